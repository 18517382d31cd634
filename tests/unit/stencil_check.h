// SPDX-License-Identifier: MIT
// Where a slice by the stencil may differ from a slice by lookup.
#ifndef PVT_TEST_STENCIL_CHECK_H
#define PVT_TEST_STENCIL_CHECK_H

#include <paravent/section.h>
#include <stdlib.h>

// Twice cellsPerVoxel times the height of a cell's centre, in 2^-20 voxel: an exact integer.
static inline int64_t GetHeight(const pvtPlane* plane, int cellsPerVoxel, int i, int j)
{
    return plane->offset * 2 * cellsPerVoxel + (int64_t)plane->slopeU * (2 * i + 1) +
           (int64_t)plane->slopeV * (2 * j + 1);
}

// The one mismatch that is accepted: within 1/512 cell of the centre along u and v, the plane meets
// a voxel's face. The allowance is for depths next to −1, which a float rounds to 2^-17 voxel at
// this size; a plane without slopes has no clipped edges, and is exact.
static inline bool IsNextToFace(const pvtPlane* plane, int cellsPerVoxel, int i, int j)
{
    const int64_t voxel = 2 * cellsPerVoxel * (INT64_C(1) << PVT_PLANE_BITS);
    const int64_t height = GetHeight(plane, cellsPerVoxel, i, j);
    const int64_t above = ((height % voxel) + voxel) % voxel;
    const int64_t distance = above < voxel - above ? above : voxel - above;
    const int64_t slopes = llabs((int64_t)plane->slopeU) + llabs((int64_t)plane->slopeV);
    const int64_t allowance = slopes == 0 ? 0 : voxel >> 17;
    return distance <= slopes * 2 / 512 + allowance;
}

#endif
