// SPDX-License-Identifier: MIT
// The grid's words in the orders that slicing reads them in, one for each dominant axis.
#include "base/bits.h"
#include "base/context.h"

#include <paravent/section.h>

// The block of 64 × 64 bits in place: bit c of word r goes to bit r of word c. Blocks of halving
// size are swapped across the diagonal (Warren, Hacker's Delight, 2nd edition 2012, section 7-3,
// with the lowest bit first).
static void TransposeBits(uint64_t block[64])
{
    uint64_t mask = UINT64_C(0x00000000FFFFFFFF);
    for (unsigned size = 32; size != 0; size >>= 1) {
        for (unsigned begin = 0; begin < 64; begin += 2 * size) {
            for (unsigned r = begin; r < begin + size; ++r) {
                const uint64_t swap = ((block[r] >> size) ^ block[r + size]) & mask;
                block[r] ^= swap << size;
                block[r + size] ^= swap;
            }
        }
        mask ^= mask << (size >> 1);
    }
}

// Planes over x have their rows along y: the only order whose words are not the grid's own.
static void FillAlongX(const pvtBitGrid* grid, int z, pvtSliceColumns* columns)
{
    const int* size = grid->frame.size;
    for (size_t w = 0; w < columns->wordsPerRow; ++w) {
        const size_t left = (size_t)size[1] - 64 * w;
        const size_t rowCount = left < 64 ? left : 64;
        uint64_t* column =
            columns->words + ((size_t)z * columns->wordsPerRow + w) * columns->stride;
        for (size_t x = 0; x < (size_t)size[0]; x += 64) {
            uint64_t block[64] = {0};
            for (size_t r = 0; r < rowCount; ++r) {
                const size_t row = (size_t)z * (size_t)size[1] + 64 * w + r;
                block[r] = grid->words[row * grid->wordsPerRow + x / 64];
            }
            TransposeBits(block);
            for (size_t n = 0; n < 64 && x + n < (size_t)size[0]; ++n) {
                column[x + n] = block[n];
            }
        }
    }
}

static void FillAlongY(const pvtBitGrid* grid, int z, pvtSliceColumns* columns)
{
    const size_t height = (size_t)grid->frame.size[1];
    const size_t wordsPerRow = grid->wordsPerRow;
    const uint64_t* words = grid->words + (size_t)z * height * wordsPerRow;
    uint64_t* column = columns->words + (size_t)z * wordsPerRow * columns->stride;
    for (size_t y = 0; y < height; ++y) {
        for (size_t w = 0; w < wordsPerRow; ++w) {
            column[w * columns->stride + y] = words[y * wordsPerRow + w];
        }
    }
}

static void FillAlongZ(const pvtBitGrid* grid, int y, pvtSliceColumns* columns)
{
    const size_t depth = (size_t)grid->frame.size[2];
    const size_t wordsPerRow = grid->wordsPerRow;
    uint64_t* column = columns->words + (size_t)y * wordsPerRow * columns->stride;
    for (size_t z = 0; z < depth; ++z) {
        const size_t row = z * (size_t)grid->frame.size[1] + (size_t)y;
        for (size_t w = 0; w < wordsPerRow; ++w) {
            column[w * columns->stride + z] = grid->words[row * wordsPerRow + w];
        }
    }
}

static void FindRanges(pvtSliceColumns* columns, int v, int length)
{
    for (size_t w = 0; w < columns->wordsPerRow; ++w) {
        const size_t index = (size_t)v * columns->wordsPerRow + w;
        const uint64_t* column = columns->words + index * columns->stride;
        int begin = 0, end = length;
        while (begin < end && column[begin] == 0) {
            ++begin;
        }
        while (end > begin && column[end - 1] == 0) {
            --end;
        }
        columns->ranges[index][0] = begin;
        columns->ranges[index][1] = end;
    }
}

typedef struct FillTask {
    const pvtBitGrid* grid;
    pvtSliceColumns* axes; // of three
} FillTask;

static void FillLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const FillTask* task = taskData;
    for (int z = (int)begin; z < (int)end; ++z) {
        FillAlongX(task->grid, z, &task->axes[PVT_AXIS_X]);
        FillAlongY(task->grid, z, &task->axes[PVT_AXIS_Y]);
        FindRanges(&task->axes[PVT_AXIS_X], z, task->grid->frame.size[0]);
        FindRanges(&task->axes[PVT_AXIS_Y], z, task->grid->frame.size[1]);
    }
}

static void FillWalls(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const FillTask* task = taskData;
    for (int y = (int)begin; y < (int)end; ++y) {
        FillAlongZ(task->grid, y, &task->axes[PVT_AXIS_Z]);
        FindRanges(&task->axes[PVT_AXIS_Z], y, task->grid->frame.size[2]);
    }
}

static pvtStatus CreateColumns(pvtContext* context, const pvtBitGrid* grid, int axis,
                               pvtSliceColumns* columns)
{
    const pvtPlane plane = {.axis = (pvtAxis)axis};
    const size_t length = (size_t)grid->frame.size[axis];
    // Slicing reads words in fours, and may start with the last one of a column.
    columns->stride = (length + 3 + 7) / 8 * 8;
    columns->wordsPerRow = pvtGetWordCount((size_t)grid->frame.size[pvtPlane_GetU(&plane)]);
    const size_t count = columns->wordsPerRow * (size_t)grid->frame.size[pvtPlane_GetV(&plane)];
    columns->words = pvtAllocate(context, count * columns->stride, sizeof *columns->words);
    if (columns->words == NULL) {
        return pvtContext_GetStatus(context);
    }
    columns->ranges = pvtAllocate(context, count, sizeof *columns->ranges);
    return columns->ranges != NULL ? PVT_OK : pvtContext_GetStatus(context);
}

static pvtStatus CreateAxes(pvtContext* context, const pvtBitGrid* grid, pvtSliceColumns axes[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const pvtStatus status = CreateColumns(context, grid, axis, &axes[axis]);
        if (status != PVT_OK) {
            return status;
        }
    }
    FillTask task = {grid, axes};
    pvtParallelFor(context, FillLayers, (size_t)grid->frame.size[2], 4, &task);
    pvtParallelFor(context, FillWalls, (size_t)grid->frame.size[1], 4, &task);
    return PVT_OK;
}

pvtStatus pvtCreateSliceVolume(pvtContext* context, const pvtBitGrid* grid, pvtSliceVolume* volume)
{
    *volume = (pvtSliceVolume){.grid = grid};
    const pvtStatus status = CreateAxes(context, grid, volume->axes);
    if (status != PVT_OK) {
        pvtSliceVolume_Free(context, volume);
    }
    return status;
}

static void FreeColumns(pvtContext* context, pvtSliceColumns axes[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        pvtRelease(context, axes[axis].words);
        pvtRelease(context, axes[axis].ranges);
        axes[axis] = (pvtSliceColumns){0};
    }
}

pvtStatus pvtAddSliceCells(pvtContext* context, const pvtCellGrid* cells, pvtSliceVolume* volume)
{
    // Where either is set. Only its words are its own.
    pvtBitGrid some = *volume->grid;
    some.words = pvtAllocateUnset(context, some.wordCount, sizeof *some.words);
    for (size_t i = 0; i < some.wordCount && some.words != NULL; ++i) {
        some.words[i] = volume->grid->words[i] | cells->voxels.words[i];
    }
    pvtStatus status = some.words != NULL ? CreateAxes(context, &some, volume->partly)
                                          : pvtContext_GetStatus(context);
    pvtRelease(context, some.words);
    if (status == PVT_OK) {
        volume->cells = cells;
    } else {
        FreeColumns(context, volume->partly);
    }
    return status;
}

void pvtSliceVolume_Free(pvtContext* context, pvtSliceVolume* volume)
{
    FreeColumns(context, volume->axes);
    FreeColumns(context, volume->partly);
    *volume = (pvtSliceVolume){0};
}
