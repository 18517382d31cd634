// SPDX-License-Identifier: MIT
// When triangles leave their planes, and for which views.
#include "bend.h"
#include "facets.h"
#include "occluder.h"
#include "steps.h"

#include "base/context.h"
#include "base/vector.h"
#include "voxel/bit_grid.h"

enum { MORE_VIEWS = 3 }; // for each that is optimised for

static const double MAX_BEND_BYTES = 0x1p27;

// Views between those that are optimised for, so that nothing is gained from their pixels alone:
// three times as many, turned by a radian about the axis that their weights go by. None for a list,
// which stands for itself.
static pvtStatus MakeMoreViews(pvtContext* context, const pvtBuild* build, pvtViewSet* set)
{
    pvtViewOptions options = pvtGetViewOptions(build);
    *set = (pvtViewSet){0};
    const double bytes =
        pvtGetFacetBytes(build->occluder.mesh.triangleCount, (MORE_VIEWS + 1) * build->views.count);
    if (options.list != NULL || bytes > MAX_BEND_BYTES) {
        return PVT_OK;
    }
    const int most = PVT_MAX_VIEWS / MORE_VIEWS;
    options.count = options.count <= most ? MORE_VIEWS * options.count : PVT_MAX_VIEWS;
    pvtStatus status = pvtMakeViews(context, &options, set);
    pvtWeightedDirection* list = pvtAllocate(context, set->count, sizeof *list);
    if (status == PVT_OK && list == NULL) {
        status = pvtContext_GetStatus(context);
    }
    for (size_t v = 0; v < set->count && status == PVT_OK; ++v) {
        static const double cosine = 0.5403023058681398;
        static const double sine = 0.8414709848078965;
        const pvtVec3 from = set->views[v].direction;
        const int a = (options.up + 1) % 3;
        const int b = (options.up + 2) % 3;
        list[v] = (pvtWeightedDirection){from, set->views[v].weight};
        pvtSetAxis(&list[v].direction, a,
                   cosine * pvtGetAxis(from, a) - sine * pvtGetAxis(from, b));
        pvtSetAxis(&list[v].direction, b,
                   sine * pvtGetAxis(from, a) + cosine * pvtGetAxis(from, b));
    }
    options.list = list;
    options.listCount = set->count;
    pvtViewSet_Free(context, set);
    if (status == PVT_OK) {
        status = pvtMakeViews(context, &options, set);
    }
    pvtRelease(context, list);
    return status;
}

// Polygons are inside as they were made. Far from the origin, what floats make of their corners may
// not be.
static bool IsFlatInside(const pvtBuild* build)
{
    const pvtOccluder* flat = &build->flat;
    size_t triangle = 0;
    for (size_t p = 0; p < flat->loops.loopCount; ++p) {
        const bool isOnSheet = pvtSheetSet_Find(&build->sheets, &flat->planes[p]) != NULL;
        const size_t end = triangle + pvtCountPolygonTriangles(&flat->loops, p);
        for (; triangle < end; ++triangle) {
            pvtVec3 corners[3];
            pvtGetGridTriangle(&flat->frame, &flat->mesh, triangle, corners);
            if (!isOnSheet && !pvtInsideTest_HasTriangle(&build->inside, corners)) {
                return false;
            }
        }
    }
    return true;
}

// What hides more rectangles nearly always has the greater measure, too. Where it has not, the
// polygons that were selected are taken: the measure never falls.
static pvtStatus TakeFlatIfBetter(pvtContext* context, pvtBuild* build)
{
    double flat = 0.0;
    double bent = 0.0;
    pvtStatus status = pvtMeasureTriangles(context, build, &build->flat.mesh, &flat);
    if (status == PVT_OK) {
        status = pvtMeasureTriangles(context, build, &build->occluder.mesh, &bent);
    }
    if (status == PVT_OK && bent < flat && IsFlatInside(build)) {
        const pvtOccluder worse = build->occluder;
        build->occluder = build->flat;
        build->flat = worse;
    }
    return status;
}

static pvtStatus Bend(pvtContext* context, pvtBuild* build)
{
    static const struct {
        int trials, sweeps;
    } efforts[] = {[PVT_EFFORT_FAST] = {0, 1},
                   [PVT_EFFORT_DEFAULT] = {800, 3},
                   [PVT_EFFORT_BEST] = {60000, 4}};
    const int effort = (int)build->options->effort;
    const int sweeps =
        pvtSpreadEffort(efforts[effort].sweeps, (int)build->occluder.mesh.triangleCount);
    pvtBendOptions options = {.views = &build->views,
                              .inside = &build->inside,
                              .bounds = build->bounds,
                              .seed = build->options->seed,
                              .trials = efforts[effort].trials,
                              .sweeps = sweeps > 1 ? sweeps : 1,
                              .enough = pvtGetEnough(build)};
    pvtViewSet more;
    pvtStatus status = MakeMoreViews(context, build, &more);
    if (status == PVT_OK) {
        options.more = &more;
        status = pvtBendOccluder(context, &options, &build->occluder);
    }
    pvtViewSet_Free(context, &more);
    return status;
}

// Where time is short it is spent better on the steps before.
static bool MayBend(const pvtBuild* build)
{
    const size_t triangles = build->occluder.mesh.triangleCount;
    return pvtGetTimeShare(build) == 1.0 && triangles <= PVT_MAX_FACETS &&
           pvtGetFacetBytes(triangles, build->views.count) <= MAX_BEND_BYTES;
}

pvtStatus pvtBendStep(pvtContext* context, pvtBuild* build)
{
    if (!pvtMayAscend(build) || !pvtIsMeasured(build)) {
        return PVT_OK;
    }
    const pvtStatus status = MayBend(build) ? Bend(context, build) : PVT_OK;
    return status == PVT_OK ? TakeFlatIfBetter(context, build) : status;
}
