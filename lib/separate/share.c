// SPDX-License-Identifier: MIT
// A budget shared by several meshes. What t triangles hide of what is possible is not known before
// it is tried; t ÷ (t + HALF) has the shape that occluders of many models show: half with HALF
// triangles, and less and less from each that is added. Giving each next triangle to the claim
// where it hides most then has a closed form, by Lagrange's multiplier λ, the gain of a drawn
// triangle at which everybody stops: HALF × possible ÷ (t + HALF)² = λ.
#include <paravent/separate.h>

#include "base/context.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

enum { LEAST = 2, HALF = 8, ROUNDS = 64 };

typedef struct Ranked {
    double possible;
    size_t claim;
} Ranked;

typedef struct Sharing {
    const pvtClaim* claims;
    const Ranked* order; // falling claims
    size_t count;
    int budget;
    size_t left; // triangles, as drawn
    int* shares;
} Sharing;

static int CompareRanked(const void* left, const void* right)
{
    const Ranked* a = left;
    const Ranked* b = right;
    if (a->possible != b->possible) {
        return a->possible > b->possible ? -1 : 1;
    }
    return a->claim < b->claim ? -1 : a->claim > b->claim ? 1 : 0;
}

static bool Give(Sharing* sharing, size_t claim, int triangles)
{
    const size_t instances = sharing->claims[claim].instanceCount;
    if (instances > sharing->left / (size_t)triangles) {
        return false;
    }
    sharing->left -= instances * (size_t)triangles;
    sharing->shares[claim] += triangles;
    return true;
}

// From the largest claim down; one triangle is better than none for those at the end.
static void GiveLeast(Sharing* sharing)
{
    for (int triangles = LEAST; triangles > 0; --triangles) {
        for (size_t i = 0; i < sharing->count; ++i) {
            const Ranked* next = &sharing->order[i];
            if (next->possible > 0.0 && sharing->shares[next->claim] == 0) {
                Give(sharing, next->claim, triangles);
            }
        }
    }
}

// What a claim has more than the least when everybody stops at λ.
static int GetMore(const Sharing* sharing, size_t claim, double lambda)
{
    const double possible = sharing->claims[claim].possible;
    const double triangles = floor(sqrt(HALF * possible / lambda) - HALF);
    const double most = sharing->budget;
    return sharing->shares[claim] < LEAST || !(triangles > LEAST) ? 0
           : triangles > most                                     ? sharing->budget - LEAST
                                                                  : (int)triangles - LEAST;
}

static bool Fits(const Sharing* sharing, double lambda)
{
    double sum = 0.0;
    for (size_t i = 0; i < sharing->count; ++i) {
        sum += (double)GetMore(sharing, i, lambda) * (double)sharing->claims[i].instanceCount;
    }
    return sum <= (double)sharing->left;
}

// The smallest λ that fits, between that at which the largest claim gets nothing more and that at
// which the smallest gets everything.
static double FindLambda(const Sharing* sharing)
{
    double smallest = sharing->order[0].possible;
    for (size_t i = 0; i < sharing->count; ++i) {
        const double possible = sharing->order[i].possible;
        smallest = possible > 0.0 ? possible : smallest;
    }
    const double most = (double)sharing->budget + HALF + 1.0;
    double high = sharing->order[0].possible / HALF;
    double low = HALF * smallest / (most * most);
    for (int round = 0; round < ROUNDS && low < high; ++round) {
        const double middle = sqrt(low) * sqrt(high);
        if (Fits(sharing, middle)) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

static void GiveRest(Sharing* sharing)
{
    const double lambda = FindLambda(sharing);
    for (size_t i = 0; i < sharing->count; ++i) {
        const int more = GetMore(sharing, i, lambda);
        if (more > 0) {
            Give(sharing, i, more);
        }
    }
    // Rounding down, and claims that are equal, leave a few.
    for (bool isGiven = true; isGiven;) {
        isGiven = false;
        for (size_t i = 0; i < sharing->count; ++i) {
            const size_t claim = sharing->order[i].claim;
            isGiven = (sharing->shares[claim] >= LEAST && Give(sharing, claim, 1)) || isGiven;
        }
    }
}

pvtStatus pvtShareBudget(pvtContext* context, const pvtClaim* claims, size_t count, int budget,
                         int* shares)
{
    assert(budget > 0);
    Ranked* order = pvtAllocate(context, count, sizeof *order);
    if (order == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t i = 0; i < count; ++i) {
        assert(claims[i].instanceCount > 0);
        order[i] = (Ranked){claims[i].possible, i};
        shares[i] = 0;
    }
    if (count > 0) {
        qsort(order, count, sizeof *order, CompareRanked);
    }
    Sharing sharing = {claims, order, count, budget, (size_t)budget, shares};
    if (count > 0 && order[0].possible > 0.0) {
        GiveLeast(&sharing);
        GiveRest(&sharing);
    }
    pvtRelease(context, order);
    return PVT_OK;
}
