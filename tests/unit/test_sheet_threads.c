// SPDX-License-Identifier: MIT
// By itself, since the thread sanitizer is too slow for the other tests of sheets.
#include "check.h"

#include <paravent/occluder.h>

// A wall with a door, and a roof that leans away from it.
static void MakeWall(pvtContext* context, pvtMesh* mesh)
{
    static const pvtVec3 positions[] = {{-4, 0, 0}, {-1, 0, 0}, {-1, 3, 0}, {1, 3, 0}, {1, 0, 0},
                                        {4, 0, 0},  {4, 4, 0},  {-4, 4, 0}, {4, 6, 3}, {-4, 6, 3}};
    static const uint32_t indices[] = {0, 1, 2, 0, 2, 7, 2, 3, 7, 3, 6, 7,
                                       3, 4, 5, 3, 5, 6, 7, 6, 8, 7, 8, 9};
    CHECK_OK(context, pvtCreateMesh(context, positions, 10, indices, 8, mesh));
}

static pvtOccluder Build(pvtContext* context)
{
    pvtMesh mesh;
    MakeWall(context, &mesh);
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.resolution = 32;
    options.budget = 10;
    options.views.count = 4;
    options.effort = PVT_EFFORT_FAST;
    pvtOccluder occluder;
    pvtBuildStats stats;
    CHECK_OK(context, pvtBuildOccluder(context, &options, &mesh, &occluder, &stats));
    assert_true(stats.surfacePanels > 0);
    pvtMesh_Free(context, &mesh);
    return occluder;
}

static void threads_do_not_change_a_sheet(void** state)
{
    (void)state;
    pvtContext* keeper = CreateTestContext(1);
    pvtOccluder first = Build(keeper);
    for (int threads = 2; threads <= 4; threads += 2) {
        pvtContext* context = CreateTestContext(threads);
        pvtOccluder other = Build(context);
        assert_int_equal(other.mesh.positionCount, first.mesh.positionCount);
        assert_memory_equal(other.mesh.positions, first.mesh.positions,
                            first.mesh.positionCount * sizeof(pvtVec3));
        pvtOccluder_Free(context, &other);
        DestroyTestContext(context);
    }
    pvtOccluder_Free(keeper, &first);
    DestroyTestContext(keeper);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(threads_do_not_change_a_sheet)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
