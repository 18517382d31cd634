// SPDX-License-Identifier: MIT
// Which part of the touched voxels is inside, at a quarter of their size.
//
// A surface takes up a layer of voxels, which is lost on all sides of a strict occluder, and where
// the parts of a model overlap within it as well. Cut into 4 × 4 × 4 cells, one word each, that
// layer is as thin as at four times the resolution, for the memory of a few grids. Two waves start
// at the same time, one from the outside voxels and one from the inside, and go through free cells,
// a cell a step (`waves.c`). Where the surface is closed they never meet; at a crack that the
// voxels had closed they meet in it, so that it stays closed.
#include "shell.h"

enum { MIN_LAYERS = 4 };

typedef struct Judge {
    pvtShell shell;
    uint64_t* allowed; // cells of touched voxels
    uint8_t* isOpen;   // whether a voxel is beside one in which the waves meet
    pvtBitGrid* whole; // voxels that are allowed as a whole
    pvtBitGrid mixed;  // voxels that have cells of their own
    pvtCellGrid* cells;
} Judge;

// Adds the neighbours on both sides along an axis; the voxels below and above lend theirs.
PVT_IN_CLONES uint64_t Dilate(const uint64_t voxels[3], int axis)
{
    const int below = 2 * axis, above = 2 * axis + 1;
    return voxels[1] | pvtMoveCells(voxels[1], below) | pvtSpreadAcross(voxels[0], below) |
           pvtMoveCells(voxels[1], above) | pvtSpreadAcross(voxels[2], above);
}

// Of the voxels x − 1, x and x + 1 of a row, which cells are outside. Of voxels that are next to
// each other, the places are as well.
PVT_IN_CLONES void GetOutsideOfThree(const pvtShell* shell, const pvtShellRow* row, int x,
                                     uint64_t outside[3])
{
    uint32_t place = pvtShellRow_Find(row, x - 1);
    outside[0] = pvtShell_GetWaves(shell, place).outside;
    for (int i = 1; i < 3; ++i) {
        const int at = x + i - 1;
        const bool isNext =
            place < PVT_INSIDE && at < row->size && pvtGetBit(row->touched, (size_t)at);
        place = isNext ? place + 1 : pvtShellRow_Find(row, at);
        outside[i] = pvtShell_GetWaves(shell, place).outside;
    }
}

// The voxel's cells that are outside or have an outside cell among their 26 neighbours. A plane
// touches no cell whose neighbours all lie on its inner side or on it.
PVT_IN_CLONES uint64_t FindCellsNearOutside(const pvtShell* shell,
                                            const pvtShellRow rows[PVT_SHELL_ROWS], int x)
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

// Whether an outside cell of a voxel is next to one that is neither outside nor touched.
PVT_IN_CLONES bool DoWavesMeet(const pvtShell* shell, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                               size_t place)
{
    const uint64_t outside = shell->waves[place].outside;
    const uint64_t within = ~shell->touched->cells[place] & ~outside;
    uint64_t near = pvtSpreadCells(within);
    uint64_t far = pvtSpreadCells(outside);
    for (int side = 0; side < PVT_SIDES; ++side) {
        const uint32_t beside = pvtFindBeside(rows, x, side);
        const uint64_t there = pvtShell_GetWaves(shell, beside).outside;
        const uint64_t free = beside < PVT_INSIDE ? ~shell->touched->cells[beside] : ~UINT64_C(0);
        near |= pvtSpreadAcross(free & ~there, side);
        far |= pvtSpreadAcross(there, side);
    }
    return ((outside & near) | (within & far)) != 0;
}

// Several workers may mark the same.
static void MarkOpen(const Judge* judge, const pvtShellRow rows[PVT_SHELL_ROWS], int x)
{
    for (int n = 0; n < 3 * PVT_SHELL_ROWS; ++n) {
        const uint32_t beside = pvtShellRow_Find(&rows[n / 3], x + n % 3 - 1);
        if (beside < PVT_INSIDE) {
            __atomic_store_n(&judge->isOpen[beside], 1, __ATOMIC_RELAXED);
        }
    }
}

PVT_IN_CLONES void JudgeVoxel(void* task, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                              size_t place)
{
    const Judge* judge = task;
    judge->allowed[place] = ~FindCellsNearOutside(&judge->shell, rows, x);
    if (DoWavesMeet(&judge->shell, rows, x, place)) {
        MarkOpen(judge, rows, x);
    }
}

PVT_VECTOR_CLONES
static void JudgeLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Judge* judge = taskData;
    pvtShell_VisitLayers(&judge->shell, begin, end, taskData, JudgeVoxel);
}

// Not inside, but not outside either. Around an opening there is no border: one could walk around
// the edge of the surface there, to its other side.
static uint64_t GetBorder(const Judge* judge, size_t place)
{
    return judge->isOpen[place] != 0 ? 0
                                     : ~judge->allowed[place] & ~judge->shell.waves[place].outside;
}

// Whether anything beside a voxel is inside: else its border is that of a sheet.
static bool IsBesideInside(const Judge* judge, const pvtShellRow rows[PVT_SHELL_ROWS], int x)
{
    for (int side = 0; side < PVT_SIDES; ++side) {
        const uint32_t beside = pvtFindBeside(rows, x, side);
        if (beside == PVT_INSIDE || (beside < PVT_INSIDE && judge->allowed[beside] != 0)) {
            return true;
        }
    }
    return false;
}

// Whether a voxel has cells of its own: it is neither inside nor outside as a whole.
static bool IsMixed(const Judge* judge, const pvtShellRow rows[PVT_SHELL_ROWS], int x, size_t place)
{
    return judge->allowed[place] == 0
               ? GetBorder(judge, place) != 0 && IsBesideInside(judge, rows, x)
               : judge->allowed[place] != ~UINT64_C(0);
}

// The bits of a voxel's row in another grid of the same frame.
static uint64_t* FindBits(const Judge* judge, const pvtShellRow rows[PVT_SHELL_ROWS],
                          const pvtBitGrid* grid)
{
    return grid->words + (rows[PVT_OWN_ROW].touched - judge->shell.touched->voxels.words);
}

static void SortVoxel(void* task, const pvtShellRow rows[PVT_SHELL_ROWS], int x, size_t place)
{
    const Judge* judge = task;
    if (IsMixed(judge, rows, x, place)) {
        pvtSetBit(FindBits(judge, rows, &judge->mixed), (size_t)x);
    } else if (judge->allowed[place] != 0) {
        pvtSetBit(FindBits(judge, rows, judge->whole), (size_t)x);
    }
}

static void SortLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Judge* judge = taskData;
    pvtShell_VisitLayers(&judge->shell, begin, end, taskData, SortVoxel);
}

static void KeepCells(void* task, const pvtShellRow rows[PVT_SHELL_ROWS], int x, size_t place)
{
    const Judge* judge = task;
    const pvtCellGrid* cells = judge->cells;
    const uint64_t* bits = FindBits(judge, rows, &cells->voxels);
    if (pvtGetBit(bits, (size_t)x)) {
        const size_t kept = pvtRankInRow(bits, cells->ranks + (bits - cells->voxels.words), x);
        cells->cells[kept] = judge->allowed[place];
        cells->border[kept] = GetBorder(judge, place);
    }
}

static void KeepLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Judge* judge = taskData;
    pvtShell_VisitLayers(&judge->shell, begin, end, taskData, KeepCells);
}

// Whole voxels become allowed; those with some cells are kept with them.
static pvtStatus SortVoxels(pvtContext* context, Judge* judge, size_t layers)
{
    const pvtGridFrame* frame = &judge->whole->frame;
    pvtStatus status = pvtCreateBitGrid(context, frame, &judge->mixed);
    if (status == PVT_OK) {
        pvtParallelFor(context, SortLayers, layers, MIN_LAYERS, judge);
        status = pvtCreateCellGrid(context, &judge->mixed, judge->cells);
    }
    if (status == PVT_OK) {
        pvtCellGrid* cells = judge->cells;
        cells->border = pvtAllocateUnset(context, cells->count, sizeof *cells->border);
        status = cells->border == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, KeepLayers, layers, MIN_LAYERS, judge);
    }
    return status;
}

static pvtStatus JudgeVoxels(pvtContext* context, Judge* judge)
{
    const pvtCellGrid* touched = judge->shell.touched;
    judge->shell.waves = pvtAllocateUnset(context, touched->count, sizeof *judge->shell.waves);
    if (judge->shell.waves == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtStatus status = pvtRunWaves(&judge->shell);
    if (status == PVT_OK) {
        judge->allowed = pvtAllocateUnset(context, touched->count, sizeof *judge->allowed);
        judge->isOpen = pvtAllocate(context, touched->count, sizeof *judge->isOpen);
        status = judge->allowed == NULL || judge->isOpen == NULL ? pvtContext_GetStatus(context)
                                                                 : PVT_OK;
    }
    const size_t layers = (size_t)touched->voxels.frame.size[2];
    if (status == PVT_OK) {
        pvtParallelFor(context, JudgeLayers, layers, MIN_LAYERS, judge);
        status = SortVoxels(context, judge, layers);
    }
    return status == PVT_OK && pvtIsCancelled(context) ? pvtFailCancelled(context) : status;
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
    Judge judge = {.shell = {.context = context, .touched = &touched, .inside = &solid->inside},
                   .whole = allowed,
                   .cells = cells};
    if (status == PVT_OK) {
        status = JudgeVoxels(context, &judge);
    }
    pvtRelease(context, judge.shell.waves);
    pvtRelease(context, judge.allowed);
    pvtRelease(context, judge.isOpen);
    pvtCellGrid_Free(context, &touched);
    if (status != PVT_OK) {
        pvtBitGrid_Free(context, &judge.mixed);
        pvtCellGrid_Free(context, cells);
    }
    return status;
}
