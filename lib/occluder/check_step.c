// SPDX-License-Identifier: MIT
// What is known of an occluder when it is done: whether it keeps the promise, and how much of what
// could be hidden it hides.
#include "ceiling.h"
#include "check.h"
#include "steps.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "voxel/outside.h"

#include <inttypes.h>
#include <math.h>

// Of messages: what is known of the storage, and what helps.
#define STORAGE "coordinates as large as %g are stored in steps of %.2g, and voxels are %.2g"
#define REMEDY                                                                                     \
    "bring the mesh nearer to its origin, or try --separate, which keeps each mesh's own "         \
    "coordinates"

enum { FEW_TRIANGLES = 16 }; // of a budget that cannot be expected to hide much

static const double LITTLE_SHARE = 0.2;     // of what can be hidden: less is told
static const double MIN_STRICT_SHARE = 0.5; // of the measure: less is told
static const double COARSE_STEP = 0.25;     // [vx]
static const double SAFE_SHARE = 0.8; // of the inside: with more, that of the measure is not small

// Of the voxels that are inside, those that are allowed and the allowed parts of others.
static double GetAllowedShare(const pvtBuild* build)
{
    const pvtCellGrid* cells = &build->cells;
    uint64_t parts = 0;
    for (size_t i = 0; i < cells->count; ++i) {
        parts += (uint64_t)pvtCountBits(cells->cells[i]);
    }
    return ((double)pvtBitGrid_Count(&build->allowed) + (double)parts / 64.0) /
           (double)build->solid.insideCount;
}

// A strict interior may be a small part of what the mesh hides: a chair's legs are all surface.
// Then recall is low whatever the budget, and only other options help.
static pvtStatus CompareWithMesh(pvtContext* context, pvtBuild* build, bool* isThin)
{
    pvtBox3 bounds;
    double hidden = 0.0;
    if (build->stats.tolerance > 0.0 || GetAllowedShare(build) > SAFE_SHARE ||
        !pvtFindVoxelBounds(&build->solid.inside, &bounds)) {
        return PVT_OK;
    }
    const pvtMeasureGridOptions options = {&build->views, &bounds, PVT_MEASURE_SIZE};
    const pvtStatus status = pvtMeasureGrid(context, &options, &build->solid.inside, NULL, &hidden);
    *isThin = status == PVT_OK && build->stats.measureOfSolid < MIN_STRICT_SHARE * hidden;
    if (*isThin) {
        pvtWarnOnce(
            context,
            "only %.1f %% of what the mesh hides lies strictly inside or flat on it at %d voxels, "
            "and an occluder can hide no more; --tolerance 1vx uses the touched voxels too, a "
            "higher --resolution finds thinner parts",
            100.0 * build->stats.measureOfSolid / hidden, build->stats.resolution);
    }
    return status;
}

// Holes all through a solid leave nothing large that few triangles could hide. Where openings or
// thin parts were told of before, so was what helps.
static void WarnOfLittle(pvtContext* context, const pvtBuild* build)
{
    const pvtBuildStats* stats = &build->stats;
    const pvtRemedy* told = &build->solid.remedy;
    if (told->terrain || told->ground || told->smallestHole > 0.0 ||
        build->options->budget < FEW_TRIANGLES ||
        stats->measure >= LITTLE_SHARE * stats->measureOfSolid) {
        return;
    }
    pvtWarnOnce(
        context,
        "%zu triangles hide only %.1f %% of what all of the inside does: it is thin, or full of "
        "holes; --smallest-hole D closes holes narrower than D, %s, and a larger --budget hides "
        "more",
        build->occluder.mesh.triangleCount, 100.0 * stats->measure / stats->measureOfSolid,
        stats->tolerance > 0.0 ? "a lower --resolution those that are narrower than a voxel"
                               : "--tolerance 1vx spans those that are narrower than a voxel");
}

// The promise, kept by every triangle.
static pvtStatus CheckTriangles(pvtContext* context, pvtBuild* build)
{
    const pvtMesh* mesh = &build->occluder.mesh;
    const pvtInterior interior = pvtGetInterior(build);
    pvtCountSurfacePanels(build);
    // What voxels object to is checked once more where there are panels: one is enough to know.
    const uint64_t enough = build->stats.surfacePanels > 0 ? 1 : UINT64_MAX;
    uint64_t* outside = pvtAllocate(context, mesh->triangleCount, sizeof *outside);
    pvtStatus status = outside == NULL
                           ? pvtContext_GetStatus(context)
                           : pvtCheckTriangles(context, &interior, mesh, enough, outside);
    for (size_t t = 0; t < mesh->triangleCount && status == PVT_OK; ++t) {
        build->stats.outside += outside[t];
    }
    if (status == PVT_OK) {
        status = pvtCheckSheets(context, build, outside);
    }
    pvtRelease(context, outside);
    return status;
}

// Corners are stored as floats, which far from the origin of a small mesh are few.
typedef struct Storage {
    double farthest; // coordinate
    double step;     // between two that can be stored there
} Storage;

static Storage FindStorage(const pvtBuild* build)
{
    const pvtVec3 corners[] = {build->bounds.lower, build->bounds.upper};
    double farthest = 0.0;
    for (int i = 0; i < 6; ++i) {
        farthest = fmax(farthest, fabs(pvtGetAxis(corners[i / 3], i % 3)));
    }
    return (Storage){farthest, (double)(nextafterf((float)farthest, INFINITY) - (float)farthest)};
}

// The ascent takes away what it cannot bring inside, which with coarse steps may be all.
static pvtStatus FailEmpty(pvtContext* context, const pvtBuild* build)
{
    const Storage storage = FindStorage(build);
    const double voxel = build->stats.voxelSize;
    return storage.step > COARSE_STEP * voxel
               ? pvtFail(context, PVT_NOTHING_INSIDE,
                         STORAGE ", so that no triangle can lie inside: " REMEDY, storage.farthest,
                         storage.step, voxel)
               : pvtFailNothingInside(context, build);
}

// Nothing but coarse steps is known to make the check find anything.
static void WarnOfStorage(pvtContext* context, const pvtBuild* build)
{
    const pvtBuildStats* stats = &build->stats;
    const Storage storage = FindStorage(build);
    if (stats->outside > 0) {
        pvtWarnOnce(context,
                    "the check found %" PRIu64
                    " voxel%s in which the occluder reaches where it may not; " STORAGE ": " REMEDY,
                    stats->outside, stats->outside == 1 ? "" : "s", storage.farthest, storage.step,
                    stats->voxelSize);
    } else if (storage.step > COARSE_STEP * stats->voxelSize) {
        pvtWarnOnce(
            context,
            STORAGE
            ", so that corners lie where they can rather than where they hide most: " REMEDY,
            storage.farthest, storage.step, stats->voxelSize);
    }
}

pvtStatus pvtCheckStep(pvtContext* context, pvtBuild* build)
{
    pvtBuildStats* stats = &build->stats;
    if (build->occluder.mesh.triangleCount == 0) {
        return FailEmpty(context, build);
    }
    pvtStatus status = CheckTriangles(context, build);
    if (status == PVT_OK) {
        WarnOfStorage(context, build);
        // Triangles in a band hide nearly all, and closing what is open would rather do harm.
        if (!build->isBand) {
            pvtWarnWhenHollow(context, &build->solid);
        }
    }
    if (status == PVT_OK) {
        status = pvtMeasureTriangles(context, build, &build->occluder.mesh, &stats->measure);
        build->occluder.measure = stats->measure;
    }
    if (status == PVT_OK) {
        status = pvtMeasureCeiling(context, build);
    }
    bool isThin = false;
    if (status == PVT_OK) {
        status = CompareWithMesh(context, build, &isThin);
    }
    if (status == PVT_OK && !isThin) {
        WarnOfLittle(context, build);
    }
    return status;
}
