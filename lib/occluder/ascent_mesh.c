// SPDX-License-Identifier: MIT
// A mesh of no more triangles than the budget is an occluder of itself, once it is inside: for a
// box nothing is better. Where nothing but rows of holes is to be hidden, the polygons as they were
// selected may be better than where a climb leads. What hides no more than the climbs do is not
// kept.
#include "ascent_state.h"

#include "base/context.h"
#include "base/vector.h"
#include "voxel/bit_grid.h"

#include <math.h>
#include <string.h>

// The middle of the node that is deepest inside, where a triangle without any extent is inside.
static void FindDeepest(const pvtField* field, float place[3])
{
    const float side = (float)field->nodeSize;
    int8_t deepest = INT8_MIN;
    for (int z = 0; z < field->size[2]; ++z) {
        for (int y = 0; y < field->size[1]; ++y) {
            for (int x = 0; x < field->size[0]; ++x) {
                const int8_t depth = pvtField_GetNode(field, x, y, z);
                if (depth > deepest) {
                    deepest = depth;
                    place[0] = ((float)x + 0.5F) * side;
                    place[1] = ((float)y + 0.5F) * side;
                    place[2] = ((float)z + 0.5F) * side;
                }
            }
        }
    }
}

static void GetMiddleAndNormal(const pvtTriangleSet* set, const uint32_t corners[3],
                               pvtVec3* middle, pvtVec3* normal)
{
    pvtVec3 places[3];
    for (int k = 0; k < 3; ++k) {
        const float* place = set->corners[corners[k]];
        places[k] = (pvtVec3){(double)place[0], (double)place[1], (double)place[2]};
    }
    *middle = pvtScale(pvtAdd(places[0], pvtAdd(places[1], places[2])), 1.0 / 3.0);
    *normal = pvtNormalize(pvtCross(pvtSub(places[1], places[0]), pvtSub(places[2], places[0])));
}

// Of the start's polygons the one that a triangle is most like.
static int32_t FindTag(const pvtAscent* ascent, const uint32_t corners[3])
{
    const pvtTriangleSet* start = &ascent->start;
    const double longest = pvtGetLongestSide(ascent->frame.size);
    pvtVec3 middle, normal;
    GetMiddleAndNormal(&ascent->set, corners, &middle, &normal);
    double most = -HUGE_VAL;
    int32_t tag = 0;
    for (int t = 0; t < start->triangleCount; ++t) {
        pvtVec3 at, facing;
        GetMiddleAndNormal(start, start->triangles[t], &at, &facing);
        const double likeness =
            fabs(pvtDot(normal, facing)) - pvtLength3(pvtSub(at, middle)) / longest;
        if (likeness > most) {
            most = likeness;
            tag = start->tags[t];
        }
    }
    return tag;
}

static void TakeMesh(const pvtMesh* mesh, pvtAscent* ascent)
{
    pvtTriangleSet* set = &ascent->set;
    float anchor[3] = {0};
    FindDeepest(&ascent->field, anchor);
    set->cornerCount = set->triangleCount = 0;
    pvtAscent_AddCorners(ascent, mesh);
    for (int c = 0; c < set->cornerCount; ++c) {
        memcpy(set->anchors[c], anchor, sizeof anchor);
    }
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const uint32_t* corners = mesh->indices + 3 * t;
        pvtTriangleSet_AddTriangle(set, corners, FindTag(ascent, corners));
    }
    pvtTriangleSet_FindEdges(set);
}

pvtStatus pvtAscent_TakeMesh(pvtContext* context, const pvtMesh* mesh, pvtAscent* ascent,
                             bool* isTaken)
{
    *isTaken = mesh != NULL && mesh->triangleCount > 0 &&
               mesh->triangleCount <= (size_t)ascent->options->budget;
    if (!*isTaken) {
        return PVT_OK;
    }
    pvtMesh welded;
    const pvtStatus status = pvtWeldMesh(context, mesh, &welded);
    if (status == PVT_OK) {
        TakeMesh(&welded, ascent);
        pvtMesh_Free(context, &welded);
    }
    return status;
}
