// SPDX-License-Identifier: MIT
// What would be lost with each triangle: the pixels that it covers alone, and what they are worth.
#include "pull.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vectors.h"
#include "sight_mask.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { HALVES = PVT_SIGHT_WORDS };

enum { LEAST_CHOICE = 8 }; // triangles that are weighed at least

static size_t GetIndex(const pvtPuller* puller, size_t b, int triangle)
{
    return b * (size_t)puller->set->triangleCapacity + (size_t)triangle;
}

// Pixels of a row of the goal that a triangle covers and no other.
static inline uint64_t GetSingles(const pvtSightMask* mask, const pvtSightMask* twice,
                                  const pvtSightMask* goal, int half, int y)
{
    return mask->words[half][y] & ~twice->words[half][y] & goal->words[half][y];
}

PVT_VECTOR_CLONES
static int CountSingles(const pvtSightMask* mask, const pvtSightMask* twice,
                        const pvtSightMask* goal, pvtSightRows rows)
{
    int count = 0;
    for (int half = 0; half < HALVES; ++half) {
        for (int y = rows.first; y < rows.end; ++y) {
            count += pvtCountBits(GetSingles(mask, twice, goal, half, y));
        }
    }
    return count;
}

static void AddSingles(const pvtSightMask* mask, const pvtSightMask* twice,
                       const pvtSightMask* goal, pvtSightRows rows, pvtSightMask* restrict singles)
{
    for (int half = 0; half < HALVES; ++half) {
        for (int y = rows.first; y < rows.end; ++y) {
            singles->words[half][y] |= GetSingles(mask, twice, goal, half, y);
        }
    }
}

PVT_VECTOR_CLONES
static void AddLayer(const pvtSightMask* restrict mask, pvtSightRows rows,
                     pvtSightMask layers[restrict 3])
{
    for (int half = 0; half < HALVES; ++half) {
        uint64_t* once = layers[0].words[half];
        uint64_t* twice = layers[1].words[half];
        uint64_t* thrice = layers[2].words[half];
        const uint64_t* added = mask->words[half];
        for (int y = rows.first; y < rows.end; ++y) {
            thrice[y] |= twice[y] & added[y];
            twice[y] |= once[y] & added[y];
            once[y] |= added[y];
        }
    }
}

// Of what was drawn the last time: the others are clear.
static void ClearRows(pvtSightMask* mask, pvtSightRows rows)
{
    for (int half = 0; half < PVT_SIGHT_WORDS && rows.first < rows.end; ++half) {
        memset(mask->words[half] + rows.first, 0,
               (size_t)(rows.end - rows.first) * sizeof mask->words[half][0]);
    }
}

static void DrawMasks(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    pvtPuller* puller = taskData;
    const pvtTriangleSet* set = puller->set;
    float places[PVT_MOST_SIGHT_CORNERS][2];
    for (size_t b = begin; b < end; ++b) {
        const pvtSight* sight = pvtPuller_GetSight(puller, b);
        pvtSightMask* masks = &puller->masks[GetIndex(puller, b, 0)];
        pvtSightRows* rows = &puller->rows[GetIndex(puller, b, 0)];
        pvtSightMask* layers = puller->layers[b];
        pvtProjectCorners(sight, set, places);
        memset(layers, 0, sizeof puller->layers[b]);
        for (int t = 0; t < set->triangleCount; ++t) {
            ClearRows(&masks[t], rows[t]);
            rows[t] = pvtDrawSightTriangle(set, places, t, puller->options.inset, &masks[t]);
            AddLayer(&masks[t], rows[t], layers);
        }
        for (int t = 0; t < set->triangleCount; ++t) {
            puller->singles[GetIndex(puller, b, t)] =
                (uint32_t)CountSingles(&masks[t], &layers[1], &sight->goal, rows[t]);
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
        const pvtSightMask* layers = puller->layers[b];
        pvtSightMask missing;
        pvtFindMissing(&sight->goal, &layers[0], &missing);
        const double worth = pvtSumWorths(puller->sights, sight, &missing, softness);
        for (int t = 0; t < puller->set->triangleCount; ++t) {
            const size_t index = GetIndex(puller, b, t);
            puller->losses[index] = 0.0F;
            if (puller->isWeighed[t] && puller->singles[index] > 0) {
                pvtSightMask lacking = missing;
                AddSingles(&puller->masks[index], &layers[1], &sight->goal, puller->rows[index],
                           &lacking);
                const double left = pvtSumWorths(puller->sights, sight, &lacking, softness);
                puller->losses[index] = (float)(worth - left) * sight->weight;
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

static bool CoverTogether(const pvtSightMask* a, const pvtSightMask* b, const pvtSightMask* thrice,
                          pvtSightRows rows)
{
    uint64_t both = 0;
    for (int half = 0; half < HALVES; ++half) {
        for (int y = rows.first; y < rows.end; ++y) {
            both |= a->words[half][y] & b->words[half][y] & ~thrice->words[half][y];
        }
    }
    return both != 0;
}

bool pvtArePartners(const pvtPuller* puller, int a, int b)
{
    for (size_t s = 0; s < (size_t)puller->options.count; ++s) {
        const size_t i = GetIndex(puller, s, a), j = GetIndex(puller, s, b);
        if (CoverTogether(&puller->masks[i], &puller->masks[j], &puller->layers[s][2],
                          puller->rows[i])) {
            return true;
        }
    }
    return false;
}
