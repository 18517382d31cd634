// SPDX-License-Identifier: MIT
// Which cells a triangle or a segment touches: row by row, the least and the greatest x that it has
// between the row's two borders, as fractions, rounded outwards to whole cells.
#include "cover.h"

#include "base/bits.h"
#include "predicates.h"

// A range of cells; empty when end ≤ begin.
typedef struct CellRange {
    int64_t begin, end;
} CellRange;

// Widens the range by the part of an edge that lies in strip[0] ≤ y ≤ strip[1].
static void AddEdge(CellRange* range, pvtPoint2 p, pvtPoint2 q, const int64_t strip[2],
                    int32_t unit)
{
    const pvtPoint2 lower = p.y < q.y ? p : q, upper = p.y < q.y ? q : p;
    const int64_t from = pvtMaxInt64(strip[0], lower.y), to = pvtMinInt64(strip[1], upper.y);
    if (lower.y == upper.y || from > to) {
        return; // the ends of a level edge are ends of the other two edges as well
    }
    const int64_t height = (int64_t)upper.y - lower.y, width = (int64_t)upper.x - lower.x;
    const int64_t divisor = height * unit;
    const int64_t base = lower.x * height;
    const int64_t left = base + width * ((width < 0 ? to : from) - lower.y);
    const int64_t right = base + width * ((width < 0 ? from : to) - lower.y);
    range->begin = pvtMinInt64(range->begin, pvtFloorDivide(left, divisor));
    range->end = pvtMaxInt64(range->end, pvtCeilDivide(right, divisor));
}

static bool IsRangeCovered(const pvtBitmap* cells, int64_t row, const CellRange* range)
{
    if (range->begin < 0 || range->end > cells->width) {
        return false;
    }
    const uint64_t* words = cells->words + (size_t)row * cells->wordsPerRow;
    return pvtIsBitRangeSet(words, (size_t)range->begin, (size_t)range->end);
}

// The cells around the middle corner that the triangle's angle there opens into. Most triangles
// that are not covered stand on a clear cell there.
static bool IsMiddleCovered(const pvtBitmap* cells, int32_t unit, const pvtPoint2 corners[3])
{
    const pvtPoint2 at = corners[1];
    const bool isTurned = pvtOrient(at, corners[0], corners[2]) < 0;
    const pvtPoint2 first = corners[isTurned ? 2 : 0], second = corners[isTurned ? 0 : 2];
    const int64_t x1 = (int64_t)first.x - at.x, y1 = (int64_t)first.y - at.y;
    const int64_t x2 = (int64_t)second.x - at.x, y2 = (int64_t)second.y - at.y;
    const int shift = __builtin_ctz((unsigned)unit);
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
        const int x = quadrant % 2 == 0 ? -1 : 1, y = quadrant < 2 ? -1 : 1;
        // Two angles overlap when a side of one, or the middle of the other, lies in the other.
        const bool isTouched = (x1 * x > 0 && y1 * y > 0) || (x2 * x > 0 && y2 * y > 0) ||
                               (x1 * y - y1 * x > 0 && x * y2 - y * x2 > 0);
        if (isTouched &&
            !pvtBitmap_Get(cells, (at.x - (x < 0)) >> shift, (at.y - (y < 0)) >> shift)) {
            return false;
        }
    }
    return true;
}

static bool IsRowCovered(const pvtBitmap* cells, int32_t unit, const pvtPoint2 corners[3],
                         int64_t row)
{
    const int64_t strip[2] = {row * unit, (row + 1) * unit};
    CellRange range = {INT64_MAX, INT64_MIN};
    for (int i = 0; i < 3; ++i) {
        AddEdge(&range, corners[i], corners[i == 2 ? 0 : i + 1], strip, unit);
    }
    return IsRangeCovered(cells, row, &range);
}

// An edge that is followed from row to row: where it crosses the next border, in cells, as
// whole + rest / divisor.
typedef struct EdgeWalk {
    int64_t firstRow, lastRow;
    CellRange low, high; // around its x at the row's lower border, and at its upper end
    int64_t whole, rest, divisor;
    int64_t wholeStep, restStep;
} EdgeWalk;

static CellRange GetCellsAround(int32_t x, int shift)
{
    return (CellRange){x >> shift, ((int64_t)x + (1 << shift) - 1) >> shift};
}

// Goes nowhere when the edge is level.
static EdgeWalk StartWalk(pvtPoint2 p, pvtPoint2 q, int shift)
{
    const pvtPoint2 lower = p.y < q.y ? p : q, upper = p.y < q.y ? q : p;
    const int64_t height = (int64_t)upper.y - lower.y, width = (int64_t)upper.x - lower.x;
    EdgeWalk walk = {.firstRow = lower.y >> shift,
                     .lastRow = ((int64_t)upper.y - 1) >> shift,
                     .low = GetCellsAround(lower.x, shift),
                     .high = GetCellsAround(upper.x, shift)};
    if (height == 0) {
        walk.lastRow = walk.firstRow - 1;
    } else if (walk.firstRow < walk.lastRow) {
        const int64_t rise = ((walk.firstRow + 1) << shift) - lower.y;
        const int64_t x = lower.x * height + width * rise;
        walk.divisor = height << shift;
        walk.whole = pvtFloorDivide(x, walk.divisor);
        walk.rest = x - walk.whole * walk.divisor;
        walk.wholeStep = pvtFloorDivide(width, height);
        walk.restStep = (width - walk.wholeStep * height) << shift;
    }
    return walk;
}

// Widens the range by what the edge passes in one row, the next from its last call.
static void WalkRow(EdgeWalk* walk, int64_t row, CellRange* range)
{
    if (row < walk->firstRow || row > walk->lastRow) {
        return;
    }
    CellRange high = walk->high;
    if (row < walk->lastRow) {
        high = (CellRange){walk->whole, walk->whole + (walk->rest > 0)};
        walk->whole += walk->wholeStep;
        walk->rest += walk->restStep;
        if (walk->rest >= walk->divisor) {
            walk->rest -= walk->divisor;
            ++walk->whole;
        }
    }
    range->begin = pvtMinInt64(range->begin, pvtMinInt64(walk->low.begin, high.begin));
    range->end = pvtMaxInt64(range->end, pvtMaxInt64(walk->low.end, high.end));
    walk->low = high;
}

static bool AreRowsCovered(const pvtBitmap* cells, int shift, const pvtPoint2 corners[3],
                           const CellRange* rows)
{
    EdgeWalk walks[3];
    for (int i = 0; i < 3; ++i) {
        walks[i] = StartWalk(corners[i], corners[i == 2 ? 0 : i + 1], shift);
    }
    for (int64_t row = rows->begin; row < rows->end; ++row) {
        CellRange range = {INT64_MAX, INT64_MIN};
        for (int i = 0; i < 3; ++i) {
            WalkRow(&walks[i], row, &range);
        }
        if (!IsRangeCovered(cells, row, &range)) {
            return false;
        }
    }
    return true;
}

bool pvtIsTriangleCovered(const pvtBitmap* cells, int32_t unit, const pvtPoint2 corners[3])
{
    if (pvtOrient(corners[0], corners[1], corners[2]) == 0) {
        return true;
    }
    if (!IsMiddleCovered(cells, unit, corners)) {
        return false;
    }
    const int shift = __builtin_ctz((unsigned)unit);
    const int32_t y0 = corners[0].y, y1 = corners[1].y, y2 = corners[2].y;
    const CellRange rows = {pvtMinInt64(y0, pvtMinInt64(y1, y2)) >> shift,
                            (pvtMaxInt64(y0, pvtMaxInt64(y1, y2)) + unit - 1) >> shift};
    if (rows.begin < 0 || rows.end > cells->height) {
        return false;
    }
    // A tall triangle that is not covered seldom is so in one row only: a few tell most of them.
    const int64_t quarter = (rows.end - rows.begin) / 4;
    for (int i = 1; i < 4 && quarter > 2; ++i) {
        if (!IsRowCovered(cells, unit, corners, rows.begin + i * quarter)) {
            return false;
        }
    }
    return AreRowsCovered(cells, shift, corners, &rows);
}

bool pvtIsSegmentCovered(const pvtBitmap* cells, int32_t unit, pvtPoint2 from, pvtPoint2 to)
{
    const int64_t first = pvtFloorDivide(pvtMinInt64(from.y, to.y), unit);
    const int64_t end = pvtCeilDivide(pvtMaxInt64(from.y, to.y), unit);
    if (first < end && (first < 0 || end > cells->height)) {
        return false;
    }
    for (int64_t row = first; row < end; ++row) {
        const int64_t strip[2] = {row * unit, (row + 1) * unit};
        CellRange range = {INT64_MAX, INT64_MIN};
        if (from.y == to.y) {
            range.begin = pvtFloorDivide(pvtMinInt64(from.x, to.x), unit);
            range.end = pvtCeilDivide(pvtMaxInt64(from.x, to.x), unit);
        } else {
            AddEdge(&range, from, to, strip, unit);
        }
        if (!IsRangeCovered(cells, row, &range)) {
            return false;
        }
    }
    return true;
}
