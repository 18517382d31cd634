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

enum { TILE = 32, TILE_PIXELS = 31 };

// A view's frame in its quarter of a mask.
static pvtMaskFrame MakeTileFrame(const pvtScorerOptions* options, size_t view)
{
    pvtMaskFrame frame =
        pvtMakeMaskFrame(&options->views->views[view], &options->bounds, options->size);
    if (options->size == TILE_PIXELS) {
        frame.offsetX += (double)(view % 2 * TILE);
        frame.offsetY += (double)(view / 2 % 2 * TILE);
    }
    return frame;
}

pvtStatus pvtCreateScorer(pvtContext* context, const pvtScorerOptions* options,
                          const pvtGridFrame* grid, pvtScorer* scorer)
{
    const size_t count = options->views->count;
    *scorer = (pvtScorer){.grid = *grid,
                          .size = options->size == TILE_PIXELS ? 2 * TILE : options->size,
                          .viewsPerMask = options->size == TILE_PIXELS ? 4 : 1,
                          .viewCount = count};
    const size_t perMask = (size_t)scorer->viewsPerMask;
    scorer->maskCount = (count + perMask - 1) / perMask;
    scorer->wordCount = (size_t)scorer->size * (size_t)scorer->size / 64;
    scorer->frames = pvtAllocate(context, count, sizeof *scorer->frames);
    scorer->factors = pvtAllocate(context, 4 * scorer->maskCount, sizeof *scorer->factors);
    scorer->table =
        pvtAllocate(context, pvtGetDistanceTableCount(scorer->size), sizeof *scorer->table);
    if (scorer->frames == NULL || scorer->factors == NULL || scorer->table == NULL) {
        pvtScorer_Free(context, scorer);
        return pvtContext_GetStatus(context);
    }
    pvtFillDistanceTable(scorer->size, options->exponent, scorer->table);
    for (size_t v = 0; v < count; ++v) {
        scorer->frames[v] = MakeTileFrame(options, v);
        const double pixel = scorer->frames[v].pixelSize;
        double factor = options->views->views[v].weight * pixel * pixel / 256.0;
        for (int power = 0; power < options->exponent; ++power) {
            factor *= pixel;
        }
        scorer->factors[4 * (v / perMask) + v % perMask] = factor;
    }
    return PVT_OK;
}

// (u, v) of a plane to mask coordinates in 1/256 pixel: x = xu × u + xv × v + x0, y alike.
typedef struct PlaneProjection {
    double xu, xv, x0, yu, yv, y0;
} PlaneProjection;

static PlaneProjection ProjectPlane(const pvtScorer* scorer, size_t view, const pvtPlane* plane)
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
    return (PlaneProjection){
        .xu = pvtDot(u, frame->right) * fixed / unit,
        .xv = pvtDot(v, frame->right) * fixed / unit,
        .x0 = (pvtDot(origin, frame->right) + frame->offsetX) * fixed,
        .yu = pvtDot(u, frame->up) * fixed / unit,
        .yv = pvtDot(v, frame->up) * fixed / unit,
        .y0 = (pvtDot(origin, frame->up) + frame->offsetY) * fixed,
    };
}

static pvtMaskPoint ProjectPoint(const PlaneProjection* p, pvtPoint2 point)
{
    const double u = point.x;
    const double v = point.y;
    return (pvtMaskPoint){(int32_t)lrint(p->xu * u + p->xv * v + p->x0),
                          (int32_t)lrint(p->yu * u + p->yv * v + p->y0)};
}

void pvtDrawSectionPolygon(const pvtScorer* scorer, size_t mask, const pvtPlane* plane,
                           const pvtPoint2* points, size_t count, uint64_t* rows)
{
    const size_t perMask = (size_t)scorer->viewsPerMask;
    const size_t end = (mask + 1) * perMask;
    for (size_t v = mask * perMask; v < end && v < scorer->viewCount && count >= 3; ++v) {
        const PlaneProjection projection = ProjectPlane(scorer, v, plane);
        pvtMaskPoint from = ProjectPoint(&projection, points[count - 1]);
        for (size_t i = 0; i < count; ++i) {
            const pvtMaskPoint to = ProjectPoint(&projection, points[i]);
            pvtToggleMaskEdge(rows, scorer->size, from, to);
            from = to;
        }
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
    const size_t bytes = (scorer->wordCount + 2 * size) * sizeof(uint64_t) + size * size;
    *set = (pvtScoredMaskSet){.count = scorer->maskCount};
    set->masks = pvtAllocate(context, set->count, sizeof *set->masks);
    set->memory = pvtAllocate(context, set->count, bytes);
    if (set->masks == NULL || set->memory == NULL) {
        pvtScoredMaskSet_Free(context, set);
        return pvtContext_GetStatus(context);
    }
    for (size_t m = 0; m < set->count; ++m) {
        uint8_t* memory = (uint8_t*)set->memory + m * bytes;
        pvtScoredMask* mask = &set->masks[m];
        mask->rows = (uint64_t*)memory;
        mask->rowSums = (uint64_t(*)[2])(mask->rows + scorer->wordCount);
        mask->columns = (uint8_t*)(mask->rowSums + size);
    }
    return PVT_OK;
}

// The quarter that a half of row y belongs to.
static size_t GetQuarter(const pvtScorer* scorer, size_t y, size_t half)
{
    return scorer->viewsPerMask == 1 ? 0 : (y >= TILE ? 2 : 0) + half;
}

static double WeighSums(const pvtScorer* scorer, size_t index, const uint64_t sums[4])
{
    const double* factors = scorer->factors + 4 * index;
    return factors[0] * (double)sums[0] + factors[1] * (double)sums[1] +
           factors[2] * (double)sums[2] + factors[3] * (double)sums[3];
}

double pvtScoreRows(const pvtScorer* scorer, const pvtScoredMaskSet* set, size_t index,
                    const uint64_t* rows)
{
    const pvtScoredMask* mask = &set->masks[index];
    if (memcmp(rows, mask->rows, scorer->wordCount * sizeof *rows) == 0) {
        return mask->value;
    }
    uint8_t columns[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE];
    pvtTransformMaskColumns(rows, scorer->size, columns);
    const size_t size = (size_t)scorer->size;
    uint64_t sums[4];
    memcpy(sums, mask->sums, sizeof sums);
    for (size_t y = 0; y < size; ++y) {
        const uint8_t* row = columns + y * size;
        if (memcmp(row, mask->columns + y * size, size) != 0) {
            uint64_t halves[2];
            pvtSumMaskRow(row, scorer->size, scorer->table, halves);
            for (size_t half = 0; half < 2; ++half) {
                sums[GetQuarter(scorer, y, half)] += halves[half] - mask->rowSums[y][half];
            }
        }
    }
    return WeighSums(scorer, index, sums);
}

void pvtAssignRows(const pvtScorer* scorer, pvtScoredMaskSet* set, size_t index,
                   const uint64_t* rows)
{
    pvtScoredMask* mask = &set->masks[index];
    const size_t size = (size_t)scorer->size;
    memcpy(mask->rows, rows, scorer->wordCount * sizeof *rows);
    memset(mask->sums, 0, sizeof mask->sums);
    pvtTransformMaskColumns(rows, scorer->size, mask->columns);
    for (size_t y = 0; y < size; ++y) {
        pvtSumMaskRow(mask->columns + y * size, scorer->size, scorer->table, mask->rowSums[y]);
        for (size_t half = 0; half < 2; ++half) {
            mask->sums[GetQuarter(scorer, y, half)] += mask->rowSums[y][half];
        }
    }
    mask->value = WeighSums(scorer, index, mask->sums);
}
