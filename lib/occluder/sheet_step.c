// SPDX-License-Identifier: MIT
// Sheets within a build: how far the surface may lie from them, what they add, and what is said
// about them.
#include "steps.h"

#include "base/context.h"
#include "base/vector.h"
#include "ceiling.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MIN_SHEETS = 128, MAX_SHEETS = 512 };

// [vx] How far the surface may lie from a panel on it: less than √3, so that the bound of the
// strict interior holds for sheets as well. All but the first are for meshes without any.
static const double DEVIATIONS[] = {0.03125, 0.25, 1.0};
enum { DEVIATION_COUNT = sizeof DEVIATIONS / sizeof *DEVIATIONS };
// Sheets that take this part of the surface need not lie any farther off; nearly all of it, where
// the next step is a small one.
static const double ENOUGH[] = {0.9, 0.5};
// Less than this is not flat a little farther off, either: a band is tried first.
static const double HOPELESS = 0.25;

bool pvtMayUseSheets(const pvtBuild* build)
{
    return build->options->method == PVT_METHOD_PLANAR && build->stats.tolerance == 0.0;
}

static pvtStatus FindSheets(pvtContext* context, pvtBuild* build, double deviation)
{
    const int wanted = 2 * build->options->budget;
    const pvtSheetOptions options = {
        .deviation = deviation,
        .maxCount = wanted < MIN_SHEETS   ? MIN_SHEETS
                    : wanted > MAX_SHEETS ? MAX_SHEETS
                                          : wanted,
        .seed = build->options->seed,
        .allowed = &build->allowed,
    };
    pvtSheetSet_Free(context, &build->sheets);
    build->deviation = deviation;
    return pvtFindSheets(context, &options, build->mesh, &build->allowed.frame, &build->sheets);
}

static int CompareFalling(const void* left, const void* right)
{
    const double a = *(const double*)left;
    const double b = *(const double*)right;
    return (a < b) - (a > b);
}

// The part of the surface that as many sheets as the budget has quadrilaterals for would take.
static pvtStatus GetShare(pvtContext* context, const pvtBuild* build, double* share)
{
    const pvtSheetSet* set = &build->sheets;
    double* areas = pvtAllocate(context, set->count, sizeof *areas);
    if (areas == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t i = 0; i < set->count; ++i) {
        areas[i] = set->sheets[i].gain;
    }
    if (set->count > 0) {
        qsort(areas, set->count, sizeof *areas, CompareFalling);
    }
    const size_t panels = (size_t)build->options->budget / 2 + 1;
    *share = 0.0;
    for (size_t i = 0; i < set->count && i < panels; ++i) {
        *share += areas[i] / set->bare;
    }
    pvtRelease(context, areas);
    return PVT_OK;
}

// How far the surface may stray from sheets at most: where there is an inside, no farther than
// sheets beside it may.
static double GetMostDeviation(const pvtBuild* build)
{
    return build->band.keepsClose || pvtBitGrid_Count(&build->allowed) > 0
               ? DEVIATIONS[0]
               : DEVIATIONS[DEVIATION_COUNT - 1];
}

bool pvtMayPanelsStray(const pvtBuild* build)
{
    return build->sheets.count > 0 && build->deviation > DEVIATIONS[0];
}

// Sheets may reach into voxels that they do not pass over wholly.
static void WidenBySheets(pvtBuild* build)
{
    build->bounds = build->allowedBounds;
    pvtWidenBounds(&build->hiding, &build->bounds);
    const double h = build->stats.voxelSize;
    pvtBox3* box = &build->bounds;
    if (box->lower.x <= box->upper.x) {
        box->lower = pvtSub(box->lower, (pvtVec3){h, h, h});
        box->upper = pvtAdd(box->upper, (pvtVec3){h, h, h});
    }
}

bool pvtMayUseFartherSheets(const pvtBuild* build)
{
    return build->triedDeviations < DEVIATION_COUNT &&
           DEVIATIONS[build->triedDeviations] <= GetMostDeviation(build);
}

// With the next deviation that was not tried yet.
static pvtStatus FindFartherSheets(pvtContext* context, pvtBuild* build)
{
    const pvtStatus status = FindSheets(context, build, DEVIATIONS[build->triedDeviations++]);
    // Without any bare surface all of it has an inside behind it.
    build->sheetShare = 1.0;
    return status == PVT_OK && build->sheets.bare > 0.0
               ? GetShare(context, build, &build->sheetShare)
               : status;
}

// Sheets as close to the surface as it allows.
static pvtStatus FindClosestSheets(pvtContext* context, pvtBuild* build, bool isLast)
{
    pvtStatus status = PVT_OK;
    while (status == PVT_OK && pvtMayUseFartherSheets(build)) {
        const int tried = build->triedDeviations;
        if (tried > 0 &&
            (build->sheetShare >= ENOUGH[tried - 1] || (!isLast && build->sheetShare < HOPELESS))) {
            return PVT_OK;
        }
        status = FindFartherSheets(context, build);
    }
    return status;
}

static pvtStatus MarkSheets(pvtContext* context, pvtBuild* build)
{
    if (build->sheets.count == 0) {
        return PVT_OK;
    }
    pvtBitGrid_Free(context, &build->hiding);
    const pvtStatus status =
        pvtMarkSheets(context, &build->sheets, &build->allowed, &build->hiding);
    WidenBySheets(build);
    return status;
}

pvtStatus pvtSheetStep(pvtContext* context, pvtBuild* build)
{
    if (!pvtMayUseSheets(build) || build->band.reach > 0.0) {
        return PVT_OK;
    }
    const pvtStatus status = FindClosestSheets(context, build, !pvtMayUseBand(build));
    return status == PVT_OK ? MarkSheets(context, build) : status;
}

pvtStatus pvtUseFartherSheets(pvtContext* context, pvtBuild* build)
{
    const pvtStatus status = FindFartherSheets(context, build);
    return status == PVT_OK ? MarkSheets(context, build) : status;
}

pvtStatus pvtSheetStepWithoutBand(pvtContext* context, pvtBuild* build)
{
    const int tried = build->triedDeviations;
    pvtStatus status = FindClosestSheets(context, build, true);
    if (status == PVT_OK && build->triedDeviations > tried) {
        status = MarkSheets(context, build);
    }
    return status == PVT_OK && build->bounds.lower.x > build->bounds.upper.x
               ? pvtFailNothingInside(context, build)
               : status;
}

pvtStatus pvtAddSheets(pvtContext* context, const pvtCandidateOptions* options, pvtBuild* build)
{
    return pvtAddSheetCandidates(context, options, &build->volume, &build->sheets,
                                 &build->candidates);
}

pvtStatus pvtMeasureCeiling(pvtContext* context, pvtBuild* build)
{
    const bool hasSheets = build->hiding.words != NULL;
    const pvtBitGrid* grid = build->isBand ? &build->solid.surface
                             : hasSheets   ? &build->hiding
                                           : &build->allowed;
    const pvtMeasureGridOptions options = {&build->views, &build->bounds, PVT_MEASURE_SIZE};
    return pvtMeasureGrid(context, &options, grid, &build->cells, &build->stats.measureOfSolid);
}

static double GetWidth(const pvtMesh* mesh, size_t triangle)
{
    double longest = 0.0;
    pvtVec3 sides[3];
    for (size_t k = 0; k < 3; ++k) {
        const uint32_t* corners = mesh->indices + 3 * triangle;
        sides[k] = pvtSub(mesh->positions[corners[(k + 1) % 3]], mesh->positions[corners[k]]);
        longest = fmax(longest, pvtLength3(sides[k]));
    }
    return longest > 0.0 ? pvtLength3(pvtCross(sides[0], sides[1])) / longest : 0.0;
}

// The triangles that `counts` (one each, null: all) has some for and that are wider than this.
static pvtStatus TakeTriangles(pvtContext* context, const pvtMesh* mesh, const uint64_t* counts,
                               double width, pvtMesh* taken)
{
    uint32_t* indices = pvtAllocate(context, 3 * mesh->triangleCount, sizeof *indices);
    if (indices == NULL) {
        return pvtContext_GetStatus(context);
    }
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        if ((counts == NULL || counts[t] > 0) && GetWidth(mesh, t) > width) {
            memcpy(indices + 3 * count++, mesh->indices + 3 * t, 3 * sizeof *indices);
        }
    }
    const pvtStatus status =
        pvtCreateMesh(context, mesh->positions, mesh->positionCount, indices, count, taken);
    pvtRelease(context, indices);
    return status;
}

// What the promise says of panels on the surface: nothing is left of them without it, but what lies
// in allowed voxels and cells, and dust of a few roundings that is narrower than the slack.
static pvtStatus CheckPanels(pvtContext* context, pvtBuild* build, const uint64_t* isOutside)
{
    pvtBuildStats* stats = &build->stats;
    const pvtMesh* mesh = &build->occluder.mesh;
    const pvtSurfaceReach reach = {.distance = stats->deviation, .slack = stats->voxelSize / 256.0};
    const pvtInterior allowed = {.allowed = &build->allowed, .cells = &build->cells};
    pvtMesh outside = {0}, rest = {0}, wide = {0};
    pvtStatus status = TakeTriangles(context, mesh, isOutside, 0.0, &outside);
    if (status == PVT_OK) {
        status = pvtTakeOffSurface(context, &reach, build->mesh, &outside, &rest);
    }
    if (status == PVT_OK) {
        status = TakeTriangles(context, &rest, NULL, reach.slack, &wide);
    }
    if (status == PVT_OK) {
        status = pvtCheckOccluder(context, &allowed, &wide, &stats->outside);
    }
    pvtMesh_Free(context, &wide);
    pvtMesh_Free(context, &rest);
    pvtMesh_Free(context, &outside);
    return status;
}

void pvtCountSurfacePanels(pvtBuild* build)
{
    build->stats.surfacePanels = 0;
    for (size_t p = 0; p < build->occluder.loops.loopCount; ++p) {
        build->stats.surfacePanels +=
            pvtSheetSet_Find(&build->sheets, &build->occluder.planes[p]) != NULL ? 1 : 0;
    }
}

pvtStatus pvtCheckSheets(pvtContext* context, pvtBuild* build, const uint64_t* outside)
{
    pvtBuildStats* stats = &build->stats;
    if (stats->surfacePanels == 0) {
        return PVT_OK;
    }
    stats->deviation = build->deviation * stats->voxelSize;
    const pvtStatus status = stats->outside > 0 ? CheckPanels(context, build, outside) : PVT_OK;
    if (status == PVT_OK && build->solid.strictCount == 0) {
        pvtWarnOnce(
            context,
            "the mesh has no inside at %d voxels: all panels lie on its surface, within %.3g",
            stats->resolution, stats->deviation);
    }
    return status;
}
