// SPDX-License-Identifier: MIT
#include "shapes.h"

#include "base/context.h"

#include <string.h>

static pvtLoopSet Trace(pvtContext* context, const pvtBitmap* slice, int cellsPerVoxel)
{
    pvtLoopSet contours;
    CHECK_OK(context, pvtTraceContours(context, slice, cellsPerVoxel, &contours));
    return contours;
}

static void areas_sum_to_the_number_of_set_cells(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int seed = 0; seed < 60; ++seed) {
        const int cellsPerVoxel = 1 << seed % 3;
        pvtBitmap slice =
            MakeBlobs(context, 1 + seed * 3, 1 + seed * 5 % 97, (uint64_t)seed, seed % 5);
        pvtLoopSet contours = Trace(context, &slice, cellsPerVoxel);
        const double cell = 1.0 / (cellsPerVoxel * cellsPerVoxel);
        assert_true(GetSetArea(&contours) == (double)pvtBitmap_Count(&slice) * cell);
        pvtLoopSet_Free(context, &contours);
        pvtBitmap_Free(context, &slice);
    }
    DestroyTestContext(context);
}

static void each_cell_is_wound_around_once_if_set_and_else_never(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int seed = 0; seed < 12; ++seed) {
        pvtBitmap slice = MakeBlobs(context, 40, 33, (uint64_t)seed, seed % 4);
        pvtLoopSet contours = Trace(context, &slice, 1);
        for (int i = 0; i < 40 * 33; ++i) {
            const int x = i % 40, y = i / 40;
            int winding = 0;
            for (size_t l = 0; l < contours.loopCount; ++l) {
                winding += GetWinding(contours.points + contours.starts[l],
                                      contours.starts[l + 1] - contours.starts[l],
                                      256.0 * x + 128.0, 256.0 * y + 128.0);
            }
            assert_int_equal(winding, pvtBitmap_Get(&slice, x, y));
        }
        pvtLoopSet_Free(context, &contours);
        pvtBitmap_Free(context, &slice);
    }
    DestroyTestContext(context);
}

static void every_point_is_a_turn_at_a_corner_of_cells(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap slice = MakeBlobs(context, 130, 70, 5, 2);
    pvtLoopSet contours = Trace(context, &slice, 4);
    for (size_t l = 0; l < contours.loopCount; ++l) {
        const size_t begin = contours.starts[l], count = contours.starts[l + 1] - begin;
        assert_true(count >= 4);
        for (size_t i = 0; i < count; ++i) {
            const pvtPoint2 a = contours.points[begin + i];
            const pvtPoint2 b = contours.points[begin + (i + 1) % count];
            const pvtPoint2 c = contours.points[begin + (i + 2) % count];
            assert_true(a.x % 64 == 0 && a.y % 64 == 0);
            assert_true((a.x == b.x) != (a.y == b.y));
            assert_true((a.x == b.x) == (b.y == c.y));
        }
    }
    pvtLoopSet_Free(context, &contours);
    pvtBitmap_Free(context, &slice);
    DestroyTestContext(context);
}

// The centre of a clear cell just inside the first, lowest and leftmost, corner of a hole.
static pvtPoint2 GetPlaceInHole(const pvtLoopSet* contours, size_t hole)
{
    const pvtPoint2 first = contours->points[contours->starts[hole]];
    return (pvtPoint2){first.x + 128, first.y + 128};
}

// Of all outer loops around a place, the one with the least area.
static int32_t FindInnermostOuter(const pvtLoopSet* contours, pvtPoint2 place)
{
    int32_t best = -1;
    int64_t bestArea = INT64_MAX;
    for (size_t l = 0; l < contours->loopCount; ++l) {
        const pvtPoint2* loop = contours->points + contours->starts[l];
        const size_t count = contours->starts[l + 1] - contours->starts[l];
        const int64_t area = pvtGetLoopArea2(loop, count);
        if (area > 0 && area < bestArea && GetWinding(loop, count, place.x, place.y) > 0) {
            best = (int32_t)l;
            bestArea = area;
        }
    }
    return best;
}

static void parents_are_the_outer_loops_directly_around_holes(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    int holes = 0, nested = 0;
    for (int seed = 0; seed < 25; ++seed) {
        pvtBitmap slice = MakeBlobs(context, 90, 90, (uint64_t)seed, 1 + seed % 3);
        pvtLoopSet contours = Trace(context, &slice, 1);
        for (size_t l = 0; l < contours.loopCount; ++l) {
            const pvtPoint2* loop = contours.points + contours.starts[l];
            const size_t count = contours.starts[l + 1] - contours.starts[l];
            if (contours.parents[l] < 0) {
                assert_true(pvtGetLoopArea2(loop, count) > 0);
                const pvtPoint2 inside = GetPlaceInHole(&contours, l);
                nested += FindInnermostOuter(&contours, inside) != (int32_t)l;
                continue;
            }
            ++holes;
            assert_true(pvtGetLoopArea2(loop, count) < 0);
            assert_int_equal(contours.parents[l],
                             FindInnermostOuter(&contours, GetPlaceInHole(&contours, l)));
        }
        pvtLoopSet_Free(context, &contours);
        pvtBitmap_Free(context, &slice);
    }
    assert_true(holes > 100);
    assert_int_equal(nested, 0);
    DestroyTestContext(context);
}

static bool AreRingsInRings(int x, int y, int size)
{
    const int ring = x < y ? x : y;
    const int far = size - 1 - (x > y ? x : y);
    return (ring < far ? ring : far) % 2 == 0;
}

static void islands_in_holes_are_outer_loops_with_holes_of_their_own(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap slice = MakeShape(context, 11, AreRingsInRings);
    pvtLoopSet contours = Trace(context, &slice, 1);
    assert_int_equal(contours.loopCount, 6);
    for (int32_t l = 0; l < 6; ++l) {
        assert_int_equal(contours.parents[l], l % 2 == 0 ? -1 : l - 1);
    }
    pvtLoopSet_Free(context, &contours);
    pvtBitmap_Free(context, &slice);
    DestroyTestContext(context);
}

static void loops_of_diagonal_cells_stay_apart(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap slice = MakeShape(context, 64, IsCheckered);
    pvtLoopSet contours = Trace(context, &slice, 2);
    assert_int_equal(contours.loopCount, 64 * 32);
    for (size_t l = 0; l < contours.loopCount; ++l) {
        assert_int_equal(contours.starts[l], 4 * l);
        assert_int_equal(pvtGetLoopArea2(contours.points + 4 * l, 4), 2 * 128 * 128);
        assert_int_equal(contours.parents[l], -1);
    }
    pvtLoopSet_Free(context, &contours);
    pvtBitmap_Free(context, &slice);
    DestroyTestContext(context);
}

static void clear_cells_that_meet_diagonally_make_one_hole(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap slice = MakeShape(context, 6, IsEverywhere);
    pvtBitmap_Set(&slice, 2, 2, false);
    pvtBitmap_Set(&slice, 3, 3, false);
    pvtLoopSet contours = Trace(context, &slice, 1);
    assert_int_equal(contours.loopCount, 2);
    assert_int_equal(contours.parents[1], 0);
    assert_int_equal(pvtGetLoopArea2(contours.points + 4, 8), -2 * 2 * 65536);
    pvtLoopSet_Free(context, &contours);
    pvtBitmap_Free(context, &slice);

    slice = MakeShape(context, 5, IsPinchedRing);
    contours = Trace(context, &slice, 1);
    assert_int_equal(contours.loopCount, 1);
    assert_int_equal(contours.pointCount, 10);
    pvtLoopSet_Free(context, &contours);
    pvtBitmap_Free(context, &slice);
    DestroyTestContext(context);
}

static void the_least_and_the_fullest_slices_have_the_loops_they_should(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int size = 1; size <= 193; size += 32) {
        pvtBitmap slice = MakeShape(context, size, IsEverywhere);
        pvtLoopSet contours = Trace(context, &slice, 1);
        assert_int_equal(contours.loopCount, 1);
        assert_int_equal(contours.pointCount, 4);
        const int32_t side = size * 256;
        const pvtPoint2 expected[] = {{0, 0}, {side, 0}, {side, side}, {0, side}};
        assert_memory_equal(contours.points, expected, sizeof expected);
        pvtLoopSet_Free(context, &contours);
        memset(slice.words, 0, slice.wordsPerRow * (size_t)size * sizeof *slice.words);
        contours = Trace(context, &slice, 1);
        assert_int_equal(contours.loopCount, 0);
        assert_int_equal(contours.starts[0], 0);
        pvtLoopSet_Free(context, &contours);
        pvtBitmap_Free(context, &slice);
    }
    DestroyTestContext(context);
}

static void nasty_slices_are_traced_in_time(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    ShapeFcn* const shapes[] = {IsCheckered, IsSieve, IsComb};
    const double start = GetCpuSeconds();
    for (int i = 0; i < 3; ++i) {
        pvtBitmap slice = MakeShape(context, 512, shapes[i]);
        pvtLoopSet contours = Trace(context, &slice, 1);
        assert_true(GetSetArea(&contours) == (double)pvtBitmap_Count(&slice));
        pvtLoopSet_Free(context, &contours);
        pvtBitmap_Free(context, &slice);
    }
    // Far above what it takes, also under a sanitizer, and far below what a quadratic search would.
    assert_true(GetCpuSeconds() - start < 2.0);
    DestroyTestContext(context);
}

static void an_unknown_number_of_cells_a_voxel_is_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap slice = MakeShape(context, 3, IsEverywhere);
    pvtLoopSet contours;
    assert_int_equal(pvtTraceContours(context, &slice, 3, &contours), PVT_INVALID_ARGUMENT);
    assert_null(contours.points);
    pvtBitmap_Free(context, &slice);
    DestroyTestContext(context);
}

static pvtStatus TraceAndFree(pvtContext* context, const void* input)
{
    pvtLoopSet contours;
    const pvtStatus status = pvtTraceContours(context, input, 1, &contours);
    pvtLoopSet_Free(context, &contours);
    return status;
}

static void a_failed_allocation_leaves_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap slice = MakeBlobs(context, 40, 40, 1, 2);
    CheckEveryAllocation(TraceAndFree, &slice);
    pvtBitmap_Free(context, &slice);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(areas_sum_to_the_number_of_set_cells),
        cmocka_unit_test(each_cell_is_wound_around_once_if_set_and_else_never),
        cmocka_unit_test(every_point_is_a_turn_at_a_corner_of_cells),
        cmocka_unit_test(parents_are_the_outer_loops_directly_around_holes),
        cmocka_unit_test(islands_in_holes_are_outer_loops_with_holes_of_their_own),
        cmocka_unit_test(loops_of_diagonal_cells_stay_apart),
        cmocka_unit_test(clear_cells_that_meet_diagonally_make_one_hole),
        cmocka_unit_test(the_least_and_the_fullest_slices_have_the_loops_they_should),
        cmocka_unit_test(nasty_slices_are_traced_in_time),
        cmocka_unit_test(an_unknown_number_of_cells_a_voxel_is_refused),
        cmocka_unit_test(a_failed_allocation_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
