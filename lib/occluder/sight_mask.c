// SPDX-License-Identifier: MIT
#include "sight_mask.h"

#include "base/vectors.h"

#include <math.h>
#include <string.h>

enum { SIZE = PVT_SIGHT_SIZE, CELLS = PVT_SIGHT_CELLS, LANES = 8 };

void pvtProjectCorners(const pvtSight* sight, const pvtTriangleSet* set, float (*places)[2])
{
    for (int c = 0; c < set->cornerCount; ++c) {
        const float* p = set->corners[c];
        places[c][0] =
            p[0] * sight->right[0] + p[1] * sight->right[1] + p[2] * sight->right[2] + sight->x;
        places[c][1] = p[0] * sight->up[0] + p[1] * sight->up[1] + p[2] * sight->up[2] + sight->y;
    }
}

// What a triangle covers of each row: from the greatest of two lines to the least of two others.
typedef struct Spans {
    float low[2][2], high[2][2]; // x = line[0] + line[1] × y
    int first, end;              // rows
    float least, most;           // that any row has: constants would end in branches, not vectors
    uint64_t one;                // 1
} Spans;

static void AddLine(float lines[2][2], int* count, float base, float slope)
{
    for (int i = *count; i < 2; ++i) {
        lines[i][0] = base;
        lines[i][1] = slope;
    }
    ++*count;
}

// False when nothing is covered.
static bool MakeSpans(const float* const p[3], const float insets[3], Spans* spans)
{
    const int side = pvtGetSide2(p[0], p[1], p[2]);
    float least = p[0][1] < p[1][1] ? p[0][1] : p[1][1];
    float most = p[0][1] < p[1][1] ? p[1][1] : p[0][1];
    least = p[2][1] < least ? p[2][1] : least;
    most = p[2][1] > most ? p[2][1] : most;
    if (side == 0 || most < 0.5F || least > SIZE) {
        return false;
    }
    int lows = 0, highs = 0;
    for (int k = 0; k < 3; ++k) {
        const float* a = p[k];
        const float* b = p[(k + 1) % 3];
        const float dx = b[0] - a[0], dy = b[1] - a[1];
        if (dy == 0.0F) {
            continue;
        }
        const float slope = dx / dy;
        // An inset moves the line along x by its length over its height.
        const float inset = insets[k] > 0.0F ? insets[k] * sqrtf(1.0F + slope * slope) : 0.0F;
        const float base = a[0] - slope * a[1];
        if ((dy < 0.0F) == (side > 0)) {
            AddLine(spans->low, &lows, base + inset, slope);
        } else {
            AddLine(spans->high, &highs, base - inset, slope);
        }
    }
    if (lows == 0 || highs == 0) {
        return false;
    }
    spans->least = 0.0F;
    spans->one = 1;
    spans->most = SIZE;
    spans->first = least < 0.5F ? 0 : (int)(least + 0.5F);
    spans->end = most >= SIZE ? SIZE : (int)(most + 0.5F);
    return spans->first < spans->end;
}

// Rows in groups of LANES, the first of which may begin before the first row.
static int GetFirstLane(const Spans* spans)
{
    return spans->first / LANES * LANES;
}

// In each row the bits below its end, clamped to the 64 from `from` on, without those below its
// begin. `count` is a multiple of LANES. `one` is 1, and not known here: compilers take no
// constants to be vectors that are shifted by others.
PVT_VECTOR_CLONES
static void SetSpans(const int32_t* restrict begins, const int32_t* restrict ends, int count,
                     int32_t from, uint64_t one, uint64_t* restrict words)
{
    for (int i = 0; i < (count & -LANES); ++i) {
        int32_t low = begins[i] - from, high = ends[i] - from;
        low = low > 0 ? low : 0;
        high = high > 0 ? high : 0;
        const uint64_t begin = (uint64_t)(low < 64 ? low : 64);
        const uint64_t end = (uint64_t)(high < 64 ? high : 64);
        // A shift by 64 would not be defined: then the second part sets all.
        const uint64_t below = ((one << (end & 63)) - one) | (UINT64_C(0) - (end >> 6));
        const uint64_t before = ((one << (begin & 63)) - one) | (UINT64_C(0) - (begin >> 6));
        words[i] |= below & ~before;
    }
}

// Pixels whose centres are covered: from the first to before the second of each row. In rows of the
// groups that are not the triangle's, none.
PVT_VECTOR_CLONES
static void FindSpans(const Spans* spans, int32_t* restrict begins, int32_t* restrict ends)
{
    const float least = spans->least, most = spans->most;
    for (int row = GetFirstLane(spans); row < spans->end; row += LANES) {
        for (int i = row; i < row + LANES; ++i) {
            const float y = (float)i + 0.5F;
            const float a = spans->low[0][0] + spans->low[0][1] * y;
            const float b = spans->low[1][0] + spans->low[1][1] * y;
            const float c = spans->high[0][0] + spans->high[0][1] * y;
            const float d = spans->high[1][0] + spans->high[1][1] * y;
            float low = a > b ? a : b, high = c < d ? c : d;
            low = low > least ? low : least;
            low = low < most ? low : most;
            high = high < most ? high : most;
            high = high > low ? high : low;
            begins[i] = (int32_t)(low + 0.5F);
            const int32_t end = (int32_t)(high + 0.5F);
            ends[i] = i >= spans->first && i < spans->end ? end : 0;
        }
    }
}

pvtSightRows pvtDrawSightTriangle(const pvtTriangleSet* set, float (*places)[2], int triangle,
                                  float inset, pvtSightMask* mask)
{
    const uint32_t* corners = set->triangles[triangle];
    const float* const p[3] = {places[corners[0]], places[corners[1]], places[corners[2]]};
    float insets[3] = {0};
    for (int k = 0; k < 3; ++k) {
        insets[k] = set->isOpen[triangle][k] ? inset : 0.0F;
    }
    Spans spans;
    if (!MakeSpans(p, insets, &spans)) {
        return (pvtSightRows){0, 0};
    }
    int32_t begins[SIZE], ends[SIZE];
    FindSpans(&spans, begins, ends);
    const int first = GetFirstLane(&spans);
    const int count = (spans.end - first + LANES - 1) / LANES * LANES;
    const float left = fminf(p[0][0], fminf(p[1][0], p[2][0]));
    const float right = fmaxf(p[0][0], fmaxf(p[1][0], p[2][0]));
    for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
        const int32_t from = 64 * half;
        if (left < (float)(from + 64) && right > (float)from) {
            SetSpans(begins + first, ends + first, count, from, spans.one,
                     mask->words[half] + first);
        }
    }
    return (pvtSightRows){(uint8_t)spans.first, (uint8_t)spans.end};
}

// How many of each pair of bits are set: eight numbers of 0 to 2, lowest first.
static uint64_t CountPairs(uint64_t bits)
{
    uint64_t pairs = bits - (bits >> 1 & 0x5555);
    pairs = (pairs | pairs << 24) & UINT64_C(0x000000FF000000FF);
    pairs = (pairs | pairs << 12) & UINT64_C(0x000F000F000F000F);
    return (pairs | pairs << 6) & UINT64_C(0x0303030303030303);
}

// Two rows of 32 cells; `sum` is that of the cells before them. All of a row are less than 256,
// since the goal keeps a margin.
static uint64_t SumCells(uint64_t first, uint64_t second, uint64_t sum, uint8_t counts[32])
{
    for (int part = 0; part < 4; ++part) {
        // Bytes times ones: each becomes the sum of those up to it.
        const uint64_t cells =
            CountPairs(first >> (16 * part) & 0xFFFF) + CountPairs(second >> (16 * part) & 0xFFFF);
        const uint64_t here = (cells + sum) * UINT64_C(0x0101010101010101);
        for (int i = 0; i < 8; ++i) {
            counts[8 * part + i] = (uint8_t)(here >> (8 * i));
        }
        sum = here >> 56;
    }
    return sum;
}

PVT_VECTOR_CLONES
void pvtSumMissing(const pvtSightMask* missing, uint16_t (*restrict sums)[PVT_SIGHT_STRIDE])
{
    memset(sums[0], 0, sizeof sums[0]);
    for (int y = 0; y < CELLS; ++y) {
        const uint64_t* left = missing->words[0] + 2 * (size_t)y;
        const uint64_t* right = missing->words[1] + 2 * (size_t)y;
        if ((left[0] | left[1] | right[0] | right[1]) == 0) {
            memcpy(sums[y + 1], sums[y], sizeof sums[0]);
            continue;
        }
        uint8_t counts[CELLS];
        const uint64_t sum = SumCells(left[0], left[1], 0, counts);
        SumCells(right[0], right[1], sum, counts + 32);
        sums[y + 1][0] = 0;
        for (int x = 0; x < CELLS; ++x) {
            sums[y + 1][x + 1] = (uint16_t)(sums[y][x + 1] + counts[x]);
        }
    }
}

PVT_VECTOR_CLONES
void pvtSumOpen(const pvtSightMask* mask, uint16_t (*restrict sums)[PVT_SIGHT_STRIDE])
{
    memset(sums[0], 0, sizeof sums[0]);
    for (int y = 0; y < CELLS; ++y) {
        uint16_t sum = 0;
        sums[y + 1][0] = 0;
        for (int x = 0; x < CELLS; x += 8) {
            const uint64_t* rows = mask->words[x / 32] + 2 * (size_t)y;
            const int shift = 2 * x % 64;
            const uint64_t counts =
                CountPairs(~rows[0] >> shift & 0xFFFF) + CountPairs(~rows[1] >> shift & 0xFFFF);
            for (int i = 0; i < 8; ++i) {
                sum = (uint16_t)(sum + (counts >> (8 * i) & 0xFF));
                sums[y + 1][x + i + 1] = (uint16_t)(sums[y][x + i + 1] + sum);
            }
        }
    }
}

double pvtSumWorths(const pvtSightSet* sights, const pvtSight* sight, const pvtSightMask* missing,
                    float softness)
{
    uint16_t sums[PVT_SIGHT_ENDS][PVT_SIGHT_STRIDE];
    pvtSumMissing(missing, sums);
    double worth = 0.0;
    const pvtSightQuad* quads = sights->quads + sight->firstQuad;
    for (size_t q = 0; q < sight->quadCount; ++q) {
        worth += (double)pvtGetWorth(pvtCountMissing(sums, &quads[q]), softness);
    }
    return worth;
}
