// SPDX-License-Identifier: MIT
#include "shapes.h"

#include "base/context.h"

typedef struct Bridged {
    pvtBitmap slice;
    pvtLoopSet contours, polygons;
} Bridged;

static Bridged Bridge(pvtContext* context, pvtBitmap slice)
{
    Bridged made = {.slice = slice};
    CHECK_OK(context, pvtTraceContours(context, &slice, 1, &made.contours));
    CHECK_OK(context, pvtBridgeHoles(context, &made.contours, &made.polygons));
    return made;
}

static void FreeBridged(pvtContext* context, Bridged* made)
{
    pvtLoopSet_Free(context, &made->polygons);
    pvtLoopSet_Free(context, &made->contours);
    pvtBitmap_Free(context, &made->slice);
}

static size_t CountHoles(const pvtLoopSet* contours)
{
    size_t count = 0;
    for (size_t l = 0; l < contours->loopCount; ++l) {
        count += contours->parents[l] >= 0;
    }
    return count;
}

// Outer loop minus its holes.
static int64_t GetAreaWithHoles(const pvtLoopSet* contours, size_t outer)
{
    int64_t area = 0;
    for (size_t l = 0; l < contours->loopCount; ++l) {
        if (l == outer || contours->parents[l] == (int32_t)outer) {
            area += pvtGetLoopArea2(contours->points + contours->starts[l],
                                    contours->starts[l + 1] - contours->starts[l]);
        }
    }
    return area;
}

static void CheckAreas(const Bridged* made)
{
    size_t polygon = 0;
    for (size_t l = 0; l < made->contours.loopCount; ++l) {
        if (made->contours.parents[l] < 0) {
            const size_t begin = made->polygons.starts[polygon];
            const size_t end = made->polygons.starts[polygon + 1];
            assert_true(pvtGetLoopArea2(made->polygons.points + begin, end - begin) ==
                        GetAreaWithHoles(&made->contours, l));
            assert_int_equal(made->polygons.parents[polygon++], -1);
        }
    }
    assert_int_equal(made->polygons.loopCount, polygon);
}

static void each_polygon_has_the_area_of_its_loop_without_the_holes(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    size_t holes = 0;
    for (int seed = 0; seed < 24; ++seed) {
        Bridged made = Bridge(context, MakeBlobs(context, 70, 61, (uint64_t)seed, seed % 5));
        CheckAreas(&made);
        assert_int_equal(made.polygons.pointCount,
                         made.contours.pointCount + 2 * CountHoles(&made.contours));
        assert_true(HasNoCrossing(&made.polygons));
        holes += CountHoles(&made.contours);
        FreeBridged(context, &made);
    }
    assert_true(holes > 200);
    DestroyTestContext(context);
}

static void each_place_is_wound_around_as_before(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int seed = 0; seed < 8; ++seed) {
        Bridged made = Bridge(context, MakeBlobs(context, 36, 36, (uint64_t)seed, 1 + seed % 3));
        for (int i = 0; i < 36 * 36; ++i) {
            int winding = 0;
            for (size_t l = 0; l < made.polygons.loopCount; ++l) {
                const size_t begin = made.polygons.starts[l];
                winding +=
                    GetWinding(made.polygons.points + begin, made.polygons.starts[l + 1] - begin,
                               256.0 * (i % 36) + 128.3, 256.0 * (i / 36) + 127.1);
            }
            assert_int_equal(winding, pvtBitmap_Get(&made.slice, i % 36, i / 36));
        }
        FreeBridged(context, &made);
    }
    DestroyTestContext(context);
}

// Any weakly simple polygon can be cut into triangles that wind one way.
static void polygons_with_bridges_can_be_triangulated(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int seed = 0; seed < 10; ++seed) {
        Bridged made = Bridge(context, MakeBlobs(context, 40, 40, (uint64_t)seed, seed % 3));
        uint32_t* indices = calloc(3 * made.polygons.pointCount, sizeof *indices);
        for (size_t l = 0; l < made.polygons.loopCount; ++l) {
            const pvtPoint2* points = made.polygons.points + made.polygons.starts[l];
            const size_t count = made.polygons.starts[l + 1] - made.polygons.starts[l];
            CHECK_OK(context, pvtTriangulatePolygon(context, points, count, indices));
            for (size_t t = 0; t < count - 2; ++t) {
                assert_true(pvtOrient(points[indices[3 * t]], points[indices[3 * t + 1]],
                                      points[indices[3 * t + 2]]) > 0);
            }
        }
        free(indices);
        FreeBridged(context, &made);
    }
    DestroyTestContext(context);
}

static void a_lone_hole_gets_the_shortest_bridge(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Bridged made = Bridge(context, MakeShape(context, 80, IsRing));
    const pvtLoopSet* loops = &made.contours;
    assert_int_equal(loops->loopCount, 2);
    int64_t shortest = INT64_MAX;
    for (size_t i = loops->starts[0]; i < loops->starts[1]; ++i) {
        for (size_t j = loops->starts[1]; j < loops->starts[2]; ++j) {
            const int64_t length2 = pvtGetDistance2(loops->points[i], loops->points[j]);
            shortest = length2 < shortest ? length2 : shortest;
        }
    }
    // Of a ring's edges only the bridge is slanted; it is there twice.
    int bridges = 0;
    for (size_t i = 0; i < made.polygons.pointCount; ++i) {
        const pvtPoint2 a = made.polygons.points[i];
        const pvtPoint2 b = made.polygons.points[(i + 1) % made.polygons.pointCount];
        bridges += pvtGetDistance2(a, b) == shortest && a.x != b.x && a.y != b.y;
    }
    assert_int_equal(bridges, 2);
    FreeBridged(context, &made);
    DestroyTestContext(context);
}

// Loops of four points each, the first of them around the others.
static pvtLoopSet MakeSquares(pvtContext* context, const int32_t (*squares)[4], size_t count)
{
    pvtLoopSet set = {
        .points = pvtAllocate(context, 4 * count, sizeof *set.points),
        .pointCount = 4 * count,
        .starts = pvtAllocate(context, count + 1, sizeof *set.starts),
        .parents = pvtAllocate(context, count, sizeof *set.parents),
        .loopCount = count,
    };
    for (size_t l = 0; l < count; ++l) {
        const int32_t* at = squares[l];
        const pvtPoint2 corners[4] = {
            {at[0], at[1]}, {at[2], at[1]}, {at[2], at[3]}, {at[0], at[3]}};
        for (size_t i = 0; i < 4; ++i) {
            set.points[4 * l + i] = corners[l == 0 ? i : 3 - i];
        }
        set.parents[l] = l == 0 ? -1 : 0;
        set.starts[l + 1] = 4 * (l + 1);
    }
    return set;
}

static void CheckSquares(const int32_t (*squares)[4], size_t count, size_t pointCount)
{
    pvtContext* context = CreateTestContext(1);
    pvtLoopSet contours = MakeSquares(context, squares, count), polygons;
    CHECK_OK(context, pvtBridgeHoles(context, &contours, &polygons));
    assert_int_equal(polygons.loopCount, 1);
    assert_int_equal(polygons.pointCount, pointCount);
    assert_true(HasNoCrossing(&polygons));
    assert_true(pvtGetLoopArea2(polygons.points, pointCount) == GetAreaWithHoles(&contours, 0));
    uint32_t indices[3 * 64];
    CHECK_OK(context, pvtTriangulatePolygon(context, polygons.points, pointCount, indices));
    for (size_t t = 0; t < pointCount - 2; ++t) {
        assert_true(pvtOrient(polygons.points[indices[3 * t]], polygons.points[indices[3 * t + 1]],
                              polygons.points[indices[3 * t + 2]]) > 0);
    }
    pvtLoopSet_Free(context, &contours);
    pvtLoopSet_Free(context, &polygons);
    DestroyTestContext(context);
}

static void holes_that_touch_at_a_corner_need_no_bridge(void** state)
{
    (void)state;
    const int32_t squares[][4] = {
        {0, 0, 900, 900}, {300, 300, 400, 400}, {400, 400, 500, 500}, {500, 300, 600, 400}};
    CheckSquares(squares, 4, 4 + 6 + 4 + 4);
}

static void bridges_from_one_corner_stay_apart(void** state)
{
    (void)state;
    // The nearest corner of all three holes is that of the outer loop.
    const int32_t squares[][4] = {
        {0, 0, 9000, 9000}, {100, 300, 101, 301}, {300, 100, 301, 101}, {290, 290, 291, 291}};
    CheckSquares(squares, 4, 4 + 3 * 6);
}

static void a_bridge_goes_around_what_is_in_its_way(void** state)
{
    (void)state;
    // A wall stands between the small hole and the nearest corners of the outer loop.
    const int32_t squares[][4] = {
        {0, 0, 1000, 1000}, {100, 10, 110, 990}, {120, 500, 125, 505}, {130, 5, 140, 995}};
    CheckSquares(squares, 4, 4 + 3 * 6);
}

static void a_sieve_is_bridged_in_time(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const double start = GetCpuSeconds();
    Bridged made = Bridge(context, MakeShape(context, 256, IsSieve));
    CheckAreas(&made);
    assert_true(GetCpuSeconds() - start < 2.0);
    FreeBridged(context, &made);
    DestroyTestContext(context);
}

static void a_hole_out_of_its_loop_is_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const int32_t squares[][4] = {{0, 0, 100, 100}, {200, 200, 300, 300}};
    pvtLoopSet contours = MakeSquares(context, squares, 2), polygons;
    assert_int_equal(pvtBridgeHoles(context, &contours, &polygons), PVT_INVALID_ARGUMENT);
    assert_null(polygons.points);
    pvtLoopSet_Free(context, &contours);
    DestroyTestContext(context);
}

static pvtStatus BridgeAndFree(pvtContext* context, const void* input)
{
    pvtLoopSet polygons;
    const pvtStatus status = pvtBridgeHoles(context, input, &polygons);
    pvtLoopSet_Free(context, &polygons);
    return status;
}

static void a_failed_allocation_leaves_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Bridged made = Bridge(context, MakeBlobs(context, 60, 60, 3, 1));
    CheckEveryAllocation(BridgeAndFree, &made.contours);
    FreeBridged(context, &made);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_polygon_has_the_area_of_its_loop_without_the_holes),
        cmocka_unit_test(each_place_is_wound_around_as_before),
        cmocka_unit_test(polygons_with_bridges_can_be_triangulated),
        cmocka_unit_test(a_lone_hole_gets_the_shortest_bridge),
        cmocka_unit_test(holes_that_touch_at_a_corner_need_no_bridge),
        cmocka_unit_test(bridges_from_one_corner_stay_apart),
        cmocka_unit_test(a_bridge_goes_around_what_is_in_its_way),
        cmocka_unit_test(a_sieve_is_bridged_in_time),
        cmocka_unit_test(a_hole_out_of_its_loop_is_refused),
        cmocka_unit_test(a_failed_allocation_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
