// SPDX-License-Identifier: MIT
#include "shapes.h"

#include "base/context.h"

enum { MOST = 4096 };

typedef struct Polygon {
    pvtPoint2 points[MOST];
    size_t count;
} Polygon;

static uint32_t* Triangulate(pvtContext* context, const pvtPoint2* points, size_t count)
{
    uint32_t* indices = calloc(3 * (count - 2), sizeof *indices);
    CHECK_OK(context, pvtTriangulatePolygon(context, points, count, indices));
    return indices;
}

// All triangles wind counter-clockwise and their areas sum to the polygon's; returns the number of
// those without area.
static size_t CheckAreas(const pvtPoint2* points, size_t count, const uint32_t* indices)
{
    int64_t sum = 0;
    size_t flat = 0;
    for (size_t t = 0; t < count - 2; ++t) {
        const uint32_t* triangle = indices + 3 * t;
        assert_true(triangle[0] < count && triangle[1] < count && triangle[2] < count);
        const int64_t area2 =
            pvtOrient(points[triangle[0]], points[triangle[1]], points[triangle[2]]);
        assert_true(area2 >= 0);
        sum += area2;
        flat += area2 == 0;
    }
    assert_true(sum == pvtGetLoopArea2(points, count));
    return flat;
}

// Each place, off all lines between points, lies in as many triangles as the polygon winds around
// it.
static void CheckPartition(const pvtPoint2* points, size_t count, const uint32_t* indices,
                           double extent)
{
    pvtRandom random = pvtMakeRandom(7, 1);
    for (int i = 0; i < 400; ++i) {
        const double x = extent * pvtRandom_Unit(&random), y = extent * pvtRandom_Unit(&random);
        int triangles = 0;
        for (size_t t = 0; t < count - 2; ++t) {
            const pvtPoint2 corners[3] = {points[indices[3 * t]], points[indices[3 * t + 1]],
                                          points[indices[3 * t + 2]]};
            triangles += GetWinding(corners, 3, x, y);
        }
        assert_int_equal(triangles, GetWinding(points, count, x, y));
    }
}

static void contours_are_partitioned_without_flat_triangles(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int seed = 0; seed < 12; ++seed) {
        pvtBitmap slice = MakeBlobs(context, 40, 40, (uint64_t)seed, seed % 4);
        pvtLoopSet contours;
        CHECK_OK(context, pvtTraceContours(context, &slice, 1, &contours));
        for (size_t l = 0; l < contours.loopCount; ++l) {
            const pvtPoint2* points = contours.points + contours.starts[l];
            const size_t count = contours.starts[l + 1] - contours.starts[l];
            if (contours.parents[l] < 0) {
                uint32_t* indices = Triangulate(context, points, count);
                assert_int_equal(CheckAreas(points, count, indices), 0);
                CheckPartition(points, count, indices, 40.0 * 256.0);
                free(indices);
            }
        }
        pvtLoopSet_Free(context, &contours);
        pvtBitmap_Free(context, &slice);
    }
    DestroyTestContext(context);
}

static void points_along_straight_sides_get_triangles_with_area(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Polygon square = {.count = 0};
    const pvtPoint2 along[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    pvtPoint2 at = {0, 0};
    for (int side = 0; side < 4; ++side) {
        for (int i = 0; i < 20; ++i) {
            square.points[square.count++] = at;
            at.x += 100 * along[side].x;
            at.y += 100 * along[side].y;
        }
    }
    uint32_t* indices = Triangulate(context, square.points, square.count);
    assert_int_equal(CheckAreas(square.points, square.count, indices), 0);
    free(indices);
    DestroyTestContext(context);
}

// A square with a square hole, joined to it from corner to corner.
static void a_polygon_with_a_bridge_is_partitioned(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtPoint2 points[] = {{0, 0},     {900, 0},   {900, 900}, {0, 900},   {0, 0},
                                {300, 300}, {300, 600}, {600, 600}, {600, 300}, {300, 300}};
    const size_t count = sizeof points / sizeof *points;
    uint32_t* indices = Triangulate(context, points, count);
    assert_int_equal(CheckAreas(points, count, indices), 0);
    CheckPartition(points, count, indices, 900.0);
    free(indices);
    DestroyTestContext(context);
}

// Two bridges from one corner, and a third hole joined to the second.
static void bridges_that_share_a_corner_are_kept_apart(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtPoint2 points[] = {{0, 0},     {900, 0},   {900, 900}, {0, 900},   {0, 0},
                                {100, 300}, {100, 400}, {200, 300}, {100, 300}, {0, 0},
                                {300, 100}, {300, 200}, {400, 200}, {500, 500}, {600, 700},
                                {700, 500}, {500, 500}, {400, 200}, {400, 100}, {300, 100}};
    const size_t count = sizeof points / sizeof *points;
    assert_true(pvtGetLoopArea2(points, count) == 2 * 810000 - 10000 - 2 * 10000 - 40000);
    uint32_t* indices = Triangulate(context, points, count);
    assert_int_equal(CheckAreas(points, count, indices), 0);
    CheckPartition(points, count, indices, 900.0);
    free(indices);
    DestroyTestContext(context);
}

static void a_slit_and_doubled_points_are_allowed(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtPoint2 points[] = {{0, 0},     {400, 0},   {800, 0},   {800, 0}, {800, 800},
                                {400, 800}, {400, 300}, {400, 800}, {0, 800}};
    const size_t count = sizeof points / sizeof *points;
    uint32_t* indices = Triangulate(context, points, count);
    (void)CheckAreas(points, count, indices);
    CheckPartition(points, count, indices, 800.0);
    free(indices);
    DestroyTestContext(context);
}

static void a_kite_is_cut_along_its_shorter_diagonal(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int turn = 0; turn < 4; ++turn) {
        const pvtPoint2 kite[] = {{0, 100}, {1000, 0}, {1800, 100}, {1000, 220}};
        pvtPoint2 points[4];
        for (int i = 0; i < 4; ++i) {
            points[i] = kite[(i + turn) % 4];
        }
        uint32_t* indices = Triangulate(context, points, 4);
        for (int t = 0; t < 2; ++t) {
            int across = 0;
            for (int i = 0; i < 3; ++i) {
                across += points[indices[3 * t + i]].x == 1000;
            }
            assert_int_equal(across, 2);
        }
        free(indices);
    }
    DestroyTestContext(context);
}

static void what_is_no_polygon_is_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    uint32_t indices[12];
    const pvtPoint2 clockwise[] = {{0, 0}, {0, 9}, {9, 9}, {9, 0}};
    assert_int_equal(pvtTriangulatePolygon(context, clockwise, 4, indices), PVT_INVALID_ARGUMENT);
    assert_int_equal(pvtTriangulatePolygon(context, clockwise, 2, indices), PVT_INVALID_ARGUMENT);
    const pvtPoint2 crossed[] = {{0, 0}, {9, 9}, {9, 0}, {0, 9}};
    assert_int_equal(pvtTriangulatePolygon(context, crossed, 4, indices), PVT_INVALID_ARGUMENT);
    DestroyTestContext(context);
}

static pvtStatus TriangulateOnce(pvtContext* context, const void* input)
{
    uint32_t indices[6];
    return pvtTriangulatePolygon(context, input, 4, indices);
}

static void a_failed_allocation_leaves_nothing(void** state)
{
    (void)state;
    const pvtPoint2 square[] = {{0, 0}, {9, 0}, {9, 9}, {0, 9}};
    CheckEveryAllocation(TriangulateOnce, square);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contours_are_partitioned_without_flat_triangles),
        cmocka_unit_test(points_along_straight_sides_get_triangles_with_area),
        cmocka_unit_test(a_polygon_with_a_bridge_is_partitioned),
        cmocka_unit_test(bridges_that_share_a_corner_are_kept_apart),
        cmocka_unit_test(a_slit_and_doubled_points_are_allowed),
        cmocka_unit_test(a_kite_is_cut_along_its_shorter_diagonal),
        cmocka_unit_test(what_is_no_polygon_is_refused),
        cmocka_unit_test(a_failed_allocation_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
