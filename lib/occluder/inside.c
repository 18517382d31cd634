// SPDX-License-Identifier: MIT
// A triangle is halved along its longest edge until the box around each piece lies in allowed
// voxels. Far from the border one look at a coarse grid of distances answers for a large piece; at
// the border pieces shrink to the size of cells. Nothing is shared with pvtCheckOccluder, which
// clips instead.
#include "inside.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"

#include <math.h>

enum {
    MAX_BLOCKS = 160, // along the longest side
    MIN_BLOCK = 4,    // [vx]; blocks are powers of two, so that one lies in one word of a row
    MAX_REACH = 255,
    MAX_CELL_BOX = 8, // [vx] along a side: larger ones seldom pass, unless they are flat
};

static const double LEAST_PIECE = 1.0 / 24.0; // [vx]
// Boxes are shrunk by this much, so that a face that lies between two voxels is in neither.
static const double SLACK = 1.0 / 8192.0; // [vx]

typedef struct Box {
    double low[3], high[3];
} Box;

// Voxels or cells, both ends included.
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

static size_t GetBlockIndex(const pvtInsideTest* test, int x, int y, int z)
{
    return ((size_t)z * (size_t)test->blocks[1] + (size_t)y) * (size_t)test->blocks[0] + (size_t)x;
}

static void MarkBlocks(pvtInsideTest* test)
{
    const int side = test->blockSize;
    for (int z = 0; z < test->blocks[2]; ++z) {
        for (int y = 0; y < test->blocks[1]; ++y) {
            for (int x = 0; x < test->blocks[0]; ++x) {
                const Range range = {{x * side, y * side, z * side},
                                     {(x + 1) * side - 1, (y + 1) * side - 1, (z + 1) * side - 1}};
                test->reach[GetBlockIndex(test, x, y, z)] =
                    AreVoxelsSet(test->allowed, &range) ? MAX_REACH : 0;
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
        const int reach = isIn ? test->reach[GetBlockIndex(test, x, y, z)] + 1 : 1;
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

pvtStatus pvtCreateInsideTest(pvtContext* context, const pvtBitGrid* allowed,
                              const pvtCellGrid* cells, pvtInsideTest* test)
{
    *test = (pvtInsideTest){.allowed = allowed,
                            .cells = cells != NULL && cells->count > 0 ? cells : NULL,
                            .blockSize = MIN_BLOCK};
    const int* size = allowed->frame.size;
    const int longest = size[0] > size[1] ? (size[0] > size[2] ? size[0] : size[2])
                                          : (size[1] > size[2] ? size[1] : size[2]);
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

// As floor and ceil, which are calls on machines without SSE 4.1.
static int RoundDown(double value)
{
    const int whole = (int)value;
    return whole - (value < whole ? 1 : 0);
}

static int RoundUp(double value)
{
    const int whole = (int)value;
    return whole + (value > whole ? 1 : 0);
}

static Range GetRange(const Box* box, double scale)
{
    Range range;
    for (int axis = 0; axis < 3; ++axis) {
        range.low[axis] = RoundDown((box->low[axis] + SLACK) * scale);
        const int high = RoundUp((box->high[axis] - SLACK) * scale) - 1;
        range.high[axis] = high > range.low[axis] ? high : range.low[axis];
    }
    return range;
}

// One look at the block in the middle of the box.
static bool IsDeepInside(const pvtInsideTest* test, const Box* box)
{
    int block[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double middle = 0.5 * (box->low[axis] + box->high[axis]) / test->blockSize;
        if (!(middle >= 0.0) || middle >= test->blocks[axis]) {
            return false;
        }
        block[axis] = (int)middle;
    }
    const int reach = test->reach[GetBlockIndex(test, block[0], block[1], block[2])];
    for (int axis = 0; axis < 3; ++axis) {
        if (box->low[axis] < (block[axis] - reach + 1) * test->blockSize ||
            box->high[axis] > (block[axis] + reach) * test->blockSize) {
            return false;
        }
    }
    return reach > 0;
}

// The part of a box that lies in a voxel with cells.
static bool AreCellsSet(uint64_t cells, const Range* range, const int voxel[3])
{
    int low[3];
    int high[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int first = PVT_CELLS * voxel[axis];
        low[axis] = range->low[axis] > first ? range->low[axis] - first : 0;
        high[axis] =
            range->high[axis] - first < PVT_CELLS - 1 ? range->high[axis] - first : PVT_CELLS - 1;
    }
    for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1]; ++y) {
            const int row = PVT_CELLS * (y + PVT_CELLS * z);
            const uint64_t mask =
                pvtMakeMask((unsigned)(row + low[0]), (unsigned)(row + high[0] + 1));
            if ((cells & mask) != mask) {
                return false;
            }
        }
    }
    return true;
}

static bool AreVoxelsOrCellsSet(const pvtInsideTest* test, const Box* box, const Range* voxels)
{
    const Range cells = GetRange(box, PVT_CELLS);
    for (int z = voxels->low[2]; z <= voxels->high[2]; ++z) {
        for (int y = voxels->low[1]; y <= voxels->high[1]; ++y) {
            for (int x = voxels->low[0]; x <= voxels->high[0]; ++x) {
                const int voxel[3] = {x, y, z};
                if (!pvtBitGrid_Get(test->allowed, x, y, z) &&
                    !AreCellsSet(pvtCellGrid_Get(test->cells, x, y, z), &cells, voxel)) {
                    return false;
                }
            }
        }
    }
    return true;
}

static bool IsBoxInside(const pvtInsideTest* test, const Box* box)
{
    if (IsDeepInside(test, box)) {
        return true;
    }
    const Range voxels = GetRange(box, 1.0);
    int longest = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int length = voxels.high[axis] - voxels.low[axis];
        longest = length > longest ? length : longest;
    }
    if (longest > 2 * test->blockSize) {
        return false;
    }
    return AreVoxelsSet(test->allowed, &voxels) || (longest < MAX_CELL_BOX && test->cells != NULL &&
                                                    AreVoxelsOrCellsSet(test, box, &voxels));
}

// A box that is flat and lies between two layers may be in either.
static bool IsBoxInsideFrom(const pvtInsideTest* test, Box box, int firstAxis)
{
    for (int axis = firstAxis; axis < 3; ++axis) {
        const double layer = RoundDown(box.low[axis] + 0.5);
        if (fabs(box.low[axis] - layer) <= SLACK && fabs(box.high[axis] - layer) <= SLACK) {
            box.low[axis] = box.high[axis] = layer - 2.0 * SLACK;
            if (IsBoxInsideFrom(test, box, axis + 1)) {
                return true;
            }
            box.low[axis] = box.high[axis] = layer + 2.0 * SLACK;
        }
    }
    return IsBoxInside(test, &box);
}

bool pvtInsideTest_HasPoint(const pvtInsideTest* test, pvtVec3 point)
{
    const Box box = {{point.x, point.y, point.z}, {point.x, point.y, point.z}};
    return IsBoxInsideFrom(test, box, 0);
}

static pvtVec3 GetMiddle(pvtVec3 a, pvtVec3 b)
{
    return pvtScale(pvtAdd(a, b), 0.5);
}

static Box GetBox(const pvtVec3 corners[3], double* side)
{
    Box box;
    *side = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = pvtGetAxis(corners[0], axis);
        const double b = pvtGetAxis(corners[1], axis);
        const double c = pvtGetAxis(corners[2], axis);
        // Compared here, since no corner is a NaN: fmin and fmax would be calls.
        const double low = a < b ? a : b, high = a < b ? b : a;
        box.low[axis] = low < c ? low : c;
        box.high[axis] = high > c ? high : c;
        const double length = box.high[axis] - box.low[axis];
        *side = length > *side ? length : *side;
    }
    return box;
}

// Its corners are inside.
static bool IsPieceInside(const pvtInsideTest* test, const pvtVec3 corners[3])
{
    double side;
    const Box box = GetBox(corners, &side);
    if (IsBoxInsideFrom(test, box, 0)) {
        return true;
    }
    if (side < LEAST_PIECE) {
        return false;
    }
    int longest = 0;
    double length = -1.0;
    for (int i = 0; i < 3; ++i) {
        const pvtVec3 edge = pvtSub(corners[(i + 1) % 3], corners[i]);
        if (pvtDot(edge, edge) > length) {
            length = pvtDot(edge, edge);
            longest = i;
        }
    }
    const pvtVec3 from = corners[longest];
    const pvtVec3 to = corners[(longest + 1) % 3];
    const pvtVec3 across = corners[(longest + 2) % 3];
    const pvtVec3 middle = GetMiddle(from, to);
    return pvtInsideTest_HasPoint(test, middle) &&
           IsPieceInside(test, (pvtVec3[3]){from, middle, across}) &&
           IsPieceInside(test, (pvtVec3[3]){middle, to, across});
}

bool pvtInsideTest_HasTriangle(const pvtInsideTest* test, const pvtVec3 corners[3])
{
    for (int i = 0; i < 3; ++i) {
        if (!pvtInsideTest_HasPoint(test, corners[i])) {
            return false;
        }
    }
    return IsPieceInside(test, corners);
}
