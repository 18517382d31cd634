// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include "base/vector.h"
#include "occluder/check.h"

#include <paravent/occluder.h>

// Voxels 4 to 15 along each axis.
static void MakeBlock(pvtContext* context, pvtBitGrid* grid)
{
    MakeShiftedGrid(context, 20, 20, 20, grid);
    SetBox(grid, (int[]){4, 4, 4}, (int[]){16, 16, 16});
}

// One triangle with corners in voxels.
static uint64_t CountOutside(pvtContext* context, const pvtBitGrid* grid, const pvtVec3 corners[3])
{
    pvtVec3 positions[3];
    for (int c = 0; c < 3; ++c) {
        positions[c] = pvtAdd(grid->frame.origin, pvtScale(corners[c], grid->frame.voxelSize));
    }
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, 3, NULL, 1, &mesh));
    uint64_t outside = 0;
    CHECK_OK(context, pvtCheckOccluder(context, &(pvtInterior){.allowed = grid}, &mesh, &outside));
    pvtMesh_Free(context, &mesh);
    return outside;
}

static void a_planted_hole_is_found_by_every_plane_through_it(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtBitGrid whole;
    pvtBitGrid pierced;
    MakeBlock(context, &whole);
    MakeBlock(context, &pierced);
    ClearVoxel(&pierced, 10, 9, 8);
    pvtRandom random = pvtMakeRandom(5, 5);
    const pvtVec3 center = {10.5, 9.5, 8.5};
    for (int round = 0; round < 300; ++round) {
        // Two random corners and a third such that the hole's centre lies inside the triangle.
        pvtVec3 corners[3];
        for (int c = 0; c < 2; ++c) {
            corners[c] = (pvtVec3){pvtRandom_Unit(&random) * 5 + 8, pvtRandom_Unit(&random) * 5 + 7,
                                   pvtRandom_Unit(&random) * 4 + 6.5};
        }
        corners[2] = pvtSub(pvtScale(center, 3.0), pvtAdd(corners[0], corners[1]));
        assert_true(CountOutside(context, &whole, corners) == 0);
        assert_true(CountOutside(context, &pierced, corners) == 1);
    }
    pvtBitGrid_Free(context, &whole);
    pvtBitGrid_Free(context, &pierced);
    DestroyTestContext(context);
}

static void what_reaches_out_by_more_than_the_slack_is_counted(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeBlock(context, &grid);
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            for (int beyond = 0; beyond < 3; ++beyond) {
                // On the block's face, and 1/4096 and 1/256 of a voxel past it.
                const double past = beyond == 0 ? 0.0 : beyond == 1 ? 0x1p-12 : 0x1p-8;
                pvtVec3 corners[3] = {{8.3, 8.3, 8.3}, {8.6, 8.4, 8.7}, {8.4, 8.6, 8.2}};
                pvtSetAxis(&corners[1], axis, side == 0 ? 4.0 - past : 16.0 + past);
                assert_true(CountOutside(context, &grid, corners) == (beyond == 2 ? 1 : 0));
            }
        }
    }
    // Far outside, beyond the grid even.
    const pvtVec3 away[3] = {{-50, 8.5, 8.5}, {70, 8.5, 8.5}, {70, 8.7, 8.5}};
    assert_true(CountOutside(context, &grid, away) > 0);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void counting_ends_where_it_is_enough(void** state)
{
    (void)state;
    enum { TRIANGLES = 200 };
    pvtContext* context = CreateTestContext(2);
    pvtBitGrid grid;
    MakeBlock(context, &grid);
    pvtRandom random = pvtMakeRandom(7, 7);
    pvtVec3 positions[3 * TRIANGLES];
    for (int i = 0; i < 3 * TRIANGLES; ++i) {
        positions[i] = (pvtVec3){pvtRandom_Unit(&random) * 14 + 4, pvtRandom_Unit(&random) * 14 + 3,
                                 pvtRandom_Unit(&random) * 14 + 4};
        positions[i] = pvtAdd(grid.frame.origin, pvtScale(positions[i], grid.frame.voxelSize));
    }
    pvtMesh mesh;
    CHECK_OK(context,
             pvtCreateMesh(context, positions, 3 * (size_t)TRIANGLES, NULL, TRIANGLES, &mesh));
    static const uint64_t limits[] = {UINT64_MAX, 1, 5};
    uint64_t counts[3][TRIANGLES];
    const pvtInterior interior = {.allowed = &grid};
    for (int i = 0; i < 3; ++i) {
        CHECK_OK(context, pvtCheckTriangles(context, &interior, &mesh, limits[i], counts[i]));
    }
    int inside = 0, many = 0;
    for (int t = 0; t < TRIANGLES; ++t) {
        const uint64_t all = counts[0][t];
        assert_true(counts[1][t] == (all < 1 ? all : 1));
        assert_true(counts[2][t] == (all < 5 ? all : 5));
        inside += all == 0 ? 1 : 0;
        many += all > 5 ? 1 : 0;
    }
    assert_true(inside > 10 && many > 10);
    pvtMesh_Free(context, &mesh);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_planted_hole_is_found_by_every_plane_through_it),
        cmocka_unit_test(what_reaches_out_by_more_than_the_slack_is_counted),
        cmocka_unit_test(counting_ends_where_it_is_enough),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
