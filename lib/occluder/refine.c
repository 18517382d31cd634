// SPDX-License-Identifier: MIT
// Refinement by threshold accepting (Dueck and Scheuer, Threshold Accepting, 1990): random changes
// are kept unless they lose more than a threshold, which falls to nothing.
#include "refine.h"

#include "base/context.h"
#include "moves.h"
#include "occluder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BATCH = 8 };

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
    uint64_t next; // number of the batch's first trial
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

static double GetEnv(const char* name, double value)
{
    const char* text = getenv(name);
    return text != NULL ? atof(text) : value;
}

static pvtStatus Anneal(pvtContext* context, Refinement* refinement, pvtPanel* best)
{
    pvtArrangement* arrangement = &refinement->arrangement;
    const int total = refinement->options->trials;
    double bestValue = arrangement->value;
    const size_t capacity = (size_t)arrangement->capacity;
    for (size_t s = 0; s < capacity; ++s) {
        best[s] = arrangement->panels[s].panel;
    }
    const double threshold0 = GetEnv("PVT_T0", 1e-3);
    const double reach0 = refinement->moves.reach;
    long accepted = 0, improved = 0;
    int done = 0;
    while (done < total) {
        const double rest = 1.0 - (double)done / total;
        refinement->moves.reach = reach0 * (0.02 + 0.98 * rest);
        refinement->moves.structure = GetEnv("PVT_S0", 0.4) * rest + 0.1;
        const double threshold = threshold0 * rest * rest * bestValue;
        pvtParallelFor(context, RunTrials, BATCH, 1, refinement);
        for (int i = 0; i < BATCH; ++i) {
            Trial* trial = &refinement->trials[i];
            ++done;
            ++refinement->next;
            if (trial->status != PVT_OK) {
                return trial->status;
            }
            if (!trial->made || trial->change.value <= arrangement->value - threshold) {
                continue;
            }
            ++accepted;
            const pvtStatus status = pvtApplyChange(context, arrangement, &trial->change);
            if (status != PVT_OK) {
                return status;
            }
            if (arrangement->value > bestValue) {
                ++improved;
                bestValue = arrangement->value;
                for (size_t s = 0; s < capacity; ++s) {
                    best[s] = arrangement->panels[s].panel;
                }
            }
            break; // what follows was judged against what was there before
        }
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        pvtReportProgress(context, (double)done / total);
    }
    pvtLog(context, PVT_LOG_DEBUG, "refine: %d trials, %ld accepted, %ld better, value %g", done,
           accepted, improved, bestValue);
    return PVT_OK;
}

static pvtStatus StorePanels(pvtContext* context, const pvtPanel* panels, int capacity,
                             pvtOccluder* occluder)
{
    size_t polygons = 0;
    size_t points = 0;
    for (int s = 0; s < capacity; ++s) {
        polygons += panels[s].count > 0 ? 1 : 0;
        points += (size_t)panels[s].count;
    }
    pvtOccluder refined;
    pvtStatus status = pvtAllocateOccluder(context, &occluder->frame, polygons, points, &refined);
    for (int s = 0; s < capacity && status == PVT_OK; ++s) {
        if (panels[s].count > 0) {
            pvtAddOccluderPolygon(&refined, &panels[s].plane, panels[s].points,
                                  (size_t)panels[s].count);
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

pvtStatus pvtRefineOccluder(pvtContext* context, const pvtRefineOptions* options,
                            const pvtSliceVolume* volume, const pvtCandidateSet* candidates,
                            pvtOccluder* occluder)
{
    Refinement refinement = {.context = context, .options = options};
    const pvtScorerOptions scorer = {.views = options->views,
                                     .bounds = options->bounds,
                                     .size = 64,
                                     .exponent = (int)GetEnv("PVT_EXP", 1)};
    const int capacity = options->budget;
    pvtStatus status =
        pvtCreateArrangement(context, &scorer, volume, capacity, &refinement.arrangement);
    const size_t count = candidates->chains.count;
    double* sums = pvtAllocate(context, count, sizeof *sums);
    pvtPanel* best = pvtAllocate(context, (size_t)capacity, sizeof *best);
    refinement.trials = pvtAllocate(context, BATCH, sizeof *refinement.trials);
    if (status == PVT_OK && (sums == NULL || best == NULL || refinement.trials == NULL)) {
        status = pvtContext_GetStatus(context);
    }
    if (status == PVT_OK) {
        double sum = 0.0;
        for (size_t c = 0; c < count; ++c) {
            const size_t first = candidates->chains.starts[c];
            sum += (double)pvtGetLoopArea2(candidates->chains.points + first,
                                           candidates->chains.starts[c + 1] - first);
            sums[c] = sum;
        }
        const int* size = volume->grid->frame.size;
        refinement.moves = (pvtMoveOptions){.budget = options->budget,
                                            .reach = 0.15 * fmax(size[0], fmax(size[1], size[2])),
                                            .candidates = candidates,
                                            .candidateSums = sums};
        status = PlaceOccluder(context, &refinement.arrangement, occluder);
    }
    if (status == PVT_OK) {
        status = Anneal(context, &refinement, best);
    }
    if (status == PVT_OK) {
        status = StorePanels(context, best, capacity, occluder);
    }
    for (int i = 0; i < BATCH && refinement.trials != NULL; ++i) {
        pvtBitmap_Free(context, &refinement.trials[i].scratch.cells);
    }
    pvtRelease(context, refinement.trials);
    pvtRelease(context, best);
    pvtRelease(context, sums);
    pvtArrangement_Free(context, &refinement.arrangement);
    return status;
}
