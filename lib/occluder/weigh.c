// SPDX-License-Identifier: MIT
// What would be lost with each triangle: the pixels that it covers alone, and what they are worth.
#include "pull.h"

#include "base/bits.h"
#include "base/context.h"
#include "sight_mask.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { SIZE = PVT_SIGHT_SIZE, HALVES = PVT_SIGHT_WORDS };

enum { LEAST_CHOICE = 8 }; // triangles that are weighed at least

static size_t GetIndex(const pvtPuller* puller, size_t b, int triangle)
{
    return b * (size_t)puller->set->triangleCapacity + (size_t)triangle;
}

// Pixels of the goal that a triangle covers and no other.
static int FindSingles(const pvtPuller* puller, size_t b, int triangle, pvtSightMask* singles)
{
    const pvtSightMask* mask = &puller->masks[GetIndex(puller, b, triangle)];
    const pvtSightMask* twice = &puller->layers[b][1];
    const pvtSightMask* goal = &pvtPuller_GetSight(puller, b)->goal;
    int count = 0;
    for (int half = 0; half < HALVES; ++half) {
        for (int y = 0; y < SIZE; ++y) {
            const uint64_t here =
                mask->words[half][y] & ~twice->words[half][y] & goal->words[half][y];
            singles->words[half][y] = here;
            count += here != 0 ? pvtCountBits(here) : 0;
        }
    }
    return count;
}

static void AddLayer(pvtSightMask layers[3], const pvtSightMask* mask)
{
    for (int half = 0; half < HALVES; ++half) {
        uint64_t* once = layers[0].words[half];
        uint64_t* twice = layers[1].words[half];
        uint64_t* thrice = layers[2].words[half];
        const uint64_t* added = mask->words[half];
        for (int y = 0; y < SIZE; ++y) {
            thrice[y] |= twice[y] & added[y];
            twice[y] |= once[y] & added[y];
            once[y] |= added[y];
        }
    }
}

static void DrawMasks(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    pvtPuller* puller = taskData;
    const pvtTriangleSet* set = puller->set;
    float places[PVT_MOST_SIGHT_CORNERS][2];
    for (size_t b = begin; b < end; ++b) {
        pvtProjectCorners(pvtPuller_GetSight(puller, b), set, places);
        memset(puller->layers[b], 0, sizeof puller->layers[b]);
        for (int t = 0; t < set->triangleCount; ++t) {
            pvtSightMask* mask = &puller->masks[GetIndex(puller, b, t)];
            memset(mask, 0, sizeof *mask);
            pvtDrawSightTriangle(set, places, t, puller->options.inset, mask);
            AddLayer(puller->layers[b], mask);
        }
        for (int t = 0; t < set->triangleCount; ++t) {
            pvtSightMask singles;
            puller->singles[GetIndex(puller, b, t)] = (uint32_t)FindSingles(puller, b, t, &singles);
        }
    }
}

static void AddMissing(const pvtSightMask* missing, pvtSightMask* lacking)
{
    for (int half = 0; half < HALVES; ++half) {
        for (int y = 0; y < SIZE; ++y) {
            lacking->words[half][y] |= missing->words[half][y];
        }
    }
}

static void WeighSights(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    pvtPuller* puller = taskData;
    const float softness = puller->options.softness;
    for (size_t b = begin; b < end; ++b) {
        const pvtSight* sight = pvtPuller_GetSight(puller, b);
        pvtSightMask missing, lacking;
        pvtFindMissing(&sight->goal, &puller->layers[b][0], &missing);
        const double worth = pvtSumWorths(puller->sights, sight, &missing, softness);
        for (int t = 0; t < puller->set->triangleCount; ++t) {
            float* loss = &puller->losses[GetIndex(puller, b, t)];
            *loss = 0.0F;
            if (puller->isWeighed[t] && FindSingles(puller, b, t, &lacking) > 0) {
                AddMissing(&missing, &lacking);
                *loss = (float)(worth - pvtSumWorths(puller->sights, sight, &lacking, softness)) *
                        sight->weight;
            }
        }
    }
}

// Those that cover the least alone: one by one the least of what is left.
static void ChooseTriangles(pvtPuller* puller)
{
    const int count = puller->set->triangleCount;
    const int wanted = count / 4 > LEAST_CHOICE ? count / 4 : LEAST_CHOICE;
    for (int t = 0; t < count; ++t) {
        double sum = 0.0;
        for (size_t b = 0; b < (size_t)puller->options.count; ++b) {
            sum += (double)pvtPuller_GetSight(puller, b)->weight *
                   puller->singles[GetIndex(puller, b, t)];
        }
        puller->triangles[t] = sum;
        puller->isWeighed[t] = false;
    }
    for (int i = 0; i < wanted && i < count; ++i) {
        int least = -1;
        for (int t = 0; t < count; ++t) {
            if (!puller->isWeighed[t] &&
                (least < 0 || puller->triangles[t] < puller->triangles[least])) {
                least = t;
            }
        }
        puller->isWeighed[least] = true;
    }
}

void pvtWeighTriangles(pvtContext* context, const pvtPullOptions* options, pvtPuller* puller)
{
    assert(options->count >= 1 && options->count <= PVT_MOST_WEIGHED && options->softness > 0.0F);
    puller->options = *options;
    pvtParallelFor(context, DrawMasks, (size_t)options->count, 1, puller);
    ChooseTriangles(puller);
    pvtParallelFor(context, WeighSights, (size_t)options->count, 1, puller);
    for (int t = 0; t < puller->set->triangleCount; ++t) {
        double sum = 0.0;
        for (size_t b = 0; b < (size_t)options->count; ++b) {
            sum += (double)puller->losses[GetIndex(puller, b, t)];
        }
        puller->triangles[t] = puller->isWeighed[t] ? sum : HUGE_VAL;
    }
}

static bool CoverTogether(const pvtSightMask* a, const pvtSightMask* b, const pvtSightMask* thrice)
{
    uint64_t both = 0;
    for (int half = 0; half < HALVES; ++half) {
        for (int y = 0; y < SIZE; ++y) {
            both |= a->words[half][y] & b->words[half][y] & ~thrice->words[half][y];
        }
    }
    return both != 0;
}

bool pvtArePartners(const pvtPuller* puller, int a, int b)
{
    for (size_t s = 0; s < (size_t)puller->options.count; ++s) {
        if (CoverTogether(&puller->masks[GetIndex(puller, s, a)],
                          &puller->masks[GetIndex(puller, s, b)], &puller->layers[s][2])) {
            return true;
        }
    }
    return false;
}
