// SPDX-License-Identifier: MIT
// Panels on sheets grow to the surface's very edges. Cells of a quarter of a voxel leave a gap
// where two walls meet, that is seen through; here corners are moved on cells of a sixteenth.
#include "sheet_cover.h"
#include "sheets.h"

#include "base/context.h"
#include "fit.h"
#include "occluder.h"

enum { FINER = 4, ROUNDS = 4, MAX_CELLS = 8192, MAX_TRIANGLES = 50000, MAX_SHAPES = 4096 };

typedef struct EdgeTask {
    pvtContext* context;
    const pvtSheetSet* sheets;
    const pvtSheetSoup* soup;
    double deviation;
    pvtOccluder* occluder;
    pvtStatus* statuses; // one a polygon
} EdgeTask;

// Where corners may move: on cells, or on shapes.
typedef struct Room {
    const pvtBitmap* cells; // may be null
    int cellsPerVoxel;
    const pvtPlaneShapes* shapes;
} Room;

static bool IsWithin(const Room* room, const pvtPoint2 triangle[3])
{
    return room->cells != NULL ? pvtIsPolygonWithin(room->cells, room->cellsPerVoxel, triangle, 3)
                               : pvtPlaneShapes_Cover(room->shapes, triangle);
}

// Whether corner `index` may move there: what is added lies in the room, and the polygon grows.
static bool MayMove(const Room* room, pvtPoint2* points, size_t count, size_t index,
                    pvtPoint2 there)
{
    const pvtPoint2 here = points[index];
    const pvtPoint2 before = points[(index + count - 1) % count];
    const pvtPoint2 after = points[(index + 1) % count];
    const pvtPoint2 now[3] = {before, here, after};
    const pvtPoint2 then[3] = {before, there, after};
    const pvtPoint2 swept[2][3] = {{before, here, there}, {here, after, there}};
    if (there.x < 0 || there.y < 0 || pvtGetLoopArea2(then, 3) <= pvtGetLoopArea2(now, 3)) {
        return false;
    }
    points[index] = there;
    const bool isSimple = pvtIsPointSimple(points, count, index);
    points[index] = here;
    return isSimple && IsWithin(room, swept[0]) && IsWithin(room, swept[1]);
}

// Each corner, in steps that halve from the first to the second, in point units.
static void MoveCorners(const Room* room, const int32_t steps[2], pvtPoint2* points, size_t count)
{
    for (int round = 0; round < ROUNDS; ++round) {
        for (size_t i = 0; i < count; ++i) {
            for (int32_t step = steps[0]; step >= steps[1]; step /= 2) {
                for (int way = 0; way < 9; ++way) {
                    const pvtPoint2 there = {points[i].x + (way % 3 - 1) * step,
                                             points[i].y + (way / 3 - 1) * step};
                    if (MayMove(room, points, count, i, there)) {
                        points[i] = there;
                    }
                }
            }
        }
    }
}

// The last sixteenth of a voxel, exactly; where there are few triangles, as on walls.
static pvtStatus MoveExactly(const EdgeTask* task, const pvtPlane* plane, pvtPoint2* points,
                             size_t count)
{
    pvtPlaneShapes shapes;
    const pvtStatus status =
        pvtCollectPlaneShapes(task->context, task->soup, plane, task->deviation, &shapes);
    if (status == PVT_OK && shapes.count <= MAX_SHAPES) {
        const Room room = {.shapes = &shapes};
        MoveCorners(&room, (int32_t[2]){(1 << PVT_POINT_BITS) / 16, 1}, points, count);
    }
    pvtPlaneShapes_Free(task->context, &shapes);
    return status;
}

static pvtStatus GrowPolygon(const EdgeTask* task, size_t polygon)
{
    const pvtPlane* plane = &task->occluder->planes[polygon];
    const pvtLoopSet* loops = &task->occluder->loops;
    if (pvtSheetSet_Find(task->sheets, plane) == NULL) {
        return PVT_OK;
    }
    const int scale = FINER * task->sheets->cellsPerVoxel;
    const int width = task->soup->frame.size[pvtPlane_GetU(plane)] * scale;
    const int height = task->soup->frame.size[pvtPlane_GetV(plane)] * scale;
    if (width > MAX_CELLS || height > MAX_CELLS) {
        return PVT_OK;
    }
    pvtBitmap cells;
    pvtStatus status = pvtCreateBitmap(task->context, width, height, &cells);
    if (status == PVT_OK) {
        status = pvtCoverPlane(task->context, task->soup, plane, task->deviation, scale, &cells);
    }
    pvtPoint2* points = loops->points + loops->starts[polygon];
    const size_t count = loops->starts[polygon + 1] - loops->starts[polygon];
    if (status == PVT_OK) {
        const Room room = {.cells = &cells, .cellsPerVoxel = scale};
        const int32_t unit = (1 << PVT_POINT_BITS) / scale;
        MoveCorners(&room, (int32_t[2]){FINER * unit, unit > 4 ? unit / 4 : 1}, points, count);
        status = MoveExactly(task, plane, points, count);
    }
    pvtBitmap_Free(task->context, &cells);
    return status;
}

static void RunGrow(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    EdgeTask* task = taskData;
    for (size_t p = begin; p < end; ++p) {
        task->statuses[p] = pvtIsCancelled(task->context) ? PVT_CANCELLED : GrowPolygon(task, p);
    }
}

pvtStatus pvtGrowSheetPanels(pvtContext* context, const pvtSheetSet* sheets, double deviation,
                             const pvtMesh* mesh, pvtOccluder* occluder)
{
    const size_t count = occluder->loops.loopCount;
    if (sheets->count == 0 || mesh->triangleCount > MAX_TRIANGLES) {
        return PVT_OK;
    }
    pvtSheetSoup soup;
    pvtStatus status = pvtCreateSheetSoup(context, mesh, &occluder->frame, &soup);
    pvtStatus* statuses = pvtAllocate(context, count, sizeof *statuses);
    if (status == PVT_OK && statuses == NULL) {
        status = pvtContext_GetStatus(context);
    }
    if (status == PVT_OK && statuses != NULL) {
        EdgeTask task = {context, sheets, &soup, deviation, occluder, statuses};
        pvtParallelFor(context, RunGrow, count, 1, &task);
    }
    for (size_t p = 0; p < count && status == PVT_OK && statuses != NULL; ++p) {
        status = statuses[p];
    }
    if (status == PVT_OK) {
        status = pvtMakeOccluderMesh(context, occluder);
    }
    pvtRelease(context, statuses);
    pvtSheetSoup_Free(context, &soup);
    return status == PVT_CANCELLED ? pvtFailCancelled(context) : status;
}
