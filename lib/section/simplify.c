// SPDX-License-Identifier: MIT
// Loops with fewer points.
//
// After Ramer, "An Iterative Procedure for the Polygonal Approximation of Plane Curves", 1972, and
// Douglas and Peucker, 1973, on closed loops, split at two far points. A chord is refused, and its
// stretch split further, unless it shares no point with any edge of the loops before, its own
// stretch aside, and the pocket between the two holds no loop. Then chords cannot cross each other
// either: one that did would have to leave the other's pocket through the stretch or the chord.
#include "base/context.h"
#include "cover.h"
#include "loops.h"
#include "pocket.h"
#include "segments.h"

static const uint32_t NONE = UINT32_MAX;

// Lengths in the plane [point units]: |(u, v)|² = uu × u² + 2 uv × u × v + vv × v².
typedef struct Metric {
    double uu, uv, vv;
} Metric;

typedef struct Stretch {
    size_t first, last;
} Stretch;

typedef struct Simplifier {
    const pvtSimplifyOptions* options;
    const pvtLoopSet* contours;
    Metric metric;
    double tolerance2; // [point units squared]
    int32_t cellUnit;  // of the guard
    pvtSegmentGrid grid;
    uint32_t* loopHeads; // by square: a loop whose first point lies in it
    uint32_t* loopNext;  // one a loop
    bool* isKept;        // one a point
    bool* isDropped;     // one a loop
    Stretch* stack;
    size_t stackCount;
    pvtPocketScratch scratch;
} Simplifier;

// A chord held against the edges near it.
typedef struct ChordCheck {
    const pvtLoopSet* contours;
    const pvtSegmentGrid* grid;
    const pvtPocket* pocket;
    size_t begin; // of the loop's points
    pvtPoint2 from, to;
} ChordCheck;

pvtSimplifyOptions pvtDefaultSimplifyOptions(void)
{
    return (pvtSimplifyOptions){.tolerance = 1.0, .cellsPerVoxel = 1};
}

static Metric MakeMetric(const pvtPlane* plane)
{
    const double one = (double)(1 << PVT_PLANE_BITS);
    const double a = plane != NULL ? plane->slopeU / one : 0.0;
    const double b = plane != NULL ? plane->slopeV / one : 0.0;
    return (Metric){1.0 + a * a, a * b, 1.0 + b * b};
}

static double Multiply(const Metric* metric, double u1, double v1, double u2, double v2)
{
    return metric->uu * u1 * u2 + metric->uv * (u1 * v2 + v1 * u2) + metric->vv * v1 * v2;
}

// From a point to the closed segment from a to b.
static double GetDistance2(const Metric* metric, pvtPoint2 point, pvtPoint2 a, pvtPoint2 b)
{
    const double u = (double)point.x - a.x, v = (double)point.y - a.y;
    const double alongU = (double)b.x - a.x, alongV = (double)b.y - a.y;
    const double length2 = Multiply(metric, alongU, alongV, alongU, alongV);
    double t = 0.0;
    if (length2 > 0.0) {
        t = Multiply(metric, u, v, alongU, alongV) / length2;
        t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
    }
    const double offU = u - t * alongU, offV = v - t * alongV;
    return Multiply(metric, offU, offV, offU, offV);
}

static pvtPocket GetPocket(const Simplifier* simplifier, size_t loop, Stretch stretch)
{
    const size_t begin = simplifier->contours->starts[loop];
    return (pvtPocket){simplifier->contours->points + begin,
                       pvtLoopSet_GetSize(simplifier->contours, loop), stretch.first, stretch.last};
}

// The point of a stretch farthest from its chord; the middle one when all lie on it.
static size_t FindFarthest(const Simplifier* simplifier, const pvtPocket* pocket, double* distance2)
{
    const pvtPoint2 from = pvtPocket_GetPoint(pocket, pocket->first);
    const pvtPoint2 to = pvtPocket_GetPoint(pocket, pocket->last);
    size_t farthest = (pocket->first + pocket->last) / 2;
    *distance2 = 0.0;
    for (size_t i = pocket->first + 1; i < pocket->last; ++i) {
        const double at =
            GetDistance2(&simplifier->metric, pvtPocket_GetPoint(pocket, i), from, to);
        if (at > *distance2) {
            *distance2 = at;
            farthest = i;
        }
    }
    return farthest;
}

// Where other edges touch an end of the chord, the chord must leave within the angle of its own
// loop: what touches lies outside that angle, and its chords stay in angles of their own.
static bool LeavesWithin(const pvtPocket* pocket, size_t end, pvtPoint2 target)
{
    const pvtPass pass = {pvtPocket_GetPoint(pocket, (end + pocket->count - 1) % pocket->count),
                          pvtPocket_GetPoint(pocket, end % pocket->count),
                          pvtPocket_GetPoint(pocket, (end + 1) % pocket->count)};
    const bool isAlongAfter = pvtOrient(pass.at, pass.after, target) == 0 &&
                              pvtDotEdges(pass.at, pass.after, pass.at, target) > 0;
    const bool isAlongBefore = pvtOrient(pass.at, pass.before, target) == 0 &&
                               pvtDotEdges(pass.at, pass.before, pass.at, target) > 0;
    return isAlongAfter || isAlongBefore || pvtPass_IsInside(&pass, target);
}

// True when an edge that shares an end with the chord stands against it.
static bool IsRefusedAtEnd(const ChordCheck* check, size_t end, pvtPoint2 other, bool isNeighbour)
{
    const bool isFirst = end == check->pocket->first;
    const pvtPoint2 at = isFirst ? check->from : check->to;
    const pvtPoint2 far = isFirst ? check->to : check->from;
    const bool runsAlong = pvtOrient(at, far, other) == 0 && pvtDotEdges(at, far, at, other) > 0;
    return runsAlong || (!isNeighbour && !LeavesWithin(check->pocket, end, far));
}

static bool IsRefused(void* user, uint32_t number)
{
    const ChordCheck* check = user;
    const pvtPocket* pocket = check->pocket;
    const pvtSegment edge = check->grid->segments[number];
    bool isNeighbour = false;
    if (number >= check->begin && number < check->begin + pocket->count) {
        const size_t past = (number - check->begin + pocket->count - pocket->first) % pocket->count;
        if (past < pocket->last - pocket->first) {
            return false; // of the stretch itself
        }
        isNeighbour = past == pocket->last - pocket->first || past == pocket->count - 1;
    }
    for (int i = 0; i < 4; ++i) {
        const pvtPoint2 shared = i < 2 ? edge.from : edge.to;
        const pvtPoint2 other = i < 2 ? edge.to : edge.from;
        if (pvtIsSamePoint(shared, i % 2 == 0 ? check->from : check->to)) {
            const size_t end = i % 2 == 0 ? pocket->first : pocket->last;
            return IsRefusedAtEnd(check, end, other, isNeighbour);
        }
    }
    return pvtSegmentsMeet(check->from, check->to, edge.from, edge.to);
}

static bool IsFree(const Simplifier* simplifier, size_t loop, const pvtPocket* pocket)
{
    ChordCheck check = {simplifier->contours,
                        &simplifier->grid,
                        pocket,
                        simplifier->contours->starts[loop],
                        pvtPocket_GetPoint(pocket, pocket->first),
                        pvtPocket_GetPoint(pocket, pocket->last)};
    return !pvtSegmentGrid_Visit(&simplifier->grid, (pvtSegment){check.from, check.to}, IsRefused,
                                 &check);
}

// The squares that a pocket's box meets.
static pvtSquareRange GetSquares(const Simplifier* simplifier, const pvtPocket* pocket)
{
    pvtSquareRange range = {INT32_MAX, INT32_MIN, INT32_MAX, INT32_MIN};
    for (size_t i = pocket->first; i <= pocket->last; ++i) {
        const pvtPoint2 at = pvtPocket_GetPoint(pocket, i);
        const int32_t column = pvtSegmentGrid_GetColumn(&simplifier->grid, at.x);
        const int32_t row = pvtSegmentGrid_GetRow(&simplifier->grid, at.y);
        range.left = column < range.left ? column : range.left;
        range.right = column > range.right ? column : range.right;
        range.bottom = row < range.bottom ? row : range.bottom;
        range.top = row > range.top ? row : range.top;
    }
    return range;
}

// A loop, or the rest of this one, that the pocket holds. No edge crosses the pocket's border, so
// that one point of each tells.
static bool HoldsLoop(const Simplifier* simplifier, size_t loop, const pvtPocket* pocket)
{
    if (pocket->last - pocket->first + 1 < pocket->count &&
        pvtPocket_Holds(pocket, pvtPocket_GetPoint(pocket, (pocket->last + 1) % pocket->count))) {
        return true;
    }
    const pvtSquareRange range = GetSquares(simplifier, pocket);
    for (int32_t row = range.bottom; row <= range.top; ++row) {
        for (int32_t column = range.left; column <= range.right; ++column) {
            const size_t square = (size_t)row * (size_t)simplifier->grid.columns + (size_t)column;
            uint32_t other = simplifier->loopHeads[square];
            for (; other != NONE; other = simplifier->loopNext[other]) {
                const size_t begin = simplifier->contours->starts[other];
                if (other != loop && pvtPocket_Holds(pocket, simplifier->contours->points[begin])) {
                    return true;
                }
            }
        }
    }
    return false;
}

static pvtStatus CheckGuard(pvtContext* context, Simplifier* simplifier, const pvtPocket* pocket,
                            bool* isGuarded)
{
    *isGuarded = true;
    const pvtBitmap* guard = simplifier->options->guard;
    if (guard == NULL) {
        return PVT_OK;
    }
    const pvtPoint2 from = pvtPocket_GetPoint(pocket, pocket->first);
    const pvtPoint2 to = pvtPocket_GetPoint(pocket, pocket->last);
    if (!pvtIsSegmentCovered(guard, simplifier->cellUnit, from, to)) {
        *isGuarded = false;
        return PVT_OK;
    }
    return pvtPocket_IsCovered(context, pocket, guard, simplifier->cellUnit, &simplifier->scratch,
                               isGuarded);
}

static pvtStatus CheckChord(pvtContext* context, Simplifier* simplifier, size_t loop,
                            Stretch stretch, bool* isAllowed)
{
    const pvtPocket pocket = GetPocket(simplifier, loop, stretch);
    *isAllowed = false;
    if (!IsFree(simplifier, loop, &pocket) || HoldsLoop(simplifier, loop, &pocket)) {
        return PVT_OK;
    }
    return CheckGuard(context, simplifier, &pocket, isAllowed);
}

static void Push(Simplifier* simplifier, size_t first, size_t last)
{
    simplifier->stack[simplifier->stackCount++] = (Stretch){first, last};
}

// Keeps a point within a stretch, and leaves both sides of it to be looked at.
static void Split(Simplifier* simplifier, size_t loop, Stretch stretch, size_t at)
{
    const size_t begin = simplifier->contours->starts[loop];
    const size_t count = pvtLoopSet_GetSize(simplifier->contours, loop);
    simplifier->isKept[begin + at % count] = true;
    Push(simplifier, at, stretch.last);
    Push(simplifier, stretch.first, at);
}

static pvtStatus SplitAll(pvtContext* context, Simplifier* simplifier, size_t loop)
{
    while (simplifier->stackCount > 0) {
        const Stretch stretch = simplifier->stack[--simplifier->stackCount];
        if (stretch.last - stretch.first < 2) {
            continue;
        }
        if (stretch.last - stretch.first > 1000 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        const pvtPocket pocket = GetPocket(simplifier, loop, stretch);
        double distance2;
        const size_t farthest = FindFarthest(simplifier, &pocket, &distance2);
        bool isAllowed = false;
        if (distance2 <= simplifier->tolerance2) {
            const pvtStatus status = CheckChord(context, simplifier, loop, stretch, &isAllowed);
            if (status != PVT_OK) {
                return status;
            }
        }
        if (!isAllowed) {
            Split(simplifier, loop, stretch, farthest);
        }
    }
    return PVT_OK;
}

// The point farthest from a given one of the same loop.
static size_t FindOpposite(const Simplifier* simplifier, size_t loop, size_t from)
{
    const pvtPocket whole = GetPocket(
        simplifier, loop, (Stretch){from, from + pvtLoopSet_GetSize(simplifier->contours, loop)});
    double distance2;
    return FindFarthest(simplifier, &whole, &distance2) % whole.count;
}

static size_t CountKept(const Simplifier* simplifier, size_t loop)
{
    size_t count = 0;
    for (size_t i = simplifier->contours->starts[loop]; i < simplifier->contours->starts[loop + 1];
         ++i) {
        count += simplifier->isKept[i];
    }
    return count;
}

// A hole that is nowhere farther from one line than the tolerance may go, if nothing is in it and
// the guard has its cells.
static pvtStatus CheckHole(pvtContext* context, Simplifier* simplifier, size_t loop, bool* mayGo)
{
    *mayGo = false;
    const size_t count = pvtLoopSet_GetSize(simplifier->contours, loop);
    const pvtPocket whole = GetPocket(simplifier, loop, (Stretch){0, count - 1});
    if (simplifier->contours->parents[loop] < 0 || HoldsLoop(simplifier, loop, &whole)) {
        return PVT_OK;
    }
    return CheckGuard(context, simplifier, &whole, mayGo);
}

// Both halves of the loop came down to the line between two points. A third is kept unless the
// loop is a hole that may go.
static pvtStatus SaveThin(pvtContext* context, Simplifier* simplifier, size_t loop, Stretch half)
{
    const size_t count = pvtLoopSet_GetSize(simplifier->contours, loop);
    const Stretch halves[2] = {half, {half.last, half.first + count}};
    bool mayGo = false;
    const pvtStatus status = CheckHole(context, simplifier, loop, &mayGo);
    if (status != PVT_OK) {
        return status;
    }
    double most = 0.0;
    size_t farthest = 0;
    int side = 0;
    for (int i = 0; i < 2; ++i) {
        const pvtPocket pocket = GetPocket(simplifier, loop, halves[i]);
        double distance2;
        const size_t at = FindFarthest(simplifier, &pocket, &distance2);
        if (distance2 > most) {
            most = distance2;
            farthest = at;
            side = i;
        }
    }
    simplifier->isDropped[loop] = mayGo;
    if (!simplifier->isDropped[loop]) {
        Split(simplifier, loop, halves[side], farthest);
    }
    return SplitAll(context, simplifier, loop);
}

// The next kept point of a loop after point `at`, counted from the loop's first.
static size_t FindKept(const Simplifier* simplifier, size_t loop, size_t at)
{
    const size_t begin = simplifier->contours->starts[loop];
    const size_t count = pvtLoopSet_GetSize(simplifier->contours, loop);
    do {
        at = at + 1 < count ? at + 1 : 0;
    } while (!simplifier->isKept[begin + at]);
    return at;
}

// Where a loop touches itself, a lobe may have come down to the line out and back: it goes.
static void CutSpikes(Simplifier* simplifier, size_t loop)
{
    const pvtPoint2* points = simplifier->contours->points + simplifier->contours->starts[loop];
    bool* isKept = simplifier->isKept + simplifier->contours->starts[loop];
    size_t left = CountKept(simplifier, loop);
    size_t at = FindKept(simplifier, loop, 0);
    for (size_t unchanged = 0; unchanged < left && left >= 3;) {
        const size_t tip = FindKept(simplifier, loop, at);
        const size_t back = FindKept(simplifier, loop, tip);
        if (pvtIsSamePoint(points[at], points[back])) {
            isKept[tip] = isKept[back] = false;
            left -= 2;
            unchanged = 0;
        } else {
            ++unchanged;
            at = tip;
        }
    }
    simplifier->isDropped[loop] = simplifier->isDropped[loop] || left < 3;
}

static pvtStatus SimplifyLoop(pvtContext* context, Simplifier* simplifier, size_t loop)
{
    const size_t begin = simplifier->contours->starts[loop];
    const size_t count = pvtLoopSet_GetSize(simplifier->contours, loop);
    const int32_t parent = simplifier->contours->parents[loop];
    if (count < 3 || pvtGetLoopArea2(simplifier->contours->points + begin, count) == 0 ||
        (parent >= 0 && simplifier->isDropped[parent])) {
        simplifier->isDropped[loop] = true;
        return PVT_OK;
    }
    const size_t far = FindOpposite(simplifier, loop, 0);
    const size_t opposite = FindOpposite(simplifier, loop, far);
    const Stretch half = far < opposite ? (Stretch){far, opposite} : (Stretch){opposite, far};
    simplifier->isKept[begin + far] = simplifier->isKept[begin + opposite] = true;
    Push(simplifier, half.last, half.first + count);
    Push(simplifier, half.first, half.last);
    pvtStatus status = SplitAll(context, simplifier, loop);
    if (status == PVT_OK && CountKept(simplifier, loop) < 3) {
        status = SaveThin(context, simplifier, loop, half);
    }
    CutSpikes(simplifier, loop);
    return status;
}

static void CollectLoop(Simplifier* simplifier, size_t loop, uint32_t* numbers,
                        pvtLoopSet* simplified)
{
    const pvtLoopSet* contours = simplifier->contours;
    const int32_t parent = contours->parents[loop];
    if (simplifier->isDropped[loop] || (parent >= 0 && simplifier->isDropped[parent])) {
        return;
    }
    for (size_t i = contours->starts[loop]; i < contours->starts[loop + 1]; ++i) {
        if (simplifier->isKept[i]) {
            simplified->points[simplified->pointCount++] = contours->points[i];
        }
    }
    numbers[loop] = (uint32_t)simplified->loopCount;
    pvtLoopSet_EndLoop(simplified, parent);
}

static pvtStatus Collect(pvtContext* context, Simplifier* simplifier, pvtLoopSet* simplified)
{
    const pvtLoopSet* contours = simplifier->contours;
    size_t points = 0;
    for (size_t i = 0; i < contours->pointCount; ++i) {
        points += simplifier->isKept[i];
    }
    const pvtStatus status = pvtCreateLoopSet(context, points, contours->loopCount, simplified);
    if (status != PVT_OK) {
        return status;
    }
    uint32_t* numbers = simplifier->loopNext; // no longer needed for what it was
    for (size_t l = 0; l < contours->loopCount; ++l) {
        CollectLoop(simplifier, l, numbers, simplified);
    }
    for (size_t l = 0; l < simplified->loopCount; ++l) {
        if (simplified->parents[l] >= 0) {
            simplified->parents[l] = (int32_t)numbers[simplified->parents[l]];
        }
    }
    return PVT_OK;
}

static void FileLoops(Simplifier* simplifier)
{
    const pvtLoopSet* contours = simplifier->contours;
    const size_t squares = (size_t)simplifier->grid.columns * (size_t)simplifier->grid.rows;
    for (size_t i = 0; i < squares; ++i) {
        simplifier->loopHeads[i] = NONE;
    }
    for (size_t l = 0; l < contours->loopCount; ++l) {
        if (pvtLoopSet_GetSize(contours, l) == 0) {
            continue;
        }
        const pvtPoint2 at = contours->points[contours->starts[l]];
        const int32_t column = pvtSegmentGrid_GetColumn(&simplifier->grid, at.x);
        const int32_t row = pvtSegmentGrid_GetRow(&simplifier->grid, at.y);
        uint32_t* head =
            &simplifier->loopHeads[(size_t)row * (size_t)simplifier->grid.columns + (size_t)column];
        simplifier->loopNext[l] = *head;
        *head = (uint32_t)l;
    }
}

static pvtStatus CreateSimplifier(pvtContext* context, Simplifier* simplifier)
{
    const pvtLoopSet* contours = simplifier->contours;
    const pvtStatus status = pvtCreateSegmentGrid(context, contours, 0, &simplifier->grid);
    if (status != PVT_OK) {
        return status;
    }
    const size_t squares = (size_t)simplifier->grid.columns * (size_t)simplifier->grid.rows;
    simplifier->loopHeads = pvtAllocate(context, squares, sizeof *simplifier->loopHeads);
    simplifier->loopNext = pvtAllocate(context, contours->loopCount, sizeof *simplifier->loopNext);
    simplifier->isKept = pvtAllocate(context, contours->pointCount, sizeof *simplifier->isKept);
    simplifier->isDropped =
        pvtAllocate(context, contours->loopCount, sizeof *simplifier->isDropped);
    // A stretch is split in two, and each has points of its own: never more than there are points.
    simplifier->stack = pvtAllocate(context, contours->pointCount + 2, sizeof *simplifier->stack);
    if (simplifier->loopHeads == NULL || simplifier->loopNext == NULL ||
        simplifier->isKept == NULL || simplifier->isDropped == NULL || simplifier->stack == NULL) {
        return pvtContext_GetStatus(context);
    }
    FileLoops(simplifier);
    return PVT_OK;
}

static void FreeSimplifier(pvtContext* context, Simplifier* simplifier)
{
    pvtSegmentGrid_Free(context, &simplifier->grid);
    pvtRelease(context, simplifier->loopHeads);
    pvtRelease(context, simplifier->loopNext);
    pvtRelease(context, simplifier->isKept);
    pvtRelease(context, simplifier->isDropped);
    pvtRelease(context, simplifier->stack);
    pvtRelease(context, simplifier->scratch.crossings);
}

static pvtStatus CheckOptions(pvtContext* context, const pvtSimplifyOptions* options)
{
    const int cells = options->cellsPerVoxel;
    if (!(options->tolerance >= 0.0)) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "tolerance is %g; it must be 0 or more",
                       options->tolerance);
    }
    if (options->guard != NULL && cells != 1 && cells != 2 && cells != 4) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "cellsPerVoxel is %d; it must be 1, 2 or 4",
                       cells);
    }
    return PVT_OK;
}

pvtStatus pvtSimplifyContours(pvtContext* context, const pvtSimplifyOptions* options,
                              const pvtLoopSet* contours, pvtLoopSet* simplified)
{
    *simplified = (pvtLoopSet){0};
    pvtStatus status = CheckOptions(context, options);
    if (status != PVT_OK) {
        return status;
    }
    const double tolerance = options->tolerance * (1 << PVT_POINT_BITS);
    Simplifier simplifier = {.options = options,
                             .contours = contours,
                             .metric = MakeMetric(options->plane),
                             .tolerance2 = tolerance * tolerance};
    if (options->guard != NULL) {
        simplifier.cellUnit = (1 << PVT_POINT_BITS) / options->cellsPerVoxel;
    }
    status = CreateSimplifier(context, &simplifier);
    for (size_t l = 0; l < contours->loopCount && status == PVT_OK; ++l) {
        status = SimplifyLoop(context, &simplifier, l);
    }
    if (status == PVT_OK) {
        status = Collect(context, &simplifier, simplified);
    }
    FreeSimplifier(context, &simplifier);
    return status;
}
