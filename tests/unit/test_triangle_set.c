// SPDX-License-Identifier: MIT
// Sets of triangles, and what of an occluder's polygons becomes one.
#include "check.h"

#include "occluder/ascent_state.h"
#include "occluder/occluder.h"

static void edges_are_shared_by_pairs_of_triangles(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtTriangleSet set;
    CHECK_OK(context, pvtCreateTriangleSet(context, 8, 8, &set));
    for (int i = 0; i < 6; ++i) {
        pvtTriangleSet_AddCorner(&set, (float[3]){(float)i, (float)(i * i), 1.0F}, i == 5);
    }
    // Three triangles on the edge from 0 to 1: a pair, and one that is left.
    pvtTriangleSet_AddTriangle(&set, (uint32_t[3]){0, 1, 2}, 7);
    pvtTriangleSet_AddTriangle(&set, (uint32_t[3]){1, 0, 3}, 8);
    pvtTriangleSet_AddTriangle(&set, (uint32_t[3]){0, 1, 5}, 9);
    pvtTriangleSet_FindEdges(&set);
    assert_int_equal(set.edgeCount, 8);
    int pairs = 0;
    for (int e = 0; e < set.edgeCount; ++e) {
        pairs += set.edges[e].sideCount == 2 ? 1 : 0;
    }
    assert_int_equal(pairs, 1);
    assert_true(!set.isOpen[0][0] && set.isOpen[0][1] && set.isOpen[0][2]);
    pvtTriangleSet_Remove(&set, 0);
    int32_t moved[8];
    pvtTriangleSet_DropCorners(&set, moved);
    assert_int_equal(set.cornerCount, 4);
    assert_int_equal(set.triangleCount, 2);
    assert_int_equal(set.tags[0], 9);
    for (int c = 0; c < set.cornerCount; ++c) {
        assert_true(set.corners[c][0] == (float)moved[c]);
        assert_true(set.isFixed[c] == (moved[c] == 5));
    }
    pvtTriangleSet_Free(context, &set);
    DestroyTestContext(context);
}

static void a_set_is_appended_with_its_corners(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtTriangleSet sets[2];
    for (int s = 0; s < 2; ++s) {
        CHECK_OK(context, pvtCreateTriangleSet(context, 8, 4, &sets[s]));
        for (int i = 0; i < 3 + s; ++i) {
            const uint32_t corner = pvtTriangleSet_AddCorner(
                &sets[s], (float[3]){(float)i, (float)(i * i), (float)s}, i == 2);
            sets[s].anchors[corner][0] = 9.0F;
        }
        pvtTriangleSet_AddTriangle(&sets[s], (uint32_t[3]){0, 1, 2}, 10 * s);
    }
    pvtTriangleSet_AddTriangle(&sets[1], (uint32_t[3]){2, 1, 3}, 11);
    pvtTriangleSet_Append(&sets[0], &sets[1]);
    pvtTriangleSet_FindEdges(&sets[0]);
    assert_int_equal(sets[0].cornerCount, 7);
    assert_int_equal(sets[0].triangleCount, 3);
    assert_int_equal(sets[0].edgeCount, 3 + 5);
    assert_int_equal(sets[0].tags[2], 11);
    for (int t = 0; t < 2; ++t) {
        for (int k = 0; k < 3; ++k) {
            const uint32_t to = sets[0].triangles[1 + t][k], from = sets[1].triangles[t][k];
            assert_memory_equal(sets[0].corners[to], sets[1].corners[from], sizeof(float[3]));
            assert_memory_equal(sets[0].anchors[to], sets[1].anchors[from], sizeof(float[3]));
            assert_int_equal(sets[0].isFixed[to], sets[1].isFixed[from]);
        }
    }
    pvtTriangleSet_Free(context, &sets[0]);
    pvtTriangleSet_Free(context, &sets[1]);
    DestroyTestContext(context);
}

// Three squares, of which the second start has one.
static void each_start_has_its_own_polygons(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtGridFrame frame = {.origin = {0, 0, 0}, .voxelSize = 1.0, .size = {8, 8, 8}};
    enum { ONE = 1 << PVT_POINT_BITS };
    const pvtPoint2 square[] = {{ONE, ONE}, {3 * ONE, ONE}, {3 * ONE, 3 * ONE}, {ONE, 3 * ONE}};
    pvtOccluder occluder;
    CHECK_OK(context, pvtAllocateOccluder(context, &frame, 3, 12, &occluder));
    for (int p = 0; p < 3; ++p) {
        const pvtPlane plane = {.axis = PVT_AXIS_Z, .offset = (int64_t)(p + 1) << PVT_PLANE_BITS};
        pvtAddOccluderPolygon(&occluder, &plane, square, 4);
    }
    CHECK_OK(context, pvtMakeOccluderMesh(context, &occluder));
    const pvtAscentOptions options = {.startEnds = (size_t[]){2, 3}, .startCount = 2};
    pvtAscent ascent = {.options = &options, .occluder = &occluder, .frame = frame};
    CHECK_OK(context, pvtCreateTriangleSet(context, 8, 4, &ascent.set));
    static const int sizes[] = {2, 1};
    int polygon = 0;
    for (int s = 0; s < 2; ++s) {
        CHECK_OK(context, pvtAscent_TakeStart(context, &ascent, s));
        assert_int_equal(ascent.set.triangleCount, 2 * sizes[s]);
        assert_int_equal(ascent.set.cornerCount, 4 * sizes[s]);
        for (int t = 0; t < ascent.set.triangleCount; ++t) {
            assert_int_equal(ascent.set.tags[t], polygon + t / 2);
            for (int k = 0; k < 3; ++k) {
                const float* corner = ascent.set.corners[ascent.set.triangles[t][k]];
                assert_true(corner[2] == (float)(ascent.set.tags[t] + 1));
            }
        }
        polygon += sizes[s];
    }
    pvtTriangleSet_Free(context, &ascent.set);
    pvtOccluder_Free(context, &occluder);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_are_shared_by_pairs_of_triangles),
        cmocka_unit_test(a_set_is_appended_with_its_corners),
        cmocka_unit_test(each_start_has_its_own_polygons),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
