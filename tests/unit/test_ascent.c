// SPDX-License-Identifier: MIT
#include "lesson.h"

#include "base/vector.h"
#include "occluder/ascent.h"
#include "occluder/ascent_state.h"
#include "occluder/contacts.h"
#include "occluder/crossing.h"

static void the_field_of_a_ball_is_its_depth(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtBitGrid grid;
    MakeBall(context, &grid);
    static const int resolutions[] = {64, 24};
    for (int r = 0; r < 2; ++r) {
        pvtField field;
        CHECK_OK(context, pvtCreateField(context, &grid, NULL, resolutions[r], &field));
        assert_int_equal(field.nodeSize, r + 1);
        pvtRandom random = pvtMakeRandom(3, 3);
        for (int round = 0; round < 3000; ++round) {
            float point[3], inward[3];
            RollCorner(&random, RADIUS + 2.0F, point);
            const float distance = GetDistance(point), depth = RADIUS - distance;
            const float found = pvtField_GetDepthAndInward(&field, point, inward);
            assert_true(found == pvtField_GetDepth(&field, point));
            if (fabsf(depth) < 6.0F) {
                // Weights of 8, 11 and 14 are off by an eighth at most, voxels by one.
                assert_true(fabsf(found - depth) < 0.13F * fabsf(depth) + 0.9F * (float)(r + 1));
                float cosine = 0.0F;
                for (int axis = 0; axis < 3; ++axis) {
                    cosine -= inward[axis] * (point[axis] - CENTER) / distance;
                }
                assert_true(cosine > 0.6F);
            }
        }
        pvtField_Free(context, &field);
    }
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void CheckDepths(const Lesson* lesson, float least)
{
    pvtRandom random = pvtMakeRandom(31, 5);
    for (int i = 0; i < 20000; ++i) {
        const uint32_t* corners = lesson->set.triangles[i % lesson->set.triangleCount];
        const float u = RollFloat(&random, 0.0F, 1.0F), v = RollFloat(&random, 0.0F, 1.0F - u);
        float point[3];
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = (1.0F - u - v) * lesson->set.corners[corners[0]][axis] +
                          u * lesson->set.corners[corners[1]][axis] +
                          v * lesson->set.corners[corners[2]][axis];
        }
        assert_true(pvtField_GetDepth(&lesson->field, point) > least);
    }
}

static void one_look_tells_less_than_all(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 1, RADIUS, &lesson);
    const pvtInterior interior = {.allowed = &lesson.grid};
    pvtInsideTest inside;
    CHECK_OK(context, pvtCreateInsideTest(context, &interior, &inside));
    pvtRandom random = pvtMakeRandom(13, 8);
    int balls = 0;
    for (int i = 0; i < 5000; ++i) {
        float point[3];
        RollCorner(&random, CENTER, point);
        const float depth = pvtField_GetDepth(&lesson.field, point);
        const float least = pvtField_GetLeastDepth(&lesson.field, point);
        assert_true(least <= depth && least > depth - 2.5F);
        const float radius = RollFloat(&random, 0.0F, 12.0F);
        if (pvtInsideTest_HasBall(&inside, point, radius)) {
            assert_true(GetDistance(point) + radius < RADIUS + 1.0F);
            ++balls;
        }
    }
    assert_true(balls > 50);
    pvtInsideTest_Free(context, &inside);
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

static void contacts_bring_triangles_inside_and_keep_them_there(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 12, RADIUS, &lesson);
    pvtContactSet contacts;
    CHECK_OK(context, pvtCreateContacts(context, 12, &contacts));
    const pvtInterior interior = {.allowed = &lesson.grid};
    pvtInsideTest inside;
    CHECK_OK(context, pvtCreateInsideTest(context, &interior, &inside));
    const pvtContactOptions options = {.inside = &inside, .band = 0.5F, .piece = 8.0F};
    for (int round = 0; round < 40; ++round) {
        pvtFindContacts(context, &options, &lesson.field, &lesson.set, &contacts);
        pvtPushInside(&contacts, &lesson.field, 3, &lesson.set);
    }
    for (int c = 0; c < lesson.set.cornerCount; ++c) {
        assert_true(GetDistance(lesson.set.corners[c]) < RADIUS + 0.9F);
    }
    CheckDepths(&lesson, -0.2F);
    pvtFindContacts(context, &options, &lesson.field, &lesson.set, &contacts);
    assert_true(contacts.count > 0);
    float velocities[36][3];
    pvtRandom random = pvtMakeRandom(9, 9);
    for (int c = 0; c < 36; ++c) {
        for (int axis = 0; axis < 3; ++axis) {
            velocities[c][axis] = RollFloat(&random, -1.0F, 1.0F);
        }
    }
    pvtSlideAlong(&contacts, options.band, &lesson.set, 100, velocities);
    for (int i = 0; i < contacts.count; ++i) {
        const pvtContact* contact = &contacts.contacts[i];
        float speed = 0.0F;
        for (int k = 0; k < 3; ++k) {
            const float* v = velocities[lesson.set.triangles[contact->triangle][k]];
            for (int axis = 0; axis < 3; ++axis) {
                speed += contact->shares[k] * v[axis] * contact->inward[axis];
            }
        }
        assert_true(contact->depth >= 0.5F || speed > -0.05F);
    }
    pvtContactSet_Free(context, &contacts);
    pvtInsideTest_Free(context, &inside);
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

// What hangs on a panel on the surface would not be inside.
static void no_triangle_grows_from_fixed_corners(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 6, 12.0F, &lesson);
    pvtAscent ascent = {.field = lesson.field, .puller = lesson.puller};
    CHECK_OK(context, pvtCreateTriangleSet(context, 48, 16, &ascent.set));
    for (uint32_t c = 0; c < 18; ++c) {
        pvtTriangleSet_AddCorner(&ascent.set, lesson.set.corners[c], c < 9);
    }
    for (uint32_t t = 0; t < 6; ++t) {
        pvtTriangleSet_AddTriangle(&ascent.set, (uint32_t[3]){3 * t, 3 * t + 1, 3 * t + 2}, 0);
    }
    pvtTriangleSet_FindEdges(&ascent.set);
    float speeds[48][3] = {{0}}, squares[48] = {1.0F};
    ascent.speeds = speeds;
    ascent.squares = squares;
    const pvtPullOptions options = {.count = 64, .softness = 10.0F, .wantsEdges = true};
    pvtPullCorners(context, &options, &ascent.puller);
    pvtAscent_Grow(&ascent, 10);
    assert_int_equal(ascent.set.triangleCount, 15); // one on each of the nine edges that may
    for (int t = 6; t < ascent.set.triangleCount; ++t) {
        for (int k = 0; k < 3; ++k) {
            assert_false(ascent.set.isFixed[ascent.set.triangles[t][k]]);
        }
    }
    pvtTriangleSet_Free(context, &ascent.set);
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

static void triangles_cross_where_they_pass_through_each_other(void** state)
{
    (void)state;
    const pvtVec3 floor[3] = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}};
    pvtVec3 ends[2];
    assert_true(pvtFindCrossing((pvtVec3[3]){{1, 1, -1}, {1, 1, 1}, {4, 1, 1}}, floor, ends));
    CHECK_NEAR(pvtLength3(pvtSub(ends[0], ends[1])), 1.5, 1e-9);
    CHECK_NEAR(ends[0].z, 0.0, 1e-9);
    // Beside it, on it, touching it, and in the same plane.
    assert_false(pvtFindCrossing((pvtVec3[3]){{9, 9, -1}, {9, 9, 1}, {12, 9, 1}}, floor, ends));
    assert_false(pvtFindCrossing((pvtVec3[3]){{1, 1, 0}, {1, 1, 1}, {4, 1, 1}}, floor, ends));
    assert_false(pvtFindCrossing((pvtVec3[3]){{1, 1, 0}, {2, 1, 0}, {4, 1, 1}}, floor, ends));
    assert_false(pvtFindCrossing((pvtVec3[3]){{1, 1, 0}, {2, 1, 0}, {1, 3, 0}}, floor, ends));
}

// The inside of a cube that is tilted against the grid, up to the surface itself.
typedef struct Tilted {
    pvtMesh mesh;
    pvtSolid solid;
    pvtBitGrid allowed;
    pvtCellGrid cells;
    pvtTouching touching;
    pvtInterior interior;
    pvtInsideTest test;
} Tilted;

// Of a direction in the cube, whose faces are 10 away from its middle.
static pvtVec3 Tilt(double x, double y, double z)
{
    return (pvtVec3){0.96 * x - 0.28 * y, 0.28 * x + 0.96 * y, z};
}

static void MakeTilted(pvtContext* context, int resolution, Tilted* tilted)
{
    *tilted = (Tilted){0};
    MakeBoxMesh(context, (pvtVec3){-10, -10, -10}, (pvtVec3){10, 10, 10}, &tilted->mesh);
    for (size_t i = 0; i < tilted->mesh.positionCount; ++i) {
        const pvtVec3 p = tilted->mesh.positions[i];
        tilted->mesh.positions[i] = Tilt(p.x, p.y, p.z);
    }
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = resolution;
    const pvtSolidOptions solid = pvtDefaultSolidOptions();
    pvtBitGrid surface;
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &tilted->mesh, &surface));
    CHECK_OK(context, pvtFillSolid(context, &solid, &surface, &tilted->solid));
    CHECK_OK(context, pvtMakeAllowedGrid(context, &tilted->solid, 0.0, &tilted->allowed));
    CHECK_OK(context, pvtRefineAllowedGrid(context, &tilted->mesh, &tilted->solid, &tilted->allowed,
                                           &tilted->cells));
    CHECK_OK(context, pvtListTouching(context, &tilted->mesh, &tilted->cells, &tilted->touching));
    tilted->interior = (pvtInterior){&tilted->allowed, &tilted->cells, &tilted->touching};
    CHECK_OK(context, pvtCreateInsideTest(context, &tilted->interior, &tilted->test));
    pvtBitGrid_Free(context, &surface);
}

static void FreeTilted(pvtContext* context, Tilted* tilted)
{
    pvtInsideTest_Free(context, &tilted->test);
    pvtTouching_Free(context, &tilted->touching);
    pvtCellGrid_Free(context, &tilted->cells);
    pvtBitGrid_Free(context, &tilted->allowed);
    pvtSolid_Free(context, &tilted->solid);
    pvtMesh_Free(context, &tilted->mesh);
}

// What the test and the check say of a triangle in the cube's own directions.
static bool IsInside(pvtContext* context, const Tilted* tilted, const pvtVec3 places[3],
                     uint64_t* outside)
{
    pvtVec3 positions[3], corners[3];
    const pvtGridFrame* frame = &tilted->allowed.frame;
    for (int k = 0; k < 3; ++k) {
        positions[k] = Tilt(places[k].x, places[k].y, places[k].z);
        corners[k] = pvtScale(pvtSub(positions[k], frame->origin), 1.0 / frame->voxelSize);
    }
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, 3, NULL, 1, &mesh));
    CHECK_OK(context, pvtCheckOccluder(context, &tilted->interior, &mesh, outside));
    pvtMesh_Free(context, &mesh);
    return pvtInsideTest_HasTriangle(&tilted->test, corners);
}

static void triangles_may_come_up_to_the_surface_and_no_farther(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Tilted tilted;
    MakeTilted(context, 24, &tilted);
    uint64_t outside = 0;
    // A corner just below a face, and one just above it; voxels are about 1 in size, cells 1/4.
    assert_true(
        IsInside(context, &tilted, (pvtVec3[3]){{9.99, 1, 1}, {-3, 2, -4}, {-3, -5, 2}}, &outside));
    assert_true(outside == 0);
    assert_false(
        IsInside(context, &tilted, (pvtVec3[3]){{10.1, 1, 1}, {-3, 2, -4}, {-3, -5, 2}}, &outside));
    assert_true(outside > 0);
    // An edge along a corner of the cube, which is nearer to it than any cell that is inside.
    assert_true(IsInside(context, &tilted,
                         (pvtVec3[3]){{9.98, 9.98, 7}, {9.98, 9.98, -7}, {0, 0, 0}}, &outside));
    assert_true(outside == 0);
    // Beside the cube, in cells that the surface passes: nothing tells that it is not inside.
    assert_false(IsInside(context, &tilted,
                          (pvtVec3[3]){{10.02, 1, 1}, {10.02, 1.2, 1}, {10.02, 1, 1.2}}, &outside));
    assert_true(outside > 0);
    FreeTilted(context, &tilted);
    DestroyTestContext(context);
}

static void large_triangles_may_come_up_to_the_surface_as_well(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Tilted tilted;
    MakeTilted(context, 192, &tilted);
    // Most of a face, in more border voxels than are kept in mind at a time.
    const pvtVec3 a = {9.99, -9.9, -9.9}, b = {9.99, 9.9, -9.9};
    uint64_t outside = 0;
    assert_true(IsInside(context, &tilted, (pvtVec3[3]){a, b, {9.85, 0.0, 9.9}}, &outside));
    assert_true(outside == 0);
    assert_false(IsInside(context, &tilted, (pvtVec3[3]){a, b, {10.01, 0.0, 9.9}}, &outside));
    assert_true(outside > 0);
    FreeTilted(context, &tilted);
    DestroyTestContext(context);
}

// A right triangle parallel to the x and y axes.
static void AddLevel(float x, float y, float z, float side, pvtTriangleSet* set)
{
    const float places[3][3] = {{x, y, z}, {x + side, y, z}, {x, y + side, z}};
    uint32_t corners[3];
    for (int k = 0; k < 3; ++k) {
        corners[k] = pvtTriangleSet_AddCorner(set, places[k], false);
    }
    pvtTriangleSet_AddTriangle(set, corners, 0);
}

static void most_of_a_start_lies_between_walls_or_not(void** state)
{
    (void)state;
    enum { LENGTH = 192, WALL = 2, BLOCK = 24 };
    pvtContext* context = CreateTestContext(2);
    pvtBitGrid grid;
    MakeEmptyGrid(context, LENGTH, LENGTH, 40, &grid);
    SetBox(&grid, (int[]){4, 4, 8}, (int[]){LENGTH / 2, LENGTH - 4, 8 + WALL});
    SetBox(&grid, (int[]){LENGTH / 2, 4, 8}, (int[]){LENGTH - 4, LENGTH - 4, 8 + BLOCK});
    pvtAscent ascent = {.frame = grid.frame};
    CHECK_OK(context, pvtCreateField(context, &grid, NULL, 256, &ascent.field));
    CHECK_OK(context, pvtCreateTriangleSet(context, 12, 4, &ascent.set));
    assert_false(pvtAscent_IsBetweenWalls(&ascent)); // nothing is not between walls
    AddLevel(8, 8, 9, 30, &ascent.set);
    assert_true(pvtAscent_IsBetweenWalls(&ascent));
    AddLevel(110, 8, 20, 20, &ascent.set);
    assert_true(pvtAscent_IsBetweenWalls(&ascent));
    // By area, and from just below a surface as well.
    AddLevel(110, 60, 9, 50, &ascent.set);
    assert_false(pvtAscent_IsBetweenWalls(&ascent));
    AddLevel(8, 60, 9, 60, &ascent.set);
    assert_true(pvtAscent_IsBetweenWalls(&ascent));
    pvtTriangleSet_Free(context, &ascent.set);
    pvtField_Free(context, &ascent.field);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void what_the_test_finds_inside_passes_the_check(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Tilted tilted;
    MakeTilted(context, 24, &tilted);
    pvtRandom random = pvtMakeRandom(21, 2);
    int inside = 0, near = 0;
    for (int round = 0; round < 4000; ++round) {
        pvtVec3 places[3];
        double farthest = 0.0;
        for (int k = 0; k < 3; ++k) {
            const double x = 20.4 * pvtRandom_Unit(&random) - 10.2;
            const double y = 20.4 * pvtRandom_Unit(&random) - 10.2;
            const double z = 20.4 * pvtRandom_Unit(&random) - 10.2;
            // One coordinate at the surface, more or less.
            places[k] = (pvtVec3){x, y, z};
            pvtSetAxis(&places[k], (int)pvtRandom_Below(&random, 3),
                       9.9 + 0.12 * pvtRandom_Unit(&random));
            farthest =
                fmax(farthest, fmax(fabs(places[k].x), fmax(fabs(places[k].y), fabs(places[k].z))));
        }
        uint64_t outside = 0;
        if (IsInside(context, &tilted, places, &outside)) {
            assert_true(outside == 0);
            assert_true(farthest < 10.0 + 1e-6);
            ++inside;
        } else {
            // What it refuses is outside, or passes outside cells within 1/24 voxel, or lies along
            // a face, in border cells alone.
            near += farthest < 9.9 ? 1 : 0;
        }
    }
    assert_true(inside > 100);
    assert_int_equal(near, 0);
    FreeTilted(context, &tilted);
    DestroyTestContext(context);
}

static void BuildTilted(pvtContext* context, int budget, pvtOccluder* occluder,
                        pvtBuildStats* stats)
{
    Tilted tilted;
    MakeTilted(context, 24, &tilted);
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.budget = budget;
    options.resolution = 32;
    options.effort = PVT_EFFORT_FAST;
    CHECK_OK(context, pvtBuildOccluder(context, &options, &tilted.mesh, occluder, stats));
    FreeTilted(context, &tilted);
}

static void an_ascent_keeps_to_its_budget_and_hides_nearly_all_of_a_cube(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    static const int budgets[] = {1, 2, 5, 12, 40};
    double before = 0.0;
    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; ++i) {
        pvtOccluder occluder;
        pvtBuildStats stats;
        BuildTilted(context, budgets[i], &occluder, &stats);
        assert_true(occluder.mesh.triangleCount >= 1);
        assert_true(occluder.mesh.triangleCount <= (size_t)budgets[i]);
        assert_true(occluder.loops.loopCount <= occluder.mesh.triangleCount);
        assert_true(stats.outside == 0);
        assert_true(stats.measure >= 0.98 * before);
        before = stats.measure;
        if (budgets[i] == 40) {
            // The ceiling takes in whole cells that the surface passes.
            assert_true(stats.measure > 0.85 * stats.measureOfSolid);
        }
        pvtOccluder_Free(context, &occluder);
    }
    DestroyTestContext(context);
}

static void threads_do_not_change_an_ascent(void** state)
{
    (void)state;
    pvtContext* one = CreateTestContext(1);
    pvtContext* many = CreateTestContext(5);
    pvtOccluder a, b;
    pvtBuildStats stats;
    BuildTilted(one, 14, &a, &stats);
    BuildTilted(many, 14, &b, &stats);
    assert_true(a.mesh.positionCount == b.mesh.positionCount);
    assert_true(a.mesh.triangleCount == b.mesh.triangleCount);
    assert_memory_equal(a.mesh.positions, b.mesh.positions, a.mesh.positionCount * sizeof(pvtVec3));
    assert_memory_equal(a.mesh.indices, b.mesh.indices, a.mesh.triangleCount * sizeof(uint32_t[3]));
    pvtOccluder_Free(one, &a);
    pvtOccluder_Free(many, &b);
    DestroyTestContext(one);
    DestroyTestContext(many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_field_of_a_ball_is_its_depth),
        cmocka_unit_test(one_look_tells_less_than_all),
        cmocka_unit_test(contacts_bring_triangles_inside_and_keep_them_there),
        cmocka_unit_test(no_triangle_grows_from_fixed_corners),
        cmocka_unit_test(triangles_cross_where_they_pass_through_each_other),
        cmocka_unit_test(triangles_may_come_up_to_the_surface_and_no_farther),
        cmocka_unit_test(large_triangles_may_come_up_to_the_surface_as_well),
        cmocka_unit_test(most_of_a_start_lies_between_walls_or_not),
        cmocka_unit_test(what_the_test_finds_inside_passes_the_check),
        cmocka_unit_test(an_ascent_keeps_to_its_budget_and_hides_nearly_all_of_a_cube),
        cmocka_unit_test(threads_do_not_change_an_ascent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
