// SPDX-License-Identifier: MIT
// A texture of opaque and transparent texels, as a PNG that needs no library to write.
#ifndef PVT_TEST_MASK_H
#define PVT_TEST_MASK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MASK_SIZE = 64, MASK_PNG_ROOM = 1024 };

/// Rows from the top.
typedef struct Mask {
    bool isOpaque[MASK_SIZE][MASK_SIZE];
} Mask;

/// One bit a pixel, with a palette of two greens, the first of them transparent; not compressed.
/// Returns the size.
size_t EncodeMask(const Mask* mask, uint8_t png[MASK_PNG_ROOM]);

#endif
