// SPDX-License-Identifier: MIT
// The occluder in colours: one for each plane, and edges around it.
#include "gl/preview.h"

#include "base/context.h"
#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

// Triangles share a plane when one's corners are closer to the other's plane than this, in the cube
// of side 2: files round positions to floats.
#define PLANE_TOLERANCE 3e-4
// Beyond this an occluder would be all edges.
enum { MOST_EDGED_TRIANGLES = 20000 };

// The largest triangle of a run; its plane is the run's.
typedef struct Reference {
    pvtVec3 corners[3];
    pvtVec3 normal; // unit
    double area;    // twice
} Reference;

static pvtVec3 ToVector(pvtPreviewPoint point)
{
    return (pvtVec3){point.x, point.y, point.z};
}

static Reference MakeReference(const pvtPreviewVertex* triangle)
{
    Reference made;
    for (int i = 0; i < 3; ++i) {
        made.corners[i] = ToVector(triangle[i].at);
    }
    const pvtVec3 cross = pvtCross(pvtSub(made.corners[1], made.corners[0]),
                                   pvtSub(made.corners[2], made.corners[0]));
    made.normal = pvtNormalize(cross);
    made.area = pvtLength3(cross);
    return made;
}

static bool SharePlane(const Reference* a, const Reference* b)
{
    const Reference* larger = a->area >= b->area ? a : b;
    const Reference* smaller = larger == a ? b : a;
    for (int i = 0; i < 3; ++i) {
        const pvtVec3 away = pvtSub(smaller->corners[i], larger->corners[0]);
        if (fabs(pvtDot(away, larger->normal)) > PLANE_TOLERANCE) {
            return false;
        }
    }
    return true;
}

static uint8_t EncodeChannel(double linear)
{
    const double clamped = fmin(1.0, fmax(0.0, linear));
    const double encoded =
        clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * pow(clamped, 1.0 / 2.4) - 0.055;
    return (uint8_t)floor(255.0 * encoded + 0.5);
}

// A colour of even lightness and strength for any hue (Ottosson, A perceptual color space for image
// processing, 2020: OKLCH).
static void MakeColor(double lightness, double chroma, double hue, uint8_t color[4])
{
    const double a = chroma * cos(hue), b = chroma * sin(hue);
    double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
    double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
    double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    color[0] = EncodeChannel(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s);
    color[1] = EncodeChannel(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s);
    color[2] = EncodeChannel(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s);
    color[3] = 255;
}

// Hues a golden angle apart never come close to a recent one.
static double GetHue(size_t run)
{
    return 4.6 + 2.399963229728653 * (double)run;
}

static void PaintFill(pvtPreviewVertex* vertices, size_t first, size_t end, size_t run)
{
    uint8_t color[4];
    MakeColor(run % 2 == 0 ? 0.68 : 0.74, 0.16, GetHue(run), color);
    for (size_t i = 3 * first; i < 3 * end; ++i) {
        memcpy(vertices[i].color, color, sizeof color);
    }
}

static int ComparePoints(const pvtPreviewPoint* a, const pvtPreviewPoint* b)
{
    if (a->x != b->x) {
        return a->x < b->x ? -1 : 1;
    }
    if (a->y != b->y) {
        return a->y < b->y ? -1 : 1;
    }
    return a->z < b->z ? -1 : a->z > b->z;
}

static int CompareEdges(const void* left, const void* right)
{
    const pvtPreviewEdge *a = left, *b = right;
    const int begins = ComparePoints(&a->begin, &b->begin);
    return begins != 0 ? begins : ComparePoints(&a->end, &b->end);
}

static pvtPreviewEdge MakeEdge(pvtPreviewPoint a, pvtPreviewPoint b)
{
    pvtPreviewEdge edge = {a, b, {0}};
    if (ComparePoints(&a, &b) > 0) {
        edge.begin = b;
        edge.end = a;
    }
    return edge;
}

// What the runs are painted with.
typedef struct Painter {
    pvtPreviewPaint* paint;
    pvtPreviewEdge* scratch; // of one run; null: no edges are wanted
    size_t innerCount;       // at the end of the edges, backwards, until all are there
} Painter;

// Adds each edge of a run once: as an outline where one triangle has it, else as an inner one.
static void AddEdges(Painter* painter, size_t first, size_t end, size_t run)
{
    pvtPreviewPaint* paint = painter->paint;
    pvtPreviewEdge* edges = painter->scratch;
    size_t count = 0;
    for (size_t t = first; t < end; ++t) {
        const pvtPreviewVertex* corners = paint->vertices + 3 * t;
        for (int i = 0; i < 3; ++i) {
            edges[count++] = MakeEdge(corners[i].at, corners[(i + 1) % 3].at);
        }
    }
    qsort(edges, count, sizeof *edges, CompareEdges);
    uint8_t outline[4], inner[4];
    MakeColor(0.36, 0.11, GetHue(run), outline);
    MakeColor(0.52, 0.14, GetHue(run), inner);
    inner[3] = 110;
    for (size_t i = 0, next; i < count; i = next) {
        for (next = i + 1; next < count && CompareEdges(&edges[i], &edges[next]) == 0;) {
            ++next;
        }
        memcpy(edges[i].color, next - i == 1 ? outline : inner, sizeof outline);
        if (next - i == 1) {
            paint->edges[paint->outlineCount++] = edges[i];
        } else {
            paint->edges[paint->vertexCount - ++painter->innerCount] = edges[i];
        }
    }
}

static void PaintRun(Painter* painter, size_t first, size_t end, size_t run)
{
    PaintFill(painter->paint->vertices, first, end, run);
    if (painter->scratch != NULL) {
        AddEdges(painter, first, end, run);
    }
}

// Cuts the triangles, in order, into runs that share a plane.
static void PaintRuns(Painter* painter)
{
    pvtPreviewPaint* paint = painter->paint;
    const size_t count = paint->vertexCount / 3;
    size_t first = 0, run = 0;
    Reference reference = {0};
    for (size_t t = 0; t < count; ++t) {
        const Reference next = MakeReference(paint->vertices + 3 * t);
        if (t > first && !SharePlane(&reference, &next)) {
            PaintRun(painter, first, t, run++);
            first = t;
        }
        if (t == first || next.area > reference.area) {
            reference = next;
        }
    }
    if (count > 0) {
        PaintRun(painter, first, count, run);
    }
    paint->edgeCount = paint->outlineCount + painter->innerCount;
    if (painter->innerCount > 0) {
        memmove(paint->edges + paint->outlineCount,
                paint->edges + (paint->vertexCount - painter->innerCount),
                painter->innerCount * sizeof *paint->edges);
    }
}

static pvtStatus PaintAll(pvtContext* context, const pvtPreviewSpace* space,
                          const pvtMesh* occluder, pvtPreviewPaint* paint)
{
    Painter painter = {.paint = paint};
    paint->vertexCount = 3 * occluder->triangleCount;
    paint->vertices = pvtAllocate(context, paint->vertexCount, sizeof *paint->vertices);
    if (paint->vertices == NULL) {
        return pvtContext_GetStatus(context);
    }
    if (occluder->triangleCount <= MOST_EDGED_TRIANGLES) {
        paint->edges = pvtAllocate(context, paint->vertexCount, sizeof *paint->edges);
        painter.scratch = pvtAllocate(context, paint->vertexCount, sizeof *painter.scratch);
        if (paint->edges == NULL || painter.scratch == NULL) {
            pvtRelease(context, painter.scratch);
            return pvtContext_GetStatus(context);
        }
    }
    for (size_t i = 0; i < paint->vertexCount; ++i) {
        paint->vertices[i].at =
            pvtPreviewSpace_Map(space, occluder->positions[occluder->indices[i]]);
    }
    PaintRuns(&painter);
    pvtRelease(context, painter.scratch);
    return PVT_OK;
}

pvtStatus pvtPaintOccluder(pvtContext* context, const pvtPreviewSpace* space,
                           const pvtMesh* occluder, pvtPreviewPaint* paint)
{
    *paint = (pvtPreviewPaint){0};
    const pvtStatus status = PaintAll(context, space, occluder, paint);
    if (status != PVT_OK) {
        pvtPreviewPaint_Free(context, paint);
    }
    return status;
}

void pvtPreviewPaint_Free(pvtContext* context, pvtPreviewPaint* paint)
{
    pvtRelease(context, paint->vertices);
    pvtRelease(context, paint->edges);
    *paint = (pvtPreviewPaint){0};
}
