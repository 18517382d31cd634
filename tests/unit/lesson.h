// SPDX-License-Identifier: MIT
// A ball with sights of it, and random triangles to hide it.
#ifndef PVT_TEST_LESSON_H
#define PVT_TEST_LESSON_H

#include "voxel_shapes.h"

#include "base/random.h"
#include "occluder/pull.h"

enum { SIDE = 48 };

static const float CENTER = SIDE / 2.0F, RADIUS = SIDE / 2.0F - 4.0F;

static inline float RollFloat(pvtRandom* random, float low, float high)
{
    return low + (high - low) * (float)pvtRandom_Unit(random);
}

// A ball that leaves four voxels free on each side, in a frame in which voxels are 1 wu.
static inline void MakeBall(pvtContext* context, pvtBitGrid* grid)
{
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, grid);
    SetBall(grid, (pvtVec3){CENTER, CENTER, CENTER}, RADIUS);
}

static inline void RollCorner(pvtRandom* random, float reach, float corner[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        corner[axis] = RollFloat(random, CENTER - reach, CENTER + reach);
    }
}

// Triangles with corners of their own, within a cube.
static inline void RollTriangles(pvtContext* context, int count, float reach, pvtTriangleSet* set)
{
    pvtRandom random = pvtMakeRandom(17, 4);
    CHECK_OK(context, pvtCreateTriangleSet(context, 3 * count, count, set));
    for (int t = 0; t < count; ++t) {
        uint32_t corners[3];
        for (int k = 0; k < 3; ++k) {
            float corner[3];
            RollCorner(&random, reach, corner);
            corners[k] = pvtTriangleSet_AddCorner(set, corner, false);
        }
        pvtTriangleSet_AddTriangle(set, corners, t);
    }
    pvtTriangleSet_FindEdges(set);
}

static inline float GetDistance(const float point[3])
{
    float sum = 0.0F;
    for (int axis = 0; axis < 3; ++axis) {
        sum += (point[axis] - CENTER) * (point[axis] - CENTER);
    }
    return sqrtf(sum);
}

typedef struct Lesson {
    pvtBitGrid grid;
    pvtField field;
    pvtSightSet sights;
    pvtTriangleSet set;
    pvtPuller puller;
} Lesson;

static inline void MakeLesson(pvtContext* context, int triangles, float reach, Lesson* lesson)
{
    MakeBall(context, &lesson->grid);
    CHECK_OK(context, pvtCreateField(context, &lesson->grid, NULL, 64, &lesson->field));
    const pvtViewOptions views = pvtDefaultViewOptions();
    const pvtSightOptions options = {.views = &views, .count = 64, .quads = 400, .seed = 1};
    CHECK_OK(context, pvtCreateSights(context, &options, &lesson->field, &lesson->sights));
    RollTriangles(context, triangles, reach, &lesson->set);
    CHECK_OK(context, pvtCreatePuller(context, &lesson->sights, &lesson->set, &lesson->puller));
}

static inline void FreeLesson(pvtContext* context, Lesson* lesson)
{
    pvtPuller_Free(context, &lesson->puller);
    pvtTriangleSet_Free(context, &lesson->set);
    pvtSightSet_Free(context, &lesson->sights);
    pvtField_Free(context, &lesson->field);
    pvtBitGrid_Free(context, &lesson->grid);
}

#endif
