// SPDX-License-Identifier: MIT
// A triangle is halved along its longest edge until the box around each piece lies in voxels or
// cells that are not outside. Far from the border one look at a coarse grid of distances answers
// for a large piece; at the border pieces shrink to the size of cells. Voxels whose border cells a
// piece may enter are noted, and the surface in them is looked at last, triangle by triangle.
// Nothing is shared with pvtCheckOccluder, which clips instead.
#include "inside.h"
#include "crossing.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "voxel/bit_grid.h"
#include "voxel/cell_grid.h"

#include <math.h>
#include <string.h>

enum {
    MAX_BLOCKS = 160, // along the longest side
    MIN_BLOCK = 4,    // [vx]; blocks are powers of two, so that one lies in one word of a row
    MAX_REACH = 255,
    MAX_CELL_BOX = 8, // [vx] along a side: larger ones seldom pass, unless they are flat
};

static const double LEAST_PIECE = 1.0 / 24.0;  // [vx]
static const double CELL_MARGIN = 1.0 / 128.0; // [cells]
static const double SLAB_SIDE = 6.0;           // [vx] of pieces that are looked at as slabs
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

// Those that are not outside, of a voxel within the grid.
static uint64_t GetCells(const pvtInsideTest* test, const int voxel[3])
{
    const size_t index = pvtCellGrid_Find(test->interior.cells, voxel[0], voxel[1], voxel[2]);
    return index == PVT_NO_CELLS ? 0 : test->open[index];
}

static bool IsInGrid(const pvtInsideTest* test, const Range* voxels)
{
    const int* size = test->interior.allowed->frame.size;
    return voxels->low[0] >= 0 && voxels->low[1] >= 0 && voxels->low[2] >= 0 &&
           voxels->high[0] < size[0] && voxels->high[1] < size[1] && voxels->high[2] < size[2];
}

static bool AreVoxelsOrCellsSet(const pvtInsideTest* test, const Box* box, const Range* voxels)
{
    const Range cells = GetRange(box, PVT_CELLS);
    if (!IsInGrid(test, voxels)) {
        return false;
    }
    for (int z = voxels->low[2]; z <= voxels->high[2]; ++z) {
        for (int y = voxels->low[1]; y <= voxels->high[1]; ++y) {
            for (int x = voxels->low[0]; x <= voxels->high[0]; ++x) {
                const int voxel[3] = {x, y, z};
                if (!pvtBitGrid_Get(test->interior.allowed, x, y, z) &&
                    !AreCellsSet(GetCells(test, voxel), &cells, voxel)) {
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
    return AreVoxelsSet(test->interior.allowed, &voxels) ||
           (longest < MAX_CELL_BOX && test->interior.cells != NULL &&
            AreVoxelsOrCellsSet(test, box, &voxels));
}

// Whether a box is flat along an axis and lies between two layers.
static bool IsBetweenLayers(const Box* box, int axis, double* layer)
{
    *layer = RoundDown(box->low[axis] + 0.5);
    return fabs(box->low[axis] - *layer) <= SLACK && fabs(box->high[axis] - *layer) <= SLACK;
}

// A box between two layers may be in either.
static bool IsBoxInsideFrom(const pvtInsideTest* test, Box box, int firstAxis)
{
    double layer;
    for (int axis = firstAxis; axis < 3; ++axis) {
        if (IsBetweenLayers(&box, axis, &layer)) {
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

enum { MOST_NOTED = 2048, NOTED_SLOTS = 4096, SEEN_SLOTS = 2048, BINS = 64 };

// A triangle on its way through the test.
typedef struct Walk {
    const pvtInsideTest* test;
    const pvtVec3* corners;    // three
    pvtVec3 outside;           // where it is not inside
    bool isSomewhereAllowed;   // so that it began inside
    bool isInBorder;           // somewhere
    bool crosses;              // the surface: then it is not inside
    pvtVec3 normal;            // of its plane, unit
    double distance;           // of that from the origin
    double reach;              // of a voxel along the normal, from its middle
    uint64_t planeCells[BINS]; // of a voxel that the plane passes, by the height of its middle
    uint64_t knownBins;        // of these
    int notedCount;
    uint32_t noted[MOST_NOTED];  // voxels, by their place among those with cells
    uint32_t slots[NOTED_SLOTS]; // hash table of them: 1 + the voxel
} Walk;

// Each triangle of the surface once, as long as there are not very many.
static bool IsSeen(uint32_t* seen, int* count, uint32_t triangle)
{
    size_t slot = (triangle * (size_t)2654435761U) % SEEN_SLOTS;
    for (; seen[slot] != 0; slot = (slot + 1) % SEEN_SLOTS) {
        if (seen[slot] == triangle + 1) {
            return true;
        }
    }
    if (*count < SEEN_SLOTS / 2) {
        seen[slot] = triangle + 1;
        ++*count;
    }
    return false;
}

// Looks at the surface in the voxels that are noted, and forgets them.
static void FindCrossings(Walk* walk)
{
    const pvtTouching* touching = walk->test->interior.touching;
    const pvtCellGrid* cells = walk->test->interior.cells;
    uint32_t seen[SEEN_SLOTS] = {0};
    int seenCount = 0;
    for (int i = 0; i < walk->notedCount && !walk->crosses; ++i) {
        const uint32_t voxel = walk->noted[i];
        for (uint32_t k = touching->starts[voxel];
             k < touching->starts[voxel + 1] && !walk->crosses; ++k) {
            const uint32_t triangle = touching->triangles[k];
            if (IsSeen(seen, &seenCount, triangle)) {
                continue;
            }
            pvtVec3 surface[3], ends[2];
            pvtGetGridTriangle(&cells->voxels.frame, touching->mesh, triangle, surface);
            walk->crosses = pvtFindCrossing(walk->corners, surface, ends) &&
                            pvtPassesBorder(cells, ends, &walk->outside);
        }
    }
    walk->notedCount = 0;
    memset(walk->slots, 0, sizeof walk->slots);
}

// False when the triangle is found to cross the surface.
static bool NoteVoxel(Walk* walk, size_t voxel)
{
    if (walk->notedCount == MOST_NOTED) {
        FindCrossings(walk);
    }
    walk->isInBorder = true;
    size_t slot = (voxel * 2654435761U) % NOTED_SLOTS;
    for (; walk->slots[slot] != 0; slot = (slot + 1) % NOTED_SLOTS) {
        if (walk->slots[slot] == voxel + 1) {
            return true;
        }
    }
    walk->slots[slot] = (uint32_t)voxel + 1;
    walk->noted[walk->notedCount++] = (uint32_t)voxel;
    return !walk->crosses;
}

// The cells of a voxel that lie in the range.
static uint64_t GetCellsInRange(const Range* range, const int voxel[3])
{
    int low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = range->low[axis] - PVT_CELLS * voxel[axis];
        high[axis] = range->high[axis] - PVT_CELLS * voxel[axis];
        low[axis] = low[axis] > 0 ? low[axis] : 0;
        high[axis] = high[axis] < PVT_CELLS - 1 ? high[axis] : PVT_CELLS - 1;
    }
    uint64_t mask = 0;
    for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1] && low[0] <= high[0]; ++y) {
            const int row = PVT_CELLS * (y + PVT_CELLS * z);
            mask |= pvtMakeMask((unsigned)(row + low[0]), (unsigned)(row + high[0] + 1));
        }
    }
    return mask;
}

// The cells of a voxel that the triangle's plane passes within `slack`; `height` is its middle's
// above the plane.
static uint64_t FindCellsInPlane(const Walk* walk, double height, double slack)
{
    const pvtVec3 n = walk->normal;
    const double reach = walk->reach / PVT_CELLS + slack;
    uint64_t mask = 0;
    for (int row = 0; row < 16; ++row) {
        const double y = ((row & 3) - 1.5) / PVT_CELLS, z = ((row >> 2) - 1.5) / PVT_CELLS;
        const double start = height + n.y * y + n.z * z - 1.5 * n.x / PVT_CELLS;
        for (int x = 0; x < PVT_CELLS; ++x) {
            const double at = fabs(start + n.x * x / PVT_CELLS);
            mask |= (uint64_t)(at <= reach ? 1 : 0) << (4 * row + x);
        }
    }
    return mask;
}

// The same for all heights in a narrow bin, so that each is found once a triangle.
static uint64_t GetCellsInPlane(Walk* walk, double height)
{
    const double width = 2.0 * (walk->reach + SLACK) / BINS;
    int bin = (int)((height + walk->reach + SLACK) / width);
    bin = bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
    if ((walk->knownBins >> bin & 1) == 0) {
        const double middle = (bin + 0.5) * width - walk->reach - SLACK;
        walk->planeCells[bin] = FindCellsInPlane(walk, middle, SLACK + 0.5 * width);
        walk->knownBins |= UINT64_C(1) << bin;
    }
    return walk->planeCells[bin];
}

// Whether the plane keeps out of outside cells in a voxel; `height` is its middle's above the
// plane.
static bool IsVoxelInside(Walk* walk, const Range* cells, const int at[3], double height)
{
    const pvtInsideTest* test = walk->test;
    const pvtCellGrid* grid = test->interior.cells;
    const size_t voxel = grid != NULL ? pvtCellGrid_Find(grid, at[0], at[1], at[2]) : PVT_NO_CELLS;
    const uint64_t open = voxel != PVT_NO_CELLS ? test->open[voxel] : 0;
    const uint64_t passed = GetCellsInRange(cells, at) & GetCellsInPlane(walk, height);
    if ((passed & ~open) != 0) {
        return false;
    }
    return test->interior.touching == NULL || voxel == PVT_NO_CELLS ||
           (passed & grid->border[voxel]) == 0 || NoteVoxel(walk, voxel);
}

// The voxels of a row whose middles are so near to the plane that it may pass them; `start` is the
// height of the first of all.
static void FindPassed(const Walk* walk, double start, int* first, int* last)
{
    const double n = walk->normal.x, reach = walk->reach + 2.0 * SLACK;
    if (fabs(n) < 1e-3) {
        *last = fabs(start + n * *first) > reach + 1.0 ? *first - 1 : *last;
        return;
    }
    const double a = (-reach - start) / n, b = (reach - start) / n;
    const double low = a < b ? a : b, high = a < b ? b : a;
    *first = low > *first ? (low < *last ? RoundUp(low) : *last + 1) : *first;
    *last = high < *last ? (high > *first ? RoundDown(high) : *first - 1) : *last;
}

// Whether the plane keeps out of outside cells within a box of a few voxels. A plane that follows
// the border closely does, where boxes would have to be as small as cells.
static bool IsSlabInside(Walk* walk, const Box* box)
{
    const pvtBitGrid* allowed = walk->test->interior.allowed;
    const Range voxels = GetRange(box, 1.0), cells = GetRange(box, PVT_CELLS);
    if (!IsInGrid(walk->test, &voxels)) {
        return false;
    }
    for (int z = voxels.low[2]; z <= voxels.high[2]; ++z) {
        for (int y = voxels.low[1]; y <= voxels.high[1]; ++y) {
            const uint64_t* row = pvtBitGrid_GetRow(allowed, y, z);
            const double start =
                pvtDot(walk->normal, (pvtVec3){0.5, y + 0.5, z + 0.5}) - walk->distance;
            int first = voxels.low[0], last = voxels.high[0];
            FindPassed(walk, start, &first, &last);
            for (int x = first; x <= last; ++x) {
                if (!pvtGetBit(row, (size_t)x) &&
                    !IsVoxelInside(walk, &cells, (int[3]){x, y, z}, start + walk->normal.x * x)) {
                    return false;
                }
            }
        }
    }
    return true;
}

// Of a box that is not outside, the border cells that are to be looked at.
static bool NoteBox(Walk* walk, const Box* box)
{
    const pvtInterior* interior = &walk->test->interior;
    const Range voxels = GetRange(box, 1.0), cells = GetRange(box, PVT_CELLS);
    for (int z = voxels.low[2]; z <= voxels.high[2]; ++z) {
        for (int y = voxels.low[1]; y <= voxels.high[1]; ++y) {
            for (int x = voxels.low[0]; x <= voxels.high[0]; ++x) {
                const int at[3] = {x, y, z};
                const size_t voxel = pvtCellGrid_Find(interior->cells, x, y, z);
                if (voxel != PVT_NO_CELLS &&
                    (interior->cells->border[voxel] & GetCellsInRange(&cells, at)) != 0 &&
                    !NoteVoxel(walk, voxel)) {
                    return false;
                }
            }
        }
    }
    return true;
}

// Allowed, not only a border cell, and not so close to one that rounding could matter.
static bool IsPointAllowed(const pvtInsideTest* test, pvtVec3 point)
{
    int cell[3], voxel[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double at = PVT_CELLS * pvtGetAxis(point, axis);
        cell[axis] = RoundDown(at);
        voxel[axis] = cell[axis] >> 2;
        if (at - cell[axis] < CELL_MARGIN || at - cell[axis] > 1.0 - CELL_MARGIN) {
            return false;
        }
    }
    const int bit = (cell[0] & 3) + PVT_CELLS * ((cell[1] & 3) + PVT_CELLS * (cell[2] & 3));
    return pvtBitGrid_Get(test->interior.allowed, voxel[0], voxel[1], voxel[2]) ||
           (test->interior.cells != NULL &&
            (pvtCellGrid_Get(test->interior.cells, voxel[0], voxel[1], voxel[2]) >> bit & 1) != 0);
}

static void LookForAllowed(Walk* walk, pvtVec3 point)
{
    walk->isSomewhereAllowed = walk->isSomewhereAllowed || IsPointAllowed(walk->test, point);
}

// Its corners are not outside.
static bool IsPieceInside(Walk* walk, const pvtVec3 corners[3])
{
    const pvtInsideTest* test = walk->test;
    double side, layer;
    const Box box = GetBox(corners, &side);
    if (IsDeepInside(test, &box)) {
        walk->isSomewhereAllowed = true;
        return true;
    }
    if (side < SLAB_SIDE && IsSlabInside(walk, &box)) {
        return true;
    }
    if (walk->crosses) {
        return false;
    }
    // What leaves the inside as a slab does as a box, unless it may be moved between layers.
    const bool mayBeBox = side >= SLAB_SIDE || IsBetweenLayers(&box, 0, &layer) ||
                          IsBetweenLayers(&box, 1, &layer) || IsBetweenLayers(&box, 2, &layer);
    if (mayBeBox && IsBoxInsideFrom(test, box, 0)) {
        return test->interior.touching == NULL || test->interior.cells == NULL ||
               NoteBox(walk, &box);
    }
    walk->outside = corners[0];
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
    walk->outside = middle;
    LookForAllowed(walk, middle);
    return pvtInsideTest_HasPoint(test, middle) &&
           IsPieceInside(walk, (pvtVec3[3]){from, middle, across}) &&
           IsPieceInside(walk, (pvtVec3[3]){middle, to, across});
}

bool pvtInsideTest_FindOutside(const pvtInsideTest* test, const pvtVec3 corners[3],
                               pvtVec3* outside)
{
    Walk walk;
    walk.test = test;
    walk.corners = corners;
    walk.isSomewhereAllowed = walk.isInBorder = walk.crosses = false;
    walk.notedCount = 0;
    walk.knownBins = 0;
    memset(walk.slots, 0, sizeof walk.slots);
    walk.normal =
        pvtNormalize(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])));
    walk.distance = pvtDot(walk.normal, corners[0]);
    walk.reach = 0.5 * (fabs(walk.normal.x) + fabs(walk.normal.y) + fabs(walk.normal.z));
    LookForAllowed(&walk, pvtScale(pvtAdd(corners[0], pvtAdd(corners[1], corners[2])), 1.0 / 3.0));
    bool isInside = true;
    for (int i = 0; i < 3 && isInside; ++i) {
        walk.outside = corners[i];
        LookForAllowed(&walk, corners[i]);
        isInside = pvtInsideTest_HasPoint(test, corners[i]);
    }
    if (isInside) {
        isInside = IsPieceInside(&walk, corners);
    }
    if (isInside && walk.isInBorder) {
        if (walk.isSomewhereAllowed) {
            FindCrossings(&walk);
        } else {
            walk.outside = corners[0];
        }
        isInside = walk.isSomewhereAllowed && !walk.crosses;
    }
    *outside = walk.outside;
    return isInside;
}

bool pvtInsideTest_HasTriangle(const pvtInsideTest* test, const pvtVec3 corners[3])
{
    pvtVec3 outside;
    return pvtInsideTest_FindOutside(test, corners, &outside);
}
