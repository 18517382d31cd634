// SPDX-License-Identifier: MIT
// Voxels at the border of the set ones are splatted as points, close enough to each other to leave
// no pixel free between them: much faster than drawing the faces between them.
#include "ceiling.h"
#include "points.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "occlusion/distance.h"
#include "occlusion/mask.h"
#include "voxel/bit_grid.h"

#include <math.h>
#include <string.h>

enum { MANY_SPLITS = 6 }; // along a voxel: with more, its faces are drawn instead

typedef struct CeilingTask {
    pvtContext* context;
    const pvtViewSet* views;
    const pvtBox3* bounds;
    int size;
    pvtGridFrame frame; // of the points
    float* points[3];   // [vx] along each axis
    size_t pointCount;
    const uint32_t* table;
    double* results; // one a view
} CeilingTask;

// Of a row that may be outside of the grid, the voxels that are set or have cells.
static uint64_t GetSome(const pvtBitGrid* grid, const pvtCellGrid* cells, size_t word, int y, int z)
{
    if (y < 0 || z < 0 || y >= grid->frame.size[1] || z >= grid->frame.size[2]) {
        return 0;
    }
    const uint64_t finer = cells != NULL ? pvtBitGrid_GetRow(&cells->voxels, y, z)[word] : 0;
    return pvtBitGrid_GetRow(grid, y, z)[word] | finer;
}

// Set voxels of one word that have a clear neighbour, without cells; outside of the grid is clear.
static uint64_t GetBorderWord(const pvtBitGrid* grid, const pvtCellGrid* cells, size_t word, int y,
                              int z)
{
    const uint64_t here = pvtBitGrid_GetRow(grid, y, z)[word];
    if (here == 0) {
        return 0;
    }
    const uint64_t some = GetSome(grid, cells, word, y, z);
    const uint64_t before = word > 0 ? GetSome(grid, cells, word - 1, y, z) : 0;
    const uint64_t after = word + 1 < grid->wordsPerRow ? GetSome(grid, cells, word + 1, y, z) : 0;
    return here & ~((some << 1 | before >> 63) & (some >> 1 | after << 63) &
                    GetSome(grid, cells, word, y - 1, z) & GetSome(grid, cells, word, y + 1, z) &
                    GetSome(grid, cells, word, y, z - 1) & GetSome(grid, cells, word, y, z + 1));
}

// Counts, and stores when there is room.
typedef struct PointList {
    float** points; // [vx] one array an axis
    size_t count;
} PointList;

static void AddPoint(PointList* list, pvtVec3 point)
{
    if (list->points != NULL) {
        list->points[0][list->count] = (float)point.x;
        list->points[1][list->count] = (float)point.y;
        list->points[2][list->count] = (float)point.z;
    }
    ++list->count;
}

static void ListBorder(const pvtBitGrid* grid, const pvtCellGrid* cells, int splits,
                       PointList* list)
{
    const int each = splits * splits * splits;
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (size_t word = 0; word < grid->wordsPerRow; ++word) {
                uint64_t border = GetBorderWord(grid, cells, word, y, z);
                if (list->points == NULL) {
                    list->count += (size_t)(pvtCountBits(border) * each);
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
                        AddPoint(list, (pvtVec3){x + dx, y + dy, z + dz});
                    }
                }
            }
        }
    }
}

// The cells of one of the groups that a voxel is cut into, `side` cells long.
static uint64_t GetGroup(int group, int side)
{
    static const uint64_t corners[] = {[1] = 1, [2] = UINT64_C(0x330033), [4] = ~UINT64_C(0)};
    const int across = PVT_CELLS / side;
    const int x = group % across, y = group / across % across, z = group / (across * across);
    return corners[side] << (side * (x + PVT_CELLS * (y + PVT_CELLS * z)));
}

// Of the cells' coordinates, each the sum of a one and a two.
static pvtVec3 GetMiddle(uint64_t cells)
{
    static const uint64_t ones[3] = {UINT64_C(0xAAAAAAAAAAAAAAAA), UINT64_C(0xF0F0F0F0F0F0F0F0),
                                     UINT64_C(0xFFFF0000FFFF0000)};
    static const uint64_t twos[3] = {UINT64_C(0xCCCCCCCCCCCCCCCC), UINT64_C(0xFF00FF00FF00FF00),
                                     UINT64_C(0xFFFFFFFF00000000)};
    const double count = pvtCountBits(cells);
    double sums[3];
    for (int axis = 0; axis < 3; ++axis) {
        sums[axis] = pvtCountBits(cells & ones[axis]) + 2.0 * pvtCountBits(cells & twos[axis]);
    }
    const pvtVec3 sum = {sums[0] + 0.5 * count, sums[1] + 0.5 * count, sums[2] + 0.5 * count};
    return pvtScale(sum, 1.0 / count);
}

// As many points along a voxel's side as it needs: one in the middle of each group of cells that
// has any, or eight in each cell.
static void AddCells(const int voxel[3], uint64_t cells, int splits, PointList* list)
{
    const int side = splits == 1 ? 4 : splits == 2 ? 2 : 1;
    const int parts = splits > PVT_CELLS ? 8 : 1;
    const pvtVec3 corner = {PVT_CELLS * voxel[0], PVT_CELLS * voxel[1], PVT_CELLS * voxel[2]};
    for (int group = 0; group < 64 / (side * side * side); ++group) {
        const uint64_t members = cells & GetGroup(group, side);
        if (list->points == NULL) {
            list->count += members != 0 ? (size_t)parts : 0;
            continue;
        }
        for (int part = 0; part < parts && members != 0; ++part) {
            const pvtVec3 away = {parts == 1 ? 0.0 : 0.5 * (part & 1) - 0.25,
                                  parts == 1 ? 0.0 : 0.5 * (part >> 1 & 1) - 0.25,
                                  parts == 1 ? 0.0 : 0.5 * (part >> 2) - 0.25};
            const pvtVec3 at = pvtAdd(corner, pvtAdd(GetMiddle(members), away));
            AddPoint(list, pvtScale(at, 1.0 / PVT_CELLS));
        }
    }
}

static void ListCells(const pvtCellGrid* grid, int splits, PointList* list)
{
    const pvtBitGrid* voxels = &grid->voxels;
    for (size_t word = 0, index = 0; word < voxels->wordCount; ++word) {
        const int row = (int)(word / voxels->wordsPerRow);
        const int first = (int)(word % voxels->wordsPerRow) * 64;
        for (uint64_t bits = voxels->words[word]; bits != 0; bits &= bits - 1, ++index) {
            const int voxel[3] = {first + __builtin_ctzll(bits), row % voxels->frame.size[1],
                                  row / voxels->frame.size[1]};
            const uint64_t border = grid->border != NULL ? grid->border[index] : 0;
            AddCells(voxel, grid->cells[index] | border, splits, list);
        }
    }
}

// Of points in grid coordinates.
static pvtPointProjection MakeProjection(const pvtMaskFrame* frame, const pvtGridFrame* grid)
{
    pvtPointProjection projection;
    for (int axis = 0; axis < 3; ++axis) {
        projection.right[axis] = (float)(pvtGetAxis(frame->right, axis) * grid->voxelSize);
        projection.up[axis] = (float)(pvtGetAxis(frame->up, axis) * grid->voxelSize);
    }
    projection.offset[0] = (float)(pvtDot(grid->origin, frame->right) + frame->offsetX);
    projection.offset[1] = (float)(pvtDot(grid->origin, frame->up) + frame->offsetY);
    return projection;
}

static void SplatPoints(const CeilingTask* task, const pvtMaskFrame* frame, uint64_t* rows)
{
    const pvtPointProjection projection = MakeProjection(frame, &task->frame);
    const size_t words = (size_t)task->size / 64;
    const float size = (float)task->size;
    float places[2][PVT_POINT_GROUP];
    for (size_t first = 0; first < task->pointCount; first += PVT_POINT_GROUP) {
        const size_t left = task->pointCount - first,
                     count = left < PVT_POINT_GROUP ? left : PVT_POINT_GROUP;
        pvtProjectPoints(&projection, task->points, first, count, places);
        for (size_t i = 0; i < count; ++i) {
            const float x = places[0][i], y = places[1][i];
            if (x >= 0.0F && y >= 0.0F && x < size && y < size) {
                pvtSetBit(rows + (size_t)y * words, (size_t)x);
            }
        }
    }
}

static void MeasureViews(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const CeilingTask* task = taskData;
    for (size_t v = begin; v < end && !pvtIsCancelled(task->context); ++v) {
        uint64_t rows[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE / 64];
        memset(rows, 0, sizeof rows);
        const pvtMaskFrame frame =
            pvtMakeMaskFrame(&task->views->views[v], task->bounds, task->size);
        SplatPoints(task, &frame, rows);
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

// Voxels of many pixels are few: their faces are drawn, and those of partly set ones as wholes.
static pvtStatus MeasureFaces(pvtContext* context, const CeilingTask* task, const pvtBitGrid* grid,
                              const pvtCellGrid* cells, double* measure)
{
    pvtBitGrid some = *grid;
    some.words = pvtAllocate(context, some.wordCount, sizeof *some.words);
    if (some.words == NULL) {
        return pvtContext_GetStatus(context);
    }
    memcpy(some.words, grid->words, some.wordCount * sizeof *some.words);
    for (size_t i = 0; cells != NULL && i < some.wordCount; ++i) {
        some.words[i] |= cells->voxels.words[i];
    }
    pvtMesh faces;
    pvtStatus status = pvtBuildVoxelMesh(context, &some, &faces);
    pvtRelease(context, some.words);
    if (status == PVT_OK) {
        status =
            pvtMeasureOcclusion(context, task->views, task->bounds, task->size, &faces, measure);
        pvtMesh_Free(context, &faces);
    }
    return status;
}

static void ListPoints(const pvtBitGrid* grid, const pvtCellGrid* cells, int splits,
                       PointList* list)
{
    ListBorder(grid, cells, splits, list);
    if (cells != NULL) {
        ListCells(cells, splits, list);
    }
}

pvtStatus pvtMeasureGrid(pvtContext* context, const pvtMeasureGridOptions* options,
                         const pvtBitGrid* grid, const pvtCellGrid* cells, double* measure)
{
    *measure = 0.0;
    CeilingTask task = {.context = context,
                        .views = options->views,
                        .bounds = options->bounds,
                        .size = options->size};
    cells = cells != NULL && cells->count > 0 ? cells : NULL;
    const int splits =
        GetSplits(options->views, options->bounds, options->size, grid->frame.voxelSize);
    if (splits > MANY_SPLITS) {
        return MeasureFaces(context, &task, grid, cells, measure);
    }
    PointList list = {0};
    ListPoints(grid, cells, splits, &list);
    uint32_t* table = pvtAllocate(context, pvtGetDistanceTableCount(task.size), sizeof *table);
    task.results = pvtAllocate(context, task.views->count, sizeof *task.results);
    bool hasRoom = table != NULL && task.results != NULL;
    for (int axis = 0; axis < 3; ++axis) {
        task.points[axis] = pvtAllocate(context, list.count, sizeof *task.points[axis]);
        hasRoom = hasRoom && task.points[axis] != NULL;
    }
    pvtStatus status = hasRoom ? PVT_OK : pvtContext_GetStatus(context);
    if (status == PVT_OK) {
        list = (PointList){task.points, 0};
        ListPoints(grid, cells, splits, &list);
        pvtFillDistanceTable(task.size, 1, table);
        task.frame = grid->frame;
        task.pointCount = list.count;
        task.table = table;
        pvtParallelFor(context, MeasureViews, task.views->count, 1, &task);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
        for (size_t v = 0; v < task.views->count && status == PVT_OK; ++v) {
            *measure += task.results[v];
        }
    }
    pvtRelease(context, task.results);
    pvtRelease(context, table);
    for (int axis = 0; axis < 3; ++axis) {
        pvtRelease(context, task.points[axis]);
    }
    return status;
}
