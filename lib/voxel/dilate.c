// SPDX-License-Identifier: MIT
// Growing a set of voxels by a Euclidean ball, row by row of bits.
//
// The ball is a stack of rows: at (dy, dz) from its centre it is 2w + 1 voxels long. An output row
// gathers the rows around it from the longest to the shortest, and grows by one bit at each side
// between two lengths, so that each row ends up widened by its own w. That costs as much as the
// ball has rows; large balls go by distances instead (dilate_far.c), when there is memory for it.
#include "dilate.h"

#include "bit_grid.h"

#include "base/context.h"

#include <math.h>
#include <stdatomic.h>

// Here both ways take about the same time.
enum { SQUARED_RADIUS_BY_DISTANCE = 20 * 20 };

// A row of the ball: where it lies, and by how many voxels it reaches to either side.
typedef struct BallRow {
    int y, z, reach;
} BallRow;

typedef struct Ball {
    BallRow* rows; // falling reach
    size_t count;
} Ball;

typedef struct Dilation {
    pvtContext* context;
    const pvtBitGrid* grid;
    pvtBitGrid* dilated;
    Ball ball;
    bool* isEmpty; // a row of the grid holds no bit
    atomic_bool cancelled;
} Dilation;

uint32_t pvtGetSquaredReach(const pvtGridFrame* frame, double distance)
{
    const double reach = distance / frame->voxelSize * (1.0 + 1e-9);
    const double most = 3.0 * PVT_MAX_GRID_SIDE * (double)PVT_MAX_GRID_SIDE;
    return (uint32_t)fmin(reach * reach, most);
}

static int FindRoot(uint32_t square)
{
    int root = (int)sqrt((double)square);
    while ((uint32_t)root * (uint32_t)root > square) {
        --root;
    }
    while ((uint32_t)(root + 1) * (uint32_t)(root + 1) <= square) {
        ++root;
    }
    return root;
}

static pvtStatus MakeBall(pvtContext* context, uint32_t squaredRadius, Ball* ball)
{
    const int radius = FindRoot(squaredRadius);
    const size_t side = 2 * (size_t)radius + 1;
    *ball = (Ball){.rows = pvtAllocate(context, side * side, sizeof *ball->rows)};
    if (ball->rows == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (int reach = radius; reach >= 0; --reach) {
        for (int z = -radius; z <= radius; ++z) {
            for (int y = -radius; y <= radius; ++y) {
                const uint32_t square = (uint32_t)(y * y + z * z);
                if (square <= squaredRadius && FindRoot(squaredRadius - square) == reach) {
                    ball->rows[ball->count++] = (BallRow){y, z, reach};
                }
            }
        }
    }
    return PVT_OK;
}

// Grows a row by one bit at either side of each set one.
static void GrowRow(uint64_t* row, size_t count)
{
    uint64_t before = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint64_t word = row[i];
        const uint64_t after = i + 1 < count ? row[i + 1] : 0;
        row[i] = word | word << 1 | word >> 1 | before >> 63 | after << 63;
        before = word;
    }
}

static void DilateRow(const Dilation* dilation, int y, int z)
{
    const pvtBitGrid* grid = dilation->grid;
    const size_t count = grid->wordsPerRow;
    uint64_t* out = pvtBitGrid_GetRow(dilation->dilated, y, z);
    int reach = dilation->ball.rows[0].reach;
    bool any = false;
    for (size_t i = 0; i < dilation->ball.count; ++i) {
        const BallRow ballRow = dilation->ball.rows[i];
        for (; reach > ballRow.reach; --reach) {
            if (any) {
                GrowRow(out, count);
            }
        }
        const int fromY = y + ballRow.y;
        const int fromZ = z + ballRow.z;
        if (fromY < 0 || fromZ < 0 || fromY >= grid->frame.size[1] ||
            fromZ >= grid->frame.size[2] || dilation->isEmpty[pvtGetRowIndex(grid, fromY, fromZ)]) {
            continue;
        }
        const uint64_t* from = pvtBitGrid_GetRow(grid, fromY, fromZ);
        for (size_t word = 0; word < count; ++word) {
            out[word] |= from[word];
        }
        any = true;
    }
    // The shortest row of the ball may be longer than one voxel.
    for (; reach > 0; --reach) {
        GrowRow(out, count);
    }
    out[count - 1] &= pvtBitGrid_GetTailMask(grid);
}

static void DilateSlabs(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Dilation* dilation = taskData;
    for (size_t z = begin; z < end; ++z) {
        for (int y = 0; y < dilation->grid->frame.size[1]; ++y) {
            DilateRow(dilation, y, (int)z);
        }
        if (pvtIsCancelled(dilation->context)) {
            atomic_store(&dilation->cancelled, true);
        }
        if (atomic_load(&dilation->cancelled)) {
            return;
        }
    }
}

static void FindEmptyRows(Dilation* dilation)
{
    const pvtBitGrid* grid = dilation->grid;
    const size_t rows = (size_t)grid->frame.size[1] * (size_t)grid->frame.size[2];
    for (size_t row = 0; row < rows; ++row) {
        uint64_t any = 0;
        for (size_t i = 0; i < grid->wordsPerRow; ++i) {
            any |= grid->words[row * grid->wordsPerRow + i];
        }
        dilation->isEmpty[row] = any == 0;
    }
}

pvtStatus pvtDilateGrid(pvtContext* context, const pvtBitGrid* grid, uint32_t squaredRadius,
                        pvtBitGrid* dilated)
{
    if (squaredRadius == 0) {
        return pvtCopyBitGrid(context, grid, dilated);
    }
    if (squaredRadius >= SQUARED_RADIUS_BY_DISTANCE &&
        pvtGetDistanceDilationBytes(context, grid) <= (double)pvtGetFreeBytes(context)) {
        return pvtDilateByDistance(context, grid, squaredRadius, dilated);
    }
    *dilated = (pvtBitGrid){0};
    Dilation dilation = {.context = context, .grid = grid, .dilated = dilated};
    const size_t rows = (size_t)grid->frame.size[1] * (size_t)grid->frame.size[2];
    dilation.isEmpty = pvtAllocate(context, rows, sizeof *dilation.isEmpty);
    pvtStatus status = dilation.isEmpty == NULL ? pvtContext_GetStatus(context)
                                                : MakeBall(context, squaredRadius, &dilation.ball);
    if (status == PVT_OK) {
        status = pvtCreateBitGrid(context, &grid->frame, dilated);
    }
    if (status == PVT_OK) {
        FindEmptyRows(&dilation);
        pvtParallelFor(context, DilateSlabs, (size_t)grid->frame.size[2], 1, &dilation);
        status = atomic_load(&dilation.cancelled) ? pvtFailCancelled(context) : PVT_OK;
    }
    pvtRelease(context, dilation.ball.rows);
    pvtRelease(context, dilation.isEmpty);
    if (status != PVT_OK) {
        pvtBitGrid_Free(context, dilated);
    }
    return status;
}
