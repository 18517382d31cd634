// SPDX-License-Identifier: MIT
#include "cell_grid.h"

#include "base/context.h"

void pvtCellGrid_Free(pvtContext* context, pvtCellGrid* grid)
{
    pvtBitGrid_Free(context, &grid->voxels);
    pvtRelease(context, grid->ranks);
    pvtRelease(context, grid->cells);
    pvtRelease(context, grid->border);
    *grid = (pvtCellGrid){0};
}

pvtStatus pvtCreateCellGrid(pvtContext* context, pvtBitGrid* voxels, pvtCellGrid* grid)
{
    *grid = (pvtCellGrid){.voxels = *voxels};
    *voxels = (pvtBitGrid){0};
    grid->ranks = pvtAllocateUnset(context, grid->voxels.wordCount, sizeof *grid->ranks);
    for (size_t word = 0; word < grid->voxels.wordCount && grid->ranks != NULL; ++word) {
        grid->ranks[word] = (uint32_t)grid->count;
        grid->count += (size_t)pvtCountBits(grid->voxels.words[word]);
    }
    if (grid->ranks != NULL) {
        grid->cells = pvtAllocate(context, grid->count, sizeof *grid->cells);
    }
    if (grid->ranks == NULL || grid->cells == NULL) {
        pvtCellGrid_Free(context, grid);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

static uint64_t GetWord(const pvtCellGrid* grid, const uint64_t* words, int x, int y, int z)
{
    const int* size = grid->voxels.frame.size;
    if (words == NULL || x < 0 || y < 0 || z < 0 || x >= size[0] || y >= size[1] || z >= size[2]) {
        return 0;
    }
    const size_t index = pvtCellGrid_Find(grid, x, y, z);
    return index == PVT_NO_CELLS ? 0 : words[index];
}

uint64_t pvtCellGrid_Get(const pvtCellGrid* grid, int x, int y, int z)
{
    return GetWord(grid, grid->cells, x, y, z);
}

uint64_t pvtCellGrid_GetBorder(const pvtCellGrid* grid, int x, int y, int z)
{
    return GetWord(grid, grid->border, x, y, z);
}
