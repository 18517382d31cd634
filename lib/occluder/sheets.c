// SPDX-License-Identifier: MIT
// Planes that the surface lies on, found by drawing triangles at random, by area, growing each to
// the plane with most of the surface near it (after Schnabel, Wahl and Klein, Efficient RANSAC for
// Point-Cloud Shape Detection, 2007, whose scores are counts of points; here they are areas), and
// taking away what it covers. Only surface without strict interior behind it is drawn: elsewhere
// sections through the inside are as good, and lie behind what they stand for.
#include "sheets.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/random.h"
#include "base/vector.h"
#include "sheet_cover.h"
#include "voxel/dilate.h"

#include <math.h>
#include <string.h>

enum {
    BATCH = 8,
    MAX_IDLE = 4,
    BACKED_REACH = 6, // [vx²] how far from surface the strict interior counts as behind it
    SAMPLE_STEP = 4,  // [vx] between the points at which a triangle is looked at
    MAX_SAMPLES = 64, // along an edge
};

// Less of the surface than this part without interior behind it is not worth a search; and the
// search ends when less than that is left.
static const double MIN_SHARE = 0.01;
// Sheets smaller than this part of the largest are dropped, and those below so many [vx²].
static const double MIN_AREA_SHARE = 0.002;
static const double MIN_AREA = 4.0;
// A round that adds less than this part to what was gained so far is idle.
static const double MIN_ROUND_SHARE = 0.01;

void pvtSheetSet_Free(pvtContext* context, pvtSheetSet* set)
{
    for (size_t i = 0; i < set->count; ++i) {
        pvtBitmap_Free(context, &set->sheets[i].cells);
    }
    pvtRelease(context, set->sheets);
    *set = (pvtSheetSet){0};
}

static bool IsSamePlane(const pvtPlane* a, const pvtPlane* b)
{
    return a->axis == b->axis && a->slopeU == b->slopeU && a->slopeV == b->slopeV &&
           a->offset == b->offset;
}

const pvtSheet* pvtSheetSet_Find(const pvtSheetSet* set, const pvtPlane* plane)
{
    for (size_t i = 0; i < set->count; ++i) {
        if (IsSamePlane(&set->sheets[i].plane, plane)) {
            return &set->sheets[i];
        }
    }
    return NULL;
}

// Every bit of a row becomes `factor` bits.
static void AddWidened(const uint64_t* from, size_t words, size_t first, size_t factor,
                       uint64_t* to)
{
    for (size_t w = 0; w < words; ++w) {
        for (uint64_t bits = from[w]; bits != 0; bits &= bits - 1) {
            const size_t x = first + w * 64 + (size_t)__builtin_ctzll(bits);
            pvtSetBitRange(to, x * factor, (x + 1) * factor);
        }
    }
}

void pvtAddSheetCells(const pvtSheetSet* set, const pvtPlane* plane, int cellsPerVoxel,
                      pvtBitmap* slice)
{
    const pvtSheet* sheet = pvtSheetSet_Find(set, plane);
    if (sheet == NULL) {
        return;
    }
    const size_t factor = (size_t)(cellsPerVoxel / set->cellsPerVoxel);
    const pvtBitmap* cells = &sheet->cells;
    for (size_t y = 0; y < (size_t)cells->height * factor; ++y) {
        const uint64_t* from = cells->words + y / factor * cells->wordsPerRow;
        uint64_t* to = slice->words + (y + (size_t)sheet->corner[1] * factor) * slice->wordsPerRow;
        if (factor == 1) {
            for (size_t w = 0; w < cells->wordsPerRow; ++w) {
                to[w + (size_t)sheet->corner[0] / 64] |= from[w];
            }
        } else {
            AddWidened(from, cells->wordsPerRow, (size_t)sheet->corner[0], factor, to);
        }
    }
}

typedef struct Found {
    pvtSheet sheet;
    size_t triangle; // drawn
    pvtBitmap whole; // scratch
    pvtStatus status;
} Found;

typedef struct Search {
    pvtContext* context;
    const pvtSheetOptions* options;
    pvtSheetSoup soup;
    pvtBitGrid backed;  // what is near the strict interior; no words: nothing
    double* weights;    // one a triangle of the soup: area to be drawn; 0 once covered
    double total, left; // sums of weights
    double* sums;       // running, as of the last batch
    int cellsPerVoxel;
    Found found[BATCH];
    pvtSheetSet* set;
    double largest; // [vx²] of the sheets
    double gained;  // [vx²] by all sheets
} Search;

// What is near the strict interior.
static pvtStatus MarkBacked(pvtContext* context, const pvtSheetOptions* options, pvtBitGrid* backed)
{
    *backed = (pvtBitGrid){0};
    if (options->allowed == NULL) {
        return PVT_OK;
    }
    return pvtDilateGrid(context, options->allowed, BACKED_REACH, backed);
}

static bool IsBacked(const Search* search, pvtVec3 p)
{
    return search->backed.words != NULL &&
           pvtBitGrid_Get(&search->backed, (int)floor(p.x), (int)floor(p.y), (int)floor(p.z));
}

// The area of a triangle's part that has no interior behind it.
static double MeasureBare(const Search* search, size_t triangle)
{
    pvtVec3 corners[3];
    pvtSheetSoup_GetCorners(&search->soup, triangle, corners);
    const pvtVec3 u = pvtSub(corners[1], corners[0]);
    const pvtVec3 v = pvtSub(corners[2], corners[0]);
    const double longest = fmax(pvtLength3(u), fmax(pvtLength3(v), pvtLength3(pvtSub(u, v))));
    const int steps = (int)fmin(ceil(longest / SAMPLE_STEP), MAX_SAMPLES);
    int bare = 0;
    int seen = 0;
    // The middles of the small triangles that stand as the large one does.
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; i + j < steps; ++j) {
            const pvtVec3 p = pvtAdd(corners[0], pvtAdd(pvtScale(u, (i + 1.0 / 3.0) / steps),
                                                        pvtScale(v, (j + 1.0 / 3.0) / steps)));
            bare += IsBacked(search, p) ? 0 : 1;
            ++seen;
        }
    }
    return 0.5 * pvtLength3(pvtCross(u, v)) * bare / (seen > 0 ? seen : 1);
}

static void RunMeasure(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Search* search = taskData;
    for (size_t i = begin; i < end && !pvtIsCancelled(search->context); ++i) {
        search->weights[i] = MeasureBare(search, search->soup.triangles[i]);
    }
}

// The triangle that the weights up to it reach `at` of their sum with.
static size_t FindSum(const Search* search, double at)
{
    size_t low = 0;
    size_t high = search->soup.count - 1;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (search->sums[middle] > at) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

static void SumWeights(Search* search)
{
    double sum = 0.0;
    for (size_t i = 0; i < search->soup.count; ++i) {
        sum += search->weights[i];
        search->sums[i] = sum;
    }
    search->left = sum;
}

// Keeps the words and rows of the plane's cells that hold any.
static pvtStatus Crop(pvtContext* context, const pvtBitmap* whole, pvtSheet* sheet)
{
    size_t left = whole->wordsPerRow, right = 0;
    int top = whole->height, bottom = 0;
    for (int y = 0; y < whole->height; ++y) {
        const uint64_t* row = whole->words + (size_t)y * whole->wordsPerRow;
        for (size_t w = 0; w < whole->wordsPerRow; ++w) {
            if (row[w] != 0) {
                left = w < left ? w : left;
                right = w + 1 > right ? w + 1 : right;
                top = y < top ? y : top;
                bottom = y + 1;
            }
        }
    }
    const int width = (int)(right * 64) < whole->width ? (int)(right * 64) : whole->width;
    const pvtStatus status =
        pvtCreateBitmap(context, width - (int)left * 64, bottom - top, &sheet->cells);
    for (int y = top; y < bottom && status == PVT_OK; ++y) {
        memcpy(sheet->cells.words + (size_t)(y - top) * sheet->cells.wordsPerRow,
               whole->words + (size_t)y * whole->wordsPerRow + left,
               sheet->cells.wordsPerRow * sizeof *whole->words);
    }
    sheet->corner[0] = (int)left * 64;
    sheet->corner[1] = top;
    return status;
}

static pvtStatus FindSheet(const Search* search, Found* found)
{
    pvtContext* context = search->context;
    const pvtGridFrame* frame = &search->soup.frame;
    const pvtFlat flat = pvtFitFlat(&search->soup, search->soup.triangles[found->triangle],
                                    search->options->deviation);
    pvtSheet* sheet = &found->sheet;
    *sheet = (pvtSheet){0};
    sheet->plane = pvtMakePlane(frame, flat.normal,
                                pvtAdd(frame->origin, pvtScale(flat.center, frame->voxelSize)));
    const int width = frame->size[pvtPlane_GetU(&sheet->plane)] * search->cellsPerVoxel;
    const int height = frame->size[pvtPlane_GetV(&sheet->plane)] * search->cellsPerVoxel;
    pvtStatus status = PVT_OK;
    if (found->whole.width != width || found->whole.height != height) {
        pvtBitmap_Free(context, &found->whole);
        status = pvtCreateBitmap(context, width, height, &found->whole);
    }
    if (status == PVT_OK) {
        status = pvtCoverPlane(context, &search->soup, &sheet->plane, search->options->deviation,
                               search->cellsPerVoxel, &found->whole);
    }
    if (status == PVT_OK) {
        sheet->area = pvtMeasureSlice(&found->whole, &sheet->plane, search->cellsPerVoxel);
        status = sheet->area > MIN_AREA ? Crop(context, &found->whole, sheet) : PVT_OK;
    }
    return status;
}

static void RunFind(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Search* search = taskData;
    for (size_t i = begin; i < end; ++i) {
        Found* found = &search->found[i];
        found->status = pvtIsCancelled(search->context) ? PVT_CANCELLED : FindSheet(search, found);
    }
}

// Takes the triangles whose middle the sheet covers out of the draw; returns their bare area.
static double TakeCovered(Search* search, const Found* found)
{
    double taken = 0.0;
    const pvtPlane* plane = &found->sheet.plane;
    const double one = 1 << PVT_PLANE_BITS;
    const double reach = search->options->deviation;
    const pvtVec3 normal = pvtPlane_GetNormal(plane);
    const double offset = (double)plane->offset / one * pvtGetAxis(normal, (int)plane->axis);
    for (size_t c = 0; c < search->soup.chunkCount; ++c) {
        const pvtSheetSoupChunk* chunk = &search->soup.chunks[c];
        if (!pvtIsChunkNear(chunk, normal, offset, search->options->deviation)) {
            continue;
        }
        for (size_t i = chunk->begin; i < chunk->end; ++i) {
            pvtVec3 p[3];
            pvtSheetSoup_GetCorners(&search->soup, search->soup.triangles[i], p);
            const pvtVec3 middle = pvtScale(pvtAdd(pvtAdd(p[0], p[1]), p[2]), 1.0 / 3.0);
            const double u = pvtGetAxis(middle, (int)pvtPlane_GetU(plane));
            const double v = pvtGetAxis(middle, (int)pvtPlane_GetV(plane));
            const double height =
                ((double)plane->offset + plane->slopeU * u + plane->slopeV * v) / one;
            if (fabs(pvtGetAxis(middle, (int)plane->axis) - height) <= reach &&
                pvtBitmap_Get(&found->whole, (int)floor(u * search->cellsPerVoxel),
                              (int)floor(v * search->cellsPerVoxel))) {
                taken += search->weights[i];
                search->weights[i] = 0.0;
            }
        }
    }
    return taken;
}

// A sheet that came of one batch with another that covers the triangle it was drawn at is dropped.
static void KeepSheet(Search* search, Found* found)
{
    pvtSheetSet* set = search->set;
    const bool isNew = search->weights[found->triangle] > 0.0 && found->sheet.cells.words != NULL &&
                       found->sheet.area >= MIN_AREA_SHARE * search->largest &&
                       pvtSheetSet_Find(set, &found->sheet.plane) == NULL;
    found->sheet.gain = isNew ? TakeCovered(search, found) : 0.0;
    search->weights[found->triangle] = 0.0;
    if (found->sheet.gain > 0.0) {
        search->largest = fmax(search->largest, found->sheet.area);
        search->gained += found->sheet.gain;
        set->sheets[set->count++] = found->sheet;
        found->sheet.cells = (pvtBitmap){0};
    }
}

static pvtStatus RunBatch(pvtContext* context, Search* search, uint64_t number)
{
    pvtRandom random = pvtMakeRandom(search->options->seed, number);
    for (int i = 0; i < BATCH; ++i) {
        search->found[i].triangle = FindSum(search, pvtRandom_Unit(&random) * search->left);
    }
    pvtParallelFor(context, RunFind, BATCH, 1, search);
    pvtStatus status = PVT_OK;
    for (int i = 0; i < BATCH; ++i) {
        Found* found = &search->found[i];
        status = status == PVT_OK ? found->status : status;
        if (status == PVT_OK && search->set->count < (size_t)search->options->maxCount) {
            KeepSheet(search, found);
        }
        pvtBitmap_Free(context, &found->sheet.cells);
    }
    return status;
}

static pvtStatus RunSearch(pvtContext* context, Search* search)
{
    pvtParallelFor(context, RunMeasure, search->soup.count, 256, search);
    double whole = 0.0;
    for (size_t i = 0; i < search->soup.count; ++i) {
        pvtVec3 p[3];
        pvtSheetSoup_GetCorners(&search->soup, search->soup.triangles[i], p);
        whole += 0.5 * pvtLength3(pvtCross(pvtSub(p[1], p[0]), pvtSub(p[2], p[0])));
    }
    SumWeights(search);
    search->set->area = whole;
    search->set->bare = search->left;
    const double enough = MIN_SHARE * whole;
    // The search ends when a few rounds in a row have brought next to nothing.
    int idle = 0;
    pvtStatus status = PVT_OK;
    for (int b = 0; idle < MAX_IDLE && status == PVT_OK && search->left > enough &&
                    search->set->count < (size_t)search->options->maxCount;
         ++b) {
        const double before = search->gained;
        status = pvtIsCancelled(context) ? PVT_CANCELLED : RunBatch(context, search, (uint64_t)b);
        idle = search->gained - before < MIN_ROUND_SHARE * search->gained ? idle + 1 : 0;
        SumWeights(search);
        pvtReportProgress(context, 1.0 - (search->left - enough) / whole);
    }
    return status;
}

// Fine enough for four cells a voxel up to 640 voxels.
static int ChooseCells(const pvtGridFrame* frame)
{
    const int* size = frame->size;
    const int longest = (int)fmax(size[0], fmax(size[1], size[2]));
    return longest <= 660 ? 4 : longest <= 1320 ? 2 : 1;
}

static pvtStatus AllocateSearch(pvtContext* context, Search* search)
{
    search->weights = pvtAllocate(context, search->soup.count, sizeof *search->weights);
    search->sums = pvtAllocate(context, search->soup.count, sizeof *search->sums);
    search->set->sheets =
        pvtAllocate(context, (size_t)search->options->maxCount, sizeof *search->set->sheets);
    if (search->weights == NULL || search->sums == NULL || search->set->sheets == NULL) {
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

pvtStatus pvtFindSheets(pvtContext* context, const pvtSheetOptions* options, const pvtMesh* mesh,
                        const pvtGridFrame* frame, pvtSheetSet* set)
{
    *set = (pvtSheetSet){.cellsPerVoxel = options->deviation < 1.0 ? ChooseCells(frame) : 1};
    Search search = {
        .context = context, .options = options, .cellsPerVoxel = set->cellsPerVoxel, .set = set};
    pvtStatus status = pvtCreateSheetSoup(context, mesh, frame, &search.soup);
    if (status == PVT_OK && search.soup.count > 0) {
        status = MarkBacked(context, options, &search.backed);
        if (status == PVT_OK) {
            status = AllocateSearch(context, &search);
        }
        if (status == PVT_OK) {
            status = RunSearch(context, &search);
        }
    }
    for (int i = 0; i < BATCH; ++i) {
        pvtBitmap_Free(context, &search.found[i].whole);
    }
    pvtBitGrid_Free(context, &search.backed);
    pvtRelease(context, search.weights);
    pvtRelease(context, search.sums);
    pvtSheetSoup_Free(context, &search.soup);
    if (status != PVT_OK) {
        pvtSheetSet_Free(context, set);
        return status == PVT_CANCELLED ? pvtFailCancelled(context) : status;
    }
    return PVT_OK;
}
