// SPDX-License-Identifier: MIT
// Meshes and grids that several tests need.
#ifndef PVT_TEST_VOXEL_SHAPES_H
#define PVT_TEST_VOXEL_SHAPES_H

#include "failures.h"

#include "base/context.h"
#include "base/random.h"

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
    *grid = (pvtBitGrid){.frame = {{0.0, 0.0, 0.0}, 1.0, {x, y, z}}};
    grid->wordsPerRow = ((size_t)x + 63) / 64;
    grid->wordCount = grid->wordsPerRow * (size_t)y * (size_t)z;
    grid->words = pvtAllocate(context, grid->wordCount, sizeof *grid->words);
    assert_non_null(grid->words);
}

static inline void SetVoxel(pvtBitGrid* grid, int x, int y, int z)
{
    const size_t row = (size_t)z * (size_t)grid->frame.size[1] + (size_t)y;
    grid->words[row * grid->wordsPerRow + (size_t)x / 64] |= UINT64_C(1) << (x % 64);
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
