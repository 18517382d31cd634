// SPDX-License-Identifier: MIT
// Triangles of a weakly simple polygon.
//
// After Meisters, "Polygons Have Ears", 1975: any polygon with more than three points has two that
// can be cut off. Here the ear whose least angle is greatest goes first. An ear may not have
// another point on its border, so that points along a straight side become corners of real
// triangles; only when no such ear is left may a new edge run through points, and only then may a
// point go whose triangle has no area.
#include "queue.h"
#include "ring.h"

#include "base/context.h"

#include <math.h>

// Comes after every ear with an area.
static const int64_t DEGENERATE_COST = 1;

typedef struct Clipper {
    pvtRing ring;
    pvtQueue queue;
    bool allowsPinch;
} Clipper;

// The sine of the least angle, −2^40 for 1: twice the area over the two longer sides.
static int64_t GetShapeCost(pvtPoint2 a, pvtPoint2 b, pvtPoint2 c, int64_t area2)
{
    const double ab = (double)pvtGetDistance2(a, b);
    const double bc = (double)pvtGetDistance2(b, c);
    const double ca = (double)pvtGetDistance2(c, a);
    const double least = fmin(ab, fmin(bc, ca));
    const double longer = sqrt(ab * bc * ca / least);
    return -(int64_t)(0x1p40 * ((double)area2 / longer));
}

static void Score(Clipper* clipper, uint32_t node)
{
    const pvtPass pass = pvtRing_GetPass(&clipper->ring, node);
    const int64_t area2 = pvtOrient(pass.before, pass.at, pass.after);
    if (area2 < 0) {
        pvtQueue_Drop(&clipper->queue, node);
        return;
    }
    const int64_t cost =
        area2 == 0 ? DEGENERATE_COST : GetShapeCost(pass.before, pass.at, pass.after, area2);
    pvtQueue_Push(&clipper->queue, node, cost);
}

static void ScoreAll(Clipper* clipper)
{
    for (uint32_t lane = 0; lane < clipper->ring.count; ++lane) {
        Score(clipper, clipper->ring.owners[lane]);
    }
}

// The next point to cut off; false when there is none.
static bool FindEar(Clipper* clipper, uint32_t* node)
{
    while (pvtQueue_Pop(&clipper->queue, node)) {
        const pvtPass pass = pvtRing_GetPass(&clipper->ring, *node);
        if (pvtOrient(pass.before, pass.at, pass.after) == 0) {
            if (clipper->allowsPinch) {
                return true;
            }
            pvtQueue_Push(&clipper->queue, *node, DEGENERATE_COST);
            return false;
        }
        const pvtEar ear = pvtMakeEar(pass.before, pass.at, pass.after, clipper->allowsPinch);
        const uint32_t blocker = pvtRing_FindBlocker(&clipper->ring, &ear, *node);
        if (blocker == UINT32_MAX) {
            return true;
        }
        pvtQueue_Wait(&clipper->queue, *node, blocker);
    }
    return false;
}

// As FindEar, with another look at those that wait, first as strictly as before.
static bool FindEarAnyhow(Clipper* clipper, uint32_t* node)
{
    if (FindEar(clipper, node)) {
        return true;
    }
    ScoreAll(clipper);
    if (FindEar(clipper, node)) {
        return true;
    }
    clipper->allowsPinch = true;
    ScoreAll(clipper);
    return FindEar(clipper, node);
}

static void Clip(Clipper* clipper, uint32_t node, uint32_t triangle[3])
{
    const uint32_t before = clipper->ring.nodes[node].before;
    const uint32_t after = clipper->ring.nodes[node].after;
    triangle[0] = before;
    triangle[1] = node;
    triangle[2] = after;
    pvtRing_Remove(&clipper->ring, node);
    pvtQueue_Drop(&clipper->queue, node);
    pvtQueue_Wake(&clipper->queue, node);
    Score(clipper, before);
    Score(clipper, after);
}

static pvtStatus Triangulate(pvtContext* context, Clipper* clipper, uint32_t* indices)
{
    ScoreAll(clipper);
    for (uint32_t* triangle = indices; clipper->ring.count > 2; triangle += 3) {
        uint32_t node;
        if (!FindEarAnyhow(clipper, &node)) {
            return pvtFail(context, PVT_INVALID_ARGUMENT,
                           "a polygon cannot be cut into triangles: it crosses itself or runs "
                           "clockwise");
        }
        if (clipper->ring.count % 1024 == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        Clip(clipper, node, triangle);
    }
    return PVT_OK;
}

pvtStatus pvtTriangulatePolygon(pvtContext* context, const pvtPoint2* points, size_t count,
                                uint32_t* indices)
{
    if (count < 3 || count > INT32_MAX) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "a polygon of %zu points", count);
    }
    Clipper clipper = {0};
    pvtStatus status = pvtCreateRing(context, count, count, &clipper.ring);
    if (status == PVT_OK) {
        status = pvtCreateQueue(context, count, count, &clipper.queue);
    }
    if (status == PVT_OK) {
        pvtRing_Reset(&clipper.ring, points, count);
        status = Triangulate(context, &clipper, indices);
    }
    pvtRing_Free(context, &clipper.ring);
    pvtQueue_Free(context, &clipper.queue);
    return status;
}
