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

#include "base/context.h"
#include "base/vectors.h"
#include "beyond.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    SIZE = PVT_SIGHT_SIZE,
    CELLS = PVT_SIGHT_CELLS,
    STRIDE = PVT_SIGHT_STRIDE,
    ENDS = PVT_SIGHT_ENDS,
    ROWS = 8,
    LANES = 8,
    PADDED = SIZE + 2, // with a pixel more on each side
    LINKS = 6,         // of 32 pixels a padded row, the first and last of which hold none
};

// From an edge to the pixel behind it [px].
static const float BEHIND = 0.5F;
static const float SPACING = 2.0F; // [px] from one look behind an edge to the next
static const uint64_t EVEN = UINT64_C(0x5555555555555555);

void pvtPuller_Free(pvtContext* context, pvtPuller* puller)
{
    pvtRelease(context, puller->cornerPulls);
    pvtRelease(context, puller->edgePulls);
    pvtRelease(context, puller->masks);
    pvtRelease(context, puller->rows);
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
    puller->cornerPulls =
        pvtAllocate(context, PVT_MOST_BATCH * corners, sizeof *puller->cornerPulls);
    puller->edgePulls =
        pvtAllocate(context, PVT_MOST_BATCH * 3 * triangles, sizeof *puller->edgePulls);
    puller->masks = pvtAllocate(context, PVT_MOST_WEIGHED * triangles, sizeof *puller->masks);
    puller->rows = pvtAllocate(context, PVT_MOST_WEIGHED * triangles, sizeof *puller->rows);
    puller->layers = pvtAllocate(context, PVT_MOST_WEIGHED, sizeof *puller->layers);
    puller->singles = pvtAllocate(context, PVT_MOST_WEIGHED * triangles, sizeof *puller->singles);
    puller->isWeighed = pvtAllocate(context, triangles, sizeof *puller->isWeighed);
    puller->losses = pvtAllocate(context, PVT_MOST_WEIGHED * triangles, sizeof *puller->losses);
    puller->corners = pvtAllocate(context, corners, sizeof *puller->corners);
    puller->edges = pvtAllocate(context, 3 * triangles, sizeof *puller->edges);
    puller->triangles = pvtAllocate(context, triangles, sizeof *puller->triangles);
    if (puller->cornerPulls == NULL || puller->edgePulls == NULL || puller->masks == NULL ||
        puller->rows == NULL || puller->losses == NULL || puller->layers == NULL ||
        puller->singles == NULL || puller->isWeighed == NULL || puller->corners == NULL ||
        puller->edges == NULL || puller->triangles == NULL) {
        pvtPuller_Free(context, puller);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

PVT_VECTOR_CLONES
static void SumColumns(float (*restrict values)[STRIDE])
{
    for (int y = 1; y < CELLS; ++y) {
        for (int x = 0; x < CELLS; ++x) {
            values[y][x + 1] += values[y - 1][x + 1];
        }
    }
}

// Several rows at a time, as each sum waits for the one before it.
static void SumRows(float (*restrict values)[STRIDE])
{
    for (int y = 0; y < CELLS; y += ROWS) {
        float sums[ROWS] = {0};
        for (int x = 1; x <= CELLS; ++x) {
            for (int i = 0; i < ROWS; ++i) {
                sums[i] += values[y + i][x];
                values[y + i][x] = sums[i];
            }
        }
    }
}

// What is missing, and what each pixel of a cell is worth.
typedef struct Lack {
    uint32_t missing[PADDED][LINKS]; // pixel x is bit x + 32 of row y + 1
    float values[ENDS + 1][STRIDE];  // of cell (x, y) at [y + 1][x + 1]
    bool hasLosses;                  // values below 0, which are rounding otherwise
} Lack;

static void PadMissing(const pvtSightMask* missing, Lack* lack)
{
    memset(lack->missing, 0, sizeof lack->missing);
    for (int y = 0; y < SIZE; ++y) {
        for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
            const uint64_t word = missing->words[half][y];
            lack->missing[y + 1][2 * half + 1] = (uint32_t)word;
            lack->missing[y + 1][2 * half + 2] = (uint32_t)(word >> 32);
        }
    }
}

static void ClearValues(float (*values)[STRIDE])
{
    if (values != NULL) {
        memset(values, 0, (ENDS + 1) * sizeof *values);
    }
}

static void SumValues(float (*values)[STRIDE])
{
    if (values != NULL) {
        SumColumns(values + 1);
        SumRows(values + 1);
    }
}

// What each pixel of a rectangle is worth: the table holds differences until they are summed.
static inline void AddSlope(const pvtSightQuad* quad, float slope, float (*values)[STRIDE])
{
    if (values == NULL) {
        return;
    }
    values[quad->y0 + 1][quad->x0 + 1] += slope;
    values[quad->y0 + 1][quad->x1 + 1] -= slope;
    values[quad->y1 + 1][quad->x0 + 1] -= slope;
    values[quad->y1 + 1][quad->x1 + 1] += slope;
}

// Of a sight's rectangles.
typedef struct Worths {
    double worth;
    double hidden; // those of which nothing is missing
} Worths;

// A rectangle that counts `weight`, by what is missing of it.
static inline void WeighQuad(const pvtSightQuad* quad, float weight, uint16_t (*sums)[STRIDE],
                             float softness, Worths* worths, float (*values)[STRIDE])
{
    const float here = pvtGetWorth(pvtCountMissing(sums, quad), softness);
    worths->worth += (double)(weight * here);
    worths->hidden += here >= 1.0F ? (double)weight : 0.0;
    AddSlope(quad, weight * here * here / softness, values);
}

// Fills the values, unless there are none.
static Worths WeighCells(const pvtPuller* puller, const pvtSight* sight,
                         const pvtSightMask* missing, float (*values)[STRIDE])
{
    uint16_t sums[ENDS][STRIDE];
    pvtSumMissing(missing, sums);
    ClearValues(values);
    Worths worths = {0.0, 0.0};
    const pvtSightQuad* quads = puller->sights->quads + sight->firstQuad;
    for (size_t q = 0; q < sight->quadCount; ++q) {
        WeighQuad(&quads[q], 1.0F, sums, puller->options.softness, &worths, values);
    }
    SumValues(values);
    return worths;
}

// The same of those that reach beyond the goal; what matters of them is what is not covered at all.
static Worths WeighWrong(const pvtPuller* puller, const pvtSight* sight,
                         const pvtSightMask* covered, float (*values)[STRIDE])
{
    uint16_t sums[ENDS][STRIDE];
    pvtSumOpen(covered, sums);
    ClearValues(values);
    Worths worths = {0.0, 0.0};
    const pvtWrongQuad* wrongs = puller->sights->wrongs + sight->firstWrong;
    for (size_t q = 0; q < sight->wrongCount; ++q) {
        WeighQuad(&wrongs[q].quad, wrongs[q].weight, sums, puller->options.softness, &worths,
                  values);
    }
    SumValues(values);
    return worths;
}

// The worth behind an edge, by how near it is to either end and to the middle.
typedef struct EdgeWorth {
    float ends[2], middle;
    float normal[2];
} EdgeWorth;

// The worths at `steps` even steps along a line, weighed by how near they are to its ends and to
// its middle. In lanes of their own, so that the sums do not depend on the width of vectors.
PVT_VECTOR_CLONES
static void SumAlong(const float from[2], const float way[2], int steps, const Lack* restrict lack,
                     float sums[3])
{
    const uint32_t* restrict missing = lack->missing[0];
    const float* restrict values = lack->values[0];
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
            const int column = (int)x, row = (int)y, bit = column + 31;
            const float found = values[(row + 1) / 2 * STRIDE + (column + 1) / 2];
            const bool isMissing = (missing[row * LINKS + bit / 32] >> (bit & 31) & 1) != 0;
            const float value = isMissing && s < 1.0F ? found : 0.0F;
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
                      const Lack* lack, EdgeWorth* worth)
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
    const int steps = (int)(length / SPACING) + 1;
    const float from[2] = {a[0] + worth->normal[0] * (BEHIND - inset),
                           a[1] + worth->normal[1] * (BEHIND - inset)};
    float sums[3] = {0};
    SumAlong(from, (float[2]){dx, dy}, steps, lack, sums);
    const float pixels = length / (float)steps;
    worth->ends[0] = sums[0] * pixels;
    worth->ends[1] = sums[1] * pixels;
    worth->middle = sums[2] * pixels;
    return worth->ends[0] + worth->ends[1] > 0.0F || lack->hasLosses;
}

// Edges between two triangles that lie on both sides of it cover what is behind each other.
static void PullEdges(const pvtPuller* puller, size_t b, float (*places)[2], const Lack* lack)
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
        if (!WeighEdge(from, to, across, isOpen ? puller->options.inset : 0.0F, lack, &worth)) {
            continue;
        }
        for (int axis = 0; axis < 2; ++axis) {
            corners[edge->ends[0]][axis] += worth.ends[0] * worth.normal[axis];
            corners[edge->ends[1]][axis] += worth.ends[1] * worth.normal[axis];
            edges[e][axis] = worth.middle * worth.normal[axis];
        }
    }
}

// Beyond the goal's whole cells a pixel that is covered is worth less than nothing: there it counts
// as missing, and what is missing of the goal does not.
static void LoseWrong(const pvtPuller* puller, const pvtSight* sight, const float (*slopes)[STRIDE],
                      pvtSightMask* missing, Lack* lack)
{
    for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
        for (int y = 0; y < CELLS; ++y) {
            const uint64_t* goal = sight->goal.words[half] + 2 * (size_t)y;
            const uint64_t both = goal[0] & goal[1];
            const uint64_t whole = both & both >> 1 & EVEN;
            uint64_t* rows = missing->words[half] + 2 * (size_t)y;
            for (int i = 0; i < 2; ++i) {
                rows[i] = (rows[i] & (whole | whole << 1)) | ~goal[i];
            }
            for (int x = 0; x < 32; ++x) {
                if ((whole >> (2 * x) & 1) == 0) {
                    const int column = 32 * half + x + 1;
                    lack->values[y + 1][column] =
                        -puller->options.wrongCost * slopes[y + 1][column];
                }
            }
        }
    }
}

// Pixels beyond the goal are as missing ones that are worth less than nothing.
static void LoseBeyond(pvtPuller* puller, size_t b, const pvtSightMask* covered,
                       pvtSightMask* missing, Lack* lack)
{
    const pvtSight* sight = pvtPuller_GetSight(puller, b);
    pvtSightMask beyond;
    pvtFindBeyond(&sight->goal, &beyond);
    if (puller->options.wantsNoPulls) {
        puller->worth[b] -=
            (double)sight->quadCount * pvtGetCostBeyond(&sight->goal, &beyond, covered);
        return;
    }
    lack->hasLosses = true;
    pvtPunishBeyond(&beyond, lack->values);
    for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
        for (int y = 0; y < SIZE; ++y) {
            missing->words[half][y] |= beyond.words[half][y];
        }
    }
}

static void WeighSight(pvtPuller* puller, size_t b, const pvtSightMask* covered,
                       pvtSightMask* missing, Lack* lack)
{
    const pvtSight* sight = pvtPuller_GetSight(puller, b);
    const bool wantsPulls = !puller->options.wantsNoPulls;
    const Worths worths = WeighCells(puller, sight, missing, wantsPulls ? lack->values : NULL);
    puller->most[b] = (double)sight->quadCount;
    puller->worth[b] = worths.worth;
    puller->rights[b] = worths.hidden;
    puller->wrongs[b] = 0.0;
    lack->hasLosses = wantsPulls && sight->wrongCount > 0 && puller->options.wrongCost > 0.0F;
    if (sight->wrongCount > 0) {
        float slopes[ENDS + 1][STRIDE];
        const Worths wrong = WeighWrong(puller, sight, covered, lack->hasLosses ? slopes : NULL);
        puller->wrongs[b] = wrong.hidden;
        if (lack->hasLosses) {
            LoseWrong(puller, sight, (const float(*)[STRIDE])slopes, missing, lack);
        }
    }
    if (puller->options.mindsBeyond) {
        LoseBeyond(puller, b, covered, missing, lack);
    }
}

static void PullSights(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    pvtPuller* puller = taskData;
    const pvtTriangleSet* set = puller->set;
    float places[PVT_MOST_SIGHT_CORNERS][2];
    Lack lack;
    for (size_t b = begin; b < end; ++b) {
        const pvtSight* sight = pvtPuller_GetSight(puller, b);
        pvtSightMask covered = {0}, missing;
        pvtProjectCorners(sight, set, places);
        for (int t = 0; t < set->triangleCount; ++t) {
            pvtDrawSightTriangle(set, places, t, puller->options.inset, &covered);
        }
        pvtFindMissing(&sight->goal, &covered, &missing);
        WeighSight(puller, b, &covered, &missing, &lack);
        if (!puller->options.wantsNoPulls) {
            PadMissing(&missing, &lack);
            PullEdges(puller, b, places, &lack);
        }
    }
}

// From the planes of the views to space: what a pixel gains, a voxel gains over the pixel's size.
static void SumPulls(const pvtPuller* puller, const float (*pulls)[2], size_t stride, int count,
                     float (*sums)[3])
{
    memset(sums, 0, (size_t)count * sizeof *sums);
    for (size_t b = 0; b < (size_t)puller->options.count; ++b) {
        const pvtSight* sight = pvtPuller_GetSight(puller, b);
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
    assert(set->cornerCount <= PVT_MOST_SIGHT_CORNERS);
    assert(options->count >= 1 && options->count <= PVT_MOST_BATCH && options->softness > 0.0F);
    puller->options = *options;
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
    puller->right = puller->wrong = 0.0;
    for (size_t b = 0; b < (size_t)options->count; ++b) {
        const double weight = (double)pvtPuller_GetSight(puller, b)->weight;
        worth += weight * puller->worth[b];
        most += weight * puller->most[b];
        puller->right += weight * puller->rights[b];
        puller->wrong += weight * puller->wrongs[b];
    }
    puller->share = most > 0.0 ? worth / most : 0.0;
}
