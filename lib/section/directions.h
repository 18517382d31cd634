// SPDX-License-Identifier: MIT
// The directions of a plan, and how far a grid's set voxels reach along each.
#ifndef PVT_SECTION_DIRECTIONS_H
#define PVT_SECTION_DIRECTIONS_H

#include <paravent/section.h>

/// The offsets of planes that meet a set voxel's closed cube; lower > upper when none is set.
typedef struct pvtOffsetRange {
    int64_t lower, upper;
} pvtOffsetRange;

/// What the planes of one direction share.
typedef struct pvtPlanLine {
    pvtVec3 direction; ///< unit
    bool strong;       ///< an axis or a direction that faces share
    pvtPlane shape;    ///< its offset does not matter
    pvtOffsetRange range;
} pvtPlanLine;

/// Face directions, axes, face diagonals, then what spreads evenly in between, without near
/// duplicates. Leaves the ranges for pvtMeasureExtents. To be released.
pvtStatus pvtCollectDirections(pvtContext* context, const pvtPlanOptions* options,
                               const pvtGridFrame* frame, pvtPlanLine** lines, size_t* count);

/// Sets the exact range of each line.
pvtStatus pvtMeasureExtents(pvtContext* context, const pvtBitGrid* grid, pvtPlanLine* lines,
                            size_t count);

#endif
