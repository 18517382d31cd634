// SPDX-License-Identifier: MIT
#include "fit.h"

#include "base/bits.h"
#include "section/predicates.h"

#include <assert.h>

// Edge i against all edges that are not its neighbours, and its neighbours for folding back.
static bool IsEdgeFree(const pvtPoint2* points, size_t count, size_t i)
{
    const pvtPoint2 a = points[i];
    const pvtPoint2 b = points[(i + 1) % count];
    if (pvtIsSamePoint(a, b)) {
        return false;
    }
    const pvtPoint2 before = points[(i + count - 1) % count];
    const pvtPoint2 after = points[(i + 2) % count];
    if (count > 3 && (pvtIsOnSegment(before, a, b) || pvtIsOnSegment(after, a, b) ||
                      pvtIsOnSegment(b, before, a) || pvtIsOnSegment(a, b, after))) {
        return false;
    }
    for (size_t j = (i + 2) % count; j != (i + count - 1) % count; j = (j + 1) % count) {
        if (pvtSegmentsMeet(a, b, points[j], points[(j + 1) % count])) {
            return false;
        }
    }
    return true;
}

bool pvtIsPointSimple(const pvtPoint2* points, size_t count, size_t index)
{
    return pvtGetLoopArea2(points, count) > 0 && IsEdgeFree(points, count, index) &&
           IsEdgeFree(points, count, (index + count - 1) % count);
}

// Whether they have more in common than an end of both, or a bridge, which is there in both
// directions.
static bool DoEdgesCross(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c, pvtPoint2 d)
{
    const bool isBridge = pvtIsSamePoint(a, d) && pvtIsSamePoint(b, c);
    return !isBridge && pvtSegmentsCross(a, b, c, d);
}

bool pvtIsPointFree(const pvtPoint2* points, size_t count, size_t index)
{
    const size_t before = (index + count - 1) % count;
    for (size_t side = 0; side < 2; ++side) {
        const size_t i = side == 0 ? before : index;
        const pvtPoint2 a = points[i], b = points[(i + 1) % count];
        if (pvtIsSamePoint(a, b)) {
            return false;
        }
        for (size_t j = 0; j < count; ++j) {
            if (j != i && DoEdgesCross(a, b, points[j], points[(j + 1) % count])) {
                return false;
            }
        }
    }
    return pvtGetLoopArea2(points, count) > 0;
}

int pvtGetWinding(const pvtPoint2* points, size_t count, const pvtPoint2 triangle[3])
{
    // Three times as large, the middle has whole coordinates.
    const int64_t x = (int64_t)triangle[0].x + triangle[1].x + triangle[2].x;
    const int64_t y = (int64_t)triangle[0].y + triangle[1].y + triangle[2].y;
    int winding = 0;
    for (size_t i = 0; i < count; ++i) {
        const pvtPoint2 a = points[i], b = points[(i + 1) % count];
        const int64_t ax = 3 * (int64_t)a.x - x, ay = 3 * (int64_t)a.y - y;
        const int64_t bx = 3 * (int64_t)b.x - x, by = 3 * (int64_t)b.y - y;
        const int64_t side = ax * by - bx * ay;
        winding += ay <= 0 && by > 0 && side > 0 ? 1 : 0;
        winding -= ay > 0 && by <= 0 && side < 0 ? 1 : 0;
    }
    return winding;
}

bool pvtIsPolygonSimple(const pvtPoint2* points, size_t count)
{
    if (count < 3 || pvtGetLoopArea2(points, count) <= 0) {
        return false;
    }
    for (size_t i = 0; i < count; ++i) {
        if (!IsEdgeFree(points, count, i)) {
            return false;
        }
    }
    return true;
}

// The cells of one row, from floor(low) to ceil(high) − 1 in units of 1 / scale cells, are all set.
static bool IsSpanSet(const pvtBitmap* cells, int row, int64_t low, int64_t high, int64_t scale)
{
    int64_t first = low >= 0 ? low / scale : -1;
    int64_t end = high > 0 ? (high + scale - 1) / scale : 0;
    // A span without any width still lies in a cell, unless it runs along a border between two.
    if (end <= first && low % scale != 0) {
        end = first + 1;
    }
    if (end <= first) {
        return true;
    }
    if (first < 0 || end > cells->width) {
        return false;
    }
    return pvtIsBitRangeSet(cells->words + (size_t)row * cells->wordsPerRow, (size_t)first,
                            (size_t)end);
}

// All cells whose interior the open edge passes. Coordinates are multiplied by the edge's height,
// so that crossings with rows are whole numbers.
static bool IsEdgeWithin(const pvtBitmap* cells, int32_t unit, pvtPoint2 a, pvtPoint2 b)
{
    const pvtPoint2 low = a.y <= b.y ? a : b;
    const pvtPoint2 high = a.y <= b.y ? b : a;
    const int64_t height = (int64_t)high.y - low.y;
    if (height == 0) {
        // A level edge on a border between rows passes no interior; what is inside is tested by
        // rows.
        if (low.y % unit == 0) {
            return true;
        }
        const int row = low.y / unit;
        const int32_t left = a.x < b.x ? a.x : b.x;
        const int32_t right = a.x < b.x ? b.x : a.x;
        return low.y >= 0 && row < cells->height && IsSpanSet(cells, row, left, right, unit);
    }
    if (low.y < 0 || high.y > (int64_t)cells->height * unit) {
        return false;
    }
    const int64_t width = (int64_t)high.x - low.x;
    for (int32_t y = low.y; y < high.y;) {
        const int row = y / unit;
        const int32_t next = (row + 1) * unit < high.y ? (row + 1) * unit : high.y;
        const int64_t from = low.x * height + width * (y - low.y);
        const int64_t to = low.x * height + width * (next - low.y);
        if (!IsSpanSet(cells, row, from < to ? from : to, from < to ? to : from, unit * height)) {
            return false;
        }
        y = next;
    }
    return true;
}

static void SortCrossings(double* values, int count)
{
    for (int i = 1; i < count; ++i) {
        const double value = values[i];
        int j = i;
        for (; j > 0 && values[j - 1] > value; --j) {
            values[j] = values[j - 1];
        }
        values[j] = value;
    }
}

// The cells of a row whose centres are inside. Those at the ends belong to edges as well, so that
// rounding a crossing does no harm.
static bool IsRowWithin(const pvtBitmap* cells, int32_t unit, int row, const pvtPoint2* points,
                        size_t count)
{
    const double center = (row + 0.5) * unit;
    double crossings[PVT_MAX_FIT_POINTS];
    int found = 0;
    for (size_t i = 0; i < count; ++i) {
        const pvtPoint2 a = points[i];
        const pvtPoint2 b = points[i + 1 < count ? i + 1 : 0];
        if ((a.y < center) != (b.y < center)) {
            crossings[found++] = a.x + (center - a.y) * (b.x - a.x) / (double)(b.y - a.y);
        }
    }
    SortCrossings(crossings, found);
    for (int i = 0; i + 1 < found; i += 2) {
        const int64_t first = (int64_t)(crossings[i] / unit + 0.5);
        const int64_t end = (int64_t)(crossings[i + 1] / unit + 0.5);
        if (!IsSpanSet(cells, row, first, end, 1)) {
            return false;
        }
    }
    return true;
}

bool pvtIsPolygonWithin(const pvtBitmap* cells, int cellsPerVoxel, const pvtPoint2* points,
                        size_t count)
{
    assert(count <= PVT_MAX_FIT_POINTS);
    const int32_t unit = (1 << PVT_POINT_BITS) / cellsPerVoxel;
    int32_t low = INT32_MAX;
    int32_t high = INT32_MIN;
    for (size_t i = 0; i < count; ++i) {
        low = points[i].y < low ? points[i].y : low;
        high = points[i].y > high ? points[i].y : high;
        if (points[i].x < 0 || points[i].x > (int64_t)cells->width * unit) {
            return false;
        }
    }
    if (low < 0 || high > (int64_t)cells->height * unit) {
        return false;
    }
    for (size_t i = 0; i < count; ++i) {
        if (!IsEdgeWithin(cells, unit, points[i], points[i + 1 < count ? i + 1 : 0])) {
            return false;
        }
    }
    // Rows whose centre lies between low and high.
    const int firstRow = (low + unit / 2 - 1) / unit;
    for (int row = firstRow; row * unit + unit / 2 <= high && row < cells->height; ++row) {
        if (!IsRowWithin(cells, unit, row, points, count)) {
            return false;
        }
    }
    return true;
}
