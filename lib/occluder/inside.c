// SPDX-License-Identifier: MIT
// The coarse grid of distances that the test looks at first, and the test of points.
#include "inside.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "base/vectors.h"
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
                const bool isOutermost = x == 0 || y == 0 || z == 0 || x == test->blocks[0] - 1 ||
                                         y == test->blocks[1] - 1 || z == test->blocks[2] - 1;
                test->reach[pvtInsideTest_GetBlock(test, x, y, z)] =
                    !AreVoxelsSet(test->interior.allowed, &range) ? 0
                    : isOutermost                                 ? 1
                                                                  : MAX_REACH;
            }
        }
    }
}

// One more than the least of the three neighbours that each block of a row has in another.
PVT_VECTOR_CLONES
static void ReachFromRow(const uint8_t* restrict from, int width, uint8_t* restrict row)
{
    for (int x = 1; x < width - 1; ++x) {
        const uint8_t side = from[x - 1] < from[x + 1] ? from[x - 1] : from[x + 1];
        const uint8_t least = side < from[x] ? side : from[x];
        const uint8_t reach = (uint8_t)(least + (least < MAX_REACH ? 1 : 0));
        row[x] = reach < row[x] ? reach : row[x];
    }
}

static void ReachWithinRow(int width, int way, uint8_t* row)
{
    for (int i = 1; i < width - 1; ++i) {
        const int x = way > 0 ? i : width - 1 - i;
        const int reach = row[x - way] + 1;
        row[x] = reach < row[x] ? (uint8_t)reach : row[x];
    }
}

// From three rows of the layer before, and the row before in its own.
static void SpreadToRow(const pvtInsideTest* test, int y, int z, int way)
{
    const int width = test->blocks[0];
    uint8_t* row = test->reach + pvtInsideTest_GetBlock(test, 0, y, z);
    for (int i = -1; i <= 1; ++i) {
        ReachFromRow(test->reach + pvtInsideTest_GetBlock(test, 0, y + i, z - way), width, row);
    }
    ReachFromRow(test->reach + pvtInsideTest_GetBlock(test, 0, y - way, z), width, row);
    ReachWithinRow(width, way, row);
}

// Rosenfeld and Pfaltz, Sequential Operations in Digital Picture Processing, 1966: one pass forth
// and one back give the distance along the farthest axis exactly. Outside of the grid is clear, so
// that the outermost blocks, which are as they are marked, reach one block at most.
static void SpreadReach(pvtInsideTest* test)
{
    const int* blocks = test->blocks;
    for (int way = 1; way >= -1; way -= 2) {
        for (int k = 1; k < blocks[2] - 1; ++k) {
            const int z = way > 0 ? k : blocks[2] - 1 - k;
            for (int j = 1; j < blocks[1] - 1; ++j) {
                SpreadToRow(test, way > 0 ? j : blocks[1] - 1 - j, z, way);
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
    if (test->reach == NULL) {
        return pvtContext_GetStatus(context);
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
    return place != PVT_NO_CELLS && (pvtInsideTest_GetOpen(test, place) >> bit & 1) != 0;
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
