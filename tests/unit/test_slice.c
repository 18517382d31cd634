// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include <math.h>
#include <paravent/section.h>
#include <stdlib.h>
#include <string.h>

enum { ONE = 1 << PVT_PLANE_BITS };

static pvtBitmap MakeSliceBitmap(pvtContext* context, const pvtBitGrid* grid, const pvtPlane* plane,
                                 int cells)
{
    pvtBitmap slice;
    CHECK_OK(context, pvtCreateBitmap(context, grid->frame.size[pvtPlane_GetU(plane)] * cells,
                                      grid->frame.size[pvtPlane_GetV(plane)] * cells, &slice));
    memset(slice.words, 0xA5, slice.wordsPerRow * (size_t)slice.height * 8);
    return slice;
}

static int64_t FloorDivide(int64_t a, int64_t b)
{
    return a / b - (a % b < 0 ? 1 : 0);
}

// The plane's height [vx] over the point (u, v), given in eighths of a voxel, times 8 × ONE.
static int64_t GetHeight(const pvtPlane* plane, int64_t u8, int64_t v8)
{
    return plane->offset * 8 + plane->slopeU * u8 + plane->slopeV * v8;
}

// What a cell should say, from the definition: voxel by voxel, corner by corner.
static bool AskOracle(const pvtBitGrid* grid, const pvtPlane* plane, pvtSliceRule rule, int cells,
                      const int cell[2])
{
    const int64_t one = INT64_C(8) * ONE;
    const int step = 8 / cells;
    int64_t low = INT64_MAX, high = INT64_MIN;
    for (int corner = 0; corner < 4; ++corner) {
        const int64_t height = GetHeight(plane, (int64_t)(cell[0] + (corner & 1)) * step,
                                         (int64_t)(cell[1] + (corner >> 1)) * step);
        low = height < low ? height : low;
        high = height > high ? height : high;
    }
    int64_t first = -FloorDivide(-low, one) - 1, last = FloorDivide(high, one);
    if (rule == PVT_SLICE_CENTER) {
        first = last = FloorDivide(GetHeight(plane, (int64_t)cell[0] * step + step / 2,
                                             (int64_t)cell[1] * step + step / 2),
                                   one);
    }
    int position[3] = {0};
    position[pvtPlane_GetU(plane)] = cell[0] / cells;
    position[pvtPlane_GetV(plane)] = cell[1] / cells;
    for (int64_t n = first; n <= last; ++n) {
        position[plane->axis] = (int)n;
        if (!pvtBitGrid_Get(grid, position[0], position[1], position[2])) {
            return false;
        }
    }
    return true;
}

static void CheckSlice(pvtContext* context, const pvtSliceVolume* volume, const pvtPlane* plane,
                       pvtSliceRule rule, int cells)
{
    pvtBitmap slice = MakeSliceBitmap(context, volume->grid, plane, cells);
    pvtSliceGrid(volume, plane, rule, cells, &slice);
    uint64_t count = 0;
    for (int j = 0; j < slice.height; ++j) {
        for (int i = 0; i < slice.width; ++i) {
            const bool expected = AskOracle(volume->grid, plane, rule, cells, (int[]){i, j});
            if (pvtBitmap_Get(&slice, i, j) != expected) {
                fail_msg("axis %d slopes %d %d offset %lld rule %d cells %d: (%d, %d) is not %d",
                         (int)plane->axis, plane->slopeU, plane->slopeV, (long long)plane->offset,
                         (int)rule, cells, i, j, (int)expected);
            }
            count += expected ? 1 : 0;
        }
    }
    // Also says that no bit past the width is set.
    assert_true(pvtBitmap_Count(&slice) == count);
    pvtBitmap_Free(context, &slice);
}

static void CheckAllSlices(pvtContext* context, const pvtSliceVolume* volume, const pvtPlane* plane)
{
    for (int cells = 1; cells <= 4; cells *= 2) {
        CheckSlice(context, volume, plane, PVT_SLICE_CENTER, cells);
        CheckSlice(context, volume, plane, PVT_SLICE_COVERED, cells);
    }
}

static const int32_t slopes[] = {0,       16,      -16,        ONE / 2,     -ONE / 2,  ONE,
                                 -ONE,    ONE - 1, 1 - ONE,    ONE / 64,    ONE / 3,   -ONE / 7,
                                 1048560, -524304, 16 * 12345, -16 * 54321, 16 * 60001};
enum { SLOPE_COUNT = (int)(sizeof slopes / sizeof slopes[0]) };

// Planes through the middle of the grid, give or take its half along the axis.
static pvtPlane MakeTestPlane(const pvtBitGrid* grid, pvtRandom* random, int axis, bool planned)
{
    pvtPlane plane = {.axis = (pvtAxis)axis,
                      .slopeU = slopes[pvtRandom_Below(random, SLOPE_COUNT)],
                      .slopeV = slopes[pvtRandom_Below(random, SLOPE_COUNT)]};
    const int64_t middle = (int64_t)grid->frame.size[axis] * (ONE / 2) -
                           (int64_t)plane.slopeU * grid->frame.size[pvtPlane_GetU(&plane)] / 2 -
                           (int64_t)plane.slopeV * grid->frame.size[pvtPlane_GetV(&plane)] / 2;
    const int64_t shift = (int64_t)(pvtRandom_Unit(random) * grid->frame.size[axis] * ONE);
    plane.offset = middle + shift - (int64_t)grid->frame.size[axis] * (ONE / 2);
    plane.offset = planned ? plane.offset | 1 : plane.offset & ~(int64_t)(ONE / 2 - 1);
    return plane;
}

static void slices_agree_with_a_look_at_every_voxel(void** state)
{
    (void)state;
    static const int sizes[][3] = {{70, 33, 130}, {9, 8, 65}, {64, 128, 1}, {1, 70, 20}};
    pvtContext* context = CreateTestContext(2);
    pvtRandom random = pvtMakeRandom(7, 1);
    for (int trial = 0; trial < 12; ++trial) {
        const int* size = sizes[trial % 4];
        pvtBitGrid grid;
        MakeEmptyGrid(context, size[0], size[1], size[2], &grid);
        FillRandomly(&grid, &random, trial % 3 == 0 ? 50 : trial % 3 == 1 ? 94 : 100);
        pvtSliceVolume volume;
        CHECK_OK(context, pvtCreateSliceVolume(context, &grid, &volume));
        for (int axis = 0; axis < 3; ++axis) {
            for (int n = 0; n < 4; ++n) {
                // Planes that are not planned meet faces and edges exactly.
                const pvtPlane plane = MakeTestPlane(&grid, &random, axis, n < 2);
                CheckAllSlices(context, &volume, &plane);
            }
        }
        pvtSliceVolume_Free(context, &volume);
        pvtBitGrid_Free(context, &grid);
    }
    DestroyTestContext(context);
}

static void patches_that_reach_corners_exactly_touch_four_voxels(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(12, 1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, 70, 70, 70, &grid);
    FillRandomly(&grid, &random, 86);
    pvtSliceVolume volume;
    CHECK_OK(context, pvtCreateSliceVolume(context, &grid, &volume));
    for (int n = 0; n < 12; ++n) {
        const int32_t u = n & 1 ? ONE : -ONE, v = n & 2 ? ONE : -ONE;
        // Through the middle of the grid.
        const pvtPlane plane = {(pvtAxis)(n / 4), u, v, INT64_C(35) * (ONE - u - v)};
        CheckAllSlices(context, &volume, &plane);
    }
    pvtSliceVolume_Free(context, &volume);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void planes_outside_the_grid_have_no_slice(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(8, 1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, 66, 20, 20, &grid);
    FillRandomly(&grid, &random, 100);
    pvtSliceVolume volume;
    CHECK_OK(context, pvtCreateSliceVolume(context, &grid, &volume));
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = -1; side <= 1; side += 2) {
            const pvtPlane plane = {(pvtAxis)axis, ONE, -ONE / 3, side * (INT64_C(1) << 49) + 1};
            pvtBitmap slice = MakeSliceBitmap(context, &grid, &plane, 1);
            pvtSliceGrid(&volume, &plane, PVT_SLICE_CENTER, 1, &slice);
            assert_true(pvtBitmap_Count(&slice) == 0);
            pvtBitmap_Free(context, &slice);
        }
    }
    pvtSliceVolume_Free(context, &volume);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

// Walks a lattice of points of each covered cell's patch, its border included.
static void CheckCoveredPatches(const pvtBitGrid* grid, const pvtPlane* plane, int cells,
                                const pvtBitmap* slice)
{
    for (int cell = 0; cell < slice->width * slice->height; ++cell) {
        const int i = cell % slice->width, j = cell / slice->width;
        for (int point = 0; point < 25 && pvtBitmap_Get(slice, i, j); ++point) {
            const double u = (i + (point % 5) / 4.0) / cells, v = (j + point / 5 / 4.0) / cells;
            const double height =
                ((double)plane->offset + plane->slopeU * u + plane->slopeV * v) / ONE;
            int position[3] = {0};
            position[pvtPlane_GetU(plane)] = i / cells;
            position[pvtPlane_GetV(plane)] = j / cells;
            position[plane->axis] = (int)floor(height);
            assert_true(pvtBitGrid_Get(grid, position[0], position[1], position[2]));
            position[plane->axis] = (int)ceil(height) - 1;
            assert_true(pvtBitGrid_Get(grid, position[0], position[1], position[2]));
        }
    }
}

static void covered_cells_touch_no_clear_voxel_and_have_their_centre_set(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(9, 1);
    uint64_t covered = 0, centered = 0;
    for (int trial = 0; trial < 10; ++trial) {
        pvtBitGrid grid;
        MakeEmptyGrid(context, 40, 30, 35, &grid);
        FillRandomly(&grid, &random, 90);
        pvtSliceVolume volume;
        CHECK_OK(context, pvtCreateSliceVolume(context, &grid, &volume));
        for (int axis = 0; axis < 3; ++axis) {
            const int cells = 1 << (trial % 3);
            const pvtPlane plane = MakeTestPlane(&grid, &random, axis, trial % 2 == 0);
            pvtBitmap strict = MakeSliceBitmap(context, &grid, &plane, cells);
            pvtBitmap center = MakeSliceBitmap(context, &grid, &plane, cells);
            pvtSliceGrid(&volume, &plane, PVT_SLICE_COVERED, cells, &strict);
            pvtSliceGrid(&volume, &plane, PVT_SLICE_CENTER, cells, &center);
            for (size_t w = 0; w < strict.wordsPerRow * (size_t)strict.height; ++w) {
                assert_true((strict.words[w] & ~center.words[w]) == 0);
            }
            CheckCoveredPatches(&grid, &plane, cells, &strict);
            covered += pvtBitmap_Count(&strict);
            centered += pvtBitmap_Count(&center);
            pvtBitmap_Free(context, &strict);
            pvtBitmap_Free(context, &center);
        }
        pvtSliceVolume_Free(context, &volume);
        pvtBitGrid_Free(context, &grid);
    }
    assert_true(covered > 1000 && covered < centered);
    DestroyTestContext(context);
}

static double MeasureBallSlice(pvtContext* context, const pvtSliceVolume* volume, pvtVec3 direction,
                               double depth, int cells)
{
    const double middle = 0.5 * volume->grid->frame.size[0];
    const double length =
        sqrt(direction.x * direction.x + direction.y * direction.y + direction.z * direction.z);
    const pvtVec3 point = {middle + depth * direction.x / length,
                           middle + depth * direction.y / length,
                           middle + depth * direction.z / length};
    const pvtPlane plane = pvtMakePlane(&volume->grid->frame, direction, point);
    pvtBitmap slice = MakeSliceBitmap(context, volume->grid, &plane, cells);
    pvtSliceGrid(volume, &plane, PVT_SLICE_CENTER, cells, &slice);
    const double area = pvtMeasureSlice(&slice, &plane, cells);
    pvtBitmap_Free(context, &slice);
    return area;
}

static void slices_of_a_ball_have_the_area_of_a_disk_in_any_direction(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const double radius = 45.0, pi = 3.14159265358979;
    pvtBitGrid grid;
    MakeEmptyGrid(context, 100, 100, 100, &grid);
    SetBall(&grid, (pvtVec3){50.0, 50.0, 50.0}, radius);
    pvtSliceVolume volume;
    CHECK_OK(context, pvtCreateSliceVolume(context, &grid, &volume));
    pvtRandom random = pvtMakeRandom(10, 1);
    for (int trial = 0; trial < 60; ++trial) {
        const pvtVec3 direction = {pvtRandom_Unit(&random) - 0.5, pvtRandom_Unit(&random) - 0.5,
                                   pvtRandom_Unit(&random) - 0.5};
        const double depth = 0.6 * radius * pvtRandom_Unit(&random);
        const double disk = pi * (radius * radius - depth * depth);
        const double area = MeasureBallSlice(context, &volume, direction, depth, 1 << (trial % 3));
        assert_true(fabs(area - disk) < 0.02 * disk);
    }
    pvtSliceVolume_Free(context, &volume);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void the_axes_are_alike(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, 80, 80, 80, &grid);
    SetBall(&grid, (pvtVec3){40.0, 40.0, 40.0}, 37.5);
    pvtSliceVolume volume;
    CHECK_OK(context, pvtCreateSliceVolume(context, &grid, &volume));
    for (int cells = 1; cells <= 4; cells *= 2) {
        for (int depth = 0; depth < 30; depth += 7) {
            // The half keeps the points off the faces, where rounding would choose.
            const double at = depth + 0.5;
            const pvtVec3 a = {1.0, 0.25, -0.625}, b = {0.25, 1.0, -0.625}, c = {0.25, -0.625, 1.0};
            const double area = MeasureBallSlice(context, &volume, a, at, cells);
            assert_true(area > 0.0);
            assert_true(area == MeasureBallSlice(context, &volume, b, at, cells));
            assert_true(area == MeasureBallSlice(context, &volume, c, at, cells));
        }
    }
    pvtSliceVolume_Free(context, &volume);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void a_volume_is_the_same_for_any_number_of_threads_and_leaks_nothing(void** state)
{
    (void)state;
    pvtContext* one = CreateTestContext(1);
    pvtContext* four = CreateTestContext(4);
    pvtRandom random = pvtMakeRandom(11, 1);
    pvtBitGrid grid;
    MakeEmptyGrid(one, 100, 70, 90, &grid);
    FillRandomly(&grid, &random, 8);
    pvtSliceVolume a, b;
    CHECK_OK(one, pvtCreateSliceVolume(one, &grid, &a));
    CHECK_OK(four, pvtCreateSliceVolume(four, &grid, &b));
    for (int axis = 0; axis < 3; ++axis) {
        const size_t columns =
            a.axes[axis].wordsPerRow * (size_t)grid.frame.size[axis == 2 ? 1 : 2];
        assert_memory_equal(a.axes[axis].words, b.axes[axis].words,
                            columns * a.axes[axis].stride * 8);
        assert_memory_equal(a.axes[axis].ranges, b.axes[axis].ranges, columns * 8);
    }
    pvtSliceVolume_Free(one, &a);
    pvtSliceVolume_Free(four, &b);
    pvtBitGrid_Free(one, &grid);
    DestroyTestContext(one);
    DestroyTestContext(four);
}

static void a_volume_that_does_not_fit_is_left_empty(void** state)
{
    (void)state;
    pvtContext* plenty = CreateTestContext(1);
    pvtBitGrid grid;
    MakeEmptyGrid(plenty, 20, 20, 20, &grid);
    bool made = false;
    for (int failAt = 1; !made; ++failAt) {
        PoorHeap heap = {.failAt = failAt};
        pvtContext* context = CreatePoorContext(&heap);
        pvtSliceVolume volume;
        const pvtStatus status = pvtCreateSliceVolume(context, &grid, &volume);
        made = status == PVT_OK;
        assert_true(made || (status == PVT_OUT_OF_MEMORY && volume.axes[0].words == NULL));
        pvtSliceVolume_Free(context, &volume);
        DestroyTestContext(context);
    }
    pvtBitGrid_Free(plenty, &grid);
    DestroyTestContext(plenty);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_agree_with_a_look_at_every_voxel),
        cmocka_unit_test(patches_that_reach_corners_exactly_touch_four_voxels),
        cmocka_unit_test(planes_outside_the_grid_have_no_slice),
        cmocka_unit_test(covered_cells_touch_no_clear_voxel_and_have_their_centre_set),
        cmocka_unit_test(slices_of_a_ball_have_the_area_of_a_disk_in_any_direction),
        cmocka_unit_test(the_axes_are_alike),
        cmocka_unit_test(a_volume_is_the_same_for_any_number_of_threads_and_leaks_nothing),
        cmocka_unit_test(a_volume_that_does_not_fit_is_left_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
