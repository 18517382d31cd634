// SPDX-License-Identifier: MIT
// Ari Silvennoinen, Hannu Saransaari, Samuli Laine, Jaakko Lehtinen: Occluder Simplification using
// Planar Sections, Computer Graphics Forum, 2014, figure 5. Coarser voxels close wider openings, so
// that an occluder for afar is simpler than any made from the fine ones. Unlike there, each level
// states how far it may be wrong, and the distance from which on that cannot be seen.
#include <paravent/ladder.h>

#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <stdio.h>

enum { FINEST_BUDGET = 64, COARSEST_BUDGET = 4, MAX_SIDE = 65536 };

pvtLadderOptions pvtDefaultLadderOptions(void)
{
    return (pvtLadderOptions){.build = pvtDefaultBuildOptions(),
                              .coarseTolerance = {1.0, true},
                              .levelCount = 4,
                              .screen = pvtDefaultScreenOptions()};
}

void pvtLadder_Free(pvtContext* context, pvtLadder* ladder)
{
    for (size_t i = 0; i < ladder->count; ++i) {
        pvtOccluder_Free(context, &ladder->levels[i].occluder);
    }
    pvtRelease(context, ladder->levels);
    *ladder = (pvtLadder){0};
}

static pvtStatus CheckScreen(pvtContext* context, const pvtScreenOptions* screen)
{
    if (!isfinite(screen->pixelError) || screen->pixelError <= 0.0) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the pixel error is %g; it must be above 0 and finite", screen->pixelError);
    }
    if (!(screen->fieldOfView > 0.0 && screen->fieldOfView < 180.0)) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the field of view is %g degrees; it must be above 0 and below 180",
                       screen->fieldOfView);
    }
    if (screen->height < 1 || screen->height > MAX_SIDE || screen->width < 0 ||
        screen->width > MAX_SIDE) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the screen is %d by %d pixels; a side has 1 to %d", screen->width,
                       screen->height, MAX_SIDE);
    }
    return PVT_OK;
}

static pvtStatus CheckLevels(pvtContext* context, const pvtLadderOptions* options)
{
    const int count = options->levelCount;
    if (count < 1 || count > PVT_MAX_LEVELS) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%d levels; there can be 1 to %d", count,
                       PVT_MAX_LEVELS);
    }
    const double* errors = options->errors;
    for (int i = 0; i < count && errors[0] != 0.0; ++i) {
        const double least = i == 0 ? 0.0 : errors[i - 1];
        if (!isfinite(errors[i]) || errors[i] <= least) {
            return pvtFail(context, PVT_INVALID_ARGUMENT,
                           "LOD%d: the error is %g; it must be above %g and finite", i, errors[i],
                           least);
        }
    }
    const int* budgets = options->budgets;
    for (int i = 0; i < count && budgets[0] != 0; ++i) {
        const int most = i == 0 ? 65535 : budgets[i - 1] - 1;
        if (budgets[i] < 1 || budgets[i] > most) {
            return pvtFail(context, PVT_INVALID_ARGUMENT,
                           "LOD%d: the budget is %d triangles; it must be 1 to %d", i, budgets[i],
                           most);
        }
    }
    return PVT_OK;
}

static int GetBudget(const pvtLadderOptions* options, int number)
{
    if (options->budgets[0] != 0) {
        return options->budgets[number];
    }
    const int last = options->levelCount - 1;
    const int finest = COARSEST_BUDGET << last;
    return (finest > FINEST_BUDGET ? finest : FINEST_BUDGET) >> number;
}

// 0 for the finest level by default: then the resolution holds.
static double GetError(const pvtLadderOptions* options, const pvtLadder* ladder, int number)
{
    if (options->errors[0] != 0.0 || number == 0) {
        return options->errors[number];
    }
    return ldexp(ladder->levels[0].stats.errorBound, number);
}

// The library's stages know one occluder: which of them failed is said here.
static pvtStatus NameLevel(pvtContext* context, int number, pvtStatus status)
{
    if (status == PVT_CANCELLED) {
        return status;
    }
    char reason[1024];
    (void)snprintf(reason, sizeof reason, "%s", pvtContext_GetMessage(context));
    return pvtFail(context, status, "LOD%d: %s", number, reason);
}

static void LeaveOut(pvtContext* context, const char* reason)
{
    pvtLog(context, PVT_LOG_WARNING, "the level is left out, and coarser ones move up: %s", reason);
}

// Builds one level behind those that are there; it is left out when it is of no use.
static pvtStatus BuildLevel(pvtContext* context, const pvtLadderOptions* options,
                            const pvtMesh* mesh, int number, pvtLadder* ladder)
{
    pvtSetStageScope(context, "LOD%d", number);
    pvtLevel* level = &ladder->levels[ladder->count];
    const pvtLevel* finer = ladder->count > 0 ? level - 1 : NULL;
    *level = (pvtLevel){.number = number, .budget = GetBudget(options, number)};
    pvtBuildOptions build = options->build;
    build.deadline = 0.0;
    build.error = GetError(options, ladder, number);
    build.tolerance = number == 0 ? options->build.tolerance : options->coarseTolerance;
    if (finer != NULL) {
        const int fewer = (int)finer->occluder.mesh.triangleCount - 1;
        level->budget = level->budget < fewer ? level->budget : fewer;
        if (fewer == 0) {
            LeaveOut(context, "the level before it has a single triangle");
            return PVT_OK;
        }
    }
    build.budget = level->budget;
    const pvtStatus status =
        pvtBuildOccluder(context, &build, mesh, &level->occluder, &level->stats);
    if (status == PVT_NOTHING_INSIDE && finer != NULL) {
        LeaveOut(context, pvtContext_GetMessage(context));
        return PVT_OK;
    }
    if (status != PVT_OK) {
        return NameLevel(context, number, status);
    }
    if (finer != NULL && level->stats.errorBound <= finer->stats.errorBound) {
        LeaveOut(context, "its voxels would be no larger than those before it");
        pvtOccluder_Free(context, &level->occluder);
        return PVT_OK;
    }
    ++ladder->count;
    return PVT_OK;
}

// The largest distance from `center` to a corner of the box.
static double GetReach(pvtVec3 center, const pvtBox3* box)
{
    const pvtVec3 a = pvtSub(center, box->lower);
    const pvtVec3 b = pvtSub(box->upper, center);
    return pvtLength3((pvtVec3){fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)});
}

// Errors are measured at the mesh; coverage is what an engine sees, which is the finest occluder.
static void PlaceLevels(const pvtLadderOptions* options, const pvtMesh* mesh, pvtLadder* ladder)
{
    const pvtBox3 box = pvtMesh_GetBounds(&ladder->levels[0].occluder.mesh);
    ladder->center = pvtScale(pvtAdd(box.lower, box.upper), 0.5);
    ladder->radius = 0.5 * pvtLength3(pvtSub(box.upper, box.lower));
    const pvtBox3 bounds = pvtMesh_GetBounds(mesh);
    const double reach = GetReach(ladder->center, &bounds);
    for (size_t i = 0; i < ladder->count; ++i) {
        pvtLevel* level = &ladder->levels[i];
        level->distance = pvtGetErrorDistance(&options->screen, level->stats.errorBound, reach);
        level->screenCoverage =
            pvtGetScreenCoverage(&options->screen, ladder->radius, level->distance);
    }
}

pvtStatus pvtBuildLadder(pvtContext* context, const pvtLadderOptions* options, const pvtMesh* mesh,
                         pvtLadder* ladder)
{
    *ladder = (pvtLadder){0};
    pvtStatus status = CheckScreen(context, &options->screen);
    if (status == PVT_OK) {
        status = CheckLevels(context, options);
    }
    if (status != PVT_OK) {
        return status;
    }
    ladder->levels = pvtAllocate(context, (size_t)options->levelCount, sizeof *ladder->levels);
    if (ladder->levels == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (int i = 0; i < options->levelCount && status == PVT_OK; ++i) {
        status = BuildLevel(context, options, mesh, i, ladder);
    }
    pvtSetStageScope(context, "%s", "");
    if (status != PVT_OK) {
        pvtLadder_Free(context, ladder);
        return status;
    }
    PlaceLevels(options, mesh, ladder);
    return PVT_OK;
}
