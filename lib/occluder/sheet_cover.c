// SPDX-License-Identifier: MIT
// Inner coverage of cells by a soup of triangles. Triangles are clipped to what is near the plane
// and projected along its axis. Rows of cells wholly within one of them are set at once; in cells
// that several cover in part, what they leave of the square is found by subtracting them one after
// the other, so that neither overlaps nor T-junctions matter.
#include "sheet_cover.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_POINTS = 12, MAX_PIECES = 48, ROWS_A_CHECK = 1024 };

// What may be left uncovered of a quarter of a voxel's square, as a part of it: cracks between
// triangles that are rounded, nowhere wider than 1/64 of it.
static const double GAP = 1.0 / 8192.0;

// [cells] A point this close to an edge counts as inside, where only cells that fail are sought.
static const double NEAR = 0.01;

typedef struct Point {
    double x, y; // [cells]
} Point;

// Convex, counter-clockwise.
typedef struct Shape {
    Point points[MAX_POINTS];
    int count;
} Shape;

// What is near the plane of a triangle, in the same way.
typedef struct pvtClipped {
    Point points[5];
    int count;
} Clipped;

typedef struct Part {
    int32_t x, y;
    uint32_t shape;
} Part;

typedef struct Cover {
    pvtContext* context;
    const pvtSheetSoup* soup;
    const pvtPlane* plane;
    double reach; // [vx] along the axis
    double scale; // cells a voxel
    pvtBitmap* cells;
    Clipped* shapes;
    size_t shapeCount, shapeCapacity;
    Part* parts;
    size_t partCount, partCapacity;
} Cover;

static pvtStatus Reserve(pvtContext* context, void** memory, size_t count, size_t* capacity,
                         size_t size)
{
    if (count < *capacity) {
        return PVT_OK;
    }
    const size_t more = *capacity * 2 + 256;
    void* grown = pvtReallocate(context, *memory, more, size);
    if (grown == NULL) {
        return pvtContext_GetStatus(context);
    }
    *memory = grown;
    *capacity = more;
    return PVT_OK;
}

static double GetArea(const Point* points, int count)
{
    double twice = 0.0;
    for (int i = 1; i + 1 < count; ++i) {
        twice += (points[i].x - points[0].x) * (points[i + 1].y - points[0].y) -
                 (points[i].y - points[0].y) * (points[i + 1].x - points[0].x);
    }
    return 0.5 * twice;
}

// (u, v, height above the plane) of a triangle's corners, cut to |height| ≤ reach.
static int ClipToReach(const pvtVec3* in, int count, double sign, double reach, pvtVec3* out)
{
    int kept = 0;
    for (int i = 0; i < count; ++i) {
        const pvtVec3 a = in[i];
        const pvtVec3 b = in[(i + 1) % count];
        const double da = sign * a.z - reach;
        const double db = sign * b.z - reach;
        if (da <= 0.0) {
            out[kept++] = a;
        }
        if ((da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0)) {
            out[kept++] = pvtAdd(a, pvtScale(pvtSub(b, a), da / (da - db)));
        }
    }
    return kept;
}

static void AddPoints(const Cover* cover, const pvtVec3* points, int count, Clipped* shape)
{
    shape->count = count;
    for (int i = 0; i < count; ++i) {
        shape->points[i] = (Point){points[i].x * cover->scale, points[i].y * cover->scale};
    }
    if (GetArea(shape->points, count) < 0.0) {
        for (int i = 0; i < count / 2; ++i) {
            const Point swap = shape->points[i];
            shape->points[i] = shape->points[count - 1 - i];
            shape->points[count - 1 - i] = swap;
        }
    }
}

static pvtStatus AddTriangle(Cover* cover, size_t triangle)
{
    const pvtPlane* plane = cover->plane;
    const double one = 1 << PVT_PLANE_BITS;
    pvtVec3 corners[3];
    pvtSheetSoup_GetCorners(cover->soup, triangle, corners);
    for (int c = 0; c < 3; ++c) {
        const double u = pvtGetAxis(corners[c], (int)pvtPlane_GetU(plane));
        const double v = pvtGetAxis(corners[c], (int)pvtPlane_GetV(plane));
        const double height = ((double)plane->offset + plane->slopeU * u + plane->slopeV * v) / one;
        corners[c] = (pvtVec3){u, v, pvtGetAxis(corners[c], (int)plane->axis) - height};
    }
    pvtVec3 above[4], near[5];
    const int most = ClipToReach(corners, 3, 1.0, cover->reach, above);
    const int count = most < 3 ? 0 : ClipToReach(above, most, -1.0, cover->reach, near);
    if (count < 3) {
        return PVT_OK;
    }
    if (Reserve(cover->context, (void**)&cover->shapes, cover->shapeCount, &cover->shapeCapacity,
                sizeof *cover->shapes) != PVT_OK ||
        cover->shapes == NULL) {
        return pvtContext_GetStatus(cover->context);
    }
    Clipped* shape = &cover->shapes[cover->shapeCount];
    AddPoints(cover, near, count, shape);
    cover->shapeCount += GetArea(shape->points, count) > 1e-9 ? 1 : 0;
    return PVT_OK;
}

static pvtStatus CollectShapes(Cover* cover, double distance)
{
    const pvtSheetSoup* soup = cover->soup;
    const pvtVec3 normal = pvtPlane_GetNormal(cover->plane);
    const double offset = (double)cover->plane->offset / (1 << PVT_PLANE_BITS) *
                          pvtGetAxis(normal, (int)cover->plane->axis);
    pvtStatus status = PVT_OK;
    for (size_t c = 0; c < soup->chunkCount && status == PVT_OK; ++c) {
        const pvtSheetSoupChunk* chunk = &soup->chunks[c];
        if (!pvtIsChunkNear(chunk, normal, offset, distance)) {
            continue;
        }
        for (size_t i = chunk->begin; i < chunk->end && status == PVT_OK; ++i) {
            status = AddTriangle(cover, soup->triangles[i]);
        }
    }
    return status;
}

typedef struct Span {
    double low, high; // empty when low > high
} Span;

static void Widen(Span* span, double x)
{
    span->low = fmin(span->low, x);
    span->high = fmax(span->high, x);
}

// Where the level line at y crosses the shape.
static Span CrossLevel(const Clipped* shape, double y)
{
    Span span = {HUGE_VAL, -HUGE_VAL};
    for (int i = 0; i < shape->count; ++i) {
        const Point a = shape->points[i];
        const Point b = shape->points[(i + 1) % shape->count];
        if (a.y == y) {
            Widen(&span, a.x);
        }
        if ((a.y < y && b.y > y) || (a.y > y && b.y < y)) {
            Widen(&span, a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)));
        }
    }
    return span;
}

static int ToCell(double at, int size)
{
    return (int)fmax(0.0, fmin(at, size));
}

static pvtStatus AddParts(Cover* cover, uint32_t shape, int y, int from, int to)
{
    for (int x = from; x < to; ++x) {
        if (Reserve(cover->context, (void**)&cover->parts, cover->partCount, &cover->partCapacity,
                    sizeof *cover->parts) != PVT_OK) {
            return pvtContext_GetStatus(cover->context);
        }
        cover->parts[cover->partCount++] = (Part){x, y, shape};
    }
    return PVT_OK;
}

// A shape is convex: what lies between its crossings at both the row's borders is within.
static pvtStatus DrawRow(Cover* cover, uint32_t index, int y, Span below, Span above)
{
    const Clipped* shape = &cover->shapes[index];
    Span touched = {fmin(below.low, above.low), fmax(below.high, above.high)};
    for (int i = 0; i < shape->count; ++i) {
        if (shape->points[i].y > y && shape->points[i].y < y + 1) {
            Widen(&touched, shape->points[i].x);
        }
    }
    if (touched.low >= touched.high) {
        return PVT_OK;
    }
    const int width = cover->cells->width;
    const int first = ToCell(floor(touched.low), width);
    const int end = ToCell(ceil(touched.high), width);
    int fullFirst = first;
    int fullEnd = first;
    if (below.low <= below.high && above.low <= above.high) {
        fullFirst = ToCell(ceil(fmax(below.low, above.low)), width);
        fullEnd = ToCell(floor(fmin(below.high, above.high)), width);
    }
    if (fullFirst >= fullEnd) {
        return AddParts(cover, index, y, first, end);
    }
    pvtSetBitRange(cover->cells->words + (size_t)y * cover->cells->wordsPerRow, (size_t)fullFirst,
                   (size_t)fullEnd);
    const pvtStatus status = AddParts(cover, index, y, first, fullFirst);
    return status == PVT_OK ? AddParts(cover, index, y, fullEnd, end) : status;
}

static pvtStatus DrawShape(Cover* cover, uint32_t index)
{
    const Clipped* shape = &cover->shapes[index];
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    for (int i = 0; i < shape->count; ++i) {
        low = fmin(low, shape->points[i].y);
        high = fmax(high, shape->points[i].y);
    }
    const int first = ToCell(floor(low), cover->cells->height);
    const int end = ToCell(ceil(high), cover->cells->height);
    Span below = CrossLevel(shape, first);
    pvtStatus status = PVT_OK;
    for (int y = first; y < end && status == PVT_OK; ++y) {
        const Span above = CrossLevel(shape, y + 1);
        status = DrawRow(cover, index, y, below, above);
        below = above;
    }
    return status;
}

// The part of `piece` to the right of (outside = true) or to the left of the line from a to b.
static Shape Cut(const Shape* piece, Point a, Point b, double side)
{
    Shape kept = {.count = 0};
    const double dx = side * (b.x - a.x);
    const double dy = side * (b.y - a.y);
    for (int i = 0; i < piece->count && kept.count + 2 <= MAX_POINTS; ++i) {
        const Point p = piece->points[i];
        const Point q = piece->points[(i + 1) % piece->count];
        const double dp = dx * (p.y - a.y) - dy * (p.x - a.x);
        const double dq = dx * (q.y - a.y) - dy * (q.x - a.x);
        if (dp >= 0.0) {
            kept.points[kept.count++] = p;
        }
        if ((dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0)) {
            const double t = dp / (dp - dq);
            kept.points[kept.count++] = (Point){p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)};
        }
    }
    return kept;
}

// What a shape leaves of some pieces; false when that is too many.
static bool Subtract(const Shape* pieces, int count, const Clipped* shape, Shape* left, int* kept)
{
    *kept = 0;
    for (int p = 0; p < count; ++p) {
        Shape rest = pieces[p];
        for (int i = 0; i < shape->count && rest.count >= 3; ++i) {
            const Point a = shape->points[i];
            const Point b = shape->points[(i + 1) % shape->count];
            const Shape outside = Cut(&rest, a, b, -1.0);
            rest = Cut(&rest, a, b, 1.0);
            if (outside.count >= 3 && GetArea(outside.points, outside.count) > 0.0) {
                if (*kept == MAX_PIECES) {
                    return false;
                }
                left[(*kept)++] = outside;
            }
        }
    }
    return true;
}

static bool IsInside(const Clipped* shape, double x, double y)
{
    for (int i = 0; i < shape->count; ++i) {
        const Point a = shape->points[i];
        const Point b = shape->points[(i + 1) % shape->count];
        const double length = fabs(b.x - a.x) + fabs(b.y - a.y);
        if ((b.x - a.x) * (y - a.y) < (b.y - a.y) * (x - a.x) - NEAR * length) {
            return false;
        }
    }
    return true;
}

// Five points within the cell, each in some shape; most cells at a border fail here.
static bool MayBeCovered(const Cover* cover, const Part* parts, size_t count)
{
    static const double at[5][2] = {
        {0.03, 0.03}, {0.97, 0.03}, {0.03, 0.97}, {0.97, 0.97}, {0.5, 0.5}};
    for (int i = 0; i < 5; ++i) {
        bool inside = false;
        for (size_t p = 0; p < count && !inside; ++p) {
            inside =
                IsInside(&cover->shapes[parts[p].shape], parts->x + at[i][0], parts->y + at[i][1]);
        }
        if (!inside) {
            return false;
        }
    }
    return true;
}

static bool IsCovered(const Cover* cover, const Part* parts, size_t count)
{
    if (!MayBeCovered(cover, parts, count)) {
        return false;
    }
    const double x = parts->x;
    const double y = parts->y;
    Shape buffers[2][MAX_PIECES];
    buffers[0][0] = (Shape){.points = {{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}, .count = 4};
    int left = 1;
    for (size_t i = 0; i < count && left > 0; ++i) {
        const int before = left;
        if (!Subtract(buffers[i % 2], before, &cover->shapes[parts[i].shape], buffers[(i + 1) % 2],
                      &left)) {
            return false;
        }
    }
    double area = 0.0;
    for (int i = 0; i < left; ++i) {
        const Shape* piece = &buffers[count % 2][i];
        area += GetArea(piece->points, piece->count);
    }
    return area * 16.0 <= GAP * cover->scale * cover->scale;
}

static int CompareParts(const void* left, const void* right)
{
    const Part* a = left;
    const Part* b = right;
    if (a->y != b->y) {
        return a->y < b->y ? -1 : 1;
    }
    if (a->x != b->x) {
        return a->x < b->x ? -1 : 1;
    }
    return (a->shape > b->shape) - (a->shape < b->shape);
}

static pvtStatus JoinParts(Cover* cover)
{
    size_t kept = 0;
    for (size_t i = 0; i < cover->partCount; ++i) {
        if (!pvtBitmap_Get(cover->cells, cover->parts[i].x, cover->parts[i].y)) {
            cover->parts[kept++] = cover->parts[i];
        }
    }
    if (kept > 0) {
        qsort(cover->parts, kept, sizeof *cover->parts, CompareParts);
    }
    for (size_t i = 0, end; i < kept; i = end) {
        const Part* part = &cover->parts[i];
        end = i + 1;
        while (end < kept && cover->parts[end].x == part->x && cover->parts[end].y == part->y) {
            ++end;
        }
        if (IsCovered(cover, part, end - i)) {
            pvtBitmap_Set(cover->cells, part->x, part->y, true);
        }
        if (i % ROWS_A_CHECK == 0 && pvtIsCancelled(cover->context)) {
            return PVT_CANCELLED;
        }
    }
    return PVT_OK;
}

pvtStatus pvtCoverPlane(pvtContext* context, const pvtSheetSoup* soup, const pvtPlane* plane,
                        double distance, int cellsPerVoxel, pvtBitmap* cells)
{
    Cover cover = {.context = context,
                   .soup = soup,
                   .plane = plane,
                   .reach = distance,
                   .scale = cellsPerVoxel,
                   .cells = cells};
    memset(cells->words, 0, cells->wordsPerRow * (size_t)cells->height * sizeof *cells->words);
    pvtStatus status = CollectShapes(&cover, distance);
    for (size_t i = 0; i < cover.shapeCount && status == PVT_OK; ++i) {
        status = DrawShape(&cover, (uint32_t)i);
        if (i % ROWS_A_CHECK == 0 && pvtIsCancelled(context)) {
            status = PVT_CANCELLED;
        }
    }
    if (status == PVT_OK) {
        status = JoinParts(&cover);
    }
    pvtRelease(context, cover.shapes);
    pvtRelease(context, cover.parts);
    return status;
}

typedef struct pvtShapeBox {
    Span x, y;
} Box;

static Box GetBox(const Point* points, int count)
{
    Box box = {{HUGE_VAL, -HUGE_VAL}, {HUGE_VAL, -HUGE_VAL}};
    for (int i = 0; i < count; ++i) {
        Widen(&box.x, points[i].x);
        Widen(&box.y, points[i].y);
    }
    return box;
}

pvtStatus pvtCollectPlaneShapes(pvtContext* context, const pvtSheetSoup* soup,
                                const pvtPlane* plane, double distance, pvtPlaneShapes* shapes)
{
    Cover cover = {
        .context = context, .soup = soup, .plane = plane, .reach = distance, .scale = 1.0};
    pvtStatus status = CollectShapes(&cover, distance);
    *shapes = (pvtPlaneShapes){.shapes = cover.shapes, .count = cover.shapeCount};
    if (status == PVT_OK) {
        shapes->boxes = pvtAllocate(context, shapes->count, sizeof *shapes->boxes);
        status = shapes->boxes == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    }
    if (status != PVT_OK) {
        pvtPlaneShapes_Free(context, shapes);
        return status;
    }
    for (size_t i = 0; i < shapes->count; ++i) {
        shapes->boxes[i] = GetBox(shapes->shapes[i].points, shapes->shapes[i].count);
    }
    return PVT_OK;
}

void pvtPlaneShapes_Free(pvtContext* context, pvtPlaneShapes* shapes)
{
    pvtRelease(context, shapes->shapes);
    pvtRelease(context, shapes->boxes);
    *shapes = (pvtPlaneShapes){0};
}

static bool AreApart(const Box* a, const Box* b)
{
    return a->x.low >= b->x.high || a->x.high <= b->x.low || a->y.low >= b->y.high ||
           a->y.high <= b->y.low;
}

// Points near the corners and in the middle, each in some shape: what is not covered fails here.
static bool MayCover(const pvtPlaneShapes* shapes, const Shape* triangle)
{
    enum { POINTS = 4 };
    for (int i = 0; i < POINTS; ++i) {
        const double most = 0.9;
        double x = 0.0, y = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double share = i == 3 ? 1.0 / 3.0 : k == i ? most : 0.5 * (1.0 - most);
            x += share * triangle->points[k].x;
            y += share * triangle->points[k].y;
        }
        bool isInside = false;
        for (size_t s = 0; s < shapes->count && !isInside; ++s) {
            const Box* box = &shapes->boxes[s];
            isInside = x >= box->x.low - NEAR && x <= box->x.high + NEAR &&
                       y >= box->y.low - NEAR && y <= box->y.high + NEAR &&
                       IsInside(&shapes->shapes[s], x, y);
        }
        if (!isInside) {
            return false;
        }
    }
    return true;
}

bool pvtPlaneShapes_Cover(const pvtPlaneShapes* shapes, const pvtPoint2 triangle[3], double* open)
{
    const double unit = 1 << PVT_POINT_BITS;
    Shape whole = {.count = 3};
    for (int i = 0; i < 3; ++i) {
        whole.points[i] = (Point){triangle[i].x / unit, triangle[i].y / unit};
    }
    const double area = GetArea(whole.points, 3);
    if (area < 0.0) {
        const Point swap = whole.points[1];
        whole.points[1] = whole.points[2];
        whole.points[2] = swap;
    }
    if (!MayCover(shapes, &whole)) {
        return false;
    }
    const Box box = GetBox(whole.points, 3);
    Shape buffers[2][MAX_PIECES];
    int now = 0;
    int left = 1;
    buffers[0][0] = whole;
    for (size_t i = 0; i < shapes->count && left > 0; ++i) {
        if (AreApart(&shapes->boxes[i], &box)) {
            continue;
        }
        const int before = left;
        if (!Subtract(buffers[now], before, &shapes->shapes[i], buffers[1 - now], &left)) {
            return false;
        }
        now = 1 - now;
    }
    double rest = 0.0;
    for (int i = 0; i < left; ++i) {
        rest += GetArea(buffers[now][i].points, buffers[now][i].count);
    }
    if (rest > fmin(fabs(area) / 64.0, *open)) {
        return false;
    }
    *open -= rest;
    return true;
}
