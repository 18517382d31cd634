// SPDX-License-Identifier: MIT
#include "shapes.h"

#include "base/context.h"

#include <math.h>
#include <string.h>

static double GetDistance(const pvtPlane* plane, pvtPoint2 point, pvtPoint2 a, pvtPoint2 b)
{
    // By the points in space, so that nothing of the library's way is shared.
    const double slopeU = plane != NULL ? plane->slopeU / 1048576.0 : 0.0;
    const double slopeV = plane != NULL ? plane->slopeV / 1048576.0 : 0.0;
    const double p[3] = {point.x - a.x, point.y - a.y,
                         slopeU * (point.x - a.x) + slopeV * (point.y - a.y)};
    const double d[3] = {b.x - a.x, b.y - a.y, slopeU * (b.x - a.x) + slopeV * (b.y - a.y)};
    const double length2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    double t = length2 > 0.0 ? (p[0] * d[0] + p[1] * d[1] + p[2] * d[2]) / length2 : 0.0;
    t = fmin(1.0, fmax(0.0, t));
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
        sum += (p[i] - t * d[i]) * (p[i] - t * d[i]);
    }
    return sqrt(sum) / 256.0;
}

static bool HasPoint(const pvtLoopSet* set, size_t loop, pvtPoint2 point)
{
    for (size_t i = set->starts[loop]; i < set->starts[loop + 1]; ++i) {
        if (pvtIsSamePoint(set->points[i], point)) {
            return true;
        }
    }
    return false;
}

// All points of a simplified loop come from the contour.
static bool IsMadeOf(const pvtLoopSet* contours, size_t contour, const pvtLoopSet* simplified,
                     size_t loop)
{
    bool isMade = loop < simplified->loopCount;
    for (size_t i = isMade ? simplified->starts[loop] : 0;
         isMade && i < simplified->starts[loop + 1]; ++i) {
        isMade = HasPoint(contours, contour, simplified->points[i]);
    }
    return isMade;
}

// Every point of a contour is near an edge of the loop made of it. A loop that is gone was a hole
// that lay near one line.
static void CheckDistances(const pvtSimplifyOptions* options, const pvtLoopSet* contours,
                           const pvtLoopSet* simplified)
{
    size_t made = 0;
    for (size_t l = 0; l < contours->loopCount; ++l) {
        const bool isGone = !IsMadeOf(contours, l, simplified, made);
        const pvtLoopSet* loops = isGone ? contours : simplified;
        const size_t begin = loops->starts[isGone ? l : made];
        const size_t end = loops->starts[(isGone ? l : made) + 1];
        double farthest = isGone ? 1e9 : 0.0;
        assert_true(!isGone || contours->parents[l] >= 0);
        for (size_t i = begin; i < end; ++i) {
            for (size_t j = begin; isGone && j < end; ++j) {
                double most = 0.0;
                for (size_t k = begin; k < end; ++k) {
                    most = fmax(most, GetDistance(options->plane, loops->points[k],
                                                  loops->points[i], loops->points[j]));
                }
                farthest = fmin(farthest, most);
            }
        }
        for (size_t i = contours->starts[l]; !isGone && i < contours->starts[l + 1]; ++i) {
            double nearest = 1e9;
            for (size_t j = begin; j < end; ++j) {
                nearest =
                    fmin(nearest, GetDistance(options->plane, contours->points[i], loops->points[j],
                                              loops->points[j + 1 < end ? j + 1 : begin]));
            }
            farthest = fmax(farthest, nearest);
        }
        assert_true(farthest <= options->tolerance + 1e-9);
        made += !isGone;
    }
    assert_int_equal(made, simplified->loopCount);
}

static void CheckOrder(const pvtLoopSet* simplified)
{
    for (size_t l = 0; l < simplified->loopCount; ++l) {
        const pvtPoint2* loop = simplified->points + simplified->starts[l];
        const size_t count = simplified->starts[l + 1] - simplified->starts[l];
        const int32_t parent = simplified->parents[l];
        assert_true(count >= 3);
        assert_true(parent < 0 ? pvtGetLoopArea2(loop, count) > 0
                               : pvtGetLoopArea2(loop, count) < 0);
        if (parent >= 0) {
            assert_int_equal(simplified->parents[parent], -1);
            const pvtPoint2* outer = simplified->points + simplified->starts[parent];
            const size_t outerCount = simplified->starts[parent + 1] - simplified->starts[parent];
            // Midway along the hole's first edge, off the outer loop's points.
            assert_int_equal(GetWinding(outer, outerCount, 0.5 * (loop[0].x + loop[1].x) + 0.01,
                                        0.5 * (loop[0].y + loop[1].y) + 0.007),
                             1);
        }
    }
}

static int GetTotalWinding(const pvtLoopSet* set, double x, double y)
{
    int winding = 0;
    for (size_t l = 0; l < set->loopCount; ++l) {
        winding +=
            GetWinding(set->points + set->starts[l], set->starts[l + 1] - set->starts[l], x, y);
    }
    return winding;
}

typedef struct Simplified {
    pvtBitmap slice;
    pvtLoopSet contours, loops;
} Simplified;

static Simplified Simplify(pvtContext* context, pvtBitmap slice, const pvtSimplifyOptions* options)
{
    Simplified made = {.slice = slice};
    CHECK_OK(context, pvtTraceContours(context, &slice, options->cellsPerVoxel, &made.contours));
    CHECK_OK(context, pvtSimplifyContours(context, options, &made.contours, &made.loops));
    return made;
}

static void FreeSimplified(pvtContext* context, Simplified* made)
{
    pvtLoopSet_Free(context, &made->loops);
    pvtLoopSet_Free(context, &made->contours);
    pvtBitmap_Free(context, &made->slice);
}

static void loops_stay_apart_and_within_the_tolerance(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    size_t before = 0, after = 0;
    for (int seed = 0; seed < 24; ++seed) {
        pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
        options.tolerance = 0.5 + 0.5 * (seed % 5);
        Simplified made =
            Simplify(context, MakeBlobs(context, 60, 55, (uint64_t)seed, seed % 6), &options);
        CheckDistances(&options, &made.contours, &made.loops);
        CheckOrder(&made.loops);
        assert_true(HasNoCrossing(&made.loops));
        pvtRandom random = pvtMakeRandom((uint64_t)seed, 4);
        for (int i = 0; i < 500; ++i) {
            const int winding = GetTotalWinding(&made.loops, 256.0 * 60 * pvtRandom_Unit(&random),
                                                256.0 * 55 * pvtRandom_Unit(&random));
            assert_true(winding == 0 || winding == 1);
        }
        before += made.contours.pointCount;
        after += made.loops.pointCount;
        FreeSimplified(context, &made);
    }
    assert_true(2 * after < before);
    DestroyTestContext(context);
}

static void loops_stay_within_the_guard(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int seed = 0; seed < 12; ++seed) {
        pvtBitmap slice = MakeBlobs(context, 50, 50, (uint64_t)seed, 1 + seed % 5);
        pvtBitmap guard = MakeBlobs(context, 50, 50, (uint64_t)seed + 100, 1 + seed % 5);
        for (size_t i = 0; i < slice.wordsPerRow * 50; ++i) {
            guard.words[i] |= slice.words[i];
        }
        pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
        options.tolerance = 1.5;
        options.guard = &guard;
        Simplified made = Simplify(context, slice, &options);
        for (int i = 0; i < 9 * 50 * 50; ++i) {
            const int x = i / 9 % 50, y = i / 450;
            if (!pvtBitmap_Get(&guard, x, y)) {
                const double u = 256.0 * x + 1.3 + 126.1 * (i % 3);
                const double v = 256.0 * y + 1.7 + 125.7 * (i / 3 % 3);
                assert_int_equal(GetTotalWinding(&made.loops, u, v), 0);
            }
        }
        FreeSimplified(context, &made);
        pvtBitmap_Free(context, &guard);
    }
    DestroyTestContext(context);
}

static void distances_are_those_in_the_plane(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtPlane plane = {.axis = PVT_AXIS_Z, .slopeU = 1 << 20, .slopeV = -(1 << 19), .offset = 1};
    size_t flat = 0, steep = 0;
    for (int i = 0; i < 2; ++i) {
        pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
        options.plane = i == 0 ? NULL : &plane;
        Simplified made = Simplify(context, MakeShape(context, 120, IsDisc), &options);
        CheckDistances(&options, &made.contours, &made.loops);
        *(i == 0 ? &flat : &steep) = made.loops.pointCount;
        FreeSimplified(context, &made);
    }
    assert_true(steep > flat);
    DestroyTestContext(context);
}

static void a_turned_square_comes_down_to_its_corners(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    Simplified made = Simplify(context, MakeShape(context, 128, IsTurnedSquare), &options);
    assert_int_equal(made.loops.loopCount, 1);
    assert_in_range(made.loops.pointCount, 4, 8);
    const double whole = (double)pvtBitmap_Count(&made.slice);
    assert_true(fabs(GetSetArea(&made.loops) - whole) < 0.03 * whole);
    FreeSimplified(context, &made);
    DestroyTestContext(context);
}

static void thin_plates_stay_and_small_holes_go(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap slice = MakeShape(context, 40, IsEverywhere);
    pvtBitmap_Set(&slice, 11, 13, false); // a hole of one voxel
    for (int x = 0; x < 40; ++x) {
        pvtBitmap_Set(&slice, x, 36, false); // cuts off a plate three voxels thick
        pvtBitmap_Set(&slice, x, 38, false); // and one of one voxel
    }
    const pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    Simplified made = Simplify(context, slice, &options);
    assert_int_equal(made.contours.loopCount, 4);
    assert_int_equal(made.loops.loopCount, 3);
    FreeSimplified(context, &made);

    // Guarded, the hole stays, as a triangle around its cell at the least.
    slice = MakeShape(context, 40, IsEverywhere);
    pvtBitmap_Set(&slice, 11, 13, false);
    pvtBitmap guard = MakeShape(context, 40, IsEverywhere);
    pvtBitmap_Set(&guard, 11, 13, false);
    pvtSimplifyOptions guarded = options;
    guarded.guard = &guard;
    made = Simplify(context, slice, &guarded);
    assert_int_equal(made.loops.loopCount, 2);
    assert_int_equal(made.loops.parents[1], 0);
    FreeSimplified(context, &made);
    pvtBitmap_Free(context, &guard);
    DestroyTestContext(context);
}

// Two long walls one voxel apart, each with a step in it: chords across the gap would meet.
static bool IsGap(int x, int y, int size)
{
    const int bend = abs(2 * x - size) / 8;
    return y < bend || y > bend + 1;
}

static void chords_do_not_meet_across_a_gap(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    options.tolerance = 3.0;
    Simplified made = Simplify(context, MakeShape(context, 64, IsGap), &options);
    CheckOrder(&made.loops);
    assert_true(HasNoCrossing(&made.loops));
    FreeSimplified(context, &made);
    DestroyTestContext(context);
}

static void no_tolerance_changes_nothing_of_a_contour(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    options.tolerance = 0.0;
    Simplified made = Simplify(context, MakeBlobs(context, 50, 50, 8, 2), &options);
    assert_int_equal(made.loops.pointCount, made.contours.pointCount);
    assert_int_equal(made.loops.loopCount, made.contours.loopCount);
    assert_memory_equal(made.loops.points, made.contours.points,
                        made.loops.pointCount * sizeof(pvtPoint2));
    assert_memory_equal(made.loops.parents, made.contours.parents,
                        made.loops.loopCount * sizeof(int32_t));
    FreeSimplified(context, &made);
    DestroyTestContext(context);
}

static void points_along_a_line_go_without_tolerance(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtPoint2 points[] = {{0, 0}, {50, 0}, {100, 0}, {100, 100}, {60, 100}, {40, 100}, {0, 100}};
    size_t starts[] = {0, 7};
    int32_t parents[] = {-1};
    const pvtLoopSet set = {points, 7, starts, parents, 1};
    pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    options.tolerance = 0.0;
    pvtLoopSet simplified;
    CHECK_OK(context, pvtSimplifyContours(context, &options, &set, &simplified));
    assert_int_equal(simplified.pointCount, 4);
    pvtLoopSet_Free(context, &simplified);
    DestroyTestContext(context);
}

static void nasty_slices_are_simplified_in_time(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    ShapeFcn* const shapes[] = {IsCheckered, IsSieve, IsComb};
    const pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    const double start = GetCpuSeconds();
    for (int i = 0; i < 3; ++i) {
        Simplified made = Simplify(context, MakeShape(context, 256, shapes[i]), &options);
        FreeSimplified(context, &made);
    }
    assert_true(GetCpuSeconds() - start < 3.0);
    DestroyTestContext(context);
}

static void options_out_of_range_are_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap guard = MakeShape(context, 4, IsEverywhere);
    const pvtLoopSet none = {.starts = (size_t[1]){0}};
    pvtLoopSet simplified;
    pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    options.tolerance = -1.0;
    assert_int_equal(pvtSimplifyContours(context, &options, &none, &simplified),
                     PVT_INVALID_ARGUMENT);
    options = pvtDefaultSimplifyOptions();
    options.guard = &guard;
    options.cellsPerVoxel = 3;
    assert_int_equal(pvtSimplifyContours(context, &options, &none, &simplified),
                     PVT_INVALID_ARGUMENT);
    options.cellsPerVoxel = 1;
    CHECK_OK(context, pvtSimplifyContours(context, &options, &none, &simplified));
    assert_int_equal(simplified.loopCount, 0);
    pvtLoopSet_Free(context, &simplified);
    pvtBitmap_Free(context, &guard);
    DestroyTestContext(context);
}

static pvtStatus SimplifyAndFree(pvtContext* context, const void* input)
{
    const Simplified* made = input;
    pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    options.guard = &made->slice;
    pvtLoopSet loops;
    const pvtStatus status = pvtSimplifyContours(context, &options, &made->contours, &loops);
    pvtLoopSet_Free(context, &loops);
    return status;
}

static void a_failed_allocation_leaves_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtSimplifyOptions options = pvtDefaultSimplifyOptions();
    Simplified made = Simplify(context, MakeBlobs(context, 40, 40, 3, 2), &options);
    CheckEveryAllocation(SimplifyAndFree, &made);
    FreeSimplified(context, &made);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loops_stay_apart_and_within_the_tolerance),
        cmocka_unit_test(loops_stay_within_the_guard),
        cmocka_unit_test(distances_are_those_in_the_plane),
        cmocka_unit_test(a_turned_square_comes_down_to_its_corners),
        cmocka_unit_test(thin_plates_stay_and_small_holes_go),
        cmocka_unit_test(chords_do_not_meet_across_a_gap),
        cmocka_unit_test(no_tolerance_changes_nothing_of_a_contour),
        cmocka_unit_test(points_along_a_line_go_without_tolerance),
        cmocka_unit_test(nasty_slices_are_simplified_in_time),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(a_failed_allocation_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
