// SPDX-License-Identifier: MIT
// The exact distance transform of a mask, row by row, for those who keep its parts.
#ifndef PVT_OCCLUSION_DISTANCE_H
#define PVT_OCCLUSION_DISTANCE_H

#include <paravent/occlusion.h>

enum { PVT_MAX_MASK_SIZE = 256 };

/// Distance [px] along each column to the nearest clear pixel of it, 0 where clear: `size` bytes a
/// row. First half of the transform.
void pvtTransformMaskColumns(const uint64_t* rows, int size, uint8_t* columns);

/// Second half, for one row of pvtTransformMaskColumns: Σ table[d²] over the left and over the
/// right half of the row.
void pvtSumMaskRow(const uint8_t* columnRow, int size, const uint32_t* table, uint64_t sums[2]);

#endif
