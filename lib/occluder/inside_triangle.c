// SPDX-License-Identifier: MIT
// A triangle is halved along its longest edge until one look at a coarse grid of distances tells
// that a piece is inside, or until pieces are small. These are cut into rows of voxels (rows.c), of
// which whole words are looked at. In voxels at the border the plane's cells are looked at, and
// where these do not settle it, those of the piece itself, exactly. Voxels whose border cells it
// enters are noted, and the surface in them is looked at last, triangle by triangle.
// Nothing is shared with pvtCheckOccluder, which clips instead.
#include "crossing.h"
#include "inside.h"
#include "rows.h"

#include "base/bits.h"
#include "base/vector.h"
#include "voxel/bit_grid.h"
#include "voxel/cell_grid.h"

#include <math.h>
#include <string.h>

enum {
    MOST_ROWS = 20, // of voxels that a piece is cut into
    MOST_NOTED = 2048,
    NOTED_SLOTS = 4096,
    SEEN_SLOTS = 2048,
    BINS = 64,
    LAST_CELL = PVT_CELLS - 1
};

static const double PIECE_SIDE = MOST_ROWS - 3.0; // [vx] below which pieces are cut into rows
static const double FLAT_SIDE = 2.0;              // [vx] to which flat ones are halved
static const double CELL_MARGIN = 1.0 / 128.0;    // [cells]

typedef struct Box {
    double low[3], high[3];
} Box;

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

// Of the places where the triangle crosses the surface within a voxel the first in space, so that
// the order of the mesh's triangles does not matter.
static void FindCrossingsInVoxel(Walk* walk, uint32_t voxel, uint32_t* seen, int* seenCount)
{
    const pvtTouching* touching = walk->test->interior.touching;
    const pvtCellGrid* cells = walk->test->interior.cells;
    for (uint32_t k = touching->starts[voxel]; k < touching->starts[voxel + 1]; ++k) {
        const uint32_t triangle = touching->triangles[k];
        if (IsSeen(seen, seenCount, triangle)) {
            continue;
        }
        pvtVec3 surface[3], ends[2], place;
        pvtGetGridTriangle(&cells->voxels.frame, touching->mesh, triangle, surface);
        if (pvtFindCrossing(walk->corners, surface, ends) && pvtPassesBorder(cells, ends, &place)) {
            walk->outside =
                walk->crosses && !pvtIsBefore(place, walk->outside) ? walk->outside : place;
            walk->crosses = true;
        }
    }
}

// Looks at the surface in the voxels that are noted, and forgets them.
static void FindCrossings(Walk* walk)
{
    uint32_t seen[SEEN_SLOTS] = {0};
    int seenCount = 0;
    for (int i = 0; i < walk->notedCount && !walk->crosses; ++i) {
        FindCrossingsInVoxel(walk, walk->noted[i], seen, &seenCount);
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
    const double width = 2.0 * (walk->reach + PVT_INSIDE_SLACK) / BINS;
    int bin = (int)((height + walk->reach + PVT_INSIDE_SLACK) / width);
    bin = bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
    if ((walk->knownBins >> bin & 1) == 0) {
        const double middle = (bin + 0.5) * width - walk->reach - PVT_INSIDE_SLACK;
        walk->planeCells[bin] = FindCellsInPlane(walk, middle, PVT_INSIDE_SLACK + 0.5 * width);
        walk->knownBins |= UINT64_C(1) << bin;
    }
    return walk->planeCells[bin];
}

// The cells of a piece in one layer of voxels, as long as that is the one that is looked at.
typedef struct PieceCells {
    const pvtVec3* corners; // of the piece
    int layer;              // of voxels; −1: none
    pvtRows rows[PVT_CELLS];
    pvtRowSpan spans[PVT_CELLS][PVT_CELLS * MOST_ROWS];
} PieceCells;

static void CutCells(PieceCells* piece, int layer)
{
    const pvtRowCutter cutter =
        pvtStartRows(piece->corners, PVT_CELLS, PVT_CELLS * PVT_INSIDE_SLACK);
    for (int i = 0; i < PVT_CELLS; ++i) {
        const int at = PVT_CELLS * layer + i;
        pvtRows* rows = &piece->rows[i];
        *rows = (pvtRows){.spans = piece->spans[i], .first = 0, .last = -1};
        if (at >= cutter.firstLayer && at <= cutter.lastLayer) {
            pvtCutLayer(&cutter, at, rows);
        }
    }
    piece->layer = layer;
}

// The cells of a voxel that the piece passes.
static uint64_t GetCellsOfPiece(PieceCells* piece, const int voxel[3])
{
    if (piece->layer != voxel[2]) {
        CutCells(piece, voxel[2]);
    }
    uint64_t mask = 0;
    for (int row = 0; row < PVT_CELLS * PVT_CELLS; ++row) {
        const pvtRows* rows = &piece->rows[row / PVT_CELLS];
        const int y = PVT_CELLS * voxel[1] + row % PVT_CELLS;
        if (y < rows->first || y > rows->last) {
            continue;
        }
        int first, last;
        pvtRows_GetVoxels(rows, y, &first, &last);
        first -= PVT_CELLS * voxel[0];
        last -= PVT_CELLS * voxel[0];
        if (first < PVT_CELLS && last >= 0) {
            const unsigned end = (unsigned)(last < LAST_CELL ? last : LAST_CELL) + 1;
            mask |= pvtMakeMask((unsigned)(first > 0 ? first : 0), end) << (PVT_CELLS * row);
        }
    }
    return mask;
}

// The middle of the lowest of some cells of a voxel, moved into the triangle's plane.
static pvtVec3 GetPlace(const Walk* walk, const int voxel[3], uint64_t cells)
{
    const int cell = __builtin_ctzll(cells);
    const int row = cell / PVT_CELLS, layer = row / PVT_CELLS;
    const pvtVec3 middle = {voxel[0] + (cell % PVT_CELLS + 0.5) / PVT_CELLS,
                            voxel[1] + (row % PVT_CELLS + 0.5) / PVT_CELLS,
                            voxel[2] + (layer + 0.5) / PVT_CELLS};
    const double height = pvtDot(walk->normal, middle) - walk->distance;
    return pvtSub(middle, pvtScale(walk->normal, height));
}

// Of a voxel that is not allowed as a whole, whether the piece passes no outside cell.
static bool IsVoxelInside(Walk* walk, PieceCells* piece, const int voxel[3])
{
    const pvtInsideTest* test = walk->test;
    const pvtCellGrid* grid = test->interior.cells;
    const size_t place =
        grid != NULL ? pvtCellGrid_Find(grid, voxel[0], voxel[1], voxel[2]) : PVT_NO_CELLS;
    const uint64_t open = place != PVT_NO_CELLS ? pvtInsideTest_GetOpen(test, place) : 0;
    const pvtVec3 middle = {voxel[0] + 0.5, voxel[1] + 0.5, voxel[2] + 0.5};
    uint64_t passed = GetCellsInPlane(walk, pvtDot(walk->normal, middle) - walk->distance);
    if ((passed & ~open) != 0) {
        passed = GetCellsOfPiece(piece, voxel);
    }
    if ((passed & ~open) != 0) {
        walk->outside = GetPlace(walk, voxel, passed & ~open);
        return false;
    }
    const bool isInBorder = test->interior.touching != NULL && place != PVT_NO_CELLS &&
                            (passed & grid->border[place]) != 0;
    walk->isSomewhereAllowed = walk->isSomewhereAllowed || (passed != 0 && !isInBorder);
    return !isInBorder || NoteVoxel(walk, place);
}

// The voxels of a row from `first` to `last`.
static bool IsRowInside(Walk* walk, PieceCells* piece, int y, int z, int first, int last)
{
    const uint64_t* row = pvtBitGrid_GetRow(walk->test->interior.allowed, y, z);
    for (int word = first / 64; word <= last / 64; ++word) {
        const int from = first - 64 * word, to = last - 64 * word;
        const uint64_t mask =
            pvtMakeMask((unsigned)(from > 0 ? from : 0), (unsigned)(to < 63 ? to + 1 : 64));
        walk->isSomewhereAllowed = walk->isSomewhereAllowed || (row[word] & mask) != 0;
        for (uint64_t left = mask & ~row[word]; left != 0; left &= left - 1) {
            const int voxel[3] = {64 * word + __builtin_ctzll(left), y, z};
            if (!IsVoxelInside(walk, piece, voxel)) {
                return false;
            }
        }
    }
    return true;
}

static bool AreRowsInside(Walk* walk, const pvtVec3 corners[3])
{
    pvtRowSpan spans[MOST_ROWS];
    pvtRows rows = {.spans = spans};
    PieceCells piece;
    piece.corners = corners;
    piece.layer = -1;
    const pvtRowCutter cutter = pvtStartRows(corners, 1.0, PVT_INSIDE_SLACK);
    for (int z = cutter.firstLayer; z <= cutter.lastLayer; ++z) {
        pvtCutLayer(&cutter, z, &rows);
        for (int y = rows.first; y <= rows.last; ++y) {
            int first, last;
            pvtRows_GetVoxels(&rows, y, &first, &last);
            if (!IsRowInside(walk, &piece, y, z, first, last)) {
                return false;
            }
        }
    }
    return true;
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
    const int reach = test->reach[pvtInsideTest_GetBlock(test, block[0], block[1], block[2])];
    for (int axis = 0; axis < 3; ++axis) {
        if (box->low[axis] < (block[axis] - reach + 1) * test->blockSize ||
            box->high[axis] > (block[axis] + reach) * test->blockSize) {
            return false;
        }
    }
    return reach > 0;
}

// Whether a box is flat along an axis and lies between two layers.
static bool IsBetweenLayers(const Box* box, int axis, double* layer)
{
    *layer = floor(box->low[axis] + 0.5);
    return fabs(box->low[axis] - *layer) <= PVT_INSIDE_SLACK &&
           fabs(box->high[axis] - *layer) <= PVT_INSIDE_SLACK;
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

// Allowed, not only a border cell, and not so close to one that rounding could matter.
static bool IsPointAllowed(const pvtInsideTest* test, pvtVec3 point)
{
    int cell[3], voxel[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double at = PVT_CELLS * pvtGetAxis(point, axis);
        cell[axis] = (int)at; // not below 0
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

// A piece that is flat along an axis and lies between two layers may be in either.
static bool IsFlatInside(Walk* walk, const pvtVec3 corners[3], const Box* box, int firstAxis)
{
    double layer;
    for (int axis = firstAxis; axis < 3; ++axis) {
        if (IsBetweenLayers(box, axis, &layer)) {
            for (int side = -1; side <= 1; side += 2) {
                pvtVec3 moved[3];
                memcpy(moved, corners, sizeof moved);
                for (int k = 0; k < 3; ++k) {
                    pvtSetAxis(&moved[k], axis, layer + 2.0 * side * PVT_INSIDE_SLACK);
                }
                if (IsFlatInside(walk, moved, box, axis + 1)) {
                    return true;
                }
            }
            return false;
        }
    }
    return AreRowsInside(walk, corners);
}

static bool IsPieceInside(Walk* walk, const pvtVec3 corners[3]);

static bool AreHalvesInside(Walk* walk, const pvtVec3 corners[3])
{
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
    const pvtVec3 middle = pvtScale(pvtAdd(from, to), 0.5);
    walk->outside = middle;
    LookForAllowed(walk, middle);
    return pvtInsideTest_HasPoint(walk->test, middle) &&
           IsPieceInside(walk, (pvtVec3[3]){from, middle, across}) &&
           IsPieceInside(walk, (pvtVec3[3]){middle, to, across});
}

// Its corners are not outside.
static bool IsPieceInside(Walk* walk, const pvtVec3 corners[3])
{
    double side, layer;
    const Box box = GetBox(corners, &side);
    if (IsDeepInside(walk->test, &box)) {
        walk->isSomewhereAllowed = true;
        return true;
    }
    if (side > PIECE_SIDE) {
        return AreHalvesInside(walk, corners);
    }
    if (!IsBetweenLayers(&box, 0, &layer) && !IsBetweenLayers(&box, 1, &layer) &&
        !IsBetweenLayers(&box, 2, &layer)) {
        return AreRowsInside(walk, corners);
    }
    return IsFlatInside(walk, corners, &box, 0) ||
           (side > FLAT_SIDE && !walk->crosses && AreHalvesInside(walk, corners));
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
    bool isInside = true;
    for (int i = 0; i < 3 && isInside; ++i) {
        walk.outside = corners[i];
        isInside = pvtInsideTest_HasPoint(test, corners[i]);
    }
    if (isInside) {
        LookForAllowed(&walk,
                       pvtScale(pvtAdd(corners[0], pvtAdd(corners[1], corners[2])), 1.0 / 3.0));
        for (int i = 0; i < 3; ++i) {
            LookForAllowed(&walk, corners[i]);
        }
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
