// SPDX-License-Identifier: MIT
#include "pocket.h"

#include "base/bits.h"
#include "base/context.h"

#include <stdlib.h>

static int CompareCrossings(const void* left, const void* right)
{
    const pvtPocketCrossing *a = left, *b = right;
    if (a->row != b->row) {
        return a->row < b->row ? -1 : 1;
    }
    return (a->column > b->column) - (a->column < b->column);
}

static pvtStatus ReserveCrossings(pvtContext* context, pvtPocketScratch* scratch, size_t count)
{
    if (scratch->count + count <= scratch->capacity) {
        return PVT_OK;
    }
    const size_t capacity = 2 * (scratch->count + count) + 64;
    pvtPocketCrossing* grown =
        pvtReallocate(context, scratch->crossings, capacity, sizeof *scratch->crossings);
    if (grown == NULL) {
        return pvtContext_GetStatus(context);
    }
    scratch->crossings = grown;
    scratch->capacity = capacity;
    return PVT_OK;
}

// Where an edge crosses the lines through the centres of rows of cells.
static pvtStatus AddEdge(pvtContext* context, pvtPoint2 from, pvtPoint2 to, int32_t unit,
                         pvtPocketScratch* scratch)
{
    const bool isUp = from.y < to.y;
    const pvtPoint2 low = isUp ? from : to, high = isUp ? to : from;
    // Rows whose centre lies above `low` or on it, and below `high`.
    const int64_t first = pvtCeilDivide(2 * (int64_t)low.y - unit, 2 * (int64_t)unit);
    const int64_t end = pvtCeilDivide(2 * (int64_t)high.y - unit, 2 * (int64_t)unit);
    if (first >= end) {
        return PVT_OK;
    }
    const pvtStatus status = ReserveCrossings(context, scratch, (size_t)(end - first));
    const int64_t height = 2 * ((int64_t)high.y - low.y);
    const int64_t width = (int64_t)high.x - low.x;
    for (int64_t row = first; row < end && status == PVT_OK; ++row) {
        const int64_t rise = (2 * row + 1) * unit - 2 * (int64_t)low.y;
        const int64_t twice = 2 * (low.x * height + width * rise) - unit * height;
        const int64_t column = pvtFloorDivide(twice, 2 * (int64_t)unit * height) + 1;
        scratch->crossings[scratch->count++] =
            (pvtPocketCrossing){(int32_t)row, (int32_t)column, isUp ? 1 : -1};
    }
    return status;
}

// From one crossing to the next of its row.
static bool IsRunCovered(const pvtBitmap* cells, const pvtPocketCrossing* from, int32_t end)
{
    if (from->column >= end) {
        return true;
    }
    if (from->row < 0 || from->row >= cells->height || from->column < 0 || end > cells->width) {
        return false;
    }
    const uint64_t* row = cells->words + (size_t)from->row * cells->wordsPerRow;
    return pvtIsBitRangeSet(row, (size_t)from->column, (size_t)end);
}

static bool AreRunsCovered(const pvtPocketScratch* scratch, const pvtBitmap* cells)
{
    int32_t winding = 0;
    for (size_t i = 0; i + 1 < scratch->count; ++i) {
        winding += scratch->crossings[i].turn;
        // Windings end with their row, since the border is closed.
        if (winding != 0 &&
            !IsRunCovered(cells, &scratch->crossings[i], scratch->crossings[i + 1].column)) {
            return false;
        }
    }
    return true;
}

pvtStatus pvtPocket_IsCovered(pvtContext* context, const pvtPocket* pocket, const pvtBitmap* cells,
                              int32_t unit, pvtPocketScratch* scratch, bool* isCovered)
{
    *isCovered = false;
    scratch->count = 0;
    for (size_t i = pocket->first; i <= pocket->last; ++i) {
        const size_t next = i < pocket->last ? i + 1 : pocket->first;
        const pvtStatus status = AddEdge(context, pvtPocket_GetPoint(pocket, i),
                                         pvtPocket_GetPoint(pocket, next), unit, scratch);
        if (status != PVT_OK) {
            return status;
        }
    }
    if (scratch->count > 0) {
        qsort(scratch->crossings, scratch->count, sizeof *scratch->crossings, CompareCrossings);
    }
    *isCovered = AreRunsCovered(scratch, cells);
    return PVT_OK;
}

bool pvtPocket_Holds(const pvtPocket* pocket, pvtPoint2 point)
{
    int winding = 0;
    for (size_t i = pocket->first; i <= pocket->last; ++i) {
        const size_t next = i < pocket->last ? i + 1 : pocket->first;
        const pvtPoint2 a = pvtPocket_GetPoint(pocket, i), b = pvtPocket_GetPoint(pocket, next);
        if (pvtIsOnSegment(point, a, b)) {
            return true;
        }
        if ((a.y <= point.y) != (b.y <= point.y)) {
            const bool isUp = a.y <= point.y;
            const int64_t side = pvtOrient(a, b, point);
            winding += isUp && side > 0 ? 1 : !isUp && side < 0 ? -1 : 0;
        }
    }
    return winding != 0;
}
