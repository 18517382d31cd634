// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"
#include "warnings.h"

#include <math.h>
#include <stdlib.h>

// A shell of about one and a half voxels around a ball, with round holes at both ends of z.
static void MakeShell(pvtContext* context, int radius, double hole, pvtBitGrid* surface)
{
    const int side = 2 * radius + 7;
    MakeEmptyGrid(context, side, side, side, surface);
    for (int i = 0; i < side * side * side; ++i) {
        const int v[3] = {i % side, i / side % side, i / (side * side)};
        const double x = v[0] - radius - 3;
        const double y = v[1] - radius - 3;
        const double z = v[2] - radius - 3;
        const bool isHole = x * x + y * y < 0.25 * hole * hole;
        if (fabs(sqrt(x * x + y * y + z * z) - radius) < 0.75 && !isHole) {
            SetVoxel(surface, v[0], v[1], v[2]);
        }
    }
}

static pvtRemedy FindRemedy(pvtContext* context, const pvtBitGrid* surface, pvtSolidOptions options)
{
    pvtSolid solid;
    CHECK_OK(context, pvtFillSolid(context, &options, surface, &solid));
    const pvtRemedy remedy = solid.remedy;
    pvtSolid_Free(context, &solid);
    return remedy;
}

static double GetFraction(pvtContext* context, const pvtBitGrid* surface, pvtSolidOptions options)
{
    pvtSolid solid;
    CHECK_OK(context, pvtFillSolid(context, &options, surface, &solid));
    const double fraction = solid.insideFraction;
    pvtSolid_Free(context, &solid);
    return fraction;
}

// A shell with a wide hole around one with a narrow hole: closing the narrow one fills little, and
// would only lead to the next warning.
static void one_remedy_fills_a_shell_within_a_shell(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtBitGrid surface, inner;
    MakeShell(context, 30, 11.0, &surface);
    MakeShell(context, 10, 3.0, &inner);
    const int side = 2 * 10 + 7;
    for (int i = 0; i < side * side * side; ++i) {
        const int v[3] = {i % side, i / side % side, i / (side * side)};
        if (pvtBitGrid_Get(&inner, v[0], v[1], v[2])) {
            SetVoxel(&surface, v[0] + 20, v[1] + 20, v[2] + 20);
        }
    }
    surface.frame.voxelSize = 1.0;
    pvtSolidOptions options = pvtDefaultSolidOptions();
    const pvtRemedy remedy = FindRemedy(context, &surface, options);
    assert_true(remedy.smallestHole >= 11.0);
    options.smallestHole = remedy.smallestHole;
    assert_true(GetFraction(context, &surface, options) > 0.3);
    const pvtRemedy next = FindRemedy(context, &surface, options);
    assert_false(next.smallestHole > 0.0 || next.ground || next.terrain);
    pvtBitGrid_Free(context, &inner);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

// At 20 voxels the search sees the grid itself, at 42 a coarser copy first.
static void the_size_told_for_a_shell_with_holes_fills_it(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    static const int radii[] = {20, 20, 20, 42};
    static const double holes[] = {3.0, 5.0, 7.0, 12.0};
    for (int i = 0; i < 4; ++i) {
        pvtBitGrid surface;
        MakeShell(context, radii[i], holes[i], &surface);
        surface.frame.voxelSize = 0.01;
        pvtSolidOptions options = pvtDefaultSolidOptions();
        assert_true(GetFraction(context, &surface, options) == 0.0);
        const pvtRemedy remedy = FindRemedy(context, &surface, options);
        assert_true(remedy.smallestHole >= 0.01 * holes[i]);
        assert_true(remedy.smallestHole <= 0.01 * (1.2 * holes[i] + 6.0));
        assert_false(remedy.ground || remedy.terrain);
        options.smallestHole = remedy.smallestHole;
        // The ball within the shell is more than 40 % of the bounds.
        assert_true(GetFraction(context, &surface, options) > 0.4);
        assert_true(FindRemedy(context, &surface, options).smallestHole == 0.0);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void a_closed_shell_needs_no_remedy(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid surface;
    MakeShell(context, 20, 0.0, &surface);
    const pvtRemedy remedy = FindRemedy(context, &surface, pvtDefaultSolidOptions());
    assert_true(remedy.smallestHole == 0.0 && !remedy.ground && !remedy.terrain);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

// Rods in all directions through a ball: little inside, and no room between them.
static void MakeTangle(pvtContext* context, int rods, uint64_t seed, pvtBitGrid* surface)
{
    enum { SIDE = 64 };
    pvtRandom random = pvtMakeRandom(seed, (uint64_t)rods);
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, surface);
    for (int i = 0; i < rods; ++i) {
        double from[3];
        double to[3];
        for (int axis = 0; axis < 3; ++axis) {
            from[axis] = 2.0 + (SIDE - 4) * pvtRandom_Unit(&random);
            to[axis] = 2.0 + (SIDE - 4) * pvtRandom_Unit(&random);
        }
        for (int step = 0; step <= 4 * SIDE; ++step) {
            const double t = step / (4.0 * SIDE);
            SetVoxel(surface, (int)(from[0] + t * (to[0] - from[0])),
                     (int)(from[1] + t * (to[1] - from[1])),
                     (int)(from[2] + t * (to[2] - from[2])));
        }
    }
}

static void a_tangle_of_rods_is_not_called_hollow(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    // These few lock some balls in between them, but none that is much wider.
    static const int rods[] = {20, 80, 160, 640};
    for (int i = 0; i < 4; ++i) {
        pvtBitGrid surface;
        MakeTangle(context, rods[i], (uint64_t)i + 1, &surface);
        const pvtRemedy remedy = FindRemedy(context, &surface, pvtDefaultSolidOptions());
        assert_true(remedy.smallestHole == 0.0 && !remedy.ground && !remedy.terrain);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

// Walls and a roof around 20 × 20 × 10 voxels that face away from `up`, a window of `hole` voxels.
static void MakeHall(pvtContext* context, pvtAxis up, int hole, pvtBitGrid* surface)
{
    MakeEmptyGrid(context, 28, 28, 28, surface);
    for (int i = 0; i < 28 * 28 * 28; ++i) {
        const int v[3] = {i % 28, i / 28 % 28, i / 784};
        const int height = v[up] - 3;
        const int a = v[(up + 1) % 3] - 3;
        const int b = v[(up + 2) % 3] - 3;
        const bool isWithin = a >= 0 && b >= 0 && a <= 21 && b <= 21 && height >= 0 && height <= 10;
        const bool isWall = a == 0 || b == 0 || a == 21 || b == 21;
        const bool isWindow = a == 0 && b >= 5 && b < 5 + hole && height >= 3 && height < 3 + hole;
        if (isWithin && (isWall || height == 10) && !isWindow) {
            SetVoxel(surface, v[0], v[1], v[2]);
        }
    }
}

// A trunk of 5 × 5 voxels inside, open below, under a crown of rods that makes the bounds large.
static void MakeTree(pvtContext* context, bool isOpen, pvtBitGrid* surface)
{
    enum { SIDE = 84, MIDDLE = 42, TOP = 40, HALF = 3 };
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, surface);
    for (int y = 2; y <= TOP; ++y) {
        for (int x = -HALF; x <= HALF; ++x) {
            for (int z = -HALF; z <= HALF; ++z) {
                const bool isWall = abs(x) == HALF || abs(z) == HALF || y == TOP;
                if (isWall || (y == 2 && !isOpen)) {
                    SetVoxel(surface, MIDDLE + x, y, MIDDLE + z);
                }
            }
        }
    }
    for (int i = 2; i < SIDE - 2; ++i) {
        SetVoxel(surface, i, TOP + 4, MIDDLE);
        SetVoxel(surface, MIDDLE, TOP + 8, i);
        SetVoxel(surface, MIDDLE, i / 2 + TOP, MIDDLE);
    }
    surface->frame.voxelSize = 0.1;
}

static void the_ground_is_told_for_a_trunk_that_is_open_below(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int isOpen = 0; isOpen < 2; ++isOpen) {
        pvtBitGrid surface;
        MakeTree(context, isOpen != 0, &surface);
        const pvtRemedy remedy = FindRemedy(context, &surface, pvtDefaultSolidOptions());
        assert_true(remedy.ground == (isOpen != 0));
        assert_true(remedy.smallestHole == 0.0 && !remedy.terrain);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void the_ground_is_told_for_a_hall_without_a_floor(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int up = 0; up < 3; ++up) {
        pvtSolidOptions options = pvtDefaultSolidOptions();
        options.up = (pvtAxis)up;
        pvtBitGrid surface;
        MakeHall(context, options.up, 0, &surface);
        pvtRemedy remedy = FindRemedy(context, &surface, options);
        assert_true(remedy.ground && remedy.smallestHole == 0.0 && !remedy.terrain);
        pvtBitGrid_Free(context, &surface);

        // With a window it takes both.
        MakeHall(context, options.up, 3, &surface);
        remedy = FindRemedy(context, &surface, options);
        assert_true(remedy.ground && remedy.smallestHole >= 3.0 && remedy.smallestHole <= 6.0);
        options.ground = true;
        assert_true(GetFraction(context, &surface, options) == 0.0);
        options.smallestHole = remedy.smallestHole;
        assert_true(GetFraction(context, &surface, options) > 0.6);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void terrain_is_told_for_a_height_field(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int up = 0; up < 3; ++up) {
        pvtSolidOptions options = pvtDefaultSolidOptions();
        options.up = (pvtAxis)up;
        pvtBitGrid surface;
        MakeEmptyGrid(context, 46, 46, 46, &surface);
        for (int i = 0; i < 40 * 40; ++i) {
            int v[3];
            v[(up + 1) % 3] = 3 + i % 40;
            v[(up + 2) % 3] = 3 + i / 40;
            v[up] = (int)(12.0 + 5.0 * sin(0.2 * (i % 40)) + 3.0 * cos(0.3 * (i / 40.0)));
            SetVoxel(&surface, v[0], v[1], v[2]);
        }
        const pvtRemedy remedy = FindRemedy(context, &surface, options);
        assert_true(remedy.terrain && !remedy.ground && remedy.smallestHole == 0.0);
        options.terrain = true;
        assert_true(GetFraction(context, &surface, options) > 0.2);
        assert_false(FindRemedy(context, &surface, options).terrain);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void a_hollow_solid_is_warned_about_with_the_size_that_helps(void** state)
{
    (void)state;
    Warnings warnings;
    pvtContext* context = CreateWarningContext(&warnings);
    pvtBitGrid surface;
    MakeShell(context, 20, 0.0, &surface);
    assert_true(GetFraction(context, &surface, pvtDefaultSolidOptions()) > 0.4);
    assert_string_equal(warnings.text, "");
    pvtBitGrid_Free(context, &surface);
    MakeShell(context, 20, 5.0, &surface);
    const pvtRemedy remedy = FindRemedy(context, &surface, pvtDefaultSolidOptions());
    char expected[64];
    (void)snprintf(expected, sizeof expected, "--smallest-hole %g ", remedy.smallestHole);
    assert_non_null(strstr(warnings.text, "hollow"));
    assert_non_null(strstr(warnings.text, expected));
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

static pvtStatus FillAndFree(pvtContext* context, const void* data)
{
    const pvtSolidOptions options = pvtDefaultSolidOptions();
    pvtSolid solid;
    const pvtStatus status = pvtFillSolid(context, &options, data, &solid);
    assert_true(status == PVT_OK || (solid.inside.words == NULL && solid.surface.words == NULL));
    pvtSolid_Free(context, &solid);
    return status;
}

static void the_search_survives_failing_allocations_and_cancelling(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid surface;
    MakeHall(context, PVT_AXIS_Y, 3, &surface);
    CheckEveryAllocation(FillAndFree, &surface);
    CheckEveryCancel(FillAndFree, &surface);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

// Looking for a remedy takes more memory than the solid does, and the solid is the promise.
static void the_memory_limit_leaves_the_remedy_out_before_it_fails(void** state)
{
    (void)state;
    int refused = 0;
    int without = 0;
    int with = 0;
    for (size_t limit = 24000; limit < 1500000; limit += limit / 8) {
        pvtContextDef def = pvtDefaultContextDef();
        def.memoryLimit = limit;
        def.threadCount = 1;
        pvtContext* context = NULL;
        assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
        pvtBitGrid surface;
        MakeShell(context, 20, 5.0, &surface);
        const pvtSolidOptions options = pvtDefaultSolidOptions();
        pvtSolid solid;
        const pvtStatus status = pvtFillSolid(context, &options, &surface, &solid);
        assert_true(status == PVT_OK || status == PVT_LIMIT);
        refused += status == PVT_LIMIT;
        without += status == PVT_OK && solid.remedy.smallestHole == 0.0;
        with += status == PVT_OK && solid.remedy.smallestHole > 0.0;
        pvtSolid_Free(context, &solid);
        pvtBitGrid_Free(context, &surface);
        DestroyTestContext(context);
    }
    assert_true(refused > 0 && without > 0 && with > 0);
}

// A tube with a slot along it, longer than the grids that are searched. To look whether the slot
// closed leaves more to do, balls of its width would meet the whole grid: by distances in memory 16
// times as large as the grid, and without that memory in an hour at 2,048 voxels.
static void a_fine_grid_is_not_grown_by_large_balls_for_a_remedy(void** state)
{
    (void)state;
    enum { LENGTH = 1160, SIDE = 160, WALL = 8, SLOT = 60 };
    pvtContext* context = CreateTestContext(2);
    pvtBitGrid surface;
    MakeEmptyGrid(context, LENGTH, SIDE, SIDE, &surface);
    for (int z = WALL; z < SIDE - WALL; ++z) {
        for (int y = WALL; y < SIDE - WALL; ++y) {
            const bool isSlot = z == WALL && 2 * abs(y - SIDE / 2) < SLOT;
            const bool isWall =
                z == WALL || z == SIDE - WALL - 1 || y == WALL || y == SIDE - WALL - 1;
            for (int x = WALL; x < LENGTH - WALL; ++x) {
                const bool isEnd = x == WALL || x == LENGTH - WALL - 1;
                if (isEnd || (isWall && !isSlot)) {
                    SetVoxel(&surface, x, y, z);
                }
            }
        }
    }
    const size_t bytes = pvtContext_GetHeldBytes(context);
    const pvtRemedy remedy = FindRemedy(context, &surface, pvtDefaultSolidOptions());
    assert_true(remedy.smallestHole >= SLOT && remedy.smallestHole <= SLOT + 24.0);
    assert_true(pvtContext_GetPeakBytes(context) < 8 * bytes);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_size_told_for_a_shell_with_holes_fills_it),
        cmocka_unit_test(one_remedy_fills_a_shell_within_a_shell),
        cmocka_unit_test(a_closed_shell_needs_no_remedy),
        cmocka_unit_test(a_tangle_of_rods_is_not_called_hollow),
        cmocka_unit_test(the_ground_is_told_for_a_trunk_that_is_open_below),
        cmocka_unit_test(the_ground_is_told_for_a_hall_without_a_floor),
        cmocka_unit_test(terrain_is_told_for_a_height_field),
        cmocka_unit_test(a_hollow_solid_is_warned_about_with_the_size_that_helps),
        cmocka_unit_test(the_memory_limit_leaves_the_remedy_out_before_it_fails),
        cmocka_unit_test(the_search_survives_failing_allocations_and_cancelling),
        cmocka_unit_test(a_fine_grid_is_not_grown_by_large_balls_for_a_remedy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
