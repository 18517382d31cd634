// SPDX-License-Identifier: MIT
// Making, reading and measuring bit grids.
#include "bit_grid.h"

#include "base/context.h"

#include <assert.h>
#include <math.h>
#include <string.h>

// How much is done between two questions whether to stop.
enum { COPY_WORDS = 1 << 20, CANCEL_INTERVAL = 16 };

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
    pvtStatus status = pvtCreateBitGrid(context, &grid->frame, copy);
    const size_t step = COPY_WORDS;
    for (size_t begin = 0; status == PVT_OK && begin < grid->wordCount; begin += step) {
        const size_t left = grid->wordCount - begin;
        memcpy(copy->words + begin, grid->words + begin,
               (left < step ? left : step) * sizeof *grid->words);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
    }
    if (status != PVT_OK) {
        pvtBitGrid_Free(context, copy);
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

// 64 bits of a row from bit `first` on, which may lie before or beyond it: there, bits are 0.
static uint64_t ReadBits(const uint64_t* row, long count, long first)
{
    const long word = first >= 0 ? first / 64 : -((63 - first) / 64);
    const int shift = (int)(first - word * 64);
    const uint64_t low = word >= 0 && word < count ? row[word] : 0;
    const uint64_t high = word + 1 >= 0 && word + 1 < count ? row[word + 1] : 0;
    return shift == 0 ? low : low >> shift | high << (64 - shift);
}

pvtStatus pvtMoveBitGrid(pvtContext* context, const pvtBitGrid* grid, const int offset[3],
                         const int size[3], pvtBitGrid* moved)
{
    pvtGridFrame frame = {grid->frame.origin, grid->frame.voxelSize, {size[0], size[1], size[2]}};
    frame.origin.x -= offset[0] * frame.voxelSize;
    frame.origin.y -= offset[1] * frame.voxelSize;
    frame.origin.z -= offset[2] * frame.voxelSize;
    const pvtStatus status = pvtCreateBitGrid(context, &frame, moved);
    if (status != PVT_OK) {
        return status;
    }
    for (int z = 0; z < size[2]; ++z) {
        if (z % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
            pvtBitGrid_Free(context, moved);
            return pvtFailCancelled(context);
        }
        for (int y = 0; y < size[1]; ++y) {
            const int from[2] = {y - offset[1], z - offset[2]};
            if (from[0] < 0 || from[1] < 0 || from[0] >= grid->frame.size[1] ||
                from[1] >= grid->frame.size[2]) {
                continue;
            }
            const uint64_t* source = pvtBitGrid_GetRow(grid, from[0], from[1]);
            uint64_t* row = pvtBitGrid_GetRow(moved, y, z);
            for (size_t i = 0; i < moved->wordsPerRow; ++i) {
                row[i] = ReadBits(source, (long)grid->wordsPerRow, (long)i * 64 - offset[0]);
            }
            row[moved->wordsPerRow - 1] &= pvtBitGrid_GetTailMask(moved);
        }
    }
    return PVT_OK;
}

void pvtBitGrid_Complement(pvtBitGrid* grid)
{
    const uint64_t tailMask = pvtBitGrid_GetTailMask(grid);
    for (size_t begin = 0; begin < grid->wordCount; begin += grid->wordsPerRow) {
        uint64_t* row = grid->words + begin;
        for (size_t i = 0; i < grid->wordsPerRow; ++i) {
            row[i] = ~row[i];
        }
        row[grid->wordsPerRow - 1] &= tailMask;
    }
}

void pvtBitGrid_SetLayers(pvtBitGrid* grid, pvtAxis axis, int begin, int end)
{
    int lower[3] = {0, 0, 0};
    int upper[3] = {grid->frame.size[0], grid->frame.size[1], grid->frame.size[2]};
    lower[axis] = begin;
    upper[axis] = end;
    for (int z = lower[2]; z < upper[2]; ++z) {
        for (int y = lower[1]; y < upper[1]; ++y) {
            pvtSetBitRange(pvtBitGrid_GetRow(grid, y, z), (size_t)lower[0], (size_t)upper[0]);
        }
    }
}

pvtStatus pvtCheckGridMemory(pvtContext* context, const pvtBitGrid* grid, double count,
                             const char* purpose)
{
    const double needed = count * (double)grid->wordCount * sizeof *grid->words;
    const double left = (double)pvtGetFreeBytes(context);
    if (needed <= left) {
        return PVT_OK;
    }
    // What is held already shrinks along: the grid itself, and with it what is left grows.
    const double held = (double)grid->wordCount * sizeof *grid->words;
    const int* size = grid->frame.size;
    const int longest = size[0] > size[1] ? size[0] : size[1];
    const double sides = (double)(longest > size[2] ? longest : size[2]);
    return pvtFail(context, PVT_LIMIT,
                   "%s needs %.1f MB, but only %.1f MB of the memory limit are left; a resolution "
                   "of about %.0f would fit",
                   purpose, needed / 1e6, left / 1e6,
                   floor(0.95 * sides * cbrt((left + held) / (needed + held))));
}
