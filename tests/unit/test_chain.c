// SPDX-License-Identifier: MIT
#include "shapes.h"

#include "base/context.h"
#include "section/cover.h"

#include <math.h>
#include <string.h>

enum { LONGEST = 66 };

// One link of a chain.
typedef struct Link {
    pvtPoint2 points[LONGEST];
    size_t count;
    double area; // [vx²]
} Link;

typedef struct Slice {
    pvtBitmap bitmap;
    pvtLoopSet polygons;
} Slice;

static Slice MakeSlice(pvtContext* context, pvtBitmap bitmap, int cellsPerVoxel)
{
    Slice slice = {.bitmap = bitmap};
    pvtLoopSet contours;
    CHECK_OK(context, pvtTraceContours(context, &bitmap, cellsPerVoxel, &contours));
    CHECK_OK(context, pvtBridgeHoles(context, &contours, &slice.polygons));
    pvtLoopSet_Free(context, &contours);
    return slice;
}

static void FreeSlice(pvtContext* context, Slice* slice)
{
    pvtLoopSet_Free(context, &slice->polygons);
    pvtBitmap_Free(context, &slice->bitmap);
}

static pvtChainSet Build(pvtContext* context, const pvtLoopSet* polygons, const pvtBitmap* allowed,
                         int cellsPerVoxel)
{
    pvtChainOptions options = pvtDefaultChainOptions();
    options.allowed = allowed;
    options.cellsPerVoxel = cellsPerVoxel;
    pvtChainSet chains;
    CHECK_OK(context, pvtBuildChains(context, &options, polygons, &chains));
    return chains;
}

static Link GetLink(const pvtChainSet* chains, size_t chain, int triangles)
{
    Link link;
    link.count = pvtChainSet_GetLink(chains, chain, triangles, link.points);
    link.area = (double)pvtGetLoopArea2(link.points, link.count) / 131072.0;
    return link;
}

static int GetMostTriangles(const pvtChainSet* chains, size_t chain)
{
    uint32_t most = 3;
    for (size_t i = chains->starts[chain]; i < chains->starts[chain + 1]; ++i) {
        most = chains->ranks[i] > most ? chains->ranks[i] : most;
    }
    int count = 0;
    for (size_t i = chains->starts[chain]; i < chains->starts[chain + 1]; ++i) {
        count += chains->limits[i] == UINT32_MAX;
    }
    assert_true((int)most <= count);
    return count - 2;
}

static bool IsWeaklySimple(const Link* link, double extent)
{
    size_t starts[2] = {0, link->count};
    pvtPoint2 points[LONGEST];
    memcpy(points, link->points, sizeof points);
    const pvtLoopSet set = {.points = points, .starts = starts, .loopCount = 1};
    bool isSimple = HasNoCrossing(&set);
    pvtRandom random = pvtMakeRandom(3, 3);
    for (int i = 0; i < 200 && isSimple; ++i) {
        const double x = extent * pvtRandom_Unit(&random), y = extent * pvtRandom_Unit(&random);
        const int winding = GetWinding(points, link->count, x, y);
        isSimple = winding == 0 || winding == 1;
    }
    return isSimple;
}

// Every triangle of the link lies in set cells.
static bool IsCovered(pvtContext* context, const Link* link, const pvtBitmap* allowed, int unit)
{
    uint32_t indices[3 * LONGEST];
    CHECK_OK(context, pvtTriangulatePolygon(context, link->points, link->count, indices));
    for (size_t t = 0; t < link->count - 2; ++t) {
        const pvtPoint2 corners[3] = {link->points[indices[3 * t]],
                                      link->points[indices[3 * t + 1]],
                                      link->points[indices[3 * t + 2]]};
        if (!pvtIsTriangleCovered(allowed, unit, corners)) {
            return false;
        }
    }
    return true;
}

// Samples four by four places of each cell, by nothing that the library uses.
static void CheckSamplesAreCovered(const Link* link, const pvtBitmap* allowed, int unit)
{
    for (int y = 0; y < 4 * allowed->height; ++y) {
        for (int x = 0; x < 4 * allowed->width; ++x) {
            if (!pvtBitmap_Get(allowed, x / 4, y / 4)) {
                const double u = (0.26 + 0.249 * (x % 4 - 1) + x / 4) * unit;
                const double v = (0.27 + 0.248 * (y % 4 - 1) + y / 4) * unit;
                assert_int_equal(GetWinding(link->points, link->count, u, v), 0);
            }
        }
    }
}

static void every_link_is_weakly_simple_and_covered(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    int links = 0;
    for (int seed = 0; seed < 9; ++seed) {
        const int cellsPerVoxel = 1 << seed % 3, unit = 256 / cellsPerVoxel;
        Slice slice = MakeSlice(context, MakeBlobs(context, 60, 60, (uint64_t)seed, 2 + seed % 4),
                                cellsPerVoxel);
        pvtChainSet chains = Build(context, &slice.polygons, &slice.bitmap, cellsPerVoxel);
        for (size_t c = 0; c < chains.count; ++c) {
            for (int t = GetMostTriangles(&chains, c); t >= 1; t = t > 8 ? t * 3 / 4 : t - 1) {
                const Link link = GetLink(&chains, c, t);
                assert_int_equal(link.count, t + 2);
                assert_true(link.area > 0.0);
                assert_true(IsWeaklySimple(&link, 60.0 * unit));
                assert_true(IsCovered(context, &link, &slice.bitmap, unit));
                ++links;
            }
        }
        pvtChainSet_Free(context, &chains);
        FreeSlice(context, &slice);
    }
    assert_true(links > 300);
    DestroyTestContext(context);
}

static bool IsBean(int x, int y, int size)
{
    const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size / 8;
    return IsDisc(x, y, size) && dx * dx + dy * dy > size * size / 5;
}

static void links_stay_within_the_cells(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    ShapeFcn* const shapes[] = {IsDisc, IsBean, IsTurnedSquare, IsL, IsComb, IsRing, IsSieve};
    for (int i = 0; i < 7; ++i) {
        Slice slice = MakeSlice(context, MakeShape(context, 50, shapes[i]), 2);
        pvtChainSet chains = Build(context, &slice.polygons, &slice.bitmap, 2);
        assert_int_equal(chains.count, 1);
        for (int t = GetMostTriangles(&chains, 0); t >= 1; --t) {
            const Link link = GetLink(&chains, 0, t);
            assert_true(IsCovered(context, &link, &slice.bitmap, 128));
            if (t % 7 == 1) {
                CheckSamplesAreCovered(&link, &slice.bitmap, 128);
            }
        }
        pvtChainSet_Free(context, &chains);
        FreeSlice(context, &slice);
    }
    DestroyTestContext(context);
}

// A bitmap with every cell set that is set in `slice` or beside such a cell.
static pvtBitmap Widen(pvtContext* context, const pvtBitmap* slice)
{
    pvtBitmap wide;
    CHECK_OK(context, pvtCreateBitmap(context, slice->width, slice->height, &wide));
    for (int y = 0; y < slice->height; ++y) {
        for (int x = 0; x < slice->width; ++x) {
            bool isSet = false;
            for (int i = 0; i < 9; ++i) {
                isSet = isSet || pvtBitmap_Get(slice, x + i % 3 - 1, y + i / 3 - 1);
            }
            pvtBitmap_Set(&wide, x, y, isSet);
        }
    }
    return wide;
}

static void links_use_the_room_of_wider_cells_and_no_more(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int seed = 0; seed < 4; ++seed) {
        Slice slice = MakeSlice(context, MakeBlobs(context, 48, 48, (uint64_t)seed, 5), 1);
        pvtBitmap wide = Widen(context, &slice.bitmap);
        pvtChainSet narrow = Build(context, &slice.polygons, &slice.bitmap, 1);
        pvtChainSet chains = Build(context, &slice.polygons, &wide, 1);
        assert_int_equal(narrow.count, chains.count);
        double gained = 0.0;
        for (size_t c = 0; c < chains.count; ++c) {
            const Link within = GetLink(&narrow, c, GetMostTriangles(&narrow, c));
            const Link most = GetLink(&chains, c, GetMostTriangles(&chains, c));
            gained += most.area - within.area;
            for (int t = GetMostTriangles(&chains, c); t >= 1; t -= 3) {
                const Link link = GetLink(&chains, c, t);
                assert_true(IsWeaklySimple(&link, 48.0 * 256.0));
                assert_true(IsCovered(context, &link, &wide, 256));
            }
        }
        assert_true(gained > 0.0);
        pvtChainSet_Free(context, &narrow);
        pvtChainSet_Free(context, &chains);
        pvtBitmap_Free(context, &wide);
        FreeSlice(context, &slice);
    }
    DestroyTestContext(context);
}

static void without_allowed_cells_each_link_lies_in_the_one_before(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeBlobs(context, 64, 64, 11, 4), 1);
    pvtChainSet chains = Build(context, &slice.polygons, NULL, 1);
    pvtRandom random = pvtMakeRandom(5, 5);
    for (size_t c = 0; c < chains.count; ++c) {
        for (int t = GetMostTriangles(&chains, c); t > 1; --t) {
            const Link larger = GetLink(&chains, c, t), smaller = GetLink(&chains, c, t - 1);
            assert_true(smaller.area <= larger.area);
            assert_true(smaller.area > 0.0);
            for (int i = 0; i < 100; ++i) {
                const double x = 16384.0 * pvtRandom_Unit(&random);
                const double y = 16384.0 * pvtRandom_Unit(&random);
                assert_true(GetWinding(smaller.points, smaller.count, x, y) <=
                            GetWinding(larger.points, larger.count, x, y));
            }
        }
    }
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static void links_of_a_disc_come_near_the_best_polygons(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeShape(context, 256, IsDisc), 1);
    pvtChainSet chains = Build(context, &slice.polygons, &slice.bitmap, 1);
    for (int points = 3; points <= 62; ++points) {
        const Link link = GetLink(&chains, 0, points - 2);
        const double best = points / 2.0 * sin(2.0 * 3.14159265358979 / points) * 127.0 * 127.0;
        assert_true(link.area > 0.97 * best);
    }
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static void a_bay_is_followed_with_few_points(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeShape(context, 256, IsBean), 1);
    pvtChainSet chains = Build(context, &slice.polygons, &slice.bitmap, 1);
    const double whole = (double)pvtBitmap_Count(&slice.bitmap);
    assert_true(GetLink(&chains, 0, 14).area > 0.93 * whole);
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static void what_is_a_polygon_already_is_its_own_longest_link(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeShape(context, 100, IsL), 4);
    pvtChainSet chains = Build(context, &slice.polygons, &slice.bitmap, 4);
    assert_int_equal(chains.count, 1);
    const Link link = GetLink(&chains, 0, 4);
    assert_int_equal(link.count, 6);
    assert_memory_equal(link.points, slice.polygons.points, 6 * sizeof(pvtPoint2));
    assert_int_equal(GetLink(&chains, 0, 64).count, 6);
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static void polygons_below_the_least_area_are_skipped(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitmap bitmap;
    CHECK_OK(context, pvtCreateBitmap(context, 12, 3, &bitmap));
    pvtBitmap_Set(&bitmap, 0, 0, true);
    for (int x = 2; x < 6; ++x) {
        pvtBitmap_Set(&bitmap, x, 0, true);
    }
    Slice slice = MakeSlice(context, bitmap, 2);
    pvtChainSet chains = Build(context, &slice.polygons, NULL, 2);
    assert_int_equal(chains.count, 1);
    assert_true(GetLink(&chains, 0, 9).area == 1.0);
    assert_true(GetLink(&chains, 0, 1).area == 0.5);
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static void points_off_the_lattice_are_taken_as_they_are(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    enum { COUNT = 400 };
    pvtPoint2 points[COUNT];
    for (int i = 0; i < COUNT; ++i) {
        const double angle = 6.283185307179586 * i / COUNT, radius = 3000.0 + 900.0 * (i % 2);
        points[i] = (pvtPoint2){(int32_t)(5000.0 + radius * cos(angle)),
                                (int32_t)(5000.0 + radius * sin(angle))};
    }
    size_t starts[2] = {0, COUNT};
    int32_t parents[1] = {-1};
    const pvtLoopSet star = {points, COUNT, starts, parents, 1};
    pvtChainSet chains = Build(context, &star, NULL, 1);
    assert_int_equal(chains.count, 1);
    assert_int_equal(GetMostTriangles(&chains, 0), 64);
    for (int t = 64; t >= 1; --t) {
        const Link link = GetLink(&chains, 0, t);
        assert_int_equal(link.count, t + 2);
        assert_true(IsWeaklySimple(&link, 10000.0));
    }
    pvtChainSet_Free(context, &chains);
    DestroyTestContext(context);
}

static void loops_that_touch_themselves_have_chains(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeShape(context, 5, IsPinchedRing), 1);
    pvtChainSet chains = Build(context, &slice.polygons, &slice.bitmap, 1);
    assert_int_equal(chains.count, 1);
    assert_true(GetLink(&chains, 0, 8).area == 7.0);
    for (int t = 8; t >= 1; --t) {
        const Link link = GetLink(&chains, 0, t);
        assert_int_equal(link.count, t + 2);
        assert_true(IsWeaklySimple(&link, 5 * 256.0));
        CheckSamplesAreCovered(&link, &slice.bitmap, 256);
    }
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static void nasty_polygons_are_done_in_time(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const double start = GetCpuSeconds();
    Slice comb = MakeSlice(context, MakeShape(context, 448, IsComb), 1);
    pvtChainSet chains = Build(context, &comb.polygons, &comb.bitmap, 1);
    assert_int_equal(chains.count, 1);
    const Link link = GetLink(&chains, 0, 64);
    assert_true(IsCovered(context, &link, &comb.bitmap, 256));
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &comb);
    Slice checkers = MakeSlice(context, MakeShape(context, 256, IsCheckered), 1);
    chains = Build(context, &checkers.polygons, &checkers.bitmap, 1);
    assert_int_equal(chains.count, 256 * 128);
    pvtChainSet_Free(context, &chains);
    FreeSlice(context, &checkers);
    assert_true(GetCpuSeconds() - start < 2.0);
    DestroyTestContext(context);
}

// True when the open cell and the open triangle share a point: no line along a side of either
// separates them.
static bool Overlap(const pvtPoint2 corners[3], pvtPoint2 cell, int unit)
{
    const pvtPoint2 square[4] = {
        cell, {cell.x + unit, cell.y}, {cell.x + unit, cell.y + unit}, {cell.x, cell.y + unit}};
    for (int i = 0; i < 7; ++i) {
        const pvtPoint2 p = i < 3 ? corners[i] : square[i - 3];
        const pvtPoint2 q = i < 3 ? corners[(i + 1) % 3] : square[(i - 2) % 4];
        bool isSeparated = true;
        for (int j = 0; j < (i < 3 ? 4 : 3); ++j) {
            isSeparated = isSeparated && pvtOrient(p, q, i < 3 ? square[j] : corners[j]) <= 0;
        }
        if (isSeparated) {
            return false;
        }
    }
    return true;
}

static void the_cells_of_a_triangle_are_those_it_overlaps(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(9, 2);
    pvtBitmap cells = MakeShape(context, 12, IsEverywhere);
    for (int round = 0; round < 400; ++round) {
        const int grain = 1 << pvtRandom_Below(&random, 7);
        pvtPoint2 corners[3];
        for (int i = 0; i < 3; ++i) {
            const uint32_t most = (uint32_t)(12 * 64 / grain + 1);
            corners[i] = (pvtPoint2){(int32_t)pvtRandom_Below(&random, most) * grain,
                                     (int32_t)pvtRandom_Below(&random, most) * grain};
        }
        if (pvtOrient(corners[0], corners[1], corners[2]) <= 0) {
            continue;
        }
        assert_true(pvtIsTriangleCovered(&cells, 64, corners));
        for (int i = 0; i < 144; ++i) {
            const pvtPoint2 cell = {i % 12 * 64, i / 12 * 64};
            pvtBitmap_Set(&cells, i % 12, i / 12, false);
            assert_int_equal(pvtIsTriangleCovered(&cells, 64, corners),
                             !Overlap(corners, cell, 64));
            pvtBitmap_Set(&cells, i % 12, i / 12, true);
        }
    }
    const pvtPoint2 outside[3] = {{-1, 5}, {90, 10}, {20, 80}};
    assert_false(pvtIsTriangleCovered(&cells, 64, outside));
    pvtBitmap_Free(context, &cells);
    DestroyTestContext(context);
}

static void options_out_of_range_are_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeShape(context, 5, IsEverywhere), 1);
    pvtChainSet chains;
    pvtChainOptions options = pvtDefaultChainOptions();
    options.maxTriangles = 0;
    assert_int_equal(pvtBuildChains(context, &options, &slice.polygons, &chains),
                     PVT_INVALID_ARGUMENT);
    options = pvtDefaultChainOptions();
    options.allowed = &slice.bitmap;
    options.cellsPerVoxel = 3;
    assert_int_equal(pvtBuildChains(context, &options, &slice.polygons, &chains),
                     PVT_INVALID_ARGUMENT);
    assert_null(chains.points);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static pvtStatus BuildAndFree(pvtContext* context, const void* input)
{
    const Slice* slice = input;
    pvtChainOptions options = pvtDefaultChainOptions();
    options.allowed = &slice->bitmap;
    pvtChainSet chains;
    const pvtStatus status = pvtBuildChains(context, &options, &slice->polygons, &chains);
    assert_true((status == PVT_OK) == (chains.points != NULL));
    pvtChainSet_Free(context, &chains);
    return status;
}

static void a_failed_allocation_leaves_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeShape(context, 120, IsDisc), 1);
    CheckEveryAllocation(BuildAndFree, &slice);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

static void a_cancelled_build_leaves_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Slice slice = MakeSlice(context, MakeShape(context, 64, IsRing), 1);
    CheckEveryCancel(BuildAndFree, &slice);
    FreeSlice(context, &slice);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_link_is_weakly_simple_and_covered),
        cmocka_unit_test(links_stay_within_the_cells),
        cmocka_unit_test(links_use_the_room_of_wider_cells_and_no_more),
        cmocka_unit_test(without_allowed_cells_each_link_lies_in_the_one_before),
        cmocka_unit_test(links_of_a_disc_come_near_the_best_polygons),
        cmocka_unit_test(a_bay_is_followed_with_few_points),
        cmocka_unit_test(what_is_a_polygon_already_is_its_own_longest_link),
        cmocka_unit_test(polygons_below_the_least_area_are_skipped),
        cmocka_unit_test(points_off_the_lattice_are_taken_as_they_are),
        cmocka_unit_test(loops_that_touch_themselves_have_chains),
        cmocka_unit_test(nasty_polygons_are_done_in_time),
        cmocka_unit_test(the_cells_of_a_triangle_are_those_it_overlaps),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(a_failed_allocation_leaves_nothing),
        cmocka_unit_test(a_cancelled_build_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
