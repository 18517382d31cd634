// SPDX-License-Identifier: MIT
// Whether there is more than walls to climb in. In a shell, such as a vase, triangles lie between
// two sides that are close to each other wherever they go: steps are short then, the way along the
// wall is long, and a climb needs more of them.
#include "ascent_state.h"

#include "base/vector.h"
#include "voxel/bit_grid.h"

enum { LOOKS = 6, POINTS = 4 };

static const float WALL_DEPTH = 2.0F; // [vx] at 256 along the longest side: half of a wall
static const double SHELL_PART = 0.5; // of the start's area

// Whether the inside is deeper than half a wall at a point, or farther in.
static bool IsDeep(const pvtAscent* ascent, const float point[3])
{
    const float deep = WALL_DEPTH * (float)pvtGetLongestSide(ascent->frame.size) / 256.0F;
    float place[3] = {point[0], point[1], point[2]};
    for (int i = 0; i < LOOKS; ++i) {
        float inward[3];
        if (pvtField_GetDepthAndInward(&ascent->field, place, inward) >= deep) {
            return true;
        }
        for (int axis = 0; axis < 3; ++axis) {
            place[axis] += 0.5F * deep * inward[axis];
        }
    }
    return false;
}

// The centres of the four triangles that the lines between an own triangle's midpoints cut it into.
static int CountThin(const pvtAscent* ascent, int triangle)
{
    static const float sixths[POINTS][3] = {{2, 2, 2}, {4, 1, 1}, {1, 4, 1}, {1, 1, 4}};
    int thin = 0;
    for (int i = 0; i < POINTS; ++i) {
        pvtContact contact = {.triangle = triangle};
        for (int k = 0; k < 3; ++k) {
            contact.shares[k] = sixths[i][k] / 6.0F;
        }
        float point[3];
        pvtGetContactPlace(&contact, &ascent->set, point);
        thin += IsDeep(ascent, point) ? 0 : 1;
    }
    return thin;
}

bool pvtAscent_IsBetweenWalls(const pvtAscent* ascent)
{
    double thin = 0.0, all = 0.0;
    for (int t = 0; t < ascent->set.triangleCount; ++t) {
        pvtVec3 corners[3];
        pvtAscent_GetTriangle(ascent, t, corners);
        const double area =
            pvtLength3(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])));
        thin += area * CountThin(ascent, t) / POINTS;
        all += area;
    }
    return thin > SHELL_PART * all;
}
