// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/context.h"
#include "base/random.h"
#include "occluder/fit.h"

#include <string.h>

// Whether a point in point units lies strictly inside a convex counter-clockwise triangle.
static bool IsInside(const pvtPoint2 t[3], double x, double y)
{
    for (int i = 0; i < 3; ++i) {
        const pvtPoint2 a = t[i];
        const pvtPoint2 b = t[(i + 1) % 3];
        if ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) <= 0.0) {
            return false;
        }
    }
    return true;
}

// Dense samples of the triangle: finds every cell that it covers by more than a sample's spacing.
static bool IsWithinBySampling(const pvtBitmap* cells, double unit, const pvtPoint2 t[3])
{
    for (int y = 0; y < cells->height * 16; ++y) {
        for (int x = 0; x < cells->width * 16; ++x) {
            if (!pvtBitmap_Get(cells, x / 16, y / 16) &&
                IsInside(t, (x + 0.5) / 16 * unit, (y + 0.5) / 16 * unit)) {
                return false;
            }
        }
    }
    return true;
}

static void a_polygon_said_to_be_within_meets_no_clear_cell(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(3, 5);
    pvtBitmap cells;
    CHECK_OK(context, pvtCreateBitmap(context, 12, 10, &cells));
    int within = 0;
    for (int round = 0; round < 400; ++round) {
        const int cellsPerVoxel = 1 << (round % 3);
        const int32_t unit = 256 / cellsPerVoxel;
        for (int y = 0; y < 10; ++y) {
            for (int x = 0; x < 12; ++x) {
                pvtBitmap_Set(&cells, x, y, pvtRandom_Below(&random, 12) != 0);
            }
        }
        pvtPoint2 t[3];
        for (int c = 0; c < 3; ++c) {
            t[c].x = (int32_t)pvtRandom_Below(&random, (uint32_t)(6 * unit)) + 2 * unit;
            t[c].y = (int32_t)pvtRandom_Below(&random, (uint32_t)(5 * unit)) + 2 * unit;
        }
        if (pvtGetLoopArea2(t, 3) <= 0) {
            continue;
        }
        if (pvtIsPolygonWithin(&cells, cellsPerVoxel, t, 3)) {
            ++within;
            assert_true(IsWithinBySampling(&cells, unit, t));
        }
        // With every cell clear that the samples missed, it is exact the other way round as well:
        // clearing any cell that a sample hits makes it leave.
        const double sum[2] = {(t[0].x + t[1].x + t[2].x) / 3.0, (t[0].y + t[1].y + t[2].y) / 3.0};
        pvtBitmap_Set(&cells, (int)(sum[0] / unit), (int)(sum[1] / unit), false);
        assert_false(pvtIsPolygonWithin(&cells, cellsPerVoxel, t, 3));
    }
    assert_true(within > 20);
    pvtBitmap_Free(context, &cells);
    DestroyTestContext(context);
}

static void a_rectangle_of_whole_cells_is_within_them_exactly(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap cells;
    CHECK_OK(context, pvtCreateBitmap(context, 70, 9, &cells));
    for (int y = 2; y < 7; ++y) {
        for (int x = 3; x < 67; ++x) {
            pvtBitmap_Set(&cells, x, y, true);
        }
    }
    const pvtPoint2 exact[] = {
        {3 * 256, 2 * 256}, {67 * 256, 2 * 256}, {67 * 256, 7 * 256}, {3 * 256, 7 * 256}};
    assert_true(pvtIsPolygonWithin(&cells, 1, exact, 4));
    for (int corner = 0; corner < 4; ++corner) {
        for (int way = 0; way < 2; ++way) {
            pvtPoint2 grown[4];
            memcpy(grown, exact, sizeof grown);
            const int32_t outwards = corner == 1 || corner == 2 ? 1 : -1;
            grown[corner].x += way == 0 ? outwards : 0;
            grown[corner].y += way == 1 ? (corner >= 2 ? 1 : -1) : 0;
            assert_false(pvtIsPolygonWithin(&cells, 1, grown, 4));
        }
    }
    pvtBitmap_Free(context, &cells);
    DestroyTestContext(context);
}

static void crossed_folded_and_clockwise_polygons_are_not_simple(void** state)
{
    (void)state;
    const pvtPoint2 square[] = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};
    const pvtPoint2 clockwise[] = {{0, 10}, {10, 10}, {10, 0}, {0, 0}};
    const pvtPoint2 crossed[] = {{0, 0}, {10, 0}, {0, 10}, {10, 11}};
    const pvtPoint2 spike[] = {{0, 0}, {10, 0}, {20, 0}, {10, 0}, {10, 10}};
    const pvtPoint2 touching[] = {{0, 0}, {10, 0}, {10, 10}, {5, 0}, {0, 10}};
    const pvtPoint2 notched[] = {{0, 0}, {10, 0}, {10, 10}, {5, 1}, {0, 10}};
    const pvtPoint2 flat[] = {{0, 0}, {10, 0}, {20, 0}};
    assert_true(pvtIsPolygonSimple(square, 4));
    assert_true(pvtIsPolygonSimple(notched, 5));
    assert_false(pvtIsPolygonSimple(clockwise, 4));
    assert_false(pvtIsPolygonSimple(crossed, 4));
    assert_false(pvtIsPolygonSimple(spike, 5));
    assert_false(pvtIsPolygonSimple(touching, 5));
    assert_false(pvtIsPolygonSimple(flat, 3));
}

// A square of 20 with a hole of 4 that a bridge leads to from its corner.
static void edges_of_a_bridge_may_lie_on_each_other_and_others_may_not_cross(void** state)
{
    (void)state;
    enum { COUNT = 10, HOLE = 5 };
    const pvtPoint2 square[COUNT] = {{0, 0}, {20, 0}, {20, 20}, {0, 20}, {0, 0},
                                     {8, 8}, {8, 12}, {12, 12}, {12, 8}, {8, 8}};
    for (size_t i = 0; i < COUNT; ++i) {
        assert_true(pvtIsPointFree(square, COUNT, i));
    }
    static const struct {
        size_t index;
        pvtPoint2 there;
        bool isFree;
    } moves[] = {
        {2, {25, 25}, true},  // outwards
        {7, {10, 11}, true},  // the hole becomes smaller,
        {7, {8, 8}, true},    // closes,
        {7, {5, 5}, false},   // or reaches over its bridge
        {1, {10, 10}, false}, // an edge through the hole
        {2, {-5, 5}, false},  // and one through the other side
        {1, {0, 0}, false},   // an edge without length
    };
    for (size_t m = 0; m < sizeof moves / sizeof *moves; ++m) {
        pvtPoint2 moved[COUNT];
        memcpy(moved, square, sizeof moved);
        moved[moves[m].index] = moves[m].there;
        assert_int_equal(pvtIsPointFree(moved, COUNT, moves[m].index), moves[m].isFree);
    }
    const pvtPoint2 inHole[3] = {{9, 9}, {11, 9}, {10, 11}};
    const pvtPoint2 within[3] = {{14, 2}, {18, 2}, {16, 6}};
    const pvtPoint2 outside[3] = {{24, 2}, {28, 2}, {26, 6}};
    assert_int_equal(pvtGetWinding(square, COUNT, inHole), 0);
    assert_int_equal(pvtGetWinding(square, COUNT, within), 1);
    assert_int_equal(pvtGetWinding(square, COUNT, outside), 0);
    // Turned inside out, the hole is there twice.
    pvtPoint2 twice[COUNT];
    memcpy(twice, square, sizeof twice);
    twice[HOLE + 1] = square[HOLE + 3];
    twice[HOLE + 3] = square[HOLE + 1];
    assert_int_equal(pvtGetWinding(twice, COUNT, inHole), 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_polygon_said_to_be_within_meets_no_clear_cell),
        cmocka_unit_test(a_rectangle_of_whole_cells_is_within_them_exactly),
        cmocka_unit_test(edges_of_a_bridge_may_lie_on_each_other_and_others_may_not_cross),
        cmocka_unit_test(crossed_folded_and_clockwise_polygons_are_not_simple),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
