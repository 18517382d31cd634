// SPDX-License-Identifier: MIT
// A surface that has no inside, or little, and is not flat, a landscape above all: triangles may
// lie within a band around it, which is as narrow as the budget allows. What they hide and the
// surface does not is measured when they are made: where that is too much they keep closer to its
// outline, and then the band becomes narrower.
#include "ceiling.h"
#include "steps.h"

#include "base/context.h"
#include "voxel/bit_grid.h"

#include <math.h>
#include <paravent/evaluate.h>

// [vx] How far a band reaches from the touched voxels, at 256 voxels along the longest side. One
// that is wide enough is looked for among every other one of them.
static const double REACHES[] = {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0};
enum { REACH_COUNT = sizeof REACHES / sizeof *REACHES, REACH_STEP = 2 };
static const double REACH_RESOLUTION = 256.0;
enum { MOST_RESOLUTION = 640 }; // along the longest side, for an error that was asked for
// Of what the touched voxels hide: a mesh that hides less has gaps that they do not show, as leaves
// and twigs have: 0.1 to 0.5, where landscapes have 0.8 to 0.9. A band need not be tried.
static const double WHOLE = 0.5;
// Of what a band as a whole hides, at the reaches above: where the touched voxels hide less than
// this, more than their rim has grown. Between them it goes by the reach.
static const double RIM_LOSS = 0.15, MOST_LOSS = 0.45;
// Of uniform quads that triangles hide, the part that the surface has to hide as well.
static const double LEAST_PRECISION = 0.999;
// More than so many times as much as may be seen asks for more than one step at once.
static const double FAR_OFF = 4.0;
enum {
    TRIAL_VIEWS = 32,
    JUDGE_VIEWS = 128,
    JUDGE_QUADS = 4000,
    JUDGE_PIXELS = 512,
    JUDGE_SEED = 7
};
// Of what the surface hides: where a selection without refinement hides this part of it, nearly all
// is hidden in the end; with half of this next to nothing.
static const double ENOUGH_SHARE = 0.5;
// Where there is an inside behind a part of the surface, a strict occluder of this recall will do.
static const double ENOUGH_RECALL = 0.25;
// Of what the surface hides: where a selection on sheets hides less, sheets farther from it are
// tried, and taken where they hide so many times as much.
static const double NEARLY_ALL = 0.9, MUCH_MORE = 1.1;
// Of the surface: where sheets take less it is not flat, and a selection need not be tried.
static const double FLAT_SHARE = 0.5;
// Of the touched voxels: an inside of fewer is none.
static const double LEAST_INSIDE = 0.01;
// Of the surface: where as much has no inside behind it, a band may help although there is one.
static const double BARE_SHARE = 0.3;

// What is known of triangles within some voxels before any are made with care. [wu³] measures.
typedef struct Trial {
    bool hasRoom;    // for a polygon: else nothing is measured
    double selected; // of a quick selection
    double mesh;
    double touched; // of the touched voxels
    double allowed; // of all voxels that triangles may lie in
    double recall;  // of the selection, where there is an inside; else 0
} Trial;

static double GetReach(const pvtBuild* build, int number)
{
    const double voxels = REACHES[number] * build->stats.resolution / REACH_RESOLUTION;
    return fmax(voxels, 1.0) * build->stats.voxelSize;
}

// What looks like a landscape may have an inside in a few folds.
static bool HasNoInside(const pvtBuild* build)
{
    const pvtSolid* solid = &build->solid;
    return solid->remedy.terrain ||
           (double)solid->strictCount < LEAST_INSIDE * (double)solid->surfaceCount;
}

// Whether there is no inside behind much of the surface: a buoy's hull is open below, though its
// lamp is not.
static bool IsOpen(const pvtBuild* build)
{
    return HasNoInside(build) || build->band.isBare ||
           build->sheets.bare > BARE_SHARE * build->sheets.area;
}

bool pvtMayUseBand(const pvtBuild* build)
{
    return pvtMayUseSheets(build) && !build->band.isOff && IsOpen(build);
}

// Lets triangles lie in the touched voxels of `solid` and within `reach` [wu] of them.
static pvtStatus AllowBand(pvtContext* context, const pvtSolid* solid, double reach,
                           pvtBuild* build)
{
    pvtBitGrid_Free(context, &build->allowed);
    pvtSliceVolume_Free(context, &build->volume);
    build->stats.tolerance = reach;
    pvtStatus status = pvtMakeAllowedGrid(context, solid, reach, &build->allowed);
    if (status == PVT_OK) {
        pvtFindVoxelBounds(&build->allowed, &build->bounds);
        status = pvtCreateSliceVolume(context, &build->allowed, &build->volume);
    }
    return status;
}

static pvtStatus Select(pvtContext* context, pvtBuild* build)
{
    pvtStatus status = pvtSearchStep(context, build);
    if (status == PVT_OK) {
        status = pvtChainStep(context, build);
    }
    return status == PVT_OK ? pvtSelectStep(context, build) : status;
}

// What `occluder` hides of what the mesh does, and besides, from where it is looked at: from so
// many directions where that is all around.
static pvtStatus Score(pvtContext* context, const pvtBuild* build, const pvtMesh* occluder,
                       int views, pvtQuadScore* score)
{
    const bool isAround = build->options->views.list == NULL && !build->options->views.aboveOnly;
    pvtVec3* directions = pvtAllocate(context, build->views.count, sizeof *directions);
    if (directions == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t v = 0; v < build->views.count; ++v) {
        directions[v] = build->views.views[v].direction;
    }
    const pvtEvaluateOptions options = {.views = isAround ? views : (int)build->views.count,
                                        .quads = JUDGE_QUADS,
                                        .pixels = JUDGE_PIXELS,
                                        .seed = JUDGE_SEED,
                                        .directions = isAround ? NULL : directions};
    pvtEvaluation evaluation = {0};
    const pvtStatus status =
        pvtEvaluateOccluders(context, &options, build->mesh, occluder, 1, &evaluation);
    if (status == PVT_OK) {
        *score = evaluation.occluders[0].uniform;
    }
    pvtEvaluation_Free(context, &evaluation);
    pvtRelease(context, directions);
    return status;
}

static const pvtMesh* GetSelected(const pvtBuild* build)
{
    return build->flat.loops.loopCount > 0 ? &build->flat.mesh : &build->occluder.mesh;
}

// The mesh's own measure stays, where it is known.
static pvtStatus MeasureSelection(pvtContext* context, pvtBuild* build, Trial* trial)
{
    *trial = (Trial){.mesh = trial->mesh};
    pvtStatus status = Select(context, build);
    if (status == PVT_NOTHING_INSIDE) {
        return PVT_OK;
    }
    trial->hasRoom = true;
    if (status == PVT_OK) {
        status = pvtMeasureTriangles(context, build, GetSelected(build), &trial->selected);
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

static bool IsEnough(const Trial* trial)
{
    return GetHidden(trial) >= ENOUGH_SHARE || trial->recall >= ENOUGH_RECALL;
}

static pvtBuildOptions GetTrialOptions(const pvtBuild* build)
{
    pvtBuildOptions options = *build->options;
    options.effort = PVT_EFFORT_FAST;
    options.createSlicer = NULL;
    options.releaseSlicer = NULL;
    return options;
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
    if (status == PVT_OK && trial->hasRoom && !HasNoInside(build)) {
        pvtQuadScore score = {0};
        status = Score(context, &scratch, GetSelected(&scratch), TRIAL_VIEWS, &score);
        trial->recall = score.recall;
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
    pvtStatus status = AllowBand(context, &build->solid, reach, &scratch);
    if (status == PVT_OK) {
        status = MeasureSelection(context, &scratch, trial);
    }
    if (status == PVT_OK && trial->hasRoom) {
        status = MeasureVoxels(context, &build->solid.surface, &scratch, trial);
    }
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

// The narrowest band that is wide enough, or the widest; 0 where it would close gaps. With an error
// that was asked for only whether there may be one.
static pvtStatus FindReach(pvtContext* context, const pvtBuild* build, double* reach)
{
    const double voxelsPerUnit =
        REACH_RESOLUTION / build->stats.resolution / build->stats.voxelSize;
    Trial trial = {0};
    pvtStatus status = PVT_OK;
    *reach = 0.0;
    const int count = build->options->error > 0.0 ? 1 : REACH_COUNT;
    for (int i = 0; i < count && !IsEnough(&trial) && status == PVT_OK; i += REACH_STEP) {
        const double next = GetReach(build, i);
        if (next > *reach) {
            *reach = next;
            status = TryReach(context, build, next, &trial);
            if (status == PVT_OK && !IsWhole(&trial, next * voxelsPerUnit)) {
                *reach = 0.0;
                return status;
            }
        }
    }
    return status;
}

static pvtStatus UseBand(pvtContext* context, pvtBuild* build, double reach)
{
    pvtSheetSet_Free(context, &build->sheets);
    pvtBitGrid_Free(context, &build->hiding);
    pvtCellGrid_Free(context, &build->cells);
    pvtTouching_Free(context, &build->touching);
    build->isBand = true;
    const pvtStatus status = AllowBand(context, &build->solid, reach, build);
    pvtSetErrorBound(&build->stats);
    return status;
}

// A bound of the error leaves most to a band of small voxels; of those that are not too many the
// smallest. 0: none.
static double FindErrorReach(const pvtBuild* build)
{
    static const double voxels[] = {4.0, 2.0, 1.0};
    for (int i = 0; i < 3; ++i) {
        const double finer = (sqrt(3.0) + voxels[i]) / sqrt(3.0);
        if (build->stats.resolution * finer <= MOST_RESOLUTION) {
            return voxels[i];
        }
    }
    return 0.0;
}

// From the beginning, with so many voxels as the tolerance, and the same error.
static pvtStatus Restart(pvtContext* context, pvtBuild* build, double voxels)
{
    build->ownOptions = *build->options;
    build->ownOptions.tolerance = (pvtLength){voxels, true};
    pvtBuild_Free(context, build);
    build->options = &build->ownOptions;
    pvtStatus status = pvtResolveSizes(context, build);
    if (status == PVT_OK) {
        status = pvtVoxelizeStep(context, build);
    }
    if (status == PVT_OK) {
        status = pvtFillStep(context, build);
    }
    // Smaller voxels may have found one.
    build->isBand = status == PVT_OK && (HasNoInside(build) || build->band.isBare);
    pvtBeginStage(context, "band");
    return status;
}

static pvtStatus TakeReach(pvtContext* context, pvtBuild* build, double reach)
{
    build->band.reach = reach;
    build->band.resolution = build->stats.resolution;
    build->band.isBare = !HasNoInside(build);
    if (build->options->error == 0.0) {
        return UseBand(context, build, reach);
    }
    const double voxels = FindErrorReach(build);
    if (voxels == 0.0) {
        build->band = (pvtBandPlan){.isOff = true};
        return PVT_OK;
    }
    return Restart(context, build, voxels);
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

// The sheets that hide most, where the surface is flat enough for any, and whether they hide
// enough: close to it half of what the mesh does, farther off nearly all.
static pvtStatus ChooseSheets(pvtContext* context, pvtBuild* build, bool* areEnough)
{
    Trial trial = {0};
    pvtStatus status = PVT_OK;
    if (build->sheetShare >= FLAT_SHARE || !HasNoInside(build)) {
        status = TrySheets(context, build, &trial);
    }
    *areEnough = IsEnough(&trial);
    while (status == PVT_OK && trial.hasRoom && GetHidden(&trial) < NEARLY_ALL &&
           pvtMayUseFartherSheets(build)) {
        status = TryFartherSheets(context, build, &trial);
        *areEnough = *areEnough || GetHidden(&trial) >= NEARLY_ALL;
    }
    return status;
}

static pvtStatus TryBand(pvtContext* context, pvtBuild* build)
{
    bool areEnough = false;
    double reach = 0.0;
    pvtStatus status = ChooseSheets(context, build, &areEnough);
    if (status == PVT_OK && pvtMayUseBand(build) && !areEnough) {
        status = FindReach(context, build, &reach);
    }
    return status == PVT_OK && reach > 0.0 ? TakeReach(context, build, reach) : status;
}

pvtStatus pvtBandStep(pvtContext* context, pvtBuild* build)
{
    pvtStatus status = PVT_OK;
    if (pvtMayUseSheets(build) && IsOpen(build)) {
        status = build->band.reach > 0.0 ? TakeReach(context, build, build->band.reach)
                                         : TryBand(context, build);
    }
    // A band is a tolerance, with which there are no sheets.
    return status == PVT_OK && pvtMayUseSheets(build) ? pvtSheetStepWithoutBand(context, build)
                                                      : status;
}

// The next one that is narrower.
static void PlanNarrower(pvtBuild* build, bool isFarOff)
{
    pvtBandPlan* band = &build->band;
    int number = REACH_COUNT;
    while (number > 0 && GetReach(build, number - 1) >= band->reach) {
        --number;
    }
    number -= isFarOff && number >= REACH_STEP ? REACH_STEP : 1;
    band->isOff = number < 0;
    band->reach = band->isOff ? 0.0 : GetReach(build, number);
}

// What is left to try: triangles that keep closer to the outline, and then to the surface; false
// where an error that was asked for says how far they may stray.
static bool PlanNext(pvtBuild* build, double precision)
{
    pvtBandPlan* band = &build->band;
    const bool isFarOff = 1.0 - precision > FAR_OFF * (1.0 - LEAST_PRECISION);
    const bool hasError = build->options->error > 0.0;
    if (!band->isClose) {
        band->isClose = true;
        band->isHard = isFarOff;
    } else if (hasError && band->isHard) {
        return false;
    } else {
        band->isHard = true;
        if (!hasError) {
            PlanNarrower(build, isFarOff);
        }
    }
    return true;
}

// Whether a deadline leaves as much time as it took so far.
static bool HasTime(const pvtBuild* build)
{
    const pvtEnough enough = pvtGetEnough(build);
    const double deadline = build->options->deadline;
    return pvtEnough_FindEnd(&enough) == NULL &&
           (deadline == 0.0 || pvtGetSeconds() - build->started < 0.5 * deadline);
}

static void TellBand(pvtContext* context, const pvtBuild* build, double precision)
{
    const pvtBuildStats* stats = &build->stats;
    pvtWarnOnce(context,
                "%s at %d voxels, and the surface is not flat: triangles may stray from it by %.3g "
                "(%.3g voxels)%s; %.2g %% of what they hide can be seen",
                build->band.isBare ? "much of the surface has no inside behind it"
                                   : "there is next to nothing inside",
                build->band.resolution, stats->tolerance, stats->tolerance / stats->voxelSize,
                build->options->error > 0.0
                    ? ", as the error allows"
                    : ", unless --tolerance sets how far, or less with a larger --budget",
                100.0 * (1.0 - precision));
}

pvtStatus pvtJudgeBandStep(pvtContext* context, pvtBuild* build)
{
    if (build->band.reach == 0.0) {
        return PVT_OK;
    }
    pvtQuadScore score = {0};
    pvtStatus status = PVT_OK;
    if (build->occluder.mesh.triangleCount > 0) {
        status = Score(context, build, &build->occluder.mesh, JUDGE_VIEWS, &score);
    }
    if (status != PVT_OK) {
        return status;
    }
    // What is seen from few views is more often too little than too much.
    const double precision = score.precision + 0.5 * score.precisionError;
    build->band.wantsAgain = build->isBand && precision < LEAST_PRECISION && HasTime(build) &&
                             PlanNext(build, precision);
    if (!build->band.wantsAgain) {
        TellBand(context, build, score.precision);
    }
    return PVT_OK;
}
