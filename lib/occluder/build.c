// SPDX-License-Identifier: MIT
// The whole of it, as a list of steps (Silvennoinen et al., Occluder Simplification using Planar
// Sections, 2014, section 4).
#include "base/context.h"
#include "steps.h"

typedef struct NamedStep {
    const char* name;
    pvtBuildStep* run;
    double* seconds;
} NamedStep;

static pvtStatus RunSteps(pvtContext* context, pvtBuild* build)
{
    const NamedStep steps[] = {
        // Lengths in voxels and in world units settle each other.
        {"sizes", pvtResolveSizes, &build->stats.seconds.voxelize},
        // The soup becomes voxels, whatever its topology: after this only the directions that its
        // faces look in are asked for.
        {"voxelize", pvtVoxelizeStep, &build->stats.seconds.voxelize},
        // What a flood from outside does not reach is inside; polygons may lie in part of it.
        {"solid", pvtFillStep, &build->stats.seconds.solid},
        // Where the surface has no inside behind it, it is its own occluder.
        {"sheets", pvtSheetStep, &build->stats.seconds.sections},
        // Where it is not flat either, triangles may lie within a band around it.
        {"band", pvtBandStep, &build->stats.seconds.sections},
        // Thousands of planes are tried, and the largest slice of each bin is kept.
        {"sections", pvtSearchStep, &build->stats.seconds.sections},
        // Slices become polygons that can be shortened down to one triangle.
        {"chains", pvtChainStep, &build->stats.seconds.chains},
        // The cut through all chains that hides most within the budget.
        {"select", pvtSelectStep, &build->stats.seconds.select},
        // Where that hides next to nothing, strictly inside, a band is tried as well.
        {"thin", pvtThinStep, &build->stats.seconds.select},
        // Panels that may leave the surface move, tilt and trade triangles while they hide more.
        {"refine", pvtRefineStep, &build->stats.seconds.refine},
        // Where all is to stay inside, triangles leave their planes and climb together.
        {"ascend", pvtAscendStep, &build->stats.seconds.refine},
        // The last pixels, one triangle at a time.
        {"bend", pvtBendStep, &build->stats.seconds.refine},
        // Around a surface triangles may hide what it does not: too much of that, and all begins
        // again with other rules.
        {"evaluate", pvtJudgeStep, &build->stats.seconds.check},
        // The promise is checked by other code than that which made it.
        {"check", pvtCheckStep, &build->stats.seconds.check},
    };
    const size_t count = sizeof steps / sizeof steps[0];
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < count && status == PVT_OK && !build->band.wantsAgain; ++i) {
        const double before = pvtGetSeconds();
        pvtBeginStage(context, steps[i].name);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : steps[i].run(context, build);
        *steps[i].seconds += pvtGetSeconds() - before;
        if (status == PVT_OK) {
            pvtReportProgress(context, 1.0);
        }
    }
    return status;
}

// With nothing but what was learned of bands, and the time that it took.
static void BeginAgain(pvtContext* context, const pvtBuildOptions* options, pvtBuild* build)
{
    pvtBuild_Free(context, build);
    pvtBuild next = {
        .options = options, .mesh = build->mesh, .started = build->started, .band = build->band};
    next.band.wantsAgain = false;
    next.stats.seconds = build->stats.seconds;
    *build = next;
}

// Whether all begins again: as planned, or where panels close to the surface were none.
static bool IsToBeginAgain(pvtBuild* build, pvtStatus status)
{
    if (status == PVT_NOTHING_INSIDE && build->band.keepsClose) {
        build->band = (pvtBandPlan){.isOff = true, .mayStray = true};
        return true;
    }
    return status == PVT_OK && build->band.wantsAgain;
}

pvtStatus pvtBuildOccluder(pvtContext* context, const pvtBuildOptions* options, const pvtMesh* mesh,
                           pvtOccluder* occluder, pvtBuildStats* stats)
{
    *occluder = (pvtOccluder){0};
    const double started = pvtGetSeconds();
    pvtBuild build = {.options = options, .mesh = mesh, .started = started};
    pvtStatus status = RunSteps(context, &build);
    while (IsToBeginAgain(&build, status)) {
        BeginAgain(context, options, &build);
        status = RunSteps(context, &build);
    }
    if (status == PVT_OK) {
        *occluder = build.occluder;
        build.occluder = (pvtOccluder){0};
    }
    pvtBuild_Free(context, &build);
    build.stats.seconds.total = pvtGetSeconds() - started;
    if (stats != NULL) {
        *stats = build.stats;
    }
    return status;
}
