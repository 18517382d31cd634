// SPDX-License-Identifier: MIT
// The voxels that a triangle passes, row by row.
#ifndef PVT_OCCLUDER_ROWS_H
#define PVT_OCCLUDER_ROWS_H

#include <paravent/base.h>

/// A triangle on its way through the layers of voxels along z. All coordinates are 0 or above.
typedef struct pvtRowCutter {
    pvtVec3 corners[3];        ///< from the lowest to the highest
    double slack;              ///< what passes a layer, row or voxel by less is not counted
    int firstLayer, lastLayer; ///< both included, as all ranges here
} pvtRowCutter;

/// Where along x the part of the triangle in a row of voxels begins and ends.
typedef struct pvtRowSpan {
    double low, high;
} pvtRowSpan;

/// The rows of one layer.
typedef struct pvtRows {
    pvtRowSpan* spans; ///< of the first row and those after it
    int first, last;   ///< along y
    double slack;
} pvtRows;

/// `scale` times the corners.
pvtRowCutter pvtStartRows(const pvtVec3 corners[3], double scale, double slack);
/// One of the cutter's layers. There must be room for the spans of all of its rows: at most two
/// more than the triangle is long along y.
void pvtCutLayer(const pvtRowCutter* cutter, int layer, pvtRows* rows);

/// The voxels of a row, from the first to the last; a part between two voxels is in one of them.
static inline void pvtRows_GetVoxels(const pvtRows* rows, int y, int* first, int* last)
{
    const pvtRowSpan* span = &rows->spans[y - rows->first];
    const int end = (int)(span->high - rows->slack);
    *first = (int)(span->low + rows->slack);
    *last = end > *first ? end : *first;
}

#endif
