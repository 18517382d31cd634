// SPDX-License-Identifier: MIT
// As pvtVoxelizeMesh does it: the part of a triangle within a row is convex, so that the ends of
// its edges there bound it. Nothing is tested voxel by voxel.
#include "rows.h"

#include "base/vector.h"
#include "voxel/cut.h"

#include <math.h>

static void FindRange(double low, double high, double slack, int* first, int* last)
{
    // Not below 0: cutting the fraction off rounds down.
    const int end = (int)(high - slack);
    *first = (int)(low + slack);
    *last = end > *first ? end : *first;
}

pvtRowCutter pvtStartRows(const pvtVec3 corners[3], double scale, double slack)
{
    pvtRowCutter cutter = {.slack = slack};
    for (int i = 0; i < 3; ++i) {
        cutter.corners[i] = pvtScale(corners[i], scale);
    }
    pvtSortByZ(cutter.corners);
    const pvtVec3* c = cutter.corners;
    FindRange(c[0].z, c[2].z, slack, &cutter.firstLayer, &cutter.lastLayer);
    return cutter;
}

static void Widen(pvtRows* rows, int y, double x)
{
    const int row = y < rows->first ? rows->first : y > rows->last ? rows->last : y;
    pvtRowSpan* span = &rows->spans[row - rows->first];
    span->low = x < span->low ? x : span->low;
    span->high = x > span->high ? x : span->high;
}

static void AddSegment(pvtRows* rows, pvtFlatPoint a, pvtFlatPoint b)
{
    const pvtFlatPoint low = a.y < b.y ? a : b, high = a.y < b.y ? b : a;
    const int from = (int)low.y, to = (int)high.y;
    Widen(rows, from, low.x);
    Widen(rows, to, high.x);
    if (from == to) {
        return;
    }
    const double slope = (high.x - low.x) / (high.y - low.y);
    for (int y = from; y < to; ++y) {
        const double x = low.x + (y + 1 - low.y) * slope;
        Widen(rows, y, x);
        Widen(rows, y + 1, x);
    }
}

// Of a convex polygon in the order of its corners.
static void AddPolygon(pvtRows* rows, const pvtFlatPoint* corners, int count)
{
    double low = corners[0].y, high = corners[0].y;
    for (int i = 1; i < count; ++i) {
        low = corners[i].y < low ? corners[i].y : low;
        high = corners[i].y > high ? corners[i].y : high;
    }
    FindRange(low, high, rows->slack, &rows->first, &rows->last);
    for (int y = rows->first; y <= rows->last; ++y) {
        rows->spans[y - rows->first] = (pvtRowSpan){HUGE_VAL, -HUGE_VAL};
    }
    for (int i = 0; i < count; ++i) {
        AddSegment(rows, corners[i], corners[i + 1 == count ? 0 : i + 1]);
    }
}

void pvtCutLayer(const pvtRowCutter* cutter, int layer, pvtRows* rows)
{
    const pvtVec3* c = cutter->corners;
    rows->slack = cutter->slack;
    if (cutter->firstLayer == cutter->lastLayer) {
        AddPolygon(rows, (pvtFlatPoint[3]){pvtFlatten(c[0]), pvtFlatten(c[1]), pvtFlatten(c[2])},
                   3);
        return;
    }
    const double low = layer == cutter->firstLayer ? c[0].z : layer;
    const double high = layer == cutter->lastLayer ? c[2].z : layer + 1;
    pvtFlatPoint corners[5];
    int count = 0;
    corners[count++] = pvtCutEdge(c[0], c[2], low);
    corners[count++] = pvtCutEdge(c[0], c[2], high);
    corners[count++] = pvtCutWay(c, high);
    if (low < c[1].z && c[1].z < high) {
        corners[count++] = pvtFlatten(c[1]);
    }
    corners[count++] = pvtCutWay(c, low);
    AddPolygon(rows, corners, count);
}
