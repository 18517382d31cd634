// SPDX-License-Identifier: MIT
// How the ascent goes: steps, and what they become less of. Softness, the steps' length and the
// number of triangles fall together, from a few pixels that matter everywhere to the last ones at
// the silhouette. What such a climb ends at depends on where it began. So there are several starts;
// what the next climb ends at and the best so far are united, as in memetic algorithms (Moscato, On
// Evolution, Search, Optimization, Genetic Algorithms and Martial Arts, 1989), and of twice as many
// triangles the least useful are taken away while all go on climbing. After that come cycles, as in
// iterated local search (Lourenço et al., 2003): the best so far is softened again, triangles are
// added where most is left to hide, and the least useful ones are taken away on the way down.
#include "ascent_state.h"

#include "base/context.h"
#include "voxel/bit_grid.h"

#include <math.h>
#include <string.h>

enum {
    LEGS = 2, // of a climb
    SWEEPS = 3,
    CONTACT_STEPS = 8,
    LATE_CONTACT_STEPS = 4,
    PRUNE_ROUNDS = 40, // in which a surplus is taken away
};

// A fall of softness and reach by factors e^−x.
typedef struct Leg {
    double share;                 // of the iterations of a climb
    float softness, softnessFall; // [px]
    float reach, reachFall;       // [vx] at 256 along the longest side
    double pruneBegin, pruneEnd;  // shares of the leg between which the surplus is taken away
} Leg;

static const Leg climb[LEGS] = {{0.55, 120.0F, 2.3F, 3.0F, 1.8F, 0.0, 1.0},
                                {0.45, 12.0F, 2.8F, 0.5F, 1.6F, 0.0, 0.0}};
static const Leg crossing = {1.4, 60.0F, 4.5F, 2.0F, 3.0F, 0.0, 0.7};
static const Leg cycle = {1.4, 60.0F, 4.5F, 2.0F, 3.0F, 0.3, 0.7};

static const double SHELL_SHARE = 1.6;    // of the iterations that there are elsewhere
static const double GROWTH = 0.35;        // triangles added in a cycle, as part of the budget
static const float JUDGE_SOFTNESS = 0.6F; // [px]
static const float LATE_SOFTNESS = 12.0F; // [px] below which contacts are looked for more closely
static const float COARSE_PIECE = 16.0F, FINE_PIECE = 8.0F; // [vx]
static const float MOMENTUM = 0.9F, SQUARES = 0.98F;
static const float THIN_LOOK = 4.0F, THIN_LEAST = 0.1F, SHELL_LEAST = 0.3F; // [vx]
static const float THIN_PART = 0.1F;
// Of a pixel that is hidden wrongly, as one that is rightly counts 1.
static const float FIRST_COST = 5.0F, LEAST_COST = 0.3F, MOST_COST = 100.0F;
static const float COST_RATE = 0.03F; // that it changes by in a step, at most
static const double MEMORY = 0.9;     // of what was hidden, from a step to the next
// Of the share of all that is hidden rightly: what a greater share than the most costs that may be
// hidden wrongly.
static const double EXCESS_COST = 100.0;
static const float AHEAD = 2.0F;       // of a step
static const float LEAST_PULL = 0.02F; // of the strongest: corners that are pulled less move less

// Where the inside is thin, steps are short: a fraction of how deep it is a little farther in. In a
// shell there is nothing else, and triangles have a long way to go along it.
static float LimitReach(const pvtAscent* ascent, const float corner[3])
{
    float inward[3], deeper[3];
    pvtField_GetDepthAndInward(&ascent->field, corner, inward);
    for (int axis = 0; axis < 3; ++axis) {
        deeper[axis] = corner[axis] + THIN_LOOK * inward[axis];
    }
    const float depth = pvtField_GetDepth(&ascent->field, deeper);
    const float least = ascent->isShell ? SHELL_LEAST : THIN_LEAST;
    const float most = least + THIN_PART * (depth > 0.0F ? depth : 0.0F);
    return ascent->reach < most ? ascent->reach : most;
}

// The mean pull over the root of its mean square: about 1 for a corner that is always pulled the
// same way, and next to nothing for one that is pulled to and fro.
static void MoveCorners(pvtAscent* ascent)
{
    pvtTriangleSet* set = &ascent->set;
    float* steps = ascent->contacts.steps;
    float most = 0.0F;
    memset(steps, 0, (size_t)set->cornerCount * sizeof *steps);
    for (int c = 0; c < set->cornerCount; ++c) {
        float* speed = ascent->speeds[c];
        float square = 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
            const float pull = ascent->puller.corners[c][axis];
            speed[axis] = MOMENTUM * speed[axis] + (1.0F - MOMENTUM) * pull;
            square += pull * pull;
        }
        ascent->squares[c] = SQUARES * ascent->squares[c] + (1.0F - SQUARES) * square;
        most = ascent->squares[c] > most ? ascent->squares[c] : most;
    }
    for (int c = 0; c < set->cornerCount && most > 0.0F; ++c) {
        const float scale = LimitReach(ascent, set->corners[c]) /
                            (sqrtf(ascent->squares[c]) + LEAST_PULL * sqrtf(most));
        float square = 0.0F;
        for (int axis = 0; axis < 3 && !set->isFixed[c]; ++axis) {
            const float step = scale * ascent->speeds[c][axis];
            set->corners[c][axis] += step;
            square += step * step;
        }
        steps[c] = sqrtf(square);
    }
}

// What is hidden wrongly costs more as long as it is too much, and less otherwise: a Lagrange
// multiplier that follows (Platt and Barr, Constrained Differential Optimization, 1987).
static void AdaptCost(pvtAscent* ascent)
{
    const double most = ascent->options->mostWrong;
    ascent->right = MEMORY * ascent->right + ascent->puller.right;
    ascent->wrong = MEMORY * ascent->wrong + ascent->puller.wrong;
    const double hidden = ascent->right + ascent->wrong;
    if (most > 0.0) {
        const double excess = hidden > 0.0 ? ascent->wrong / hidden / most - 1.0 : -1.0;
        ascent->wrongCost *= 1.0F + COST_RATE * (float)(excess < 1.0 ? excess : 1.0);
        ascent->wrongCost = ascent->wrongCost > LEAST_COST ? ascent->wrongCost : LEAST_COST;
        ascent->wrongCost = ascent->wrongCost < MOST_COST ? ascent->wrongCost : MOST_COST;
    }
}

void pvtAscent_Step(pvtContext* context, pvtAscent* ascent, bool wantsEdges)
{
    const pvtPullOptions pull = {.first = ascent->next,
                                 .count = wantsEdges ? PVT_MOST_BATCH : ascent->options->batch,
                                 .softness = ascent->softness,
                                 .inset = PVT_ASCENT_INSET,
                                 .mindsBeyond = ascent->options->mindsBeyond,
                                 .wrongCost = ascent->wrongCost,
                                 .wantsEdges = wantsEdges};
    pvtPullCorners(context, &pull, &ascent->puller);
    AdaptCost(ascent);
    ascent->next = (ascent->next + (size_t)pull.count) % ascent->sights.count;
    // Contacts change slowly: they are looked for now and then, a little farther away.
    const bool isLate = ascent->softness < LATE_SOFTNESS;
    const pvtContactOptions contact = {.inside = ascent->options->inside,
                                       .band = AHEAD * ascent->reach,
                                       .piece = isLate ? FINE_PIECE : COARSE_PIECE,
                                       .isAnew = ascent->contactAge == 0};
    if (ascent->contactAge++ % (isLate ? LATE_CONTACT_STEPS : CONTACT_STEPS) == 0) {
        pvtFindContacts(context, &contact, &ascent->field, &ascent->set, &ascent->contacts);
    } else {
        pvtUpdateContacts(&ascent->field, &ascent->set, &ascent->contacts);
    }
    for (int c = 0; c < ascent->set.cornerCount; ++c) {
        if (ascent->set.isFixed[c]) {
            memset(ascent->puller.corners[c], 0, sizeof ascent->puller.corners[c]);
        }
    }
    pvtSlideAlong(&ascent->contacts, ascent->reach, &ascent->set, SWEEPS, ascent->puller.corners);
    MoveCorners(ascent);
    pvtPushInside(&ascent->contacts, &ascent->field, SWEEPS, &ascent->set);
}

// What the triangles hide, as a share of all that can be, over all sights; less where too much of
// it is wrong.
static double Judge(pvtContext* context, pvtAscent* ascent)
{
    double sum = 0.0, right = 0.0, wrong = 0.0;
    const size_t count = ascent->sights.count;
    for (size_t first = 0; first < count; first += PVT_MOST_BATCH) {
        const size_t left = count - first;
        const pvtPullOptions pull = {.first = first,
                                     .count = (int)(left < PVT_MOST_BATCH ? left : PVT_MOST_BATCH),
                                     .softness = JUDGE_SOFTNESS,
                                     .inset = PVT_ASCENT_INSET,
                                     .mindsBeyond = ascent->options->mindsBeyond,
                                     .wantsNoPulls = true};
        pvtPullCorners(context, &pull, &ascent->puller);
        sum += ascent->puller.share * pull.count;
        right += ascent->puller.right;
        wrong += ascent->puller.wrong;
    }
    const double share = wrong > 0.0 ? wrong / (right + wrong) : 0.0;
    const double excess = share - ascent->options->mostWrong;
    return sum / (double)count - (excess > 0.0 ? EXCESS_COST * excess : 0.0);
}

// Forgets what is known of the corners and contacts of another set.
static void TakeRest(pvtAscent* ascent)
{
    const size_t corners = (size_t)ascent->set.cornerCapacity;
    memset(ascent->speeds, 0, corners * sizeof *ascent->speeds);
    memset(ascent->squares, 0, corners * sizeof *ascent->squares);
    ascent->contactAge = 0;
}

static void BeginLeg(pvtAscent* ascent, const Leg* leg)
{
    ascent->softness = leg->softness;
    ascent->reach = leg->reach * (float)pvtGetLongestSide(ascent->frame.size) / 256.0F;
}

static int GetSteps(const pvtAscent* ascent, const Leg* leg)
{
    const int steps = (int)(leg->share * ascent->iterations);
    return steps > 1 ? steps : 1;
}

// False when it is to end.
static bool GoOn(pvtContext* context, const pvtAscent* ascent)
{
    const double share = (double)ascent->steps / ascent->allSteps;
    pvtReportProgress(context, share < 1.0 ? share : 1.0);
    return !pvtEnough_Ends(context, &ascent->options->enough, "refinement", "steps", share) &&
           !pvtIsCancelled(context);
}

// How many triangles there are to be at a time of a leg, 0 to 1.
static int GetCount(const pvtAscent* ascent, const Leg* leg, int start, double time)
{
    const int budget = ascent->options->budget;
    const double part = (leg->pruneEnd - time) / (leg->pruneEnd - leg->pruneBegin);
    const double left = !(part > 0.0) ? 0.0 : part < 1.0 ? part : 1.0;
    return start <= budget ? start : budget + (int)((start - budget) * left * left);
}

static bool RunLeg(pvtContext* context, pvtAscent* ascent, const Leg* leg)
{
    const int steps = GetSteps(ascent, leg);
    const int round = steps / PRUNE_ROUNDS > 1 ? steps / PRUNE_ROUNDS : 1;
    const int start = ascent->set.triangleCount;
    for (int i = 0; i < steps; ++i, ++ascent->steps) {
        if (i % round == 0) {
            pvtAscent_Prune(context, ascent, GetCount(ascent, leg, start, (double)i / steps));
        }
        pvtAscent_Step(context, ascent, false);
        ascent->softness *= 1.0F - leg->softnessFall / (float)steps;
        ascent->reach *= 1.0F - leg->reachFall / (float)steps;
        if (!GoOn(context, ascent)) {
            return false;
        }
    }
    return true;
}

// Judged when it is inside: what a climb finds in thin parts may be lost by that.
static pvtStatus KeepIfBetter(pvtContext* context, pvtAscent* ascent)
{
    pvtAscent_Prune(context, ascent, ascent->options->budget);
    const pvtStatus status = pvtAscent_Settle(context, ascent);
    const double worth = status == PVT_OK ? Judge(context, ascent) : 0.0;
    if (status == PVT_OK && worth > ascent->bestWorth) {
        ascent->bestWorth = worth;
        pvtTriangleSet_Copy(&ascent->set, &ascent->best);
    }
    return status;
}

static int CountSteps(const pvtAscent* ascent)
{
    const int starts = ascent->options->startCount;
    int steps = ascent->options->cycles * GetSteps(ascent, &cycle) +
                (starts - 1) * GetSteps(ascent, &crossing);
    for (size_t i = 0; i < LEGS; ++i) {
        steps += starts * GetSteps(ascent, &climb[i]);
    }
    return steps;
}

// Where the first start is between walls, climbs are longer; where there are fewer sights, shorter.
static void PlanSteps(pvtAscent* ascent)
{
    ascent->isShell = pvtAscent_IsBetweenWalls(ascent);
    const double share = ascent->sights.share * (ascent->isShell ? SHELL_SHARE : 1.0);
    ascent->iterations = (int)(share * ascent->options->iterations);
    ascent->allSteps = CountSteps(ascent);
}

static pvtStatus RunClimb(pvtContext* context, pvtAscent* ascent, int start, bool* goesOn)
{
    ascent->next = ascent->sights.count * (size_t)start / (size_t)ascent->options->startCount;
    const pvtStatus status = pvtAscent_TakeStart(context, ascent, start);
    if (status != PVT_OK) {
        return status;
    }
    TakeRest(ascent);
    for (size_t i = 0; i < LEGS && *goesOn; ++i) {
        BeginLeg(ascent, &climb[i]);
        *goesOn = RunLeg(context, ascent, &climb[i]);
    }
    return KeepIfBetter(context, ascent);
}

// With what the last climb ended at.
static pvtStatus RunCrossing(pvtContext* context, pvtAscent* ascent, bool* goesOn)
{
    pvtTriangleSet_Append(&ascent->set, &ascent->rival);
    pvtTriangleSet_FindEdges(&ascent->set);
    TakeRest(ascent);
    BeginLeg(ascent, &crossing);
    *goesOn = RunLeg(context, ascent, &crossing);
    return KeepIfBetter(context, ascent);
}

// From a mesh, such as the model itself. Pushed inside it is crooked, and goes back as far as it
// can; there it is anchored when it settles once more.
static pvtStatus TryMesh(pvtContext* context, const pvtMesh* mesh, pvtAscent* ascent)
{
    const pvtTriangleSet* set = &ascent->set;
    bool isTaken = false;
    pvtStatus status = pvtAscent_TakeMesh(context, mesh, ascent, &isTaken);
    if (status != PVT_OK || !isTaken) {
        return status;
    }
    TakeRest(ascent);
    float(*goals)[3] = pvtAllocate(context, (size_t)set->cornerCount, sizeof *goals);
    if (goals == NULL) {
        return pvtContext_GetStatus(context);
    }
    memcpy(goals, set->corners, (size_t)set->cornerCount * sizeof *goals);
    status = pvtAscent_Settle(context, ascent);
    if (status == PVT_OK) {
        status = pvtAscent_Return(context, ascent, (const float(*)[3])goals);
    }
    pvtRelease(context, goals);
    return status == PVT_OK ? KeepIfBetter(context, ascent) : status;
}

static pvtStatus RunCycle(pvtContext* context, pvtAscent* ascent, bool* goesOn)
{
    const int growth = (int)(GROWTH * ascent->options->budget);
    pvtTriangleSet_Copy(&ascent->best, &ascent->set);
    TakeRest(ascent);
    BeginLeg(ascent, &cycle);
    pvtAscent_Step(context, ascent, true);
    pvtAscent_Grow(ascent, growth > 1 ? growth : 1);
    *goesOn = RunLeg(context, ascent, &cycle);
    return KeepIfBetter(context, ascent);
}

pvtStatus pvtAscent_Climb(pvtContext* context, pvtAscent* ascent)
{
    bool goesOn = true;
    ascent->bestWorth = -HUGE_VAL;
    ascent->wrongCost = ascent->options->mostWrong > 0.0 ? FIRST_COST : 0.0F;
    PlanSteps(ascent);
    pvtStatus status = TryMesh(context, ascent->options->mesh, ascent);
    if (status == PVT_OK) {
        status = TryMesh(context, ascent->options->flat, ascent);
    }
    for (int i = 0; i < ascent->options->startCount && goesOn && status == PVT_OK; ++i) {
        pvtTriangleSet_Copy(&ascent->best, &ascent->rival);
        status = RunClimb(context, ascent, i, &goesOn);
        if (i > 0 && goesOn && status == PVT_OK) {
            status = RunCrossing(context, ascent, &goesOn);
        }
    }
    for (int i = 0; i < ascent->options->cycles && goesOn && status == PVT_OK; ++i) {
        status = RunCycle(context, ascent, &goesOn);
    }
    pvtTriangleSet_Copy(&ascent->best, &ascent->set);
    TakeRest(ascent);
    return status == PVT_OK && pvtIsCancelled(context) ? pvtFailCancelled(context) : status;
}
