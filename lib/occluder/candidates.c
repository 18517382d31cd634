// SPDX-License-Identifier: MIT
// From planes to chains of polygons (Silvennoinen et al., Occluder Simplification using Planar
// Sections, 2014, sections 4.3 and 4.4). Where the paper simplifies contours first and lets them
// stray by a voxel, the strict way leaves the contours as they are: chains shorten the staircases
// themselves, without ever leaving the slice.
#include "base/context.h"

#include <paravent/occluder.h>
#include <string.h>

enum { BATCH = 64 }; // sections whose bitmaps are held at once

pvtCandidateOptions pvtDefaultCandidateOptions(void)
{
    return (pvtCandidateOptions){
        .rule = PVT_SLICE_COVERED, .cellsPerVoxel = 1, .maxTriangles = 64, .minArea = 0.002};
}

void pvtCandidateSet_Free(pvtContext* context, pvtCandidateSet* set)
{
    pvtChainSet_Free(context, &set->chains);
    pvtRelease(context, set->planes);
    pvtRelease(context, set->triangles);
    *set = (pvtCandidateSet){0};
}

typedef struct CandidateTask {
    pvtContext* context;
    const pvtCandidateOptions* options;
    const pvtSliceVolume* volume;
    const pvtSectionSet* sections;
    size_t first; // section of the batch's first bitmap
    pvtBitmap bitmaps[BATCH];
    pvtBitmap guards[BATCH];
    pvtChainSet chains[BATCH];
    pvtStatus statuses[BATCH];
    double minArea;              // [vx²] in the plane
    size_t pointRoom, chainRoom; // of the set's arrays
} CandidateTask;

static pvtStatus CreateSliceBitmap(pvtContext* context, const pvtGridFrame* frame,
                                   const pvtPlane* plane, int cells, pvtBitmap* bitmap)
{
    if (bitmap->words != NULL) {
        pvtBitmap_Free(context, bitmap);
    }
    return pvtCreateBitmap(context, frame->size[pvtPlane_GetU(plane)] * cells,
                           frame->size[pvtPlane_GetV(plane)] * cells, bitmap);
}

// The loops that chains start from: contours, simplified when the options say so.
static pvtStatus MakeLoops(const CandidateTask* task, size_t slot, const pvtPlane* plane,
                           pvtLoopSet* loops)
{
    pvtContext* context = task->context;
    const pvtCandidateOptions* options = task->options;
    pvtLoopSet contours;
    pvtStatus status =
        pvtTraceContours(context, &task->bitmaps[slot], options->cellsPerVoxel, &contours);
    if (status == PVT_OK && options->simplification > 0.0) {
        pvtSimplifyOptions simplify = pvtDefaultSimplifyOptions();
        simplify.tolerance = options->simplification;
        simplify.plane = plane;
        simplify.guard = &task->guards[slot];
        simplify.cellsPerVoxel = options->cellsPerVoxel;
        pvtLoopSet simplified;
        status = pvtSimplifyContours(context, &simplify, &contours, &simplified);
        pvtLoopSet_Free(context, &contours);
        contours = simplified;
    }
    *loops = (pvtLoopSet){0};
    if (status == PVT_OK) {
        status = pvtBridgeHoles(context, &contours, loops);
    }
    pvtLoopSet_Free(context, &contours);
    return status;
}

static pvtStatus MakeSlices(CandidateTask* task, size_t slot, const pvtPlane* plane)
{
    pvtContext* context = task->context;
    const pvtCandidateOptions* options = task->options;
    const pvtGridFrame* frame = &task->volume->grid->frame;
    const int cells = options->cellsPerVoxel;
    if (options->slicer == NULL) {
        if (CreateSliceBitmap(context, frame, plane, cells, &task->bitmaps[slot]) != PVT_OK) {
            return pvtContext_GetStatus(context);
        }
        if (options->rule == PVT_SLICE_COVERED && task->volume->cells != NULL && cells == 1) {
            pvtSliceCells(task->volume, plane, cells, NULL, &task->bitmaps[slot]);
        } else {
            pvtSliceGrid(task->volume, plane, options->rule, cells, &task->bitmaps[slot]);
        }
    }
    if (options->simplification > 0.0) {
        if (CreateSliceBitmap(context, frame, plane, cells, &task->guards[slot]) != PVT_OK) {
            return pvtContext_GetStatus(context);
        }
        if (options->guard != NULL) {
            pvtSliceGrid(options->guard, plane, PVT_SLICE_COVERED, cells, &task->guards[slot]);
        } else {
            const pvtBitmap* from = &task->bitmaps[slot];
            memcpy(task->guards[slot].words, from->words,
                   from->wordsPerRow * (size_t)from->height * sizeof(uint64_t));
        }
    }
    return PVT_OK;
}

static pvtStatus MakeChains(CandidateTask* task, size_t slot)
{
    pvtContext* context = task->context;
    const pvtCandidateOptions* options = task->options;
    const pvtPlane* plane = &task->sections->sections[task->first + slot].plane;
    pvtStatus status = MakeSlices(task, slot, plane);
    if (status != PVT_OK) {
        return status;
    }
    pvtLoopSet loops;
    status = MakeLoops(task, slot, plane, &loops);
    if (status == PVT_OK) {
        pvtChainOptions chain = pvtDefaultChainOptions();
        chain.maxTriangles = options->maxTriangles;
        chain.minArea = task->minArea / pvtPlane_GetAreaScale(plane);
        chain.allowed = options->simplification > 0.0 ? &task->guards[slot] : &task->bitmaps[slot];
        chain.cellsPerVoxel = options->cellsPerVoxel;
        status = pvtBuildChains(context, &chain, &loops, &task->chains[slot]);
    }
    pvtLoopSet_Free(context, &loops);
    return status;
}

static void RunCandidateTask(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    CandidateTask* task = taskData;
    for (size_t slot = begin; slot < end; ++slot) {
        task->statuses[slot] =
            pvtIsCancelled(task->context) ? PVT_CANCELLED : MakeChains(task, slot);
    }
}

// Makes room for so many points and chains in all, at least twice what there was: a copy a batch
// would take time that grows with the square of their number.
static pvtStatus GrowCandidates(CandidateTask* task, pvtCandidateSet* set, size_t points,
                                size_t chains)
{
    if (set->chains.starts != NULL && points <= task->pointRoom && chains <= task->chainRoom) {
        return PVT_OK;
    }
    points = points > 2 * task->pointRoom ? points : 2 * task->pointRoom;
    chains = chains > 2 * task->chainRoom ? chains : 2 * task->chainRoom;
    struct {
        void** memory;
        size_t count, size;
    } parts[] = {
        {(void**)&set->chains.points, points, sizeof *set->chains.points},
        {(void**)&set->chains.ranks, points, sizeof *set->chains.ranks},
        {(void**)&set->chains.limits, points, sizeof *set->chains.limits},
        {(void**)&set->chains.starts, chains + 1, sizeof *set->chains.starts},
        {(void**)&set->planes, chains, sizeof *set->planes},
        {(void**)&set->triangles, chains, sizeof *set->triangles},
    };
    for (size_t i = 0; i < sizeof parts / sizeof *parts; ++i) {
        void* grown = pvtReallocate(task->context, *parts[i].memory, parts[i].count, parts[i].size);
        if (grown == NULL) {
            return pvtContext_GetStatus(task->context);
        }
        *parts[i].memory = grown;
    }
    task->pointRoom = points;
    task->chainRoom = chains;
    return PVT_OK;
}

static int32_t GetLongestLink(const pvtChainSet* chains, size_t chain)
{
    int32_t points = 0;
    for (size_t i = chains->starts[chain]; i < chains->starts[chain + 1]; ++i) {
        points += chains->limits[i] == UINT32_MAX ? 1 : 0;
    }
    return points - 2;
}

// Appends the batch's chains, in order.
static pvtStatus AppendChains(CandidateTask* task, size_t count, pvtCandidateSet* set)
{
    size_t points = set->chains.pointCount;
    size_t chains = set->chains.count;
    for (size_t slot = 0; slot < count; ++slot) {
        points += task->chains[slot].pointCount;
        chains += task->chains[slot].count;
    }
    const pvtStatus status = GrowCandidates(task, set, points, chains);
    if (status != PVT_OK) {
        return status;
    }
    pvtChainSet* to = &set->chains;
    for (size_t slot = 0; slot < count; ++slot) {
        const pvtChainSet* from = &task->chains[slot];
        if (from->count == 0) {
            continue;
        }
        memcpy(to->points + to->pointCount, from->points, from->pointCount * sizeof *to->points);
        memcpy(to->ranks + to->pointCount, from->ranks, from->pointCount * sizeof *to->ranks);
        memcpy(to->limits + to->pointCount, from->limits, from->pointCount * sizeof *to->limits);
        for (size_t c = 0; c < from->count; ++c) {
            to->starts[to->count + c] = to->pointCount + from->starts[c];
            set->planes[to->count + c] = task->sections->sections[task->first + slot].plane;
            set->triangles[to->count + c] = GetLongestLink(from, c);
        }
        to->pointCount += from->pointCount;
        to->count += from->count;
        to->starts[to->count] = to->pointCount;
    }
    return PVT_OK;
}

static pvtStatus RunBatch(pvtContext* context, CandidateTask* task, pvtCandidateSet* set)
{
    const size_t left = task->sections->count - task->first;
    const size_t count = left < BATCH ? left : BATCH;
    const pvtSlicer* slicer = task->options->slicer;
    const int cells = task->options->cellsPerVoxel;
    for (size_t slot = 0; slot < count && slicer != NULL; ++slot) {
        const pvtPlane* plane = &task->sections->sections[task->first + slot].plane;
        pvtStatus status = CreateSliceBitmap(context, &task->volume->grid->frame, plane, cells,
                                             &task->bitmaps[slot]);
        if (status == PVT_OK) {
            status = slicer->slice(context, slicer->user, plane, cells, &task->bitmaps[slot]);
        }
        if (status != PVT_OK) {
            return status;
        }
    }
    pvtParallelFor(context, RunCandidateTask, count, 1, task);
    pvtStatus status = PVT_OK;
    for (size_t slot = 0; slot < count && status == PVT_OK; ++slot) {
        status = task->statuses[slot];
    }
    if (status == PVT_OK) {
        status = AppendChains(task, count, set);
    }
    for (size_t slot = 0; slot < count; ++slot) {
        pvtChainSet_Free(context, &task->chains[slot]);
    }
    return status;
}

pvtStatus pvtBuildCandidates(pvtContext* context, const pvtCandidateOptions* options,
                             const pvtSliceVolume* volume, const pvtSectionSet* sections,
                             pvtCandidateSet* candidates)
{
    *candidates = (pvtCandidateSet){.frame = volume->grid->frame};
    CandidateTask* task = pvtAllocate(context, 1, sizeof *task);
    if (task == NULL) {
        return pvtContext_GetStatus(context);
    }
    task->context = context;
    task->options = options;
    task->volume = volume;
    task->sections = sections;
    double largest = 0.0;
    for (size_t s = 0; s < sections->count; ++s) {
        largest = sections->sections[s].area > largest ? sections->sections[s].area : largest;
    }
    task->minArea = largest * options->minArea;
    pvtStatus status = PVT_OK;
    for (; task->first < sections->count && status == PVT_OK; task->first += BATCH) {
        status = RunBatch(context, task, candidates);
        const size_t done = task->first + BATCH;
        pvtReportProgress(context,
                          done < sections->count ? (double)done / (double)sections->count : 1.0);
    }
    for (size_t slot = 0; slot < BATCH; ++slot) {
        pvtBitmap_Free(context, &task->bitmaps[slot]);
        pvtBitmap_Free(context, &task->guards[slot]);
    }
    pvtRelease(context, task);
    if (status != PVT_OK) {
        pvtCandidateSet_Free(context, candidates);
        return status == PVT_CANCELLED ? pvtFailCancelled(context) : status;
    }
    return PVT_OK;
}
