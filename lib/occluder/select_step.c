// SPDX-License-Identifier: MIT
// Which polygons are chosen, over which views, and how often: an ascent has several starts, each
// chosen over other views, since which of them leads farthest is only known at its end.
#include "steps.h"

#include "ascent.h"
#include "occluder.h"

#include "base/context.h"

// A start is chosen over fewer views than refinement and the final measure see. Within a tolerance
// the first may be the end, too, where rows of holes are to be hidden.
static int GetStartViewCount(const pvtBuild* build, int start)
{
    static const int others[PVT_MOST_STARTS] = {0, 8, 4, 12};
    const pvtEffort effort = build->options->effort;
    if (start > 0) {
        return others[start];
    }
    const bool isStart = effort == PVT_EFFORT_DEFAULT && build->stats.tolerance == 0.0;
    return effort == PVT_EFFORT_FAST ? 8 : isStart ? 12 : 16;
}

static int GetStartCount(const pvtBuild* build)
{
    static const int counts[] = {
        [PVT_EFFORT_FAST] = 1, [PVT_EFFORT_DEFAULT] = 3, [PVT_EFFORT_BEST] = PVT_MOST_STARTS};
    // Within a band a third one gains nothing.
    static const int inBand[] = {
        [PVT_EFFORT_FAST] = 1, [PVT_EFFORT_DEFAULT] = 2, [PVT_EFFORT_BEST] = PVT_MOST_STARTS};
    const pvtEffort effort = build->options->effort;
    return !pvtMayAscend(build) ? 1 : build->isBand ? inBand[effort] : counts[effort];
}

// A cut within `budget`, and with `surplus` more triangles another one, over at most so many views.
static pvtStatus Choose(pvtContext* context, pvtBuild* build, int viewCount, int budget,
                        int surplus, pvtCut* cut)
{
    pvtViewOptions few = pvtGetViewOptions(build);
    few.count = few.count < viewCount ? few.count : viewCount;
    pvtViewSet set;
    pvtStatus status = pvtMakeViews(context, &few, &set);
    if (status == PVT_OK) {
        pvtSelectOptions options = pvtDefaultSelectOptions();
        options.budget = budget;
        options.surplus = surplus;
        options.views = pvtIsPaper(build) ? &build->views : &set;
        options.bounds = build->bounds;
        status = pvtIsPaper(build) ? pvtReduceOccluder(context, &options, &build->candidates, cut)
                                   : pvtSelectOccluder(context, &options, &build->candidates, cut);
    }
    pvtViewSet_Free(context, &set);
    return status;
}

// The polygons that are chosen for the budget, to stay in their planes.
static pvtStatus TakeFlat(pvtContext* context, pvtBuild* build, pvtOccluder* occluder)
{
    const int viewCount = build->options->effort == PVT_EFFORT_FAST ? 16 : 36;
    pvtCut cut = {0};
    pvtStatus status = Choose(context, build, viewCount, build->options->budget, 0, &cut);
    if (status == PVT_OK) {
        status = pvtTakeCut(context, &build->candidates, &cut, occluder);
    }
    pvtCut_Free(context, &cut);
    return status;
}

// The polygons that a start of the ascent begins with; of the first those within the budget, too.
static pvtStatus TakeStart(pvtContext* context, pvtBuild* build, int start, pvtOccluder* occluder)
{
    const int budget = pvtGetAscentBudget(build);
    pvtCut cut = {0};
    pvtStatus status = Choose(context, build, GetStartViewCount(build, start), budget,
                              pvtGetAscentStart(budget) - budget, &cut);
    if (status == PVT_OK) {
        const pvtCut ample = {.triangles = cut.ample, .count = cut.count};
        status = pvtTakeCut(context, &build->candidates, &ample, occluder);
    }
    if (status == PVT_OK && start == 0) {
        status = budget == build->options->budget || !pvtIsMeasured(build)
                     ? pvtTakeCut(context, &build->candidates, &cut, &build->flat)
                     : TakeFlat(context, build, &build->flat);
    }
    pvtCut_Free(context, &cut);
    return status;
}

static bool IsEnough(const pvtBuild* build)
{
    const pvtEnough enough = pvtGetEnough(build);
    return pvtEnough_FindEnd(&enough) != NULL;
}

// What a list of views chooses is the same each time.
static pvtStatus TakeStarts(pvtContext* context, pvtBuild* build)
{
    const bool isSame = build->options->views.list != NULL;
    const int count = GetStartCount(build);
    pvtOccluder starts[PVT_MOST_STARTS] = {0};
    pvtStatus status = PVT_OK;
    for (int s = 0; s < count && status == PVT_OK && (s == 0 || !IsEnough(build)); ++s) {
        if (s > 0 && isSame) {
            starts[s] = starts[0];
        } else {
            status = pvtMayAscend(build) ? TakeStart(context, build, s, &starts[s])
                                         : TakeFlat(context, build, &starts[s]);
        }
        const size_t before = s > 0 ? build->startEnds[s - 1] : 0;
        build->startEnds[s] = before + starts[s].loops.loopCount;
        build->startCount = s + 1;
    }
    if (status == PVT_OK) {
        status = pvtJoinOccluders(context, starts, (size_t)build->startCount, &build->occluder);
    }
    for (int s = 0; s < (isSame ? 1 : count); ++s) {
        pvtOccluder_Free(context, &starts[s]);
    }
    return status;
}

pvtStatus pvtSelectStep(pvtContext* context, pvtBuild* build)
{
    const pvtViewOptions views = pvtGetViewOptions(build);
    const pvtStatus status = pvtMakeViews(context, &views, &build->views);
    return status == PVT_OK ? TakeStarts(context, build) : status;
}
