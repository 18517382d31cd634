// SPDX-License-Identifier: MIT
// Loops around the set cells of a bitmap.
//
// After Silvennoinen et al., "Occluder Simplification Using Planar Sections", 2014, section 4.3,
// but not by stepping from edge to edge: corners are found 64 at a time from the words of two rows,
// and each corner is linked to the one beside it and the one below it as the rows go by. The time
// goes with the words and the corners; straight runs of boundary cost nothing.
#include "loops.h"

#include "base/bits.h"
#include "base/context.h"

static const uint32_t NONE = UINT32_MAX;

// The cells around a lattice point, 64 points a word: bit i speaks of point x0 + i.
typedef struct Around {
    uint64_t belowLeft, below, aboveLeft, above;
} Around;

// A corner of a loop. At a point where two set cells meet diagonally there are two.
typedef struct Corner {
    pvtPoint2 point; // [cells]
    uint32_t next;
    uint32_t loop;
    uint32_t left; // of a corner that may be a hole's first: the lower end of the edge to its left
} Corner;

typedef struct Tracer {
    const pvtBitmap* slice;
    size_t wordCount; // of a row of lattice points, one more than cells
    Corner* corners;
    uint32_t cornerCount;
    uint32_t* open;   // by x: the corner that the vertical edge reaching up from here began at
    uint32_t pending; // the corner that the horizontal edge reaching right from here began at
    uint32_t across, upright; // open and pending as they were before the point at hand
} Tracer;

static uint64_t GetWord(const pvtBitmap* slice, int row, size_t word)
{
    const bool isInside = row >= 0 && row < slice->height && word < slice->wordsPerRow;
    return isInside ? slice->words[(size_t)row * slice->wordsPerRow + word] : 0;
}

static uint64_t GetShiftedWord(const pvtBitmap* slice, int row, size_t word)
{
    const uint64_t carry = word > 0 ? GetWord(slice, row, word - 1) >> 63 : 0;
    return GetWord(slice, row, word) << 1 | carry;
}

static Around GetAround(const pvtBitmap* slice, int row, size_t word)
{
    return (Around){GetShiftedWord(slice, row - 1, word), GetWord(slice, row - 1, word),
                    GetShiftedWord(slice, row, word), GetWord(slice, row, word)};
}

// Points with a boundary edge both across and up or down.
static uint64_t FindTurns(const Around* around)
{
    const uint64_t across =
        (around->belowLeft ^ around->aboveLeft) | (around->below ^ around->above);
    const uint64_t upright =
        (around->belowLeft ^ around->below) | (around->aboveLeft ^ around->above);
    return across & upright;
}

// Points with all four edges: two set cells meet diagonally.
static uint64_t FindMeetings(const Around* around)
{
    return (around->belowLeft ^ around->aboveLeft) & (around->belowLeft ^ around->below) &
           (around->above ^ around->aboveLeft) & (around->above ^ around->below);
}

static size_t CountCorners(const Tracer* tracer)
{
    size_t count = 0;
    for (int y = 0; y <= tracer->slice->height; ++y) {
        for (size_t word = 0; word < tracer->wordCount; ++word) {
            const Around around = GetAround(tracer->slice, y, word);
            const uint64_t turns = FindTurns(&around);
            if (turns != 0) {
                count += (size_t)pvtCountBits(turns) + (size_t)pvtCountBits(FindMeetings(&around));
            }
        }
    }
    return count;
}

// The lower end of the nearest vertical edge left of point x that bounds row y of cells.
static uint32_t FindEdgeToLeft(const Tracer* tracer, int x, int y)
{
    size_t word = (size_t)x >> 6;
    uint64_t mask = pvtMakeMask(0, (unsigned)(x & 63));
    for (;; mask = ~UINT64_C(0)) {
        const uint64_t edges =
            (GetWord(tracer->slice, y, word) ^ GetShiftedWord(tracer->slice, y, word)) & mask;
        if (edges != 0) {
            return tracer->open[word * 64 + 63 - (size_t)__builtin_clzll(edges)];
        }
        --word; // the cell left of x is set, so that an edge comes before the row's end
    }
}

// Links two corners: set cells lie on the left of the way from the first to the second.
static void Link(Tracer* tracer, uint32_t from, uint32_t to, bool isForward)
{
    if (isForward) {
        tracer->corners[from].next = to;
    } else {
        tracer->corners[to].next = from;
    }
}

// A corner with one edge across, to the left or to the right, and one edge down or up.
static void AddCorner(Tracer* tracer, pvtPoint2 point, const bool cells[4], bool isLeft,
                      bool isDown)
{
    const bool belowLeft = cells[0], aboveLeft = cells[2], above = cells[3];
    const uint32_t corner = tracer->cornerCount++;
    tracer->corners[corner] = (Corner){point, NONE, NONE, NONE};
    if (isLeft) {
        Link(tracer, tracer->across, corner, aboveLeft);
    } else {
        tracer->pending = corner;
    }
    if (isDown) {
        Link(tracer, tracer->upright, corner, belowLeft);
    } else {
        tracer->open[point.x] = corner;
    }
    if (!isLeft && !isDown && !above) {
        tracer->corners[corner].left = FindEdgeToLeft(tracer, point.x, point.y);
    }
}

static void AddPoint(Tracer* tracer, pvtPoint2 point, const bool cells[4])
{
    const bool belowLeft = cells[0], below = cells[1], aboveLeft = cells[2], above = cells[3];
    tracer->across = tracer->pending;
    tracer->upright = tracer->open[point.x];
    if (belowLeft == above && below == aboveLeft) {
        // Each of the two set cells keeps its own two edges.
        AddCorner(tracer, point, cells, true, belowLeft);
        AddCorner(tracer, point, cells, false, !belowLeft);
        return;
    }
    AddCorner(tracer, point, cells, belowLeft != aboveLeft, belowLeft != below);
}

static void ScanRow(Tracer* tracer, int y)
{
    for (size_t word = 0; word < tracer->wordCount; ++word) {
        const Around around = GetAround(tracer->slice, y, word);
        for (uint64_t turns = FindTurns(&around); turns != 0; turns &= turns - 1) {
            const int bit = __builtin_ctzll(turns);
            const bool cells[4] = {around.belowLeft >> bit & 1, around.below >> bit & 1,
                                   around.aboveLeft >> bit & 1, around.above >> bit & 1};
            AddPoint(tracer, (pvtPoint2){(int32_t)(word * 64) + bit, y}, cells);
        }
    }
}

// A loop's first corner is the leftmost of its lowest. It is convex on outer loops, and on holes
// it is one that looked for the edge to its left: that edge belongs to a loop which began before.
static int32_t FindParent(const Tracer* tracer, const pvtLoopSet* contours, uint32_t first)
{
    const uint32_t left = tracer->corners[first].left;
    if (left == NONE) {
        return -1;
    }
    const int32_t beside = (int32_t)tracer->corners[left].loop;
    return contours->parents[beside] < 0 ? beside : contours->parents[beside];
}

static void CollectLoop(Tracer* tracer, uint32_t first, int32_t unit, pvtLoopSet* contours)
{
    const int32_t parent = FindParent(tracer, contours, first);
    uint32_t corner = first;
    do {
        Corner* at = &tracer->corners[corner];
        contours->points[contours->pointCount++] =
            (pvtPoint2){at->point.x * unit, at->point.y * unit};
        at->loop = (uint32_t)contours->loopCount;
        corner = at->next;
    } while (corner != first);
    pvtLoopSet_EndLoop(contours, parent);
}

// Loops in the order of their first corners. A loop has four corners or more.
static pvtStatus CollectLoops(pvtContext* context, Tracer* tracer, int32_t unit,
                              pvtLoopSet* contours)
{
    const size_t count = tracer->cornerCount;
    const pvtStatus status = pvtCreateLoopSet(context, count, count / 4, contours);
    if (status != PVT_OK) {
        return status;
    }
    for (uint32_t i = 0; i < count; ++i) {
        if (tracer->corners[i].loop == NONE) {
            CollectLoop(tracer, i, unit, contours);
        }
    }
    return PVT_OK;
}

static pvtStatus Trace(pvtContext* context, Tracer* tracer, int32_t unit, pvtLoopSet* contours)
{
    for (int y = 0; y <= tracer->slice->height; ++y) {
        if (y % 256 == 255 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        ScanRow(tracer, y);
    }
    return CollectLoops(context, tracer, unit, contours);
}

pvtStatus pvtTraceContours(pvtContext* context, const pvtBitmap* slice, int cellsPerVoxel,
                           pvtLoopSet* contours)
{
    *contours = (pvtLoopSet){0};
    if (cellsPerVoxel != 1 && cellsPerVoxel != 2 && cellsPerVoxel != 4) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "cellsPerVoxel is %d; it must be 1, 2 or 4",
                       cellsPerVoxel);
    }
    Tracer tracer = {.slice = slice, .wordCount = pvtGetWordCount((size_t)slice->width + 1)};
    const size_t count = CountCorners(&tracer);
    if (count >= NONE) {
        return pvtFail(context, PVT_LIMIT, "%zu corners in one slice", count);
    }
    tracer.corners = pvtAllocate(context, count, sizeof *tracer.corners);
    tracer.open = pvtAllocate(context, tracer.wordCount * 64, sizeof *tracer.open);
    const int32_t unit = (1 << PVT_POINT_BITS) / cellsPerVoxel;
    const pvtStatus status = tracer.corners != NULL && tracer.open != NULL
                                 ? Trace(context, &tracer, unit, contours)
                                 : pvtContext_GetStatus(context);
    pvtRelease(context, tracer.corners);
    pvtRelease(context, tracer.open);
    return status;
}
