// SPDX-License-Identifier: MIT
// Two waves through the free cells of touched voxels, one from the voxels outside and one from
// those inside, a cell a step; where both come at once the outside goes first. Each step looks at
// all before any is taken, so that the outcome depends on no order.
#include "shell.h"

enum {
    FULL_STEPS = 2, // after which most voxels are done
    BLOCK = 64,
    MIN_WORDS = 128,
    MIN_LAYERS = 4
};

// Voxels of one word that may take cells in this step.
typedef struct Woken {
    uint64_t bits;
    uint32_t word;
    uint32_t first; // where what the first of them takes is kept; the others follow
} Woken;

typedef struct Race {
    pvtShell* shell;
    uint64_t* woken;      // a bit a voxel: whether it may take cells in the next step
    uint8_t* wokenBlocks; // whether there is one in BLOCK words
    Woken* list;          // those of this step
    size_t listCount;     // [words]
    pvtWaves* next;       // what they take; in a step of all, what all have then
} Race;

// Several workers may wake the same voxel.
PVT_IN_CLONES void Wake(const Race* race, const pvtShellRow* row, int x)
{
    const pvtBitGrid* voxels = &race->shell->touched->voxels;
    const size_t word = (size_t)(row->touched - voxels->words) + (size_t)x / 64;
    const uint64_t bit = UINT64_C(1) << (x % 64);
    if ((__atomic_load_n(&race->woken[word], __ATOMIC_RELAXED) & bit) == 0) {
        __atomic_fetch_or(&race->woken[word], bit, __ATOMIC_RELAXED);
        __atomic_store_n(&race->wokenBlocks[word / BLOCK], 1, __ATOMIC_RELAXED);
    }
}

// What comes to a voxel's free cells across a side.
static void AddComing(pvtWaves* coming, pvtWaves there, int side)
{
    coming->outside |= pvtSpreadAcross(there.outside, side);
    coming->inside |= pvtSpreadAcross(there.inside, side);
}

static pvtWaves Limit(pvtWaves near, uint64_t free)
{
    return (pvtWaves){free & near.outside, free & near.inside & ~near.outside};
}

// The first step, before any touched voxel has waves.
PVT_IN_CLONES void StartVoxel(void* task, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                              size_t place)
{
    const Race* race = task;
    pvtWaves coming = {0};
    for (int side = 0; side < PVT_SIDES; ++side) {
        const pvtShellRow* row = &rows[pvtShellSides[side].row];
        const int beside = x + pvtShellSides[side].step;
        if (!pvtShellRow_IsTouched(row, beside)) {
            AddComing(&coming, pvtShell_GetWaves(race->shell, pvtShellRow_Find(row, beside)), side);
        }
    }
    race->shell->waves[place] = Limit(coming, ~race->shell->touched->cells[place]);
}

PVT_VECTOR_CLONES
static void StartLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Race* race = taskData;
    pvtShell_VisitLayers(race->shell, begin, end, taskData, StartVoxel);
}

PVT_IN_CLONES void AddFromSide(const pvtShell* shell, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                               int side, uint64_t free, pvtWaves* near)
{
    if ((free & pvtSpreadAcross(~UINT64_C(0), side)) != 0) {
        AddComing(near, pvtShell_GetWaves(shell, pvtFindBeside(rows, x, side)), side);
    }
}

PVT_IN_CLONES pvtWaves FindStep(const pvtShell* shell, const pvtShellRow rows[PVT_SHELL_ROWS],
                                int x, size_t place)
{
    const pvtWaves here = shell->waves[place];
    const uint64_t free = ~shell->touched->cells[place] & ~here.outside & ~here.inside;
    if (free == 0) {
        return (pvtWaves){0};
    }
    pvtWaves near = {pvtSpreadCells(here.outside), pvtSpreadCells(here.inside)};
    PVT_UNROLL
    for (int side = 0; side < PVT_SIDES; ++side) {
        AddFromSide(shell, rows, x, side, free, &near);
    }
    return Limit(near, free);
}

static bool IsNone(pvtWaves waves)
{
    return (waves.outside | waves.inside) == 0;
}

// A step of all voxels, from one set of waves to another: next to nobody is asleep yet.
PVT_IN_CLONES void MoveVoxel(void* task, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                             size_t place)
{
    const Race* race = task;
    const pvtWaves here = race->shell->waves[place];
    const pvtWaves step = FindStep(race->shell, rows, x, place);
    race->next[place] = (pvtWaves){here.outside | step.outside, here.inside | step.inside};
}

PVT_VECTOR_CLONES
static void MoveLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Race* race = taskData;
    pvtShell_VisitLayers(race->shell, begin, end, taskData, MoveVoxel);
}

PVT_IN_CLONES void WakeVoxel(void* task, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                             size_t place)
{
    const Race* race = task;
    if (!IsNone(FindStep(race->shell, rows, x, place))) {
        Wake(race, &rows[PVT_OWN_ROW], x);
    }
}

PVT_VECTOR_CLONES
static void WakeLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Race* race = taskData;
    pvtShell_VisitLayers(race->shell, begin, end, taskData, WakeVoxel);
}

typedef void VisitWokenFcn(const Race* race, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                           size_t place, pvtWaves* next);

PVT_IN_CLONES void VisitWoken(const Race* race, size_t begin, size_t end, VisitWokenFcn* visit)
{
    const pvtBitGrid* voxels = &race->shell->touched->voxels;
    const size_t height = (size_t)voxels->frame.size[1];
    for (size_t k = begin; k < end; ++k) {
        const Woken* here = &race->list[k];
        const size_t row = here->word / voxels->wordsPerRow;
        const int x = (int)(here->word % voxels->wordsPerRow * 64);
        pvtShellRow rows[PVT_SHELL_ROWS];
        pvtShell_GetRows(race->shell, (int)(row % height), (int)(row / height), rows);
        pvtWaves* next = race->next + here->first;
        for (uint64_t bits = here->bits; bits != 0; bits &= bits - 1, ++next) {
            const int at = x + __builtin_ctzll(bits);
            visit(race, rows, at, pvtShellRow_Find(&rows[PVT_OWN_ROW], at), next);
        }
    }
}

PVT_IN_CLONES void StepVoxel(const Race* race, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                             size_t place, pvtWaves* next)
{
    *next = FindStep(race->shell, rows, x, place);
}

PVT_VECTOR_CLONES
static void StepVoxels(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    VisitWoken(taskData, begin, end, StepVoxel);
}

// While other workers take cells of theirs: then it is up to one step late, with cells too many.
PVT_IN_CLONES uint64_t GetFreeMeanwhile(const pvtShell* shell, size_t place)
{
    const pvtWaves* waves = &shell->waves[place];
    return ~shell->touched->cells[place] & ~__atomic_load_n(&waves->outside, __ATOMIC_RELAXED) &
           ~__atomic_load_n(&waves->inside, __ATOMIC_RELAXED);
}

PVT_IN_CLONES void WakeBeside(const Race* race, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                              uint64_t taken, int side)
{
    const uint64_t near = pvtSpreadAcross(taken, side ^ 1);
    const uint32_t beside = near != 0 ? pvtFindBeside(rows, x, side) : PVT_OUTSIDE;
    if (beside < PVT_INSIDE && (near & GetFreeMeanwhile(race->shell, beside)) != 0) {
        Wake(race, &rows[pvtShellSides[side].row], x + pvtShellSides[side].step);
    }
}

// Takes the cells, and wakes the voxel and those beside it that have free ones next to them.
PVT_IN_CLONES void TakeCells(const Race* race, const pvtShellRow rows[PVT_SHELL_ROWS], int x,
                             size_t place, pvtWaves* next)
{
    if (IsNone(*next)) {
        return;
    }
    const pvtShell* shell = race->shell;
    pvtWaves* waves = &shell->waves[place];
    __atomic_store_n(&waves->outside, waves->outside | next->outside, __ATOMIC_RELAXED);
    __atomic_store_n(&waves->inside, waves->inside | next->inside, __ATOMIC_RELAXED);
    const uint64_t taken = next->outside | next->inside;
    if ((pvtSpreadCells(taken) & GetFreeMeanwhile(shell, place)) != 0) {
        Wake(race, &rows[PVT_OWN_ROW], x);
    }
    PVT_UNROLL
    for (int side = 0; side < PVT_SIDES; ++side) {
        WakeBeside(race, rows, x, taken, side);
    }
}

PVT_VECTOR_CLONES
static void TakeVoxels(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    VisitWoken(taskData, begin, end, TakeCells);
}

// Those that were woken. Mostly they are few, and far from each other.
static void ListWoken(Race* race)
{
    const size_t count = race->shell->touched->voxels.wordCount;
    uint32_t voxels = 0;
    race->listCount = 0;
    for (size_t block = 0; block * BLOCK < count; ++block) {
        const size_t end = (block + 1) * BLOCK < count ? (block + 1) * BLOCK : count;
        for (size_t word = block * BLOCK; race->wokenBlocks[block] != 0 && word < end; ++word) {
            if (race->woken[word] != 0) {
                race->list[race->listCount++] = (Woken){race->woken[word], (uint32_t)word, voxels};
                voxels += (uint32_t)pvtCountBits(race->woken[word]);
                race->woken[word] = 0;
            }
        }
        race->wokenBlocks[block] = 0;
    }
}

static pvtStatus Run(pvtContext* context, Race* race)
{
    const size_t layers = (size_t)race->shell->touched->voxels.frame.size[2];
    pvtParallelFor(context, StartLayers, layers, MIN_LAYERS, race);
    for (int i = 0; i < FULL_STEPS; ++i) {
        pvtParallelFor(context, MoveLayers, layers, MIN_LAYERS, race);
        pvtWaves* const waves = race->shell->waves;
        race->shell->waves = race->next;
        race->next = waves;
    }
    pvtParallelFor(context, WakeLayers, layers, MIN_LAYERS, race);
    for (ListWoken(race); race->listCount > 0 && !pvtIsCancelled(context); ListWoken(race)) {
        pvtParallelFor(context, StepVoxels, race->listCount, MIN_WORDS, race);
        pvtParallelFor(context, TakeVoxels, race->listCount, MIN_WORDS, race);
    }
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
}

pvtStatus pvtRunWaves(pvtShell* shell)
{
    pvtContext* context = shell->context;
    const pvtCellGrid* touched = shell->touched;
    const size_t words = touched->voxels.wordCount;
    Race race = {.shell = shell};
    race.woken = pvtAllocate(context, words, sizeof *race.woken);
    race.wokenBlocks = pvtAllocate(context, words / BLOCK + 1, sizeof *race.wokenBlocks);
    race.list = pvtAllocateUnset(context, words, sizeof *race.list);
    race.next = pvtAllocateUnset(context, touched->count, sizeof *race.next);
    pvtStatus status = pvtContext_GetStatus(context);
    if (race.woken != NULL && race.wokenBlocks != NULL && race.list != NULL && race.next != NULL) {
        status = Run(context, &race);
    }
    pvtRelease(context, race.woken);
    pvtRelease(context, race.wokenBlocks);
    pvtRelease(context, race.list);
    pvtRelease(context, race.next);
    return status;
}
