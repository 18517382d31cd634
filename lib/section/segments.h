// SPDX-License-Identifier: MIT
// The edges of loops, filed under the squares that they pass.
#ifndef PVT_SECTION_SEGMENTS_H
#define PVT_SECTION_SEGMENTS_H

#include <paravent/section.h>

typedef struct pvtSegment {
    pvtPoint2 from, to;
} pvtSegment;

/// One segment in one square.
typedef struct pvtSegmentEntry {
    uint32_t segment;
    uint32_t next; ///< UINT32_MAX: the square's last
} pvtSegmentEntry;

typedef struct pvtSegmentGrid {
    pvtPoint2 origin;
    int shift; ///< squares are 2^shift point units wide
    int32_t columns, rows;
    uint32_t* heads; ///< one a square
    pvtSegmentEntry* entries;
    size_t entryCount, entryCapacity;
    pvtSegment* segments; ///< of loops: numbered as the points that they begin at
    size_t segmentCount;
} pvtSegmentGrid;

/// Squares from left to right and from bottom to top.
typedef struct pvtSquareRange {
    int32_t left, right, bottom, top;
} pvtSquareRange;

/// Files all edges of the loops, and leaves room for `extra` more segments.
pvtStatus pvtCreateSegmentGrid(pvtContext* context, const pvtLoopSet* loops, size_t extra,
                               pvtSegmentGrid* grid);
void pvtSegmentGrid_Free(pvtContext* context, pvtSegmentGrid* grid);
/// Must lie within the box of the loops.
pvtStatus pvtSegmentGrid_Add(pvtContext* context, pvtSegmentGrid* grid, pvtSegment segment);

/// Called with each segment that may share a point with another; returns true to stop.
typedef bool pvtSegmentVisitor(void* user, uint32_t segment);

/// Visits the segments near one that lies within the box of the loops, some of them repeatedly.
/// True when the visitor stopped it.
bool pvtSegmentGrid_Visit(const pvtSegmentGrid* grid, pvtSegment segment,
                          pvtSegmentVisitor* visitor, void* user);

static inline int32_t pvtSegmentGrid_GetColumn(const pvtSegmentGrid* grid, int64_t x)
{
    return (int32_t)((x - grid->origin.x) >> grid->shift);
}

static inline int32_t pvtSegmentGrid_GetRow(const pvtSegmentGrid* grid, int64_t y)
{
    return (int32_t)((y - grid->origin.y) >> grid->shift);
}

static inline uint32_t pvtSegmentGrid_GetHead(const pvtSegmentGrid* grid, int32_t column,
                                              int32_t row)
{
    return grid->heads[(size_t)row * (size_t)grid->columns + (size_t)column];
}

#endif
