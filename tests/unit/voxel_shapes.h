// SPDX-License-Identifier: MIT
// Meshes and grids that several tests need.
#ifndef PVT_TEST_VOXEL_SHAPES_H
#define PVT_TEST_VOXEL_SHAPES_H

#include "failures.h"

#include "base/context.h"
#include "base/random.h"
#include "voxel/bit_grid.h"

#include <paravent/voxel.h>
#include <string.h>

/// The 12 triangles of a box, wound outwards.
static inline void MakeBoxMesh(pvtContext* context, pvtVec3 lower, pvtVec3 upper, pvtMesh* mesh)
{
    pvtVec3 corners[8];
    for (int i = 0; i < 8; ++i) {
        corners[i] = (pvtVec3){(i & 1) != 0 ? upper.x : lower.x, (i & 2) != 0 ? upper.y : lower.y,
                               (i & 4) != 0 ? upper.z : lower.z};
    }
    static const uint32_t indices[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    CHECK_OK(context, pvtCreateMesh(context, corners, 8, indices, 12, mesh));
}

/// An empty grid of unit voxels at the origin.
static inline void MakeEmptyGrid(pvtContext* context, int x, int y, int z, pvtBitGrid* grid)
{
    const pvtGridFrame frame = {{0.0, 0.0, 0.0}, 1.0, {x, y, z}};
    CHECK_OK(context, pvtCreateBitGrid(context, &frame, grid));
}

/// The same with voxels of half the size, off the origin, so that voxels and world differ.
static inline void MakeShiftedGrid(pvtContext* context, int x, int y, int z, pvtBitGrid* grid)
{
    const pvtGridFrame frame = {{1.0, 2.0, 3.0}, 0.5, {x, y, z}};
    CHECK_OK(context, pvtCreateBitGrid(context, &frame, grid));
}

static inline void SetVoxel(pvtBitGrid* grid, int x, int y, int z)
{
    pvtSetBit(pvtBitGrid_GetRow(grid, y, z), (size_t)x);
}

static inline void ClearVoxel(pvtBitGrid* grid, int x, int y, int z)
{
    pvtClearBit(pvtBitGrid_GetRow(grid, y, z), (size_t)x);
}

/// Sets the voxels from lower to upper − 1 along each axis.
static inline void SetBox(pvtBitGrid* grid, const int lower[3], const int upper[3])
{
    for (int z = lower[2]; z < upper[2]; ++z) {
        for (int y = lower[1]; y < upper[1]; ++y) {
            pvtSetBitRange(pvtBitGrid_GetRow(grid, y, z), (size_t)lower[0], (size_t)upper[0]);
        }
    }
}

/// Sets the voxels whose centres are nearer to `center` than `radius`, all in voxels.
static inline void SetBall(pvtBitGrid* grid, pvtVec3 center, double radius)
{
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (int x = 0; x < grid->frame.size[0]; ++x) {
                const double dx = x + 0.5 - center.x;
                const double dy = y + 0.5 - center.y;
                const double dz = z + 0.5 - center.z;
                if (dx * dx + dy * dy + dz * dz < radius * radius) {
                    SetVoxel(grid, x, y, z);
                }
            }
        }
    }
}

/// Sets each voxel with a chance of `percent`.
static inline void FillRandomly(pvtBitGrid* grid, pvtRandom* random, uint32_t percent)
{
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (int x = 0; x < grid->frame.size[0]; ++x) {
                if (pvtRandom_Below(random, 100) < percent) {
                    SetVoxel(grid, x, y, z);
                }
            }
        }
    }
}

#endif
