// SPDX-License-Identifier: MIT
// A PNG's pixels, without anything around them.
#ifndef PVT_IO_PNG_STRIP_H
#define PVT_IO_PNG_STRIP_H

#include "source.h"

/// Copies the chunks that make the pixels of bytes that begin as a PNG: profiles, texts and the
/// like are of no use here, and libpng says to the standard error what it thinks of them. For the
/// same reason what is cut short, or does not match its checksum, is PVT_INVALID_INPUT already
/// here. `label` is the image's name for messages.
pvtStatus pvtStripPng(pvtContext* context, const char* label, const uint8_t* bytes, size_t size,
                      pvtSource* stripped);

#endif
