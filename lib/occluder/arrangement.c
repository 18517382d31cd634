// SPDX-License-Identifier: MIT
#include "arrangement.h"

#include "base/context.h"
#include "voxel/bit_grid.h"

#include <assert.h>
#include <string.h>

enum { MAX_WORDS = PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE / 64, LAYERS = 3 };

void pvtArrangement_Free(pvtContext* context, pvtArrangement* arrangement)
{
    for (int slot = 0; slot < arrangement->capacity && arrangement->panels != NULL; ++slot) {
        pvtRelease(context, arrangement->panels[slot].masks);
        pvtBitmap_Free(context, &arrangement->panels[slot].cells);
    }
    pvtRelease(context, arrangement->panels);
    pvtRelease(context, arrangement->layers);
    pvtScoredMaskSet_Free(context, &arrangement->covered);
    pvtScorer_Free(context, &arrangement->scorer);
    *arrangement = (pvtArrangement){0};
}

pvtStatus pvtCreateArrangement(pvtContext* context, const pvtScorerOptions* options,
                               const pvtSliceVolume* volume, int capacity,
                               pvtArrangement* arrangement)
{
    *arrangement = (pvtArrangement){.volume = volume, .capacity = capacity};
    const int* size = volume->grid->frame.size;
    const int longest = pvtGetLongestSide(size);
    arrangement->cellsPerVoxel = volume->cells != NULL || longest <= 160 ? 4
                                 : longest <= 640                        ? 2
                                                                         : 1;
    pvtStatus status =
        pvtCreateScorer(context, options, &volume->grid->frame, &arrangement->scorer);
    if (status == PVT_OK) {
        status = pvtCreateScoredMasks(context, &arrangement->scorer, &arrangement->covered);
    }
    if (status == PVT_OK) {
        const size_t words = arrangement->scorer.maskCount * arrangement->scorer.wordCount;
        arrangement->panels = pvtAllocate(context, (size_t)capacity, sizeof *arrangement->panels);
        arrangement->layers = pvtAllocate(context, LAYERS * words, sizeof(uint64_t));
        if (arrangement->panels == NULL || arrangement->layers == NULL) {
            status = pvtContext_GetStatus(context);
        }
    }
    if (status != PVT_OK) {
        pvtArrangement_Free(context, arrangement);
    }
    return status;
}

void pvtUseSheets(pvtArrangement* arrangement, const pvtSheetSet* sheets)
{
    arrangement->sheets = sheets;
    if (arrangement->cellsPerVoxel < sheets->cellsPerVoxel) {
        arrangement->cellsPerVoxel = sheets->cellsPerVoxel;
    }
}

pvtStatus pvtSliceAllowed(pvtContext* context, const pvtArrangement* arrangement,
                          const pvtPlane* plane, const pvtSliceWindow* window, pvtBitmap* cells)
{
    const int* size = arrangement->volume->grid->frame.size;
    const int scale = arrangement->cellsPerVoxel;
    const int width = size[pvtPlane_GetU(plane)] * scale;
    const int height = size[pvtPlane_GetV(plane)] * scale;
    if (cells->width != width || cells->height != height) {
        pvtBitmap_Free(context, cells);
        const pvtStatus status = pvtCreateBitmap(context, width, height, cells);
        if (status != PVT_OK) {
            return status;
        }
    }
    if (arrangement->volume->cells != NULL) {
        pvtSliceCells(arrangement->volume, plane, scale, window, cells);
    } else {
        pvtSliceGrid(arrangement->volume, plane, PVT_SLICE_COVERED, scale, cells);
    }
    if (arrangement->sheets != NULL) {
        pvtAddSheetCells(arrangement->sheets, plane, scale, cells);
    }
    return PVT_OK;
}

static void DrawPanel(const pvtArrangement* arrangement, size_t mask, const pvtPanel* panel,
                      uint64_t* rows)
{
    memset(rows, 0, arrangement->scorer.wordCount * sizeof *rows);
    pvtDrawSectionPolygon(&arrangement->scorer, mask, &panel->plane, panel->points,
                          (size_t)panel->count, rows);
}

static const uint64_t* GetLayers(const pvtArrangement* arrangement, size_t mask)
{
    return arrangement->layers + LAYERS * mask * arrangement->scorer.wordCount;
}

// A mask after the change.
static void ComposeMask(const pvtArrangement* arrangement, const pvtChange* change, size_t mask,
                        uint64_t* rows)
{
    const size_t words = arrangement->scorer.wordCount;
    const uint64_t* once = GetLayers(arrangement, mask);
    const uint64_t* twice = once + words;
    const uint64_t* thrice = twice + words;
    const uint64_t* first = arrangement->panels[change->slots[0]].masks;
    first = first != NULL ? first + mask * words : NULL;
    const uint64_t* second = change->count > 1 ? arrangement->panels[change->slots[1]].masks : NULL;
    second = second != NULL ? second + mask * words : NULL;
    assert(change->count == 1 || change->count == 2);
    uint64_t drawn[2][MAX_WORDS];
    for (int i = 0; i < change->count; ++i) {
        DrawPanel(arrangement, mask, &change->panels[i], drawn[i]);
    }
    for (size_t w = 0; w < words; ++w) {
        const uint64_t p = first != NULL ? first[w] : 0;
        const uint64_t q = second != NULL ? second[w] : 0;
        // What the others cover: once more than the replaced panels do.
        rows[w] = (~p & ~q & once[w]) | ((p ^ q) & twice[w]) | (p & q & thrice[w]);
        rows[w] |= drawn[0][w] | (change->count > 1 ? drawn[1][w] : 0);
    }
}

void pvtEvaluateChange(const pvtArrangement* arrangement, pvtChange* change)
{
    const pvtScorer* scorer = &arrangement->scorer;
    double value = 0.0;
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        uint64_t rows[MAX_WORDS];
        ComposeMask(arrangement, change, m, rows);
        value += pvtScoreRows(scorer, &arrangement->covered, m, rows);
    }
    change->value = value;
}

static void CountLayers(pvtArrangement* arrangement, size_t mask)
{
    const size_t words = arrangement->scorer.wordCount;
    uint64_t* once = arrangement->layers + LAYERS * mask * words;
    uint64_t* twice = once + words;
    uint64_t* thrice = twice + words;
    memset(once, 0, LAYERS * words * sizeof *once);
    for (int slot = 0; slot < arrangement->capacity; ++slot) {
        if (arrangement->panels[slot].panel.count == 0) {
            continue;
        }
        const uint64_t* rows = arrangement->panels[slot].masks + mask * words;
        for (size_t w = 0; w < words; ++w) {
            thrice[w] |= twice[w] & rows[w];
            twice[w] |= once[w] & rows[w];
            once[w] |= rows[w];
        }
    }
}

static bool IsSamePlane(const pvtPlane* a, const pvtPlane* b)
{
    return a->axis == b->axis && a->slopeU == b->slopeU && a->slopeV == b->slopeV &&
           a->offset == b->offset;
}

static pvtStatus PlacePanel(pvtContext* context, pvtArrangement* arrangement, int slot,
                            const pvtPanel* panel)
{
    pvtPlacedPanel* placed = &arrangement->panels[slot];
    const pvtScorer* scorer = &arrangement->scorer;
    if (placed->masks == NULL) {
        placed->masks =
            pvtAllocate(context, scorer->maskCount * scorer->wordCount, sizeof *placed->masks);
        if (placed->masks == NULL) {
            return pvtContext_GetStatus(context);
        }
    }
    const bool samePlane =
        placed->panel.count > 0 && IsSamePlane(&placed->panel.plane, &panel->plane);
    if (panel->count > 0 && !samePlane) {
        const pvtStatus status =
            pvtSliceAllowed(context, arrangement, &panel->plane, NULL, &placed->cells);
        if (status != PVT_OK) {
            return status;
        }
    }
    const int before = placed->panel.count > 0 ? placed->panel.count - 2 : 0;
    const int after = panel->count > 0 ? panel->count - 2 : 0;
    arrangement->triangles += after - before;
    placed->panel = *panel;
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        DrawPanel(arrangement, m, panel, placed->masks + m * scorer->wordCount);
    }
    return PVT_OK;
}

pvtStatus pvtApplyChange(pvtContext* context, pvtArrangement* arrangement, const pvtChange* change)
{
    for (int i = 0; i < change->count; ++i) {
        const pvtStatus status =
            PlacePanel(context, arrangement, change->slots[i], &change->panels[i]);
        if (status != PVT_OK) {
            return status;
        }
    }
    const pvtScorer* scorer = &arrangement->scorer;
    arrangement->value = 0.0;
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        CountLayers(arrangement, m);
        const uint64_t* once = GetLayers(arrangement, m);
        if (memcmp(once, arrangement->covered.masks[m].rows, scorer->wordCount * sizeof *once) !=
            0) {
            pvtAssignRows(scorer, &arrangement->covered, m, once);
        }
        arrangement->value += arrangement->covered.masks[m].value;
    }
    return PVT_OK;
}
