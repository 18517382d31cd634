// SPDX-License-Identifier: MIT
#include "scorer.h"

#include "base/context.h"
#include "base/vector.h"

#include <string.h>

void pvtScorer_Free(pvtContext* context, pvtScorer* scorer)
{
    pvtRelease(context, scorer->frames);
    pvtRelease(context, scorer->factors);
    pvtRelease(context, scorer->table);
    *scorer = (pvtScorer){0};
}

pvtStatus pvtCreateScorer(pvtContext* context, const pvtScorerOptions* options,
                          const pvtGridFrame* grid, pvtScorer* scorer)
{
    const size_t count = options->views->count;
    *scorer = (pvtScorer){.grid = *grid,
                          .size = options->size,
                          .viewCount = count,
                          .wordCount = (size_t)options->size * (size_t)options->size / 64};
    scorer->frames = pvtAllocate(context, count, sizeof *scorer->frames);
    scorer->factors = pvtAllocate(context, count, sizeof *scorer->factors);
    scorer->table =
        pvtAllocate(context, pvtGetDistanceTableCount(options->size), sizeof *scorer->table);
    if (scorer->frames == NULL || scorer->factors == NULL || scorer->table == NULL) {
        pvtScorer_Free(context, scorer);
        return pvtContext_GetStatus(context);
    }
    pvtFillDistanceTable(options->size, options->exponent, scorer->table);
    for (size_t v = 0; v < count; ++v) {
        const pvtView* view = &options->views->views[v];
        scorer->frames[v] = pvtMakeMaskFrame(view, &options->bounds, options->size);
        const double pixel = scorer->frames[v].pixelSize;
        scorer->factors[v] = view->weight * pixel * pixel / 256.0;
        for (int power = 0; power < options->exponent; ++power) {
            scorer->factors[v] *= pixel;
        }
    }
    return PVT_OK;
}

pvtPlaneProjection pvtProjectPlane(const pvtScorer* scorer, size_t view, const pvtPlane* plane)
{
    const pvtMaskFrame* frame = &scorer->frames[view];
    const int32_t unit = 1 << PVT_POINT_BITS;
    const pvtVec3 origin = pvtPlane_ToWorld(plane, &scorer->grid, (pvtPoint2){0, 0});
    // Far steps, so that their differences are exact to many digits.
    const pvtVec3 alongU = pvtPlane_ToWorld(plane, &scorer->grid, (pvtPoint2){1024 * unit, 0});
    const pvtVec3 alongV = pvtPlane_ToWorld(plane, &scorer->grid, (pvtPoint2){0, 1024 * unit});
    const pvtVec3 u = pvtScale(pvtSub(alongU, origin), 1.0 / 1024.0);
    const pvtVec3 v = pvtScale(pvtSub(alongV, origin), 1.0 / 1024.0);
    const double fixed = 1 << PVT_MASK_POINT_BITS;
    return (pvtPlaneProjection){
        .xu = pvtDot(u, frame->right) * fixed / unit,
        .xv = pvtDot(v, frame->right) * fixed / unit,
        .x0 = (pvtDot(origin, frame->right) + frame->offsetX) * fixed,
        .yu = pvtDot(u, frame->up) * fixed / unit,
        .yv = pvtDot(v, frame->up) * fixed / unit,
        .y0 = (pvtDot(origin, frame->up) + frame->offsetY) * fixed,
    };
}

static pvtMaskPoint ProjectPoint(const pvtPlaneProjection* p, pvtPoint2 point)
{
    const double u = point.x;
    const double v = point.y;
    return (pvtMaskPoint){(int32_t)lrint(p->xu * u + p->xv * v + p->x0),
                          (int32_t)lrint(p->yu * u + p->yv * v + p->y0)};
}

void pvtDrawSectionPolygon(const pvtScorer* scorer, const pvtPlaneProjection* projection,
                           const pvtPoint2* points, size_t count, uint64_t* rows)
{
    if (count < 3) {
        return;
    }
    pvtMaskPoint from = ProjectPoint(projection, points[count - 1]);
    for (size_t i = 0; i < count; ++i) {
        const pvtMaskPoint to = ProjectPoint(projection, points[i]);
        pvtToggleMaskEdge(rows, scorer->size, from, to);
        from = to;
    }
}

void pvtScoredMaskSet_Free(pvtContext* context, pvtScoredMaskSet* set)
{
    pvtRelease(context, set->masks);
    pvtRelease(context, set->memory);
    *set = (pvtScoredMaskSet){0};
}

pvtStatus pvtCreateScoredMasks(pvtContext* context, const pvtScorer* scorer, pvtScoredMaskSet* set)
{
    const size_t size = (size_t)scorer->size;
    const size_t bytes = (scorer->wordCount + size) * sizeof(uint64_t) + size * size;
    *set = (pvtScoredMaskSet){.count = scorer->viewCount};
    set->masks = pvtAllocate(context, set->count, sizeof *set->masks);
    set->memory = pvtAllocate(context, set->count, bytes);
    if (set->masks == NULL || set->memory == NULL) {
        pvtScoredMaskSet_Free(context, set);
        return pvtContext_GetStatus(context);
    }
    for (size_t v = 0; v < set->count; ++v) {
        uint8_t* memory = (uint8_t*)set->memory + v * bytes;
        pvtScoredMask* mask = &set->masks[v];
        mask->rows = (uint64_t*)memory;
        mask->rowSums = mask->rows + scorer->wordCount;
        mask->columns = (uint8_t*)(mask->rowSums + size);
    }
    return PVT_OK;
}

uint64_t pvtScoreRows(const pvtScorer* scorer, const pvtScoredMask* mask, const uint64_t* rows)
{
    uint8_t columns[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE];
    if (memcmp(rows, mask->rows, scorer->wordCount * sizeof *rows) == 0) {
        return mask->sum;
    }
    pvtTransformMaskColumns(rows, scorer->size, columns);
    const size_t size = (size_t)scorer->size;
    uint64_t sum = mask->sum;
    for (size_t y = 0; y < size; ++y) {
        const uint8_t* row = columns + y * size;
        if (memcmp(row, mask->columns + y * size, size) != 0) {
            sum += pvtSumMaskRow(row, scorer->size, scorer->table) - mask->rowSums[y];
        }
    }
    return sum;
}

void pvtScoredMask_Assign(const pvtScorer* scorer, pvtScoredMask* mask, const uint64_t* rows)
{
    memcpy(mask->rows, rows, scorer->wordCount * sizeof *rows);
    pvtTransformMaskColumns(rows, scorer->size, mask->columns);
    const size_t size = (size_t)scorer->size;
    mask->sum = 0;
    for (size_t y = 0; y < size; ++y) {
        mask->rowSums[y] = pvtSumMaskRow(mask->columns + y * size, scorer->size, scorer->table);
        mask->sum += mask->rowSums[y];
    }
}
