// SPDX-License-Identifier: MIT
// Exact Euclidean distances after Arnold Meijster, Jos B. T. M. Roerdink and Wim H. Hesselink, "A
// General Algorithm for Computing Distance Transforms in Linear Time" (ISMM 2000): distances along
// the columns first, then along each row the lower envelope of one parabola a column. Only the
// largest distance is asked for here: a row whose pixels are seen to be no farther off than what
// was found already needs no envelope, and on an envelope a stretch of pixels is farthest at one
// of its ends or of those of a parabola's reach.
#include "excess.h"

#include "base/bits.h"
#include "base/context.h"

#include <string.h>

enum {
    NO_DISTANCE = UINT16_MAX,
    MOST_PROBES = 16, // [px] to either side before the row's envelope is made
};

static const int64_t FAR_LEFT = -(INT64_C(1) << 40);

// One row of the occluder, in the original's pixels.
typedef struct ExcessRow {
    const uint16_t* distances; // of the original's row that is nearest to it
    int64_t beside;            // [px] how far above or below that row it lies
    int width;                 // of the original
    const uint64_t *own, *other;
    int firstWord, wordCount, otherWords; // own word w lies over word firstWord + w of other
} ExcessRow;

static bool IsEmpty(const pvtRaster* raster)
{
    const size_t words = raster->wordsPerRow * (size_t)raster->height;
    for (size_t i = 0; i < words; ++i) {
        if (raster->words[i] != 0) {
            return false;
        }
    }
    return true;
}

static pvtStatus Reserve(pvtContext* context, const pvtRaster* original, pvtExcessScratch* scratch)
{
    const size_t pixels = (size_t)original->width * (size_t)original->height;
    const size_t columns = (size_t)original->width;
    if (pixels <= scratch->distanceCapacity && columns <= scratch->siteCapacity) {
        return PVT_OK;
    }
    pvtExcessScratch_Free(context, scratch);
    scratch->distances = pvtAllocate(context, pixels, sizeof *scratch->distances);
    scratch->sites = pvtAllocate(context, columns, sizeof *scratch->sites);
    scratch->starts = pvtAllocate(context, columns, sizeof *scratch->starts);
    if (scratch->distances == NULL || scratch->sites == NULL || scratch->starts == NULL) {
        pvtExcessScratch_Free(context, scratch);
        return pvtContext_GetStatus(context);
    }
    scratch->distanceCapacity = pixels;
    scratch->siteCapacity = columns;
    return PVT_OK;
}

// One more pixel away than the row before it, or 0 where the pixel itself is covered.
static void StepColumns(const uint64_t* bits, int width, const uint16_t* before, uint16_t* after)
{
    for (int x = 0; x < width; ++x) {
        const uint16_t away = before[x] == NO_DISTANCE ? NO_DISTANCE : (uint16_t)(before[x] + 1);
        const uint16_t here = pvtGetBit(bits, (size_t)x) ? 0 : away;
        after[x] = here < after[x] ? here : after[x];
    }
}

static void MeasureColumns(const pvtRaster* original, uint16_t* distances)
{
    const size_t width = (size_t)original->width, rows = (size_t)original->height;
    if (IsEmpty(original)) {
        memset(distances, 0, width * rows * sizeof *distances);
        return;
    }
    memset(distances, 0xff, width * rows * sizeof *distances);
    for (size_t y = 0; y < rows; ++y) {
        uint16_t* row = distances + y * width;
        StepColumns(original->words + y * original->wordsPerRow, original->width,
                    y > 0 ? row - width : row, row);
    }
    for (size_t y = rows - 1; y-- > 0;) {
        uint16_t* row = distances + y * width;
        StepColumns(original->words + y * original->wordsPerRow, original->width, row + width, row);
    }
}

static uint64_t GetExcessWord(const ExcessRow* row, int word)
{
    const int other = row->firstWord + word;
    const bool over = row->other != NULL && other >= 0 && other < row->otherWords;
    return row->own[word] & ~(over ? row->other[other] : 0);
}

// Squared distance of column x from the site's pixel.
static int64_t GetDistance2(const ExcessRow* row, int site, int64_t x)
{
    const int64_t up = row->distances[site] + row->beside;
    return (x - site) * (x - site) + up * up;
}

// Whether some covered pixel close by is at most sqrt(limit2) away; it may be, and not be seen.
static bool IsSeenWithin(const ExcessRow* row, int64_t x, uint64_t limit2)
{
    for (int64_t d = 0; d <= MOST_PROBES && (uint64_t)(d * d) <= limit2; ++d) {
        for (int side = -1; side <= 1; side += 2) {
            const int64_t site = x + side * d;
            if (site >= 0 && site < row->width && row->distances[site] != NO_DISTANCE &&
                (uint64_t)GetDistance2(row, (int)site, x) <= limit2) {
                return true;
            }
        }
    }
    return false;
}

static bool IsRowSeenWithin(const ExcessRow* row, uint64_t limit2)
{
    for (int w = 0; w < row->wordCount; ++w) {
        for (uint64_t word = GetExcessWord(row, w); word != 0; word &= word - 1) {
            const int64_t x = ((int64_t)row->firstWord + w) * 64 + __builtin_ctzll(word);
            if (!IsSeenWithin(row, x, limit2)) {
                return false;
            }
        }
    }
    return true;
}

// The first column from which on `right` is nearer than `left`, a site to its left.
static int64_t FindStart(const ExcessRow* row, int left, int right)
{
    const int64_t a = GetDistance2(row, left, 0), b = GetDistance2(row, right, 0);
    return pvtDivideDown(b - a, 2 * ((int64_t)right - left)) + 1;
}

static int BuildEnvelope(const ExcessRow* row, pvtExcessScratch* scratch)
{
    int count = 0;
    for (int x = 0; x < row->width; ++x) {
        if (row->distances[x] == NO_DISTANCE) {
            continue;
        }
        int64_t start = FAR_LEFT;
        while (count > 0) {
            start = FindStart(row, scratch->sites[count - 1], x);
            if (start > scratch->starts[count - 1]) {
                break;
            }
            --count;
        }
        scratch->sites[count] = x;
        scratch->starts[count++] = start;
    }
    return count;
}

// The largest distance within columns begin to last, of which `first` is the site on the left;
// moves `first` to the site at `last`.
static uint64_t MeasureRun(const ExcessRow* row, const pvtExcessScratch* scratch, int count,
                           const int64_t run[2], int* first)
{
    int64_t most = 0;
    for (int64_t x = run[0];;) {
        while (*first + 1 < count && scratch->starts[*first + 1] <= x) {
            ++*first;
        }
        const int64_t stop = *first + 1 < count ? scratch->starts[*first + 1] - 1 : run[1];
        const int64_t last = stop < run[1] ? stop : run[1];
        const int64_t atFirst = GetDistance2(row, scratch->sites[*first], x);
        const int64_t atLast = GetDistance2(row, scratch->sites[*first], last);
        most = atFirst > most ? atFirst : most;
        most = atLast > most ? atLast : most;
        if (last == run[1]) {
            return (uint64_t)most;
        }
        x = last + 1;
    }
}

static uint64_t MeasureRow(const ExcessRow* row, pvtExcessScratch* scratch)
{
    const int count = BuildEnvelope(row, scratch);
    uint64_t most = 0;
    int first = 0;
    for (int w = 0; w < row->wordCount; ++w) {
        uint64_t word = GetExcessWord(row, w);
        while (word != 0) {
            const int begin = __builtin_ctzll(word);
            const uint64_t gap = ~(word >> begin);
            const int end = gap == 0 ? 64 : begin + __builtin_ctzll(gap);
            const int64_t x = ((int64_t)row->firstWord + w) * 64;
            const int64_t run[2] = {x + begin, x + end - 1};
            const uint64_t distance2 = MeasureRun(row, scratch, count, run, &first);
            most = distance2 > most ? distance2 : most;
            word &= ~pvtMakeMask((unsigned)begin, (unsigned)end);
        }
    }
    return most;
}

static ExcessRow GetRow(const pvtRasterPair* pair, int row, const pvtExcessScratch* scratch)
{
    const pvtRaster *original = pair->original, *occluder = pair->occluder;
    const int y = row + pair->y;
    const int near = y < 0 ? 0 : y >= original->height ? original->height - 1 : y;
    const size_t distances = (size_t)near * (size_t)original->width;
    return (ExcessRow){
        .distances = scratch->distances + distances,
        .beside = y < near ? near - y : y - near,
        .width = original->width,
        .own = occluder->words + (size_t)row * occluder->wordsPerRow,
        .other = y == near ? original->words + (size_t)y * original->wordsPerRow : NULL,
        .firstWord = pair->x / 64,
        .wordCount = (int)occluder->wordsPerRow,
        .otherWords = (int)original->wordsPerRow,
    };
}

static uint64_t CountRow(const ExcessRow* row)
{
    uint64_t count = 0;
    for (int w = 0; w < row->wordCount; ++w) {
        count += (uint64_t)pvtCountBits(GetExcessWord(row, w));
    }
    return count;
}

pvtStatus pvtMeasureExcess(pvtContext* context, const pvtRasterPair* pair,
                           pvtExcessScratch* scratch, pvtExcess* excess)
{
    *excess = (pvtExcess){0};
    pvtStatus status = Reserve(context, pair->original, scratch);
    for (int y = 0; y < pair->occluder->height && status == PVT_OK; ++y) {
        ExcessRow row = GetRow(pair, y, scratch);
        const uint64_t pixels = CountRow(&row);
        excess->pixels += pixels;
        if (pixels == 0) {
            continue;
        }
        if (!scratch->isReady) {
            MeasureColumns(pair->original, scratch->distances);
            scratch->isReady = true;
        }
        if (!IsRowSeenWithin(&row, excess->distance2)) {
            const uint64_t distance2 = MeasureRow(&row, scratch);
            excess->distance2 = distance2 > excess->distance2 ? distance2 : excess->distance2;
        }
        if (pvtIsCancelled(context)) {
            status = pvtFailCancelled(context);
        }
    }
    return status;
}

void pvtExcessScratch_Free(pvtContext* context, pvtExcessScratch* scratch)
{
    pvtRelease(context, scratch->distances);
    pvtRelease(context, scratch->sites);
    pvtRelease(context, scratch->starts);
    *scratch = (pvtExcessScratch){0};
}
