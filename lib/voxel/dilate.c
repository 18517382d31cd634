// SPDX-License-Identifier: MIT
// Growing a set of voxels by a Euclidean ball, row by row of bits.
//
// The ball is a stack of rows: at (dy, dz) from its centre it is 2w + 1 voxels long. An output slab
// gathers the slabs around it, moved by dy, from the longest rows of the ball to the shortest, and
// grows by one bit at each side between two lengths, so that each row ends up widened by its own w.
// That costs as much as the ball has rows; large balls go by distances instead (dilate_far.c), when
// there is memory for it.
#include "dilate.h"

#include "bit_grid.h"

#include "base/context.h"

#include <math.h>
#include <stdatomic.h>

// Here both ways take about the same time.
enum { SQUARED_RADIUS_BY_DISTANCE = 25 * 25 };

enum { CANCEL_INTERVAL = 64 }; // rows of the ball

// A row of the ball: where it lies, and by how many voxels it reaches to either side.
typedef struct BallRow {
    int y, z, reach;
} BallRow;

typedef struct Ball {
    BallRow* rows; // falling reach
    size_t count;
} Ball;

// The rows of a slab from the first to the last that hold a bit; empty when begin ≥ end.
typedef struct RowRange {
    int begin, end;
} RowRange;

typedef struct Dilation {
    pvtContext* context;
    const pvtBitGrid* grid;
    pvtBitGrid* dilated;
    Ball ball;
    RowRange* used; // for each slab of the grid
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

static void GrowRows(const Dilation* dilation, int z, RowRange rows, int times)
{
    const size_t count = dilation->grid->wordsPerRow;
    for (int y = rows.begin; y < rows.end; ++y) {
        uint64_t* row = pvtBitGrid_GetRow(dilation->dilated, y, z);
        for (int i = 0; i < times; ++i) {
            GrowRow(row, count);
        }
    }
}

// ORs the slab that lies a ball row away into slab z; `rows` widens to what has been written.
static void GatherRow(const Dilation* dilation, int z, BallRow ballRow, RowRange* rows)
{
    const pvtBitGrid* grid = dilation->grid;
    const int fromZ = z + ballRow.z;
    if (fromZ < 0 || fromZ >= grid->frame.size[2]) {
        return;
    }
    const int height = grid->frame.size[1];
    const RowRange used = dilation->used[fromZ];
    const int begin = used.begin - ballRow.y > 0 ? used.begin - ballRow.y : 0;
    const int end = used.end - ballRow.y < height ? used.end - ballRow.y : height;
    if (begin >= end) {
        return;
    }
    const uint64_t* from = pvtBitGrid_GetRow(grid, begin + ballRow.y, fromZ);
    uint64_t* to = pvtBitGrid_GetRow(dilation->dilated, begin, z);
    const size_t count = (size_t)(end - begin) * grid->wordsPerRow;
    for (size_t i = 0; i < count; ++i) {
        to[i] |= from[i];
    }
    rows->begin = begin < rows->begin ? begin : rows->begin;
    rows->end = end > rows->end ? end : rows->end;
}

static bool ShouldStop(Dilation* dilation)
{
    if (pvtIsCancelled(dilation->context)) {
        atomic_store(&dilation->cancelled, true);
    }
    return atomic_load(&dilation->cancelled);
}

// On a large grid a slab takes seconds: a large ball has as many rows as the grid has itself.
static void DilateSlab(Dilation* dilation, int z)
{
    const pvtBitGrid* grid = dilation->grid;
    RowRange rows = {grid->frame.size[1], 0};
    int reach = dilation->ball.rows[0].reach;
    for (size_t i = 0; i < dilation->ball.count; ++i) {
        if (i % CANCEL_INTERVAL == 0 && ShouldStop(dilation)) {
            return;
        }
        const BallRow ballRow = dilation->ball.rows[i];
        GrowRows(dilation, z, rows, reach - ballRow.reach);
        reach = ballRow.reach;
        GatherRow(dilation, z, ballRow, &rows);
    }
    // The shortest row of the ball may be longer than one voxel.
    GrowRows(dilation, z, rows, reach);
    for (int y = rows.begin; y < rows.end; ++y) {
        pvtBitGrid_GetRow(dilation->dilated, y, z)[grid->wordsPerRow - 1] &=
            pvtBitGrid_GetTailMask(grid);
    }
}

static void DilateSlabs(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Dilation* dilation = taskData;
    for (size_t z = begin; z < end && !ShouldStop(dilation); ++z) {
        DilateSlab(dilation, (int)z);
    }
}

static void FindUsedRows(Dilation* dilation)
{
    const pvtBitGrid* grid = dilation->grid;
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        RowRange used = {grid->frame.size[1], 0};
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            const uint64_t* row = pvtBitGrid_GetRow(grid, y, z);
            uint64_t any = 0;
            for (size_t i = 0; i < grid->wordsPerRow; ++i) {
                any |= row[i];
            }
            if (any != 0) {
                used.begin = y < used.begin ? y : used.begin;
                used.end = y + 1;
            }
        }
        dilation->used[z] = used;
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
    dilation.used = pvtAllocate(context, (size_t)grid->frame.size[2], sizeof *dilation.used);
    pvtStatus status = dilation.used == NULL ? pvtContext_GetStatus(context)
                                             : MakeBall(context, squaredRadius, &dilation.ball);
    if (status == PVT_OK) {
        status = pvtCreateBitGrid(context, &grid->frame, dilated);
    }
    if (status == PVT_OK) {
        FindUsedRows(&dilation);
        pvtParallelFor(context, DilateSlabs, (size_t)grid->frame.size[2], 1, &dilation);
        status = atomic_load(&dilation.cancelled) ? pvtFailCancelled(context) : PVT_OK;
    }
    pvtRelease(context, dilation.ball.rows);
    pvtRelease(context, dilation.used);
    if (status != PVT_OK) {
        pvtBitGrid_Free(context, dilated);
    }
    return status;
}
