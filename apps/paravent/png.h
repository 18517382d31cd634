// SPDX-License-Identifier: MIT
// Small pictures for use within other files: PNG without any library, in memory.
#ifndef PVT_APP_PNG_H
#define PVT_APP_PNG_H

#include <paravent/image.h>

/// The image's colours without its alpha, as a PNG file. Meant for flat areas, which it compresses
/// well. The caller frees `*bytes`. False when memory is short.
bool pvtEncodePng(const pvtImage* image, uint8_t** bytes, size_t* size);

#endif
