// SPDX-License-Identifier: MIT
// The first, long part of a chain: from a raw contour of thousands of points to a few hundred.
//
// After Silvennoinen et al., "Occluder Simplification Using Planar Sections", 2014, section 4.4.
// The points of a contour lie at cell corners. One bit a corner tells where points are left, so
// that a triangle is free when the words of its rows are clear, and a step costs next to nothing.
#include "lattice.h"

#include "base/bits.h"
#include "base/context.h"
#include "cover.h"
#include "ear.h"

#include <assert.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

// Removes what has no area before anything else.
static const int64_t FREE_COST = INT64_MIN;

// Corners of one row, from the first to the last; none when last < first.
typedef struct PlaceRange {
    int64_t first, last;
} PlaceRange;

int32_t pvtFindLatticeUnit(const pvtPoint2* points, size_t count)
{
    uint32_t bits = 0;
    for (size_t i = 0; i < count; ++i) {
        bits |= (uint32_t)points[i].x | (uint32_t)points[i].y;
    }
    return bits % 256 == 0 ? 256 : bits % 128 == 0 ? 128 : bits % 64 == 0 ? 64 : 0;
}

typedef struct Box {
    pvtPoint2 low, high;
} Box;

static Box GetBox(const pvtPoint2* points, size_t count)
{
    Box box = {points[0], points[0]};
    for (size_t i = 1; i < count; ++i) {
        box.low.x = points[i].x < box.low.x ? points[i].x : box.low.x;
        box.low.y = points[i].y < box.low.y ? points[i].y : box.low.y;
        box.high.x = points[i].x > box.high.x ? points[i].x : box.high.x;
        box.high.y = points[i].y > box.high.y ? points[i].y : box.high.y;
    }
    return box;
}

// At most half full.
static size_t GetTableSize(size_t count)
{
    size_t size = 64;
    while (size < 2 * count) {
        size *= 2;
    }
    return size;
}

pvtStatus pvtCreateLattice(pvtContext* context, const pvtLoopSet* polygons, uint32_t target,
                           pvtLattice* lattice)
{
    assert(target >= 3);
    size_t most = 0, words = 0;
    for (size_t l = 0; l < polygons->loopCount; ++l) {
        const pvtPoint2* points = polygons->points + polygons->starts[l];
        const size_t count = polygons->starts[l + 1] - polygons->starts[l];
        const int32_t unit = pvtFindLatticeUnit(points, count);
        if (count <= target || unit == 0) {
            continue;
        }
        const Box box = GetBox(points, count);
        const size_t across = pvtGetWordCount((size_t)((box.high.x - box.low.x) / unit) + 1);
        const size_t rows = (size_t)((box.high.y - box.low.y) / unit) + 1;
        most = count > most ? count : most;
        words = across * rows > words ? across * rows : words;
    }
    *lattice = (pvtLattice){.target = target};
    const pvtStatus status = pvtCreateQueue(context, most, most, &lattice->queue);
    if (status != PVT_OK) {
        return status;
    }
    lattice->nodes = pvtAllocate(context, most, sizeof *lattice->nodes);
    lattice->bits = pvtAllocate(context, words, sizeof *lattice->bits);
    lattice->table = pvtAllocate(context, GetTableSize(most), sizeof *lattice->table);
    if (lattice->nodes == NULL || lattice->bits == NULL || lattice->table == NULL) {
        pvtLattice_Free(context, lattice);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

void pvtLattice_Free(pvtContext* context, pvtLattice* lattice)
{
    pvtRelease(context, lattice->nodes);
    pvtRelease(context, lattice->bits);
    pvtRelease(context, lattice->table);
    pvtQueue_Free(context, &lattice->queue);
    *lattice = (pvtLattice){0};
}

static uint64_t* GetRow(const pvtLattice* lattice, int64_t y)
{
    return lattice->bits + (size_t)y * lattice->wordsPerRow;
}

static void SetTaken(pvtLattice* lattice, pvtPoint2 place, bool isTaken)
{
    uint64_t* row = GetRow(lattice, place.y);
    if (isTaken) {
        pvtSetBit(row, (size_t)place.x);
    } else {
        pvtClearBit(row, (size_t)place.x);
    }
}

// The entry of the place, or the empty one where it belongs.
static uint32_t* FindEntry(const pvtLattice* lattice, pvtPoint2 place)
{
    const size_t mask = lattice->tableSize - 1;
    uint32_t hash = (uint32_t)place.x * 0x9E3779B1u + (uint32_t)place.y * 0x85EBCA77u;
    hash ^= hash >> 15;
    for (size_t i = hash & mask;; i = (i + 1) & mask) {
        uint32_t* entry = &lattice->table[i];
        if (*entry == 0 || pvtIsSamePoint(lattice->nodes[*entry - 1].point, place)) {
            return entry;
        }
    }
}

static void EnterPlace(pvtLattice* lattice, uint32_t node)
{
    pvtLatticeNode* made = &lattice->nodes[node];
    made->twinBefore = made->twinAfter = node;
    uint32_t* entry = FindEntry(lattice, made->point);
    if (*entry != 0) {
        pvtLatticeNode* twin = &lattice->nodes[*entry - 1];
        made->twinAfter = *entry - 1;
        made->twinBefore = twin->twinBefore;
        lattice->nodes[twin->twinBefore].twinAfter = node;
        twin->twinBefore = node;
    }
    *entry = node + 1;
    SetTaken(lattice, made->point, true);
}

static void LeavePlace(pvtLattice* lattice, uint32_t node)
{
    const pvtLatticeNode* gone = &lattice->nodes[node];
    if (gone->twinAfter == node) {
        SetTaken(lattice, gone->point, false); // the table is not asked where no bit is set
        return;
    }
    lattice->nodes[gone->twinBefore].twinAfter = gone->twinAfter;
    lattice->nodes[gone->twinAfter].twinBefore = gone->twinBefore;
    uint32_t* entry = FindEntry(lattice, gone->point);
    *entry = gone->twinAfter + 1;
}

static void Load(pvtLattice* lattice, const pvtPoint2* points, size_t count)
{
    const Box box = GetBox(points, count);
    const int32_t unit = pvtFindLatticeUnit(points, count);
    assert(unit > 0);
    const size_t rows = (size_t)((box.high.y - box.low.y) / unit) + 1;
    const uint32_t last = (uint32_t)count - 1;
    lattice->wordsPerRow = pvtGetWordCount((size_t)((box.high.x - box.low.x) / unit) + 1);
    lattice->tableSize = GetTableSize(count);
    lattice->origin = box.low;
    lattice->unit = unit;
    lattice->count = (uint32_t)count;
    lattice->allowsPinch = false;
    memset(lattice->bits, 0, rows * lattice->wordsPerRow * sizeof *lattice->bits);
    memset(lattice->table, 0, lattice->tableSize * sizeof *lattice->table);
    pvtQueue_Reset(&lattice->queue, count, count);
    for (uint32_t i = 0; i <= last; ++i) {
        const pvtPoint2 place = {(points[i].x - box.low.x) / unit,
                                 (points[i].y - box.low.y) / unit};
        lattice->nodes[i] =
            (pvtLatticeNode){place, i == 0 ? last : i - 1, i == last ? 0 : i + 1, i, i};
        EnterPlace(lattice, i);
    }
}

static pvtPass GetPass(const pvtLattice* lattice, uint32_t node)
{
    const pvtLatticeNode* at = &lattice->nodes[node];
    return (pvtPass){lattice->nodes[at->before].point, at->point, lattice->nodes[at->after].point};
}

// The places of a row in the closed triangle.
static PlaceRange GetPlaces(const pvtEar* ear, int64_t y)
{
    PlaceRange range = {INT64_MAX, INT64_MIN};
    for (int i = 0; i < 3; ++i) {
        const pvtPoint2 p = ear->corners[i], q = ear->corners[i == 2 ? 0 : i + 1];
        const pvtPoint2 lower = p.y < q.y ? p : q, upper = p.y < q.y ? q : p;
        if (lower.y == upper.y || y < lower.y || y > upper.y) {
            continue; // the ends of a level edge are ends of the other two edges as well
        }
        const int64_t height = upper.y - lower.y;
        const int64_t rise = ((int64_t)upper.x - lower.x) * (y - lower.y);
        const int64_t whole = pvtFloorDivide(rise, height);
        const int64_t x = lower.x + whole;
        range.first = pvtMinInt64(range.first, whole * height == rise ? x : x + 1);
        range.last = pvtMaxInt64(range.last, x);
    }
    return range;
}

// Of all points at a place, one that blocks the ear.
static uint32_t FindBlockerAt(const pvtLattice* lattice, const pvtEar* ear, uint32_t first,
                              uint32_t node)
{
    uint32_t twin = first;
    do {
        const pvtPass pass = GetPass(lattice, twin);
        if (twin != node && pvtEar_IsBlocked(ear, &pass)) {
            return twin;
        }
        twin = lattice->nodes[twin].twinAfter;
    } while (twin != first);
    return NONE;
}

static uint32_t FindBlockerInRow(const pvtLattice* lattice, const pvtEar* ear, int64_t y,
                                 uint32_t node)
{
    const PlaceRange range = GetPlaces(ear, y);
    const uint64_t* row = GetRow(lattice, y);
    for (int64_t begin = range.first; begin <= range.last; begin = (begin | 63) + 1) {
        const int64_t end = pvtMinInt64(range.last, begin | 63) + 1;
        const size_t word = (size_t)begin >> 6;
        uint64_t taken =
            row[word] & pvtMakeMask((unsigned)(begin & 63), (unsigned)(end - (int64_t)word * 64));
        for (; taken != 0; taken &= taken - 1) {
            const pvtPoint2 place = {(int32_t)(word * 64) + __builtin_ctzll(taken), (int32_t)y};
            const uint32_t first = *FindEntry(lattice, place) - 1;
            const uint32_t blocker = FindBlockerAt(lattice, ear, first, node);
            if (blocker != NONE) {
                return blocker;
            }
        }
    }
    return NONE;
}

static uint32_t FindBlockerInRows(const pvtLattice* lattice, const pvtEar* ear, uint32_t node)
{
    const int32_t y0 = ear->corners[0].y, y1 = ear->corners[1].y, y2 = ear->corners[2].y;
    const int64_t low = pvtMinInt64(y0, pvtMinInt64(y1, y2));
    const int64_t high = pvtMaxInt64(y0, pvtMaxInt64(y1, y2));
    for (int64_t y = low; y <= high; ++y) {
        const uint32_t blocker = FindBlockerInRow(lattice, ear, y, node);
        if (blocker != NONE) {
            return blocker;
        }
    }
    return NONE;
}

// A point that keeps `node` from being taken out. The ear's own corners lie in its triangle: their
// bits are put out while the rows are looked at, and only their twins are asked.
static uint32_t FindBlocker(pvtLattice* lattice, const pvtEar* ear, uint32_t node)
{
    const pvtLatticeNode* nodes = lattice->nodes;
    const uint32_t corners[3] = {nodes[node].before, node, nodes[node].after};
    for (int i = 0; i < 3; ++i) {
        if (nodes[corners[i]].twinAfter != corners[i]) {
            const uint32_t blocker = FindBlockerAt(lattice, ear, corners[i], node);
            if (blocker != NONE) {
                return blocker;
            }
        }
    }
    for (int i = 0; i < 3; ++i) {
        SetTaken(lattice, nodes[corners[i]].point, false);
    }
    const uint32_t blocker = FindBlockerInRows(lattice, ear, node);
    for (int i = 0; i < 3; ++i) {
        SetTaken(lattice, nodes[corners[i]].point, true);
    }
    return blocker;
}

static pvtPoint2 GetPoint(const pvtLattice* lattice, pvtPoint2 place)
{
    return (pvtPoint2){lattice->origin.x + place.x * lattice->unit,
                       lattice->origin.y + place.y * lattice->unit};
}

static bool IsCovered(const pvtLattice* lattice, const pvtPass* pass)
{
    const pvtPoint2 corners[3] = {GetPoint(lattice, pass->before), GetPoint(lattice, pass->at),
                                  GetPoint(lattice, pass->after)};
    return lattice->cells != NULL &&
           pvtIsTriangleCovered(lattice->cells, lattice->cellUnit, corners);
}

// The area that goes when the point goes; what a reflex point adds counts as gained. Once edges
// may run through points it is no longer known what lies on their right.
static void Score(pvtLattice* lattice, uint32_t node)
{
    const pvtPass pass = GetPass(lattice, node);
    const int64_t area2 = pvtOrient(pass.before, pass.at, pass.after);
    if (area2 < 0 && (lattice->allowsPinch || !IsCovered(lattice, &pass))) {
        pvtQueue_Drop(&lattice->queue, node);
        return;
    }
    pvtQueue_Push(&lattice->queue, node, area2 == 0 ? FREE_COST : area2);
}

static void ScoreAll(pvtLattice* lattice, uint32_t anyNode)
{
    uint32_t node = anyNode;
    do {
        Score(lattice, node);
        node = lattice->nodes[node].after;
    } while (node != anyNode);
}

// A point on a straight way where the boundary touches itself stays as long as it does, so that
// points touch points only, never edges. Where that cannot be helped it may go.
static bool IsPointOfContact(const pvtLattice* lattice, uint32_t node, const pvtPass* pass)
{
    return !lattice->allowsPinch && lattice->nodes[node].twinAfter != node &&
           pvtDotEdges(pass->at, pass->before, pass->at, pass->after) < 0;
}

static bool FindStep(pvtLattice* lattice, uint32_t* node)
{
    while (pvtQueue_Pop(&lattice->queue, node)) {
        const pvtPass pass = GetPass(lattice, *node);
        if (pvtOrient(pass.before, pass.at, pass.after) == 0) {
            if (!IsPointOfContact(lattice, *node, &pass)) {
                return true;
            }
            pvtQueue_Wait(&lattice->queue, *node, lattice->nodes[*node].twinAfter);
            continue;
        }
        const pvtEar ear = pvtMakeEar(pass.before, pass.at, pass.after, lattice->allowsPinch);
        const uint32_t blocker = FindBlocker(lattice, &ear, *node);
        if (blocker == NONE) {
            return true;
        }
        pvtQueue_Wait(&lattice->queue, *node, blocker);
    }
    return false;
}

// As FindStep, with another look at those that wait: their blockers may have turned away without
// going.
static bool FindStepAnyhow(pvtLattice* lattice, uint32_t anyNode, uint32_t* node)
{
    if (FindStep(lattice, node)) {
        return true;
    }
    ScoreAll(lattice, anyNode);
    if (FindStep(lattice, node)) {
        return true;
    }
    lattice->allowsPinch = true;
    ScoreAll(lattice, anyNode);
    return FindStep(lattice, node);
}

// Returns a node that is left.
static uint32_t TakeOut(pvtLattice* lattice, uint32_t node)
{
    const pvtLatticeNode gone = lattice->nodes[node];
    LeavePlace(lattice, node);
    lattice->nodes[gone.before].after = gone.after;
    lattice->nodes[gone.after].before = gone.before;
    --lattice->count;
    pvtQueue_Drop(&lattice->queue, node);
    pvtQueue_Wake(&lattice->queue, node);
    Score(lattice, gone.before);
    Score(lattice, gone.after);
    return gone.after;
}

static void Collect(const pvtLattice* lattice, uint32_t anyNode, pvtPoint2* reduced)
{
    // Nodes are numbered in order: begin at the lowest that is left.
    uint32_t node = anyNode;
    for (; lattice->nodes[node].before < node; node = lattice->nodes[node].before) {
    }
    for (uint32_t i = 0; i < lattice->count; ++i, node = lattice->nodes[node].after) {
        reduced[i] = GetPoint(lattice, lattice->nodes[node].point);
    }
}

pvtStatus pvtLattice_Reduce(pvtContext* context, pvtLattice* lattice, const pvtPoint2* points,
                            size_t count, pvtPoint2* reduced)
{
    Load(lattice, points, count);
    uint32_t anyNode = 0, node = 0;
    ScoreAll(lattice, anyNode);
    while (lattice->count > lattice->target && FindStepAnyhow(lattice, anyNode, &node)) {
        if (lattice->count % 4096 == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        anyNode = TakeOut(lattice, node);
    }
    Collect(lattice, anyNode, reduced);
    return PVT_OK;
}
