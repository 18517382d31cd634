// SPDX-License-Identifier: MIT
// The total occlusion measure (Silvennoinen et al., Occluder Simplification using Planar Sections,
// 2014, section 3): the integral of the distance transform of the projection, over all directions.
#include "base/context.h"
#include "distance.h"
#include "mask.h"

#include <string.h>

typedef struct MeasureTask {
    const pvtViewSet* views;
    const pvtBox3* bounds;
    const pvtMesh* mesh;
    int size;
    const uint32_t* table;
    uint64_t* masks; // one a worker
    double* results; // one a view
    pvtContext* context;
} MeasureTask;

static void DrawMesh(const pvtMesh* mesh, const pvtMaskFrame* frame, int size, uint64_t* rows)
{
    uint64_t triangleRows[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE / 64];
    const size_t words = (size_t)size / 64;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        pvtMaskPoint corners[3];
        int32_t low = INT32_MAX;
        int32_t high = INT32_MIN;
        for (int c = 0; c < 3; ++c) {
            corners[c] = pvtProjectToMask(frame, mesh->positions[mesh->indices[3 * t + (size_t)c]]);
            low = corners[c].y < low ? corners[c].y : low;
            high = corners[c].y > high ? corners[c].y : high;
        }
        const int first = low >> PVT_MASK_POINT_BITS;
        const int last = high >> PVT_MASK_POINT_BITS;
        const size_t begin = (size_t)(first < 0 ? 0 : first) * words;
        const size_t end = (size_t)(last >= size ? size : last + 1) * words;
        if (first >= size || last < 0) {
            continue;
        }
        memset(triangleRows + begin, 0, (end - begin) * sizeof(uint64_t));
        pvtToggleMaskPolygon(triangleRows, size, corners, 3);
        for (size_t word = begin; word < end; ++word) {
            rows[word] |= triangleRows[word];
        }
    }
}

static void MeasureViews(size_t begin, size_t end, int worker, void* taskData)
{
    const MeasureTask* task = taskData;
    const size_t wordCount = (size_t)task->size * (size_t)task->size / 64;
    uint64_t* rows = task->masks + (size_t)worker * wordCount;
    for (size_t v = begin; v < end && !pvtIsCancelled(task->context); ++v) {
        const pvtMaskFrame frame =
            pvtMakeMaskFrame(&task->views->views[v], task->bounds, task->size);
        memset(rows, 0, wordCount * sizeof(uint64_t));
        DrawMesh(task->mesh, &frame, task->size, rows);
        const double sum = (double)pvtSumDistances(rows, task->size, task->table) / 256.0;
        const double pixel = frame.pixelSize;
        task->results[v] = frame.weight * sum * pixel * pixel * pixel;
    }
}

pvtStatus pvtMeasureOcclusion(pvtContext* context, const pvtViewSet* views, const pvtBox3* bounds,
                              int size, const pvtMesh* mesh, double* measure)
{
    *measure = 0.0;
    if (size != 64 && size != 128 && size != 256) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "masks of %d pixels; the measure takes 64, 128 or 256", size);
    }
    const size_t wordCount = (size_t)size * (size_t)size / 64;
    const size_t workers = (size_t)pvtContext_GetThreadCount(context);
    uint32_t* table = pvtAllocate(context, pvtGetDistanceTableCount(size), sizeof *table);
    uint64_t* masks = pvtAllocate(context, workers * wordCount, sizeof *masks);
    double* results = pvtAllocate(context, views->count, sizeof *results);
    pvtStatus status = PVT_OK;
    if (table == NULL || masks == NULL || results == NULL) {
        status = pvtContext_GetStatus(context);
    } else {
        pvtFillDistanceTable(size, 1, table);
        MeasureTask task = {views, bounds, mesh, size, table, masks, results, context};
        pvtParallelFor(context, MeasureViews, views->count, 1, &task);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
        for (size_t v = 0; v < views->count && status == PVT_OK; ++v) {
            *measure += results[v];
        }
    }
    pvtRelease(context, results);
    pvtRelease(context, masks);
    pvtRelease(context, table);
    return status;
}
