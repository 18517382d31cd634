// SPDX-License-Identifier: MIT
#include "points.h"

#include "base/vectors.h"

#include <stdbool.h>

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

PVT_VECTOR_CLONES
void pvtFindPixels(const pvtPointProjection* projection, float* const points[3], size_t first,
                   size_t count, int size, int32_t* restrict pixels)
{
    float places[2][PVT_POINT_GROUP];
    pvtProjectPoints(projection, points, first, count, places);
    const float end = (float)size;
    for (size_t i = 0; i < count; ++i) {
        const float x = places[0][i], y = places[1][i];
        const bool isWithin = (x >= 0.0F) & (y >= 0.0F) & (x < end) & (y < end);
        const int32_t pixel = (int32_t)y * size + (int32_t)x;
        pixels[i] = isWithin ? pixel : size * size;
    }
}
