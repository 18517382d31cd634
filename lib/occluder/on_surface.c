// SPDX-License-Identifier: MIT
// The promise of panels on the surface, checked after the fact: what is left of an occluder's
// triangles once those parts are taken away that lie close to the surface? Each triangle, as it is
// stored, is halved until few of the surface's triangles are over a part, and these are subtracted
// from it one by one. Shares nothing with the cells that such panels are made of.
#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <paravent/occluder.h>
#include <string.h>

enum { CHUNK = 64, MAX_CORNERS = 24, MAX_LEFT = 40, FEW = 12, SEVERAL = 96, MAX_DEPTH = 40 };

// How much may be missing: this part of a triangle, besides a strip as wide as the slack along its
// border.
static const double MISSING = 1.0 / 512.0;
// Axes along which a normal is this part of its largest coordinate may all be looked along.
static const double NEARLY_LARGEST = 0.99;

typedef struct Corner {
    double u, v;
} Corner;

// Convex, counter-clockwise.
typedef struct Part {
    Corner corners[MAX_CORNERS];
    int count;
} Part;

typedef struct Box {
    pvtVec3 low, high;
} Box;

typedef struct List {
    void* items;
    size_t count, capacity;
} List;

typedef struct OffTask {
    pvtContext* context;
    const pvtSurfaceReach* reach;
    const pvtMesh* surface;
    const pvtMesh* occluder;
    Box* chunks;
    size_t chunkCount;
    List* rests; // of pvtVec3, three a triangle; one list a triangle of the occluder
    pvtStatus* statuses;
} OffTask;

typedef struct Extent {
    double low[2], high[2];
} Extent;

// What is near of the surface, seen along the axis: few corners, for there may be many of these.
typedef struct Over {
    Extent extent;
    Corner corners[5];
    int count;
} Over;

// One triangle, looked at along one axis. Coordinates count from its first corner.
typedef struct Look {
    const OffTask* task;
    pvtVec3 origin;
    int axis, u, v;
    double slopeU, slopeV; // of its plane over (u, v)
    double reach;          // [wu] along the axis
    Part whole;
    List overs; // Over
    List stack; // uint32_t: into overs
    List rest;  // pvtVec3
    double missing;
    pvtStatus status;
} Look;

static bool Push(pvtContext* context, List* list, const void* item, size_t size)
{
    if (list->count == list->capacity) {
        const size_t capacity = 2 * list->capacity + 64;
        void* grown = pvtReallocate(context, list->items, capacity, size);
        if (grown == NULL) {
            return false;
        }
        list->items = grown;
        list->capacity = capacity;
    }
    memcpy((char*)list->items + list->count * size, item, size);
    ++list->count;
    return true;
}

static double GetArea(const Part* part)
{
    double twice = 0.0;
    const Corner o = part->corners[0];
    for (int i = 1; i + 1 < part->count; ++i) {
        const Corner a = part->corners[i];
        const Corner b = part->corners[i + 1];
        twice += (a.u - o.u) * (b.v - o.v) - (a.v - o.v) * (b.u - o.u);
    }
    return 0.5 * twice;
}

static double GetLength(Corner a, Corner b)
{
    return sqrt((a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v));
}

static double GetDiameter(const Part* part)
{
    double most = 0.0;
    for (int i = 0; i < part->count; ++i) {
        for (int j = 0; j < i; ++j) {
            most = fmax(most, GetLength(part->corners[i], part->corners[j]));
        }
    }
    return most;
}

// The part where a u + b v ≤ c.
static Part CutPart(const Part* part, double a, double b, double c)
{
    Part kept = {.count = 0};
    for (int i = 0; i < part->count; ++i) {
        const Corner p = part->corners[i];
        const Corner q = part->corners[(i + 1) % part->count];
        const double dp = a * p.u + b * p.v - c;
        const double dq = a * q.u + b * q.v - c;
        if (dp <= 0.0 && kept.count < MAX_CORNERS) {
            kept.corners[kept.count++] = p;
        }
        if (((dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0)) && kept.count < MAX_CORNERS) {
            const double at = dp / (dp - dq);
            kept.corners[kept.count++] = (Corner){p.u + at * (q.u - p.u), p.v + at * (q.v - p.v)};
        }
    }
    return kept;
}

static Extent GetExtent(const Part* part)
{
    Extent e = {{HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL}};
    for (int i = 0; i < part->count; ++i) {
        e.low[0] = fmin(e.low[0], part->corners[i].u);
        e.high[0] = fmax(e.high[0], part->corners[i].u);
        e.low[1] = fmin(e.low[1], part->corners[i].v);
        e.high[1] = fmax(e.high[1], part->corners[i].v);
    }
    return e;
}

// What a convex shape leaves of a part, in pieces; −1 when these are too many.
static int TakeAway(const Part* part, const Over* over, Part* left, int room)
{
    int count = 0;
    Part rest = *part;
    for (int i = 0; i < over->count && rest.count >= 3; ++i) {
        const Corner p = over->corners[i];
        const Corner q = over->corners[(i + 1) % over->count];
        // To the right of the edge is outside.
        const double a = q.v - p.v;
        const double b = p.u - q.u;
        const double c = a * p.u + b * p.v;
        const Part outside = CutPart(&rest, -a, -b, -c);
        if (outside.count >= 3 && GetArea(&outside) > 0.0) {
            if (count == room || outside.count >= MAX_CORNERS - 2) {
                return -1;
            }
            left[count++] = outside;
        }
        rest = CutPart(&rest, a, b, c);
    }
    return count;
}

static pvtVec3 Lift(const Look* look, Corner at)
{
    pvtVec3 p = {0};
    pvtSetAxis(&p, look->u, at.u);
    pvtSetAxis(&p, look->v, at.v);
    pvtSetAxis(&p, look->axis, look->slopeU * at.u + look->slopeV * at.v);
    return pvtAdd(p, look->origin);
}

static void AddRest(Look* look, const Part* part)
{
    for (int i = 1; i + 1 < part->count && look->status == PVT_OK; ++i) {
        const int corners[3] = {0, i, i + 1};
        for (int c = 0; c < 3; ++c) {
            const pvtVec3 p = Lift(look, part->corners[corners[c]]);
            if (!Push(look->task->context, &look->rest, &p, sizeof p)) {
                look->status = pvtContext_GetStatus(look->task->context);
            }
        }
    }
}

// A piece that is nowhere wider than the slack only counts as missing.
static void AddPiece(Look* look, const Part* piece)
{
    const double area = GetArea(piece);
    const double slack = look->task->reach->slack;
    const double diameter = GetDiameter(piece);
    if (diameter <= slack || 2.0 * area <= slack * diameter) {
        look->missing += area;
    } else {
        AddRest(look, piece);
    }
}

// False when a part is in too many pieces on the way.
static bool TakeAllAway(Look* look, const Part* part, const uint32_t* overs, size_t count)
{
    Part pieces[2][MAX_LEFT];
    int left = 1;
    int now = 0;
    pieces[0][0] = *part;
    for (size_t i = 0; i < count && left > 0; ++i) {
        const Over* over = (const Over*)look->overs.items + overs[i];
        int kept = 0;
        for (int p = 0; p < left; ++p) {
            const int more =
                TakeAway(&pieces[now][p], over, &pieces[1 - now][kept], MAX_LEFT - kept);
            if (more < 0) {
                return false;
            }
            kept += more;
        }
        left = kept;
        now = 1 - now;
    }
    for (int p = 0; p < left; ++p) {
        AddPiece(look, &pieces[now][p]);
    }
    return true;
}

// Puts those of the shapes begin to end − 1 on the stack that are over the extent.
static bool Filter(Look* look, size_t begin, size_t end, const Extent* extent)
{
    for (size_t i = begin; i < end; ++i) {
        const uint32_t over = ((const uint32_t*)look->stack.items)[i];
        const Extent e = ((const Over*)look->overs.items)[over].extent;
        if (e.low[0] < extent->high[0] && e.high[0] > extent->low[0] &&
            e.low[1] < extent->high[1] && e.high[1] > extent->low[1] &&
            !Push(look->task->context, &look->stack, &over, sizeof over)) {
            look->status = pvtContext_GetStatus(look->task->context);
            return false;
        }
    }
    return true;
}

static bool HoldsAll(const Over* over, const Part* part)
{
    for (int i = 0; i < over->count; ++i) {
        const Corner p = over->corners[i];
        const Corner q = over->corners[(i + 1) % over->count];
        for (int c = 0; c < part->count; ++c) {
            const Corner at = part->corners[c];
            if ((q.u - p.u) * (at.v - p.v) < (q.v - p.v) * (at.u - p.u)) {
                return false;
            }
        }
    }
    return true;
}

static bool IsHeld(const Look* look, const Part* part, size_t begin, size_t end)
{
    const uint32_t* overs = look->stack.items;
    const Extent inner = GetExtent(part);
    for (size_t i = begin; i < end; ++i) {
        const Over* over = (const Over*)look->overs.items + overs[i];
        const Extent* outer = &over->extent;
        if (outer->low[0] <= inner.low[0] && outer->high[0] >= inner.high[0] &&
            outer->low[1] <= inner.low[1] && outer->high[1] >= inner.high[1] &&
            HoldsAll(over, part)) {
            return true;
        }
    }
    return false;
}

// Takes the shapes begin to end − 1 of the stack from a part. Recursion ends with MAX_DEPTH, or
// where a part is smaller than the slack.
static void Divide(Look* look, const Part* part, size_t begin, size_t end, int depth)
{
    if (look->status != PVT_OK || pvtIsCancelled(look->task->context)) {
        return;
    }
    if (IsHeld(look, part, begin, end)) {
        return;
    }
    const double diameter = GetDiameter(part);
    if (begin == end || diameter <= look->task->reach->slack) {
        AddPiece(look, part);
        return;
    }
    const uint32_t* overs = (const uint32_t*)look->stack.items + begin;
    // Where many meet, halving does not help for long.
    const bool isSmall = end - begin <= SEVERAL && diameter <= 64.0 * look->task->reach->slack;
    if ((end - begin <= FEW || isSmall || depth == MAX_DEPTH) &&
        TakeAllAway(look, part, overs, end - begin)) {
        return;
    }
    if (depth == MAX_DEPTH || part->count >= MAX_CORNERS - 2) {
        AddRest(look, part);
        return;
    }
    const Extent e = GetExtent(part);
    const bool alongV = e.high[1] - e.low[1] > e.high[0] - e.low[0];
    const double middle = alongV ? 0.5 * (e.low[1] + e.high[1]) : 0.5 * (e.low[0] + e.high[0]);
    for (int side = 0; side < 2; ++side) {
        const double sign = side == 0 ? 1.0 : -1.0;
        const Part half = alongV ? CutPart(part, 0.0, sign, sign * middle)
                                 : CutPart(part, sign, 0.0, sign * middle);
        if (half.count < 3) {
            continue;
        }
        const Extent extent = GetExtent(&half);
        const size_t top = look->stack.count;
        if (Filter(look, begin, end, &extent)) {
            Divide(look, &half, top, look->stack.count, depth + 1);
        }
        look->stack.count = top;
    }
}

// The triangle's part whose height over the plane is within reach, seen along the axis.
static Part SeeTriangle(const Look* look, const pvtVec3 corners[3])
{
    pvtVec3 near[8];
    int count = 3;
    int above = 0;
    int below = 0;
    for (int c = 0; c < 3; ++c) {
        const double u = pvtGetAxis(corners[c], look->u);
        const double v = pvtGetAxis(corners[c], look->v);
        near[c] = (pvtVec3){
            u, v, pvtGetAxis(corners[c], look->axis) - look->slopeU * u - look->slopeV * v};
        above += near[c].z > look->reach ? 1 : 0;
        below += near[c].z < -look->reach ? 1 : 0;
    }
    if (above == 3 || below == 3) {
        return (Part){.count = 0};
    }
    for (int side = 0; side < 2; ++side) {
        pvtVec3 cut[8];
        int kept = 0;
        for (int i = 0; i < count; ++i) {
            const pvtVec3 p = near[i];
            const pvtVec3 q = near[(i + 1) % count];
            const double dp = (side == 0 ? p.z : -p.z) - look->reach;
            const double dq = (side == 0 ? q.z : -q.z) - look->reach;
            if (dp <= 0.0) {
                cut[kept++] = p;
            }
            if ((dp < 0.0 && dq > 0.0) || (dp > 0.0 && dq < 0.0)) {
                cut[kept++] = pvtAdd(p, pvtScale(pvtSub(q, p), dp / (dp - dq)));
            }
        }
        memcpy(near, cut, (size_t)kept * sizeof *near);
        count = kept;
    }
    Part part = {.count = count < 3 ? 0 : count};
    for (int i = 0; i < part.count; ++i) {
        part.corners[i] = (Corner){near[i].x, near[i].y};
    }
    if (GetArea(&part) < 0.0) {
        for (int i = 0; i < part.count / 2; ++i) {
            const Corner swap = part.corners[i];
            part.corners[i] = part.corners[part.count - 1 - i];
            part.corners[part.count - 1 - i] = swap;
        }
    }
    return part;
}

static bool IsApart(const Box* a, const Box* b, double distance)
{
    return a->low.x > b->high.x + distance || b->low.x > a->high.x + distance ||
           a->low.y > b->high.y + distance || b->low.y > a->high.y + distance ||
           a->low.z > b->high.z + distance || b->low.z > a->high.z + distance;
}

static Box GetBox(const pvtMesh* mesh, size_t begin, size_t end)
{
    Box box = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (size_t i = 3 * begin; i < 3 * end; ++i) {
        const pvtVec3 p = mesh->positions[mesh->indices[i]];
        box.low = (pvtVec3){fmin(box.low.x, p.x), fmin(box.low.y, p.y), fmin(box.low.z, p.z)};
        box.high = (pvtVec3){fmax(box.high.x, p.x), fmax(box.high.y, p.y), fmax(box.high.z, p.z)};
    }
    return box;
}

static void CollectOvers(Look* look, size_t triangle)
{
    const OffTask* task = look->task;
    const Box box = GetBox(task->occluder, triangle, triangle + 1);
    const Extent extent = GetExtent(&look->whole);
    for (size_t c = 0; c < task->chunkCount; ++c) {
        if (IsApart(&task->chunks[c], &box, look->reach)) {
            continue;
        }
        const size_t end = (c + 1) * CHUNK;
        for (size_t t = c * CHUNK; t < end && t < task->surface->triangleCount; ++t) {
            pvtVec3 corners[3];
            for (size_t k = 0; k < 3; ++k) {
                corners[k] = pvtSub(task->surface->positions[task->surface->indices[3 * t + k]],
                                    look->origin);
            }
            const Part seen = SeeTriangle(look, corners);
            Over over = {.extent = GetExtent(&seen), .count = seen.count};
            memcpy(over.corners, seen.corners, sizeof over.corners);
            const Extent e = over.extent;
            const uint32_t index = (uint32_t)look->overs.count;
            if (over.count < 3 || e.low[0] >= extent.high[0] || e.high[0] <= extent.low[0] ||
                e.low[1] >= extent.high[1] || e.high[1] <= extent.low[1]) {
                continue;
            }
            if (!Push(task->context, &look->overs, &over, sizeof over) ||
                !Push(task->context, &look->stack, &index, sizeof index)) {
                look->status = pvtContext_GetStatus(task->context);
                return;
            }
        }
    }
}

static double GetPerimeter(const Part* part)
{
    double sum = 0.0;
    for (int i = 0; i < part->count; ++i) {
        sum += GetLength(part->corners[i], part->corners[(i + 1) % part->count]);
    }
    return sum;
}

// What is left when looking along one axis, in look->rest.
static void LookAlong(Look* look, size_t triangle, const pvtVec3 corners[3], pvtVec3 normal)
{
    look->u = look->axis == 0 ? 1 : 0;
    look->v = look->axis == 2 ? 1 : 2;
    const double along = pvtGetAxis(normal, look->axis);
    look->slopeU = -pvtGetAxis(normal, look->u) / along;
    look->slopeV = -pvtGetAxis(normal, look->v) / along;
    look->reach = look->task->reach->distance + look->task->reach->slack;
    look->origin = corners[0];
    look->whole = (Part){.count = 3};
    for (int c = 0; c < 3; ++c) {
        const pvtVec3 p = pvtSub(corners[c], corners[0]);
        look->whole.corners[c] = (Corner){pvtGetAxis(p, look->u), pvtGetAxis(p, look->v)};
    }
    if (GetArea(&look->whole) < 0.0) {
        const Corner swap = look->whole.corners[1];
        look->whole.corners[1] = look->whole.corners[2];
        look->whole.corners[2] = swap;
    }
    look->rest.count = look->overs.count = look->stack.count = 0;
    look->missing = 0.0;
    CollectOvers(look, triangle);
    Divide(look, &look->whole, 0, look->stack.count, 0);
    const double allowed =
        MISSING * GetArea(&look->whole) + look->task->reach->slack * GetPerimeter(&look->whole);
    if (look->missing > allowed) {
        AddRest(look, &look->whole);
    }
}

static pvtStatus TakeTriangle(OffTask* task, size_t triangle)
{
    pvtVec3 corners[3];
    for (size_t c = 0; c < 3; ++c) {
        corners[c] = task->occluder->positions[task->occluder->indices[3 * triangle + c]];
    }
    const pvtVec3 normal =
        pvtNormalize(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])));
    const double largest = fmax(fabs(normal.x), fmax(fabs(normal.y), fabs(normal.z)));
    Look look = {.task = task};
    bool done = !(largest > 0.0);
    for (look.axis = 0; look.axis < 3 && !done && look.status == PVT_OK; ++look.axis) {
        if (fabs(pvtGetAxis(normal, look.axis)) >= NEARLY_LARGEST * largest) {
            LookAlong(&look, triangle, corners, normal);
            done = look.rest.count == 0;
        }
    }
    pvtRelease(task->context, look.overs.items);
    pvtRelease(task->context, look.stack.items);
    task->rests[triangle] = look.rest;
    return look.status;
}

static void RunTakeOff(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    OffTask* task = taskData;
    for (size_t t = begin; t < end; ++t) {
        task->statuses[t] = pvtIsCancelled(task->context) ? PVT_CANCELLED : TakeTriangle(task, t);
    }
}

static pvtStatus JoinRests(pvtContext* context, const OffTask* task, pvtMesh* rest)
{
    for (size_t t = 0; t < task->occluder->triangleCount; ++t) {
        if (task->statuses[t] != PVT_OK) {
            return task->statuses[t];
        }
        rest->positionCount += task->rests[t].count;
    }
    rest->triangleCount = rest->positionCount / 3;
    rest->positions = pvtAllocate(context, rest->positionCount, sizeof *rest->positions);
    rest->indices = pvtAllocate(context, rest->positionCount, sizeof *rest->indices);
    if (rest->positions == NULL || rest->indices == NULL) {
        return pvtContext_GetStatus(context);
    }
    size_t at = 0;
    for (size_t t = 0; t < task->occluder->triangleCount; ++t) {
        const pvtVec3* from = task->rests[t].items;
        for (size_t i = 0; i < task->rests[t].count; ++i) {
            rest->positions[at] = from[i];
            rest->indices[at] = (uint32_t)at;
            ++at;
        }
    }
    return PVT_OK;
}

pvtStatus pvtTakeOffSurface(pvtContext* context, const pvtSurfaceReach* reach,
                            const pvtMesh* surface, const pvtMesh* occluder, pvtMesh* rest)
{
    *rest = (pvtMesh){0};
    OffTask task = {.context = context,
                    .reach = reach,
                    .surface = surface,
                    .occluder = occluder,
                    .chunkCount = (surface->triangleCount + CHUNK - 1) / CHUNK};
    const size_t count = occluder->triangleCount;
    task.chunks = pvtAllocate(context, task.chunkCount, sizeof *task.chunks);
    task.rests = pvtAllocate(context, count, sizeof *task.rests);
    task.statuses = pvtAllocate(context, count, sizeof *task.statuses);
    pvtStatus status = PVT_OK;
    if (task.chunks == NULL || task.rests == NULL || task.statuses == NULL) {
        status = pvtContext_GetStatus(context);
    }
    for (size_t c = 0; c < task.chunkCount && status == PVT_OK && task.chunks != NULL; ++c) {
        const size_t end = (c + 1) * CHUNK;
        task.chunks[c] =
            GetBox(surface, c * CHUNK, end < surface->triangleCount ? end : surface->triangleCount);
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, RunTakeOff, count, 1, &task);
        status = JoinRests(context, &task, rest);
    }
    for (size_t t = 0; t < count && task.rests != NULL; ++t) {
        pvtRelease(context, task.rests[t].items);
    }
    pvtRelease(context, task.rests);
    pvtRelease(context, task.statuses);
    pvtRelease(context, task.chunks);
    if (status != PVT_OK) {
        pvtMesh_Free(context, rest);
    }
    return status == PVT_CANCELLED ? pvtFailCancelled(context) : status;
}
