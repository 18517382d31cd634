// SPDX-License-Identifier: MIT
// Gradient ascent on a softened recall. The paper selects sections and leaves them as they are;
// trying random changes one by one, as refine.c and bend.c do, spends nearly all of its time on
// changes that leave the inside. Here each step looks from a few dozen of many views, adds up which
// way all corners are pulled (pull.c), takes from that what would lead outside (contacts.c), and
// moves each corner by about the same length (Kingma and Ba, Adam, 2015). As steps look from ever
// other views, there is nothing to gain from the pixels of any of them.
//
// More triangles than the budget has start, and the least useful are taken away while the others
// move on: those that are left had the choice of their places (climb.c, restructure.c). What the
// climbs from several starts end at is united, and thinned out in the same way. A mesh that
// has climbed is inside but for a fraction of a voxel, and settles until the exact test agrees
// (settle.c, polish.c).
#include "ascent.h"
#include "ascent_state.h"
#include "occluder.h"

#include "base/context.h"
#include "base/vector.h"
#include "voxel/bit_grid.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    QUADS = 400,            // drawn a sight
    GOAL_RESOLUTION = 256,  // nodes, about twice as many as pixels
    FIELD_RESOLUTION = 288, // nodes: a voxel each at the default resolution, in a band as well
};

static const double TOUCHED = 1.8; // [vx] from the surface to the far corner of a touched voxel

int pvtGetAscentStart(int budget)
{
    return 2 * budget;
}

pvtVec3 pvtAscent_GetPlace(const pvtAscent* ascent, const float corner[3])
{
    const double h = ascent->frame.voxelSize;
    const pvtVec3 origin = ascent->frame.origin;
    return (pvtVec3){(float)(origin.x + h * (double)corner[0]),
                     (float)(origin.y + h * (double)corner[1]),
                     (float)(origin.z + h * (double)corner[2])};
}

void pvtAscent_GetTriangle(const pvtAscent* ascent, int triangle, pvtVec3 corners[3])
{
    for (int k = 0; k < 3; ++k) {
        const float* corner = ascent->set.corners[ascent->set.triangles[triangle][k]];
        corners[k] = pvtToGrid(&ascent->frame, pvtAscent_GetPlace(ascent, corner));
    }
}

void pvtAscent_AddCorners(pvtAscent* ascent, const pvtMesh* mesh)
{
    for (size_t c = 0; c < mesh->positionCount; ++c) {
        const pvtVec3 at = pvtToGrid(&ascent->frame, mesh->positions[c]);
        pvtTriangleSet_AddCorner(&ascent->set, (float[3]){(float)at.x, (float)at.y, (float)at.z},
                                 false);
    }
}

static void FreeAscent(pvtContext* context, pvtAscent* ascent)
{
    pvtTriangleSet_Free(context, &ascent->set);
    pvtTriangleSet_Free(context, &ascent->start);
    pvtTriangleSet_Free(context, &ascent->best);
    pvtTriangleSet_Free(context, &ascent->rival);
    pvtField_Free(context, &ascent->field);
    pvtSightSet_Free(context, &ascent->sights);
    pvtPuller_Free(context, &ascent->puller);
    pvtContactSet_Free(context, &ascent->contacts);
    pvtRelease(context, ascent->speeds);
    pvtRelease(context, ascent->squares);
    pvtRelease(context, ascent->moved);
    pvtRelease(context, ascent);
}

static size_t GetFirstPolygon(const pvtAscent* ascent, int start)
{
    return start > 0 ? ascent->options->startEnds[start - 1] : 0;
}

// Triangles in the order of their polygons, as pvtMakeOccluderMesh left them.
static void AddTriangles(const pvtMesh* mesh, int start, pvtAscent* ascent)
{
    const pvtOccluder* occluder = ascent->occluder;
    const pvtSheetSet* sheets = ascent->options->sheets;
    size_t triangle = 0;
    for (size_t p = GetFirstPolygon(ascent, start); p < ascent->options->startEnds[start]; ++p) {
        const bool isFixed =
            sheets != NULL && pvtSheetSet_Find(sheets, &occluder->planes[p]) != NULL;
        const size_t end = triangle + pvtCountPolygonTriangles(&occluder->loops, p);
        for (; triangle < end; ++triangle) {
            const uint32_t* corners = mesh->indices + 3 * triangle;
            pvtTriangleSet_AddTriangle(&ascent->set, corners, (int32_t)p);
            for (int k = 0; k < 3 && isFixed; ++k) {
                ascent->set.isFixed[corners[k]] = true;
            }
        }
    }
    assert(triangle == mesh->triangleCount);
}

// Its triangles lie together, as its polygons do.
static pvtMesh GetStartMesh(const pvtAscent* ascent, int start)
{
    const size_t firstPolygon = GetFirstPolygon(ascent, start);
    const size_t endPolygon = ascent->options->startEnds[start];
    pvtMesh mesh = ascent->occluder->mesh;
    for (size_t p = 0; p < firstPolygon; ++p) {
        mesh.indices += 3 * pvtCountPolygonTriangles(&ascent->occluder->loops, p);
    }
    mesh.triangleCount = 0;
    for (size_t p = firstPolygon; p < endPolygon; ++p) {
        mesh.triangleCount += pvtCountPolygonTriangles(&ascent->occluder->loops, p);
    }
    return mesh;
}

pvtStatus pvtAscent_TakeStart(pvtContext* context, pvtAscent* ascent, int start)
{
    const pvtMesh own = GetStartMesh(ascent, start);
    pvtMesh welded;
    const pvtStatus status = pvtWeldMesh(context, &own, &welded);
    if (status != PVT_OK) {
        return status;
    }
    ascent->set.cornerCount = ascent->set.triangleCount = 0;
    pvtAscent_AddCorners(ascent, &welded);
    AddTriangles(&welded, start, ascent);
    pvtTriangleSet_FindEdges(&ascent->set);
    pvtMesh_Free(context, &welded);
    return PVT_OK;
}

static pvtStatus MakeRoom(pvtContext* context, pvtAscent* ascent)
{
    int triangles = 2 * ascent->options->budget + 8;
    for (int s = 0; s < ascent->options->startCount; ++s) {
        const int start = (int)GetStartMesh(ascent, s).triangleCount;
        triangles = start > triangles ? start : triangles;
    }
    const size_t corners = 3 * (size_t)triangles;
    pvtTriangleSet* const sets[] = {&ascent->set, &ascent->start, &ascent->best, &ascent->rival};
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < sizeof sets / sizeof *sets && status == PVT_OK; ++i) {
        status = pvtCreateTriangleSet(context, (int)corners, triangles, sets[i]);
    }
    if (status == PVT_OK) {
        status = pvtCreateContacts(context, triangles, &ascent->contacts);
    }
    ascent->speeds = pvtAllocate(context, corners, sizeof *ascent->speeds);
    ascent->squares = pvtAllocate(context, corners, sizeof *ascent->squares);
    ascent->moved = pvtAllocate(context, corners, sizeof *ascent->moved);
    return status == PVT_OK &&
                   (ascent->speeds == NULL || ascent->squares == NULL || ascent->moved == NULL)
               ? pvtContext_GetStatus(context)
               : status;
}

static pvtStatus MakeSights(pvtContext* context, pvtAscent* ascent)
{
    const pvtAscentOptions* options = ascent->options;
    const pvtSightOptions sights = {.views = options->views,
                                    .count = options->sights,
                                    .stray = options->stray / ascent->frame.voxelSize + TOUCHED,
                                    .quads = QUADS,
                                    .seed = options->seed};
    if (options->mostWrong > 0.0) {
        return pvtCreateMeshSights(context, &sights, &ascent->frame, options->mesh,
                                   &ascent->sights);
    }
    pvtField goal;
    pvtStatus status =
        pvtCreateField(context, options->goal, options->goalCells, GOAL_RESOLUTION, &goal);
    if (status == PVT_OK) {
        status = pvtCreateSights(context, &sights, &goal, &ascent->sights);
        pvtField_Free(context, &goal);
    }
    return status;
}

static pvtStatus Prepare(pvtContext* context, pvtAscent* ascent)
{
    pvtStatus status = MakeRoom(context, ascent);
    if (status == PVT_OK) {
        status = pvtAscent_TakeStart(context, ascent, 0);
    }
    if (status == PVT_OK) {
        status = MakeSights(context, ascent);
    }
    if (status == PVT_OK) {
        status = pvtCreateField(context, ascent->options->inside->interior.allowed,
                                ascent->options->inside->interior.cells, FIELD_RESOLUTION,
                                &ascent->field);
    }
    if (status == PVT_OK) {
        status = pvtCreatePuller(context, &ascent->sights, &ascent->set, &ascent->puller);
    }
    if (status == PVT_OK) {
        pvtTriangleSet_Copy(&ascent->set, &ascent->start);
    }
    return status;
}

// Polygons of which no triangle is left go; the others stay in order.
static void KeepPolygons(const pvtAscent* ascent, pvtOccluder* occluder)
{
    pvtLoopSet* loops = &occluder->loops;
    size_t kept = 0, points = 0;
    for (size_t p = 0; p < loops->loopCount; ++p) {
        const size_t first = loops->starts[p], count = loops->starts[p + 1] - first;
        bool isUsed = false;
        for (int t = 0; t < ascent->set.triangleCount && !isUsed; ++t) {
            isUsed = ascent->set.tags[t] == (int32_t)p;
        }
        if (isUsed) {
            occluder->planes[kept] = occluder->planes[p];
            memmove(loops->points + points, loops->points + first, count * sizeof *loops->points);
            loops->starts[kept++] = points;
            points += count;
        }
    }
    loops->starts[kept] = points;
    loops->loopCount = kept;
    loops->pointCount = points;
}

static pvtStatus StoreTriangles(pvtContext* context, const pvtAscent* ascent, pvtOccluder* occluder)
{
    const pvtTriangleSet* set = &ascent->set;
    pvtVec3* places = pvtAllocate(context, (size_t)set->cornerCount, sizeof *places);
    if (places == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (int c = 0; c < set->cornerCount; ++c) {
        places[c] = pvtAscent_GetPlace(ascent, set->corners[c]);
    }
    pvtMesh mesh;
    const pvtStatus status = pvtCreateMesh(context, places, (size_t)set->cornerCount,
                                           set->triangles[0], (size_t)set->triangleCount, &mesh);
    if (status == PVT_OK) {
        pvtMesh_Free(context, &occluder->mesh);
        occluder->mesh = mesh;
        KeepPolygons(ascent, occluder);
    }
    pvtRelease(context, places);
    return status;
}

pvtStatus pvtAscendOccluder(pvtContext* context, const pvtAscentOptions* options,
                            pvtOccluder* occluder)
{
    assert(options->budget >= 1 && options->budget <= PVT_MOST_ASCENT);
    assert(options->startCount >= 1 &&
           options->startEnds[options->startCount - 1] == occluder->loops.loopCount);
    pvtAscent* ascent = pvtAllocate(context, 1, sizeof *ascent);
    if (ascent == NULL) {
        return pvtContext_GetStatus(context);
    }
    ascent->options = options;
    ascent->occluder = occluder;
    ascent->frame = occluder->frame;
    pvtStatus status = Prepare(context, ascent);
    if (status == PVT_OK) {
        status = pvtAscent_Climb(context, ascent);
    }
    if (status == PVT_OK) {
        status = pvtAscent_Polish(context, ascent);
    }
    if (status == PVT_OK) {
        status = StoreTriangles(context, ascent, occluder);
    }
    FreeAscent(context, ascent);
    return status;
}
