// SPDX-License-Identifier: MIT
#include "facets.h"

#include "base/context.h"
#include "base/vector.h"
#include "base/vectors.h"
#include "occlusion/rectangles.h"
#include "occlusion/stride.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { ROWS = PVT_FACET_ROWS, LAYERS = PVT_FACET_LAYERS, LOOKS = 6, MIN_VIEWS = 16 };

// Of the value so far, at a look: who has lost more in some views seldom wins in the others.
static const double MOST_LOSS = 0.0003;

void pvtFacets_Free(pvtContext* context, pvtFacets* facets)
{
    pvtMesh_Free(context, &facets->mesh);
    pvtRelease(context, facets->frames);
    pvtRelease(context, facets->factors);
    pvtRelease(context, facets->masks);
    pvtRelease(context, facets->spans);
    pvtRelease(context, facets->layers);
    pvtRelease(context, facets->values);
    *facets = (pvtFacets){0};
}

double pvtGetFacetBytes(size_t triangleCount, size_t viewCount)
{
    return (double)viewCount * (double)(triangleCount + LAYERS) * (ROWS * sizeof(uint64_t) + 2);
}

// A screen is the box around the projected bounds, and rectangles on it are drawn at random: one
// more often hits upon the same when the screen is small.
static double GetFactor(const pvtView* view, const pvtBox3* bounds, const pvtMaskFrame* frame)
{
    const pvtVec3 half = pvtScale(pvtSub(bounds->upper, bounds->lower), 0.5 / frame->pixelSize);
    const double x =
        fabs(view->right.x) * half.x + fabs(view->right.y) * half.y + fabs(view->right.z) * half.z;
    const double y =
        fabs(view->up.x) * half.x + fabs(view->up.y) * half.y + fabs(view->up.z) * half.z;
    return x > 0.0 && y > 0.0 ? view->weight / (x * y * x * y) : 0.0;
}

static pvtVec3 GetPlace(const pvtFacets* facets, uint32_t corner)
{
    return facets->mesh.positions[corner];
}

pvtVec3 pvtGetChangedPlace(const pvtFacets* facets, const pvtFacetChange* change, uint32_t corner)
{
    for (int i = 0; i < change->movedCount; ++i) {
        if (change->moved[i] == corner) {
            return change->places[i];
        }
    }
    return GetPlace(facets, corner);
}

// Draws a triangle on clear rows; `span` tells which it may have set.
static void DrawTriangle(const pvtMaskFrame* frame, const pvtVec3 corners[3], uint64_t* rows,
                         uint8_t span[2])
{
    pvtMaskPoint points[3];
    int32_t low = INT32_MAX;
    int32_t high = INT32_MIN;
    for (int c = 0; c < 3; ++c) {
        points[c] = pvtProjectToMask(frame, corners[c]);
        low = points[c].y < low ? points[c].y : low;
        high = points[c].y > high ? points[c].y : high;
    }
    const int first = low >> PVT_MASK_POINT_BITS;
    const int end = (high >> PVT_MASK_POINT_BITS) + 1;
    span[0] = (uint8_t)(first < 0 ? 0 : first > ROWS ? ROWS : first);
    span[1] = (uint8_t)(end < span[0] ? span[0] : end > ROWS ? ROWS : end);
    memset(rows + span[0], 0, (size_t)(span[1] - span[0]) * sizeof *rows);
    pvtToggleMaskPolygon(rows, ROWS, points, 3);
}

static void DrawFacet(const pvtFacets* facets, size_t triangle, size_t view)
{
    pvtVec3 corners[3];
    for (size_t c = 0; c < 3; ++c) {
        corners[c] = GetPlace(facets, facets->mesh.indices[3 * triangle + c]);
    }
    const size_t mask = triangle * facets->viewCount + view;
    DrawTriangle(&facets->frames[view], corners, facets->masks + mask * ROWS, facets->spans[mask]);
}

static void AddMask(const pvtFacets* facets, size_t triangle, size_t view, uint64_t* rows)
{
    const size_t mask = triangle * facets->viewCount + view;
    const uint64_t* added = facets->masks + mask * ROWS;
    for (int y = facets->spans[mask][0]; y < facets->spans[mask][1]; ++y) {
        rows[y] |= added[y];
    }
}

// The first layer is what all triangles cover.
static uint64_t* GetLayers(const pvtFacets* facets, size_t view)
{
    return facets->layers + view * LAYERS * ROWS;
}

PVT_VECTOR_CLONES
static void AddToLayers(const uint64_t* restrict added, int first, int end,
                        uint64_t* restrict layers)
{
    for (int y = first; y < end; ++y) {
        for (int layer = LAYERS - 1; layer > 0; --layer) {
            layers[layer * ROWS + y] |= layers[(layer - 1) * ROWS + y] & added[y];
        }
        layers[y] |= added[y];
    }
}

static void CountLayers(const pvtFacets* facets, size_t view)
{
    uint64_t* layers = GetLayers(facets, view);
    memset(layers, 0, LAYERS * ROWS * sizeof *layers);
    for (size_t t = 0; t < facets->mesh.triangleCount; ++t) {
        const size_t mask = t * facets->viewCount + view;
        AddToLayers(facets->masks + mask * ROWS, facets->spans[mask][0], facets->spans[mask][1],
                    layers);
    }
}

static void CountView(const pvtFacets* facets, size_t view)
{
    const uint64_t* rows = GetLayers(facets, view);
    uint64_t before[ROWS];
    memcpy(before, rows, sizeof before);
    CountLayers(facets, view);
    if (memcmp(rows, before, sizeof before) != 0) {
        facets->values[view] = facets->factors[view] * (double)pvtSumRectangles(rows);
    }
}

typedef struct RedrawTask {
    const pvtFacets* facets;
    const size_t* triangles; // null: all
    size_t count;
} RedrawTask;

static void RedrawViews(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const RedrawTask* task = taskData;
    for (size_t v = begin; v < end; ++v) {
        for (size_t i = 0; i < task->count; ++i) {
            DrawFacet(task->facets, task->triangles != NULL ? task->triangles[i] : i, v);
        }
        CountView(task->facets, v);
    }
}

// Draws triangles (null: all) anew, and sums what all of them hide.
static void Redraw(pvtContext* context, pvtFacets* facets, const size_t* triangles, size_t count)
{
    RedrawTask task = {facets, triangles, count};
    pvtParallelFor(context, RedrawViews, facets->viewCount, MIN_VIEWS, &task);
    facets->total = 0.0;
    for (size_t v = 0; v < facets->viewCount; ++v) {
        facets->total += facets->values[v];
        if (v + 1 == facets->screenCount) {
            facets->screened = facets->total;
        }
    }
}

static pvtStatus AllocateMasks(pvtContext* context, pvtFacets* facets)
{
    const size_t views = facets->viewCount;
    const size_t masks = views * facets->mesh.triangleCount;
    facets->frames = pvtAllocate(context, views, sizeof *facets->frames);
    facets->factors = pvtAllocate(context, views, sizeof *facets->factors);
    facets->masks = pvtAllocate(context, masks * ROWS, sizeof *facets->masks);
    facets->spans = pvtAllocate(context, masks, sizeof *facets->spans);
    facets->layers = pvtAllocate(context, views * ROWS * LAYERS, sizeof *facets->layers);
    facets->values = pvtAllocate(context, views, sizeof *facets->values);
    return facets->frames == NULL || facets->factors == NULL || facets->masks == NULL ||
                   facets->spans == NULL || facets->layers == NULL || facets->values == NULL
               ? pvtContext_GetStatus(context)
               : PVT_OK;
}

static pvtStatus CopyMesh(pvtContext* context, const pvtMesh* mesh, pvtMesh* copy)
{
    const pvtStatus status = pvtCreateMesh(context, mesh->positions, mesh->positionCount,
                                           mesh->indices, mesh->triangleCount, copy);
    if (status != PVT_OK || mesh->positionCount >= 3 * mesh->triangleCount) {
        return status;
    }
    pvtVec3* more = pvtReallocate(context, copy->positions, 3 * mesh->triangleCount, sizeof *more);
    if (more == NULL) {
        return pvtContext_GetStatus(context);
    }
    copy->positions = more;
    copy->positionCount = 3 * mesh->triangleCount;
    return PVT_OK;
}

pvtStatus pvtCreateFacets(pvtContext* context, const pvtFacetOptions* options, const pvtMesh* mesh,
                          pvtFacets* facets)
{
    *facets = (pvtFacets){.screenCount = options->screen->count,
                          .viewCount = options->screen->count + options->more->count};
    assert(mesh->triangleCount <= PVT_MAX_FACETS);
    pvtStatus status = CopyMesh(context, mesh, &facets->mesh);
    if (status == PVT_OK) {
        status = AllocateMasks(context, facets);
    }
    if (status != PVT_OK) {
        pvtFacets_Free(context, facets);
        return status;
    }
    const size_t stride = pvtGetViewStride(facets->screenCount);
    for (size_t v = 0; v < facets->viewCount; ++v) {
        const pvtView* view = v < facets->screenCount
                                  ? &options->screen->views[v * stride % facets->screenCount]
                                  : &options->more->views[v - facets->screenCount];
        facets->frames[v] = pvtMakeMaskFrame(view, &options->bounds, ROWS);
        facets->factors[v] = GetFactor(view, &options->bounds, &facets->frames[v]);
    }
    Redraw(context, facets, NULL, facets->mesh.triangleCount);
    return PVT_OK;
}

// What the triangles that do not change cover, by going through all of them.
static void AddOthers(const pvtFacets* facets, const pvtFacetChange* change, size_t view,
                      uint64_t* rows)
{
    memset(rows, 0, ROWS * sizeof *rows);
    for (size_t t = 0, next = 0; t < facets->mesh.triangleCount; ++t) {
        if (next < (size_t)change->count && change->triangles[next] == t) {
            ++next;
        } else {
            AddMask(facets, t, view, rows);
        }
    }
}

// The same for at most three that change: pixels that are covered once more than those do. Rows
// where they have none stay as they are.
static void TakeFromLayers(const pvtFacets* facets, const pvtFacetChange* change, size_t view,
                           uint64_t* rows)
{
    const uint64_t* layers = GetLayers(facets, view);
    uint64_t taken[ROWS][LAYERS - 1];
    int first = ROWS, end = 0;
    for (int i = 0; i < change->count; ++i) {
        const uint8_t* span = facets->spans[change->triangles[i] * facets->viewCount + view];
        first = span[0] < first ? span[0] : first;
        end = span[1] > end ? span[1] : end;
    }
    memcpy(rows, layers, ROWS * sizeof *rows);
    if (first >= end) {
        return;
    }
    memset(taken[first], 0, (size_t)(end - first) * sizeof *taken);
    for (int i = 0; i < change->count; ++i) {
        const size_t mask = change->triangles[i] * facets->viewCount + view;
        const uint64_t* own = facets->masks + mask * ROWS;
        for (int y = facets->spans[mask][0]; y < facets->spans[mask][1]; ++y) {
            taken[y][2] |= taken[y][1] & own[y];
            taken[y][1] |= taken[y][0] & own[y];
            taken[y][0] |= own[y];
        }
    }
    for (int y = first; y < end; ++y) {
        rows[y] = (layers[y] & ~taken[y][0]) | (layers[ROWS + y] & ~taken[y][1]) |
                  (layers[2 * ROWS + y] & ~taken[y][2]) | layers[3 * ROWS + y];
    }
}

static double EvaluateView(const pvtFacets* facets, const pvtFacetChange* change,
                           pvtVec3 (*corners)[3], size_t view)
{
    uint64_t rows[ROWS];
    if (change->count < LAYERS) {
        TakeFromLayers(facets, change, view, rows);
    } else {
        AddOthers(facets, change, view, rows);
    }
    for (int i = 0; i < change->count; ++i) {
        uint64_t drawn[ROWS];
        uint8_t span[2];
        DrawTriangle(&facets->frames[view], corners[i], drawn, span);
        for (int y = span[0]; y < span[1]; ++y) {
            rows[y] |= drawn[y];
        }
    }
    return memcmp(rows, GetLayers(facets, view), sizeof rows) == 0
               ? facets->values[view]
               : facets->factors[view] * (double)pvtSumRectangles(rows);
}

typedef pvtVec3 ChangedCorners[PVT_MAX_CHANGED_FACETS][3];

static void PlaceCorners(const pvtFacets* facets, const pvtFacetChange* change,
                         ChangedCorners corners)
{
    for (int i = 0; i < change->count; ++i) {
        assert(i == 0 || change->triangles[i - 1] < change->triangles[i]);
        for (int c = 0; c < 3; ++c) {
            corners[i][c] = pvtGetChangedPlace(facets, change, change->corners[i][c]);
        }
    }
}

bool pvtScreenFacetChange(const pvtFacets* facets, const pvtFacetChange* change)
{
    ChangedCorners corners;
    PlaceCorners(facets, change, corners);
    double before = 0.0;
    double after = 0.0;
    size_t look = 1;
    for (size_t v = 0; v < facets->screenCount; ++v) {
        before += facets->values[v];
        after += EvaluateView(facets, change, corners, v);
        if (v + 1 == look * facets->screenCount / LOOKS) {
            if (after < before * (1.0 - MOST_LOSS)) {
                return false;
            }
            ++look;
        }
    }
    return after > before;
}

void pvtEvaluateFacetChange(const pvtFacets* facets, pvtFacetChange* change)
{
    ChangedCorners corners;
    PlaceCorners(facets, change, corners);
    change->total = 0.0;
    for (size_t v = 0; v < facets->viewCount; ++v) {
        change->total += EvaluateView(facets, change, corners, v);
        if (v + 1 == facets->screenCount) {
            change->screened = change->total;
        }
    }
}

void pvtApplyFacetChange(pvtContext* context, pvtFacets* facets, const pvtFacetChange* change)
{
    for (int i = 0; i < change->movedCount; ++i) {
        facets->mesh.positions[change->moved[i]] = change->places[i];
    }
    for (int i = 0; i < change->count; ++i) {
        memcpy(facets->mesh.indices + 3 * change->triangles[i], change->corners[i],
               sizeof change->corners[i]);
    }
    Redraw(context, facets, change->triangles, (size_t)change->count);
}
