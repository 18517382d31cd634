// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Voxels as bytes, for slow and plain versions of what the library does with bits.
typedef struct ByteGrid {
    int size[3];
    uint8_t* voxels;
} ByteGrid;

static ByteGrid MakeByteGrid(const int size[3])
{
    ByteGrid grid = {{size[0], size[1], size[2]}, NULL};
    grid.voxels = calloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2], 1);
    assert_non_null(grid.voxels);
    return grid;
}

static bool IsWithin(const ByteGrid* grid, const int v[3])
{
    return v[0] >= 0 && v[1] >= 0 && v[2] >= 0 && v[0] < grid->size[0] && v[1] < grid->size[1] &&
           v[2] < grid->size[2];
}

static uint8_t* At(const ByteGrid* grid, const int v[3])
{
    return &grid->voxels[((size_t)v[2] * (size_t)grid->size[1] + (size_t)v[1]) *
                             (size_t)grid->size[0] +
                         (size_t)v[0]];
}

static size_t CountBytes(const ByteGrid* grid)
{
    return (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
}

static void ToVoxel(const ByteGrid* grid, size_t index, int v[3])
{
    v[0] = (int)(index % (size_t)grid->size[0]);
    v[1] = (int)(index / (size_t)grid->size[0] % (size_t)grid->size[1]);
    v[2] = (int)(index / (size_t)grid->size[0] / (size_t)grid->size[1]);
}

// Repeats until nothing changes: border voxels and neighbours of reached ones, unless blocked.
static ByteGrid FloodSlowly(const ByteGrid* blocked)
{
    ByteGrid reached = MakeByteGrid(blocked->size);
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < CountBytes(blocked); ++i) {
            int v[3];
            ToVoxel(blocked, i, v);
            bool near = false;
            for (int side = 0; side < 6; ++side) {
                int n[3] = {v[0], v[1], v[2]};
                n[side / 2] += side % 2 == 0 ? -1 : 1;
                near = near || !IsWithin(blocked, n) || *At(&reached, n) != 0;
            }
            if (near && blocked->voxels[i] == 0 && reached.voxels[i] == 0) {
                reached.voxels[i] = 1;
                changed = true;
            }
        }
    }
    return reached;
}

static ByteGrid DilateSlowly(const ByteGrid* grid, double squaredRadius)
{
    ByteGrid dilated = MakeByteGrid(grid->size);
    for (size_t i = 0; i < CountBytes(grid); ++i) {
        const int reach = (int)sqrt(squaredRadius);
        const int side = 2 * reach + 1;
        for (int j = 0; j < side * side * side && grid->voxels[i] != 0; ++j) {
            const int d[3] = {j % side - reach, j / side % side - reach, j / side / side - reach};
            int v[3];
            ToVoxel(grid, i, v);
            for (int axis = 0; axis < 3; ++axis) {
                v[axis] += d[axis];
            }
            if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= squaredRadius && IsWithin(grid, v)) {
                *At(&dilated, v) = 1;
            }
        }
    }
    return dilated;
}

// Adds to `outside` all that is free beside it.
static void WalkSlowly(const ByteGrid* blocked, ByteGrid* outside)
{
    ByteGrid before = MakeByteGrid(outside->size);
    memcpy(before.voxels, outside->voxels, CountBytes(outside));
    for (size_t i = 0; i < CountBytes(outside); ++i) {
        int v[3];
        ToVoxel(outside, i, v);
        for (int side = 0; side < 6 && blocked->voxels[i] == 0; ++side) {
            int n[3] = {v[0], v[1], v[2]};
            n[side / 2] += side % 2 == 0 ? -1 : 1;
            if (IsWithin(outside, n) && *At(&before, n) != 0) {
                outside->voxels[i] = 1;
            }
        }
    }
    free(before.voxels);
}

static ByteGrid ToBytes(const pvtBitGrid* grid)
{
    ByteGrid bytes = MakeByteGrid(grid->frame.size);
    for (size_t i = 0; i < CountBytes(&bytes); ++i) {
        int v[3];
        ToVoxel(&bytes, i, v);
        bytes.voxels[i] = pvtBitGrid_Get(grid, v[0], v[1], v[2]);
    }
    return bytes;
}

static void CheckSame(const pvtBitGrid* grid, const ByteGrid* bytes)
{
    ByteGrid same = ToBytes(grid);
    assert_memory_equal(same.voxels, bytes->voxels, CountBytes(bytes));
    free(same.voxels);
}

static void MakeRandomSurface(pvtContext* context, pvtRandom* random, uint32_t percent,
                              const int size[3], pvtBitGrid* surface)
{
    MakeEmptyGrid(context, size[0], size[1], size[2], surface);
    FillRandomly(surface, random, percent);
}

static void the_plain_flood_reaches_what_a_slow_one_reaches(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(6, 0);
    const pvtSolidOptions options = pvtDefaultSolidOptions();
    static const int sizes[][3] = {{20, 11, 7}, {64, 6, 5}, {130, 4, 4}, {3, 40, 5}};
    for (int round = 0; round < 20; ++round) {
        pvtBitGrid surface;
        // Around two thirds free, paths through random voxels are long and winding.
        MakeRandomSurface(context, &random, 20 + 10 * (uint32_t)(round % 5), sizes[round % 4],
                          &surface);
        pvtSolid solid;
        CHECK_OK(context, pvtFillSolid(context, &options, &surface, &solid));
        ByteGrid blocked = ToBytes(&surface);
        ByteGrid reached = FloodSlowly(&blocked);
        uint64_t inside = 0;
        for (size_t i = 0; i < CountBytes(&reached); ++i) {
            reached.voxels[i] ^= 1;
            inside += reached.voxels[i];
        }
        CheckSame(&solid.inside, &reached);
        CheckSame(&solid.surface, &blocked);
        assert_int_equal(solid.insideCount, inside);
        assert_int_equal(solid.surfaceCount, pvtBitGrid_Count(&surface));
        assert_int_equal(solid.strictCount, solid.insideCount - solid.surfaceCount);
        free(blocked.voxels);
        free(reached.voxels);
        pvtSolid_Free(context, &solid);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static pvtSolid FillWith(pvtContext* context, const pvtBitGrid* surface, pvtSolidOptions options)
{
    pvtSolid solid;
    CHECK_OK(context, pvtFillSolid(context, &options, surface, &solid));
    return solid;
}

static uint64_t CountStrict(pvtContext* context, const pvtBitGrid* surface, pvtSolidOptions options)
{
    pvtSolid solid = FillWith(context, surface, options);
    const uint64_t count = solid.strictCount;
    pvtSolid_Free(context, &solid);
    return count;
}

// A tunnel of one voxel that winds through a block, layer by layer, into a chamber.
static void a_winding_tunnel_lets_the_flood_in(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid surface;
    MakeEmptyGrid(context, 41, 41, 9, &surface);
    for (int z = 0; z < 9; ++z) {
        for (int y = 0; y < 41; ++y) {
            for (int x = 0; x < 41; ++x) {
                const bool isAisle = y % 2 == 1 && x > 0 && x < 40;
                const bool isTurn = y % 2 == 0 && y > 0 && y < 40 && x == (y % 4 == 0 ? 1 : 39);
                const bool isStair = z % 2 == 0 && z > 0 && x == 1 && y == (z % 4 == 0 ? 1 : 39);
                const bool isFree = z % 2 == 1 ? isAisle || isTurn : isStair;
                if (!isFree || z == 8) {
                    SetVoxel(&surface, x, y, z);
                }
            }
        }
    }
    const pvtSolidOptions options = pvtDefaultSolidOptions();
    pvtSolid solid;
    CHECK_OK(context, pvtFillSolid(context, &options, &surface, &solid));
    assert_true(solid.strictCount > 2000);
    pvtSolid_Free(context, &solid);
    surface.words[0] &= ~UINT64_C(2); // opens the first aisle's floor at (1, 0, 0), not beyond
    CHECK_OK(context, pvtFillSolid(context, &options, &surface, &solid));
    assert_true(solid.strictCount > 2000);
    pvtSolid_Free(context, &solid);
    surface.words[surface.wordsPerRow] &= ~UINT64_C(2); // (1, 1, 0) leads up to the aisle
    CHECK_OK(context, pvtFillSolid(context, &options, &surface, &solid));
    assert_int_equal(solid.strictCount, 0);
    pvtSolid_Free(context, &solid);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

// Nothing but the carry from word to word leads through it.
static void a_straight_tunnel_of_several_words_is_flooded_from_either_end(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int end = 0; end < 2; ++end) {
        pvtBitGrid surface;
        MakeEmptyGrid(context, 300, 5, 5, &surface);
        for (int i = 0; i < 298 * 9; ++i) {
            const int v[3] = {1 + i % 298, 1 + i / 298 % 3, 1 + i / 894};
            const bool isOpen = end == 0 ? v[0] < 290 : v[0] > 10;
            if (!(isOpen && v[1] == 2 && v[2] == 2)) {
                SetVoxel(&surface, v[0], v[1], v[2]);
            }
        }
        assert_int_equal(CountStrict(context, &surface, pvtDefaultSolidOptions()), 0);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void a_ball_reaches_what_slow_dilation_and_flood_reach(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtRandom random = pvtMakeRandom(7, 0);
    static const double holes[] = {1.9, 2.0, 2.9, 3.0, 4.0, 5.5};
    for (int round = 0; round < 24; ++round) {
        pvtSolidOptions options = pvtDefaultSolidOptions();
        options.smallestHole = holes[round % 6];
        options.strict = round % 2 != round / 6 % 2;
        const double radius = 0.5 * (options.smallestHole + 0.5);
        const double squaredRadius = radius * radius;
        pvtBitGrid surface;
        MakeEmptyGrid(context, 18, 16, 15, &surface);
        for (int i = 0; i < 70; ++i) {
            SetVoxel(&surface, 5 + (int)pvtRandom_Below(&random, 8),
                     5 + (int)pvtRandom_Below(&random, 6), 5 + (int)pvtRandom_Below(&random, 5));
        }
        pvtSolid solid;
        CHECK_OK(context, pvtFillSolid(context, &options, &surface, &solid));
        ByteGrid bytes = ToBytes(&surface);
        ByteGrid closed = DilateSlowly(&bytes, squaredRadius);
        ByteGrid reached = FloodSlowly(&closed);
        ByteGrid outside = DilateSlowly(&reached, squaredRadius);
        for (int step = 0; step < 2 && options.strict; ++step) {
            WalkSlowly(&bytes, &outside);
        }
        for (size_t i = 0; i < CountBytes(&outside); ++i) {
            outside.voxels[i] ^= 1;
        }
        CheckSame(&solid.inside, &outside);
        free(bytes.voxels);
        free(closed.voxels);
        free(reached.voxels);
        free(outside.voxels);
        pvtSolid_Free(context, &solid);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

// A block with a wide groove along the top.
static void strict_leaves_nothing_in_shallow_creases(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtBitGrid surface;
    MakeEmptyGrid(context, 80, 80, 60, &surface);
    for (int y = 15; y < 65; ++y) {
        for (int x = 15; x < 65; ++x) {
            for (int z = 15; z < 30 + abs(x - 40); ++z) {
                SetVoxel(&surface, x, y, z);
            }
        }
    }
    pvtSolidOptions options = pvtDefaultSolidOptions();
    options.smallestHole = 12.0;
    assert_true(CountStrict(context, &surface, options) > 100);
    options.strict = true;
    assert_int_equal(CountStrict(context, &surface, options), 0);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

// The walls of a box from `lower` to `upper`, both included.
static void SetHollowBox(pvtBitGrid* grid, const int lower[3], const int upper[3])
{
    for (int z = lower[2]; z <= upper[2]; ++z) {
        for (int y = lower[1]; y <= upper[1]; ++y) {
            for (int x = lower[0]; x <= upper[0]; ++x) {
                if (x == lower[0] || y == lower[1] || z == lower[2] || x == upper[0] ||
                    y == upper[1] || z == upper[2]) {
                    SetVoxel(grid, x, y, z);
                }
            }
        }
    }
}

// A box of 12 × 12 × 12 free voxels with a square hole in its roof.
static void MakeOpenBox(pvtContext* context, int padding, int hole, pvtBitGrid* surface)
{
    const int side = 14 + 2 * padding;
    MakeEmptyGrid(context, side, side, side, surface);
    SetHollowBox(surface, (int[3]){padding, padding, padding},
                 (int[3]){padding + 13, padding + 13, padding + 13});
    for (int i = 0; i < hole * hole; ++i) {
        ClearVoxel(surface, padding + 3 + i % hole, padding + 13, padding + 3 + i / hole);
    }
}

static void holes_narrower_than_the_ball_close_and_wider_ones_do_not(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int hole = 1; hole <= 5; ++hole) {
        pvtBitGrid surface;
        MakeOpenBox(context, 8, hole, &surface);
        pvtSolidOptions options = pvtDefaultSolidOptions();
        assert_int_equal(CountStrict(context, &surface, options), 0);
        // The hole is at least as wide as its free voxels. A ball of a voxel more rests on it, and
        // only what dips in stays outside.
        options.smallestHole = hole + 0.5;
        assert_true(CountStrict(context, &surface, options) > 12 * 12 * 11);
        options.smallestHole = fmax(0.0, hole - 0.6);
        assert_true(CountStrict(context, &surface, options) < 12 * 12 * 6);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void the_result_does_not_depend_on_the_padding(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtSolidOptions options = pvtDefaultSolidOptions();
    options.ground = true;
    for (int round = 0; round < 6; ++round) {
        options.smallestHole = 0.9 * round;
        options.up = (pvtAxis)(round % 3);
        pvtBitGrid tight;
        pvtBitGrid wide;
        MakeOpenBox(context, 0, 3, &tight);
        MakeOpenBox(context, 11, 3, &wide);
        pvtSolid a = FillWith(context, &tight, options);
        pvtSolid b = FillWith(context, &wide, options);
        assert_int_equal(a.insideCount, b.insideCount);
        for (int i = 0; i < 14 * 14 * 14; ++i) {
            const int v[3] = {i % 14, i / 14 % 14, i / 196};
            assert_int_equal(pvtBitGrid_Get(&a.inside, v[0], v[1], v[2]),
                             pvtBitGrid_Get(&b.inside, v[0] + 11, v[1] + 11, v[2] + 11));
        }
        assert_true(a.insideFraction == b.insideFraction);
        pvtSolid_Free(context, &a);
        pvtSolid_Free(context, &b);
        pvtBitGrid_Free(context, &tight);
        pvtBitGrid_Free(context, &wide);
    }
    DestroyTestContext(context);
}

// A box without its lowest wall along `up`, three voxels above the grid's lower border.
static void MakeOpenBelow(pvtContext* context, pvtAxis up, pvtBitGrid* surface)
{
    MakeEmptyGrid(context, 16, 16, 16, surface);
    SetHollowBox(surface, (int[3]){3, 3, 3}, (int[3]){12, 12, 12});
    for (int i = 0; i < 64; ++i) {
        int v[3] = {3, 3, 3};
        v[(up + 1) % 3] = 4 + i % 8;
        v[(up + 2) % 3] = 4 + i / 8;
        ClearVoxel(surface, v[0], v[1], v[2]);
    }
}

static void the_ground_closes_a_box_without_a_floor(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int up = 0; up < 3; ++up) {
        pvtBitGrid surface;
        MakeOpenBelow(context, (pvtAxis)up, &surface);
        pvtSolidOptions options = pvtDefaultSolidOptions();
        options.up = (pvtAxis)up;
        assert_int_equal(CountStrict(context, &surface, options), 0);
        options.ground = true;
        // Eight by eight by nine free voxels: the open layer of the walls belongs to them. With a
        // ball, no fillet forms where the walls stand on the ground.
        for (double hole = 0.0; hole < 8.0; hole += 2.0) {
            options.smallestHole = hole;
            pvtSolid solid = FillWith(context, &surface, options);
            assert_int_equal(solid.strictCount, 8 * 8 * 9);
            for (int i = 0; i < 256; ++i) {
                int v[3] = {2, 2, 2};
                v[(up + 1) % 3] = i % 16;
                v[(up + 2) % 3] = i / 16;
                assert_false(pvtBitGrid_Get(&solid.inside, v[0], v[1], v[2]));
            }
            pvtSolid_Free(context, &solid);
        }
        // The ground below another side closes nothing.
        options.up = (pvtAxis)((up + 1) % 3);
        options.smallestHole = 0.0;
        assert_int_equal(CountStrict(context, &surface, options), 0);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void terrain_fills_below_the_lowest_surface_of_each_column(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(8, 0);
    for (int trial = 0; trial < 6; ++trial) {
        const int up = trial % 3;
        pvtBitGrid surface;
        MakeEmptyGrid(context, 70, 71, 72, &surface);
        int lowest[10][10];
        int bottom = 72;
        for (int i = 0; i < 100; ++i) {
            int* height = &lowest[i % 10][i / 10];
            *height = i % 7 == 0 ? -1 : 20 + (int)pvtRandom_Below(&random, 44);
            for (int above = 0; above < 2 && *height >= 0; ++above) {
                int v[3] = {0, 0, 0};
                v[up] = *height + 5 * above;
                v[(up + 1) % 3] = 10 + i % 10;
                v[(up + 2) % 3] = 10 + i / 10;
                SetVoxel(&surface, v[0], v[1], v[2]);
            }
            bottom = *height >= 0 && *height < bottom ? *height : bottom;
        }
        pvtSolidOptions options = pvtDefaultSolidOptions();
        options.terrain = true;
        options.below = trial < 3 ? 0 : 3;
        options.up = (pvtAxis)up;
        pvtSolid solid = FillWith(context, &surface, options);
        uint64_t expected = 0;
        bottom -= options.below;
        for (int i = 0; i < 100; ++i) {
            const int height = lowest[i % 10][i / 10];
            expected += height > bottom ? (uint64_t)(height - bottom) : 0;
            for (int at = bottom; at < height; ++at) {
                int v[3] = {0, 0, 0};
                v[up] = at;
                v[(up + 1) % 3] = 10 + i % 10;
                v[(up + 2) % 3] = 10 + i / 10;
                assert_true(pvtBitGrid_Get(&solid.inside, v[0], v[1], v[2]));
            }
        }
        assert_int_equal(solid.strictCount, expected);
        pvtSolid_Free(context, &solid);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

// Walks from a voxel along one of the 26 directions.
static bool Escapes(const ByteGrid* inside, const int from[3], int direction)
{
    const int d[3] = {direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1};
    int v[3] = {from[0] + d[0], from[1] + d[1], from[2] + d[2]};
    while (IsWithin(inside, v)) {
        if (*At(inside, v) != 0) {
            return false;
        }
        for (int axis = 0; axis < 3; ++axis) {
            v[axis] += d[axis];
        }
    }
    return true;
}

static void enclosed_voxels_are_those_that_few_walks_escape_from(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(9, 0);
    static const int sizes[][3] = {{20, 9, 8}, {64, 5, 7}, {129, 4, 5}, {66, 1, 6}, {2, 9, 1}};
    for (int round = 0; round < 20; ++round) {
        pvtBitGrid surface;
        MakeRandomSurface(context, &random, 3 + 4 * (uint32_t)(round % 7), sizes[round % 5],
                          &surface);
        pvtSolidOptions options = pvtDefaultSolidOptions();
        pvtSolid plain = FillWith(context, &surface, options);
        options.enclosed = (round * 11) % 26;
        pvtSolid solid = FillWith(context, &surface, options);
        ByteGrid inside = ToBytes(&plain.inside);
        ByteGrid expected = ToBytes(&plain.inside);
        for (size_t i = 0; i < CountBytes(&inside); ++i) {
            int v[3];
            ToVoxel(&inside, i, v);
            int count = 0;
            for (int direction = 0; direction < 27; ++direction) {
                count += direction != 13 && Escapes(&inside, v, direction);
            }
            expected.voxels[i] = inside.voxels[i] != 0 || count <= options.enclosed;
        }
        CheckSame(&solid.inside, &expected);
        free(inside.voxels);
        free(expected.voxels);
        pvtSolid_Free(context, &plain);
        pvtSolid_Free(context, &solid);
        pvtBitGrid_Free(context, &surface);
    }
    DestroyTestContext(context);
}

static void allowed_is_the_strict_interior_or_the_grown_solid(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid surface;
    MakeOpenBox(context, 8, 0, &surface);
    surface.frame.voxelSize = 0.25;
    pvtSolid solid = FillWith(context, &surface, pvtDefaultSolidOptions());
    pvtBitGrid allowed;
    CHECK_OK(context, pvtMakeAllowedGrid(context, &solid, 0.0, &allowed));
    assert_int_equal(pvtBitGrid_Count(&allowed), 12 * 12 * 12);
    assert_true(pvtBitGrid_Get(&allowed, 9, 9, 9) && !pvtBitGrid_Get(&allowed, 8, 9, 9));
    pvtBitGrid_Free(context, &allowed);
    // Below a voxel no ring is added, at one voxel each face grows by one.
    CHECK_OK(context, pvtMakeAllowedGrid(context, &solid, 0.2, &allowed));
    assert_int_equal(pvtBitGrid_Count(&allowed), 14 * 14 * 14);
    pvtBitGrid_Free(context, &allowed);
    CHECK_OK(context, pvtMakeAllowedGrid(context, &solid, 0.25, &allowed));
    assert_int_equal(pvtBitGrid_Count(&allowed), 14 * 14 * 14 + 6 * 14 * 14);
    pvtBitGrid_Free(context, &allowed);
    assert_int_equal(pvtMakeAllowedGrid(context, &solid, -1.0, &allowed), PVT_INVALID_ARGUMENT);
    assert_null(allowed.words);
    pvtSolid_Free(context, &solid);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

static void options_out_of_range_are_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid surface;
    MakeOpenBox(context, 2, 0, &surface);
    const pvtSolidOptions good = pvtDefaultSolidOptions();
    pvtSolidOptions bad[6] = {good, good, good, good, good, good};
    bad[0].smallestHole = -0.1;
    bad[1].smallestHole = NAN;
    bad[2].enclosed = 26;
    bad[3].enclosed = -2;
    bad[4].up = (pvtAxis)3;
    bad[5].below = -1;
    for (int i = 0; i < 6; ++i) {
        pvtSolid solid;
        assert_int_equal(pvtFillSolid(context, &bad[i], &surface, &solid), PVT_INVALID_ARGUMENT);
        assert_null(solid.inside.words);
    }
    pvtSolidOptions huge = good;
    huge.smallestHole = 1e30;
    pvtSolid solid;
    assert_int_equal(pvtFillSolid(context, &huge, &surface, &solid), PVT_LIMIT);
    pvtBitGrid_Free(context, &surface);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_plain_flood_reaches_what_a_slow_one_reaches),
        cmocka_unit_test(a_winding_tunnel_lets_the_flood_in),
        cmocka_unit_test(a_straight_tunnel_of_several_words_is_flooded_from_either_end),
        cmocka_unit_test(a_ball_reaches_what_slow_dilation_and_flood_reach),
        cmocka_unit_test(strict_leaves_nothing_in_shallow_creases),
        cmocka_unit_test(holes_narrower_than_the_ball_close_and_wider_ones_do_not),
        cmocka_unit_test(the_result_does_not_depend_on_the_padding),
        cmocka_unit_test(the_ground_closes_a_box_without_a_floor),
        cmocka_unit_test(terrain_fills_below_the_lowest_surface_of_each_column),
        cmocka_unit_test(enclosed_voxels_are_those_that_few_walks_escape_from),
        cmocka_unit_test(allowed_is_the_strict_interior_or_the_grown_solid),
        cmocka_unit_test(options_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
