// SPDX-License-Identifier: MIT
// View directions over a hemisphere: a Fibonacci lattice (Swinbank and Purser, Fibonacci Grids,
// 2006), whose points all stand for nearly the same solid angle.
#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <paravent/occlusion.h>

enum { MAX_VIEWS = 4096 };

static const double PI = 3.14159265358979323846;

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

// Point `index` of `count` on the half sphere on which coordinate `axis` is negative: looking down.
static pvtVec3 GetHemispherePoint(int index, int count, int axis)
{
    const double turn = 2.0 * PI * fmod(0.6180339887498949 * index, 1.0);
    const double height = (index + 0.5) / count;
    const double radius = sqrt(1.0 - height * height);
    pvtVec3 point = {0};
    pvtSetAxis(&point, axis, -height);
    pvtSetAxis(&point, (axis + 1) % 3, radius * cos(turn));
    pvtSetAxis(&point, (axis + 2) % 3, radius * sin(turn));
    return point;
}

static pvtStatus CheckOptions(pvtContext* context, const pvtViewOptions* options)
{
    const size_t count = options->list != NULL ? options->listCount : (size_t)options->count;
    if ((options->list == NULL && options->count < 1) || count < 1 || count > MAX_VIEWS) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%zu view directions; 1 to %d are possible",
                       count, MAX_VIEWS);
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
    // Seen from the ground up to the zenith, or from anywhere: opposite views are mirror images, so
    // that the half sphere that looks down stands for both.
    size_t kept = 0;
    double total = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double weight = options->list != NULL ? options->list[i].weight : 1.0;
        if (weight > 0.0) {
            const pvtVec3 direction = options->list != NULL
                                          ? pvtNormalize(options->list[i].direction)
                                          : GetHemispherePoint((int)i, (int)count, options->up);
            views[kept++] = MakeView(direction, weight);
            total += weight;
        }
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
