// SPDX-License-Identifier: MIT
// From a triangle with an alpha mask to ordinary polygons.
//
// Rows of opaque cells of the alpha map become runs, runs that are alike in consecutive rows become
// rectangles, and the triangle is clipped to each of them (Sutherland and Hodgman, "Reentrant
// Polygon Clipping", CACM 1974) in texture space, taking its positions along. Nothing is mapped
// back from the texture to the mesh, so texture coordinates may be as degenerate as they like.
//
// Runs are cut off at the box around the triangle, not at its edges: the two triangles of a card
// share the box, so that their pieces meet along the diagonal.
#include "mask_cut.h"

#include "base/context.h"
#include "base/vector.h"

#include <math.h>

// Beyond this a double no longer tells texels' cells apart.
static const double farthestTexel = 0x1p40;

// Cells looked at for one triangle; what covers more is looked at less closely.
static const double maxCells = 1 << 22;

enum { POLL_ROWS = 64, FIRST_ROOM = 64 };

typedef struct Cut {
    pvtContext* context;
    const pvtAlphaMap* map;
    const pvtCutRules* rules;
    const pvtMaskedTriangle* triangle;
    pvtPieceSet* set;
    int level;
    int64_t first[2], last[2]; // cells of the box around the triangle
    size_t runCounts[2];
} Cut;

// A polygon while it is clipped: four borders add a point each. Rounding could add more, where
// edges are hardly longer than it; such a polygon is dropped.
enum { CLIP_ROOM = 7 };

typedef struct ClipPoint {
    pvtVec3 position;
    double texel[2];
    int corner;
} ClipPoint;

typedef struct Polygon {
    ClipPoint points[CLIP_ROOM + 2];
    int count;
} Polygon;

void pvtPieceSet_Free(pvtContext* context, pvtPieceSet* set)
{
    pvtRelease(context, set->pieces);
    pvtRelease(context, set->points);
    pvtRelease(context, set->breaks);
    pvtRelease(context, set->runs[0]);
    pvtRelease(context, set->runs[1]);
    *set = (pvtPieceSet){0};
}

static bool IsBefore(const ClipPoint* a, const ClipPoint* b)
{
    return a->texel[0] < b->texel[0] || (a->texel[0] == b->texel[0] && a->texel[1] < b->texel[1]);
}

// Where a–b meets the border, the same to the last bit from either end.
static ClipPoint Meet(const ClipPoint* a, const ClipPoint* b, int axis, double border)
{
    if (IsBefore(b, a)) {
        const ClipPoint* swapped = a;
        a = b;
        b = swapped;
    }
    const double t = (border - a->texel[axis]) / (b->texel[axis] - a->texel[axis]);
    ClipPoint p = {.corner = -1};
    p.position = pvtAdd(a->position, pvtScale(pvtSub(b->position, a->position), t));
    p.texel[axis] = border;
    p.texel[1 - axis] = a->texel[1 - axis] + t * (b->texel[1 - axis] - a->texel[1 - axis]);
    return p;
}

// Keeps what lies on one side of a border: above it for `side` 1, below for −1.
static void Clip(Polygon* polygon, int axis, double border, double side)
{
    if (isinf(border)) {
        return;
    }
    Polygon kept = {.count = 0};
    for (int i = 0; i < polygon->count && kept.count <= CLIP_ROOM; ++i) {
        const ClipPoint* a = &polygon->points[i];
        const ClipPoint* b = &polygon->points[(i + 1) % polygon->count];
        const double da = side * (a->texel[axis] - border);
        const double db = side * (b->texel[axis] - border);
        if (da >= 0.0) {
            kept.points[kept.count++] = *a;
        }
        if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0)) {
            kept.points[kept.count++] = Meet(a, b, axis, border);
        }
    }
    kept.count = kept.count <= CLIP_ROOM ? kept.count : 0;
    *polygon = kept;
}

static Polygon GetTriangle(const pvtMaskedTriangle* triangle)
{
    Polygon polygon = {.count = 3};
    for (int i = 0; i < 3; ++i) {
        const pvtMaskedCorner* corner = &triangle->corners[i];
        polygon.points[i] = (ClipPoint){corner->position, {corner->texel[0], corner->texel[1]}, i};
    }
    return polygon;
}

// Room for one more element behind `count`.
static pvtStatus Grow(pvtContext* context, void** array, size_t count, size_t* room, size_t size)
{
    if (count < *room) {
        return PVT_OK;
    }
    const size_t wanted = *room == 0 ? FIRST_ROOM : 2 * *room;
    void* grown = pvtReallocate(context, *array, wanted, size);
    if (grown == NULL) {
        return pvtContext_GetStatus(context);
    }
    *array = grown;
    *room = wanted;
    return PVT_OK;
}

static pvtStatus AddPoint(Cut* cut, pvtVec3 position, int corner)
{
    pvtPieceSet* set = cut->set;
    void* points = set->points;
    const pvtStatus status =
        Grow(cut->context, &points, set->pointCount, &set->pointRoom, sizeof *set->points);
    set->points = points;
    if (status == PVT_OK) {
        set->points[set->pointCount++] = (pvtPiecePoint){position, corner};
    }
    return status;
}

static pvtStatus AddBreak(Cut* cut, int64_t column)
{
    pvtPieceSet* set = cut->set;
    void* breaks = set->breaks;
    const pvtStatus status =
        Grow(cut->context, &breaks, set->breakCount, &set->breakRoom, sizeof *set->breaks);
    set->breaks = breaks;
    if (status == PVT_OK) {
        set->breaks[set->breakCount++] = column;
    }
    return status;
}

// Where runs of a neighbouring row begin and end along a run. Rows are gone through from the left:
// `next` is the first of `others` that may still matter.
static pvtStatus FindBreaks(Cut* cut, const pvtAlphaRun* run, int others, size_t* next)
{
    const pvtAlphaRun* runs = cut->set->runs[others];
    const size_t count = cut->runCounts[others];
    while (*next < count && runs[*next].end <= run->begin) {
        ++*next;
    }
    pvtStatus status = PVT_OK;
    for (size_t i = *next; i < count && runs[i].begin < run->end && status == PVT_OK; ++i) {
        if (runs[i].begin > run->begin) {
            status = AddBreak(cut, runs[i].begin);
        }
        if (runs[i].end < run->end && status == PVT_OK) {
            status = AddBreak(cut, runs[i].end);
        }
    }
    return status;
}

// The breaks first to first + count − 1 on the edge a–b, from a on.
static pvtStatus AddBreakPoints(Cut* cut, const ClipPoint* a, const ClipPoint* b,
                                const pvtAlphaRun* range)
{
    const bool isRising = a->texel[0] < b->texel[0];
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < range->breakCount && status == PVT_OK; ++i) {
        const size_t at = range->firstBreak + (isRising ? i : range->breakCount - 1 - i);
        const double x = pvtAlphaMap_GetBorder(cut->map, 0, cut->level, cut->set->breaks[at]);
        if (x > fmin(a->texel[0], b->texel[0]) && x < fmax(a->texel[0], b->texel[0])) {
            status = AddPoint(cut, Meet(a, b, 0, x).position, -1);
        }
    }
    return status;
}

// `run` has the breaks along its first row's border, `above` those along its last one's.
static pvtStatus AddPiece(Cut* cut, const Polygon* polygon, const pvtAlphaRun* run,
                          const pvtAlphaRun* above)
{
    pvtPieceSet* set = cut->set;
    if (set->count == cut->rules->maxPieces) {
        set->isTooMany = true;
        return PVT_OK;
    }
    void* pieces = set->pieces;
    pvtStatus status =
        Grow(cut->context, &pieces, set->count, &set->pieceRoom, sizeof *set->pieces);
    set->pieces = pieces;
    const double low = pvtAlphaMap_GetBorder(cut->map, 1, cut->level, run->row);
    const double high = pvtAlphaMap_GetBorder(cut->map, 1, cut->level, above->row);
    const size_t first = set->pointCount;
    for (int i = 0; i < polygon->count && status == PVT_OK; ++i) {
        const ClipPoint* a = &polygon->points[i];
        const ClipPoint* b = &polygon->points[(i + 1) % polygon->count];
        status = AddPoint(cut, a->position, a->corner);
        if (status == PVT_OK && a->texel[1] == b->texel[1] &&
            (a->texel[1] == low || a->texel[1] == high)) {
            status = AddBreakPoints(cut, a, b, a->texel[1] == low ? run : above);
        }
    }
    if (status == PVT_OK) {
        set->pieces[set->count++] = (pvtPiece){first, set->pointCount - first};
    }
    return status;
}

// The part of the triangle in a run's columns, from the run's first row up to that of `above`.
static pvtStatus CutRun(Cut* cut, const pvtAlphaRun* run, const pvtAlphaRun* above)
{
    const pvtAlphaMap* map = cut->map;
    Polygon polygon = GetTriangle(cut->triangle);
    Clip(&polygon, 1, pvtAlphaMap_GetBorder(map, 1, cut->level, run->row), 1.0);
    Clip(&polygon, 1, pvtAlphaMap_GetBorder(map, 1, cut->level, above->row), -1.0);
    Clip(&polygon, 0, pvtAlphaMap_GetBorder(map, 0, cut->level, run->begin), 1.0);
    Clip(&polygon, 0, pvtAlphaMap_GetBorder(map, 0, cut->level, run->end), -1.0);
    return polygon.count >= 3 ? AddPiece(cut, &polygon, run, above) : PVT_OK;
}

// The opaque runs of a row within the box.
static void FindRuns(Cut* cut, int64_t row, int which)
{
    const pvtAlphaMap* map = cut->map;
    const size_t columns = map->columns[cut->level];
    const uint8_t* cells =
        map->levels[cut->level] + pvtAlphaMap_GetPlace(map, 1, cut->level, row) * columns;
    const int threshold = cut->triangle->threshold;
    pvtAlphaRun* runs = cut->set->runs[which];
    size_t count = 0;
    size_t place = pvtAlphaMap_GetPlace(map, 0, cut->level, cut->first[0]);
    bool wasOpaque = false;
    for (int64_t column = cut->first[0]; column <= cut->last[0]; ++column) {
        const bool isOpaque = cells[place] >= threshold;
        if (isOpaque && !wasOpaque) {
            runs[count] = (pvtAlphaRun){.begin = column, .end = column, .row = row};
        }
        if (!isOpaque && wasOpaque) {
            runs[count++].end = column;
        }
        wasOpaque = isOpaque;
        place = place + 1 == columns ? 0 : place + 1;
    }
    if (wasOpaque) {
        runs[count++].end = cut->last[0] + 1;
    }
    cut->runCounts[which] = count;
}

// A run of the row before that does not go on: with the breaks of this row along its last border.
static pvtStatus FinishRun(Cut* cut, const pvtAlphaRun* run, int64_t row, int which, size_t* next)
{
    pvtPieceSet* set = cut->set;
    pvtAlphaRun above = {.row = row, .firstBreak = set->breakCount};
    pvtStatus status = FindBreaks(cut, run, which, next);
    above.breakCount = set->breakCount - above.firstBreak;
    if (status == PVT_OK) {
        status = CutRun(cut, run, &above);
    }
    set->breakCount = above.firstBreak;
    return status;
}

// Runs of the row before that go on hand over what is known of them; the others are done.
static pvtStatus JoinRows(Cut* cut, int64_t row, int which)
{
    const pvtAlphaRun* before = cut->set->runs[1 - which];
    pvtAlphaRun* runs = cut->set->runs[which];
    size_t next = 0, nextAbove = 0, nextBelow = 0;
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < cut->runCounts[1 - which] && status == PVT_OK; ++i) {
        while (next < cut->runCounts[which] && runs[next].begin < before[i].begin) {
            ++next;
        }
        if (next < cut->runCounts[which] && runs[next].begin == before[i].begin &&
            runs[next].end == before[i].end) {
            runs[next] = before[i];
        } else {
            status = FinishRun(cut, &before[i], row, which, &nextAbove);
        }
    }
    for (size_t i = 0; i < cut->runCounts[which] && status == PVT_OK; ++i) {
        if (runs[i].row == row) {
            runs[i].firstBreak = cut->set->breakCount;
            status = FindBreaks(cut, &runs[i], 1 - which, &nextBelow);
            runs[i].breakCount = cut->set->breakCount - runs[i].firstBreak;
        }
    }
    return status;
}

static bool IsBoxOpaque(const Cut* cut)
{
    const pvtAlphaRun* run = cut->set->runs[cut->last[1] & 1];
    return cut->runCounts[cut->last[1] & 1] == 1 && run->row == cut->first[1] &&
           run->begin == cut->first[0] && run->end == cut->last[0] + 1;
}

static pvtStatus CutRows(Cut* cut)
{
    pvtPieceSet* set = cut->set;
    for (int64_t row = cut->first[1]; row <= cut->last[1]; ++row) {
        if ((row - cut->first[1]) % POLL_ROWS == 0 && pvtIsCancelled(cut->context)) {
            return pvtFailCancelled(cut->context);
        }
        FindRuns(cut, row, (int)(row & 1));
        const pvtStatus status = JoinRows(cut, row, (int)(row & 1));
        if (status != PVT_OK || set->isTooMany) {
            return status;
        }
    }
    if (IsBoxOpaque(cut)) {
        set->isWhole = true;
        return PVT_OK;
    }
    cut->runCounts[~cut->last[1] & 1] = 0;
    return JoinRows(cut, cut->last[1] + 1, (int)(~cut->last[1] & 1));
}

// How far one texel reaches on the mesh, along the axis on which it reaches farther.
static double GetTexelLength(const pvtMaskedTriangle* triangle)
{
    const pvtMaskedCorner* c = triangle->corners;
    const double u1 = c[1].texel[0] - c[0].texel[0], v1 = c[1].texel[1] - c[0].texel[1];
    const double u2 = c[2].texel[0] - c[0].texel[0], v2 = c[2].texel[1] - c[0].texel[1];
    const pvtVec3 e1 = pvtSub(c[1].position, c[0].position);
    const pvtVec3 e2 = pvtSub(c[2].position, c[0].position);
    const double area = fabs(u1 * v2 - u2 * v1);
    const double u = pvtLength3(pvtSub(pvtScale(e1, v2), pvtScale(e2, v1)));
    const double v = pvtLength3(pvtSub(pvtScale(e2, u1), pvtScale(e1, u2)));
    return fmax(u, v) / area;
}

static int FindLevel(const Cut* cut)
{
    const int last = cut->map->levelCount - 1;
    const double texels = cut->rules->cell / GetTexelLength(cut->triangle);
    int level = 0;
    // Not a number when texture and triangle are both degenerate: then the finest.
    while (level < last && ldexp(2.0, level) <= texels) {
        ++level;
    }
    level += cut->rules->extraLevels;
    return level < last ? level : last;
}

static void FindBox(Cut* cut)
{
    const pvtMaskedCorner* c = cut->triangle->corners;
    for (int axis = 0; axis < 2; ++axis) {
        const double a = c[0].texel[axis], b = c[1].texel[axis], d = c[2].texel[axis];
        const double least = fmin(a, fmin(b, d)), most = fmax(a, fmax(b, d));
        cut->first[axis] = pvtAlphaMap_FindCell(cut->map, axis, cut->level, least);
        cut->last[axis] = pvtAlphaMap_FindCell(cut->map, axis, cut->level, most);
    }
}

static double CountCells(const Cut* cut)
{
    return (double)(cut->last[0] - cut->first[0] + 1) * (double)(cut->last[1] - cut->first[1] + 1);
}

static pvtStatus ReserveRuns(Cut* cut)
{
    pvtPieceSet* set = cut->set;
    const size_t needed = (size_t)(cut->last[0] - cut->first[0]) / 2 + 1;
    if (needed <= set->runRoom) {
        return PVT_OK;
    }
    for (int i = 0; i < 2; ++i) {
        pvtAlphaRun* grown = pvtReallocate(cut->context, set->runs[i], needed, sizeof *grown);
        if (grown == NULL) {
            return pvtContext_GetStatus(cut->context);
        }
        set->runs[i] = grown;
    }
    set->runRoom = needed;
    return PVT_OK;
}

static bool AreTexelsNear(const pvtMaskedTriangle* triangle)
{
    for (int i = 0; i < 3; ++i) {
        for (int axis = 0; axis < 2; ++axis) {
            // False for NaN too.
            if (!(fabs(triangle->corners[i].texel[axis]) < farthestTexel)) {
                return false;
            }
        }
    }
    return true;
}

pvtStatus pvtCutMaskedTriangle(pvtContext* context, const pvtAlphaMap* map,
                               const pvtCutRules* rules, const pvtMaskedTriangle* triangle,
                               pvtPieceSet* set)
{
    set->count = set->pointCount = set->breakCount = 0;
    set->isTooMany = false;
    set->isWhole = map->least >= triangle->threshold;
    if (set->isWhole || map->most < triangle->threshold || !AreTexelsNear(triangle)) {
        return PVT_OK;
    }
    Cut cut = {.context = context, .map = map, .rules = rules, .triangle = triangle, .set = set};
    cut.level = FindLevel(&cut);
    FindBox(&cut);
    while (CountCells(&cut) > maxCells && cut.level < map->levelCount - 1) {
        ++cut.level;
        FindBox(&cut);
    }
    // The one cell of the last level is not opaque, wherever it is repeated.
    if (cut.level == map->levelCount - 1) {
        return PVT_OK;
    }
    set->cellCount += (size_t)CountCells(&cut);
    const pvtStatus status = ReserveRuns(&cut);
    return status == PVT_OK ? CutRows(&cut) : status;
}
