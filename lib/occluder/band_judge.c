// SPDX-License-Identifier: MIT
// Around a surface triangles may hide what it does not. How much that is is measured when they are
// made: where it is too much they begin again, with less that may be wrong, and then in a narrower
// band.
#include "bands.h"

#include "base/context.h"

#include <math.h>

enum {
    MOST_TRIES = 3, // where an error that was asked for says how far triangles may stray
    TRIAL_VIEWS = 32,
    TRIAL_QUADS = 4000
};

// Of uniform quads that triangles hide, the part that the surface has to hide as well.
static const double LEAST_PRECISION = 0.999;
// Of what triangles hide, the part that may be wrong as they climb at first: they see it in pixels
// a quarter as fine. Where that was not good enough it becomes less, by so much at once at most.
static const double FIRST_WRONG = 0.0006, LEAST_WRONG = 1e-5, LEAST_FACTOR = 0.1;
// More than so many times as much as may be seen asks for more than one step at once.
static const double FAR_OFF = 4.0;

pvtStatus pvtScoreOccluder(pvtContext* context, const pvtBuild* build, const pvtMesh* occluder,
                           bool isTrial, pvtQuadScore* score)
{
    const bool isAround = build->options->views.list == NULL && !build->options->views.aboveOnly;
    pvtVec3* directions = pvtAllocate(context, build->views.count, sizeof *directions);
    if (directions == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t v = 0; v < build->views.count; ++v) {
        directions[v] = build->views.views[v].direction;
    }
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    if (isTrial) {
        options.views = TRIAL_VIEWS;
        options.quads = TRIAL_QUADS;
    }
    if (!isAround) {
        options.views = (int)build->views.count;
        options.directions = directions;
    }
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

// The next one that is narrower; off where there is none and less that may be wrong does not help.
static void PlanNarrower(pvtBuild* build, bool isFarOff)
{
    pvtBandPlan* band = &build->band;
    int number = PVT_BAND_COUNT;
    while (number > 0 && pvtGetBandReach(build, number - 1) >= band->reach) {
        --number;
    }
    number -= isFarOff && number >= PVT_BAND_STEP ? PVT_BAND_STEP : 1;
    if (number >= 0) {
        band->reach = pvtGetBandReach(build, number);
    } else if (band->mostWrong < LEAST_WRONG) {
        *band = (pvtBandPlan){.isOff = true};
    }
}

// Whether sheets hide more than a band that is good enough.
static bool AreSheetsBetter(const pvtBuild* build, const pvtQuadScore* score)
{
    return build->isBand && build->options->error == 0.0 && score->precision >= LEAST_PRECISION &&
           score->recall < build->band.sheetRecall;
}

// What is left to try: triangles that may hide less wrongly, and then have to keep closer to the
// surface; false where how far they may stray is given.
static bool PlanNext(pvtBuild* build, double precision)
{
    pvtBandPlan* band = &build->band;
    const double wrong = 1.0 - precision;
    const bool isFarOff = wrong > FAR_OFF * (1.0 - LEAST_PRECISION);
    band->mostWrong = pvtGetMostWrong(build) * fmax(FIRST_WRONG / wrong, LEAST_FACTOR);
    ++band->tries;
    if (build->options->error > 0.0) {
        return band->tries < MOST_TRIES;
    }
    if (isFarOff || band->tries > 1) {
        PlanNarrower(build, isFarOff);
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

static const char* GetReason(const pvtBandPlan* band)
{
    return band->isThin   ? "what fits inside hides next to nothing"
           : band->isBare ? "much of the surface has no inside behind it"
                          : "there is next to nothing inside";
}

static void TellBand(pvtContext* context, const pvtBuild* build, double precision)
{
    const pvtBuildStats* stats = &build->stats;
    const double voxels = stats->tolerance / stats->voxelSize;
    pvtWarnOnce(context,
                "%s at %d voxels, and the surface is not flat: triangles may stray from it by %.3g "
                "(%.3g voxel%s)%s; %.2g %% of what they hide can be seen",
                GetReason(&build->band), build->band.resolution, stats->tolerance, voxels,
                fabs(voxels - 1.0) < 0.005 ? "" : "s",
                build->options->error > 0.0
                    ? ", as the error allows"
                    : ", unless --tolerance sets how far, or less with a larger --budget",
                100.0 * (1.0 - precision));
}

double pvtGetMostWrong(const pvtBuild* build)
{
    if (!build->isBand) {
        return 0.0;
    }
    return build->band.mostWrong > 0.0 ? build->band.mostWrong : FIRST_WRONG;
}

// Panels within a voxel of what is as thin as that stand out at its sides.
static pvtStatus JudgePanels(pvtContext* context, pvtBuild* build)
{
    pvtQuadScore score = {0};
    const pvtStatus status = pvtScoreOccluder(context, build, &build->occluder.mesh, false, &score);
    if (status != PVT_OK || score.precision >= LEAST_PRECISION) {
        return status;
    }
    if (!build->band.mayStray && HasTime(build)) {
        build->band = (pvtBandPlan){.isOff = true, .keepsClose = true, .wantsAgain = true};
    } else {
        pvtWarnOnce(context,
                    "parts are thinner than a voxel: %.2g %% of what panels on them hide can be "
                    "seen; a higher --resolution keeps closer to them",
                    100.0 * (1.0 - score.precision));
    }
    return PVT_OK;
}

pvtStatus pvtJudgeStep(pvtContext* context, pvtBuild* build)
{
    if (build->band.reach == 0.0) {
        const bool maySee = pvtMayPanelsStray(build) && build->occluder.mesh.triangleCount > 0;
        return maySee ? JudgePanels(context, build) : PVT_OK;
    }
    pvtQuadScore score = {0};
    pvtStatus status = PVT_OK;
    if (build->occluder.mesh.triangleCount > 0) {
        status = pvtScoreOccluder(context, build, &build->occluder.mesh, false, &score);
    }
    if (status != PVT_OK) {
        return status;
    }
    if (AreSheetsBetter(build, &score) && HasTime(build)) {
        build->band = (pvtBandPlan){.isOff = true, .wantsAgain = true};
        return PVT_OK;
    }
    build->band.wantsAgain = build->isBand && score.precision < LEAST_PRECISION && HasTime(build) &&
                             PlanNext(build, score.precision);
    if (!build->band.wantsAgain) {
        TellBand(context, build, score.precision);
    }
    return PVT_OK;
}
