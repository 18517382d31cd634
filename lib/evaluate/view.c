// SPDX-License-Identifier: MIT
// One view of the evaluation of section 6.1 of the paper. Directions by George Marsaglia, "Choosing
// a Point from the Surface of a Sphere" (1972), which needs nothing but a square root.
#include "view.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"

#include <math.h>

enum {
    STREAMS_PER_VIEW = 3, // the direction's, then one a family of quads
    BATCH = 1 << 14,      // quads between two looks whether it is cancelled
    WINDOW_FACTOR = 4,
    WINDOW_EXTRA = 4096,
};

// A view along a needle must not take its rounding errors for its extent.
static const double LEAST_SIDE = 0x1p-20;  // of the bounds' diagonal
static const double LEAST_EXTENT = 1e-100; // [wu]

pvtStatus pvtCreateViewScratch(pvtContext* context, const pvtViewJob* job, pvtViewScratch* scratch)
{
    *scratch = (pvtViewScratch){0};
    size_t most = job->original->positionCount;
    for (size_t i = 0; i < job->count; ++i) {
        most = job->occluders[i].positionCount > most ? job->occluders[i].positionCount : most;
    }
    scratch->points = pvtAllocate(context, most, sizeof *scratch->points);
    return scratch->points == NULL ? pvtContext_GetStatus(context) : PVT_OK;
}

void pvtViewScratch_Free(pvtContext* context, pvtViewScratch* scratch)
{
    pvtRelease(context, scratch->points);
    pvtRaster_Free(context, &scratch->original);
    pvtRaster_Free(context, &scratch->occluder);
    pvtRaster_Free(context, &scratch->coarse);
    pvtCoverTable_Free(context, &scratch->originalTable);
    pvtCoverTable_Free(context, &scratch->occluderTable);
    pvtExcessScratch_Free(context, &scratch->excess);
    *scratch = (pvtViewScratch){0};
}

static pvtRandom GetStream(const pvtEvaluateOptions* options, int view, int stream)
{
    return pvtMakeRandom(options->seed, (uint64_t)view * STREAMS_PER_VIEW + (uint64_t)stream);
}

pvtVec3 pvtGetViewDirection(const pvtEvaluateOptions* options, int view)
{
    if (options->directions != NULL) {
        return pvtNormalize(options->directions[view]);
    }
    pvtRandom random = GetStream(options, view, 0);
    for (;;) {
        const double a = 2.0 * pvtRandom_Unit(&random) - 1.0;
        const double b = 2.0 * pvtRandom_Unit(&random) - 1.0;
        const double square = a * a + b * b;
        if (square < 1.0) {
            const double ring = 2.0 * sqrt(1.0 - square);
            return (pvtVec3){a * ring, b * ring, 1.0 - 2.0 * square};
        }
    }
}

static int CountPixels(double side, double pixelSize, int most)
{
    const double count = ceil(side / pixelSize);
    return count < 1.0 ? 1 : count > most ? most : (int)count;
}

pvtStatus pvtFitScreen(pvtContext* context, const pvtSoup* original, int pixels, pvtScreen* screen)
{
    pvtScreenBox box;
    if (!pvtProjectBounds(context, screen, original, &box)) {
        return pvtFailCancelled(context);
    }
    const double width = box.upper[0] - box.lower[0], height = box.upper[1] - box.lower[1];
    const pvtVec3 extent = pvtSub(original->bounds.upper, original->bounds.lower);
    const double least = fmax(pvtLength3(extent) * LEAST_SIDE, LEAST_EXTENT);
    screen->lower[0] = box.lower[0];
    screen->lower[1] = box.lower[1];
    screen->pixelSize = fmax(fmax(width, height), least) / pixels;
    screen->width = CountPixels(width, screen->pixelSize, pixels);
    screen->height = CountPixels(height, screen->pixelSize, pixels);
    return PVT_OK;
}

// Pixels `begin` to `end` − 1 of one axis that hold the original's and lower to upper [wu].
typedef struct PixelSpan {
    double begin, end;
} PixelSpan;

static PixelSpan FindSpan(const pvtScreen* screen, int axis, const pvtScreenBox* box)
{
    const double size = axis == 0 ? screen->width : screen->height;
    const double begin = floor((box->lower[axis] - screen->lower[axis]) / screen->pixelSize);
    const double end = ceil((box->upper[axis] - screen->lower[axis]) / screen->pixelSize);
    return (PixelSpan){fmin(begin, 0.0), fmax(end, size)};
}

pvtStatus pvtPairScreens(pvtContext* context, const pvtScreen* screen, const pvtSoup* occluder,
                         int pixels, pvtScreenPair* pair)
{
    *pair = (pvtScreenPair){*screen, *screen, 0, 0};
    pvtScreenBox box;
    if (!pvtProjectBounds(context, screen, occluder, &box)) {
        return pvtFailCancelled(context);
    }
    if (box.lower[0] > box.upper[0]) {
        return PVT_OK;
    }
    const double most = WINDOW_FACTOR * pixels + WINDOW_EXTRA;
    PixelSpan x = FindSpan(screen, 0, &box), y = FindSpan(screen, 1, &box);
    while (x.end - x.begin > most || y.end - y.begin > most) {
        pair->original.pixelSize *= 2.0;
        pair->original.width = (pair->original.width + 1) / 2;
        pair->original.height = (pair->original.height + 1) / 2;
        x = FindSpan(&pair->original, 0, &box);
        y = FindSpan(&pair->original, 1, &box);
    }
    pair->x = (int)floor(x.begin / 64.0) * 64;
    pair->y = (int)y.begin;
    pair->both = pair->original;
    pair->both.width = (int)x.end - pair->x;
    pair->both.height = (int)y.end - pair->y;
    pair->both.lower[0] += pair->x * pair->both.pixelSize;
    pair->both.lower[1] += pair->y * pair->both.pixelSize;
    return PVT_OK;
}

static pvtStatus DrawSoup(pvtContext* context, const pvtScreen* screen, const pvtSoup* soup,
                          pvtScreenPoint* points, pvtRaster* raster)
{
    const pvtStatus status = pvtRaster_Resize(context, raster, screen->width, screen->height);
    if (status != PVT_OK) {
        return status;
    }
    const bool done = pvtRasterizeSoup(context, screen, soup, points, raster);
    return done ? PVT_OK : pvtFailCancelled(context);
}

static uint64_t CountCovered(const pvtCoverTable* table)
{
    return pvtCoverTable_Count(table, &(pvtQuad){0, 0, table->width - 1, table->height - 1});
}

static uint64_t CountShared(const pvtRasterPair* pair)
{
    const pvtRaster *original = pair->original, *occluder = pair->occluder;
    uint64_t count = 0;
    for (int y = 0; y < original->height; ++y) {
        const uint64_t* a = original->words + (size_t)y * original->wordsPerRow;
        const uint64_t* b = occluder->words + (size_t)(y - pair->y) * occluder->wordsPerRow;
        b -= pair->x / 64;
        for (size_t w = 0; w < original->wordsPerRow; ++w) {
            count += (uint64_t)pvtCountBits(a[w] & b[w]);
        }
    }
    return count;
}

static pvtStatus JudgeQuads(pvtContext* context, const pvtViewJob* job, int view,
                            const pvtViewScratch* scratch, pvtViewResult* result)
{
    const pvtCoverTable* table = &scratch->originalTable;
    for (int family = 0; family < 2; ++family) {
        pvtRandom random = GetStream(job->options, view, 1 + family);
        pvtQuadTally* tally = &result->tallies[family];
        for (int q = 0; q < job->options->quads; ++q) {
            if (q % BATCH == 0 && pvtIsCancelled(context)) {
                return pvtFailCancelled(context);
            }
            const pvtQuad quad =
                pvtDrawQuad(&random, (pvtQuadFamily)family, table->width, table->height);
            pvtTallyQuad(table, &scratch->occluderTable, &quad, tally);
        }
    }
    result->score.uniform = pvtScoreTally(&result->tallies[PVT_QUADS_UNIFORM]);
    result->score.small = pvtScoreTally(&result->tallies[PVT_QUADS_SMALL]);
    return PVT_OK;
}

static pvtStatus JudgeExcess(pvtContext* context, const pvtRasterPair* pair, double pixelSize,
                             pvtViewScratch* scratch, pvtViewScore* score)
{
    pvtExcess excess;
    const pvtStatus status = pvtMeasureExcess(context, pair, &scratch->excess, &excess);
    score->overArea = (double)excess.pixels * pixelSize * pixelSize;
    score->overThickness = sqrt((double)excess.distance2) * pixelSize;
    return status;
}

// The occluder is so much larger than the original that its excess is measured in coarser pixels.
static pvtStatus JudgeCoarseExcess(pvtContext* context, const pvtViewJob* job,
                                   const pvtScreenPair* screens, pvtViewScratch* scratch,
                                   pvtViewScore* score)
{
    pvtStatus status =
        DrawSoup(context, &screens->original, job->original, scratch->points, &scratch->coarse);
    if (status != PVT_OK) {
        return status;
    }
    const pvtRasterPair pair = {&scratch->coarse, &scratch->occluder, screens->x, screens->y};
    scratch->excess.isReady = false;
    status = JudgeExcess(context, &pair, screens->original.pixelSize, scratch, score);
    scratch->excess.isReady = false;
    return status;
}

static pvtStatus JudgeOccluder(pvtContext* context, const pvtViewJob* job, size_t index,
                               const pvtScreen* screen, pvtViewScratch* scratch,
                               pvtViewScore* score)
{
    const pvtSoup* occluder = &job->occluders[index];
    pvtScreenPair screens;
    pvtStatus status = pvtPairScreens(context, screen, occluder, job->options->pixels, &screens);
    if (status == PVT_OK) {
        status = DrawSoup(context, &screens.both, occluder, scratch->points, &scratch->occluder);
    }
    pvtRasterPair pair = {&scratch->original, &scratch->occluder, screens.x, screens.y};
    if (status == PVT_OK && screens.original.pixelSize > screen->pixelSize) {
        status = JudgeCoarseExcess(context, job, &screens, scratch, score);
        if (status == PVT_OK) {
            status = DrawSoup(context, screen, occluder, scratch->points, &scratch->occluder);
        }
        pair.x = pair.y = 0;
    } else if (status == PVT_OK) {
        status = JudgeExcess(context, &pair, screen->pixelSize, scratch, score);
    }
    if (status != PVT_OK) {
        return status;
    }
    const uint64_t covered = CountCovered(&scratch->originalTable);
    const uint64_t shared = CountShared(&pair);
    score->coverage = covered > 0 ? (double)shared / (double)covered : 1.0;
    const pvtQuad part = {-pair.x, -pair.y, screen->width - 1 - pair.x,
                          screen->height - 1 - pair.y};
    return pvtCoverTable_Build(context, &scratch->occluderTable, &scratch->occluder, &part);
}

pvtStatus pvtJudgeView(pvtContext* context, const pvtViewJob* job, int view,
                       pvtViewScratch* scratch, pvtViewResult* results)
{
    pvtScreen screen = pvtMakeScreen(pvtGetViewDirection(job->options, view));
    pvtStatus status = pvtFitScreen(context, job->original, job->options->pixels, &screen);
    if (status == PVT_OK) {
        status = DrawSoup(context, &screen, job->original, scratch->points, &scratch->original);
    }
    if (status == PVT_OK) {
        const pvtQuad all = {0, 0, screen.width - 1, screen.height - 1};
        status = pvtCoverTable_Build(context, &scratch->originalTable, &scratch->original, &all);
    }
    scratch->excess.isReady = false;
    for (size_t i = 0; i < job->count && status == PVT_OK; ++i) {
        results[i] = (pvtViewResult){.score.direction = screen.direction};
        status = JudgeOccluder(context, job, i, &screen, scratch, &results[i].score);
        if (status == PVT_OK) {
            status = JudgeQuads(context, job, view, scratch, &results[i]);
        }
    }
    return status;
}
