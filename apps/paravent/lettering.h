// SPDX-License-Identifier: MIT
// Captions in pictures: capital letters, digits and a few signs, five pixels by seven.
#ifndef PVT_APP_LETTERING_H
#define PVT_APP_LETTERING_H

#include <paravent/image.h>

enum { PVT_LETTER_WIDTH = 6, PVT_LETTER_HEIGHT = 7 }; // [px] at scale 1, the gap included

/// Draws in the colour (red, green, blue), each pixel as scale × scale. The text's upper left
/// corner is at `at`; what is outside the image is left away. Small letters become capitals, what
/// has no letter a question mark.
typedef struct pvtLettering {
    int scale;
    uint8_t colour[3];
} pvtLettering;

void pvtDrawText(pvtImage* image, const pvtLettering* lettering, const int at[2], const char* text);

/// A rectangle x, y, width, height of the lettering's colour.
void pvtFillRectangle(pvtImage* image, const uint8_t colour[3], const int rectangle[4]);

#endif
