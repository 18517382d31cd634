// SPDX-License-Identifier: MIT
// Triangles cut by horizontal planes.
#ifndef PVT_VOXEL_CUT_H
#define PVT_VOXEL_CUT_H

#include <paravent/base.h>

typedef struct pvtFlatPoint {
    double x, y;
} pvtFlatPoint;

static inline pvtFlatPoint pvtFlatten(pvtVec3 p)
{
    return (pvtFlatPoint){p.x, p.y};
}

/// Where the edge a–b crosses the height z, for a.z < b.z.
static inline pvtFlatPoint pvtCutEdge(pvtVec3 a, pvtVec3 b, double z)
{
    const double t = (z - a.z) / (b.z - a.z);
    return (pvtFlatPoint){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/// The lowest corner first.
static inline void pvtSortByZ(pvtVec3 corners[3])
{
    for (int i = 0; i < 3; ++i) {
        const int a = i == 1 ? 1 : 0;
        if (corners[a].z > corners[a + 1].z) {
            const pvtVec3 swapped = corners[a];
            corners[a] = corners[a + 1];
            corners[a + 1] = swapped;
        }
    }
}

/// Where the way from the lowest corner over the middle one to the highest crosses the height z;
/// corners are sorted, and z lies between them.
static inline pvtFlatPoint pvtCutWay(const pvtVec3 corners[3], double z)
{
    const double middle = corners[1].z;
    return z < middle   ? pvtCutEdge(corners[0], corners[1], z)
           : z > middle ? pvtCutEdge(corners[1], corners[2], z)
                        : pvtFlatten(corners[1]);
}

#endif
