// SPDX-License-Identifier: MIT
// Bitmaps, loops and brute-force checks that the tests of contours, polygons and chains share.
#ifndef PVT_TEST_SHAPES_H
#define PVT_TEST_SHAPES_H

#include "failures.h"

#include "base/random.h"
#include "section/predicates.h"

#include <paravent/section.h>
#include <stdlib.h>

typedef bool ShapeFcn(int x, int y, int size);

static inline pvtBitmap MakeShape(pvtContext* context, int size, ShapeFcn* shape)
{
    pvtBitmap bitmap;
    CHECK_OK(context, pvtCreateBitmap(context, size, size, &bitmap));
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            pvtBitmap_Set(&bitmap, x, y, shape(x, y, size));
        }
    }
    return bitmap;
}

// Blobs with bays, holes and islands: noise, smoothed by a cellular automaton.
static inline pvtBitmap MakeBlobs(pvtContext* context, int width, int height, uint64_t seed,
                                  int rounds)
{
    pvtRandom random = pvtMakeRandom(seed, 17);
    pvtBitmap now, then;
    CHECK_OK(context, pvtCreateBitmap(context, width, height, &now));
    CHECK_OK(context, pvtCreateBitmap(context, width, height, &then));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            pvtBitmap_Set(&now, x, y, pvtRandom_Unit(&random) < 0.52);
        }
    }
    for (int round = 0; round < rounds; ++round) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                int neighbours = 0;
                for (int i = 0; i < 9; ++i) {
                    neighbours += pvtBitmap_Get(&now, x + i % 3 - 1, y + i / 3 - 1);
                }
                pvtBitmap_Set(&then, x, y, neighbours >= 5);
            }
        }
        const pvtBitmap swap = now;
        now = then;
        then = swap;
    }
    pvtBitmap_Free(context, &then);
    return now;
}

static inline bool IsDisc(int x, int y, int size)
{
    const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
    return dx * dx + dy * dy < (size - 2) * (size - 2);
}

static inline bool IsRing(int x, int y, int size)
{
    const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
    return IsDisc(x, y, size) && dx * dx + dy * dy > size * size / 4;
}

static inline bool IsEverywhere(int x, int y, int size)
{
    (void)x, (void)y, (void)size;
    return true;
}

static inline bool IsCheckered(int x, int y, int size)
{
    (void)size;
    return ((x ^ y) & 1) == 0;
}

// Set but for single clear cells at odd places: a great many holes.
static inline bool IsSieve(int x, int y, int size)
{
    (void)size;
    return (x & y & 1) == 0;
}

static inline bool IsComb(int x, int y, int size)
{
    return y < 2 || ((x & 1) == 0 && y < size - 1);
}

static inline bool IsTurnedSquare(int x, int y, int size)
{
    const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
    return abs(3 * dx + dy) < 2 * size && abs(3 * dy - dx) < 2 * size;
}

static inline bool IsL(int x, int y, int size)
{
    const int edge = size / 10;
    return x >= edge && y >= edge && x < size - edge && y < size - edge &&
           (x < size / 2 || y < size / 3);
}

// Eight cells in a ring around a clear one, one of its corners open: the ends touch diagonally.
static inline bool IsPinchedRing(int x, int y, int size)
{
    (void)size;
    return x >= 1 && x <= 3 && y >= 1 && y <= 3 && !(x == 2 && y == 2) && !(x == 3 && y == 3);
}

static inline double GetSetArea(const pvtLoopSet* set)
{
    double area = 0.0;
    for (size_t l = 0; l < set->loopCount; ++l) {
        area += (double)pvtGetLoopArea2(set->points + set->starts[l],
                                        set->starts[l + 1] - set->starts[l]);
    }
    return area / 131072.0;
}

// Twice the number of times that the loop winds around a point off its edges.
static inline int GetWinding(const pvtPoint2* loop, size_t count, double x, double y)
{
    int winding = 0;
    for (size_t i = 0, last = count - 1; i < count; last = i++) {
        const double ax = loop[last].x - x, ay = loop[last].y - y;
        const double bx = loop[i].x - x, by = loop[i].y - y;
        if ((ay <= 0.0) != (by <= 0.0)) {
            const double side = ax * by - ay * bx;
            winding += ay <= 0.0 ? (side > 0.0 ? 1 : 0) : (side < 0.0 ? -1 : 0);
        }
    }
    return winding;
}

// True when the segments cross in one point inside both.
static inline bool DoSegmentsCross(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c, pvtPoint2 d)
{
    return pvtSign(pvtOrient(a, b, c)) * pvtSign(pvtOrient(a, b, d)) < 0 &&
           pvtSign(pvtOrient(c, d, a)) * pvtSign(pvtOrient(c, d, b)) < 0;
}

// No two edges cross inside both: touching is allowed. Quadratic.
static inline bool HasNoCrossing(const pvtLoopSet* set)
{
    for (size_t la = 0; la < set->loopCount; ++la) {
        for (size_t a = set->starts[la], aEnd = set->starts[la + 1]; a < aEnd; ++a) {
            const pvtPoint2 p = set->points[a];
            const pvtPoint2 q = set->points[a + 1 < aEnd ? a + 1 : set->starts[la]];
            for (size_t lb = la; lb < set->loopCount; ++lb) {
                const size_t bEnd = set->starts[lb + 1];
                for (size_t b = lb == la ? a + 1 : set->starts[lb]; b < bEnd; ++b) {
                    const pvtPoint2 r = set->points[b];
                    const pvtPoint2 s = set->points[b + 1 < bEnd ? b + 1 : set->starts[lb]];
                    if (DoSegmentsCross(p, q, r, s)) {
                        return false;
                    }
                }
            }
        }
    }
    return true;
}

#endif
