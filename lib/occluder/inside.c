// SPDX-License-Identifier: MIT
// The coarse grid of distances that the test looks at first, and the test of points.
#include "inside.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "voxel/bit_grid.h"
#include "voxel/cell_grid.h"

#include <math.h>

enum {
    MAX_BLOCKS = 160, // along the longest side
    MIN_BLOCK = 4,    // [vx]; blocks are powers of two, so that one lies in one word of a row
    MAX_REACH = 255,
};

// Voxels, both ends included.
typedef struct Range {
    int low[3], high[3];
} Range;

void pvtInsideTest_Free(pvtContext* context, pvtInsideTest* test)
{
    pvtRelease(context, test->open);
    pvtRelease(context, test->reach);
    *test = (pvtInsideTest){0};
}

static bool AreVoxelsSet(const pvtBitGrid* grid, const Range* range)
{
    const int* size = grid->frame.size;
    if (range->low[0] < 0 || range->low[1] < 0 || range->low[2] < 0 || range->high[0] >= size[0] ||
        range->high[1] >= size[1] || range->high[2] >= size[2]) {
        return false;
    }
    for (int z = range->low[2]; z <= range->high[2]; ++z) {
        for (int y = range->low[1]; y <= range->high[1]; ++y) {
            const size_t row = (size_t)z * (size_t)size[1] + (size_t)y;
            if (!pvtIsBitRangeSet(grid->words + row * grid->wordsPerRow, (size_t)range->low[0],
                                  (size_t)range->high[0] + 1)) {
                return false;
            }
        }
    }
    return true;
}

static void MarkBlocks(pvtInsideTest* test)
{
    const int side = test->blockSize;
    for (int z = 0; z < test->blocks[2]; ++z) {
        for (int y = 0; y < test->blocks[1]; ++y) {
            for (int x = 0; x < test->blocks[0]; ++x) {
                const Range range = {{x * side, y * side, z * side},
                                     {(x + 1) * side - 1, (y + 1) * side - 1, (z + 1) * side - 1}};
                test->reach[pvtInsideTest_GetBlock(test, x, y, z)] =
                    AreVoxelsSet(test->interior.allowed, &range) ? MAX_REACH : 0;
            }
        }
    }
}

// The least of the 13 neighbours that come before a block, plus one; blocks outside count 0.
static int GetReachFromBefore(const pvtInsideTest* test, const int block[3], int step)
{
    int least = MAX_REACH;
    for (int i = 0; i < 13; ++i) {
        const int x = block[0] - step + step * (i % 3);
        const int y = block[1] - step + step * (i / 3 % 3);
        const int z = block[2] - step + step * (i / 9);
        const bool isIn = x >= 0 && y >= 0 && z >= 0 && x < test->blocks[0] &&
                          y < test->blocks[1] && z < test->blocks[2];
        const int reach = isIn ? test->reach[pvtInsideTest_GetBlock(test, x, y, z)] + 1 : 1;
        least = reach < least ? reach : least;
    }
    return least;
}

// Rosenfeld and Pfaltz, Sequential Operations in Digital Picture Processing, 1966: one pass forth
// and one back give the distance along the farthest axis exactly.
static void SpreadReach(pvtInsideTest* test)
{
    const size_t count =
        (size_t)test->blocks[0] * (size_t)test->blocks[1] * (size_t)test->blocks[2];
    for (int pass = 0; pass < 2; ++pass) {
        for (size_t i = 0; i < count; ++i) {
            const size_t index = pass == 0 ? i : count - 1 - i;
            if (test->reach[index] == 0) {
                continue;
            }
            const size_t row = index / (size_t)test->blocks[0];
            const int block[3] = {(int)(index % (size_t)test->blocks[0]),
                                  (int)(row % (size_t)test->blocks[1]),
                                  (int)(row / (size_t)test->blocks[1])};
            const int reach = GetReachFromBefore(test, block, pass == 0 ? 1 : -1);
            if (reach < test->reach[index]) {
                test->reach[index] = (uint8_t)reach;
            }
        }
    }
}

pvtStatus pvtCreateInsideTest(pvtContext* context, const pvtInterior* interior, pvtInsideTest* test)
{
    const pvtBitGrid* allowed = interior->allowed;
    *test = (pvtInsideTest){.interior = *interior, .blockSize = MIN_BLOCK};
    if (interior->cells != NULL && interior->cells->count == 0) {
        test->interior.cells = NULL;
    }
    const int* size = allowed->frame.size;
    const int longest = pvtGetLongestSide(size);
    while (test->blockSize * MAX_BLOCKS < longest) {
        test->blockSize *= 2;
    }
    size_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        test->blocks[axis] = (size[axis] + test->blockSize - 1) / test->blockSize;
        count *= (size_t)test->blocks[axis];
    }
    test->reach = pvtAllocate(context, count, sizeof *test->reach);
    const pvtCellGrid* cells = test->interior.cells;
    test->open = cells != NULL ? pvtAllocate(context, cells->count, sizeof *test->open) : NULL;
    if (test->reach == NULL || (cells != NULL && test->open == NULL)) {
        pvtInsideTest_Free(context, test);
        return pvtContext_GetStatus(context);
    }
    const bool mayEnterBorder = interior->touching != NULL;
    for (size_t v = 0; cells != NULL && v < cells->count; ++v) {
        test->open[v] = cells->cells[v] | (mayEnterBorder ? cells->border[v] : 0);
    }
    MarkBlocks(test);
    SpreadReach(test);
    return PVT_OK;
}

// The voxel or cell of a point must not be outside.
static bool IsPlaceInside(const pvtInsideTest* test, const double point[3])
{
    const int* size = test->interior.allowed->frame.size;
    int cell[3], voxel[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double at = point[axis] + PVT_INSIDE_SLACK;
        if (!(at >= 0.0) || at >= size[axis]) {
            return false;
        }
        cell[axis] = (int)(at * PVT_CELLS);
        voxel[axis] = cell[axis] / PVT_CELLS;
    }
    if (pvtBitGrid_Get(test->interior.allowed, voxel[0], voxel[1], voxel[2])) {
        return true;
    }
    const pvtCellGrid* cells = test->interior.cells;
    const size_t place =
        cells != NULL ? pvtCellGrid_Find(cells, voxel[0], voxel[1], voxel[2]) : PVT_NO_CELLS;
    const int bit =
        cell[0] % PVT_CELLS + PVT_CELLS * (cell[1] % PVT_CELLS + PVT_CELLS * (cell[2] % PVT_CELLS));
    return place != PVT_NO_CELLS && (test->open[place] >> bit & 1) != 0;
}

// A point that lies between two layers may be in either.
static bool IsPlaceInsideFrom(const pvtInsideTest* test, const double point[3], int firstAxis)
{
    for (int axis = firstAxis; axis < 3; ++axis) {
        const double layer = floor(point[axis] + 0.5);
        if (fabs(point[axis] - layer) <= PVT_INSIDE_SLACK) {
            double moved[3] = {point[0], point[1], point[2]};
            moved[axis] = layer - 2.0 * PVT_INSIDE_SLACK;
            if (IsPlaceInsideFrom(test, moved, axis + 1)) {
                return true;
            }
            moved[axis] = layer + 2.0 * PVT_INSIDE_SLACK;
            return IsPlaceInsideFrom(test, moved, axis + 1);
        }
    }
    return IsPlaceInside(test, point);
}

bool pvtInsideTest_HasPoint(const pvtInsideTest* test, pvtVec3 point)
{
    return IsPlaceInsideFrom(test, (double[3]){point.x, point.y, point.z}, 0);
}
