// SPDX-License-Identifier: MIT
// Arithmetic on pvtVec3.
#ifndef PVT_BASE_VECTOR_H
#define PVT_BASE_VECTOR_H

#include <math.h>
#include <paravent/base.h>

static inline pvtVec3 pvtAdd(pvtVec3 a, pvtVec3 b)
{
    return (pvtVec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline pvtVec3 pvtSub(pvtVec3 a, pvtVec3 b)
{
    return (pvtVec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline pvtVec3 pvtScale(pvtVec3 a, double s)
{
    return (pvtVec3){a.x * s, a.y * s, a.z * s};
}

static inline double pvtDot(pvtVec3 a, pvtVec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline pvtVec3 pvtCross(pvtVec3 a, pvtVec3 b)
{
    return (pvtVec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double pvtLength3(pvtVec3 a)
{
    return sqrt(pvtDot(a, a));
}

/// The zero vector stays zero.
static inline pvtVec3 pvtNormalize(pvtVec3 a)
{
    const double length = pvtLength3(a);
    return length > 0.0 ? pvtScale(a, 1.0 / length) : a;
}

static inline bool pvtIsFinite3(pvtVec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

/// By x, then y, then z.
static inline bool pvtIsBefore(pvtVec3 a, pvtVec3 b)
{
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// Coordinate 0, 1 or 2.
static inline double pvtGetAxis(pvtVec3 a, int axis)
{
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

static inline void pvtSetAxis(pvtVec3* a, int axis, double value)
{
    if (axis == 0) {
        a->x = value;
    } else if (axis == 1) {
        a->y = value;
    } else {
        a->z = value;
    }
}

#endif
