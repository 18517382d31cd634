// SPDX-License-Identifier: MIT
// When triangles leave their planes, and how long they climb.
#include "ascent.h"
#include "steps.h"

#include "base/context.h"

bool pvtMayAscend(const pvtBuild* build)
{
    // Where polygons may leave the surface, moving them freely would use that up for the last
    // pixels.
    return build->options->method != PVT_METHOD_PAPER && build->solid.strictCount > 0 &&
           build->stats.tolerance == 0.0 && build->options->budget <= PVT_MOST_ASCENT;
}

pvtInterior pvtGetInterior(const pvtBuild* build)
{
    return (pvtInterior){.allowed = &build->allowed,
                         .cells = build->cells.count > 0 ? &build->cells : NULL,
                         .touching = build->touching.starts != NULL ? &build->touching : NULL};
}

static pvtStatus Ascend(pvtContext* context, pvtBuild* build)
{
    static const struct {
        int tries, iterations, cycles, sights, batch, polish;
    } efforts[] = {[PVT_EFFORT_FAST] = {1, 240, 0, 512, 12, 1},
                   [PVT_EFFORT_DEFAULT] = {1, 400, 6, 1024, 8, 3},
                   [PVT_EFFORT_BEST] = {4, 800, 16, 1024, 16, 12}};
    const int effort = (int)build->options->effort;
    const int budget = build->options->budget;
    pvtViewOptions views = build->options->views;
    views.up = (int)build->options->up;
    const pvtAscentOptions options = {
        .views = &views,
        .goal = build->hiding.words != NULL ? &build->hiding : &build->allowed,
        .inside = &build->inside,
        .mesh = build->mesh,
        .sheets = &build->sheets,
        .budget = budget,
        .seed = build->options->seed,
        .tries = efforts[effort].tries,
        .iterations = pvtSpreadEffort(efforts[effort].iterations, budget),
        .cycles = efforts[effort].cycles,
        .sights = efforts[effort].sights,
        .batch = efforts[effort].batch,
        .polish = efforts[effort].polish,
        .deadline = pvtGetDeadline(build)};
    return pvtAscendOccluder(context, &options, &build->occluder);
}

pvtStatus pvtAscendStep(pvtContext* context, pvtBuild* build)
{
    if (!pvtMayAscend(build)) {
        return PVT_OK;
    }
    const pvtInterior interior = pvtGetInterior(build);
    const pvtStatus status = pvtCreateInsideTest(context, &interior, &build->inside);
    return status == PVT_OK ? Ascend(context, build) : status;
}
