// SPDX-License-Identifier: MIT
// How much a mask hides of boxes on the screen.
#ifndef PVT_OCCLUSION_RECTANGLES_H
#define PVT_OCCLUSION_RECTANGLES_H

#include <stdint.h>

/// Σ area over all axis-aligned rectangles of whole pixels that lie on set pixels of a mask of
/// 64 × 64: what pvtEvaluateOccluders' uniform quads estimate, without their noise.
uint64_t pvtSumRectangles(const uint64_t rows[64]);

#endif
