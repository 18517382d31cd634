// SPDX-License-Identifier: MIT
// What quick trials tell of panels on a surface, and of bands around it, before any triangles are
// made with care.
#include "bands.h"
#include "ceiling.h"

#include "base/context.h"

#include <math.h>

enum { MIDDLE_REACH = 4 }; // the band that is looked at first

// Of what the touched voxels hide: a mesh that hides less has gaps that they do not show, as leaves
// and twigs have: 0.1 to 0.5, where landscapes have 0.8 to 0.9. A band need not be tried.
static const double WHOLE = 0.5;
// Of what a band as a whole hides, at the widest at 256 voxels: where the touched voxels hide less
// than this, more than their rim has grown. Below it goes by the reach, a voxel at a time.
static const double RIM_LOSS = 0.15, MOST_LOSS = 0.45;
// Of what the surface hides: where a selection in a band, without refinement, hides this part of
// it, there is room for triangles that hide nearly all in the end.
static const double WIDE_ENOUGH = 0.8;
// A strict occluder of this recall will do: panels on the surface where there is no inside, and
// where there is one behind a part of it, what is selected in there as well, of which refinement
// makes more.
static const double ENOUGH_RECALL = 0.6, ENOUGH_INSIDE = 0.3;
// Of what the surface hides: where a selection on sheets hides less, sheets farther from it are
// tried, and taken where they hide so many times as much.
static const double NEARLY_ALL = 0.9, MUCH_MORE = 1.1;
// Of the surface: where sheets take less it is not flat, and a selection need not be tried.
static const double FLAT_SHARE = 0.5;

// What is known of triangles within some voxels before any are made with care. [wu³] measures.
typedef struct Trial {
    bool hasRoom;    // for a polygon: else nothing is measured
    double selected; // of a quick selection
    double mesh;
    double touched; // of the touched voxels
    double allowed; // of all voxels that triangles may lie in
    double recall;  // of the selection on sheets
} Trial;

static pvtOccluder* GetSelected(pvtBuild* build)
{
    return build->flat.loops.loopCount > 0 ? &build->flat : &build->occluder;
}

// The mesh's own measure stays, where it is known.
static pvtStatus MeasureSelection(pvtContext* context, pvtBuild* build, Trial* trial)
{
    *trial = (Trial){.mesh = trial->mesh};
    pvtStatus status = pvtSelectWithin(context, build);
    if (status == PVT_NOTHING_INSIDE) {
        return PVT_OK;
    }
    trial->hasRoom = true;
    if (status == PVT_OK) {
        status = pvtMeasureTriangles(context, build, &GetSelected(build)->mesh, &trial->selected);
    }
    return status == PVT_OK && trial->mesh == 0.0
               ? pvtMeasureTriangles(context, build, build->mesh, &trial->mesh)
               : status;
}

// What was selected in the build tells its views.
static pvtStatus MeasureVoxels(pvtContext* context, const pvtBitGrid* surface,
                               const pvtBuild* build, Trial* trial)
{
    const pvtMeasureGridOptions options = {&build->views, &build->bounds, PVT_MEASURE_SIZE};
    const pvtStatus status = pvtMeasureGrid(context, &options, surface, NULL, &trial->touched);
    return status == PVT_OK
               ? pvtMeasureGrid(context, &options, &build->allowed, NULL, &trial->allowed)
               : status;
}

// Of what the mesh hides.
static double GetHidden(const Trial* trial)
{
    return trial->mesh > 0.0 ? trial->selected / trial->mesh : 0.0;
}

static bool IsEnough(const pvtBuild* build, const Trial* trial)
{
    return trial->recall >= (pvtHasNoInside(build) ? ENOUGH_RECALL : ENOUGH_INSIDE) ||
           GetHidden(trial) >= NEARLY_ALL;
}

static pvtBuildOptions GetTrialOptions(const pvtBuild* build)
{
    pvtBuildOptions options = *build->options;
    options.effort = PVT_EFFORT_FAST;
    options.createSlicer = NULL;
    options.releaseSlicer = NULL;
    return options;
}

// With cracks between panels that nearly touch closed, as they will be: any would take much of it.
static pvtStatus ScorePanels(pvtContext* context, pvtBuild* scratch, double deviation,
                             double* recall)
{
    pvtOccluder* panels = GetSelected(scratch);
    pvtQuadScore score = {0};
    pvtStatus status =
        pvtGrowSheetPanels(context, &scratch->sheets, deviation, scratch->mesh, panels);
    if (status == PVT_OK) {
        status = pvtScoreOccluder(context, scratch, &panels->mesh, true, &score);
    }
    *recall = score.recall;
    return status;
}

static pvtStatus TrySheets(pvtContext* context, const pvtBuild* build, Trial* trial)
{
    const pvtBuildOptions options = GetTrialOptions(build);
    pvtBuild scratch = {.options = &options,
                        .mesh = build->mesh,
                        .started = build->started,
                        .stats = build->stats,
                        .allowed = build->allowed,
                        .cells = build->cells,
                        .volume = build->volume,
                        .bounds = build->bounds,
                        .sheets = build->sheets};
    pvtStatus status = MeasureSelection(context, &scratch, trial);
    if (status == PVT_OK && trial->hasRoom) {
        status = ScorePanels(context, &scratch, build->deviation, &trial->recall);
    }
    // These stay the build's.
    scratch.allowed = (pvtBitGrid){0};
    scratch.cells = (pvtCellGrid){0};
    scratch.volume = (pvtSliceVolume){0};
    scratch.sheets = (pvtSheetSet){0};
    pvtBuild_Free(context, &scratch);
    return status;
}

static pvtStatus TryReach(pvtContext* context, const pvtBuild* build, double reach, Trial* trial)
{
    pvtBuildOptions options = GetTrialOptions(build);
    pvtBuild scratch = {
        .options = &options, .mesh = build->mesh, .started = build->started, .stats = build->stats};
    options.budget = pvtGetAscentBudget(build);
    pvtSolid padded;
    pvtStatus status = pvtPadSolid(context, &build->solid, reach, &padded);
    if (status == PVT_OK) {
        status = pvtAllowBand(context, &padded, reach, &scratch);
    }
    if (status == PVT_OK) {
        status = MeasureSelection(context, &scratch, trial);
    }
    if (status == PVT_OK && trial->hasRoom) {
        status = MeasureVoxels(context, &padded.surface, &scratch, trial);
    }
    pvtSolid_Free(context, &padded);
    pvtBuild_Free(context, &scratch);
    return status;
}

// Whether nothing but the rim grows when the surface does.
static bool IsWhole(const Trial* trial, double voxels)
{
    const double kept = 1.0 - fmin(RIM_LOSS * voxels, MOST_LOSS);
    return !trial->hasRoom || (trial->touched > 0.0 && trial->mesh >= WHOLE * trial->touched &&
                               trial->touched >= kept * trial->allowed);
}

// Whether a band may be used, and whether it is wide enough.
static pvtStatus JudgeReach(pvtContext* context, const pvtBuild* build, int number, Trial* trial,
                            bool* isWhole)
{
    const double voxelsPerUnit =
        (double)PVT_BAND_RESOLUTION / build->stats.resolution / build->stats.voxelSize;
    const double reach = pvtGetBandReach(build, number);
    const pvtStatus status = TryReach(context, build, reach, trial);
    *isWhole = status == PVT_OK && IsWhole(trial, reach * voxelsPerUnit);
    return status;
}

pvtStatus pvtFindBandReach(pvtContext* context, const pvtBuild* build, double* reach)
{
    const int first = build->options->error > 0.0 ? 0 : MIDDLE_REACH;
    Trial trial = {0};
    bool isWhole = false, isWide = true, isFirstWide = false;
    int best = -1;
    pvtStatus status = PVT_OK;
    // Without gaps, and wide enough: then a narrower one may do as well.
    for (int i = first; i >= 0 && (isWide || !isWhole) && status == PVT_OK; i -= PVT_BAND_STEP) {
        if (i == first || pvtGetBandReach(build, i) < pvtGetBandReach(build, i + PVT_BAND_STEP)) {
            status = JudgeReach(context, build, i, &trial, &isWhole);
            isWide = GetHidden(&trial) >= WIDE_ENOUGH;
        }
        best = isWhole && (isWide || best < 0) ? i : best;
        isFirstWide = i == first ? isWide : isFirstWide;
    }
    const int wider = first + PVT_BAND_STEP;
    if (status == PVT_OK && best == first && first > 0 && !isFirstWide &&
        pvtGetBandReach(build, wider) > pvtGetBandReach(build, first)) {
        status = JudgeReach(context, build, wider, &trial, &isWhole);
        best = isWhole ? wider : best;
    }
    *reach = status == PVT_OK && best >= 0 ? pvtGetBandReach(build, best) : 0.0;
    return status;
}

// Sheets a little farther from the surface are fewer and larger, and may hide more.
static pvtStatus TryFartherSheets(pvtContext* context, pvtBuild* build, Trial* trial)
{
    pvtSheetSet sheets = build->sheets;
    pvtBitGrid hiding = build->hiding;
    const pvtBox3 bounds = build->bounds;
    const double deviation = build->deviation, share = build->sheetShare;
    build->sheets = (pvtSheetSet){0};
    build->hiding = (pvtBitGrid){0};
    Trial farther = {.mesh = trial->mesh};
    pvtStatus status = pvtUseFartherSheets(context, build);
    if (status == PVT_OK) {
        status = TrySheets(context, build, &farther);
    }
    if (GetHidden(&farther) > MUCH_MORE * GetHidden(trial)) {
        *trial = farther;
    } else {
        const pvtSheetSet others = build->sheets;
        const pvtBitGrid otherHiding = build->hiding;
        build->sheets = sheets;
        build->hiding = hiding;
        build->bounds = bounds;
        build->deviation = deviation;
        build->sheetShare = share;
        sheets = others;
        hiding = otherHiding;
    }
    pvtSheetSet_Free(context, &sheets);
    pvtBitGrid_Free(context, &hiding);
    return status;
}

pvtStatus pvtChooseSheets(pvtContext* context, pvtBuild* build, bool* areEnough)
{
    Trial trial = {0};
    pvtStatus status = PVT_OK;
    if (build->sheetShare >= FLAT_SHARE || !pvtHasNoInside(build)) {
        status = TrySheets(context, build, &trial);
    }
    while (status == PVT_OK && trial.hasRoom && GetHidden(&trial) < NEARLY_ALL &&
           pvtMayUseFartherSheets(build)) {
        status = TryFartherSheets(context, build, &trial);
    }
    *areEnough = IsEnough(build, &trial);
    build->band.sheetRecall = trial.recall;
    return status;
}
