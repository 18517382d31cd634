// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include "voxel/dilate.h"

#include "failures.h"

#include <stdlib.h>

enum { MOST_MARKS = 64 };

// The set voxels of a grid that holds few.
typedef struct Marks {
    int voxels[MOST_MARKS][3];
    int count;
} Marks;

static Marks FindMarks(const pvtBitGrid* grid)
{
    Marks marks = {.count = 0};
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (int x = 0; x < grid->frame.size[0]; ++x) {
                if (pvtBitGrid_Get(grid, x, y, z)) {
                    assert_true(marks.count < MOST_MARKS);
                    memcpy(marks.voxels[marks.count++], (int[3]){x, y, z}, 3 * sizeof(int));
                }
            }
        }
    }
    return marks;
}

static uint32_t FindSquaredDistance(const Marks* marks, const int voxel[3])
{
    uint32_t nearest = UINT32_MAX;
    for (int i = 0; i < marks->count; ++i) {
        const int* mark = marks->voxels[i];
        const int d[3] = {mark[0] - voxel[0], mark[1] - voxel[1], mark[2] - voxel[2]};
        const uint32_t square = (uint32_t)(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        nearest = square < nearest ? square : nearest;
    }
    return nearest;
}

static uint32_t* TransformAll(pvtContext* context, const pvtBitGrid* grid, uint32_t limit)
{
    const int* size = grid->frame.size;
    uint32_t* distances = malloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2] * 4);
    assert_non_null(distances);
    CHECK_OK(context, pvtTransformGridDistance(context, grid, limit, distances));
    return distances;
}

static void CheckDistances(pvtContext* context, const pvtBitGrid* grid, uint32_t limit)
{
    uint32_t* distances = TransformAll(context, grid, limit);
    const Marks marks = FindMarks(grid);
    size_t i = 0;
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (int x = 0; x < grid->frame.size[0]; ++x, ++i) {
                const uint32_t square = FindSquaredDistance(&marks, (int[3]){x, y, z});
                const uint32_t expected = square <= limit ? square : limit + 1;
                assert_int_equal(distances[i], expected);
            }
        }
    }
    free(distances);
}

static void distances_are_those_of_a_search_over_all_voxels(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtRandom random = pvtMakeRandom(4, 0);
    static const int sizes[][3] = {{20, 7, 9}, {1, 12, 17}, {66, 2, 3}, {5, 19, 1}};
    static const uint32_t limits[] = {0, 1, 9, 50, 4000, UINT32_MAX - 1};
    for (int round = 0; round < 24; ++round) {
        pvtBitGrid grid;
        const int* size = sizes[round % 4];
        MakeEmptyGrid(context, size[0], size[1], size[2], &grid);
        for (int i = 0; i < 1 + 3 * (round / 4); ++i) {
            SetVoxel(&grid, (int)pvtRandom_Below(&random, (uint32_t)size[0]),
                     (int)pvtRandom_Below(&random, (uint32_t)size[1]),
                     (int)pvtRandom_Below(&random, (uint32_t)size[2]));
        }
        CheckDistances(context, &grid, limits[round % 6]);
        pvtBitGrid_Free(context, &grid);
    }
    DestroyTestContext(context);
}

static void an_empty_grid_is_beyond_every_limit(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, 70, 3, 4, &grid);
    CheckDistances(context, &grid, 100);
    uint32_t* distances = TransformAll(context, &grid, UINT32_MAX);
    assert_int_equal(distances[5], UINT32_MAX);
    free(distances);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void CheckDilation(const pvtBitGrid* grid, const pvtBitGrid* dilated, uint32_t squaredRadius)
{
    const Marks marks = FindMarks(grid);
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            for (int x = 0; x < grid->frame.size[0]; ++x) {
                const bool isNear = FindSquaredDistance(&marks, (int[3]){x, y, z}) <= squaredRadius;
                assert_int_equal(pvtBitGrid_Get(dilated, x, y, z), isNear);
            }
        }
    }
    // No bits beyond the grid.
    const uint64_t tail = ~UINT64_C(0) >> ((64 - grid->frame.size[0] % 64) % 64);
    for (size_t i = grid->wordsPerRow - 1; i < grid->wordCount; i += grid->wordsPerRow) {
        assert_true((dilated->words[i] & ~tail) == 0);
    }
}

// Every radius goes both ways, whichever the library would take by itself.
static void growing_by_a_ball_takes_all_voxels_within_the_radius(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtRandom random = pvtMakeRandom(5, 0);
    static const uint32_t squares[] = {0, 1, 2, 3, 4, 5, 8, 12, 27, 100, 399, 3000};
    for (size_t i = 0; i < sizeof squares / sizeof squares[0]; ++i) {
        pvtBitGrid grid;
        MakeEmptyGrid(context, i % 2 == 0 ? 67 : 40, 9, 8, &grid);
        for (int j = 0; j < 4; ++j) {
            SetVoxel(&grid, (int)pvtRandom_Below(&random, 40), (int)pvtRandom_Below(&random, 9),
                     (int)pvtRandom_Below(&random, 8));
        }
        pvtBitGrid dilated;
        CHECK_OK(context, pvtDilateGrid(context, &grid, squares[i], &dilated));
        CheckDilation(&grid, &dilated, squares[i]);
        pvtBitGrid_Free(context, &dilated);
        CHECK_OK(context, pvtDilateByDistance(context, &grid, squares[i], &dilated));
        CheckDilation(&grid, &dilated, squares[i]);
        pvtBitGrid_Free(context, &dilated);
        pvtBitGrid_Free(context, &grid);
    }
    DestroyTestContext(context);
}

static void whole_numbers_of_voxels_count_whatever_the_voxel_size(void** state)
{
    (void)state;
    for (int i = 1; i < 2000; ++i) {
        const pvtGridFrame frame = {{0.0, 0.0, 0.0}, 0.1 / i, {1, 1, 1}};
        for (int n = 0; n < 30; ++n) {
            double sum = 0.0;
            for (int j = 0; j < n; ++j) {
                sum += frame.voxelSize;
            }
            assert_int_equal(pvtGetSquaredReach(&frame, sum), n * n);
        }
    }
}

// A slab of a large grid takes seconds when the ball is large: one is not too short to be stopped.
static void growing_within_one_slab_can_be_cancelled(void** state)
{
    (void)state;
    CancelCounter counter = {2};
    pvtContext* context = CreateCancelledContext(&counter, 1);
    pvtBitGrid grid;
    pvtBitGrid dilated;
    MakeEmptyGrid(context, 64, 64, 1, &grid);
    SetVoxel(&grid, 30, 31, 0);
    assert_int_equal(pvtDilateGrid(context, &grid, 20 * 20, &dilated), PVT_CANCELLED);
    assert_null(dilated.words);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_of_a_search_over_all_voxels),
        cmocka_unit_test(an_empty_grid_is_beyond_every_limit),
        cmocka_unit_test(growing_by_a_ball_takes_all_voxels_within_the_radius),
        cmocka_unit_test(whole_numbers_of_voxels_count_whatever_the_voxel_size),
        cmocka_unit_test(growing_within_one_slab_can_be_cancelled),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
