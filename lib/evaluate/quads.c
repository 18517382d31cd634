// SPDX-License-Identifier: MIT
// Quads by summed-area tables: Franklin C. Crow, "Summed-Area Tables for Texture Mapping"
// (SIGGRAPH 1984). The table counts covered pixels, so that a quad of any size costs four look-ups.
// The classes are those of the paper, section 6.1.
#include "quads.h"

#include "base/bits.h"
#include "base/context.h"

#include <math.h>

enum { SMALL_PART = 8 };

static pvtStatus ReserveTable(pvtContext* context, pvtCoverTable* table, int width, int height)
{
    const size_t count = ((size_t)width + 1) * ((size_t)height + 1);
    if (count > table->capacity) {
        pvtCoverTable_Free(context, table);
        table->sums = pvtAllocate(context, count, sizeof *table->sums);
        if (table->sums == NULL) {
            return pvtContext_GetStatus(context);
        }
        table->capacity = count;
    }
    table->width = width;
    table->height = height;
    return PVT_OK;
}

// Adds a row of bits, summed from the left, to the row of sums below it.
static void SumRow(const uint64_t* bits, int width, const uint32_t* below, uint32_t* sums)
{
    uint32_t sum = 0;
    sums[0] = 0;
    for (int x = 0; x < width; x += 64) {
        const uint64_t word = bits[x >> 6];
        const int end = width - x < 64 ? width : x + 64;
        if (word == 0) {
            for (int i = x; i < end; ++i) {
                sums[i + 1] = below[i + 1] + sum;
            }
            continue;
        }
        for (int i = x; i < end; ++i) {
            sum += (uint32_t)(word >> (i & 63)) & 1;
            sums[i + 1] = below[i + 1] + sum;
        }
    }
}

pvtStatus pvtCoverTable_Build(pvtContext* context, pvtCoverTable* table, const pvtRaster* raster,
                              const pvtQuad* part)
{
    const int width = part->x1 - part->x0 + 1, height = part->y1 - part->y0 + 1;
    const pvtStatus status = ReserveTable(context, table, width, height);
    if (status != PVT_OK) {
        return status;
    }
    const size_t stride = (size_t)width + 1;
    for (size_t x = 0; x < stride; ++x) {
        table->sums[x] = 0;
    }
    for (int y = 0; y < height; ++y) {
        const size_t row = (size_t)(part->y0 + y) * raster->wordsPerRow;
        uint32_t* sums = table->sums + (size_t)(y + 1) * stride;
        SumRow(raster->words + row + (part->x0 >> 6), width, sums - stride, sums);
    }
    return PVT_OK;
}

void pvtCoverTable_Free(pvtContext* context, pvtCoverTable* table)
{
    pvtRelease(context, table->sums);
    *table = (pvtCoverTable){0};
}

uint32_t pvtCoverTable_Count(const pvtCoverTable* table, const pvtQuad* quad)
{
    const size_t stride = (size_t)table->width + 1;
    const uint32_t* below = table->sums + (size_t)quad->y0 * stride;
    const uint32_t* above = table->sums + ((size_t)quad->y1 + 1) * stride;
    return above[quad->x1 + 1] - above[quad->x0] - below[quad->x1 + 1] + below[quad->x0];
}

static void Sort(int* a, int* b)
{
    const int first = *a < *b ? *a : *b;
    *b = *a < *b ? *b : *a;
    *a = first;
}

// A side of a small quad: its length first, then its place.
static void DrawSmallSide(pvtRandom* random, int size, int* begin, int* last)
{
    const int most = size / SMALL_PART > 1 ? size / SMALL_PART : 1;
    const int length = 1 + (int)pvtRandom_Below(random, (uint32_t)most);
    *begin = (int)pvtRandom_Below(random, (uint32_t)(size - length + 1));
    *last = *begin + length - 1;
}

pvtQuad pvtDrawQuad(pvtRandom* random, pvtQuadFamily family, int width, int height)
{
    pvtQuad quad;
    if (family == PVT_QUADS_SMALL) {
        DrawSmallSide(random, width, &quad.x0, &quad.x1);
        DrawSmallSide(random, height, &quad.y0, &quad.y1);
        return quad;
    }
    quad.x0 = (int)pvtRandom_Below(random, (uint32_t)width);
    quad.y0 = (int)pvtRandom_Below(random, (uint32_t)height);
    quad.x1 = (int)pvtRandom_Below(random, (uint32_t)width);
    quad.y1 = (int)pvtRandom_Below(random, (uint32_t)height);
    Sort(&quad.x0, &quad.x1);
    Sort(&quad.y0, &quad.y1);
    return quad;
}

void pvtTallyQuad(const pvtCoverTable* original, const pvtCoverTable* occluder, const pvtQuad* quad,
                  pvtQuadTally* tally)
{
    const uint32_t pixels =
        (uint32_t)(quad->x1 - quad->x0 + 1) * (uint32_t)(quad->y1 - quad->y0 + 1);
    const uint32_t covered = pvtCoverTable_Count(original, quad);
    const bool hidden = pvtCoverTable_Count(occluder, quad) == pixels;
    if (covered == pixels) {
        const double square = (double)pixels * (double)pixels;
        tally->hidden += hidden ? pixels : 0;
        tally->hidden2 += hidden ? square : 0.0;
        tally->lost += hidden ? 0 : pixels;
        tally->lost2 += hidden ? 0.0 : square;
    } else if (hidden) {
        const uint32_t wrong = pixels - covered;
        tally->wrong += wrong;
        tally->wrong2 += (double)wrong * (double)wrong;
    }
}

pvtQuadTally pvtAddTallies(const pvtQuadTally* a, const pvtQuadTally* b)
{
    return (pvtQuadTally){a->hidden + b->hidden,   a->lost + b->lost,   a->wrong + b->wrong,
                          a->hidden2 + b->hidden2, a->lost2 + b->lost2, a->wrong2 + b->wrong2};
}

// A ratio of sums, hit / (hit + missed), over independent quads, and its standard error to first
// order: the spread of hit − ratio × (hit + missed) over the quads.
static double GetRatio(uint64_t hit, uint64_t missed, double squares[2], double* error)
{
    const double all = (double)hit + (double)missed;
    const double ratio = all > 0.0 ? (double)hit / all : 1.0;
    const double miss = 1.0 - ratio;
    const double spread = miss * miss * squares[0] + ratio * ratio * squares[1];
    *error = all > 0.0 ? sqrt(spread) / all : 0.0;
    return ratio;
}

pvtQuadScore pvtScoreTally(const pvtQuadTally* tally)
{
    pvtQuadScore score = {.hidden = tally->hidden, .lost = tally->lost, .wrong = tally->wrong};
    double precise[2] = {tally->hidden2, tally->wrong2};
    double recalled[2] = {tally->hidden2, tally->lost2};
    score.precision = GetRatio(tally->hidden, tally->wrong, precise, &score.precisionError);
    score.recall = GetRatio(tally->hidden, tally->lost, recalled, &score.recallError);
    return score;
}
