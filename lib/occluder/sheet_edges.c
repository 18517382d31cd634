// SPDX-License-Identifier: MIT
// Panels on sheets grow to the surface's very edges. Cells of a quarter of a voxel leave a gap
// where two walls meet, that is seen through; here corners are moved on cells of a sixteenth.
#include "sheet_cover.h"
#include "sheets.h"

#include "base/context.h"
#include "fit.h"
#include "occluder.h"
#include "section/predicates.h"

#include <math.h>
#include <string.h>

enum { FINER = 4, ROUNDS = 4, MAX_CELLS = 8192, MAX_TRIANGLES = 50000, MAX_SHAPES = 4096 };

// [vx²] What may stay open around a corner in all rounds, beyond the cells: less than the check
// after the build looks at where it is in one place.
static const double CRACKS = 6e-6;

typedef struct EdgeTask {
    pvtContext* context;
    const pvtSheetSet* sheets;
    const pvtSheetSoup* soup;
    double deviation;
    pvtOccluder* occluder;
    const pvtSheet** on; // one a polygon: the sheet that it lies on, or null
    size_t* counts;      // one a polygon: of the points that are left of it
    pvtStatus* statuses; // one a sheet
} EdgeTask;

// Where corners may move: on cells, or on shapes.
typedef struct Room {
    const pvtBitmap* cells; // may be null
    int cellsPerVoxel;
    const pvtPlaneShapes* shapes;
    double* open; // [vx²] what may stay uncovered by shapes
} Room;

// All of them, or none counts.
static bool AreWithin(const Room* room, const pvtPoint2 (*triangles)[3], size_t count)
{
    double open = *room->open;
    for (size_t t = 0; t < count; ++t) {
        if (room->cells != NULL
                ? !pvtIsPolygonWithin(room->cells, room->cellsPerVoxel, triangles[t], 3)
                : !pvtPlaneShapes_Cover(room->shapes, triangles[t], &open)) {
            return false;
        }
    }
    *room->open = open;
    return true;
}

// Whether what a corner sweeps is wholly outside of the polygon where it is added, or inside of it
// where it is taken away, as it is unless the polygon runs over itself.
static bool IsSweepClear(const pvtPoint2* points, size_t count, const pvtPoint2 swept[3])
{
    const int64_t area = pvtGetLoopArea2(swept, 3);
    return area == 0 || pvtGetWinding(points, count, swept) == (area > 0 ? 0 : 1);
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
    // The short edges first, then the new ones: most moves fail there.
    const pvtPoint2 swept[2][3] = {{here, there, before}, {here, there, after}};
    const pvtPoint2 added[2][3] = {{before, there, here}, {here, there, after}};
    if (there.x < 0 || there.y < 0 || pvtGetLoopArea2(then, 3) <= pvtGetLoopArea2(now, 3) ||
        !IsSweepClear(points, count, added[0]) || !IsSweepClear(points, count, added[1])) {
        return false;
    }
    points[index] = there;
    const bool isFree = pvtIsPointFree(points, count, index);
    points[index] = here;
    return isFree && AreWithin(room, swept, 2);
}

// `step` further along the edge from `before` to `here`.
static pvtPoint2 GetBeyond(pvtPoint2 before, pvtPoint2 here, int32_t step)
{
    const double dx = here.x - before.x, dy = here.y - before.y;
    const double length = hypot(dx, dy);
    const double part = length > 0.0 ? step / length : 0.0;
    return (pvtPoint2){here.x + (int32_t)lround(part * dx), here.y + (int32_t)lround(part * dy)};
}

// In eight directions, and along its two edges: what ends on a slant gets to its end that way.
static void MoveCorner(const Room* room, int32_t step, pvtPoint2* points, size_t count, size_t i)
{
    enum { WAYS = 9 };
    for (int way = 0; way < WAYS; ++way) {
        const pvtPoint2 there = {points[i].x + (way % 3 - 1) * step,
                                 points[i].y + (way / 3 - 1) * step};
        if (MayMove(room, points, count, i, there)) {
            points[i] = there;
        }
    }
    for (size_t side = 0; side < 2; ++side) {
        const pvtPoint2 from = points[(i + (side == 0 ? count - 1 : 1)) % count];
        const pvtPoint2 beyond = GetBeyond(from, points[i], step);
        // Rounding may lead out of the room; of shapes, which take long to ask, that is left at it.
        const int ways = room->cells != NULL ? WAYS : 1;
        for (int way = 0; way < ways; ++way) {
            const pvtPoint2 there = {beyond.x + (way + 4) % WAYS % 3 - 1,
                                     beyond.y + (way + 4) % WAYS / 3 - 1};
            if (MayMove(room, points, count, i, there)) {
                points[i] = there;
                break;
            }
        }
    }
}

// Each corner, in steps that halve from the first to the second, in point units.
static void MoveCorners(const Room* room, const int32_t steps[2], pvtPoint2* points, size_t count)
{
    for (int round = 0; round < ROUNDS; ++round) {
        for (size_t i = 0; i < count; ++i) {
            *room->open = CRACKS / ROUNDS;
            for (int32_t step = steps[0]; step >= steps[1]; step /= 2) {
                MoveCorner(room, step, points, count, i);
            }
        }
    }
}

// Whether another corner is in the same place, as at the ends of a bridge.
static bool IsDouble(const pvtPoint2* points, size_t count, size_t index)
{
    for (size_t i = 0; i < count; ++i) {
        if (i != index && pvtIsSamePoint(points[i], points[index])) {
            return true;
        }
    }
    return false;
}

static void RemovePoint(pvtPoint2* points, size_t count, size_t index)
{
    memmove(points + index, points + index + 1, (count - index - 1) * sizeof *points);
}

// Whether the corner of a notch went: where all of the notch lies in the room.
static bool FillNotch(const Room* room, pvtPoint2* points, size_t count, size_t i)
{
    const pvtPoint2 here = points[i];
    const pvtPoint2 notch[3] = {points[(i + count - 1) % count], points[(i + 1) % count], here};
    if (pvtGetLoopArea2(notch, 3) < 0 || IsDouble(points, count, i) ||
        !IsSweepClear(points, count, notch) || !AreWithin(room, &notch, 1)) {
        return false;
    }
    RemovePoint(points, count, i);
    // The edge that closes it is one of those at the corner before.
    if (pvtIsPointFree(points, count - 1, i > 0 ? i - 1 : count - 2)) {
        return true;
    }
    memmove(points + i + 1, points + i, (count - i - 1) * sizeof *points);
    points[i] = here;
    return false;
}

// Notches, as the steps of cells along a slanted edge leave, are filled, and spikes go that holes
// leave which were filled. Returns how many points are left.
static size_t FillNotches(const Room* room, pvtPoint2* points, size_t count)
{
    for (size_t i = 0; i < count && count > 3;) {
        *room->open = CRACKS / ROUNDS;
        const bool isSpike =
            count > 4 && pvtIsSamePoint(points[(i + count - 1) % count], points[(i + 1) % count]);
        if (isSpike) {
            const size_t after = (i + 1) % count;
            RemovePoint(points, count, after > i ? after : i);
            RemovePoint(points, count - 1, after > i ? i : after);
            count -= 2;
            i = 0;
        } else if (FillNotch(room, points, count, i)) {
            --count;
        } else {
            ++i;
        }
    }
    return count;
}

// Whether triangles of it lie beside each other.
static pvtStatus TestPolygon(pvtContext* context, const pvtPoint2* points, size_t count,
                             bool* isSound)
{
    uint32_t* indices = pvtAllocate(context, 3 * (count - 2), sizeof *indices);
    if (indices == NULL) {
        return pvtContext_GetStatus(context);
    }
    const pvtStatus status = pvtTriangulatePolygon(context, points, count, indices);
    *isSound = status == PVT_OK;
    for (size_t t = 0; t < count - 2 && *isSound; ++t) {
        const uint32_t* corners = indices + 3 * t;
        const pvtPoint2 triangle[3] = {points[corners[0]], points[corners[1]], points[corners[2]]};
        *isSound = pvtGetLoopArea2(triangle, 3) == 0 || pvtGetWinding(points, count, triangle) == 1;
    }
    pvtRelease(context, indices);
    return status == PVT_INVALID_ARGUMENT ? PVT_OK : status;
}

// On the cells, and then the last sixteenth of a voxel exactly, where there are few triangles, as
// on walls. A polygon that would run over itself stays as it was.
static pvtStatus GrowPolygon(pvtContext* context, const Room* coarse, const Room* exact,
                             pvtPoint2* points, size_t* count)
{
    const int32_t unit = (1 << PVT_POINT_BITS) / coarse->cellsPerVoxel;
    const size_t before = *count;
    pvtPoint2* kept = pvtAllocate(context, before, sizeof *kept);
    if (kept == NULL) {
        return pvtContext_GetStatus(context);
    }
    memcpy(kept, points, before * sizeof *kept);
    MoveCorners(coarse, (int32_t[2]){FINER * unit, unit > 4 ? unit / 4 : 1}, points, before);
    if (exact->shapes->count <= MAX_SHAPES) {
        *count = FillNotches(exact, points, *count);
        MoveCorners(exact, (int32_t[2]){(1 << PVT_POINT_BITS) / 16, 1}, points, *count);
        *count = FillNotches(exact, points, *count);
    }
    bool isSound = false;
    const pvtStatus status = TestPolygon(context, points, *count, &isSound);
    if (!isSound) {
        memcpy(points, kept, before * sizeof *kept);
        *count = before;
    }
    pvtRelease(context, kept);
    return status;
}

// All polygons that lie on a sheet.
static pvtStatus GrowPolygons(const EdgeTask* task, const pvtSheet* sheet, const pvtBitmap* cells)
{
    const pvtLoopSet* loops = &task->occluder->loops;
    pvtPlaneShapes shapes;
    pvtStatus status =
        pvtCollectPlaneShapes(task->context, task->soup, &sheet->plane, task->deviation, &shapes);
    double open = 0.0;
    const Room coarse = {
        .cells = cells, .cellsPerVoxel = FINER * task->sheets->cellsPerVoxel, .open = &open};
    const Room exact = {.shapes = &shapes, .open = &open};
    for (size_t p = 0; p < loops->loopCount && status == PVT_OK; ++p) {
        if (pvtIsCancelled(task->context)) {
            status = PVT_CANCELLED;
        } else if (task->on[p] == sheet) {
            status = GrowPolygon(task->context, &coarse, &exact, loops->points + loops->starts[p],
                                 &task->counts[p]);
        }
    }
    pvtPlaneShapes_Free(task->context, &shapes);
    return status;
}

static pvtStatus GrowOnSheet(const EdgeTask* task, const pvtSheet* sheet)
{
    const pvtPlane* plane = &sheet->plane;
    bool isUsed = false;
    for (size_t p = 0; p < task->occluder->loops.loopCount && !isUsed; ++p) {
        isUsed = task->on[p] == sheet;
    }
    const int scale = FINER * task->sheets->cellsPerVoxel;
    const int width = task->soup->frame.size[pvtPlane_GetU(plane)] * scale;
    const int height = task->soup->frame.size[pvtPlane_GetV(plane)] * scale;
    if (!isUsed || width > MAX_CELLS || height > MAX_CELLS) {
        return PVT_OK;
    }
    pvtBitmap cells;
    pvtStatus status = pvtCreateBitmap(task->context, width, height, &cells);
    if (status == PVT_OK) {
        status = pvtCoverPlane(task->context, task->soup, plane, task->deviation, scale, &cells);
    }
    if (status == PVT_OK) {
        status = GrowPolygons(task, sheet, &cells);
    }
    pvtBitmap_Free(task->context, &cells);
    return status;
}

// Points stand one polygon behind the other again.
static void PackPoints(const size_t* counts, pvtLoopSet* loops)
{
    size_t next = 0;
    for (size_t p = 0; p < loops->loopCount; ++p) {
        memmove(loops->points + next, loops->points + loops->starts[p],
                counts[p] * sizeof *loops->points);
        loops->starts[p] = next;
        next += counts[p];
    }
    loops->starts[loops->loopCount] = next;
    loops->pointCount = next;
}

static void RunGrow(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    EdgeTask* task = taskData;
    for (size_t s = begin; s < end; ++s) {
        task->statuses[s] = pvtIsCancelled(task->context)
                                ? PVT_CANCELLED
                                : GrowOnSheet(task, &task->sheets->sheets[s]);
    }
}

static pvtStatus GrowAll(EdgeTask* task)
{
    pvtLoopSet* loops = &task->occluder->loops;
    const size_t sheetCount = task->sheets->count;
    for (size_t p = 0; p < loops->loopCount; ++p) {
        task->counts[p] = loops->starts[p + 1] - loops->starts[p];
        task->on[p] = pvtSheetSet_Find(task->sheets, &task->occluder->planes[p]);
    }
    pvtParallelFor(task->context, RunGrow, sheetCount, 1, task);
    for (size_t s = 0; s < sheetCount; ++s) {
        if (task->statuses[s] != PVT_OK) {
            return task->statuses[s];
        }
    }
    PackPoints(task->counts, loops);
    return pvtMakeOccluderMesh(task->context, task->occluder);
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
    EdgeTask task = {.context = context,
                     .sheets = sheets,
                     .soup = &soup,
                     .deviation = deviation,
                     .occluder = occluder,
                     .on = pvtAllocate(context, count, sizeof *task.on),
                     .counts = pvtAllocate(context, count, sizeof *task.counts),
                     .statuses = pvtAllocate(context, sheets->count, sizeof *task.statuses)};
    if (status == PVT_OK) {
        status = task.on != NULL && task.counts != NULL && task.statuses != NULL
                     ? GrowAll(&task)
                     : pvtContext_GetStatus(context);
    }
    pvtRelease(context, task.on);
    pvtRelease(context, task.counts);
    pvtRelease(context, task.statuses);
    pvtSheetSoup_Free(context, &soup);
    return status == PVT_CANCELLED ? pvtFailCancelled(context) : status;
}
