// SPDX-License-Identifier: MIT
// A cut through the chains, from nothing up (cf. Silvennoinen et al., Occluder Simplification using
// Planar Sections, 2014, section 4.5). The paper adds whole polygons and shortens them afterwards.
// Here a step adds as many links of one chain as gain most of the measure per triangle, so that the
// budget is spent where it counts from the first triangle on. Gains are evaluated lazily (Minoux,
// Accelerated Greedy Algorithms, 1978): those of earlier steps order the queue, and only its head
// is evaluated again. The same holds for the levels of a chain: what each gained the last time
// tells which of them may still be the best.
#include "select.h"
#include "base/context.h"
#include "base/vector.h"
#include "scorer.h"

#include <math.h>
#include <paravent/occluder.h>
#include <string.h>

enum {
    HEAD = 16, // candidates evaluated at once: fixed, so that threads do not matter
    MAX_LEVELS = 24,
    OPENING = 2, // a first link of a chain is a quadrilateral: single triangles gain more each, but
                 // leave more panels than can grow, and hexagons leave too few
    MAX_WORDS = PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE / 64,
};

// What a candidate offers next.
typedef struct Offer {
    double gain; // per triangle; a guess from above until it is evaluated
    int32_t level;
    bool fresh;              // evaluated against the present cut
    bool isKnown;            // `gains` holds
    float gains[MAX_LEVELS]; // of the levels above the present one, the last time: none is more now
} Offer;

typedef struct Selection {
    pvtContext* context;
    const pvtSelectOptions* options;
    const pvtCandidateSet* candidates;
    pvtScorer scorer;
    pvtScoredMaskSet covered;
    Offer* offers;
    pvtCut* cut;
    int left; // triangles of the budget
    size_t head[HEAD];
    size_t headCount;
} Selection;

pvtSelectOptions pvtDefaultSelectOptions(void)
{
    return (pvtSelectOptions){.budget = 64, .completion = 0.01};
}

// The levels worth trying above `present`: two triangles first, all of the next few, then ever
// fewer.
static int ListLevels(int32_t present, int32_t most, int32_t levels[MAX_LEVELS])
{
    int count = 0;
    int32_t step = 1;
    const int32_t opening = most < OPENING ? most : OPENING;
    for (int32_t level = present == 0 ? opening : present + 1; level <= most && count < MAX_LEVELS;
         level += step) {
        levels[count++] = level;
        if (count >= 4) {
            step += step / 2 + 1;
        }
    }
    return count;
}

// The mask with one more polygon drawn over what is covered.
static void CoverMask(const Selection* selection, size_t mask, const pvtPlane* plane,
                      const pvtPoint2* points, size_t count, uint64_t* rows)
{
    const pvtScorer* scorer = &selection->scorer;
    const uint64_t* covered = selection->covered.masks[mask].rows;
    memset(rows, 0, scorer->wordCount * sizeof *rows);
    pvtDrawSectionPolygon(scorer, mask, plane, points, count, rows);
    for (size_t word = 0; word < scorer->wordCount; ++word) {
        rows[word] |= covered[word];
    }
}

static double GetGain(const Selection* selection, size_t candidate, int32_t level)
{
    const pvtScorer* scorer = &selection->scorer;
    const pvtPlane* plane = &selection->candidates->planes[candidate];
    pvtPoint2 points[256];
    const size_t count =
        pvtChainSet_GetLink(&selection->candidates->chains, candidate, level, points);
    double gain = 0.0;
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        uint64_t rows[MAX_WORDS];
        CoverMask(selection, m, plane, points, count, rows);
        gain +=
            pvtScoreRows(scorer, &selection->covered, m, rows) - selection->covered.masks[m].value;
    }
    return gain;
}

typedef struct LevelList {
    int32_t levels[MAX_LEVELS];
    int count;
} LevelList;

// Of those above the present one, with at most so many triangles more.
static LevelList ListNextLevels(const Selection* selection, size_t candidate, int32_t left)
{
    const int32_t present = selection->cut->triangles[candidate];
    int32_t most = selection->candidates->triangles[candidate];
    most = most - present > left ? present + left : most;
    LevelList list;
    list.count = ListLevels(present, most > 254 ? 254 : most, list.levels);
    return list;
}

// Bounds for all levels from the gain of the last one: a shorter link lies in a longer one but for
// a little. With a budget that ran low there are fewer levels now than there may be later.
static void GuessGains(const Selection* selection, size_t candidate, Offer* offer)
{
    static const double MORE = 1.1;
    const int32_t present = selection->cut->triangles[candidate];
    const LevelList list = ListNextLevels(selection, candidate, INT32_MAX);
    const double gain =
        list.count > 0 ? GetGain(selection, candidate, list.levels[list.count - 1]) : 0.0;
    for (int l = 0; l < list.count; ++l) {
        offer->gains[l] = (float)(MORE * gain / (list.levels[l] - present));
    }
    offer->isKnown = true;
}

// Levels by falling gains of the last time, until none of those left can be better.
static void EvaluateOffer(const Selection* selection, size_t candidate, Offer* offer)
{
    const int32_t present = selection->cut->triangles[candidate];
    const LevelList list = ListNextLevels(selection, candidate, selection->left);
    if (!offer->isKnown) {
        GuessGains(selection, candidate, offer);
    }
    bool isDone[MAX_LEVELS] = {false};
    double best = 0.0;
    int32_t bestLevel = present;
    while (!pvtIsCancelled(selection->context)) {
        int next = -1;
        for (int l = 0; l < list.count; ++l) {
            if (!isDone[l] && (next < 0 || offer->gains[l] > offer->gains[next])) {
                next = l;
            }
        }
        if (next < 0 || (double)offer->gains[next] < best) {
            break;
        }
        isDone[next] = true;
        const int32_t level = list.levels[next];
        const double gain = GetGain(selection, candidate, level) / (level - present);
        offer->gains[next] = (float)gain;
        if (gain > best || (gain == best && level < bestLevel)) {
            best = gain;
            bestLevel = level;
        }
    }
    offer->gain = best;
    offer->level = bestLevel;
    offer->fresh = true;
    // With a single triangle left the first level is another than with more.
    offer->isKnown = present > 0 || selection->left >= OPENING;
}

static void EvaluateHead(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Selection* selection = taskData;
    for (size_t i = begin; i < end; ++i) {
        const size_t candidate = selection->head[i];
        EvaluateOffer(selection, candidate, &selection->offers[candidate]);
    }
}

// The best offers by what is known of them, best first; ties by index.
static void CollectHead(Selection* selection)
{
    selection->headCount = 0;
    for (size_t c = 0; c < selection->cut->count; ++c) {
        const double gain = selection->offers[c].gain;
        if (gain <= 0.0) {
            continue;
        }
        size_t at = selection->headCount;
        while (at > 0 && selection->offers[selection->head[at - 1]].gain < gain) {
            --at;
        }
        if (at == HEAD) {
            continue;
        }
        selection->headCount += selection->headCount < HEAD ? 1 : 0;
        for (size_t i = selection->headCount - 1; i > at; --i) {
            selection->head[i] = selection->head[i - 1];
        }
        selection->head[at] = c;
    }
}

static void Accept(Selection* selection, size_t candidate)
{
    const Offer* offer = &selection->offers[candidate];
    const pvtScorer* scorer = &selection->scorer;
    selection->left -= offer->level - selection->cut->triangles[candidate];
    selection->cut->triangles[candidate] = offer->level;
    pvtPoint2 points[256];
    const size_t count =
        pvtChainSet_GetLink(&selection->candidates->chains, candidate, offer->level, points);
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        uint64_t rows[MAX_WORDS];
        CoverMask(selection, m, &selection->candidates->planes[candidate], points, count, rows);
        pvtAssignRows(scorer, &selection->covered, m, rows);
    }
    // The best chain may have more to offer; all others know only what they would have gained
    // before.
    for (size_t c = 0; c < selection->cut->count; ++c) {
        selection->offers[c].fresh = false;
    }
    selection->offers[candidate].gain = HUGE_VAL;
    selection->offers[candidate].isKnown = false;
}

// From above: the measure of a disc of the link's area, seen from every view.
static void GuessOffers(Selection* selection)
{
    const pvtChainSet* chains = &selection->candidates->chains;
    for (size_t c = 0; c < chains->count; ++c) {
        const pvtPlane* plane = &selection->candidates->planes[c];
        const pvtVec3 normal = pvtPlane_GetNormal(plane);
        double seen = 0.0;
        for (size_t v = 0; v < selection->options->views->count; ++v) {
            const pvtView* view = &selection->options->views->views[v];
            const double facing = fabs(pvtDot(normal, view->direction));
            seen += view->weight * facing * sqrt(facing);
        }
        const double voxel = selection->candidates->frame.voxelSize / (1 << PVT_POINT_BITS);
        const LevelList list = ListNextLevels(selection, c, selection->left);
        for (int l = 0; l < list.count; ++l) {
            const int32_t level = list.levels[l];
            pvtPoint2 points[256];
            const size_t n = pvtChainSet_GetLink(chains, c, level, points);
            const double area = 0.5 * (double)pvtGetLoopArea2(points, n) * voxel * voxel *
                                pvtPlane_GetAreaScale(plane);
            const double gain = seen * area * sqrt(area) / (3.0 * sqrt(3.14159265358979323846));
            if (gain / level > selection->offers[c].gain) {
                selection->offers[c].gain = gain / level;
                selection->offers[c].level = level;
            }
        }
    }
}

// Until the triangles that are left are spent, or nothing gains.
static pvtStatus RunSelection(Selection* selection)
{
    pvtContext* context = selection->context;
    const int budget = selection->options->budget + selection->options->surplus;
    while (selection->left > 0) {
        CollectHead(selection);
        if (selection->headCount == 0) {
            break;
        }
        const size_t best = selection->head[0];
        if (selection->offers[best].fresh &&
            selection->offers[best].level - selection->cut->triangles[best] <= selection->left) {
            Accept(selection, best);
            pvtReportProgress(context, 1.0 - (double)selection->left / budget);
            continue;
        }
        pvtParallelFor(context, EvaluateHead, selection->headCount, 1, selection);
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
    }
    return PVT_OK;
}

pvtStatus pvtCheckSelectOptions(pvtContext* context, const pvtSelectOptions* options)
{
    if (options->budget < 1 || options->budget > 65535) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "budget of %d triangles; 1 to 65535 are possible", options->budget);
    }
    return PVT_OK;
}

static pvtStatus CreateCut(pvtContext* context, size_t count, pvtCut* cut)
{
    *cut = (pvtCut){.count = count};
    cut->triangles = pvtAllocate(context, count, sizeof *cut->triangles);
    return cut->triangles == NULL ? pvtContext_GetStatus(context) : PVT_OK;
}

// With a surplus the same selection goes on. What gains nothing will not gain later either.
static pvtStatus RunWithSurplus(Selection* selection)
{
    pvtCut* cut = selection->cut;
    pvtCut ample;
    pvtStatus status = CreateCut(selection->context, cut->count, &ample);
    if (status != PVT_OK) {
        return status;
    }
    memcpy(ample.triangles, cut->triangles, cut->count * sizeof *ample.triangles);
    cut->ample = ample.triangles;
    for (size_t c = 0; c < cut->count; ++c) {
        selection->offers[c].fresh = false;
    }
    selection->cut = &ample;
    selection->left += selection->options->surplus;
    status = RunSelection(selection);
    selection->cut = cut;
    return status;
}

pvtStatus pvtSelectOccluder(pvtContext* context, const pvtSelectOptions* options,
                            const pvtCandidateSet* candidates, pvtCut* cut)
{
    *cut = (pvtCut){0};
    if (pvtCheckSelectOptions(context, options) != PVT_OK) {
        return pvtContext_GetStatus(context);
    }
    Selection selection = {.context = context,
                           .options = options,
                           .candidates = candidates,
                           .cut = cut,
                           .left = options->budget};
    const pvtScorerOptions scorer = {
        .views = options->views, .bounds = options->bounds, .size = 31, .exponent = 1};
    pvtStatus status = pvtCreateScorer(context, &scorer, &candidates->frame, &selection.scorer);
    if (status == PVT_OK) {
        status = pvtCreateScoredMasks(context, &selection.scorer, &selection.covered);
    }
    if (status == PVT_OK) {
        status = CreateCut(context, candidates->chains.count, cut);
    }
    if (status == PVT_OK) {
        selection.offers = pvtAllocate(context, candidates->chains.count, sizeof *selection.offers);
        status = selection.offers == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    }
    if (status == PVT_OK) {
        GuessOffers(&selection);
        status = RunSelection(&selection);
    }
    if (status == PVT_OK && options->surplus > 0) {
        status = RunWithSurplus(&selection);
    }
    pvtRelease(context, selection.offers);
    pvtScoredMaskSet_Free(context, &selection.covered);
    pvtScorer_Free(context, &selection.scorer);
    if (status != PVT_OK) {
        pvtCut_Free(context, cut);
    }
    return status;
}
