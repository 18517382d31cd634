// SPDX-License-Identifier: MIT
// Which part of the touched voxels is inside, at a quarter of their size.
//
// A surface takes up a layer of voxels, which is lost on all sides of a strict occluder, and where
// the parts of a model overlap within it as well. Cut into 4 × 4 × 4 cells, one word each, that
// layer is as thin as at four times the resolution, for the memory of a few grids. Two waves start
// at the same time, one from the outside voxels and one from the inside, and go through free cells,
// a cell a step. Where the surface is closed they never meet; at a crack that the voxels had closed
// they meet in it, so that it stays closed.
#include "bit_grid.h"
#include "cell_grid.h"

#include "base/context.h"

#include <string.h>

enum { SIDES = 6, CANCEL_INTERVAL = 1024, BLOCK = 256, MIN_LAYERS = 4 };

// What lies beyond a side of a touched voxel when it is not touched.
#define OUTSIDE UINT32_MAX
#define INSIDE (UINT32_MAX - 1)

static const uint64_t FIRST_X = UINT64_C(0x1111111111111111);
static const uint64_t FIRST_Y = UINT64_C(0x000F000F000F000F);

typedef struct Waves {
    uint64_t outside, inside;
} Waves;

typedef struct Shell {
    pvtContext* context;
    const pvtSolid* solid;
    const pvtCellGrid* touched;
    uint32_t (*neighbours)[SIDES]; // below and above along x, y, z
    Waves* waves;                  // cells that the waves have taken
    Waves* next;                   // and those that they take in this step
    uint8_t* woken;                // whether a voxel's cells may change in the next step
    uint8_t* wokenBlocks;          // whether any of BLOCK voxels is woken
    uint32_t* list;                // those that may in this step
    size_t listCount;
    uint64_t* allowed; // the outcome, where `next` was
    uint8_t* isOpen;   // whether a voxel is beside one in which the waves meet
    uint8_t* isMixed;  // whether it has cells of its own
} Shell;

// Several workers may mark the same.
static void Mark(uint8_t* flag)
{
    __atomic_store_n(flag, 1, __ATOMIC_RELAXED);
}

static void Wake(const Shell* shell, size_t voxel)
{
    Mark(&shell->woken[voxel]);
    Mark(&shell->wokenBlocks[voxel / BLOCK]);
}

// A row of voxels; null words for one beyond the grid.
typedef struct Row {
    const uint64_t *touched, *inside;
    const uint32_t* ranks;
    int size;
} Row;

static Row GetRowInGrid(const Shell* shell, int y, int z)
{
    const pvtBitGrid* voxels = &shell->touched->voxels;
    const size_t first = pvtGetRowIndex(voxels, y, z) * voxels->wordsPerRow;
    return (Row){voxels->words + first, shell->solid->inside.words + first,
                 shell->touched->ranks + first, voxels->frame.size[0]};
}

static Row GetRow(const Shell* shell, int y, int z)
{
    const int* size = shell->touched->voxels.frame.size;
    const bool isInGrid = y >= 0 && z >= 0 && y < size[1] && z < size[2];
    return isInGrid ? GetRowInGrid(shell, y, z) : (Row){0};
}

static uint32_t FindInRow(const Row* row, int x)
{
    if (x < 0 || x >= row->size) {
        return OUTSIDE;
    }
    const size_t word = (size_t)x / 64;
    const uint64_t bit = UINT64_C(1) << (x % 64);
    return (row->touched[word] & bit) != 0
               ? row->ranks[word] + (uint32_t)pvtCountBits(row->touched[word] & (bit - 1))
           : (row->inside[word] & bit) != 0 ? INSIDE
                                            : OUTSIDE;
}

static bool IsBesideWaves(const uint32_t neighbours[SIDES])
{
    bool isBeside = false;
    for (int side = 0; side < SIDES; ++side) {
        isBeside = isBeside || neighbours[side] >= INSIDE;
    }
    return isBeside;
}

// A touched voxel, and the rows around it with its own in the middle: (y, z) with y first.
typedef void VisitFcn(Shell* shell, const Row rows[9], int x, size_t index);

static inline void VisitRow(Shell* shell, int y, int z, VisitFcn* visit)
{
    const Row here = GetRowInGrid(shell, y, z);
    Row rows[9];
    for (int n = 0; n < 9; ++n) {
        rows[n] = GetRow(shell, y + n % 3 - 1, z + n / 3 - 1);
    }
    for (size_t w = 0; w < shell->touched->voxels.wordsPerRow; ++w) {
        size_t index = here.ranks[w];
        for (uint64_t bits = here.touched[w]; bits != 0; bits &= bits - 1, ++index) {
            visit(shell, rows, (int)(w * 64) + __builtin_ctzll(bits), index);
        }
    }
}

static inline void VisitLayer(Shell* shell, size_t z, VisitFcn* visit)
{
    for (int y = 0; y < shell->touched->voxels.frame.size[1]; ++y) {
        VisitRow(shell, y, (int)z, visit);
    }
}

static void ListVoxel(Shell* shell, const Row rows[9], int x, size_t index)
{
    const uint32_t neighbours[SIDES] = {FindInRow(&rows[4], x - 1), FindInRow(&rows[4], x + 1),
                                        FindInRow(&rows[3], x),     FindInRow(&rows[5], x),
                                        FindInRow(&rows[1], x),     FindInRow(&rows[7], x)};
    memcpy(shell->neighbours[index], neighbours, sizeof neighbours);
    if (IsBesideWaves(neighbours)) {
        Wake(shell, index);
    }
}

static void ListLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    for (size_t z = begin; z < end; ++z) {
        VisitLayer(taskData, z, ListVoxel);
    }
}

// The cells of a voxel that have one of these as a neighbour, across its side.
static uint64_t SpreadAcross(uint64_t cells, int side)
{
    switch (side) {
    case 0:
        return cells >> 3 & FIRST_X;
    case 1:
        return (cells & FIRST_X) << 3;
    case 2:
        return cells >> 12 & FIRST_Y;
    case 3:
        return (cells & FIRST_Y) << 12;
    case 4:
        return cells >> 48;
    default:
        return cells << 48;
    }
}

// Cells moved by one, away from a side, as far as they stay in the voxel.
static uint64_t MoveWithin(uint64_t cells, int side)
{
    switch (side) {
    case 0:
        return (cells & ~(FIRST_X << 3)) << 1;
    case 1:
        return (cells & ~FIRST_X) >> 1;
    case 2:
        return (cells & ~(FIRST_Y << 12)) << 4;
    case 3:
        return (cells & ~FIRST_Y) >> 4;
    case 4:
        return cells << 16;
    default:
        return cells >> 16;
    }
}

// Cells that have one of these as a neighbour within the voxel.
static uint64_t Spread(uint64_t cells)
{
    uint64_t near = 0;
    for (int side = 0; side < SIDES; ++side) {
        near |= MoveWithin(cells, side);
    }
    return near;
}

static Waves GetWaves(const Shell* shell, uint32_t voxel)
{
    return voxel < INSIDE ? shell->waves[voxel]
                          : (Waves){.outside = voxel == OUTSIDE ? ~UINT64_C(0) : 0,
                                    .inside = voxel == INSIDE ? ~UINT64_C(0) : 0};
}

// Where both come at once the outside goes first.
static void StepVoxels(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Shell* shell = taskData;
    for (size_t k = begin; k < end; ++k) {
        const size_t i = shell->list[k];
        const Waves here = shell->waves[i];
        const uint64_t free = ~shell->touched->cells[i] & ~here.outside & ~here.inside;
        Waves near = {0};
        if (free != 0) {
            near = (Waves){Spread(here.outside), Spread(here.inside)};
            for (int side = 0; side < SIDES; ++side) {
                const Waves there = GetWaves(shell, shell->neighbours[i][side]);
                near.outside |= SpreadAcross(there.outside, side);
                near.inside |= SpreadAcross(there.inside, side);
            }
        }
        shell->next[k].outside = free & near.outside;
        shell->next[k].inside = free & near.inside & ~near.outside;
    }
}

// While other workers take cells of theirs: then it is up to one step late, with cells too many.
static uint64_t GetFreeMeanwhile(const Shell* shell, size_t voxel)
{
    const Waves* waves = &shell->waves[voxel];
    return ~shell->touched->cells[voxel] & ~__atomic_load_n(&waves->outside, __ATOMIC_RELAXED) &
           ~__atomic_load_n(&waves->inside, __ATOMIC_RELAXED);
}

// Wakes the voxel and those beside it that have free cells next to these.
static void WakeAround(const Shell* shell, size_t voxel, uint64_t taken)
{
    if ((Spread(taken) & GetFreeMeanwhile(shell, voxel)) != 0) {
        Wake(shell, voxel);
    }
    for (int side = 0; side < SIDES; ++side) {
        const uint32_t beside = shell->neighbours[voxel][side];
        const uint64_t near = SpreadAcross(taken, side ^ 1);
        if (near != 0 && beside < INSIDE && (near & GetFreeMeanwhile(shell, beside)) != 0) {
            Wake(shell, beside);
        }
    }
}

static void TakeCells(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Shell* shell = taskData;
    for (size_t k = begin; k < end; ++k) {
        const size_t i = shell->list[k];
        const Waves next = shell->next[k];
        if ((next.outside | next.inside) == 0) {
            continue;
        }
        Waves* waves = &shell->waves[i];
        __atomic_store_n(&waves->outside, waves->outside | next.outside, __ATOMIC_RELAXED);
        __atomic_store_n(&waves->inside, waves->inside | next.inside, __ATOMIC_RELAXED);
        WakeAround(shell, i, next.outside | next.inside);
    }
}

static void ListWokenFrom(Shell* shell, size_t begin, size_t end)
{
    for (size_t i = begin; i < end; ++i) {
        if (shell->woken[i] != 0) {
            shell->woken[i] = 0;
            shell->list[shell->listCount++] = (uint32_t)i;
        }
    }
}

// Those that were woken. Mostly they are few, and far from each other.
static void ListWoken(Shell* shell)
{
    const size_t count = shell->touched->count;
    shell->listCount = 0;
    for (size_t block = 0; block * BLOCK < count; ++block) {
        if (shell->wokenBlocks[block] != 0) {
            shell->wokenBlocks[block] = 0;
            const size_t end = (block + 1) * BLOCK;
            ListWokenFrom(shell, block * BLOCK, end < count ? end : count);
        }
    }
}

static pvtStatus RunWaves(pvtContext* context, Shell* shell)
{
    for (ListWoken(shell); shell->listCount > 0; ListWoken(shell)) {
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        pvtParallelFor(context, StepVoxels, shell->listCount, CANCEL_INTERVAL, shell);
        pvtParallelFor(context, TakeCells, shell->listCount, CANCEL_INTERVAL, shell);
    }
    return PVT_OK;
}

// Adds the neighbours on both sides along an axis; the voxels below and above lend theirs.
static uint64_t Dilate(const uint64_t voxels[3], int axis)
{
    const int below = 2 * axis, above = 2 * axis + 1;
    return voxels[1] | MoveWithin(voxels[1], below) | SpreadAcross(voxels[0], below) |
           MoveWithin(voxels[1], above) | SpreadAcross(voxels[2], above);
}

// Of the voxels x − 1, x and x + 1 of a row, which cells are outside. Of voxels that are next to
// each other, the places are as well.
static void GetOutsideOfThree(const Shell* shell, const Row* row, int x, uint64_t outside[3])
{
    uint32_t place = FindInRow(row, x - 1);
    outside[0] = GetWaves(shell, place).outside;
    for (int i = 1; i < 3; ++i) {
        const int at = x + i - 1;
        const bool isNext = place < INSIDE && at < row->size && pvtGetBit(row->touched, (size_t)at);
        place = isNext ? place + 1 : FindInRow(row, at);
        outside[i] = GetWaves(shell, place).outside;
    }
}

// The voxel's cells that are outside or have an outside cell among their 26 neighbours. A plane
// touches no cell whose neighbours all lie on its inner side or on it.
static uint64_t FindCellsNearOutside(const Shell* shell, const Row rows[9], int x)
{
    uint64_t layers[3];
    for (int z = 0; z < 3; ++z) {
        uint64_t dilated[3];
        for (int y = 0; y < 3; ++y) {
            uint64_t cells[3];
            GetOutsideOfThree(shell, &rows[3 * z + y], x, cells);
            dilated[y] = Dilate(cells, 0);
        }
        layers[z] = Dilate(dilated, 1);
    }
    return Dilate(layers, 2);
}

static void JudgeVoxel(Shell* shell, const Row rows[9], int x, size_t index)
{
    shell->allowed[index] = ~FindCellsNearOutside(shell, rows, x);
}

static void JudgeLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Shell* shell = taskData;
    for (size_t z = begin; z < end && !pvtIsCancelled(shell->context); ++z) {
        VisitLayer(shell, z, JudgeVoxel);
    }
}

// Whether an outside cell of a voxel is next to one that is neither outside nor touched.
static bool DoWavesMeet(const Shell* shell, size_t voxel)
{
    const uint64_t outside = shell->waves[voxel].outside;
    const uint64_t within = ~shell->touched->cells[voxel] & ~outside;
    uint64_t near = Spread(within);
    uint64_t far = Spread(outside);
    for (int side = 0; side < SIDES; ++side) {
        const uint32_t beside = shell->neighbours[voxel][side];
        const uint64_t there = GetWaves(shell, beside).outside;
        const uint64_t free = beside < INSIDE ? ~shell->touched->cells[beside] : ~UINT64_C(0);
        near |= SpreadAcross(free & ~there, side);
        far |= SpreadAcross(there, side);
    }
    return ((outside & near) | (within & far)) != 0;
}

static void FindOpening(Shell* shell, const Row rows[9], int x, size_t index)
{
    const bool isOpen = DoWavesMeet(shell, index);
    for (int n = 0; n < 27 && isOpen; ++n) {
        const uint32_t beside = FindInRow(&rows[n / 3], x + n % 3 - 1);
        if (beside < INSIDE) {
            Mark(&shell->isOpen[beside]);
        }
    }
}

static void FindOpenings(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    for (size_t z = begin; z < end; ++z) {
        VisitLayer(taskData, z, FindOpening);
    }
}

// Not inside, but not outside either. Around an opening there is no border: one could walk around
// the edge of the surface there, to its other side.
static uint64_t GetBorder(const Shell* shell, size_t voxel)
{
    return shell->isOpen[voxel] != 0 ? 0 : ~shell->allowed[voxel] & ~shell->waves[voxel].outside;
}

// Whether anything beside a voxel is inside: else its border is that of a sheet.
static bool IsBesideInside(const Shell* shell, size_t voxel)
{
    for (int side = 0; side < SIDES; ++side) {
        const uint32_t neighbour = shell->neighbours[voxel][side];
        if (neighbour == INSIDE || (neighbour < INSIDE && shell->allowed[neighbour] != 0)) {
            return true;
        }
    }
    return false;
}

// Whether a voxel has cells of its own: it is neither inside nor outside as a whole.
static bool IsMixed(const Shell* shell, size_t voxel)
{
    return shell->allowed[voxel] == 0 ? GetBorder(shell, voxel) != 0 && IsBesideInside(shell, voxel)
                                      : shell->allowed[voxel] != ~UINT64_C(0);
}

static void FindMixed(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Shell* shell = taskData;
    for (size_t i = begin; i < end; ++i) {
        shell->isMixed[i] = IsMixed(shell, i) ? 1 : 0;
    }
}

static pvtStatus FindAllowedCells(pvtContext* context, Shell* shell)
{
    const size_t count = shell->touched->count;
    shell->neighbours = pvtAllocateUnset(context, count, sizeof *shell->neighbours);
    shell->waves = pvtAllocate(context, count, sizeof *shell->waves);
    shell->next = pvtAllocateUnset(context, count, sizeof *shell->next);
    shell->list = pvtAllocateUnset(context, count, sizeof *shell->list);
    shell->woken = pvtAllocate(context, count, sizeof *shell->woken);
    shell->wokenBlocks = pvtAllocate(context, count / BLOCK + 1, sizeof *shell->wokenBlocks);
    shell->isOpen = pvtAllocate(context, count, sizeof *shell->isOpen);
    shell->isMixed = pvtAllocateUnset(context, count, sizeof *shell->isMixed);
    if (shell->neighbours == NULL || shell->waves == NULL || shell->next == NULL ||
        shell->list == NULL || shell->woken == NULL || shell->wokenBlocks == NULL ||
        shell->isOpen == NULL || shell->isMixed == NULL) {
        return pvtContext_GetStatus(context);
    }
    const size_t layers = (size_t)shell->touched->voxels.frame.size[2];
    pvtParallelFor(context, ListLayers, layers, MIN_LAYERS, shell);
    const pvtStatus status = RunWaves(context, shell);
    if (status == PVT_OK) {
        shell->allowed = (uint64_t*)shell->next;
        pvtParallelFor(context, JudgeLayers, layers, MIN_LAYERS, shell);
        pvtParallelFor(context, FindOpenings, layers, MIN_LAYERS, shell);
        pvtParallelFor(context, FindMixed, count, CANCEL_INTERVAL, shell);
    }
    return status == PVT_OK && pvtIsCancelled(context) ? pvtFailCancelled(context) : status;
}

// Whole voxels become allowed; those with some cells are mixed.
static void SortBits(const Shell* shell, pvtBitGrid* allowed, pvtBitGrid* mixed)
{
    const pvtBitGrid* touched = &shell->touched->voxels;
    size_t index = 0;
    for (size_t w = 0; w < touched->wordCount; ++w) {
        for (uint64_t bits = touched->words[w]; bits != 0; bits &= bits - 1, ++index) {
            const uint64_t bit = bits & (~bits + 1);
            if (shell->isMixed[index] != 0) {
                mixed->words[w] |= bit;
            } else if (shell->allowed[index] != 0) {
                allowed->words[w] |= bit;
            }
        }
    }
}

// Whole voxels become allowed; those with some cells are kept with them.
static pvtStatus SortVoxels(pvtContext* context, const Shell* shell, pvtBitGrid* allowed,
                            pvtCellGrid* cells)
{
    pvtBitGrid mixed;
    if (pvtCreateBitGrid(context, &allowed->frame, &mixed) != PVT_OK) {
        return pvtContext_GetStatus(context);
    }
    SortBits(shell, allowed, &mixed);
    pvtStatus status = pvtCreateCellGrid(context, &mixed, cells);
    if (status == PVT_OK) {
        cells->border = pvtAllocate(context, cells->count, sizeof *cells->border);
        status = cells->border == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    }
    if (status != PVT_OK) {
        pvtCellGrid_Free(context, cells);
        return status;
    }
    // The shell's voxels are in the same order as those that are kept.
    size_t next = 0;
    for (size_t i = 0; i < shell->touched->count; ++i) {
        if (shell->isMixed[i] != 0) {
            cells->cells[next] = shell->allowed[i];
            cells->border[next++] = GetBorder(shell, i);
        }
    }
    return PVT_OK;
}

static void FreeShell(pvtContext* context, Shell* shell)
{
    pvtRelease(context, shell->neighbours);
    pvtRelease(context, shell->waves);
    pvtRelease(context, shell->next);
    pvtRelease(context, shell->list);
    pvtRelease(context, shell->woken);
    pvtRelease(context, shell->wokenBlocks);
    pvtRelease(context, shell->isOpen);
    pvtRelease(context, shell->isMixed);
}

pvtStatus pvtRefineAllowedGrid(pvtContext* context, const pvtMesh* mesh, const pvtSolid* solid,
                               pvtBitGrid* allowed, pvtCellGrid* cells)
{
    *cells = (pvtCellGrid){0};
    pvtBitGrid voxels;
    pvtStatus status = pvtCopyBitGrid(context, &solid->surface, &voxels);
    pvtCellGrid touched = {0};
    if (status == PVT_OK) {
        status = pvtCreateCellGrid(context, &voxels, &touched);
    }
    if (status == PVT_OK) {
        status = pvtVoxelizeCells(context, mesh, &touched);
    }
    Shell shell = {.context = context, .solid = solid, .touched = &touched};
    if (status == PVT_OK) {
        status = FindAllowedCells(context, &shell);
    }
    if (status == PVT_OK) {
        status = SortVoxels(context, &shell, allowed, cells);
    }
    FreeShell(context, &shell);
    pvtCellGrid_Free(context, &touched);
    return status;
}
