// SPDX-License-Identifier: MIT
// View directions over a hemisphere: a Fibonacci lattice (Swinbank and Purser, Fibonacci Grids,
// 2006), whose points all stand for nearly the same solid angle.
#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <paravent/occlusion.h>

pvtViewOptions pvtDefaultViewOptions(void)
{
    return (pvtViewOptions){.count = 64, .up = 1};
}

void pvtViewSet_Free(pvtContext* context, pvtViewSet* set)
{
    pvtRelease(context, set->views);
    *set = (pvtViewSet){0};
}

static pvtView MakeView(pvtVec3 direction, double weight)
{
    // Any axis far from the direction will do to span the image plane.
    const pvtVec3 helper =
        fabs(direction.y) < 0.9 ? (pvtVec3){0.0, 1.0, 0.0} : (pvtVec3){1.0, 0.0, 0.0};
    const pvtVec3 right = pvtNormalize(pvtCross(direction, helper));
    return (pvtView){direction, right, pvtCross(right, direction), weight};
}

// The lattice on the half sphere on which coordinate `axis` is negative: looking down. Each point
// is the one before it turned by the golden angle, by products only, so that every machine has the
// same.
static void FillHemisphere(pvtView* views, size_t count, int axis)
{
    static const double turnX = -0.7373688780783202; // cos and sin of 2π / golden ratio
    static const double turnY = -0.6754902942615233;
    double x = 1.0;
    double y = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double height = ((double)i + 0.5) / (double)count;
        const double radius = sqrt((1.0 - height * height) / (x * x + y * y));
        pvtVec3 direction = {0};
        pvtSetAxis(&direction, axis, -height);
        pvtSetAxis(&direction, (axis + 1) % 3, radius * x);
        pvtSetAxis(&direction, (axis + 2) % 3, radius * y);
        views[i] = MakeView(direction, 1.0);
        const double nextX = x * turnX - y * turnY;
        y = x * turnY + y * turnX;
        x = nextX;
    }
}

// For people on the ground: the weight of a view falls with the cosine of its elevation, from 1 at
// the horizon to 0 straight down.
static double WeighElevation(pvtVec3 direction, int up)
{
    const double height = pvtGetAxis(direction, up);
    return sqrt(fmax(0.0, 1.0 - height * height));
}

static pvtStatus CheckOptions(pvtContext* context, const pvtViewOptions* options)
{
    const size_t count = options->list != NULL ? options->listCount : (size_t)options->count;
    if ((options->list == NULL && options->count < 1) || count < 1 || count > PVT_MAX_VIEWS) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%zu view directions; 1 to %d are possible",
                       count, PVT_MAX_VIEWS);
    }
    for (size_t i = 0; options->list != NULL && i < count; ++i) {
        const pvtWeightedDirection* item = &options->list[i];
        const double length = pvtLength3(item->direction);
        if (!isfinite(length) || length <= 0.0 || !isfinite(item->weight) || item->weight < 0.0) {
            return pvtFail(
                context, PVT_INVALID_ARGUMENT,
                "view %zu: the direction must be finite and not 0, its weight finite and "
                "not negative",
                i + 1);
        }
    }
    return PVT_OK;
}

pvtStatus pvtMakeViews(pvtContext* context, const pvtViewOptions* options, pvtViewSet* set)
{
    *set = (pvtViewSet){0};
    if (CheckOptions(context, options) != PVT_OK) {
        return pvtContext_GetStatus(context);
    }
    const size_t count = options->list != NULL ? options->listCount : (size_t)options->count;
    pvtView* views = pvtAllocate(context, count, sizeof *views);
    if (views == NULL) {
        return pvtContext_GetStatus(context);
    }
    // Opposite views are mirror images, so that the half sphere that looks down stands for both.
    size_t kept = 0;
    if (options->list == NULL) {
        FillHemisphere(views, count, options->up);
        kept = count;
    }
    for (size_t i = 0; i < count && options->list != NULL; ++i) {
        if (options->list[i].weight > 0.0) {
            views[kept++] =
                MakeView(pvtNormalize(options->list[i].direction), options->list[i].weight);
        }
    }
    double total = 0.0;
    for (size_t i = 0; i < kept; ++i) {
        if (options->list == NULL && options->aboveOnly) {
            views[i].weight = WeighElevation(views[i].direction, options->up);
        }
        total += views[i].weight;
    }
    if (kept == 0) {
        pvtRelease(context, views);
        return pvtFail(context, PVT_INVALID_ARGUMENT, "no view direction has any weight");
    }
    for (size_t i = 0; i < kept; ++i) {
        views[i].weight /= total;
    }
    *set = (pvtViewSet){views, kept};
    return PVT_OK;
}
