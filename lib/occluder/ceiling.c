// SPDX-License-Identifier: MIT
// Voxels at the border of the set ones are splatted as points, close enough to each other to leave
// no pixel free between them: much faster than drawing the faces between them. They are kept by
// blocks, since a block behind pixels that are set already has nothing to add.
#include "ceiling.h"
#include "points.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "base/vectors.h"
#include "occlusion/distance.h"
#include "occlusion/mask.h"
#include "voxel/bit_grid.h"
#include "voxel/cell_grid.h"

#include <math.h>
#include <string.h>

enum {
    MANY_SPLITS = 6, // along a voxel: with more, its faces are drawn instead
    BLOCK = 8,       // [vx] along a side
    ROWS = BLOCK * BLOCK,
    VIEW_GROUP = 4,
};

// Points from `first` up to that of the next block.
typedef struct Block {
    uint16_t place[3]; // in blocks
    size_t first;
} Block;

// What a layer of blocks has.
typedef struct Layer {
    size_t points, blocks;
} Layer;

typedef struct CeilingTask {
    pvtContext* context;
    const pvtViewSet* views;
    const pvtBox3* bounds;
    int size;
    pvtGridFrame frame; // of the points
    float* points[3];   // [vx] along each axis
    Block* blocks;      // one more at the end
    size_t blockCount;
    const uint32_t* table;
    uint8_t* pixels; // of all views' pictures
    double* results; // one a view
} CeilingTask;

// Of a row that may be outside of the grid, the voxels that are set or have cells.
PVT_IN_CLONES uint64_t GetSome(const pvtBitGrid* grid, const pvtCellGrid* cells, size_t word, int y,
                               int z)
{
    if (y < 0 || z < 0 || y >= grid->frame.size[1] || z >= grid->frame.size[2]) {
        return 0;
    }
    const uint64_t finer = cells != NULL ? pvtBitGrid_GetRow(&cells->voxels, y, z)[word] : 0;
    return pvtBitGrid_GetRow(grid, y, z)[word] | finer;
}

// Set voxels of one word that have a clear neighbour, without cells; outside of the grid is clear.
PVT_IN_CLONES uint64_t GetBorderWord(const pvtBitGrid* grid, const pvtCellGrid* cells, size_t word,
                                     int y, int z)
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
    float* const* points; // [vx] one array an axis
    size_t count;
    Block* blocks;
    size_t blockCount;
} PointList;

PVT_IN_CLONES void AddPoint(PointList* list, pvtVec3 point)
{
    if (list->points != NULL) {
        list->points[0][list->count] = (float)point.x;
        list->points[1][list->count] = (float)point.y;
        list->points[2][list->count] = (float)point.z;
    }
    ++list->count;
}

PVT_IN_CLONES void AddVoxel(const int voxel[3], int splits, PointList* list)
{
    const int each = splits * splits * splits;
    if (list->points == NULL) {
        list->count += (size_t)each;
        return;
    }
    for (int part = 0; part < each; ++part) {
        const int row = part / splits;
        const int layer = row / splits;
        const double dx = (part % splits + 0.5) / splits;
        const double dy = (row % splits + 0.5) / splits;
        const double dz = (layer + 0.5) / splits;
        AddPoint(list, (pvtVec3){voxel[0] + dx, voxel[1] + dy, voxel[2] + dz});
    }
}

// The cells of one of the groups that a voxel is cut into, `side` cells long.
PVT_IN_CLONES uint64_t GetGroup(int group, int side)
{
    static const uint64_t corners[] = {[1] = 1, [2] = UINT64_C(0x330033), [4] = ~UINT64_C(0)};
    const int across = PVT_CELLS / side;
    const int x = group % across, y = group / across % across, z = group / (across * across);
    return corners[side] << (side * (x + PVT_CELLS * (y + PVT_CELLS * z)));
}

// Of the cells' coordinates, each the sum of a one and a two.
PVT_IN_CLONES pvtVec3 GetMiddle(uint64_t cells)
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
PVT_IN_CLONES void AddCells(const int voxel[3], uint64_t cells, int splits, PointList* list)
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

typedef struct ListTask {
    const pvtBitGrid* grid;
    const pvtCellGrid* cells; // null: none
    int splits;
    Layer* layers; // of each layer of blocks: what it has, then what comes before it
    float* const* points;
    Block* blocks;
} ListTask;

// Of the rows of some blocks along x, the voxels that are splatted, and those with cells.
typedef struct RowWords {
    uint64_t border[ROWS], finer[ROWS];
    uint64_t any;
} RowWords;

PVT_IN_CLONES void GetRowWords(const ListTask* task, size_t word, int y, int z, RowWords* rows)
{
    const int* size = task->grid->frame.size;
    rows->any = 0;
    for (int r = 0; r < ROWS; ++r) {
        const int rowY = y + r % BLOCK, rowZ = z + r / BLOCK;
        rows->border[r] = rows->finer[r] = 0;
        if (rowY < size[1] && rowZ < size[2]) {
            rows->border[r] = GetBorderWord(task->grid, task->cells, word, rowY, rowZ);
            rows->finer[r] =
                task->cells != NULL ? pvtBitGrid_GetRow(&task->cells->voxels, rowY, rowZ)[word] : 0;
        }
        rows->any |= rows->border[r] | rows->finer[r];
    }
}

PVT_IN_CLONES void ListBlock(const ListTask* task, const RowWords* rows, const int corner[3],
                             PointList* list)
{
    if (list->blocks != NULL) {
        list->blocks[list->blockCount] =
            (Block){{(uint16_t)(corner[0] / BLOCK), (uint16_t)(corner[1] / BLOCK),
                     (uint16_t)(corner[2] / BLOCK)},
                    list->count};
    }
    ++list->blockCount;
    const int shift = corner[0] % 64;
    for (int r = 0; r < ROWS; ++r) {
        int voxel[3] = {0, corner[1] + r % BLOCK, corner[2] + r / BLOCK};
        for (unsigned bits = rows->border[r] >> shift & 0xFF; bits != 0; bits &= bits - 1) {
            voxel[0] = corner[0] + __builtin_ctz(bits);
            AddVoxel(voxel, task->splits, list);
        }
        for (unsigned bits = rows->finer[r] >> shift & 0xFF; bits != 0; bits &= bits - 1) {
            voxel[0] = corner[0] + __builtin_ctz(bits);
            const size_t index = pvtCellGrid_Rank(task->cells, voxel[0], voxel[1], voxel[2]);
            const uint64_t border = task->cells->border != NULL ? task->cells->border[index] : 0;
            AddCells(voxel, task->cells->cells[index] | border, task->splits, list);
        }
    }
}

PVT_IN_CLONES void ListLayer(const ListTask* task, int z, PointList* list)
{
    const pvtBitGrid* grid = task->grid;
    for (int y = 0; y < grid->frame.size[1]; y += BLOCK) {
        for (size_t word = 0; word < grid->wordsPerRow; ++word) {
            RowWords rows;
            GetRowWords(task, word, y, z, &rows);
            for (int x = 0; x < 64; x += BLOCK) {
                if ((rows.any >> x & 0xFF) != 0) {
                    ListBlock(task, &rows, (int[3]){(int)word * 64 + x, y, z}, list);
                }
            }
        }
    }
}

PVT_VECTOR_CLONES
static void CountLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const ListTask* task = taskData;
    for (size_t l = begin; l < end; ++l) {
        PointList list = {0};
        ListLayer(task, (int)l * BLOCK, &list);
        task->layers[l] = (Layer){list.count, list.blockCount};
    }
}

PVT_VECTOR_CLONES
static void StoreLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const ListTask* task = taskData;
    for (size_t l = begin; l < end; ++l) {
        PointList list = {task->points, task->layers[l].points, task->blocks,
                          task->layers[l].blocks};
        ListLayer(task, (int)l * BLOCK, &list);
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

static int ClampToMask(float value, int size)
{
    return value <= 0.0F ? 0 : value >= (float)size ? size - 1 : (int)value;
}

// What a view makes of the points. Bytes, since with bits each point would wait for the one before,
// which sets one of the same word.
typedef struct Picture {
    pvtMaskFrame frame;
    pvtPointProjection projection;
    float reach[2];  // [px] of a block's points from its middle
    uint8_t* pixels; // one a pixel, and one more for all beside the mask
} Picture;

// Whether all pixels are set that points of a block may lie in.
static bool IsBlockCovered(const CeilingTask* task, const Picture* picture, const Block* block)
{
    const pvtPointProjection* projection = &picture->projection;
    const float* reach = picture->reach;
    const float center[3] = {(float)(BLOCK * block->place[0]) + 0.5F * BLOCK,
                             (float)(BLOCK * block->place[1]) + 0.5F * BLOCK,
                             (float)(BLOCK * block->place[2]) + 0.5F * BLOCK};
    float x = projection->offset[0], y = projection->offset[1];
    for (int axis = 0; axis < 3; ++axis) {
        x += center[axis] * projection->right[axis];
        y += center[axis] * projection->up[axis];
    }
    const int first = ClampToMask(x - reach[0], task->size);
    const int last = ClampToMask(x + reach[0], task->size);
    const int end = ClampToMask(y + reach[1], task->size);
    for (int row = ClampToMask(y - reach[1], task->size); row <= end; ++row) {
        for (int column = first; column <= last; ++column) {
            if (picture->pixels[row * task->size + column] == 0) {
                return false;
            }
        }
    }
    return true;
}

static void SplatBlock(const CeilingTask* task, const Block* block, Picture* picture)
{
    const size_t end = block[1].first;
    int32_t pixels[PVT_POINT_GROUP];
    for (size_t first = block->first; first < end; first += PVT_POINT_GROUP) {
        const size_t left = end - first;
        const size_t count = left < PVT_POINT_GROUP ? left : PVT_POINT_GROUP;
        pvtFindPixels(&picture->projection, task->points, first, count, task->size, pixels);
        for (size_t i = 0; i < count; ++i) {
            picture->pixels[pixels[i]] = 1;
        }
    }
}

static size_t GetPictureSize(const CeilingTask* task)
{
    return (size_t)task->size * (size_t)task->size + 1;
}

static void BeginPicture(const CeilingTask* task, size_t view, Picture* picture)
{
    static const float MORE = 0.01F; // [px] than rounding could move a point by
    picture->frame = pvtMakeMaskFrame(&task->views->views[view], task->bounds, task->size);
    picture->projection = MakeProjection(&picture->frame, &task->frame);
    picture->reach[0] = picture->reach[1] = MORE;
    for (int axis = 0; axis < 3; ++axis) {
        picture->reach[0] += 0.5F * BLOCK * fabsf(picture->projection.right[axis]);
        picture->reach[1] += 0.5F * BLOCK * fabsf(picture->projection.up[axis]);
    }
    picture->pixels = task->pixels + view * GetPictureSize(task);
}

static double MeasurePicture(const CeilingTask* task, const Picture* picture)
{
    uint64_t rows[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE / 64];
    for (size_t i = 0; i < (size_t)task->size * (size_t)task->size / 64; ++i) {
        rows[i] = pvtPackWord(picture->pixels + 64 * i);
    }
    const double sum = (double)pvtSumDistances(rows, task->size, task->table) / 256.0;
    const double pixel = picture->frame.pixelSize;
    return picture->frame.weight * sum * pixel * pixel * pixel;
}

// Points are too many for a cache: a block goes to a few views while it is at hand.
static void MeasureViews(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const CeilingTask* task = taskData;
    for (size_t group = begin; group < end && !pvtIsCancelled(task->context); ++group) {
        Picture pictures[VIEW_GROUP];
        const size_t first = group * VIEW_GROUP, left = task->views->count - first;
        const size_t count = left < VIEW_GROUP ? left : VIEW_GROUP;
        for (size_t v = 0; v < count; ++v) {
            BeginPicture(task, first + v, &pictures[v]);
        }
        for (size_t b = 0; b < task->blockCount; ++b) {
            for (size_t v = 0; v < count; ++v) {
                if (!IsBlockCovered(task, &pictures[v], &task->blocks[b])) {
                    SplatBlock(task, &task->blocks[b], &pictures[v]);
                }
            }
        }
        for (size_t v = 0; v < count; ++v) {
            task->results[first + v] = MeasurePicture(task, &pictures[v]);
        }
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

static pvtStatus ListPoints(pvtContext* context, const pvtBitGrid* grid, const pvtCellGrid* cells,
                            int splits, CeilingTask* task)
{
    const size_t layerCount = ((size_t)grid->frame.size[2] + BLOCK - 1) / BLOCK;
    ListTask list = {.grid = grid, .cells = cells, .splits = splits};
    list.layers = pvtAllocate(context, layerCount, sizeof *list.layers);
    if (list.layers == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtParallelFor(context, CountLayers, layerCount, 1, &list);
    Layer all = {0};
    for (size_t l = 0; l < layerCount; ++l) {
        const Layer here = list.layers[l];
        list.layers[l] = all;
        all.points += here.points;
        all.blocks += here.blocks;
    }
    task->blocks = pvtAllocate(context, all.blocks + 1, sizeof *task->blocks);
    bool hasRoom = task->blocks != NULL;
    for (int axis = 0; axis < 3; ++axis) {
        task->points[axis] = pvtAllocateUnset(context, all.points, sizeof *task->points[axis]);
        hasRoom = hasRoom && task->points[axis] != NULL;
    }
    if (hasRoom) {
        list.points = task->points;
        list.blocks = task->blocks;
        pvtParallelFor(context, StoreLayers, layerCount, 1, &list);
        task->blocks[all.blocks].first = all.points;
        task->blockCount = all.blocks;
    }
    pvtRelease(context, list.layers);
    return hasRoom ? PVT_OK : pvtContext_GetStatus(context);
}

static pvtStatus SumViews(pvtContext* context, CeilingTask* task, double* measure)
{
    const size_t groups = (task->views->count + VIEW_GROUP - 1) / VIEW_GROUP;
    pvtParallelFor(context, MeasureViews, groups, 1, task);
    if (pvtIsCancelled(context)) {
        return pvtFailCancelled(context);
    }
    for (size_t v = 0; v < task->views->count; ++v) {
        *measure += task->results[v];
    }
    return PVT_OK;
}

pvtStatus pvtMeasureGrid(pvtContext* context, const pvtMeasureGridOptions* options,
                         const pvtBitGrid* grid, const pvtCellGrid* cells, double* measure)
{
    *measure = 0.0;
    CeilingTask task = {.context = context,
                        .views = options->views,
                        .bounds = options->bounds,
                        .size = options->size,
                        .frame = grid->frame};
    cells = cells != NULL && cells->count > 0 ? cells : NULL;
    const int splits =
        GetSplits(options->views, options->bounds, options->size, grid->frame.voxelSize);
    if (splits > MANY_SPLITS) {
        return MeasureFaces(context, &task, grid, cells, measure);
    }
    uint32_t* table = pvtAllocate(context, pvtGetDistanceTableCount(task.size), sizeof *table);
    task.results = pvtAllocate(context, task.views->count, sizeof *task.results);
    task.pixels = pvtAllocate(context, task.views->count, GetPictureSize(&task));
    pvtStatus status = table != NULL && task.results != NULL && task.pixels != NULL
                           ? ListPoints(context, grid, cells, splits, &task)
                           : pvtContext_GetStatus(context);
    if (status == PVT_OK) {
        pvtFillDistanceTable(task.size, 1, table);
        task.table = table;
        status = SumViews(context, &task, measure);
    }
    pvtRelease(context, task.pixels);
    pvtRelease(context, task.results);
    pvtRelease(context, table);
    pvtRelease(context, task.blocks);
    for (int axis = 0; axis < 3; ++axis) {
        pvtRelease(context, task.points[axis]);
    }
    return status;
}
