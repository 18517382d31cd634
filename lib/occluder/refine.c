// SPDX-License-Identifier: MIT
// Refinement by stochastic hill climbing: random changes are kept when they raise the measure. The
// paper has no such stage. Accepting small losses for a while (threshold accepting) found better
// occluders only after ten times as many trials.
#include "refine.h"

#include "base/context.h"
#include "moves.h"
#include "occluder.h"

#include <math.h>
#include <string.h>

enum { BATCH = 8, ROUNDS = 3 };

typedef struct Trial {
    pvtChange change;
    bool made;
    pvtStatus status;
    pvtMoveScratch scratch;
} Trial;

typedef struct Refinement {
    pvtContext* context;
    const pvtRefineOptions* options;
    pvtArrangement arrangement;
    pvtMoveOptions moves;
    Trial* trials; // BATCH
    double reach;  // [vx] of the longest steps
    uint64_t next; // number of the batch's first trial: its dice
} Refinement;

static void RunTrials(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Refinement* refinement = taskData;
    for (size_t i = begin; i < end; ++i) {
        Trial* trial = &refinement->trials[i];
        pvtRandom random = pvtMakeRandom(refinement->options->seed, refinement->next + i);
        trial->made = pvtMakeMove(refinement->context, &refinement->arrangement, &refinement->moves,
                                  &trial->scratch, &random, &trial->change, &trial->status);
        if (trial->made) {
            pvtEvaluateChange(&refinement->arrangement, &trial->change);
        }
    }
}

static pvtStatus PlaceOccluder(pvtContext* context, pvtArrangement* arrangement,
                               const pvtOccluder* occluder)
{
    const pvtLoopSet* loops = &occluder->loops;
    for (size_t l = 0; l < loops->loopCount; ++l) {
        const size_t count = loops->starts[l + 1] - loops->starts[l];
        pvtChange change = {.count = 1, .slots = {(int)l, 0}};
        change.panels[0].plane = occluder->planes[l];
        change.panels[0].count = (int)count;
        memcpy(change.panels[0].points, loops->points + loops->starts[l],
               count * sizeof(pvtPoint2));
        const pvtStatus status = pvtApplyChange(context, arrangement, &change);
        if (status != PVT_OK) {
            return status;
        }
    }
    return PVT_OK;
}

// One batch: changes are judged against what is there before it, and the first that gains is made.
// Those behind it count as not tried. So the outcome does not depend on the number of threads.
static pvtStatus RunBatch(pvtContext* context, Refinement* refinement)
{
    pvtParallelFor(context, RunTrials, BATCH, 1, refinement);
    for (int i = 0; i < BATCH; ++i) {
        const Trial* trial = &refinement->trials[i];
        ++refinement->next;
        if (trial->status != PVT_OK) {
            return trial->status;
        }
        if (trial->made && trial->change.value > refinement->arrangement.value) {
            return pvtApplyChange(context, &refinement->arrangement, &trial->change);
        }
    }
    return PVT_OK;
}

// Rounds end after so many trials, or with the last; each begins with large steps again.
static const double roundEnds[ROUNDS] = {1500.0, 20000.0, HUGE_VAL};

// One round: large steps and new structure first, small steps at the end. Sets *stop when time is
// up.
static pvtStatus Climb(pvtContext* context, Refinement* refinement, double end, bool* stop)
{
    const double total = refinement->options->trials;
    const double begin = (double)refinement->next;
    while ((double)refinement->next < end) {
        const double rest = 1.0 - ((double)refinement->next - begin) / (end - begin);
        refinement->moves.reach = refinement->reach * (0.02 + 0.98 * rest);
        refinement->moves.structure = 0.1 + 0.4 * rest;
        const pvtStatus status = RunBatch(context, refinement);
        if (status != PVT_OK) {
            return status;
        }
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        const double done = (double)refinement->next / total;
        if (pvtEnough_Ends(context, &refinement->options->enough, "refinement", "trials", done)) {
            *stop = true;
            return PVT_OK;
        }
        pvtReportProgress(context, done);
    }
    return PVT_OK;
}

static pvtStatus RunRounds(pvtContext* context, Refinement* refinement)
{
    const double total = refinement->options->trials;
    bool stop = false;
    for (int r = 0; r < ROUNDS && (double)refinement->next < total && !stop; ++r) {
        const pvtStatus status = Climb(context, refinement, fmin(roundEnds[r], total), &stop);
        if (status != PVT_OK) {
            return status;
        }
    }
    return PVT_OK;
}

static pvtStatus StorePanels(pvtContext* context, const pvtArrangement* arrangement,
                             pvtOccluder* occluder)
{
    size_t polygons = 0;
    size_t points = 0;
    for (int s = 0; s < arrangement->capacity; ++s) {
        const int count = arrangement->panels[s].panel.count;
        polygons += count > 0 ? 1 : 0;
        points += (size_t)count;
    }
    pvtOccluder refined;
    pvtStatus status = pvtAllocateOccluder(context, &occluder->frame, polygons, points, &refined);
    for (int s = 0; s < arrangement->capacity && status == PVT_OK; ++s) {
        const pvtPanel* panel = &arrangement->panels[s].panel;
        if (panel->count > 0) {
            pvtAddOccluderPolygon(&refined, &panel->plane, panel->points, (size_t)panel->count);
        }
    }
    if (status == PVT_OK) {
        status = pvtMakeOccluderMesh(context, &refined);
    }
    if (status != PVT_OK) {
        pvtOccluder_Free(context, &refined);
        return status;
    }
    pvtOccluder_Free(context, occluder);
    *occluder = refined;
    return PVT_OK;
}

// Running sums of the candidates' areas, so that large ones are drawn more often.
static double* SumAreas(pvtContext* context, const pvtCandidateSet* candidates)
{
    const size_t count = candidates->chains.count;
    double* sums = pvtAllocate(context, count, sizeof *sums);
    double sum = 0.0;
    for (size_t c = 0; c < count && sums != NULL; ++c) {
        pvtPoint2 points[PVT_MAX_FIT_POINTS];
        const size_t n =
            pvtChainSet_GetLink(&candidates->chains, c, PVT_MAX_FIT_POINTS - 2, points);
        sum += (double)pvtGetLoopArea2(points, n) * pvtPlane_GetAreaScale(&candidates->planes[c]);
        sums[c] = sum;
    }
    return sums;
}

pvtStatus pvtRefineOccluder(pvtContext* context, const pvtRefineOptions* options,
                            const pvtSliceVolume* volume, const pvtCandidateSet* candidates,
                            pvtOccluder* occluder)
{
    Refinement refinement = {.context = context, .options = options};
    const pvtScorerOptions scorer = {
        .views = options->views, .bounds = options->bounds, .size = 64, .exponent = 1};
    pvtStatus status =
        pvtCreateArrangement(context, &scorer, volume, options->budget, &refinement.arrangement);
    if (options->sheets != NULL && options->sheets->count > 0) {
        pvtUseSheets(&refinement.arrangement, options->sheets);
    }
    double* sums = SumAreas(context, candidates);
    refinement.trials = pvtAllocate(context, BATCH, sizeof *refinement.trials);
    if (status == PVT_OK && (sums == NULL || refinement.trials == NULL)) {
        status = pvtContext_GetStatus(context);
    }
    if (status == PVT_OK) {
        const int* size = volume->grid->frame.size;
        refinement.reach = 0.15 * fmax(size[0], fmax(size[1], size[2]));
        refinement.moves = (pvtMoveOptions){
            .budget = options->budget, .candidates = candidates, .candidateSums = sums};
        status = PlaceOccluder(context, &refinement.arrangement, occluder);
    }
    if (status == PVT_OK) {
        status = RunRounds(context, &refinement);
    }
    if (status == PVT_OK) {
        status = StorePanels(context, &refinement.arrangement, occluder);
    }
    for (int i = 0; i < BATCH && refinement.trials != NULL; ++i) {
        pvtBitmap_Free(context, &refinement.trials[i].scratch.cells);
    }
    pvtRelease(context, refinement.trials);
    pvtRelease(context, sums);
    pvtArrangement_Free(context, &refinement.arrangement);
    return status;
}
