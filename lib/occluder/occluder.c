// SPDX-License-Identifier: MIT
// Polygons on planes, and the triangles they make.
#include "occluder.h"

#include "base/context.h"

#include <string.h>

void pvtOccluder_Free(pvtContext* context, pvtOccluder* occluder)
{
    pvtRelease(context, occluder->planes);
    pvtLoopSet_Free(context, &occluder->loops);
    pvtMesh_Free(context, &occluder->mesh);
    *occluder = (pvtOccluder){0};
}

void pvtCut_Free(pvtContext* context, pvtCut* cut)
{
    pvtRelease(context, cut->triangles);
    pvtRelease(context, cut->ample);
    *cut = (pvtCut){0};
}

// The normal of (u, v, axis) points along +axis for x and z; (x, z, y) is left-handed.
static bool IsLeftHanded(const pvtPlane* plane)
{
    return plane->axis == PVT_AXIS_Y;
}

static float RoundCoordinate(double value)
{
    return (float)value;
}

static pvtStatus TriangulateLoop(pvtContext* context, const pvtOccluder* occluder, size_t loop,
                                 uint32_t* indices)
{
    const size_t first = occluder->loops.starts[loop];
    const size_t count = occluder->loops.starts[loop + 1] - first;
    const pvtStatus status =
        pvtTriangulatePolygon(context, occluder->loops.points + first, count, indices);
    if (status != PVT_OK) {
        return status;
    }
    for (size_t t = 0; t < count - 2; ++t) {
        uint32_t* corner = indices + 3 * t;
        if (IsLeftHanded(&occluder->planes[loop])) {
            const uint32_t swap = corner[1];
            corner[1] = corner[2];
            corner[2] = swap;
        }
        for (int c = 0; c < 3; ++c) {
            corner[c] += (uint32_t)first;
        }
    }
    return PVT_OK;
}

pvtStatus pvtMakeOccluderMesh(pvtContext* context, pvtOccluder* occluder)
{
    const pvtLoopSet* loops = &occluder->loops;
    pvtMesh mesh = {.positionCount = loops->pointCount};
    for (size_t loop = 0; loop < loops->loopCount; ++loop) {
        mesh.triangleCount += pvtCountPolygonTriangles(loops, loop);
    }
    mesh.positions = pvtAllocate(context, mesh.positionCount, sizeof *mesh.positions);
    mesh.indices = pvtAllocate(context, 3 * mesh.triangleCount, sizeof *mesh.indices);
    pvtStatus status =
        mesh.positions == NULL || mesh.indices == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    size_t triangle = 0;
    for (size_t loop = 0; loop < loops->loopCount && status == PVT_OK; ++loop) {
        for (size_t i = loops->starts[loop]; i < loops->starts[loop + 1]; ++i) {
            const pvtVec3 point =
                pvtPlane_ToWorld(&occluder->planes[loop], &occluder->frame, loops->points[i]);
            mesh.positions[i] = (pvtVec3){RoundCoordinate(point.x), RoundCoordinate(point.y),
                                          RoundCoordinate(point.z)};
        }
        status = TriangulateLoop(context, occluder, loop, mesh.indices + 3 * triangle);
        triangle += pvtCountPolygonTriangles(loops, loop);
    }
    if (status != PVT_OK) {
        pvtMesh_Free(context, &mesh);
        return status;
    }
    pvtMesh_Free(context, &occluder->mesh);
    occluder->mesh = mesh;
    return PVT_OK;
}

pvtStatus pvtAllocateOccluder(pvtContext* context, const pvtGridFrame* frame, size_t polygonCount,
                              size_t pointCount, pvtOccluder* occluder)
{
    *occluder = (pvtOccluder){.frame = *frame};
    occluder->planes = pvtAllocate(context, polygonCount, sizeof *occluder->planes);
    pvtLoopSet* loops = &occluder->loops;
    loops->points = pvtAllocate(context, pointCount, sizeof *loops->points);
    loops->starts = pvtAllocate(context, polygonCount + 1, sizeof *loops->starts);
    loops->parents = pvtAllocate(context, polygonCount, sizeof *loops->parents);
    if (occluder->planes == NULL || loops->points == NULL || loops->starts == NULL ||
        loops->parents == NULL) {
        pvtOccluder_Free(context, occluder);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

void pvtAddOccluderPolygon(pvtOccluder* occluder, const pvtPlane* plane, const pvtPoint2* points,
                           size_t count)
{
    pvtLoopSet* loops = &occluder->loops;
    memcpy(loops->points + loops->pointCount, points, count * sizeof *points);
    loops->pointCount += count;
    occluder->planes[loops->loopCount] = *plane;
    loops->parents[loops->loopCount] = -1;
    ++loops->loopCount;
    loops->starts[loops->loopCount] = loops->pointCount;
}

pvtStatus pvtJoinOccluders(pvtContext* context, const pvtOccluder* parts, size_t count,
                           pvtOccluder* joined)
{
    size_t polygons = 0, points = 0;
    for (size_t i = 0; i < count; ++i) {
        polygons += parts[i].loops.loopCount;
        points += parts[i].loops.pointCount;
    }
    pvtStatus status = pvtAllocateOccluder(context, &parts[0].frame, polygons, points, joined);
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        const pvtLoopSet* loops = &parts[i].loops;
        for (size_t p = 0; p < loops->loopCount; ++p) {
            const size_t first = loops->starts[p];
            pvtAddOccluderPolygon(joined, &parts[i].planes[p], loops->points + first,
                                  loops->starts[p + 1] - first);
        }
    }
    if (status == PVT_OK) {
        status = pvtMakeOccluderMesh(context, joined);
    }
    if (status != PVT_OK) {
        pvtOccluder_Free(context, joined);
    }
    return status;
}

pvtStatus pvtTakeCut(pvtContext* context, const pvtCandidateSet* candidates, const pvtCut* cut,
                     pvtOccluder* occluder)
{
    size_t polygons = 0;
    size_t points = 0;
    size_t longest = 0;
    for (size_t c = 0; c < cut->count; ++c) {
        if (cut->triangles[c] > 0) {
            const size_t length = (size_t)cut->triangles[c] + 2;
            ++polygons;
            points += length;
            longest = length > longest ? length : longest;
        }
    }
    pvtStatus status = pvtAllocateOccluder(context, &candidates->frame, polygons, points, occluder);
    pvtPoint2* link = pvtAllocate(context, longest, sizeof *link);
    if (status == PVT_OK && link == NULL) {
        status = pvtContext_GetStatus(context);
    }
    for (size_t c = 0; c < cut->count && status == PVT_OK; ++c) {
        if (cut->triangles[c] > 0) {
            const size_t count =
                pvtChainSet_GetLink(&candidates->chains, c, cut->triangles[c], link);
            pvtAddOccluderPolygon(occluder, &candidates->planes[c], link, count);
        }
    }
    if (status == PVT_OK) {
        status = pvtMakeOccluderMesh(context, occluder);
    }
    pvtRelease(context, link);
    if (status != PVT_OK) {
        pvtOccluder_Free(context, occluder);
    }
    return status;
}
