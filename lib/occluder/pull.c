// SPDX-License-Identifier: MIT
// The gradient of a softened recall. For each view the triangles are drawn, and the pixels that
// each of its rectangles lacks are counted in a summed-area table (Crow, Summed-Area Tables for
// Texture Mapping, 1984); what a rectangle would gain by one pixel more is added at its corners,
// and sums over both axes give what every pixel is worth. Along an edge behind which nothing is
// covered, that worth times the edge's length is what the worth grows by as the edge moves out: a
// boundary integral, as for other renderers (Li et al., Differentiable Monte Carlo Ray Tracing
// through Edge Sampling, 2018). One such pull costs as much as one evaluation, and moves all
// corners at once.
#include "pull.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vectors.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    SIZE = PVT_SIGHT_SIZE,
    ENDS = SIZE + 1,
    MASKED = SIZE + 2,
    ROWS = 8,
    LANES = 8,
    STRIDE = 72, // of the tables
    TABLE = SIZE * SIZE + 1,
    LAYERS = 3,
    LEAST_CHOICE = 8, // triangles that are weighed at least
};

// From an edge to the pixel behind it [px].
static const float BEHIND = 0.6F;

void pvtPuller_Free(pvtContext* context, pvtPuller* puller)
{
    pvtRelease(context, puller->worths);
    pvtRelease(context, puller->slopes);
    pvtRelease(context, puller->cornerPulls);
    pvtRelease(context, puller->edgePulls);
    pvtRelease(context, puller->masks);
    pvtRelease(context, puller->layers);
    pvtRelease(context, puller->singles);
    pvtRelease(context, puller->losses);
    pvtRelease(context, puller->isWeighed);
    pvtRelease(context, puller->corners);
    pvtRelease(context, puller->edges);
    pvtRelease(context, puller->triangles);
    *puller = (pvtPuller){0};
}

pvtStatus pvtCreatePuller(pvtContext* context, const pvtSightSet* sights, const pvtTriangleSet* set,
                          pvtPuller* puller)
{
    const size_t corners = (size_t)set->cornerCapacity;
    const size_t triangles = (size_t)set->triangleCapacity;
    *puller = (pvtPuller){.sights = sights, .set = set};
    puller->worths = pvtAllocate(context, TABLE, sizeof *puller->worths);
    puller->slopes = pvtAllocate(context, TABLE, sizeof *puller->slopes);
    puller->cornerPulls =
        pvtAllocate(context, PVT_MOST_BATCH * corners, sizeof *puller->cornerPulls);
    puller->edgePulls =
        pvtAllocate(context, PVT_MOST_BATCH * 3 * triangles, sizeof *puller->edgePulls);
    puller->masks = pvtAllocate(context, PVT_MOST_BATCH * triangles * SIZE, sizeof *puller->masks);
    puller->layers = pvtAllocate(context, PVT_MOST_BATCH * SIZE * LAYERS, sizeof *puller->layers);
    puller->singles = pvtAllocate(context, PVT_MOST_BATCH * triangles, sizeof *puller->singles);
    puller->isWeighed = pvtAllocate(context, triangles, sizeof *puller->isWeighed);
    puller->losses = pvtAllocate(context, PVT_MOST_BATCH * triangles, sizeof *puller->losses);
    puller->corners = pvtAllocate(context, corners, sizeof *puller->corners);
    puller->edges = pvtAllocate(context, 3 * triangles, sizeof *puller->edges);
    puller->triangles = pvtAllocate(context, triangles, sizeof *puller->triangles);
    if (puller->worths == NULL || puller->slopes == NULL || puller->cornerPulls == NULL ||
        puller->edgePulls == NULL || puller->masks == NULL || puller->losses == NULL ||
        puller->layers == NULL || puller->singles == NULL || puller->isWeighed == NULL ||
        puller->corners == NULL || puller->edges == NULL || puller->triangles == NULL) {
        pvtPuller_Free(context, puller);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

static void SetOptions(pvtPuller* puller, const pvtPullOptions* options)
{
    assert(options->count >= 1 && options->count <= PVT_MOST_BATCH && options->softness > 0.0F);
    puller->options = *options;
    if (puller->softness == options->softness) {
        return;
    }
    puller->softness = options->softness;
    for (int m = 0; m < TABLE; ++m) {
        const float worth = 1.0F / (1.0F + (float)m / options->softness);
        puller->worths[m] = worth;
        puller->slopes[m] = worth * worth / options->softness;
    }
}

static size_t GetSightIndex(const pvtPuller* puller, size_t b)
{
    return (puller->options.first + b) % puller->sights->count;
}

static void ProjectCorners(const pvtSight* sight, const pvtTriangleSet* set, float (*places)[2])
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
    spans->first = least < 0.5F ? 0 : (int)(least + 0.5F);
    spans->end = most >= SIZE ? SIZE : (int)(most + 0.5F);
    return spans->first < spans->end;
}

// Pixels whose centres are covered.
PVT_VECTOR_CLONES
static void DrawSpans(const Spans* spans, uint64_t* restrict rows)
{
    int32_t begins[SIZE], counts[SIZE];
    const int height = spans->end - spans->first;
    for (int i = 0; i < height; ++i) {
        const float y = (float)(spans->first + i) + 0.5F;
        const float a = spans->low[0][0] + spans->low[0][1] * y;
        const float b = spans->low[1][0] + spans->low[1][1] * y;
        const float c = spans->high[0][0] + spans->high[0][1] * y;
        const float d = spans->high[1][0] + spans->high[1][1] * y;
        float low = a > b ? a : b, high = c < d ? c : d;
        low = low > 0.0F ? low : 0.0F;
        low = low < SIZE ? low : SIZE;
        high = high < SIZE ? high : SIZE;
        high = high > low ? high : low;
        begins[i] = (int32_t)(low + 0.5F);
        counts[i] = (int32_t)(high + 0.5F) - begins[i];
    }
    for (int i = 0; i < height; ++i) {
        const uint64_t many = counts[i] > 0 ? ~UINT64_C(0) >> ((64 - counts[i]) & 63) : 0;
        rows[spans->first + i] |= many << (begins[i] & 63);
    }
}

static void DrawTriangle(const pvtTriangleSet* set, float (*places)[2], int triangle, float inset,
                         uint64_t* rows)
{
    const uint32_t* corners = set->triangles[triangle];
    const float* const p[3] = {places[corners[0]], places[corners[1]], places[corners[2]]};
    float insets[3] = {0};
    for (int k = 0; k < 3; ++k) {
        insets[k] = set->isOpen[triangle][k] ? inset : 0.0F;
    }
    Spans spans;
    if (MakeSpans(p, insets, &spans)) {
        DrawSpans(&spans, rows);
    }
}

PVT_VECTOR_CLONES
static void SumPixels(const uint64_t* missing, uint16_t (*restrict sums)[STRIDE])
{
    memset(sums[0], 0, sizeof sums[0]);
    for (int y = 0; y < SIZE; ++y) {
        const uint64_t row = missing[y];
        if (row == 0) {
            memcpy(sums[y + 1], sums[y], sizeof sums[0]);
            continue;
        }
        uint8_t counts[SIZE];
        uint64_t sum = 0;
        for (int byte = 0; byte < 8; ++byte) {
            // Bytes times ones: each becomes the sum of those up to it.
            const uint64_t here =
                (pvtSpreadBits((row >> (8 * byte)) & 255) + sum) * UINT64_C(0x0101010101010101);
            for (int i = 0; i < 8; ++i) {
                counts[8 * byte + i] = (uint8_t)(here >> (8 * i));
            }
            sum = here >> 56;
        }
        sums[y + 1][0] = 0;
        for (int x = 0; x < SIZE; ++x) {
            sums[y + 1][x + 1] = (uint16_t)(sums[y][x + 1] + counts[x]);
        }
    }
}

static unsigned CountMissing(uint16_t (*sums)[STRIDE], const pvtSightQuad* quad)
{
    return (unsigned)(sums[quad->y1][quad->x1] - sums[quad->y0][quad->x1] -
                      sums[quad->y1][quad->x0] + sums[quad->y0][quad->x0]);
}

static double SumWorths(const pvtPuller* puller, const pvtSight* sight, const uint64_t* missing)
{
    uint16_t sums[ENDS][STRIDE];
    SumPixels(missing, sums);
    double worth = 0.0;
    const pvtSightQuad* quads = puller->sights->quads + sight->firstQuad;
    for (size_t q = 0; q < sight->quadCount; ++q) {
        worth += (double)puller->worths[CountMissing(sums, &quads[q])];
    }
    return worth;
}

PVT_VECTOR_CLONES
static void SumColumns(float (*restrict values)[STRIDE])
{
    for (int y = 1; y < SIZE; ++y) {
        for (int x = 0; x < SIZE; ++x) {
            values[y][x] += values[y - 1][x];
        }
    }
}

// Several rows at a time, as each sum waits for the one before it.
static void SumRows(float (*restrict values)[STRIDE])
{
    for (int y = 0; y < SIZE; y += ROWS) {
        float sums[ROWS] = {0};
        for (int x = 0; x < SIZE; ++x) {
            for (int i = 0; i < ROWS; ++i) {
                sums[i] += values[y + i][x];
                values[y + i][x] = sums[i];
            }
        }
    }
}

// Into a table with a margin all around, 0 where nothing is missing.
PVT_VECTOR_CLONES
static void MaskValues(const uint64_t* missing, float (*restrict values)[STRIDE],
                       float (*restrict masked)[STRIDE])
{
    for (int y = 0; y < SIZE; ++y) {
        const uint32_t low = (uint32_t)missing[y], high = (uint32_t)(missing[y] >> 32);
        for (int x = 0; x < 32; ++x) {
            masked[y + 1][x + 1] = (low >> x & 1) != 0 ? values[y][x] : 0.0F;
            masked[y + 1][x + 33] = (high >> x & 1) != 0 ? values[y][x + 32] : 0.0F;
        }
    }
}

// What each pixel that is missing is worth, at one row and column farther.
static double WeighPixels(const pvtPuller* puller, const pvtSight* sight, const uint64_t* missing,
                          float (*masked)[STRIDE])
{
    uint16_t sums[ENDS][STRIDE];
    float values[ENDS][STRIDE];
    SumPixels(missing, sums);
    memset(values, 0, sizeof values);
    double worth = 0.0;
    const pvtSightQuad* quads = puller->sights->quads + sight->firstQuad;
    for (size_t q = 0; q < sight->quadCount; ++q) {
        const pvtSightQuad* quad = &quads[q];
        const unsigned lacks = CountMissing(sums, quad);
        const float slope = puller->slopes[lacks];
        worth += (double)puller->worths[lacks];
        values[quad->y0][quad->x0] += slope;
        values[quad->y0][quad->x1] -= slope;
        values[quad->y1][quad->x0] -= slope;
        values[quad->y1][quad->x1] += slope;
    }
    SumColumns(values);
    SumRows(values);
    MaskValues(missing, values, masked);
    return worth;
}

// The worth behind an edge, by how near it is to either end and to the middle.
typedef struct EdgeWorth {
    float ends[2], middle;
    float normal[2];
} EdgeWorth;

// The worths at `steps` even steps along a line, weighed by how near they are to its ends and to
// its middle. In lanes of their own, so that the sums do not depend on the width of vectors.
PVT_VECTOR_CLONES
static void SumAlong(const float from[2], const float way[2], int steps,
                     const float* restrict masked, float sums[3])
{
    float ends[2][LANES] = {{0}}, middle[LANES] = {0};
    const float step = 1.0F / (float)steps;
    for (int first = 0; first < steps; first += LANES) {
        for (int i = 0; i < LANES; ++i) {
            const float s = ((float)(first + i) + 0.5F) * step;
            float x = from[0] + way[0] * s + 1.0F, y = from[1] + way[1] * s + 1.0F;
            x = x > 0.0F ? x : 0.0F;
            x = x < SIZE + 1 ? x : SIZE + 1;
            y = y > 0.0F ? y : 0.0F;
            y = y < SIZE + 1 ? y : SIZE + 1;
            const float found = masked[(int)y * STRIDE + (int)x];
            const float value = s < 1.0F ? found : 0.0F;
            const float half = s < 0.5F ? s : 1.0F - s;
            ends[0][i] += value * (1.0F - s);
            ends[1][i] += value * s;
            middle[i] += value * (2.0F * half);
        }
    }
    for (int i = 0; i < LANES; ++i) {
        sums[0] += ends[0][i];
        sums[1] += ends[1][i];
        sums[2] += middle[i];
    }
}

static bool WeighEdge(const float a[2], const float b[2], const float across[2], float inset,
                      float (*masked)[STRIDE], EdgeWorth* worth)
{
    const float dx = b[0] - a[0], dy = b[1] - a[1];
    const float length = sqrtf(dx * dx + dy * dy);
    *worth = (EdgeWorth){0};
    if (!(length > 0.01F) || length > 4.0F * SIZE) {
        return false;
    }
    const float sign = pvtGetSide2(a, b, across) > 0 ? 1.0F : -1.0F;
    worth->normal[0] = sign * dy / length;
    worth->normal[1] = -sign * dx / length;
    const int steps = (int)length + 1;
    const float from[2] = {a[0] + worth->normal[0] * (BEHIND - inset),
                           a[1] + worth->normal[1] * (BEHIND - inset)};
    float sums[3] = {0};
    SumAlong(from, (float[2]){dx, dy}, steps, masked[0], sums);
    const float pixels = length / (float)steps;
    worth->ends[0] = sums[0] * pixels;
    worth->ends[1] = sums[1] * pixels;
    worth->middle = sums[2] * pixels;
    return worth->ends[0] + worth->ends[1] > 0.0F;
}

// Edges between two triangles that lie on both sides of it cover what is behind each other.
static void PullEdges(const pvtPuller* puller, size_t b, float (*places)[2],
                      float (*masked)[STRIDE])
{
    const pvtTriangleSet* set = puller->set;
    float(*corners)[2] = puller->cornerPulls + b * (size_t)set->cornerCapacity;
    float(*edges)[2] = puller->edgePulls + b * 3 * (size_t)set->triangleCapacity;
    memset(corners, 0, (size_t)set->cornerCount * sizeof *corners);
    memset(edges, 0, (size_t)set->edgeCount * sizeof *edges);
    for (int e = 0; e < set->edgeCount; ++e) {
        const pvtTriangleEdge* edge = &set->edges[e];
        const float* from = places[edge->ends[0]];
        const float* to = places[edge->ends[1]];
        const float* across = places[edge->across[0]];
        const bool isOpen = edge->sideCount < 2;
        if (!isOpen &&
            pvtGetSide2(from, to, across) * pvtGetSide2(from, to, places[edge->across[1]]) < 0) {
            continue;
        }
        EdgeWorth worth;
        if (!WeighEdge(from, to, across, isOpen ? puller->options.inset : 0.0F, masked, &worth)) {
            continue;
        }
        for (int axis = 0; axis < 2; ++axis) {
            corners[edge->ends[0]][axis] += worth.ends[0] * worth.normal[axis];
            corners[edge->ends[1]][axis] += worth.ends[1] * worth.normal[axis];
            edges[e][axis] = worth.middle * worth.normal[axis];
        }
    }
}

static void FindMissing(const pvtSight* sight, const uint64_t* rows, uint64_t* missing)
{
    for (int y = 0; y < SIZE; ++y) {
        missing[y] = sight->goal[y] & ~rows[y];
    }
}

enum { MOST_CORNERS_AT_ONCE = 9 * 512 + 64 };

static void PullSights(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    pvtPuller* puller = taskData;
    const pvtTriangleSet* set = puller->set;
    float places[MOST_CORNERS_AT_ONCE][2];
    float masked[MASKED][STRIDE] = {{0}};
    for (size_t b = begin; b < end; ++b) {
        const pvtSight* sight = &puller->sights->sights[GetSightIndex(puller, b)];
        ProjectCorners(sight, set, places);
        uint64_t rows[SIZE] = {0};
        for (int t = 0; t < set->triangleCount; ++t) {
            DrawTriangle(set, places, t, puller->options.inset, rows);
        }
        uint64_t missing[SIZE];
        FindMissing(sight, rows, missing);
        puller->most[b] = (double)sight->quadCount;
        if (puller->options.wantsNoPulls) {
            puller->worth[b] = SumWorths(puller, sight, missing);
        } else {
            puller->worth[b] = WeighPixels(puller, sight, missing, masked);
            PullEdges(puller, b, places, masked);
        }
    }
}

// From the planes of the views to space: what a pixel gains, a voxel gains over the pixel's size.
static void SumPulls(const pvtPuller* puller, const float (*pulls)[2], size_t stride, int count,
                     float (*sums)[3])
{
    memset(sums, 0, (size_t)count * sizeof *sums);
    for (size_t b = 0; b < (size_t)puller->options.count; ++b) {
        const pvtSight* sight = &puller->sights->sights[GetSightIndex(puller, b)];
        const float(*from)[2] = pulls + b * stride;
        for (int i = 0; i < count; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                sums[i][axis] += sight->weight *
                                 (from[i][0] * sight->right[axis] + from[i][1] * sight->up[axis]);
            }
        }
    }
}

void pvtPullCorners(pvtContext* context, const pvtPullOptions* options, pvtPuller* puller)
{
    const pvtTriangleSet* set = puller->set;
    assert(set->cornerCount <= MOST_CORNERS_AT_ONCE);
    SetOptions(puller, options);
    pvtParallelFor(context, PullSights, (size_t)options->count, 1, puller);
    if (!options->wantsNoPulls) {
        SumPulls(puller, (const float(*)[2])puller->cornerPulls, (size_t)set->cornerCapacity,
                 set->cornerCount, puller->corners);
    }
    if (options->wantsEdges) {
        SumPulls(puller, (const float(*)[2])puller->edgePulls, 3 * (size_t)set->triangleCapacity,
                 set->edgeCount, puller->edges);
    }
    double worth = 0.0, most = 0.0;
    for (size_t b = 0; b < (size_t)options->count; ++b) {
        const double weight = (double)puller->sights->sights[GetSightIndex(puller, b)].weight;
        worth += weight * puller->worth[b];
        most += weight * puller->most[b];
    }
    puller->share = most > 0.0 ? worth / most : 0.0;
}

static uint64_t* GetMask(const pvtPuller* puller, size_t b, int triangle)
{
    return puller->masks + (b * (size_t)puller->set->triangleCapacity + (size_t)triangle) * SIZE;
}

static uint64_t (*GetLayers(const pvtPuller* puller, size_t b))[LAYERS]
{
    return (uint64_t(*)[LAYERS])(puller->layers + b * SIZE * LAYERS);
}

static size_t GetLossIndex(const pvtPuller* puller, size_t b, int triangle)
{
    return b * (size_t)puller->set->triangleCapacity + (size_t)triangle;
}

// Pixels of the goal that a triangle covers and no other.
static int FindSingles(const pvtPuller* puller, const pvtSight* sight, size_t b, int triangle,
                       uint64_t* singles)
{
    const uint64_t* mask = GetMask(puller, b, triangle);
    uint64_t(*layers)[LAYERS] = GetLayers(puller, b);
    int count = 0;
    for (int y = 0; y < SIZE; ++y) {
        singles[y] = mask[y] & ~layers[y][1] & sight->goal[y];
        count += singles[y] != 0 ? pvtCountBits(singles[y]) : 0;
    }
    return count;
}

static void DrawMasks(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    pvtPuller* puller = taskData;
    const pvtTriangleSet* set = puller->set;
    float places[MOST_CORNERS_AT_ONCE][2];
    for (size_t b = begin; b < end; ++b) {
        const pvtSight* sight = &puller->sights->sights[GetSightIndex(puller, b)];
        uint64_t(*layers)[LAYERS] = GetLayers(puller, b);
        ProjectCorners(sight, set, places);
        memset(layers, 0, SIZE * sizeof *layers);
        for (int t = 0; t < set->triangleCount; ++t) {
            uint64_t* mask = GetMask(puller, b, t);
            memset(mask, 0, SIZE * sizeof *mask);
            DrawTriangle(set, places, t, puller->options.inset, mask);
            for (int y = 0; y < SIZE; ++y) {
                layers[y][2] |= layers[y][1] & mask[y];
                layers[y][1] |= layers[y][0] & mask[y];
                layers[y][0] |= mask[y];
            }
        }
        for (int t = 0; t < set->triangleCount; ++t) {
            uint64_t singles[SIZE];
            puller->singles[GetLossIndex(puller, b, t)] =
                (uint32_t)FindSingles(puller, sight, b, t, singles);
        }
    }
}

static void WeighSights(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    pvtPuller* puller = taskData;
    for (size_t b = begin; b < end; ++b) {
        const pvtSight* sight = &puller->sights->sights[GetSightIndex(puller, b)];
        uint64_t(*layers)[LAYERS] = GetLayers(puller, b);
        uint64_t missing[SIZE], lacking[SIZE], singles[SIZE];
        for (int y = 0; y < SIZE; ++y) {
            missing[y] = sight->goal[y] & ~layers[y][0];
        }
        const double worth = SumWorths(puller, sight, missing);
        for (int t = 0; t < puller->set->triangleCount; ++t) {
            float* loss = &puller->losses[GetLossIndex(puller, b, t)];
            *loss = 0.0F;
            if (puller->isWeighed[t] && FindSingles(puller, sight, b, t, singles) > 0) {
                for (int y = 0; y < SIZE; ++y) {
                    lacking[y] = missing[y] | singles[y];
                }
                *loss = (float)(worth - SumWorths(puller, sight, lacking)) * sight->weight;
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
            sum += (double)puller->sights->sights[GetSightIndex(puller, b)].weight *
                   puller->singles[GetLossIndex(puller, b, t)];
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
    SetOptions(puller, options);
    pvtParallelFor(context, DrawMasks, (size_t)options->count, 1, puller);
    ChooseTriangles(puller);
    pvtParallelFor(context, WeighSights, (size_t)options->count, 1, puller);
    for (int t = 0; t < puller->set->triangleCount; ++t) {
        double sum = 0.0;
        for (size_t b = 0; b < (size_t)options->count; ++b) {
            sum += (double)puller->losses[GetLossIndex(puller, b, t)];
        }
        puller->triangles[t] = puller->isWeighed[t] ? sum : HUGE_VAL;
    }
}

bool pvtArePartners(const pvtPuller* puller, int a, int b)
{
    for (size_t s = 0; s < (size_t)puller->options.count; ++s) {
        const uint64_t* first = GetMask(puller, s, a);
        const uint64_t* second = GetMask(puller, s, b);
        uint64_t(*layers)[LAYERS] = GetLayers(puller, s);
        for (int y = 0; y < SIZE; ++y) {
            if ((first[y] & second[y] & ~layers[y][2]) != 0) {
                return true;
            }
        }
    }
    return false;
}
