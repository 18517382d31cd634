// SPDX-License-Identifier: MIT
// How far the set voxels reach along many directions at once. In each layer of constant z only the
// corners of a convex hull can be the farthest, and there are few of those (Andrew, Another
// efficient algorithm for convex hulls in two dimensions, 1979, of the rows' first and last set
// bits, which come sorted).
#include "directions.h"

#include "base/context.h"

#include <stdatomic.h>
#include <string.h>

typedef struct HullPoint {
    int32_t x, y;
} HullPoint;

typedef struct ExtentTask {
    pvtContext* context;
    const pvtBitGrid* grid;
    const pvtPlanLine* lines;
    size_t count;
    pvtOffsetRange* ranges; // count a worker
    HullPoint* hulls;       // two chains of size[1] points a worker
    atomic_bool cancelled;
} ExtentTask;

static int32_t FindFirstBit(const uint64_t* row, size_t wordCount)
{
    for (size_t w = 0; w < wordCount; ++w) {
        if (row[w] != 0) {
            return (int32_t)(64 * w) + __builtin_ctzll(row[w]);
        }
    }
    return -1;
}

static int32_t FindLastBit(const uint64_t* row, size_t wordCount)
{
    for (size_t w = wordCount; w-- > 0;) {
        if (row[w] != 0) {
            return (int32_t)(64 * w) + 63 - __builtin_clzll(row[w]);
        }
    }
    return -1;
}

// Appends a point to a chain that bends one way only: to lower x for side −1, to higher for 1.
static size_t AppendToChain(HullPoint* chain, size_t count, HullPoint point, int side)
{
    while (count >= 2) {
        const HullPoint a = chain[count - 2], b = chain[count - 1];
        const int64_t turn =
            (int64_t)(b.x - a.x) * (point.y - a.y) - (int64_t)(point.x - a.x) * (b.y - a.y);
        if (side * turn > 0) {
            break;
        }
        --count;
    }
    chain[count] = point;
    return count + 1;
}

static int64_t GetCoefficient(const pvtPlane* plane, pvtAxis axis)
{
    return axis == plane->axis            ? INT64_C(1) << PVT_PLANE_BITS
           : axis == pvtPlane_GetU(plane) ? -(int64_t)plane->slopeU
                                          : -(int64_t)plane->slopeV;
}

// Of voxels' lower corners; the cubes are added at the end.
static void WidenRange(const pvtPlane* plane, int z, const HullPoint* chain, size_t count,
                       pvtOffsetRange* range)
{
    const int64_t x = GetCoefficient(plane, PVT_AXIS_X), y = GetCoefficient(plane, PVT_AXIS_Y);
    const int64_t base = GetCoefficient(plane, PVT_AXIS_Z) * z;
    for (size_t i = 0; i < count; ++i) {
        const int64_t offset = base + x * chain[i].x + y * chain[i].y;
        range->lower = offset < range->lower ? offset : range->lower;
        range->upper = offset > range->upper ? offset : range->upper;
    }
}

static void MeasureLayer(const ExtentTask* task, int z, HullPoint* hull, pvtOffsetRange* ranges)
{
    const pvtBitGrid* grid = task->grid;
    const int height = grid->frame.size[1];
    HullPoint* low = hull;
    HullPoint* high = hull + height;
    size_t lowCount = 0, highCount = 0;
    for (int y = 0; y < height; ++y) {
        const size_t index = (size_t)z * (size_t)height + (size_t)y;
        const uint64_t* row = grid->words + index * grid->wordsPerRow;
        const int32_t first = FindFirstBit(row, grid->wordsPerRow);
        if (first >= 0) {
            const int32_t last = FindLastBit(row, grid->wordsPerRow);
            lowCount = AppendToChain(low, lowCount, (HullPoint){first, y}, -1);
            highCount = AppendToChain(high, highCount, (HullPoint){last, y}, 1);
        }
    }
    for (size_t i = 0; i < task->count && lowCount > 0; ++i) {
        WidenRange(&task->lines[i].shape, z, low, lowCount, &ranges[i]);
        WidenRange(&task->lines[i].shape, z, high, highCount, &ranges[i]);
    }
}

static void MeasureLayers(size_t begin, size_t end, int worker, void* taskData)
{
    ExtentTask* task = taskData;
    HullPoint* hull = task->hulls + 2 * (size_t)worker * (size_t)task->grid->frame.size[1];
    for (size_t z = begin; z < end; ++z) {
        if (pvtIsCancelled(task->context)) {
            atomic_store(&task->cancelled, true);
            return;
        }
        MeasureLayer(task, (int)z, hull, task->ranges + (size_t)worker * task->count);
    }
}

static void MergeRanges(const ExtentTask* task, size_t workers, pvtPlanLine* lines)
{
    for (size_t i = 0; i < task->count; ++i) {
        pvtOffsetRange range = task->ranges[i];
        for (size_t worker = 1; worker < workers; ++worker) {
            const pvtOffsetRange* other = &task->ranges[worker * task->count + i];
            range.lower = other->lower < range.lower ? other->lower : range.lower;
            range.upper = other->upper > range.upper ? other->upper : range.upper;
        }
        for (int axis = 0; axis < 3 && range.lower <= range.upper; ++axis) {
            const int64_t coefficient = GetCoefficient(&lines[i].shape, (pvtAxis)axis);
            range.lower += coefficient < 0 ? coefficient : 0;
            range.upper += coefficient > 0 ? coefficient : 0;
        }
        lines[i].range = range;
    }
}

pvtStatus pvtMeasureExtents(pvtContext* context, const pvtBitGrid* grid, pvtPlanLine* lines,
                            size_t count)
{
    const size_t workers = (size_t)pvtContext_GetThreadCount(context);
    ExtentTask task = {.context = context, .grid = grid, .lines = lines, .count = count};
    task.ranges = pvtAllocate(context, workers * count, sizeof *task.ranges);
    task.hulls =
        task.ranges == NULL
            ? NULL
            : pvtAllocate(context, 2 * workers * (size_t)grid->frame.size[1], sizeof *task.hulls);
    pvtStatus status = pvtContext_GetStatus(context);
    if (task.hulls != NULL) {
        for (size_t i = 0; i < workers * count; ++i) {
            task.ranges[i] = (pvtOffsetRange){INT64_MAX, INT64_MIN};
        }
        pvtParallelFor(context, MeasureLayers, (size_t)grid->frame.size[2], 1, &task);
        MergeRanges(&task, workers, lines);
        status = atomic_load(&task.cancelled) ? pvtFailCancelled(context) : PVT_OK;
    }
    pvtRelease(context, task.ranges);
    pvtRelease(context, task.hulls);
    return status;
}
