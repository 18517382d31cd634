// SPDX-License-Identifier: MIT
// Voxels at the border of the set ones are splatted as points, close enough to each other to leave
// no pixel free between them: much faster than drawing the faces between them.
#include "ceiling.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "occlusion/distance.h"
#include "occlusion/mask.h"

#include <math.h>
#include <string.h>

enum { MANY_SPLITS = 6 }; // along a voxel: with more, its faces are drawn instead

typedef struct CeilingTask {
    pvtContext* context;
    const pvtViewSet* views;
    const pvtBox3* bounds;
    int size;
    const pvtVec3* points;
    size_t pointCount;
    const uint32_t* table;
    double* results; // one a view
} CeilingTask;

// Set voxels of one word that have a clear neighbour; outside of the grid is clear.
static uint64_t GetBorderWord(const pvtBitGrid* grid, size_t word, int y, int z)
{
    const size_t perRow = grid->wordsPerRow;
    const size_t row = ((size_t)z * (size_t)grid->frame.size[1] + (size_t)y) * perRow;
    const uint64_t* words = grid->words + row;
    const uint64_t here = words[word];
    if (here == 0) {
        return 0;
    }
    const size_t slab = (size_t)grid->frame.size[1] * perRow;
    const uint64_t left = here << 1 | (word > 0 ? words[word - 1] >> 63 : 0);
    const uint64_t right = here >> 1 | (word + 1 < perRow ? words[word + 1] << 63 : 0);
    const uint64_t below = y > 0 ? *(words + word - perRow) : 0;
    const uint64_t above = y + 1 < grid->frame.size[1] ? (words + perRow)[word] : 0;
    const uint64_t front = z > 0 ? *(words + word - slab) : 0;
    const uint64_t back = z + 1 < grid->frame.size[2] ? (words + slab)[word] : 0;
    return here & ~(left & right & below & above & front & back);
}

// The number of points; they are stored when `points` is not null.
static size_t ListBorder(const pvtBitGrid* grid, int splits, pvtVec3* points)
{
    size_t count = 0;
    const double h = grid->frame.voxelSize;
    const int each = splits * splits * splits;
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (size_t word = 0; word < grid->wordsPerRow; ++word) {
                uint64_t border = GetBorderWord(grid, word, y, z);
                if (points == NULL) {
                    count += (size_t)(pvtCountBits(border) * each);
                    continue;
                }
                for (; border != 0; border &= border - 1) {
                    const int x = (int)(word * 64) + __builtin_ctzll(border);
                    for (int part = 0; part < each; ++part) {
                        const int row = part / splits;
                        const int layer = row / splits;
                        const double dx = (part % splits + 0.5) / splits;
                        const double dy = (row % splits + 0.5) / splits;
                        const double dz = (layer + 0.5) / splits;
                        points[count++] =
                            pvtAdd(grid->frame.origin,
                                   (pvtVec3){(x + dx) * h, (y + dy) * h, (z + dz) * h});
                    }
                }
            }
        }
    }
    return count;
}

static void MeasureViews(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const CeilingTask* task = taskData;
    const size_t words = (size_t)task->size / 64;
    for (size_t v = begin; v < end && !pvtIsCancelled(task->context); ++v) {
        uint64_t rows[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE / 64];
        memset(rows, 0, sizeof rows);
        const pvtMaskFrame frame =
            pvtMakeMaskFrame(&task->views->views[v], task->bounds, task->size);
        for (size_t i = 0; i < task->pointCount; ++i) {
            const int x = (int)(pvtDot(task->points[i], frame.right) + frame.offsetX);
            const int y = (int)(pvtDot(task->points[i], frame.up) + frame.offsetY);
            if (x >= 0 && y >= 0 && x < task->size && y < task->size) {
                pvtSetBit(rows + (size_t)y * words, (size_t)x);
            }
        }
        const double sum = (double)pvtSumDistances(rows, task->size, task->table) / 256.0;
        task->results[v] = frame.weight * sum * frame.pixelSize * frame.pixelSize * frame.pixelSize;
    }
}

// So many points along each side of a voxel that no two lie a pixel apart, seen from anywhere.
static int GetSplits(const pvtViewSet* views, const pvtBox3* bounds, int size, double voxelSize)
{
    double pixel = HUGE_VAL;
    for (size_t v = 0; v < views->count; ++v) {
        pixel = fmin(pixel, pvtMakeMaskFrame(&views->views[v], bounds, size).pixelSize);
    }
    return (int)fmin(fmax(ceil(1.5 * voxelSize / pixel), 1.0), MANY_SPLITS + 1.0);
}

// Voxels of many pixels are few: their faces are drawn.
static pvtStatus MeasureFaces(pvtContext* context, const pvtViewSet* views, const pvtBox3* bounds,
                              int size, const pvtBitGrid* grid, double* measure)
{
    pvtMesh faces;
    pvtStatus status = pvtBuildVoxelMesh(context, grid, &faces);
    if (status == PVT_OK) {
        status = pvtMeasureOcclusion(context, views, bounds, size, &faces, measure);
        pvtMesh_Free(context, &faces);
    }
    return status;
}

pvtStatus pvtMeasureGrid(pvtContext* context, const pvtViewSet* views, const pvtBox3* bounds,
                         int size, const pvtBitGrid* grid, double* measure)
{
    *measure = 0.0;
    const int splits = GetSplits(views, bounds, size, grid->frame.voxelSize);
    if (splits > MANY_SPLITS) {
        return MeasureFaces(context, views, bounds, size, grid, measure);
    }
    const size_t count = ListBorder(grid, splits, NULL);
    pvtVec3* points = pvtAllocate(context, count, sizeof *points);
    uint32_t* table = pvtAllocate(context, pvtGetDistanceTableCount(size), sizeof *table);
    double* results = pvtAllocate(context, views->count, sizeof *results);
    pvtStatus status = PVT_OK;
    if (points == NULL || table == NULL || results == NULL) {
        status = pvtContext_GetStatus(context);
    } else {
        ListBorder(grid, splits, points);
        pvtFillDistanceTable(size, 1, table);
        CeilingTask task = {context, views, bounds, size, points, count, table, results};
        pvtParallelFor(context, MeasureViews, views->count, 1, &task);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
        for (size_t v = 0; v < views->count && status == PVT_OK; ++v) {
            *measure += results[v];
        }
    }
    pvtRelease(context, results);
    pvtRelease(context, table);
    pvtRelease(context, points);
    return status;
}
