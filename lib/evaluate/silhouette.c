// SPDX-License-Identifier: MIT
// Pictures for people, in the colours of the paper's figure 7. Drawn by the evaluator's rasteriser,
// so that what it counts is what they show.
#include "base/bits.h"
#include "base/context.h"
#include "raster.h"

#include <math.h>
#include <paravent/evaluate.h>
#include <stdatomic.h>

enum { FINE = 3, MIN_SIDE = 16, MAX_SIDE = 4096 }; // FINE × FINE samples a pixel

typedef struct SilhouetteScratch {
    pvtScreenPoint* points;
    pvtRaster original, occluder;
} SilhouetteScratch;

typedef struct SilhouetteTask {
    pvtContext* context;
    const pvtSilhouetteOptions* options;
    const pvtSoup *original, *occluder;
    SilhouetteScratch* scratches; // one a worker
    pvtImage* images;
    atomic_size_t done;
    _Atomic pvtStatus status; // the first failure
} SilhouetteTask;

// By occluder × 2 + original.
static const uint8_t COLOURS[4][3] = {
    {255, 255, 255},
    {0, 0, 0},
    {30, 80, 230},
    {255, 221, 0},
};

pvtSilhouetteOptions pvtDefaultSilhouetteOptions(void)
{
    return (pvtSilhouetteOptions){.width = 512, .height = 512, .margin = 8};
}

static bool UnionBounds(pvtContext* context, const pvtScreen* screen, const SilhouetteTask* task,
                        pvtScreenBox* box)
{
    pvtScreenBox other;
    if (!pvtProjectBounds(context, screen, task->original, box) ||
        !pvtProjectBounds(context, screen, task->occluder, &other)) {
        return false;
    }
    for (int i = 0; i < 2; ++i) {
        box->lower[i] = fmin(box->lower[i], other.lower[i]);
        box->upper[i] = fmax(box->upper[i], other.upper[i]);
    }
    return true;
}

// Fits both into the middle of the picture, in samples.
static bool FitPicture(pvtContext* context, const SilhouetteTask* task, pvtScreen* screen)
{
    pvtScreenBox box;
    if (!UnionBounds(context, screen, task, &box)) {
        return false;
    }
    const pvtSilhouetteOptions* options = task->options;
    const int sides[2] = {options->width * FINE, options->height * FINE};
    screen->width = sides[0];
    screen->height = sides[1];
    screen->pixelSize = 1e-100;
    for (int i = 0; i < 2; ++i) {
        const double room = sides[i] - 2 * options->margin * FINE;
        screen->pixelSize = fmax(screen->pixelSize, (box.upper[i] - box.lower[i]) / room);
    }
    for (int i = 0; i < 2; ++i) {
        const double middle = 0.5 * (box.lower[i] + box.upper[i]);
        screen->lower[i] = middle - 0.5 * sides[i] * screen->pixelSize;
    }
    return true;
}

// The mean colour of the samples of pixel (x, y), rows from the top.
static void MixPixel(const SilhouetteScratch* scratch, int x, int y, uint8_t pixel[4])
{
    int counts[4] = {0};
    const int bottom = scratch->original.height - (y + 1) * FINE;
    for (int j = 0; j < FINE; ++j) {
        const size_t row = (size_t)(bottom + j) * scratch->original.wordsPerRow;
        for (int i = 0; i < FINE; ++i) {
            const size_t bit = (size_t)x * FINE + (size_t)i;
            const int original = pvtGetBit(scratch->original.words + row, bit);
            const int occluder = pvtGetBit(scratch->occluder.words + row, bit);
            ++counts[2 * occluder + original];
        }
    }
    for (int c = 0; c < 3; ++c) {
        int sum = FINE * FINE / 2;
        for (int k = 0; k < 4; ++k) {
            sum += counts[k] * COLOURS[k][c];
        }
        pixel[c] = (uint8_t)(sum / (FINE * FINE));
    }
    pixel[3] = 255;
}

static pvtStatus DrawPicture(SilhouetteTask* task, size_t index, SilhouetteScratch* scratch)
{
    pvtContext* context = task->context;
    pvtScreen screen = pvtMakeScreen(task->options->directions[index]);
    if (!FitPicture(context, task, &screen)) {
        return pvtFailCancelled(context);
    }
    pvtStatus status = pvtRaster_Resize(context, &scratch->original, screen.width, screen.height);
    if (status == PVT_OK) {
        status = pvtRaster_Resize(context, &scratch->occluder, screen.width, screen.height);
    }
    if (status != PVT_OK) {
        return status;
    }
    if (!pvtRasterizeSoup(context, &screen, task->original, scratch->points, &scratch->original) ||
        !pvtRasterizeSoup(context, &screen, task->occluder, scratch->points, &scratch->occluder)) {
        return pvtFailCancelled(context);
    }
    const pvtImage* image = &task->images[index];
    for (int y = 0; y < image->height; ++y) {
        for (int x = 0; x < image->width; ++x) {
            MixPixel(scratch, x, y,
                     image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x));
        }
    }
    return PVT_OK;
}

static void DrawPictures(size_t begin, size_t end, int worker, void* taskData)
{
    SilhouetteTask* task = taskData;
    for (size_t i = begin; i < end && atomic_load(&task->status) == PVT_OK; ++i) {
        pvtStatus none = PVT_OK;
        const pvtStatus status = DrawPicture(task, i, &task->scratches[worker]);
        atomic_compare_exchange_strong(&task->status, &none, status);
        const size_t done = atomic_fetch_add(&task->done, 1) + 1;
        if (worker == 0) {
            pvtReportProgress(task->context, (double)done / (double)task->options->count);
        }
    }
}

static pvtStatus RunTask(SilhouetteTask* task)
{
    pvtContext* context = task->context;
    const size_t threads = (size_t)pvtContext_GetThreadCount(context);
    const size_t points = task->original->positionCount > task->occluder->positionCount
                              ? task->original->positionCount
                              : task->occluder->positionCount;
    task->scratches = pvtAllocate(context, threads, sizeof *task->scratches);
    if (task->scratches == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < threads && status == PVT_OK; ++i) {
        task->scratches[i].points = pvtAllocate(context, points, sizeof(pvtScreenPoint));
        status = task->scratches[i].points == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, DrawPictures, task->options->count, 1, task);
        status = atomic_load(&task->status);
    }
    if (status == PVT_OK) {
        pvtReportProgress(context, 1.0); // the caller's thread may have drawn none
    }
    for (size_t i = 0; i < threads; ++i) {
        pvtRelease(context, task->scratches[i].points);
        pvtRaster_Free(context, &task->scratches[i].original);
        pvtRaster_Free(context, &task->scratches[i].occluder);
    }
    pvtRelease(context, task->scratches);
    return status;
}

static pvtStatus CheckOptions(pvtContext* context, const pvtSilhouetteOptions* options)
{
    const int least = options->width < options->height ? options->width : options->height;
    const int most = options->width > options->height ? options->width : options->height;
    if (least < MIN_SIDE || most > MAX_SIDE || options->margin < 0 ||
        4 * options->margin >= least) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "a silhouette of %d × %d pixels with a margin of %d; sides must be %d to "
                       "%d, the margin less than a quarter of them",
                       options->width, options->height, options->margin, MIN_SIDE, MAX_SIDE);
    }
    pvtStatus status = PVT_OK;
    for (size_t i = 0; status == PVT_OK && i < options->count; ++i) {
        status = pvtCheckDirection(context, i, options->directions[i]);
    }
    return status;
}

static pvtStatus DrawSoups(pvtContext* context, const pvtSilhouetteOptions* options,
                           const pvtSoup soups[2], pvtImage* images)
{
    SilhouetteTask task = {.context = context,
                           .options = options,
                           .original = &soups[0],
                           .occluder = &soups[1],
                           .images = images};
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < options->count && status == PVT_OK; ++i) {
        status = pvtCreateImage(context, options->width, options->height, &images[i]);
    }
    return status == PVT_OK ? RunTask(&task) : status;
}

pvtStatus pvtDrawSilhouettes(pvtContext* context, const pvtSilhouetteOptions* options,
                             const pvtMesh* original, const pvtMesh* occluder, pvtImage* images)
{
    for (size_t i = 0; i < options->count; ++i) {
        images[i] = (pvtImage){0};
    }
    pvtStatus status = CheckOptions(context, options);
    if (status == PVT_OK && original->triangleCount == 0) {
        status = pvtFail(context, PVT_INVALID_INPUT, "the original has no triangles to draw");
    }
    if (status != PVT_OK) {
        return status;
    }
    pvtBeginStage(context, "silhouettes");
    pvtSoup soups[2] = {0};
    status = pvtCreateSoup(context, "the original", original, &soups[0]);
    if (status == PVT_OK) {
        status = pvtCreateSoup(context, "the occluder", occluder, &soups[1]);
    }
    if (status == PVT_OK) {
        status = DrawSoups(context, options, soups, images);
    }
    pvtSoup_Free(context, &soups[0]);
    pvtSoup_Free(context, &soups[1]);
    for (size_t i = 0; status != PVT_OK && i < options->count; ++i) {
        pvtImage_Free(context, &images[i]);
    }
    return status;
}
