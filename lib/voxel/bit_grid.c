// SPDX-License-Identifier: MIT
// Making, reading and measuring bit grids.
#include "bit_grid.h"

#include "base/context.h"

#include <assert.h>
#include <string.h>

void pvtBitGrid_Free(pvtContext* context, pvtBitGrid* grid)
{
    pvtRelease(context, grid->words);
    *grid = (pvtBitGrid){0};
}

bool pvtBitGrid_Get(const pvtBitGrid* grid, int x, int y, int z)
{
    const int* size = grid->frame.size;
    if (x < 0 || y < 0 || z < 0 || x >= size[0] || y >= size[1] || z >= size[2]) {
        return false;
    }
    return pvtGetBit(pvtBitGrid_GetRow(grid, y, z), (size_t)x);
}

uint64_t pvtBitGrid_Count(const pvtBitGrid* grid)
{
    uint64_t count = 0;
    for (size_t i = 0; i < grid->wordCount; ++i) {
        count += (uint64_t)pvtCountBits(grid->words[i]);
    }
    return count;
}

pvtStatus pvtCreateBitGrid(pvtContext* context, const pvtGridFrame* frame, pvtBitGrid* grid)
{
    assert(frame->size[0] > 0 && frame->size[1] > 0 && frame->size[2] > 0);
    *grid = (pvtBitGrid){.frame = *frame, .wordsPerRow = pvtGetWordCount((size_t)frame->size[0])};
    grid->wordCount = grid->wordsPerRow * (size_t)frame->size[1] * (size_t)frame->size[2];
    grid->words = pvtAllocate(context, grid->wordCount, sizeof *grid->words);
    if (grid->words == NULL) {
        *grid = (pvtBitGrid){0};
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

pvtStatus pvtCopyBitGrid(pvtContext* context, const pvtBitGrid* grid, pvtBitGrid* copy)
{
    const pvtStatus status = pvtCreateBitGrid(context, &grid->frame, copy);
    if (status == PVT_OK) {
        memcpy(copy->words, grid->words, grid->wordCount * sizeof *grid->words);
    }
    return status;
}

// ORs the row into `columns`; true when it holds a bit.
static bool MergeRow(uint64_t* columns, const uint64_t* row, size_t count)
{
    uint64_t any = 0;
    for (size_t i = 0; i < count; ++i) {
        columns[i] |= row[i];
        any |= row[i];
    }
    return any != 0;
}

static void Widen(pvtGridBox* box, int axis, int value)
{
    box->lower[axis] = value < box->lower[axis] ? value : box->lower[axis];
    box->upper[axis] = value >= box->upper[axis] ? value + 1 : box->upper[axis];
}

bool pvtBitGrid_FindBounds(const pvtBitGrid* grid, pvtGridBox* box)
{
    const int* size = grid->frame.size;
    *box = (pvtGridBox){{size[0], size[1], size[2]}, {0, 0, 0}};
    uint64_t columns[PVT_MAX_GRID_SIDE / 64] = {0};
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            if (MergeRow(columns, pvtBitGrid_GetRow(grid, y, z), grid->wordsPerRow)) {
                Widen(box, 1, y);
                Widen(box, 2, z);
            }
        }
    }
    for (int x = 0; x < size[0]; ++x) {
        if (pvtGetBit(columns, (size_t)x)) {
            Widen(box, 0, x);
        }
    }
    return box->upper[0] > 0;
}
