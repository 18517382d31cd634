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

static pvtVec3 GetCorner(const pvtTriangleSet* set, int triangle, int k)
{
    const float* corner = set->corners[set->triangles[triangle][k]];
    return (pvtVec3){(double)corner[0], (double)corner[1], (double)corner[2]};
}

// The centres of the four triangles that the lines between an own triangle's midpoints cut it into,
// as shares of its corners in sixths.
static int CountThin(const pvtAscent* ascent, int triangle)
{
    static const int sixths[POINTS][3] = {{2, 2, 2}, {4, 1, 1}, {1, 4, 1}, {1, 1, 4}};
    const pvtTriangleSet* set = &ascent->set;
    int thin = 0;
    for (int i = 0; i < POINTS; ++i) {
        float point[3] = {0};
        for (int k = 0; k < 3; ++k) {
            const float* corner = set->corners[set->triangles[triangle][k]];
            for (int axis = 0; axis < 3; ++axis) {
                point[axis] += (float)sixths[i][k] / 6.0F * corner[axis];
            }
        }
        thin += IsDeep(ascent, point) ? 0 : 1;
    }
    return thin;
}

bool pvtAscent_IsBetweenWalls(const pvtAscent* ascent)
{
    const pvtTriangleSet* set = &ascent->set;
    double thin = 0.0, all = 0.0;
    for (int t = 0; t < set->triangleCount; ++t) {
        const pvtVec3 a = GetCorner(set, t, 0);
        const double area =
            pvtLength3(pvtCross(pvtSub(GetCorner(set, t, 1), a), pvtSub(GetCorner(set, t, 2), a)));
        thin += area * CountThin(ascent, t) / POINTS;
        all += area;
    }
    return thin > SHELL_PART * all;
}
