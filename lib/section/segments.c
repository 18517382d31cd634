// SPDX-License-Identifier: MIT
#include "segments.h"

#include "base/context.h"
#include "predicates.h"

static const uint32_t NONE = UINT32_MAX;

// A square is at least this many powers of two wide: a quarter of a voxel.
enum { LEAST_SHIFT = 6 };

// The columns that a segment passes within one row of squares.
typedef struct ColumnRange {
    int32_t first, last;
} ColumnRange;

// About as many squares as points, so that most hold a few segments each.
static void SetSquares(const pvtLoopSet* loops, pvtSegmentGrid* grid)
{
    pvtPoint2 low = {0, 0}, high = {0, 0};
    if (loops->pointCount > 0) {
        low = high = loops->points[0];
    }
    for (size_t i = 1; i < loops->pointCount; ++i) {
        const pvtPoint2 at = loops->points[i];
        low.x = at.x < low.x ? at.x : low.x;
        low.y = at.y < low.y ? at.y : low.y;
        high.x = at.x > high.x ? at.x : high.x;
        high.y = at.y > high.y ? at.y : high.y;
    }
    grid->origin = low;
    for (grid->shift = LEAST_SHIFT;; ++grid->shift) {
        grid->columns = pvtSegmentGrid_GetColumn(grid, high.x) + 1;
        grid->rows = pvtSegmentGrid_GetRow(grid, high.y) + 1;
        if ((size_t)grid->columns * (size_t)grid->rows <= loops->pointCount + 64) {
            return;
        }
    }
}

static pvtStatus AddLoops(pvtContext* context, const pvtLoopSet* loops, pvtSegmentGrid* grid)
{
    for (size_t l = 0; l < loops->loopCount; ++l) {
        const size_t end = loops->starts[l + 1];
        for (size_t i = loops->starts[l]; i < end; ++i) {
            const size_t next = i + 1 < end ? i + 1 : loops->starts[l];
            const pvtStatus status = pvtSegmentGrid_Add(
                context, grid, (pvtSegment){loops->points[i], loops->points[next]});
            if (status != PVT_OK) {
                return status;
            }
        }
    }
    return PVT_OK;
}

pvtStatus pvtCreateSegmentGrid(pvtContext* context, const pvtLoopSet* loops, size_t extra,
                               pvtSegmentGrid* grid)
{
    *grid = (pvtSegmentGrid){0};
    SetSquares(loops, grid);
    const size_t squares = (size_t)grid->columns * (size_t)grid->rows;
    grid->entryCapacity = 4 * loops->pointCount + 64;
    grid->heads = pvtAllocate(context, squares, sizeof *grid->heads);
    grid->entries = pvtAllocate(context, grid->entryCapacity, sizeof *grid->entries);
    grid->segments = pvtAllocate(context, loops->pointCount + extra, sizeof *grid->segments);
    pvtStatus status = PVT_OK;
    if (grid->heads == NULL || grid->entries == NULL || grid->segments == NULL) {
        status = pvtContext_GetStatus(context);
    } else {
        for (size_t i = 0; i < squares; ++i) {
            grid->heads[i] = NONE;
        }
        status = AddLoops(context, loops, grid);
    }
    if (status != PVT_OK) {
        pvtSegmentGrid_Free(context, grid);
    }
    return status;
}

void pvtSegmentGrid_Free(pvtContext* context, pvtSegmentGrid* grid)
{
    pvtRelease(context, grid->heads);
    pvtRelease(context, grid->entries);
    pvtRelease(context, grid->segments);
    *grid = (pvtSegmentGrid){0};
}

// Rounded outwards, so that a segment is never missed.
static ColumnRange GetColumns(const pvtSegmentGrid* grid, const pvtSegment* segment, int32_t row)
{
    const bool isUp = segment->from.y <= segment->to.y;
    const pvtPoint2 low = isUp ? segment->from : segment->to;
    const pvtPoint2 high = isUp ? segment->to : segment->from;
    int64_t first = low.x, last = high.x;
    const int64_t bottom = grid->origin.y + ((int64_t)row << grid->shift);
    const int64_t top = bottom + ((int64_t)1 << grid->shift);
    const int64_t width = (int64_t)high.x - low.x, height = (int64_t)high.y - low.y;
    if (low.y < bottom) {
        const int64_t rise = width * (bottom - low.y);
        first = low.x + (width > 0 ? pvtFloorDivide(rise, height) : pvtCeilDivide(rise, height));
    }
    if (high.y > top) {
        const int64_t rise = width * (top - low.y);
        last = low.x + (width > 0 ? pvtCeilDivide(rise, height) : pvtFloorDivide(rise, height));
    }
    return (ColumnRange){pvtSegmentGrid_GetColumn(grid, pvtMinInt64(first, last)),
                         pvtSegmentGrid_GetColumn(grid, pvtMaxInt64(first, last))};
}

static ColumnRange GetRows(const pvtSegmentGrid* grid, const pvtSegment* segment)
{
    return (ColumnRange){pvtSegmentGrid_GetRow(grid, pvtMinInt64(segment->from.y, segment->to.y)),
                         pvtSegmentGrid_GetRow(grid, pvtMaxInt64(segment->from.y, segment->to.y))};
}

static pvtStatus ReserveEntries(pvtContext* context, pvtSegmentGrid* grid, size_t count)
{
    if (grid->entryCount + count <= grid->entryCapacity) {
        return PVT_OK;
    }
    const size_t capacity = 2 * (grid->entryCount + count);
    if (capacity >= NONE) {
        return pvtFail(context, PVT_LIMIT, "a slice has too many edges");
    }
    pvtSegmentEntry* grown = pvtReallocate(context, grid->entries, capacity, sizeof *grid->entries);
    if (grown == NULL) {
        return pvtContext_GetStatus(context);
    }
    grid->entries = grown;
    grid->entryCapacity = capacity;
    return PVT_OK;
}

pvtStatus pvtSegmentGrid_Add(pvtContext* context, pvtSegmentGrid* grid, pvtSegment segment)
{
    const uint32_t number = (uint32_t)grid->segmentCount;
    const ColumnRange rows = GetRows(grid, &segment);
    for (int32_t row = rows.first; row <= rows.last; ++row) {
        const ColumnRange columns = GetColumns(grid, &segment, row);
        const pvtStatus status =
            ReserveEntries(context, grid, (size_t)(columns.last - columns.first) + 1);
        if (status != PVT_OK) {
            return status;
        }
        for (int32_t column = columns.first; column <= columns.last; ++column) {
            uint32_t* head = &grid->heads[(size_t)row * (size_t)grid->columns + (size_t)column];
            grid->entries[grid->entryCount] = (pvtSegmentEntry){number, *head};
            *head = (uint32_t)grid->entryCount++;
        }
    }
    grid->segments[grid->segmentCount++] = segment;
    return PVT_OK;
}

bool pvtSegmentGrid_Visit(const pvtSegmentGrid* grid, pvtSegment segment,
                          pvtSegmentVisitor* visitor, void* user)
{
    const ColumnRange rows = GetRows(grid, &segment);
    for (int32_t row = rows.first; row <= rows.last; ++row) {
        const ColumnRange columns = GetColumns(grid, &segment, row);
        for (int32_t column = columns.first; column <= columns.last; ++column) {
            uint32_t entry = pvtSegmentGrid_GetHead(grid, column, row);
            for (; entry != NONE; entry = grid->entries[entry].next) {
                if (visitor(user, grid->entries[entry].segment)) {
                    return true;
                }
            }
        }
    }
    return false;
}
