// SPDX-License-Identifier: MIT
// The paper's optimizer (Silvennoinen et al., Occluder Simplification using Planar Sections, 2014,
// section 4.5), kept for comparison: whole polygons are added by the total occlusion measure until
// one gains less than α, then chain steps are taken back, each the one that leaves most surface
// area, until the budget holds.
#include "base/context.h"
#include "scorer.h"
#include "select.h"

#include <string.h>

enum { MAX_WORDS = PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE / 64 };

typedef struct Reduction {
    pvtContext* context;
    const pvtCandidateSet* candidates;
    pvtScorer scorer;
    pvtScoredMaskSet covered;
    double* gains; // one a candidate, of the present step
    const pvtCut* cut;
    pvtPoint2* points; // of whole polygons: candidate c has starts[c] to starts[c + 1] − 1
    size_t* starts;
} Reduction;

// The longest links of all chains, one behind the other.
static pvtStatus CollectWhole(pvtContext* context, Reduction* reduction)
{
    const pvtCandidateSet* candidates = reduction->candidates;
    const size_t count = candidates->chains.count;
    reduction->starts = pvtAllocate(context, count + 1, sizeof *reduction->starts);
    if (reduction->starts == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t c = 0; c < count; ++c) {
        reduction->starts[c + 1] = reduction->starts[c] + (size_t)candidates->triangles[c] + 2;
    }
    reduction->points = pvtAllocate(context, reduction->starts[count], sizeof *reduction->points);
    if (reduction->points == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t c = 0; c < count; ++c) {
        pvtChainSet_GetLink(&candidates->chains, c, candidates->triangles[c],
                            reduction->points + reduction->starts[c]);
    }
    return PVT_OK;
}

// The mask with the candidate's whole polygon added.
static void DrawWhole(const Reduction* reduction, size_t candidate, size_t mask, uint64_t* rows)
{
    const pvtScorer* scorer = &reduction->scorer;
    const size_t first = reduction->starts[candidate];
    const size_t count = reduction->starts[candidate + 1] - first;
    memset(rows, 0, scorer->wordCount * sizeof *rows);
    pvtDrawSectionPolygon(scorer, mask, &reduction->candidates->planes[candidate],
                          reduction->points + first, count, rows);
    const uint64_t* covered = reduction->covered.masks[mask].rows;
    for (size_t word = 0; word < scorer->wordCount; ++word) {
        rows[word] |= covered[word];
    }
}

static void EvaluateGains(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Reduction* reduction = taskData;
    const pvtScorer* scorer = &reduction->scorer;
    for (size_t c = begin; c < end && !pvtIsCancelled(reduction->context); ++c) {
        double gain = 0.0;
        for (size_t m = 0; m < scorer->maskCount && reduction->cut->triangles[c] == 0; ++m) {
            uint64_t rows[MAX_WORDS];
            DrawWhole(reduction, c, m, rows);
            gain += pvtScoreRows(scorer, &reduction->covered, m, rows) -
                    reduction->covered.masks[m].value;
        }
        reduction->gains[c] = gain;
    }
}

// Adds the candidate with the largest gain; false when it gains less than the part `completion`.
static bool AddBest(Reduction* reduction, double completion, pvtCut* cut)
{
    const pvtScorer* scorer = &reduction->scorer;
    double present = 0.0;
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        present += reduction->covered.masks[m].value;
    }
    size_t best = 0;
    for (size_t c = 1; c < cut->count; ++c) {
        best = reduction->gains[c] > reduction->gains[best] ? c : best;
    }
    if (cut->count == 0 || reduction->gains[best] <= completion * present) {
        return false;
    }
    cut->triangles[best] = reduction->candidates->triangles[best];
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        uint64_t rows[MAX_WORDS];
        DrawWhole(reduction, best, m, rows);
        pvtAssignRows(scorer, &reduction->covered, m, rows);
    }
    return true;
}

// Area that the link loses when it gives up one triangle, in squared point units of its plane.
static double GetStepLoss(const pvtCandidateSet* candidates, size_t chain, int32_t triangles,
                          pvtPoint2* points)
{
    size_t count = pvtChainSet_GetLink(&candidates->chains, chain, triangles, points);
    const int64_t before = pvtGetLoopArea2(points, count);
    count =
        triangles > 1 ? pvtChainSet_GetLink(&candidates->chains, chain, triangles - 1, points) : 0;
    const int64_t after = count > 0 ? pvtGetLoopArea2(points, count) : 0;
    return (double)(before - after) * pvtPlane_GetAreaScale(&candidates->planes[chain]);
}

static pvtStatus StepBack(pvtContext* context, const pvtCandidateSet* candidates, int budget,
                          pvtCut* cut)
{
    int64_t total = 0;
    int32_t longest = 0;
    for (size_t c = 0; c < cut->count; ++c) {
        total += cut->triangles[c];
        longest = cut->triangles[c] > longest ? cut->triangles[c] : longest;
    }
    double* losses = pvtAllocate(context, cut->count, sizeof *losses);
    pvtPoint2* points = pvtAllocate(context, (size_t)longest + 2, sizeof *points);
    pvtStatus status = losses == NULL || points == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    for (size_t c = 0; c < cut->count && status == PVT_OK; ++c) {
        if (cut->triangles[c] > 0) {
            losses[c] = GetStepLoss(candidates, c, cut->triangles[c], points);
        }
    }
    while (status == PVT_OK && total > budget) {
        size_t best = cut->count;
        for (size_t c = 0; c < cut->count; ++c) {
            if (cut->triangles[c] > 0 && (best == cut->count || losses[c] < losses[best])) {
                best = c;
            }
        }
        --cut->triangles[best];
        --total;
        if (cut->triangles[best] > 0) {
            losses[best] = GetStepLoss(candidates, best, cut->triangles[best], points);
        }
        if ((total & 255) == 0 && pvtIsCancelled(context)) {
            status = pvtFailCancelled(context);
        }
    }
    pvtRelease(context, points);
    pvtRelease(context, losses);
    return status;
}

static pvtStatus RunReduction(Reduction* reduction, const pvtSelectOptions* options, pvtCut* cut)
{
    pvtContext* context = reduction->context;
    for (size_t step = 0; step < cut->count; ++step) {
        pvtParallelFor(context, EvaluateGains, cut->count, 4, reduction);
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        if (!AddBest(reduction, options->completion, cut)) {
            break;
        }
        pvtReportProgress(context, 1.0 - 1.0 / (double)(step + 2));
    }
    return StepBack(context, reduction->candidates, options->budget, cut);
}

pvtStatus pvtReduceOccluder(pvtContext* context, const pvtSelectOptions* options,
                            const pvtCandidateSet* candidates, pvtCut* cut)
{
    *cut = (pvtCut){0};
    if (pvtCheckSelectOptions(context, options) != PVT_OK) {
        return pvtContext_GetStatus(context);
    }
    const size_t count = candidates->chains.count;
    Reduction reduction = {.context = context, .candidates = candidates, .cut = cut};
    const pvtScorerOptions scorer = {
        .views = options->views, .bounds = options->bounds, .size = 64, .exponent = 1};
    pvtStatus status = pvtCreateScorer(context, &scorer, &candidates->frame, &reduction.scorer);
    if (status == PVT_OK) {
        status = pvtCreateScoredMasks(context, &reduction.scorer, &reduction.covered);
    }
    if (status == PVT_OK) {
        cut->triangles = pvtAllocate(context, count, sizeof *cut->triangles);
        cut->count = count;
        reduction.gains = pvtAllocate(context, count, sizeof *reduction.gains);
        status = cut->triangles == NULL || reduction.gains == NULL ? pvtContext_GetStatus(context)
                                                                   : PVT_OK;
    }
    if (status == PVT_OK) {
        status = CollectWhole(context, &reduction);
    }
    if (status == PVT_OK) {
        status = RunReduction(&reduction, options, cut);
    }
    pvtRelease(context, reduction.points);
    pvtRelease(context, reduction.starts);
    pvtRelease(context, reduction.gains);
    pvtScoredMaskSet_Free(context, &reduction.covered);
    pvtScorer_Free(context, &reduction.scorer);
    if (status != PVT_OK) {
        pvtCut_Free(context, cut);
    }
    return status;
}
