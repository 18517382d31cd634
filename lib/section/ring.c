// SPDX-License-Identifier: MIT
#include "ring.h"

#include "base/context.h"

static const uint32_t NONE = UINT32_MAX;

// Lanes looked at together before any of them is looked at alone.
enum { BLOCK = 16 };

// The bounds of a triangle.
typedef struct Box {
    int32_t left, right, bottom, top;
} Box;

pvtStatus pvtCreateRing(pvtContext* context, size_t capacity, size_t nodeCapacity, pvtRing* ring)
{
    *ring = (pvtRing){
        .nodes = pvtAllocate(context, nodeCapacity, sizeof *ring->nodes),
        .xs = pvtAllocate(context, capacity + BLOCK, sizeof *ring->xs),
        .ys = pvtAllocate(context, capacity + BLOCK, sizeof *ring->ys),
        .nextXs = pvtAllocate(context, capacity + BLOCK, sizeof *ring->nextXs),
        .nextYs = pvtAllocate(context, capacity + BLOCK, sizeof *ring->nextYs),
        .owners = pvtAllocate(context, capacity, sizeof *ring->owners),
    };
    if (ring->nodes == NULL || ring->xs == NULL || ring->ys == NULL || ring->nextXs == NULL ||
        ring->nextYs == NULL || ring->owners == NULL) {
        pvtRing_Free(context, ring);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

void pvtRing_Free(pvtContext* context, pvtRing* ring)
{
    pvtRelease(context, ring->nodes);
    pvtRelease(context, ring->xs);
    pvtRelease(context, ring->ys);
    pvtRelease(context, ring->nextXs);
    pvtRelease(context, ring->nextYs);
    pvtRelease(context, ring->owners);
    *ring = (pvtRing){0};
}

static void SetNext(pvtRing* ring, uint32_t node, pvtPoint2 next)
{
    ring->nextXs[ring->nodes[node].lane] = next.x;
    ring->nextYs[ring->nodes[node].lane] = next.y;
}

static void SetLane(pvtRing* ring, uint32_t lane, uint32_t node)
{
    ring->nodes[node].lane = lane;
    ring->xs[lane] = ring->nodes[node].point.x;
    ring->ys[lane] = ring->nodes[node].point.y;
    ring->owners[lane] = node;
    SetNext(ring, node, ring->nodes[ring->nodes[node].after].point);
}

// Lanes past the last are looked at with their block: nothing reaches as far as they lie.
static void EndLanes(pvtRing* ring)
{
    for (uint32_t lane = ring->count; lane < ring->count + BLOCK; ++lane) {
        ring->xs[lane] = ring->nextXs[lane] = INT32_MAX;
    }
}

void pvtRing_Reset(pvtRing* ring, const pvtPoint2* points, size_t count)
{
    const uint32_t last = (uint32_t)count - 1;
    ring->count = ring->nodeCount = (uint32_t)count;
    for (uint32_t i = 0; i <= last; ++i) {
        ring->nodes[i] = (pvtRingNode){points[i], i == 0 ? last : i - 1, i == last ? 0 : i + 1, i};
    }
    for (uint32_t i = 0; i <= last; ++i) {
        SetLane(ring, i, i);
    }
    EndLanes(ring);
}

void pvtRing_Remove(pvtRing* ring, uint32_t node)
{
    const pvtRingNode* gone = &ring->nodes[node];
    ring->nodes[gone->before].after = gone->after;
    ring->nodes[gone->after].before = gone->before;
    SetNext(ring, gone->before, ring->nodes[gone->after].point);
    SetLane(ring, gone->lane, ring->owners[--ring->count]);
    ring->xs[ring->count] = ring->nextXs[ring->count] = INT32_MAX;
}

uint32_t pvtRing_InsertAfter(pvtRing* ring, uint32_t node, pvtPoint2 point)
{
    const uint32_t made = ring->nodeCount++;
    const uint32_t after = ring->nodes[node].after;
    ring->nodes[made] = (pvtRingNode){point, node, after, 0};
    ring->nodes[node].after = made;
    ring->nodes[after].before = made;
    SetNext(ring, node, point);
    SetLane(ring, ring->count++, made);
    return made;
}

pvtPass pvtRing_GetPass(const pvtRing* ring, uint32_t node)
{
    const pvtRingNode* at = &ring->nodes[node];
    return (pvtPass){ring->nodes[at->before].point, at->point, ring->nodes[at->after].point};
}

static Box GetBox(const pvtPoint2 corners[3])
{
    Box box = {corners[0].x, corners[0].x, corners[0].y, corners[0].y};
    for (int i = 1; i < 3; ++i) {
        box.left = corners[i].x < box.left ? corners[i].x : box.left;
        box.right = corners[i].x > box.right ? corners[i].x : box.right;
        box.bottom = corners[i].y < box.bottom ? corners[i].y : box.bottom;
        box.top = corners[i].y > box.top ? corners[i].y : box.top;
    }
    return box;
}

static bool IsBlockInBox(const pvtRing* ring, const Box* box, uint32_t first)
{
    const int32_t* xs = ring->xs + first;
    const int32_t* ys = ring->ys + first;
    int found = 0;
    for (int i = 0; i < BLOCK; ++i) {
        found |= (xs[i] >= box->left) & (xs[i] <= box->right) & (ys[i] >= box->bottom) &
                 (ys[i] <= box->top);
    }
    return found != 0;
}

// The next lane from `lane` on whose point lies in the box; ring->count when there is none.
static uint32_t FindInBox(const pvtRing* ring, const Box* box, uint32_t lane)
{
    for (; lane < ring->count; ++lane) {
        if (lane % BLOCK == 0) {
            while (lane < ring->count && !IsBlockInBox(ring, box, lane)) {
                lane += BLOCK;
            }
            if (lane >= ring->count) {
                break;
            }
        }
        const int32_t x = ring->xs[lane], y = ring->ys[lane];
        if (x >= box->left && x <= box->right && y >= box->bottom && y <= box->top) {
            return lane;
        }
    }
    return ring->count;
}

uint32_t pvtRing_FindBlocker(const pvtRing* ring, const pvtEar* ear, uint32_t node)
{
    const Box box = GetBox(ear->corners);
    for (uint32_t lane = FindInBox(ring, &box, 0); lane < ring->count;
         lane = FindInBox(ring, &box, lane + 1)) {
        const uint32_t other = ring->owners[lane];
        const pvtPass pass = pvtRing_GetPass(ring, other);
        if (other != node && pvtEar_IsBlocked(ear, &pass)) {
            return other;
        }
    }
    return NONE;
}

uint32_t pvtRing_FindPoint(const pvtRing* ring, const pvtPoint2 corners[3],
                           const uint32_t except[4])
{
    const Box box = GetBox(corners);
    for (uint32_t lane = FindInBox(ring, &box, 0); lane < ring->count;
         lane = FindInBox(ring, &box, lane + 1)) {
        const uint32_t other = ring->owners[lane];
        const pvtPoint2 at = ring->nodes[other].point;
        const bool isInside = pvtOrient(corners[0], corners[1], at) >= 0 &&
                              pvtOrient(corners[1], corners[2], at) >= 0 &&
                              pvtOrient(corners[2], corners[0], at) >= 0;
        if (isInside && other != except[0] && other != except[1] && other != except[2] &&
            other != except[3]) {
            return other;
        }
    }
    return NONE;
}

static int32_t Min(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int32_t Max(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

// True when some of the edges' own boxes meet the box.
static bool DoEdgesMeetBox(const pvtRing* ring, const Box* box, uint32_t first)
{
    const int32_t *xs = ring->xs + first, *ys = ring->ys + first;
    const int32_t *nextXs = ring->nextXs + first, *nextYs = ring->nextYs + first;
    int found = 0;
    for (int i = 0; i < BLOCK; ++i) {
        const int isWithinX = Max(xs[i], nextXs[i]) >= box->left;
        const int isBeforeX = Min(xs[i], nextXs[i]) <= box->right;
        const int isWithinY = Max(ys[i], nextYs[i]) >= box->bottom;
        const int isBeforeY = Min(ys[i], nextYs[i]) <= box->top;
        found |= isWithinX & isBeforeX & isWithinY & isBeforeY;
    }
    return found != 0;
}

uint32_t pvtRing_FindEdge(const pvtRing* ring, pvtPoint2 a, pvtPoint2 b, const uint32_t except[3])
{
    const Box box = {Min(a.x, b.x), Max(a.x, b.x), Min(a.y, b.y), Max(a.y, b.y)};
    for (uint32_t first = 0; first < ring->count; first += BLOCK) {
        if (!DoEdgesMeetBox(ring, &box, first)) {
            continue;
        }
        for (uint32_t lane = first; lane < ring->count && lane < first + BLOCK; ++lane) {
            const uint32_t node = ring->owners[lane];
            const pvtPoint2 from = {ring->xs[lane], ring->ys[lane]};
            const pvtPoint2 to = {ring->nextXs[lane], ring->nextYs[lane]};
            if (node != except[0] && node != except[1] && node != except[2] &&
                pvtSegmentsMeet(a, b, from, to)) {
                return node;
            }
        }
    }
    return NONE;
}
