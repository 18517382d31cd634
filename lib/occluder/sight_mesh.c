// SPDX-License-Identifier: MIT
// Sights of a mesh: it is drawn, as pvtEvaluateOccluders does.
#include "sight_subject.h"

#include "base/context.h"
#include "base/vector.h"
#include "evaluate/raster.h"
#include "voxel/bit_grid.h"

#include <math.h>

enum { SIZE = PVT_SIGHT_SIZE, WORDS = PVT_SIGHT_WORDS };

static const double MANY_TRIANGLES = 1e5; // of which sights are fewer, so that time stays bounded

// What a worker draws with.
typedef struct Canvas {
    pvtRaster raster;
    pvtScreenPoint* points;
} Canvas;

typedef struct Drawer {
    pvtContext* context;
    pvtGridFrame frame;
    pvtSoup soup;
    Canvas* canvases; // one a worker
    int canvasCount;
} Drawer;

static void DrawGoal(const void* data, const pvtView* view, int worker, pvtSight* sight)
{
    const Drawer* drawer = data;
    const Canvas* canvas = &drawer->canvases[worker];
    const double pixelSize = (double)sight->pixelSize * drawer->frame.voxelSize;
    const pvtScreen screen = {
        .direction = view->direction,
        .right = view->right,
        .up = view->up,
        .lower = {pvtDot(view->right, drawer->frame.origin) - pixelSize * (double)sight->x,
                  pvtDot(view->up, drawer->frame.origin) - pixelSize * (double)sight->y},
        .pixelSize = pixelSize,
        .width = SIZE,
        .height = SIZE};
    pvtRaster raster = canvas->raster;
    // There is room, so that this clears it.
    if (pvtRaster_Resize(drawer->context, &raster, SIZE, SIZE) != PVT_OK ||
        !pvtRasterizeSoup(drawer->context, &screen, &drawer->soup, canvas->points, &raster)) {
        return;
    }
    for (int y = 0; y < SIZE; ++y) {
        for (int half = 0; half < WORDS; ++half) {
            sight->goal.words[half][y] = raster.words[WORDS * y + half];
        }
    }
}

static pvtStatus MakeCanvases(Drawer* drawer)
{
    pvtContext* context = drawer->context;
    drawer->canvasCount = pvtContext_GetThreadCount(context);
    drawer->canvases = pvtAllocate(context, (size_t)drawer->canvasCount, sizeof *drawer->canvases);
    if (drawer->canvases == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtStatus status = PVT_OK;
    for (int i = 0; i < drawer->canvasCount && status == PVT_OK; ++i) {
        Canvas* canvas = &drawer->canvases[i];
        canvas->points = pvtAllocate(context, drawer->soup.positionCount, sizeof *canvas->points);
        status = canvas->points == NULL ? pvtContext_GetStatus(context)
                                        : pvtRaster_Resize(context, &canvas->raster, SIZE, SIZE);
    }
    return status;
}

static void FreeDrawer(Drawer* drawer)
{
    for (int i = 0; i < drawer->canvasCount && drawer->canvases != NULL; ++i) {
        pvtRaster_Free(drawer->context, &drawer->canvases[i].raster);
        pvtRelease(drawer->context, drawer->canvases[i].points);
    }
    pvtRelease(drawer->context, drawer->canvases);
    pvtSoup_Free(drawer->context, &drawer->soup);
}

pvtStatus pvtCreateMeshSights(pvtContext* context, const pvtSightOptions* options,
                              const pvtGridFrame* frame, const pvtMesh* mesh, pvtSightSet* set)
{
    *set = (pvtSightSet){0};
    Drawer drawer = {.context = context, .frame = *frame};
    pvtStatus status = pvtCreateSoup(context, "the mesh", mesh, &drawer.soup);
    if (status == PVT_OK) {
        status = MakeCanvases(&drawer);
    }
    if (status == PVT_OK) {
        const bool hasTriangles = drawer.soup.triangleCount > 0;
        const pvtVec3 origin = frame->origin;
        const pvtVec3 low = pvtToGrid(frame, hasTriangles ? drawer.soup.bounds.lower : origin);
        const pvtVec3 high = hasTriangles
                                 ? pvtToGrid(frame, drawer.soup.bounds.upper)
                                 : (pvtVec3){frame->size[0], frame->size[1], frame->size[2]};
        pvtSightSubject subject = {
            .data = &drawer,
            .share = fmin(1.0, MANY_TRIANGLES / fmax(1.0, (double)drawer.soup.triangleCount)),
            .isExact = true,
            .draw = DrawGoal};
        for (int axis = 0; axis < 3; ++axis) {
            subject.low[axis] = (float)pvtGetAxis(low, axis);
            subject.high[axis] = (float)pvtGetAxis(high, axis);
        }
        status = pvtMakeSights(context, options, &subject, set);
        // There are fewer for the mesh's sake alone: what climbs has as far to go.
        set->share = 1.0;
    }
    FreeDrawer(&drawer);
    return status;
}
