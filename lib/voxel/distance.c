// SPDX-License-Identifier: MIT
// The exact Euclidean distance transform of a grid, one axis at a time.
//
// Meijster, Roerdink and Hesselink (2000), in the order y, x, z: along y distances come from
// counting rows up and down, 64 voxels of a row at once where they are all free or all set; along
// x lines are contiguous; along z a few lines at a time are turned into a small buffer.
#include "distance.h"

#include "bit_grid.h"

#include "base/context.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum { LINES_A_TILE = 32 };

// slab[y][x] = rows since the last set voxel of the column, as a plain count.
static bool CountUp(const pvtBitGrid* grid, int z, uint32_t most, uint32_t* slab)
{
    const size_t width = (size_t)grid->frame.size[0];
    uint64_t any = 0;
    for (int y = 0; y < grid->frame.size[1]; ++y) {
        const uint64_t* row = pvtBitGrid_GetRow(grid, y, z);
        uint32_t* here = slab + (size_t)y * width;
        const uint32_t* before = here - width;
        for (size_t x = 0; x < width; ++x) {
            const uint32_t count = y == 0 ? most : before[x];
            here[x] = count < most ? count + 1 : most;
        }
        for (size_t i = 0; i < grid->wordsPerRow; ++i) {
            any |= row[i];
            for (uint64_t bits = row[i]; bits != 0; bits &= bits - 1) {
                here[i * 64 + (size_t)__builtin_ctzll(bits)] = 0;
            }
        }
    }
    return any != 0;
}

// The lesser of the counts from both sides, squared.
static void CountDownAndSquare(const pvtBitGrid* grid, uint32_t most, uint32_t* slab)
{
    const size_t width = (size_t)grid->frame.size[0];
    for (int y = grid->frame.size[1] - 2; y >= 0; --y) {
        uint32_t* here = slab + (size_t)y * width;
        uint32_t* after = here + width;
        for (size_t x = 0; x < width; ++x) {
            const uint32_t count = after[x] + 1;
            here[x] = count < here[x] ? count : here[x];
            after[x] = after[x] < most ? after[x] * after[x] : PVT_FAR;
        }
    }
    for (size_t x = 0; x < width; ++x) {
        slab[x] = slab[x] < most ? slab[x] * slab[x] : PVT_FAR;
    }
}

// The least count that stands for a distance above the limit, or for none.
static uint32_t FindMost(uint32_t limit, int height)
{
    const uint32_t most = (uint32_t)sqrt((double)limit) + 1;
    return most < (uint32_t)height ? most : (uint32_t)height;
}

bool pvtTransformSlab(const pvtBitGrid* grid, int z, uint32_t limit, pvtEnvelope* envelope,
                      uint32_t* slab)
{
    const uint32_t most = FindMost(limit, grid->frame.size[1]);
    if (!CountUp(grid, z, most, slab)) {
        return false;
    }
    CountDownAndSquare(grid, most, slab);
    for (int y = 0; y < grid->frame.size[1]; ++y) {
        uint32_t* line = slab + (size_t)y * (size_t)grid->frame.size[0];
        pvtEnvelope_Apply(envelope, line, grid->frame.size[0], limit);
    }
    return true;
}

typedef struct Transform {
    pvtContext* context;
    const pvtBitGrid* grid;
    uint32_t limit;
    uint32_t farValue; // what is stored for distances above the limit
    uint32_t* distances;
    unsigned char* memory; // for each worker an envelope, then a tile
    size_t memoryStep;
    size_t tileOffset;
    int longest;
    atomic_bool cancelled;
} Transform;

static bool ShouldStop(Transform* transform)
{
    if (pvtIsCancelled(transform->context)) {
        atomic_store(&transform->cancelled, true);
    }
    return atomic_load(&transform->cancelled);
}

static void TransformSlabs(size_t begin, size_t end, int worker, void* taskData)
{
    Transform* transform = taskData;
    const int* size = transform->grid->frame.size;
    const size_t step = (size_t)size[0] * (size_t)size[1];
    pvtEnvelope envelope = pvtMakeEnvelope(
        transform->memory + (size_t)worker * transform->memoryStep, transform->longest);
    for (size_t z = begin; z < end && !ShouldStop(transform); ++z) {
        uint32_t* slab = transform->distances + z * step;
        if (!pvtTransformSlab(transform->grid, (int)z, transform->limit, &envelope, slab)) {
            memset(slab, 0xFF, step * sizeof *slab);
        }
    }
}

// The lines along z through `count` neighbours, from `first` on.
static void TransformTile(const Transform* transform, pvtEnvelope* envelope, uint32_t* tile,
                          uint32_t* first, size_t count)
{
    const int* size = transform->grid->frame.size;
    const size_t step = (size_t)size[0] * (size_t)size[1];
    const size_t depth = (size_t)size[2];
    for (size_t z = 0; z < depth; ++z) {
        for (size_t i = 0; i < count; ++i) {
            tile[i * depth + z] = first[z * step + i];
        }
    }
    for (size_t i = 0; i < count; ++i) {
        pvtEnvelope_Apply(envelope, tile + i * depth, size[2], transform->limit);
    }
    for (size_t z = 0; z < depth; ++z) {
        for (size_t i = 0; i < count; ++i) {
            const uint32_t value = tile[i * depth + z];
            first[z * step + i] = value == PVT_FAR ? transform->farValue : value;
        }
    }
}

static void TransformRows(size_t begin, size_t end, int worker, void* taskData)
{
    Transform* transform = taskData;
    const size_t width = (size_t)transform->grid->frame.size[0];
    unsigned char* memory = transform->memory + (size_t)worker * transform->memoryStep;
    pvtEnvelope envelope = pvtMakeEnvelope(memory, transform->longest);
    uint32_t* tile = (uint32_t*)(void*)(memory + transform->tileOffset);
    for (size_t y = begin; y < end && !ShouldStop(transform); ++y) {
        uint32_t* row = transform->distances + y * width;
        for (size_t x = 0; x < width; x += LINES_A_TILE) {
            const size_t count = width - x < LINES_A_TILE ? width - x : LINES_A_TILE;
            TransformTile(transform, &envelope, tile, row + x, count);
        }
    }
}

static int GetLongestSide(const pvtBitGrid* grid)
{
    const int* size = grid->frame.size;
    const int longest = size[0] > size[1] ? size[0] : size[1];
    return longest > size[2] ? longest : size[2];
}

pvtStatus pvtTransformGridDistance(pvtContext* context, const pvtBitGrid* grid, uint32_t limit,
                                   uint32_t* distances)
{
    Transform transform = {.context = context, .grid = grid, .distances = distances};
    // No two voxels are farther apart than the diagonal of the largest grid.
    const uint32_t diagonal = 3 * (uint32_t)PVT_MAX_GRID_SIDE * (uint32_t)PVT_MAX_GRID_SIDE;
    transform.limit = limit < diagonal ? limit : diagonal;
    transform.farValue = limit < UINT32_MAX ? limit + 1 : limit;
    transform.longest = GetLongestSide(grid);
    transform.tileOffset = (pvtEnvelope_GetBytes(transform.longest) + 63) / 64 * 64;
    transform.memoryStep =
        transform.tileOffset + ((size_t)grid->frame.size[2] / 16 + 1) * 64 * LINES_A_TILE;
    transform.memory =
        pvtAllocate(context, (size_t)pvtContext_GetThreadCount(context), transform.memoryStep);
    if (transform.memory == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtParallelFor(context, TransformSlabs, (size_t)grid->frame.size[2], 1, &transform);
    if (!atomic_load(&transform.cancelled)) {
        pvtParallelFor(context, TransformRows, (size_t)grid->frame.size[1], 1, &transform);
    }
    pvtRelease(context, transform.memory);
    return atomic_load(&transform.cancelled) ? pvtFailCancelled(context) : PVT_OK;
}
