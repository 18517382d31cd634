// SPDX-License-Identifier: MIT
// Exact predicates on points of a plane. Coordinates stay below 2^28 in magnitude, so that the
// products fit 64 bits and nothing is rounded.
#ifndef PVT_SECTION_PREDICATES_H
#define PVT_SECTION_PREDICATES_H

#include <assert.h>
#include <paravent/section.h>

static inline bool pvtIsSamePoint(pvtPoint2 a, pvtPoint2 b)
{
    return a.x == b.x && a.y == b.y;
}

static inline int64_t pvtMinInt64(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static inline int64_t pvtMaxInt64(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

/// Of a quotient whose divisor is positive.
static inline int64_t pvtFloorDivide(int64_t value, int64_t divisor)
{
    assert(divisor > 0);
    const int64_t quotient = value / divisor;
    return quotient - (value % divisor < 0);
}

static inline int64_t pvtCeilDivide(int64_t value, int64_t divisor)
{
    assert(divisor > 0);
    const int64_t quotient = value / divisor;
    return quotient + (value % divisor > 0);
}

/// (b − a) × (d − c).
static inline int64_t pvtCrossEdges(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c, pvtPoint2 d)
{
    return ((int64_t)b.x - a.x) * ((int64_t)d.y - c.y) -
           ((int64_t)b.y - a.y) * ((int64_t)d.x - c.x);
}

/// (b − a) · (d − c).
static inline int64_t pvtDotEdges(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c, pvtPoint2 d)
{
    return ((int64_t)b.x - a.x) * ((int64_t)d.x - c.x) +
           ((int64_t)b.y - a.y) * ((int64_t)d.y - c.y);
}

/// Twice the signed area of the triangle a, b, c: above 0 when c lies left of a → b.
static inline int64_t pvtOrient(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c)
{
    return pvtCrossEdges(a, b, a, c);
}

static inline int pvtSign(int64_t value)
{
    return (value > 0) - (value < 0);
}

static inline int64_t pvtGetDistance2(pvtPoint2 a, pvtPoint2 b)
{
    return pvtDotEdges(a, b, a, b);
}

/// On the closed segment from a to b.
static inline bool pvtIsOnSegment(pvtPoint2 point, pvtPoint2 a, pvtPoint2 b)
{
    return pvtOrient(a, b, point) == 0 && pvtDotEdges(point, a, point, b) <= 0;
}

/// True when the closed segments a–b and c–d share a point.
static inline bool pvtSegmentsMeet(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c, pvtPoint2 d)
{
    const int abc = pvtSign(pvtOrient(a, b, c)), abd = pvtSign(pvtOrient(a, b, d));
    const int cda = pvtSign(pvtOrient(c, d, a)), cdb = pvtSign(pvtOrient(c, d, b));
    if (abc * abd < 0 && cda * cdb < 0) {
        return true;
    }
    return pvtIsOnSegment(c, a, b) || pvtIsOnSegment(d, a, b) || pvtIsOnSegment(a, c, d) ||
           pvtIsOnSegment(b, c, d);
}

/// True when two segments meet elsewhere than in a common end, or run along each other from there.
static inline bool pvtSegmentsCross(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c, pvtPoint2 d)
{
    for (int i = 0; i < 4; ++i) {
        const pvtPoint2 shared = i < 2 ? c : d, other = i < 2 ? d : c;
        const pvtPoint2 end = i % 2 == 0 ? a : b, far = i % 2 == 0 ? b : a;
        if (pvtIsSamePoint(shared, end)) {
            return pvtOrient(end, far, other) == 0 && pvtDotEdges(end, far, end, other) > 0;
        }
    }
    return pvtSegmentsMeet(a, b, c, d);
}

/// A place where a boundary passes: it comes from `before` and goes on to `after`. What it bounds
/// lies on its left, in the angle from `after` counter-clockwise to `before`.
typedef struct pvtPass {
    pvtPoint2 before, at, after;
} pvtPass;

/// True when `target` lies strictly within the angle that the boundary bounds. At a tip, where the
/// boundary turns back on itself, the angle counts as the full turn.
static inline bool pvtPass_IsInside(const pvtPass* pass, pvtPoint2 target)
{
    const int64_t turn = pvtCrossEdges(pass->at, pass->after, pass->at, pass->before);
    const int64_t fromAfter = pvtCrossEdges(pass->at, pass->after, pass->at, target);
    const int64_t toBefore = pvtCrossEdges(pass->at, target, pass->at, pass->before);
    if (turn > 0) {
        return fromAfter > 0 && toBefore > 0;
    }
    if (turn < 0) {
        return fromAfter > 0 || toBefore > 0;
    }
    const bool isStraight = pvtDotEdges(pass->at, pass->after, pass->at, pass->before) < 0;
    return isStraight ? fromAfter > 0
                      : fromAfter != 0 || pvtDotEdges(pass->at, pass->after, pass->at, target) < 0;
}

#endif
