// SPDX-License-Identifier: MIT
// A picture in memory.
#ifndef PARAVENT_IMAGE_H
#define PARAVENT_IMAGE_H

#include <paravent/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Four bytes a pixel: red, green, blue (sRGB) and alpha. The top row first.
typedef struct pvtImage {
    uint8_t* pixels; ///< 4 × width × height
    int width, height;
} pvtImage;

/// Black and transparent. 1 to 32768 a side.
PVT_API pvtStatus pvtCreateImage(pvtContext* context, int width, int height, pvtImage* image);
PVT_API void pvtImage_Free(pvtContext* context, pvtImage* image);

#ifdef __cplusplus
}
#endif
#endif
