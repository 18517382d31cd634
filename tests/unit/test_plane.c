// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/random.h"
#include "base/vector.h"

#include <paravent/section.h>

static const pvtGridFrame frame = {{-3.0, 12.5, 0.25}, 0.125, {256, 256, 256}};

static bool IsNear(double a, double b)
{
    return fabs(a - b) < 1e-9;
}

static pvtVec3 MakeRandomDirection(pvtRandom* random)
{
    pvtVec3 direction;
    do {
        direction =
            (pvtVec3){2.0 * pvtRandom_Unit(random) - 1.0, 2.0 * pvtRandom_Unit(random) - 1.0,
                      2.0 * pvtRandom_Unit(random) - 1.0};
    } while (pvtDot(direction, direction) < 0.01);
    return direction;
}

static pvtVec3 MakeRandomPoint(pvtRandom* random)
{
    const pvtVec3 voxel = {256.0 * pvtRandom_Unit(random), 256.0 * pvtRandom_Unit(random),
                           256.0 * pvtRandom_Unit(random)};
    return pvtAdd(frame.origin, pvtScale(voxel, frame.voxelSize));
}

static void a_plane_goes_through_its_point_across_its_direction(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(1, 1);
    for (int trial = 0; trial < 10000; ++trial) {
        const pvtVec3 direction = MakeRandomDirection(&random);
        const pvtVec3 point = MakeRandomPoint(&random);
        const pvtPlane plane = pvtMakePlane(&frame, direction, point);
        const pvtVec3 normal = pvtPlane_GetNormal(&plane);
        const pvtVec3 on = pvtPlane_ToWorld(&plane, &frame, (pvtPoint2){0, 0});
        // The offset is rounded by at most 2⁻²⁰ voxel, a slope by at most 2⁻¹⁷.
        assert_true(fabs(pvtDot(normal, pvtSub(point, on))) <= 0x1.01p-20 * frame.voxelSize);
        assert_true(pvtLength3(pvtCross(normal, pvtNormalize(direction))) < 0x1p-16);
        assert_true(pvtGetAxis(normal, (int)plane.axis) > 0.577);
    }
}

static void points_given_in_the_plane_lie_on_it_in_the_world(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(2, 1);
    for (int trial = 0; trial < 10000; ++trial) {
        const pvtPlane plane =
            pvtMakePlane(&frame, MakeRandomDirection(&random), MakeRandomPoint(&random));
        const pvtPoint2 a = {(int32_t)pvtRandom_Below(&random, 65537),
                             (int32_t)pvtRandom_Below(&random, 65537)};
        const pvtVec3 origin = pvtPlane_ToWorld(&plane, &frame, (pvtPoint2){0, 0});
        const pvtVec3 world = pvtPlane_ToWorld(&plane, &frame, a);
        const pvtVec3 grid = pvtScale(pvtSub(world, frame.origin), 1.0 / frame.voxelSize);
        assert_true(IsNear(pvtGetAxis(grid, (int)pvtPlane_GetU(&plane)), a.x / 256.0));
        assert_true(IsNear(pvtGetAxis(grid, (int)pvtPlane_GetV(&plane)), a.y / 256.0));
        assert_true(IsNear(pvtDot(pvtSub(world, origin), pvtPlane_GetNormal(&plane)), 0.0));
    }
}

static void u_v_and_the_dominant_axis_are_all_three_axes(void** state)
{
    (void)state;
    for (int axis = 0; axis < 3; ++axis) {
        const pvtPlane plane = {.axis = (pvtAxis)axis};
        assert_true(pvtPlane_GetU(&plane) < pvtPlane_GetV(&plane));
        assert_int_equal(
            (1 << plane.axis) | (1 << pvtPlane_GetU(&plane)) | (1 << pvtPlane_GetV(&plane)), 7);
    }
}

static void area_in_the_plane_scales_as_the_true_area(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(3, 1);
    for (int trial = 0; trial < 1000; ++trial) {
        const pvtPlane plane =
            pvtMakePlane(&frame, MakeRandomDirection(&random), MakeRandomPoint(&random));
        const pvtVec3 corner = pvtPlane_ToWorld(&plane, &frame, (pvtPoint2){0, 0});
        const pvtVec3 u = pvtSub(pvtPlane_ToWorld(&plane, &frame, (pvtPoint2){256, 0}), corner);
        const pvtVec3 v = pvtSub(pvtPlane_ToWorld(&plane, &frame, (pvtPoint2){0, 256}), corner);
        const double area = pvtLength3(pvtCross(u, v)) / (frame.voxelSize * frame.voxelSize);
        assert_true(IsNear(pvtPlane_GetAreaScale(&plane), area));
        assert_true(IsNear(pvtGetAxis(pvtPlane_GetNormal(&plane), (int)plane.axis), 1.0 / area));
    }
}

static void no_cell_centre_of_a_planned_plane_lies_on_a_voxel_face(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(4, 1);
    for (int trial = 0; trial < 2000; ++trial) {
        const pvtPlane plane =
            pvtMakePlane(&frame, MakeRandomDirection(&random), MakeRandomPoint(&random));
        assert_true(plane.offset & 1);
        for (int step = 0; step < 20; ++step) {
            const int64_t i = 2 * (int64_t)pvtRandom_Below(&random, 1024) + 1;
            const int64_t j = 2 * (int64_t)pvtRandom_Below(&random, 1024) + 1;
            const int64_t eighths = 8 * plane.offset + plane.slopeU * i + plane.slopeV * j;
            assert_true(eighths % (INT64_C(8) << PVT_PLANE_BITS) != 0);
        }
    }
}

static void the_dominant_axis_is_the_lowest_of_equals(void** state)
{
    (void)state;
    const pvtVec3 point = frame.origin;
    pvtPlane plane = pvtMakePlane(&frame, (pvtVec3){-1, 1, 0}, point);
    assert_int_equal(plane.axis, PVT_AXIS_X);
    assert_int_equal(plane.slopeU, 1 << PVT_PLANE_BITS);
    assert_int_equal(plane.slopeV, 0);
    plane = pvtMakePlane(&frame, (pvtVec3){0, -7, -7}, point);
    assert_int_equal(plane.axis, PVT_AXIS_Y);
    assert_int_equal(plane.slopeU, 0);
    assert_int_equal(plane.slopeV, -(1 << PVT_PLANE_BITS));
    plane = pvtMakePlane(&frame, (pvtVec3){0.5, 0.5, 0.6}, point);
    assert_int_equal(plane.axis, PVT_AXIS_Z);
}

static void opposite_directions_give_the_same_plane(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(5, 1);
    for (int trial = 0; trial < 1000; ++trial) {
        const pvtVec3 direction = MakeRandomDirection(&random);
        const pvtVec3 point = MakeRandomPoint(&random);
        const pvtPlane a = pvtMakePlane(&frame, direction, point);
        const pvtPlane b = pvtMakePlane(&frame, pvtScale(direction, -2.0), point);
        assert_int_equal(a.axis, b.axis);
        assert_int_equal(a.slopeU, b.slopeU);
        assert_int_equal(a.slopeV, b.slopeV);
        assert_true(a.offset == b.offset);
    }
}

static void a_bitmap_is_clear_at_first_and_outside(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap bitmap;
    CHECK_OK(context, pvtCreateBitmap(context, 70, 9, &bitmap));
    assert_int_equal(pvtBitmap_Count(&bitmap), 0);
    assert_int_equal(bitmap.wordsPerRow, 2);
    pvtBitmap_Set(&bitmap, 69, 8, true);
    pvtBitmap_Set(&bitmap, 0, 0, true);
    pvtBitmap_Set(&bitmap, 3, 4, true);
    pvtBitmap_Set(&bitmap, 3, 4, false);
    assert_int_equal(pvtBitmap_Count(&bitmap), 2);
    assert_true(pvtBitmap_Get(&bitmap, 69, 8));
    assert_false(pvtBitmap_Get(&bitmap, 3, 4));
    assert_false(pvtBitmap_Get(&bitmap, -1, 0));
    assert_false(pvtBitmap_Get(&bitmap, 70, 8));
    assert_false(pvtBitmap_Get(&bitmap, 69, 9));
    pvtBitmap_Free(context, &bitmap);
    assert_int_equal(pvtCreateBitmap(context, 0, 4, &bitmap), PVT_INVALID_ARGUMENT);
    assert_null(bitmap.words);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_goes_through_its_point_across_its_direction),
        cmocka_unit_test(points_given_in_the_plane_lie_on_it_in_the_world),
        cmocka_unit_test(u_v_and_the_dominant_axis_are_all_three_axes),
        cmocka_unit_test(area_in_the_plane_scales_as_the_true_area),
        cmocka_unit_test(no_cell_centre_of_a_planned_plane_lies_on_a_voxel_face),
        cmocka_unit_test(the_dominant_axis_is_the_lowest_of_equals),
        cmocka_unit_test(opposite_directions_give_the_same_plane),
        cmocka_unit_test(a_bitmap_is_clear_at_first_and_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
