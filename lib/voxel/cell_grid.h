// SPDX-License-Identifier: MIT
// What the voxel room's own files use of cell grids.
#ifndef PVT_VOXEL_CELL_GRID_H
#define PVT_VOXEL_CELL_GRID_H

#include "bit_grid.h"

#define PVT_NO_CELLS SIZE_MAX

/// All cells clear. Takes over `voxels`, whose frame it has; both are empty on failure.
pvtStatus pvtCreateCellGrid(pvtContext* context, pvtBitGrid* voxels, pvtCellGrid* grid);

/// So many voxels with a word come before this one; `bits` and `ranks` are those of its row.
static inline size_t pvtRankInRow(const uint64_t* bits, const uint32_t* ranks, int x)
{
    const size_t word = (size_t)x / 64;
    const uint64_t before = (UINT64_C(1) << (x % 64)) - 1;
    return ranks[word] + (size_t)pvtCountBits(bits[word] & before);
}

static inline size_t pvtCellGrid_Rank(const pvtCellGrid* grid, int x, int y, int z)
{
    const size_t row = pvtGetRowIndex(&grid->voxels, y, z) * grid->voxels.wordsPerRow;
    return pvtRankInRow(grid->voxels.words + row, grid->ranks + row, x);
}

/// Place of a voxel's word in `cells`; PVT_NO_CELLS if it has none.
static inline size_t pvtCellGrid_Find(const pvtCellGrid* grid, int x, int y, int z)
{
    return pvtBitGrid_Get(&grid->voxels, x, y, z) ? pvtCellGrid_Rank(grid, x, y, z) : PVT_NO_CELLS;
}

/// Marks the cells that a triangle touches, as pvtVoxelizeMesh does with voxels.
pvtStatus pvtVoxelizeCells(pvtContext* context, const pvtMesh* mesh, pvtCellGrid* cells);

#endif
