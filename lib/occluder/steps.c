// SPDX-License-Identifier: MIT
#include "steps.h"

#include "ascent.h"
#include "base/context.h"
#include "base/vector.h"
#include "refine.h"
#include "voxel/bit_grid.h"
#include "voxel/outside.h"

#include <math.h>

enum {
    MIN_RESOLUTION = 8,
    MAX_RESOLUTION = 2048,
    MAX_REFINED = 512, // triangles: beyond, panels are so many that single moves hardly count
};

static const double SQRT3 = 1.7320508075688772;

pvtBuildOptions pvtDefaultBuildOptions(void)
{
    return (pvtBuildOptions){.budget = 64,
                             .resolution = 256,
                             .up = PVT_AXIS_Y,
                             .enclosed = -1,
                             .method = PVT_METHOD_PLANAR,
                             .effort = PVT_EFFORT_DEFAULT,
                             .views = pvtDefaultViewOptions(),
                             .seed = 1};
}

static void FreeCandidates(pvtContext* context, pvtBuild* build)
{
    pvtSliceVolume_Free(context, &build->volume);
    pvtSliceVolume_Free(context, &build->solidVolume);
    pvtSectionSet_Free(context, &build->sections);
    pvtCandidateSet_Free(context, &build->candidates);
}

void pvtBuild_FreeSelection(pvtContext* context, pvtBuild* build)
{
    if (build->hasSlicer && build->options->releaseSlicer != NULL) {
        build->options->releaseSlicer(context, build->options->slicerUser, &build->slicer);
    }
    build->hasSlicer = false;
    FreeCandidates(context, build);
    pvtViewSet_Free(context, &build->views);
    pvtOccluder_Free(context, &build->occluder);
    pvtOccluder_Free(context, &build->flat);
    build->startCount = 0;
}

void pvtBuild_Free(pvtContext* context, pvtBuild* build)
{
    pvtBuild_FreeSelection(context, build);
    pvtBitGrid_Free(context, &build->surface);
    pvtSolid_Free(context, &build->solid);
    pvtBitGrid_Free(context, &build->allowed);
    pvtCellGrid_Free(context, &build->cells);
    pvtTouching_Free(context, &build->touching);
    pvtInsideTest_Free(context, &build->inside);
    pvtSheetSet_Free(context, &build->sheets);
    pvtBitGrid_Free(context, &build->hiding);
}

static double ToWorld(pvtLength length, double voxelSize)
{
    return length.inVoxels ? length.value * voxelSize : length.value;
}

static pvtStatus CheckRanges(pvtContext* context, const pvtBuildOptions* options)
{
    if (options->budget < 1 || options->budget > 65535) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "budget is %d triangles; it must be 1 to 65535", options->budget);
    }
    if (options->error == 0.0 &&
        (options->resolution < MIN_RESOLUTION || options->resolution > MAX_RESOLUTION)) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "resolution is %d voxels; it must be %d to %d", options->resolution,
                       MIN_RESOLUTION, MAX_RESOLUTION);
    }
    if (!isfinite(options->deadline) || options->deadline < 0.0) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the deadline is %g s; it must be finite and not negative",
                       options->deadline);
    }
    if (!isfinite(options->error) || options->error < 0.0) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "the error must be above 0 and finite");
    }
    if (!isfinite(options->tolerance.value) || options->tolerance.value < 0.0 ||
        !isfinite(options->smallestHole.value) || options->smallestHole.value < 0.0) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "tolerance and smallest hole must be finite and not negative");
    }
    if (options->enclosed < -1 || options->enclosed > 25) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "enclosed is %d; it must be 0 to 25",
                       options->enclosed);
    }
    return PVT_OK;
}

// error = √3 h + max(tolerance, hole / 2), where each of the two may be given in voxels of size h.
static double GetVoxelSizeForError(const pvtBuildOptions* options)
{
    const double tolerance = options->tolerance.value;
    const double hole = 0.5 * options->smallestHole.value;
    const double byTolerance = options->tolerance.inVoxels ? options->error / (SQRT3 + tolerance)
                                                           : (options->error - tolerance) / SQRT3;
    const double byHole = options->smallestHole.inVoxels ? options->error / (SQRT3 + hole)
                                                         : (options->error - hole) / SQRT3;
    return fmin(byTolerance, byHole);
}

void pvtSetErrorBound(pvtBuildStats* stats)
{
    stats->errorBound =
        SQRT3 * stats->voxelSize + fmax(stats->tolerance, 0.5 * stats->smallestHole);
}

pvtStatus pvtResolveSizes(pvtContext* context, pvtBuild* build)
{
    const pvtBuildOptions* options = build->options;
    if (CheckRanges(context, options) != PVT_OK) {
        return pvtContext_GetStatus(context);
    }
    const pvtBox3 bounds = pvtMesh_GetBounds(build->mesh);
    const pvtVec3 extent = pvtSub(bounds.upper, bounds.lower);
    const double longest = fmax(extent.x, fmax(extent.y, extent.z));
    if (build->mesh->triangleCount == 0 || !(longest > 0.0)) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "the mesh has no extent: there is nothing to voxelize");
    }
    pvtBuildStats* stats = &build->stats;
    stats->voxelSize = longest / options->resolution;
    stats->resolution = options->resolution;
    if (options->error > 0.0) {
        stats->voxelSize = GetVoxelSizeForError(options);
        if (!(stats->voxelSize > 0.0)) {
            return pvtFail(
                context, PVT_INVALID_ARGUMENT,
                "the error %g is used up by the tolerance or half the smallest hole; raise "
                "the error or lower these",
                options->error);
        }
        // An error larger than the object asks for no more than the coarsest grid.
        stats->voxelSize = fmin(stats->voxelSize, longest / MIN_RESOLUTION);
        const double resolution = ceil(longest / stats->voxelSize);
        if (resolution > MAX_RESOLUTION) {
            return pvtFail(
                context, PVT_LIMIT,
                "an error of %g needs %.0f voxels along the longest side; at most %d are "
                "possible, which reach %g",
                options->error, resolution, MAX_RESOLUTION,
                options->error * resolution / MAX_RESOLUTION);
        }
        stats->resolution = (int)resolution;
    }
    stats->tolerance = ToWorld(options->tolerance, stats->voxelSize);
    stats->smallestHole = ToWorld(options->smallestHole, stats->voxelSize);
    pvtSetErrorBound(stats);
    return PVT_OK;
}

pvtStatus pvtVoxelizeStep(pvtContext* context, pvtBuild* build)
{
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.voxelSize = build->stats.voxelSize;
    // And a voxel more: what lies beyond a grid is not known to be outside of what is allowed.
    const double tolerance = build->stats.tolerance;
    options.padding = tolerance > 0.0 ? tolerance + build->stats.voxelSize : 0.0;
    return pvtVoxelizeMesh(context, &options, build->mesh, &build->surface);
}

pvtStatus pvtMeasureTriangles(pvtContext* context, const pvtBuild* build, const pvtMesh* mesh,
                              double* measure)
{
    return pvtMeasureOcclusion(context, &build->views, &build->bounds, PVT_MEASURE_SIZE, mesh,
                               measure);
}

bool pvtFindVoxelBounds(const pvtBitGrid* grid, pvtBox3* bounds)
{
    pvtGridBox box;
    const bool isFound = pvtBitGrid_FindBounds(grid, &box);
    const double h = grid->frame.voxelSize;
    const pvtVec3 o = grid->frame.origin;
    bounds->lower =
        (pvtVec3){o.x + box.lower[0] * h, o.y + box.lower[1] * h, o.z + box.lower[2] * h};
    bounds->upper =
        (pvtVec3){o.x + box.upper[0] * h, o.y + box.upper[1] * h, o.z + box.upper[2] * h};
    return isFound;
}

void pvtWidenBounds(const pvtBitGrid* grid, pvtBox3* bounds)
{
    pvtBox3 more;
    if (grid->words != NULL && pvtFindVoxelBounds(grid, &more)) {
        for (int axis = 0; axis < 3; ++axis) {
            pvtSetAxis(&bounds->lower, axis,
                       fmin(pvtGetAxis(bounds->lower, axis), pvtGetAxis(more.lower, axis)));
            pvtSetAxis(&bounds->upper, axis,
                       fmax(pvtGetAxis(bounds->upper, axis), pvtGetAxis(more.upper, axis)));
        }
    }
}

pvtStatus pvtFailNothingInside(pvtContext* context, const pvtBuild* build)
{
    const pvtRemedy* remedy = &build->solid.remedy;
    const int resolution = build->stats.resolution;
    if (remedy->terrain) {
        return pvtFail(
            context, PVT_NOTHING_INSIDE,
            "nothing is inside at %d voxels, but the mesh looks like a landscape; --terrain "
            "fills what lies below it",
            resolution);
    }
    if (remedy->ground && remedy->smallestHole > 0.0) {
        return pvtFail(context, PVT_NOTHING_INSIDE,
                       "nothing is inside at %d voxels: the mesh is open at the bottom and has "
                       "other openings; --ground and --smallest-hole %g together close them",
                       resolution, remedy->smallestHole);
    }
    if (remedy->ground) {
        return pvtFail(context, PVT_NOTHING_INSIDE,
                       "nothing is inside at %d voxels, but the mesh is open at the bottom only; "
                       "--ground closes it",
                       resolution);
    }
    if (remedy->smallestHole > 0.0) {
        return pvtFail(
            context, PVT_NOTHING_INSIDE,
            "the mesh has openings, so that nothing is inside at %d voxels; --smallest-hole "
            "%.3g would close them",
            resolution, remedy->smallestHole);
    }
    return pvtFail(
        context, PVT_NOTHING_INSIDE,
        "the mesh has no inside at %d voxels; a higher --resolution finds thinner solids, "
        "--smallest-hole D closes openings narrower than D, --ground closes the bottom, "
        "--terrain fills below a landscape, --tolerance 1vx counts the touched voxels too",
        resolution);
}

pvtStatus pvtFillStep(pvtContext* context, pvtBuild* build)
{
    const pvtBuildOptions* options = build->options;
    pvtSolidOptions solid = pvtDefaultSolidOptions();
    solid.smallestHole = build->stats.smallestHole;
    solid.strict = !pvtIsPaper(build) || build->stats.tolerance == 0.0;
    solid.ground = options->ground;
    solid.terrain = options->terrain;
    // Strictly inside there is nothing below the lowest valleys: they would be holes in any plate.
    solid.below = build->stats.tolerance > 0.0 ? 0 : 1;
    solid.up = options->up;
    solid.enclosed = options->enclosed;
    pvtStatus status = pvtFillSolidInSilence(context, &solid, &build->surface, &build->solid);
    if (status == PVT_OK) {
        const pvtRemedy* remedy = &build->solid.remedy;
        build->stats.insideFraction = build->solid.insideFraction;
        // With the ground as well, the hole alone would not fill it.
        build->stats.suggestedHole = remedy->ground ? 0.0 : remedy->smallestHole;
        pvtBitGrid_Free(context, &build->surface);
        status =
            pvtMakeAllowedGrid(context, &build->solid, build->stats.tolerance, &build->allowed);
    }
    if (status == PVT_OK && build->stats.tolerance == 0.0) {
        status = pvtRefineAllowedGrid(context, build->mesh, &build->solid, &build->allowed,
                                      &build->cells);
    }
    if (status == PVT_OK && build->cells.count > 0 && pvtMayAscend(build)) {
        status = pvtListTouching(context, build->mesh, &build->cells, &build->touching);
    }
    if (status == PVT_OK && !pvtFindVoxelBounds(&build->allowed, &build->bounds)) {
        build->bounds =
            (pvtBox3){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
        status = pvtMayUseSheets(build) ? PVT_OK : pvtFailNothingInside(context, build);
    }
    if (status == PVT_OK) {
        pvtWidenBounds(&build->cells.voxels, &build->bounds);
        build->allowedBounds = build->bounds;
        status = pvtCreateSliceVolume(context, &build->allowed, &build->volume);
    }
    if (status == PVT_OK && build->cells.count > 0) {
        status = pvtAddSliceCells(context, &build->cells, &build->volume);
    }
    return status;
}

// A slicer of the caller's works on the closed mesh around the voxels that are sliced.
static pvtStatus CreateSlicer(pvtContext* context, pvtBuild* build, const pvtBitGrid* grid)
{
    if (build->options->createSlicer == NULL) {
        return PVT_OK;
    }
    pvtMesh voxelMesh;
    pvtStatus status = pvtBuildVoxelMesh(context, grid, &voxelMesh);
    if (status == PVT_OK) {
        status = build->options->createSlicer(context, build->options->slicerUser, &grid->frame,
                                              &voxelMesh, &build->slicer);
        build->hasSlicer = status == PVT_OK;
        pvtMesh_Free(context, &voxelMesh);
    }
    return status;
}

// How many candidates there are, and from how many planes each is the best.
typedef struct SearchSize {
    int directions, depths, samplesPerBin;
} SearchSize;

// Of the voxels along the longest side, cubed: with more inside, sections are large, take long to
// make polygons of, and change little from one depth to the next.
static const double MUCH_INSIDE = 1.0 / 12.0;

static SearchSize GetSearchSize(const pvtBuild* build)
{
    const bool isFast = build->options->effort == PVT_EFFORT_FAST;
    // What ascends needs no more than a start, and leaves it far behind.
    if (pvtMayAscend(build) && pvtGetAscentBudget(build) == build->options->budget) {
        const double much = MUCH_INSIDE * pow(build->stats.resolution, 3.0);
        const bool isLarge = (double)build->solid.strictCount > much;
        return isFast ? (SearchSize){6, isLarge ? 8 : 16, 4} : (SearchSize){16, 16, 4};
    }
    const pvtPlanOptions whole = pvtDefaultPlanOptions();
    // A third of the candidates: in a short search the others hardly count.
    return isFast ? (SearchSize){16, 16, whole.samplesPerBin}
                  : (SearchSize){whole.directions, whole.depths, whole.samplesPerBin};
}

// What is sliced: the paper slices the solid, and lets simplification stray by the tolerance; the
// planar method slices the allowed voxels, and never leaves them.
static const pvtSliceVolume* GetSlicedVolume(const pvtBuild* build)
{
    return build->solidVolume.grid != NULL ? &build->solidVolume : &build->volume;
}

pvtStatus pvtSearchStep(pvtContext* context, pvtBuild* build)
{
    pvtStatus status = PVT_OK;
    if (pvtIsPaper(build) && build->stats.tolerance > 0.0) {
        status = pvtCreateSliceVolume(context, &build->solid.inside, &build->solidVolume);
    }
    const pvtSliceVolume* volume = GetSlicedVolume(build);
    pvtFaceDirectionSet faces = {0};
    pvtSectionPlan plan = {0};
    if (status == PVT_OK) {
        status = build->solid.strictCount > 0 || build->stats.tolerance > 0.0
                     ? CreateSlicer(context, build, volume->grid)
                     : PVT_OK;
    }
    if (status == PVT_OK) {
        const pvtFaceDirectionOptions options = pvtDefaultFaceDirectionOptions();
        status = pvtFindFaceDirections(context, &options, build->mesh, &faces);
    }
    if (status == PVT_OK) {
        pvtPlanOptions options = pvtDefaultPlanOptions();
        options.faces = pvtIsPaper(build) ? NULL : &faces;
        options.axes = !pvtIsPaper(build);
        if (!pvtIsPaper(build)) {
            const SearchSize size = GetSearchSize(build);
            options.directions = size.directions;
            options.depths = size.depths;
            options.samplesPerBin = size.samplesPerBin;
        }
        status = pvtPlanSections(context, &options, volume->grid, &plan);
    }
    if (status == PVT_OK) {
        pvtSearchOptions options = pvtDefaultSearchOptions();
        options.rule = pvtIsPaper(build) ? PVT_SLICE_CENTER : PVT_SLICE_COVERED;
        options.slicer = build->hasSlicer ? &build->slicer : NULL;
        status = pvtSearchSections(context, &options, volume, &plan, &build->sections);
    }
    pvtSectionPlan_Free(context, &plan);
    pvtFaceDirectionSet_Free(context, &faces);
    return status;
}

pvtStatus pvtChainStep(pvtContext* context, pvtBuild* build)
{
    pvtCandidateOptions options = pvtDefaultCandidateOptions();
    options.maxTriangles = build->options->budget < 62 ? build->options->budget : 62;
    if (pvtIsPaper(build)) {
        options.rule = build->stats.tolerance > 0.0 ? PVT_SLICE_CENTER : PVT_SLICE_COVERED;
        options.slicer = build->hasSlicer && build->stats.tolerance > 0.0 ? &build->slicer : NULL;
        options.simplification = build->stats.tolerance / build->stats.voxelSize;
        options.guard = &build->volume;
        options.maxTriangles = 65535;
        options.minArea = 0.0;
    }
    pvtStatus status = pvtBuildCandidates(context, &options, GetSlicedVolume(build),
                                          &build->sections, &build->candidates);
    if (status == PVT_OK) {
        status = pvtAddSheets(context, &options, build);
    }
    build->stats.candidateCount = build->candidates.chains.count;
    if (status == PVT_OK && build->candidates.chains.count == 0) {
        status = pvtFailNothingInside(context, build);
    }
    return status;
}

pvtEnough pvtGetEnough(const pvtBuild* build)
{
    const pvtBuildOptions* options = build->options;
    return (pvtEnough){.deadline =
                           options->deadline > 0.0 ? build->started + options->deadline : 0.0,
                       .isEnough = options->isEnough,
                       .user = options->enoughUser};
}

static pvtStatus RunRefinement(pvtContext* context, pvtBuild* build)
{
    if (pvtIsPaper(build) || build->options->budget > MAX_REFINED || pvtMayAscend(build)) {
        return PVT_OK;
    }
    static const int trials[] = {
        [PVT_EFFORT_FAST] = 1500, [PVT_EFFORT_DEFAULT] = 20000, [PVT_EFFORT_BEST] = 200000};
    const pvtRefineOptions options = {.budget = build->options->budget,
                                      .views = &build->views,
                                      .bounds = build->bounds,
                                      .sheets = &build->sheets,
                                      .seed = build->options->seed,
                                      .trials = trials[build->options->effort],
                                      .enough = pvtGetEnough(build)};
    return pvtRefineOccluder(context, &options, &build->volume, &build->candidates,
                             &build->occluder);
}

pvtStatus pvtRefineStep(pvtContext* context, pvtBuild* build)
{
    pvtStatus status = RunRefinement(context, build);
    pvtOccluder* const occluders[] = {&build->occluder, &build->flat};
    for (int i = 0; i < 2 && status == PVT_OK; ++i) {
        if (occluders[i]->loops.loopCount > 0) {
            status = pvtGrowSheetPanels(context, &build->sheets, build->deviation, build->mesh,
                                        occluders[i]);
        }
    }
    // Polygons are chosen: what comes needs the memory.
    FreeCandidates(context, build);
    return status;
}
