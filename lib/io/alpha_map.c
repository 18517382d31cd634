// SPDX-License-Identifier: MIT
// A pyramid of least alphas.
//
// Lance Williams, "Pyramidal Parametrics", SIGGRAPH 1983, halves an image again and again, each
// time taking means. Here each cell takes the least of what it covers, so that a coarse cell is
// opaque only when all in it is. Levels round their sizes up: the last column and row of a level
// may cover fewer texels than the others, and no cell reaches over a repetition's border.
#include "alpha.h"

#include "base/context.h"

#include <assert.h>
#include <math.h>
#include <string.h>

// Rows between two questions whether to stop.
enum { POLL_ROWS = 64 };

void pvtAlphaMap_Free(pvtContext* context, pvtAlphaMap* map)
{
    for (int i = 0; i < map->levelCount; ++i) {
        pvtRelease(context, map->levels[i]);
    }
    *map = (pvtAlphaMap){0};
}

static pvtAlphaAxis MakeAxis(pvtWrap wrap, size_t side)
{
    switch (wrap) {
    case PVT_WRAP_REPEAT:
        return (pvtAlphaAxis){true, side, 0.5};
    case PVT_WRAP_MIRROR:
        return (pvtAlphaAxis){true, 2 * side, 0.5};
    default:
        return (pvtAlphaAxis){false, side + 1, -0.5};
    }
}

// The texel on one side of a cell of the finest level, 0 or 1.
static size_t GetTexel(const pvtAlphaAxis* axis, size_t side, size_t cell, size_t which)
{
    if (!axis->isPeriodic) {
        const size_t behind = cell + which;
        return behind == 0 ? 0 : behind > side ? side - 1 : behind - 1;
    }
    const size_t texel = (cell + which) % axis->count;
    return texel < side ? texel : 2 * side - 1 - texel;
}

static uint8_t Least(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

// One row of the finest level; `mixed` has room for a row of texels.
static void FillRow(const pvtAlpha* alpha, pvtAlphaMap* map, size_t row, uint8_t* mixed)
{
    const size_t width = (size_t)alpha->width, height = (size_t)alpha->height;
    const uint8_t* above = alpha->values + GetTexel(&map->axes[1], height, row, 0) * width;
    const uint8_t* below = alpha->values + GetTexel(&map->axes[1], height, row, 1) * width;
    for (size_t x = 0; x < width; ++x) {
        mixed[x] = Least(above[x], below[x]);
    }
    uint8_t* cells = map->levels[0] + row * map->columns[0];
    size_t texel = GetTexel(&map->axes[0], width, 0, 0);
    for (size_t i = 0; i < map->columns[0]; ++i) {
        const size_t next = GetTexel(&map->axes[0], width, i, 1);
        cells[i] = Least(mixed[texel], mixed[next]);
        map->least = Least(map->least, cells[i]);
        map->most = cells[i] > map->most ? cells[i] : map->most;
        texel = next;
    }
}

static pvtStatus FillFinest(pvtContext* context, const pvtAlpha* alpha, pvtAlphaMap* map)
{
    uint8_t* mixed = pvtAllocate(context, (size_t)alpha->width, 1);
    if (mixed == NULL) {
        return pvtContext_GetStatus(context);
    }
    map->least = UINT8_MAX;
    map->most = 0;
    pvtStatus status = PVT_OK;
    for (size_t row = 0; row < map->rows[0] && status == PVT_OK; ++row) {
        FillRow(alpha, map, row, mixed);
        if (row % POLL_ROWS == 0 && pvtIsCancelled(context)) {
            status = pvtFailCancelled(context);
        }
    }
    pvtRelease(context, mixed);
    return status;
}

static void FillCoarser(pvtAlphaMap* map, int level)
{
    const size_t columns = map->columns[level - 1], rows = map->rows[level - 1];
    for (size_t y = 0; y < map->rows[level]; ++y) {
        const uint8_t* above = map->levels[level - 1] + 2 * y * columns;
        const uint8_t* below = 2 * y + 1 < rows ? above + columns : above;
        uint8_t* cells = map->levels[level] + y * map->columns[level];
        for (size_t x = 0; x < map->columns[level]; ++x) {
            const size_t left = 2 * x, right = left + 1 < columns ? left + 1 : left;
            cells[x] = Least(Least(above[left], above[right]), Least(below[left], below[right]));
        }
    }
}

static pvtStatus FillLevels(pvtContext* context, const pvtAlpha* alpha, pvtAlphaMap* map)
{
    size_t columns = map->axes[0].count, rows = map->axes[1].count;
    bool isLast = false;
    pvtStatus status = PVT_OK;
    for (int level = 0; status == PVT_OK && !isLast; ++level) {
        assert(level < PVT_MAX_ALPHA_LEVELS);
        uint8_t* cells = pvtAllocate(context, columns * rows, 1);
        if (cells == NULL) {
            return pvtContext_GetStatus(context);
        }
        map->levels[level] = cells;
        map->columns[level] = columns;
        map->rows[level] = rows;
        map->levelCount = level + 1;
        if (level == 0) {
            status = FillFinest(context, alpha, map);
        } else {
            FillCoarser(map, level);
        }
        isLast = columns == 1 && rows == 1;
        columns = (columns + 1) / 2;
        rows = (rows + 1) / 2;
    }
    return status;
}

pvtStatus pvtBuildAlphaMap(pvtContext* context, const pvtAlpha* alpha, const pvtWrap wraps[2],
                           pvtAlphaMap* map)
{
    assert(alpha->values != NULL && alpha->width > 0 && alpha->height > 0);
    assert(alpha->width <= PVT_MAX_ALPHA_SIDE && alpha->height <= PVT_MAX_ALPHA_SIDE);
    *map = (pvtAlphaMap){.axes = {MakeAxis(wraps[0], (size_t)alpha->width),
                                  MakeAxis(wraps[1], (size_t)alpha->height)}};
    // All levels together are a third more than the first.
    const size_t cells = map->axes[0].count * map->axes[1].count;
    pvtStatus status = pvtCheckMemory(context, cells + cells / 3, "the alpha of a masked texture");
    if (status == PVT_OK) {
        status = FillLevels(context, alpha, map);
    }
    if (status != PVT_OK) {
        pvtAlphaMap_Free(context, map);
    }
    return status;
}

static size_t GetCellCount(const pvtAlphaMap* map, int axis, int level)
{
    return axis == 0 ? map->columns[level] : map->rows[level];
}

int64_t pvtAlphaMap_FindCell(const pvtAlphaMap* map, int axis, int level, double texel)
{
    const pvtAlphaAxis* a = &map->axes[axis];
    const double count = (double)a->count;
    const double from = texel - a->origin;
    const double repetition = a->isPeriodic ? floor(from / count) : 0.0;
    // Rounding may put it a little outside of its repetition, and a clamped one lies anywhere.
    const double within = fmin(fmax(floor(from - repetition * count), 0.0), count - 1.0);
    return (int64_t)repetition * (int64_t)GetCellCount(map, axis, level) +
           ((int64_t)within >> level);
}

size_t pvtAlphaMap_GetPlace(const pvtAlphaMap* map, int axis, int level, int64_t cell)
{
    const int64_t count = (int64_t)GetCellCount(map, axis, level);
    const int64_t rest = cell % count;
    return (size_t)(rest < 0 ? rest + count : rest);
}

double pvtAlphaMap_GetBorder(const pvtAlphaMap* map, int axis, int level, int64_t cell)
{
    const pvtAlphaAxis* a = &map->axes[axis];
    const int64_t count = (int64_t)GetCellCount(map, axis, level);
    if (!a->isPeriodic && (cell <= 0 || cell >= count)) {
        return cell <= 0 ? -INFINITY : INFINITY;
    }
    const size_t place = pvtAlphaMap_GetPlace(map, axis, level, cell);
    const int64_t repetition = (cell - (int64_t)place) / count;
    return a->origin + (double)repetition * (double)a->count + (double)(place << level);
}
