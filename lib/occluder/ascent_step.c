// SPDX-License-Identifier: MIT
// When triangles leave their planes, what for, and how long they climb.
#include "ascent.h"
#include "steps.h"

#include "base/context.h"
#include "voxel/bit_grid.h"

// Voxels along the longest side beyond which a quarter of one is too little to matter for a goal,
// which is looked at in nodes of four voxels and more (ascent.c), and cells would take most memory.
enum { FINEST_GOAL = 512 };

bool pvtMayAscend(const pvtBuild* build)
{
    const bool hasRoom = build->stats.tolerance > 0.0 || build->solid.strictCount > 0;
    // Of a larger budget so many climb, and by the measure all of it is taken where that hides
    // more. Within a tolerance that was asked for nothing tells: there all stay in their planes.
    const bool isKnown = build->stats.tolerance == 0.0 || build->isBand;
    return !pvtIsPaper(build) && hasRoom && (isKnown || build->options->budget <= PVT_MOST_ASCENT);
}

int pvtGetAscentBudget(const pvtBuild* build)
{
    return build->options->budget < PVT_MOST_ASCENT ? build->options->budget : PVT_MOST_ASCENT;
}

pvtInterior pvtGetInterior(const pvtBuild* build)
{
    return (pvtInterior){.allowed = &build->allowed,
                         .cells = build->cells.count > 0 ? &build->cells : NULL,
                         .touching = build->touching.starts != NULL ? &build->touching : NULL};
}

// What there is to hide, where it is not what the mesh hides.
typedef struct Goal {
    const pvtBitGrid* voxels;
    const pvtCellGrid* cells; // null: none
    pvtBitGrid ownVoxels;
    pvtCellGrid ownCells;
} Goal;

static void FreeGoal(pvtContext* context, Goal* goal)
{
    pvtBitGrid_Free(context, &goal->ownVoxels);
    pvtCellGrid_Free(context, &goal->ownCells);
}

// Within a tolerance triangles may stick out, but nothing is to be gained there: the goal is the
// inside, as exact as it is where there is no tolerance, and the touched voxels of sheets, which
// have no inside beside them.
static pvtStatus MakeGoalWithin(pvtContext* context, const pvtBuild* build, Goal* goal)
{
    pvtStatus status = pvtMakeAllowedGrid(context, &build->solid, 0.0, &goal->ownVoxels);
    if (status == PVT_OK) {
        status = pvtRefineAllowedGrid(context, build->mesh, &build->solid, &goal->ownVoxels,
                                      &goal->ownCells);
    }
    for (size_t i = 0; i < goal->ownVoxels.wordCount && status == PVT_OK; ++i) {
        goal->ownVoxels.words[i] |= build->solid.surface.words[i] & ~goal->ownCells.voxels.words[i];
    }
    goal->voxels = &goal->ownVoxels;
    goal->cells = goal->ownCells.count > 0 ? &goal->ownCells : NULL;
    return status;
}

static pvtStatus MakeGoal(pvtContext* context, const pvtBuild* build, Goal* goal)
{
    // What is below a landscape is inside because somebody says so. From the side it is seen, below
    // the landscape's edge, and hides what the landscape does not.
    if (build->options->terrain) {
        goal->voxels = &build->solid.surface;
        return PVT_OK;
    }
    if (build->stats.tolerance == 0.0) {
        goal->voxels = build->hiding.words != NULL ? &build->hiding : &build->allowed;
        goal->cells = pvtGetInterior(build).cells;
        return PVT_OK;
    }
    if (pvtGetLongestSide(build->solid.inside.frame.size) > FINEST_GOAL) {
        goal->voxels = &build->solid.inside;
        return PVT_OK;
    }
    return MakeGoalWithin(context, build, goal);
}

double pvtGetTimeShare(const pvtBuild* build)
{
    // Touched voxels as a multiple of those of a square along the longest side: a cube has 6.
    static const double MUCH_SURFACE = 8.0;
    const double side = build->stats.resolution;
    const double share = MUCH_SURFACE * side * side / (double)build->solid.surfaceCount;
    return build->options->effort == PVT_EFFORT_FAST && share < 1.0 ? share : 1.0;
}

static pvtStatus Ascend(pvtContext* context, pvtBuild* build)
{
    static const struct {
        int iterations, cycles, sights, batch, polish;
    } efforts[] = {[PVT_EFFORT_FAST] = {240, 0, 512, 12, 1},
                   [PVT_EFFORT_DEFAULT] = {185, 3, 1024, 8, 3},
                   [PVT_EFFORT_BEST] = {450, 16, 1024, 16, 12}};
    const int effort = (int)build->options->effort;
    const int budget = pvtGetAscentBudget(build);
    const double share = pvtGetTimeShare(build);
    const double mostWrong = pvtGetMostWrong(build);
    // Along a surface triangles have a long way to where they are needed, whatever the effort.
    const int least = build->options->terrain || build->isBand ? 1 : 0;
    const pvtViewOptions views = pvtGetViewOptions(build);
    Goal goal = {0};
    pvtStatus status = mostWrong > 0.0 ? PVT_OK : MakeGoal(context, build, &goal);
    const pvtAscentOptions options = {
        .views = &views,
        .goal = goal.voxels,
        .goalCells = goal.cells,
        .mindsBeyond = build->options->terrain && !build->isBand,
        .mostWrong = mostWrong,
        .stray = build->stats.tolerance,
        .inside = &build->inside,
        .mesh = build->mesh,
        .flat = build->stats.tolerance > 0.0 ? &build->flat.mesh : NULL,
        .sheets = &build->sheets,
        .budget = budget,
        .seed = build->options->seed,
        .startEnds = build->startEnds,
        .startCount = build->startCount,
        .iterations = (int)(share * pvtSpreadEffort(efforts[effort].iterations, budget)),
        .cycles = efforts[effort].cycles > least ? efforts[effort].cycles : least,
        .sights = (int)(share * efforts[effort].sights),
        .batch = efforts[effort].batch,
        .polish = efforts[effort].polish,
        .enough = pvtGetEnough(build)};
    if (status == PVT_OK) {
        status = pvtAscendOccluder(context, &options, &build->occluder);
    }
    FreeGoal(context, &goal);
    return status;
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
