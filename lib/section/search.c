// SPDX-License-Identifier: MIT
// The largest slice of each bin (Silvennoinen et al., Occluder Simplification Using Planar
// Sections, 2014, section 4.2). The paper counts a slice's pixels on the GPU; here the cells of
// every plane are counted by their centres, and then, since a covered slice is never larger than
// that, only the few planes of a bin that may still win are sliced by the stricter rule.
#include "base/bits.h"
#include "base/context.h"

#include <paravent/section.h>
#include <stdatomic.h>

enum { NO_PLANE = -1 };

typedef struct BinResult {
    int64_t plane; // in the plan, or NO_PLANE
    double area;
} BinResult;

typedef struct SearchTask {
    pvtContext* context;
    const pvtSearchOptions* options;
    const pvtSliceVolume* volume;
    const pvtSectionPlan* plan;
    uint64_t* scratch; // room for one slice a worker
    size_t scratchSize;
    uint32_t* counts;   // set cells of each plane's centre slice
    BinResult* results; // one a bin
    atomic_size_t done;
    size_t workCount; // what `done` runs up to
    atomic_bool cancelled;
} SearchTask;

pvtSearchOptions pvtDefaultSearchOptions(void)
{
    return (pvtSearchOptions){.rule = PVT_SLICE_COVERED, .cellsPerVoxel = 1};
}

void pvtSectionSet_Free(pvtContext* context, pvtSectionSet* set)
{
    pvtRelease(context, set->sections);
    *set = (pvtSectionSet){0};
}

// A bitmap for the plane's slices, still without words.
static pvtBitmap MakeShape(const SearchTask* task, const pvtPlane* plane, int cells)
{
    const int* size = task->volume->grid->frame.size;
    const int width = size[pvtPlane_GetU(plane)] * cells;
    return (pvtBitmap){
        .width = width,
        .height = size[pvtPlane_GetV(plane)] * cells,
        .wordsPerRow = pvtGetWordCount((size_t)width),
    };
}

static pvtBitmap GetScratch(const SearchTask* task, int worker, const pvtPlane* plane, int cells)
{
    pvtBitmap slice = MakeShape(task, plane, cells);
    slice.words = task->scratch + (size_t)worker * task->scratchSize;
    return slice;
}

// Counts a piece of work as done; false when the search is to stop.
static bool Advance(SearchTask* task, int worker)
{
    const size_t done = atomic_fetch_add(&task->done, 1) + 1;
    if (worker == 0) {
        pvtReportProgress(task->context, (double)done / (double)task->workCount);
    }
    if (pvtIsCancelled(task->context)) {
        atomic_store(&task->cancelled, true);
    }
    return !atomic_load(&task->cancelled);
}

static void CountPlanes(size_t begin, size_t end, int worker, void* taskData)
{
    SearchTask* task = taskData;
    for (size_t i = begin; i < end && Advance(task, worker); ++i) {
        const pvtPlane* plane = &task->plan->planes[i];
        pvtBitmap slice = GetScratch(task, worker, plane, 1);
        pvtSliceGrid(task->volume, plane, PVT_SLICE_CENTER, 1, &slice);
        task->counts[i] = (uint32_t)pvtBitmap_Count(&slice);
    }
}

// As CountPlanes, with slices from elsewhere, which come one at a time.
static pvtStatus CountPlanesElsewhere(SearchTask* task)
{
    const pvtSlicer* slicer = task->options->slicer;
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < task->plan->planeCount && status == PVT_OK && Advance(task, 0); ++i) {
        const pvtPlane* plane = &task->plan->planes[i];
        pvtBitmap slice = GetScratch(task, 0, plane, 1);
        status = slicer->slice(task->context, slicer->user, plane, 1, &slice);
        task->counts[i] = (uint32_t)pvtBitmap_Count(&slice);
    }
    return status;
}

static double MeasurePlane(const SearchTask* task, int worker, const pvtPlane* plane, int cells)
{
    pvtBitmap slice = GetScratch(task, worker, plane, cells);
    pvtSliceGrid(task->volume, plane, task->options->rule, cells, &slice);
    return pvtMeasureSlice(&slice, plane, cells);
}

static double GetCenterArea(const SearchTask* task, size_t plane)
{
    return task->counts[plane] * pvtPlane_GetAreaScale(&task->plan->planes[plane]);
}

// True when (area, plane) comes before `other`: by falling area, then by rising index.
static bool IsBefore(double area, size_t plane, BinResult other)
{
    return other.plane == NO_PLANE || area > other.area ||
           (area == other.area && (int64_t)plane < other.plane);
}

// The plane of the bin with the largest centre slice among those that come after `last`.
static BinResult FindNext(const SearchTask* task, size_t bin, BinResult last)
{
    BinResult next = {NO_PLANE, 0.0};
    for (size_t i = task->plan->binStarts[bin]; i < task->plan->binStarts[bin + 1]; ++i) {
        const double area = GetCenterArea(task, i);
        const bool isAfter =
            last.plane == NO_PLANE || (last.plane != (int64_t)i && !IsBefore(area, i, last));
        if (area > 0.0 && isAfter && IsBefore(area, i, next)) {
            next = (BinResult){(int64_t)i, area};
        }
    }
    return next;
}

// By falling centre slices, until the next one could not win even if it were covered entirely. With
// finer cells a covered slice may be larger than the centre slice, but hardly by enough to matter.
static BinResult FindLargestCovered(const SearchTask* task, size_t bin, int worker)
{
    const int cells = task->options->cellsPerVoxel;
    BinResult best = {NO_PLANE, 0.0};
    BinResult next = FindNext(task, bin, best);
    while (next.plane != NO_PLANE && IsBefore(next.area, (size_t)next.plane, best)) {
        const double area = MeasurePlane(task, worker, &task->plan->planes[next.plane], cells);
        if (area > 0.0 && IsBefore(area, (size_t)next.plane, best)) {
            best = (BinResult){next.plane, area};
        }
        next = FindNext(task, bin, next);
    }
    return best;
}

static BinResult FindLargestCenter(const SearchTask* task, size_t bin, int worker)
{
    const int cells = task->options->cellsPerVoxel;
    BinResult best = FindNext(task, bin, (BinResult){NO_PLANE, 0.0});
    if (best.plane != NO_PLANE && cells > 1) {
        best.area = MeasurePlane(task, worker, &task->plan->planes[best.plane], cells);
    }
    return best;
}

static void SearchBins(size_t begin, size_t end, int worker, void* taskData)
{
    SearchTask* task = taskData;
    for (size_t bin = begin; bin < end && Advance(task, worker); ++bin) {
        task->results[bin] = task->options->rule == PVT_SLICE_COVERED
                                 ? FindLargestCovered(task, bin, worker)
                                 : FindLargestCenter(task, bin, worker);
    }
}

static pvtStatus CollectSections(const SearchTask* task, pvtSectionSet* set)
{
    size_t count = 0;
    for (size_t bin = 0; bin < task->plan->binCount; ++bin) {
        count += task->results[bin].area > 0.0 ? 1 : 0;
    }
    set->sections = pvtAllocate(task->context, count, sizeof *set->sections);
    if (set->sections == NULL) {
        return pvtContext_GetStatus(task->context);
    }
    for (size_t bin = 0; bin < task->plan->binCount; ++bin) {
        const BinResult* result = &task->results[bin];
        if (result->area > 0.0) {
            set->sections[set->count++] =
                (pvtSection){task->plan->planes[result->plane], result->area};
        }
    }
    set->rule = task->options->rule;
    set->cellsPerVoxel = task->options->cellsPerVoxel;
    return PVT_OK;
}

static pvtStatus RunSearch(SearchTask* task, pvtSectionSet* set)
{
    pvtStatus status = PVT_OK;
    if (task->options->slicer != NULL) {
        status = CountPlanesElsewhere(task);
    } else {
        pvtParallelFor(task->context, CountPlanes, task->plan->planeCount, 8, task);
    }
    if (status == PVT_OK && !atomic_load(&task->cancelled)) {
        pvtParallelFor(task->context, SearchBins, task->plan->binCount, 4, task);
    }
    if (status == PVT_OK && atomic_load(&task->cancelled)) {
        status = pvtFailCancelled(task->context);
    }
    return status == PVT_OK ? CollectSections(task, set) : status;
}

static pvtStatus AllocateSearch(SearchTask* task)
{
    for (int axis = 0; axis < 3; ++axis) {
        const pvtPlane plane = {.axis = (pvtAxis)axis};
        const pvtBitmap shape = MakeShape(task, &plane, task->options->cellsPerVoxel);
        const size_t size = shape.wordsPerRow * (size_t)shape.height;
        task->scratchSize = size > task->scratchSize ? size : task->scratchSize;
    }
    const size_t workers = (size_t)pvtContext_GetThreadCount(task->context);
    task->scratch = pvtAllocate(task->context, workers * task->scratchSize, sizeof(uint64_t));
    if (task->scratch == NULL) {
        return pvtContext_GetStatus(task->context);
    }
    task->counts = pvtAllocate(task->context, task->plan->planeCount, sizeof *task->counts);
    if (task->counts == NULL) {
        return pvtContext_GetStatus(task->context);
    }
    task->results = pvtAllocate(task->context, task->plan->binCount, sizeof *task->results);
    return task->results != NULL ? PVT_OK : pvtContext_GetStatus(task->context);
}

pvtStatus pvtSearchSections(pvtContext* context, const pvtSearchOptions* options,
                            const pvtSliceVolume* volume, const pvtSectionPlan* plan,
                            pvtSectionSet* set)
{
    *set = (pvtSectionSet){0};
    const int cells = options->cellsPerVoxel;
    if (cells != 1 && cells != 2 && cells != 4) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%d cells a voxel; it must be 1, 2 or 4",
                       cells);
    }
    SearchTask task = {.context = context, .options = options, .volume = volume, .plan = plan};
    task.workCount = plan->planeCount + plan->binCount;
    pvtStatus status = AllocateSearch(&task);
    if (status == PVT_OK) {
        status = RunSearch(&task, set);
    }
    if (status == PVT_OK) {
        pvtReportProgress(context, 1.0); // the caller's thread may have come too late to tell
    }
    pvtRelease(context, task.scratch);
    pvtRelease(context, task.counts);
    pvtRelease(context, task.results);
    return status;
}
