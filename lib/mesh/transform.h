// SPDX-License-Identifier: MIT
// Affine transforms: 16 numbers, column after column, the last row 0 0 0 1.
#ifndef PVT_MESH_TRANSFORM_H
#define PVT_MESH_TRANSFORM_H

#include "base/vector.h"

static inline pvtVec3 pvtTransformPoint(const double m[16], pvtVec3 p)
{
    return (pvtVec3){m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
                     m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
                     m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

/// What the transform does to volumes; negative when it turns a mesh inside out.
static inline double pvtGetDeterminant(const double m[16])
{
    const pvtVec3 x = {m[0], m[1], m[2]};
    const pvtVec3 y = {m[4], m[5], m[6]};
    const pvtVec3 z = {m[8], m[9], m[10]};
    return pvtDot(pvtCross(x, y), z);
}

#endif
