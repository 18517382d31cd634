// SPDX-License-Identifier: MIT
#include "points.h"

#include "base/vectors.h"

PVT_VECTOR_CLONES
void pvtProjectPoints(const pvtPointProjection* projection, float* const points[3], size_t first,
                      size_t count, float (*restrict places)[PVT_POINT_GROUP])
{
    const float* restrict x = points[0] + first;
    const float* restrict y = points[1] + first;
    const float* restrict z = points[2] + first;
    for (size_t i = 0; i < count; ++i) {
        places[0][i] = x[i] * projection->right[0] + y[i] * projection->right[1] +
                       z[i] * projection->right[2] + projection->offset[0];
        places[1][i] = x[i] * projection->up[0] + y[i] * projection->up[1] +
                       z[i] * projection->up[2] + projection->offset[1];
    }
}
