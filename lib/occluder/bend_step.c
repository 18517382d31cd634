// SPDX-License-Identifier: MIT
// When triangles leave their planes, and for which views.
#include "bend.h"
#include "facets.h"
#include "steps.h"

#include "base/context.h"
#include "base/vector.h"

enum { MORE_VIEWS = 3 }; // for each that is optimised for

static const double MAX_BEND_BYTES = 0x1p27;

// Views between those that are optimised for, so that nothing is gained from their pixels alone:
// three times as many, turned by a radian about the axis that their weights go by. None for a list,
// which stands for itself.
static pvtStatus MakeMoreViews(pvtContext* context, const pvtBuild* build, pvtViewSet* set)
{
    pvtViewOptions options = build->options->views;
    options.up = (int)build->options->up;
    *set = (pvtViewSet){0};
    const double bytes =
        pvtGetFacetBytes(build->occluder.mesh.triangleCount, (MORE_VIEWS + 1) * build->views.count);
    if (options.list != NULL || bytes > MAX_BEND_BYTES) {
        return PVT_OK;
    }
    options.count *= MORE_VIEWS;
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

static pvtStatus MeasureMesh(pvtContext* context, const pvtBuild* build, const pvtMesh* mesh,
                             double* measure)
{
    return pvtMeasureOcclusion(context, &build->views, &build->bounds, PVT_MEASURE_SIZE, mesh,
                               measure);
}

// What hides more rectangles nearly always has the greater measure, too. Where it has not, the
// polygons stay as they were: the measure never falls.
static pvtStatus BendUnlessWorse(pvtContext* context, pvtBuild* build,
                                 const pvtBendOptions* options)
{
    pvtOccluder* occluder = &build->occluder;
    pvtMesh flat;
    pvtStatus status =
        pvtCreateMesh(context, occluder->mesh.positions, occluder->mesh.positionCount,
                      occluder->mesh.indices, occluder->mesh.triangleCount, &flat);
    double before = 0.0;
    double after = 0.0;
    if (status == PVT_OK) {
        status = MeasureMesh(context, build, &flat, &before);
    }
    if (status == PVT_OK) {
        status = pvtBendOccluder(context, options, occluder);
    }
    if (status == PVT_OK) {
        status = MeasureMesh(context, build, &occluder->mesh, &after);
    }
    if (status == PVT_OK && after < before) {
        const pvtMesh bent = occluder->mesh;
        occluder->mesh = flat;
        flat = bent;
    }
    pvtMesh_Free(context, &flat);
    return status;
}

pvtStatus pvtBendStep(pvtContext* context, pvtBuild* build)
{
    const size_t triangles = build->occluder.mesh.triangleCount;
    // Where polygons may leave the surface, bending them would use that up for the last pixels.
    const bool hasVolume = build->solid.strictCount > 0 && build->stats.tolerance == 0.0;
    if (build->options->method == PVT_METHOD_PAPER || !hasVolume || triangles == 0 ||
        triangles > PVT_MAX_FACETS ||
        pvtGetFacetBytes(triangles, build->views.count) > MAX_BEND_BYTES) {
        return PVT_OK;
    }
    // Where some panels are on the surface, the others have had more trials before.
    static const int trials[2][3] = {
        {[PVT_EFFORT_FAST] = 1500, [PVT_EFFORT_DEFAULT] = 36000, [PVT_EFFORT_BEST] = 400000},
        {[PVT_EFFORT_FAST] = 1000, [PVT_EFFORT_DEFAULT] = 24000, [PVT_EFFORT_BEST] = 400000}};
    pvtBendOptions options = {.views = &build->views,
                              .bounds = build->bounds,
                              .seed = build->options->seed,
                              .trials = trials[build->sheets.count > 0][build->options->effort],
                              .deadline = build->options->deadline > 0.0
                                              ? build->started + build->options->deadline
                                              : 0.0};
    pvtViewSet more;
    pvtInsideTest inside = {0};
    pvtStatus status = MakeMoreViews(context, build, &more);
    if (status == PVT_OK) {
        status = pvtCreateInsideTest(context, &build->allowed, &build->cells, &inside);
    }
    if (status == PVT_OK) {
        options.more = &more;
        options.inside = &inside;
        status = BendUnlessWorse(context, build, &options);
    }
    pvtInsideTest_Free(context, &inside);
    pvtViewSet_Free(context, &more);
    return status;
}
