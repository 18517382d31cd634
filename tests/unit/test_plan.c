// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include "base/vector.h"
#include "section/directions.h"

#include <stdlib.h>

enum { ONE = 1 << PVT_PLANE_BITS };

static void FillSparse(pvtBitGrid* grid, pvtRandom* random, int count)
{
    for (int i = 0; i < count; ++i) {
        const int y = (int)pvtRandom_Below(random, (uint32_t)grid->frame.size[1]);
        const int z = (int)pvtRandom_Below(random, (uint32_t)grid->frame.size[2]);
        SetVoxel(grid, (int)pvtRandom_Below(random, (uint32_t)grid->frame.size[0]), y, z);
    }
}

// The offset of the plane of this shape through a corner of the grid's lattice.
static int64_t GetOffset(const pvtPlane* shape, const int corner[3])
{
    return (int64_t)corner[shape->axis] * ONE -
           (int64_t)corner[pvtPlane_GetU(shape)] * shape->slopeU -
           (int64_t)corner[pvtPlane_GetV(shape)] * shape->slopeV;
}

static pvtOffsetRange FindRangeSlowly(const pvtBitGrid* grid, const pvtPlane* shape)
{
    pvtOffsetRange range = {INT64_MAX, INT64_MIN};
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (int x = 0; x < grid->frame.size[0]; ++x) {
                for (int n = 0; n < 8 && pvtBitGrid_Get(grid, x, y, z); ++n) {
                    const int corner[3] = {x + (n & 1), y + (n >> 1 & 1), z + (n >> 2)};
                    const int64_t offset = GetOffset(shape, corner);
                    range.lower = offset < range.lower ? offset : range.lower;
                    range.upper = offset > range.upper ? offset : range.upper;
                }
            }
        }
    }
    return range;
}

static void extents_are_those_of_the_farthest_corners_of_set_voxels(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(3);
    pvtRandom random = pvtMakeRandom(20, 1);
    const pvtPlanOptions options = pvtDefaultPlanOptions();
    for (int trial = 0; trial < 12; ++trial) {
        pvtBitGrid grid;
        MakeShiftedGrid(context, 20 + 30 * (trial % 3), 25, 15, &grid);
        FillSparse(&grid, &random, trial < 2 ? 1 : 10 << (trial % 6));
        pvtPlanLine* lines;
        size_t count;
        CHECK_OK(context, pvtCollectDirections(context, &options, &grid.frame, &lines, &count));
        CHECK_OK(context, pvtMeasureExtents(context, &grid, lines, count));
        for (size_t i = 0; i < count; ++i) {
            const pvtOffsetRange expected = FindRangeSlowly(&grid, &lines[i].shape);
            assert_true(lines[i].range.lower == expected.lower);
            assert_true(lines[i].range.upper == expected.upper);
        }
        pvtRelease(context, lines);
        pvtBitGrid_Free(context, &grid);
    }
    DestroyTestContext(context);
}

static bool HaveSameSlopes(const pvtPlane* a, const pvtPlane* b)
{
    return a->axis == b->axis && a->slopeU == b->slopeU && a->slopeV == b->slopeV;
}

static void CheckPlan(const pvtBitGrid* grid, const pvtSectionPlan* plan)
{
    assert_true(plan->binStarts[0] == 0);
    assert_true(plan->binStarts[plan->binCount] == plan->planeCount);
    for (size_t bin = 0; bin < plan->binCount; ++bin) {
        assert_true(plan->binStarts[bin] < plan->binStarts[bin + 1]);
        const pvtPlane* first = &plan->planes[plan->binStarts[bin]];
        for (size_t i = plan->binStarts[bin]; i < plan->binStarts[bin + 1]; ++i) {
            assert_true(HaveSameSlopes(first, &plan->planes[i]));
        }
    }
    for (size_t i = 0; i < plan->planeCount; ++i) {
        const pvtPlane* plane = &plan->planes[i];
        assert_true(plane->slopeU % 16 == 0 && plane->slopeV % 16 == 0 && (plane->offset & 1));
        assert_true(abs(plane->slopeU) <= ONE && abs(plane->slopeV) <= ONE);
    }
    // Every plane of every bin meets the set voxels' extent.
    for (size_t i = 0; i < plan->planeCount; i += 17) {
        const pvtOffsetRange range = FindRangeSlowly(grid, &plan->planes[i]);
        assert_true(plan->planes[i].offset >= range.lower && plan->planes[i].offset <= range.upper);
    }
}

static void planes_are_planned_ones_in_bins_of_one_direction_within_the_extents(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(21, 1);
    pvtFaceDirection faces[] = {{{0.6, 0.8, 0.0}, 2.0}, {{0.999, 0.01, 0.02}, 1.0}};
    const pvtFaceDirectionSet set = {faces, 2};
    pvtPlanOptions options = pvtDefaultPlanOptions();
    for (int trial = 0; trial < 4; ++trial) {
        pvtBitGrid grid;
        MakeShiftedGrid(context, 40, 30, 35, &grid);
        FillSparse(&grid, &random, 3000);
        options.faces = trial % 2 == 0 ? &set : NULL;
        options.depths = trial < 2 ? 24 : 3;
        pvtSectionPlan plan;
        CHECK_OK(context, pvtPlanSections(context, &options, &grid, &plan));
        assert_true(plan.planeCount > 500);
        CheckPlan(&grid, &plan);
        pvtSectionPlan_Free(context, &plan);
        pvtBitGrid_Free(context, &grid);
    }
    DestroyTestContext(context);
}

static void planes_across_an_axis_miss_no_layer_of_voxels(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeShiftedGrid(context, 200, 130, 70, &grid);
    SetBox(&grid, (int[]){10, 20, 30}, (int[]){170, 121, 37});
    pvtPlanOptions options = pvtDefaultPlanOptions();
    options.directions = 0;
    pvtSectionPlan plan;
    CHECK_OK(context, pvtPlanSections(context, &options, &grid, &plan));
    bool met[3][200] = {{false}};
    for (size_t i = 0; i < plan.planeCount; ++i) {
        const pvtPlane* plane = &plan.planes[i];
        if (plane->slopeU == 0 && plane->slopeV == 0) {
            assert_in_range(plane->offset, 1, INT64_C(200) * ONE);
            met[plane->axis][plane->offset / ONE] = true;
        }
    }
    for (int i = 0; i < 200; ++i) {
        assert_int_equal(met[0][i], i >= 10 && i < 170);
        assert_int_equal(met[1][i], i >= 20 && i < 121);
        assert_int_equal(met[2][i], i >= 30 && i < 37);
    }
    pvtSectionPlan_Free(context, &plan);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void
the_ends_of_a_slanted_face_are_tried_from_its_steps_down_to_where_all_is_covered(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(24, 1);
    pvtBitGrid grid;
    MakeShiftedGrid(context, 50, 40, 30, &grid);
    FillSparse(&grid, &random, 2000);
    pvtFaceDirection face = {{0.8, 0.48, 0.36}, 1.0};
    const pvtFaceDirectionSet faces = {&face, 1};
    pvtPlanOptions options = pvtDefaultPlanOptions();
    options.faces = &faces;
    options.axes = false;
    options.directions = 0;
    pvtSectionPlan plan;
    CHECK_OK(context, pvtPlanSections(context, &options, &grid, &plan));
    const pvtOffsetRange range = FindRangeSlowly(&grid, &plan.planes[0]);
    const double covered = 1.0 + (0.48 + 0.36) / 0.8;
    for (size_t end = 0; end < 2; ++end) {
        const size_t bin = plan.binCount - 2 + end;
        double last = 0.0;
        for (size_t i = plan.binStarts[bin]; i < plan.binStarts[bin + 1]; ++i) {
            const int64_t offset = plan.planes[i].offset;
            const int64_t depth = end == 0 ? offset - range.lower : range.upper - offset;
            assert_true(fabs((double)depth / ONE - last - 0.5) < 1e-5);
            last = (double)depth / ONE;
        }
        assert_true(last >= covered && last < covered + 0.5);
    }
    pvtSectionPlan_Free(context, &plan);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static double GetLeastAngle(const pvtPlanLine* lines, size_t count)
{
    double largest = 0.0;
    for (size_t i = 0; i < count; ++i) {
        for (size_t k = 0; k < i; ++k) {
            const double cosine = fabs(pvtDot(lines[i].direction, lines[k].direction));
            largest = cosine > largest ? cosine : largest;
        }
    }
    return acos(largest) * 57.29577951308232;
}

static double GetWidestGap(const pvtPlanLine* lines, size_t count)
{
    pvtRandom random = pvtMakeRandom(22, 1);
    double least = 1.0;
    for (int trial = 0; trial < 5000; ++trial) {
        const pvtVec3 at =
            pvtNormalize((pvtVec3){pvtRandom_Unit(&random) - 0.5, pvtRandom_Unit(&random) - 0.5,
                                   pvtRandom_Unit(&random) - 0.5});
        double nearest = 0.0;
        for (size_t i = 0; i < count; ++i) {
            nearest = fmax(nearest, fabs(pvtDot(lines[i].direction, at)));
        }
        least = fmin(least, nearest);
    }
    return acos(least) * 57.29577951308232;
}

static void directions_are_spread_evenly(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtGridFrame frame = {{0, 0, 0}, 1.0, {256, 256, 256}};
    static const struct {
        int directions;
        bool axes;
        double leastAngle, widestGap; // [°]
    } cases[] = {
        {32, false, 23, 18}, {32, true, 19, 18}, {200, false, 9, 8}, {2000, true, 1.9, 2.5}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        pvtPlanOptions options = pvtDefaultPlanOptions();
        options.directions = cases[i].directions;
        options.axes = cases[i].axes;
        pvtPlanLine* lines;
        size_t count;
        CHECK_OK(context, pvtCollectDirections(context, &options, &frame, &lines, &count));
        assert_true(GetLeastAngle(lines, count) >= cases[i].leastAngle);
        assert_true(GetWidestGap(lines, count) <= cases[i].widestGap);
        pvtRelease(context, lines);
    }
    DestroyTestContext(context);
}

static void faces_come_first_and_near_duplicates_are_dropped(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtGridFrame frame = {{0, 0, 0}, 1.0, {256, 256, 256}};
    // A wall a hair off the x axis, its neighbour 1° away, one near a face diagonal, and one 1.5°
    // off the y axis, which is no reason to do without that axis.
    pvtFaceDirection faces[] = {{{1.0, 0.001, 0.0}, 4.0},
                                {{0.9998, 0.0175, 0.0}, 3.0},
                                {{0.0, 0.7071, 0.7069}, 2.0},
                                {{0.0262, 0.99966, 0.0}, 1.0}};
    const pvtFaceDirectionSet set = {faces, 4};
    pvtPlanOptions options = pvtDefaultPlanOptions();
    options.faces = &set;
    options.directions = 0;
    pvtPlanLine* lines;
    size_t count;
    CHECK_OK(context, pvtCollectDirections(context, &options, &frame, &lines, &count));
    // Three of the faces, y and z, five of the diagonals.
    assert_int_equal(count, 10);
    assert_true(lines[0].shape.axis == PVT_AXIS_X && lines[0].shape.slopeU == 0);
    assert_true(lines[1].direction.z > 0.7 && lines[1].shape.slopeU == 0);
    assert_true(lines[2].shape.axis == PVT_AXIS_Y && lines[2].shape.slopeU != 0);
    assert_true(lines[3].shape.axis == PVT_AXIS_Y && lines[3].shape.slopeU == 0);
    for (size_t i = 0; i < count; ++i) {
        assert_int_equal(lines[i].strong, i < 5);
    }
    pvtRelease(context, lines);
    DestroyTestContext(context);
}

static void plans_are_the_same_for_any_number_of_threads(void** state)
{
    (void)state;
    pvtContext* one = CreateTestContext(1);
    pvtContext* four = CreateTestContext(4);
    pvtRandom random = pvtMakeRandom(23, 1);
    pvtBitGrid grid;
    MakeShiftedGrid(one, 70, 80, 90, &grid);
    FillSparse(&grid, &random, 300);
    const pvtPlanOptions options = pvtDefaultPlanOptions();
    pvtSectionPlan a, b;
    CHECK_OK(one, pvtPlanSections(one, &options, &grid, &a));
    CHECK_OK(four, pvtPlanSections(four, &options, &grid, &b));
    assert_true(a.planeCount == b.planeCount && a.binCount == b.binCount);
    assert_memory_equal(a.planes, b.planes, a.planeCount * sizeof *a.planes);
    assert_memory_equal(a.binStarts, b.binStarts, (a.binCount + 1) * sizeof *a.binStarts);
    pvtSectionPlan_Free(one, &a);
    pvtSectionPlan_Free(four, &b);
    pvtBitGrid_Free(one, &grid);
    DestroyTestContext(one);
    DestroyTestContext(four);
}

static void an_empty_grid_has_an_empty_plan(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeShiftedGrid(context, 10, 10, 10, &grid);
    const pvtPlanOptions options = pvtDefaultPlanOptions();
    pvtSectionPlan plan;
    CHECK_OK(context, pvtPlanSections(context, &options, &grid, &plan));
    assert_true(plan.planeCount == 0 && plan.binCount == 0);
    pvtSectionPlan_Free(context, &plan);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void options_out_of_range_are_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeShiftedGrid(context, 10, 10, 10, &grid);
    for (int i = 0; i < 8; ++i) {
        pvtPlanOptions options = pvtDefaultPlanOptions();
        options.directions = i == 0 ? -1 : i == 1 ? 4097 : options.directions;
        options.depths = i == 2 ? 0 : i == 3 ? 257 : options.depths;
        options.samplesPerBin = i == 4 ? 0 : i == 5 ? 65 : options.samplesPerBin;
        options.outermost = i == 6 ? 0.0 : i == 7 ? (double)NAN : options.outermost;
        pvtSectionPlan plan;
        assert_int_equal(pvtPlanSections(context, &options, &grid, &plan), PVT_INVALID_ARGUMENT);
        assert_null(plan.planes);
    }
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void a_cancelled_plan_is_empty(void** state)
{
    (void)state;
    CancelCounter counter = {0};
    pvtContext* context = CreateCancelledContext(&counter, 2);
    pvtBitGrid grid;
    MakeShiftedGrid(context, 10, 10, 10, &grid);
    SetBox(&grid, (int[]){1, 1, 1}, (int[]){9, 9, 9});
    const pvtPlanOptions options = pvtDefaultPlanOptions();
    pvtSectionPlan plan;
    assert_int_equal(pvtPlanSections(context, &options, &grid, &plan), PVT_CANCELLED);
    assert_null(plan.planes);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void every_failing_allocation_leaves_an_empty_plan(void** state)
{
    (void)state;
    pvtContext* plenty = CreateTestContext(1);
    pvtBitGrid grid;
    MakeShiftedGrid(plenty, 10, 10, 10, &grid);
    SetBox(&grid, (int[]){1, 1, 1}, (int[]){9, 9, 9});
    const pvtPlanOptions options = pvtDefaultPlanOptions();
    bool made = false;
    for (int failAt = 1; !made; ++failAt) {
        PoorHeap heap = {.failAt = failAt};
        pvtContext* context = CreatePoorContext(&heap);
        pvtSectionPlan plan;
        const pvtStatus status = pvtPlanSections(context, &options, &grid, &plan);
        made = status == PVT_OK;
        assert_true(made || (status == PVT_OUT_OF_MEMORY && plan.planes == NULL));
        assert_true(!made || failAt > 5);
        pvtSectionPlan_Free(context, &plan);
        DestroyTestContext(context);
    }
    pvtBitGrid_Free(plenty, &grid);
    DestroyTestContext(plenty);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extents_are_those_of_the_farthest_corners_of_set_voxels),
        cmocka_unit_test(planes_are_planned_ones_in_bins_of_one_direction_within_the_extents),
        cmocka_unit_test(planes_across_an_axis_miss_no_layer_of_voxels),
        cmocka_unit_test(
            the_ends_of_a_slanted_face_are_tried_from_its_steps_down_to_where_all_is_covered),
        cmocka_unit_test(directions_are_spread_evenly),
        cmocka_unit_test(faces_come_first_and_near_duplicates_are_dropped),
        cmocka_unit_test(plans_are_the_same_for_any_number_of_threads),
        cmocka_unit_test(an_empty_grid_has_an_empty_plan),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(a_cancelled_plan_is_empty),
        cmocka_unit_test(every_failing_allocation_leaves_an_empty_plan),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
