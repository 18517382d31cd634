// SPDX-License-Identifier: MIT
// Growing a set of voxels by a large ball, through distances.
//
// A voxel at the distance d from the set within its slab lets the ball reach √(r² − d²) slabs
// farther up and down. So the exact transform is needed for two axes only (distance.c); along the
// third two sweeps let these reaches run out, one voxel a slab, and what is left anywhere is
// within the radius.
#include "dilate.h"

#include "bit_grid.h"
#include "distance.h"

#include "base/context.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum { ALIGN_BYTES = 64 };

typedef struct FarDilation {
    pvtContext* context;
    const pvtBitGrid* grid;
    pvtBitGrid* dilated;
    uint32_t squaredRadius;
    int16_t* reaches;      // for each voxel: 1 + slabs still in reach, or 0
    unsigned char* memory; // for each worker an envelope, then a slab of distances
    size_t slabOffset;
    size_t memoryStep;
    atomic_bool cancelled;
} FarDilation;

static size_t AlignUp(size_t bytes)
{
    return (bytes + ALIGN_BYTES - 1) / ALIGN_BYTES * ALIGN_BYTES;
}

static size_t GetSlabSize(const pvtBitGrid* grid)
{
    return (size_t)grid->frame.size[0] * (size_t)grid->frame.size[1];
}

static size_t GetWorkerBytes(const pvtBitGrid* grid)
{
    return AlignUp(pvtEnvelope_GetBytes(grid->frame.size[0])) +
           AlignUp(GetSlabSize(grid) * sizeof(uint32_t));
}

double pvtGetDistanceDilationBytes(const pvtContext* context, const pvtBitGrid* grid)
{
    const double voxels = (double)GetSlabSize(grid) * grid->frame.size[2];
    // A quarter more than the blocks themselves leaves room for what each block adds.
    return 1.25 * (voxels * sizeof(int16_t) + (double)grid->wordCount * sizeof(uint64_t) +
                   (double)GetWorkerBytes(grid) * pvtContext_GetThreadCount(context));
}

static bool ShouldStop(FarDilation* dilation)
{
    if (pvtIsCancelled(dilation->context)) {
        atomic_store(&dilation->cancelled, true);
    }
    return atomic_load(&dilation->cancelled);
}

static void MeasureSlabs(size_t begin, size_t end, int worker, void* taskData)
{
    FarDilation* dilation = taskData;
    const pvtBitGrid* grid = dilation->grid;
    const size_t slabSize = GetSlabSize(grid);
    unsigned char* memory = dilation->memory + (size_t)worker * dilation->memoryStep;
    pvtEnvelope envelope = pvtMakeEnvelope(memory, grid->frame.size[0]);
    uint32_t* distances = (uint32_t*)(void*)(memory + dilation->slabOffset);
    const uint32_t limit = dilation->squaredRadius;
    for (size_t z = begin; z < end && !ShouldStop(dilation); ++z) {
        if (!pvtTransformSlab(grid, (int)z, limit, &envelope, distances)) {
            continue;
        }
        int16_t* reaches = dilation->reaches + z * slabSize;
        for (size_t i = 0; i < slabSize; ++i) {
            // Whole numbers below 2⁵³ have an exact floor of their root.
            const int left = (int)limit - (int)(distances[i] <= limit ? distances[i] : limit + 1);
            reaches[i] = (int16_t)(left < 0 ? 0 : 1 + (int)sqrt((double)left));
        }
    }
}

// What is left of the reaches of the slab before.
static void RunOut(const int16_t* before, int16_t* here, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        const int16_t left = (int16_t)(before[i] - 1);
        here[i] = left > here[i] ? left : here[i];
    }
}

static void PackRow(const int16_t* reaches, size_t width, uint64_t* row)
{
    for (size_t begin = 0; begin < width; begin += 64) {
        const size_t count = width - begin < 64 ? width - begin : 64;
        uint64_t bits = 0;
        for (size_t i = 0; i < count; ++i) {
            bits |= (uint64_t)(reaches[begin + i] > 0) << i;
        }
        row[begin / 64] = bits;
    }
}

static void SweepRows(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    FarDilation* dilation = taskData;
    const pvtBitGrid* grid = dilation->grid;
    const size_t width = (size_t)grid->frame.size[0];
    const size_t slabSize = GetSlabSize(grid);
    const size_t depth = (size_t)grid->frame.size[2];
    for (size_t y = begin; y < end && !ShouldStop(dilation); ++y) {
        int16_t* first = dilation->reaches + y * width;
        for (size_t z = 1; z < depth; ++z) {
            RunOut(first + (z - 1) * slabSize, first + z * slabSize, width);
        }
        for (size_t z = depth; z-- > 0;) {
            int16_t* here = first + z * slabSize;
            if (z + 1 < depth) {
                RunOut(here + slabSize, here, width);
            }
            PackRow(here, width, pvtBitGrid_GetRow(dilation->dilated, (int)y, (int)z));
        }
    }
}

static pvtStatus AllocateFarDilation(FarDilation* dilation)
{
    pvtContext* context = dilation->context;
    const pvtBitGrid* grid = dilation->grid;
    dilation->slabOffset = AlignUp(pvtEnvelope_GetBytes(grid->frame.size[0]));
    dilation->memoryStep = GetWorkerBytes(grid);
    dilation->memory =
        pvtAllocate(context, (size_t)pvtContext_GetThreadCount(context), dilation->memoryStep);
    dilation->reaches = dilation->memory == NULL
                            ? NULL
                            : pvtAllocate(context, GetSlabSize(grid) * (size_t)grid->frame.size[2],
                                          sizeof *dilation->reaches);
    return dilation->reaches == NULL ? pvtContext_GetStatus(context) : PVT_OK;
}

pvtStatus pvtDilateByDistance(pvtContext* context, const pvtBitGrid* grid, uint32_t squaredRadius,
                              pvtBitGrid* dilated)
{
    *dilated = (pvtBitGrid){0};
    FarDilation dilation = {
        .context = context, .grid = grid, .dilated = dilated, .squaredRadius = squaredRadius};
    pvtStatus status = AllocateFarDilation(&dilation);
    if (status == PVT_OK) {
        status = pvtCreateBitGrid(context, &grid->frame, dilated);
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, MeasureSlabs, (size_t)grid->frame.size[2], 1, &dilation);
    }
    if (status == PVT_OK && !atomic_load(&dilation.cancelled)) {
        pvtParallelFor(context, SweepRows, (size_t)grid->frame.size[1], 1, &dilation);
    }
    pvtRelease(context, dilation.reaches);
    pvtRelease(context, dilation.memory);
    if (status == PVT_OK && atomic_load(&dilation.cancelled)) {
        status = pvtFailCancelled(context);
    }
    if (status != PVT_OK) {
        pvtBitGrid_Free(context, dilated);
    }
    return status;
}
