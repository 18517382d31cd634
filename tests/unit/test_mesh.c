// SPDX-License-Identifier: MIT
#include "append.h"
#include "voxel_shapes.h"

#include <math.h>

static void bad_indices_and_positions_are_named(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtVec3 positions[4] = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    const uint32_t indices[6] = {0, 1, 2, 1, 4, 3};
    pvtMesh mesh;
    assert_int_equal(pvtCreateMesh(context, positions, 4, indices, 2, &mesh), PVT_INVALID_INPUT);
    assert_null(mesh.positions);
    assert_non_null(strstr(pvtContext_GetMessage(context), "index 4 of triangle 1"));
    positions[2].y = NAN;
    assert_int_equal(pvtCreateMesh(context, positions, 4, indices, 1, &mesh), PVT_INVALID_INPUT);
    assert_non_null(strstr(pvtContext_GetMessage(context), "position 2"));
    positions[2].y = -INFINITY;
    assert_int_equal(pvtCreateMesh(context, positions, 4, indices, 1, &mesh), PVT_INVALID_INPUT);
    positions[2].y = 1.0;
    assert_int_equal(pvtCreateMesh(context, positions, 4, NULL, 2, &mesh), PVT_INVALID_INPUT);
    CHECK_OK(context, pvtCreateMesh(context, positions, 4, NULL, 1, &mesh));
    assert_int_equal(mesh.indices[2], 2);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void bounds_hold_what_triangles_use(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtVec3 positions[5] = {
        {100.0, 0.0, 0.0}, {1.0, -2.0, 0.0}, {0.0, 1.0, 0.5}, {0.5, 0.0, 3.0}, {0.0, 0.0, -50.0}};
    const uint32_t indices[3] = {1, 2, 3};
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, 5, indices, 1, &mesh));
    pvtBox3 box = pvtMesh_GetBounds(&mesh);
    assert_true(box.lower.x == 0.0 && box.lower.y == -2.0 && box.lower.z == 0.0);
    assert_true(box.upper.x == 1.0 && box.upper.y == 1.0 && box.upper.z == 3.0);
    pvtMesh_Free(context, &mesh);
    CHECK_OK(context, pvtCreateMesh(context, NULL, 0, NULL, 0, &mesh));
    box = pvtMesh_GetBounds(&mesh);
    assert_true(box.lower.x > box.upper.x);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void welding_merges_equal_positions_in_order_of_first_use(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtVec3 positions[7] = {{9.0, 9.0, 9.0},    {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0},
                                  {-0.0, 1.0, 0.0},   {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0},
                                  {1.0, 0.0, 0x1p-60}};
    const uint32_t indices[9] = {4, 1, 2, 5, 3, 4, 6, 4, 2};
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, 7, indices, 3, &mesh));
    pvtMesh welded;
    CHECK_OK(context, pvtWeldMesh(context, &mesh, &welded));
    static const uint32_t expected[9] = {0, 1, 2, 1, 2, 0, 3, 0, 2};
    assert_int_equal(welded.positionCount, 4);
    assert_int_equal(welded.triangleCount, 3);
    assert_memory_equal(welded.indices, expected, sizeof expected);
    assert_true(welded.positions[0].z == 1.0 && welded.positions[3].z == 0x1p-60);
    pvtMesh_Free(context, &welded);
    pvtMesh_Free(context, &mesh);
    CHECK_OK(context, pvtCreateMesh(context, positions, 7, NULL, 0, &mesh));
    CHECK_OK(context, pvtWeldMesh(context, &mesh, &welded));
    assert_int_equal(welded.positionCount, 0);
    pvtMesh_Free(context, &welded);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// A lattice of cells whose corners are given anew for each triangle.
static void welding_a_soup_gives_each_lattice_point_once(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    enum { SIDE = 50 };
    pvtVec3* corners = malloc(sizeof *corners * SIDE * SIDE * 6);
    assert_non_null(corners);
    static const int offsets[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    for (int i = 0; i < SIDE * SIDE * 6; ++i) {
        const int cell = i / 6;
        corners[i] = (pvtVec3){0.1 * (cell % SIDE + offsets[i % 6][0]),
                               0.1 * (cell / SIDE + offsets[i % 6][1]), 7.0};
    }
    pvtMesh mesh;
    CHECK_OK(context,
             pvtCreateMesh(context, corners, SIDE * SIDE * 6, NULL, SIDE * SIDE * 2, &mesh));
    pvtMesh welded;
    CHECK_OK(context, pvtWeldMesh(context, &mesh, &welded));
    assert_int_equal(welded.positionCount, (SIDE + 1) * (SIDE + 1));
    for (int i = 0; i < SIDE * SIDE * 6; ++i) {
        assert_memory_equal(&welded.positions[welded.indices[i]], &corners[i], sizeof corners[i]);
    }
    pvtMesh_Free(context, &welded);
    pvtMesh_Free(context, &mesh);
    free(corners);
    DestroyTestContext(context);
}

static void joining_keeps_both_and_moves_indices(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    pvtMesh other;
    MakeBoxMesh(context, (pvtVec3){0.0, 0.0, 0.0}, (pvtVec3){1.0, 1.0, 1.0}, &mesh);
    MakeBoxMesh(context, (pvtVec3){5.0, 0.0, 0.0}, (pvtVec3){6.0, 1.0, 1.0}, &other);
    CHECK_OK(context, AppendMesh(context, &mesh, &other));
    assert_int_equal(mesh.positionCount, 16);
    assert_int_equal(mesh.triangleCount, 24);
    for (int i = 0; i < 36; ++i) {
        assert_int_equal(mesh.indices[36 + i], other.indices[i] + 8);
    }
    assert_true(pvtMesh_GetBounds(&mesh).upper.x == 6.0);
    pvtMesh_Free(context, &other);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static double AbsDot(pvtVec3 a, pvtVec3 b)
{
    return fabs(a.x * b.x + a.y * b.y + a.z * b.z);
}

static void a_box_faces_its_three_axes_with_the_area_of_both_sides(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    static const double scales[] = {1.0, 1e-20, 1e12};
    for (int i = 0; i < 3; ++i) {
        const double s = scales[i];
        pvtMesh mesh;
        MakeBoxMesh(context, (pvtVec3){0.0, 0.0, 0.0}, (pvtVec3){3.0 * s, 2.0 * s, s}, &mesh);
        const pvtFaceDirectionOptions options = pvtDefaultFaceDirectionOptions();
        pvtFaceDirectionSet set;
        CHECK_OK(context, pvtFindFaceDirections(context, &options, &mesh, &set));
        assert_int_equal(set.count, 3);
        static const pvtVec3 axes[3] = {{0.0, 0.0, 1.0}, {0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}};
        static const double areas[3] = {12.0, 6.0, 4.0};
        for (int j = 0; j < 3; ++j) {
            assert_memory_equal(&set.directions[j].direction, &axes[j], sizeof axes[j]);
            assert_true(fabs(set.directions[j].area / (areas[j] * s * s) - 1.0) < 1e-9);
        }
        pvtFaceDirectionSet_Free(context, &set);
        pvtMesh_Free(context, &mesh);
    }
    DestroyTestContext(context);
}

// Strips that face directions between two angles, `count` of them and each of the same area.
static void MakeArc(pvtContext* context, double from, double to, int count, pvtMesh* mesh)
{
    pvtVec3 corners[3 * 256];
    assert_true(count <= 256);
    for (int i = 0; i < count; ++i) {
        const double angle = from + (to - from) * i / (count - 1);
        const pvtVec3 along = {-sin(angle), cos(angle), 0.0};
        corners[3 * i] = (pvtVec3){0.0, 0.0, 0.0};
        corners[3 * i + 1] = along;
        corners[3 * i + 2] = (pvtVec3){0.0, 0.0, 1.0};
    }
    CHECK_OK(context,
             pvtCreateMesh(context, corners, 3 * (size_t)count, NULL, (size_t)count, mesh));
}

static void a_wall_keeps_its_own_direction_beside_slanted_trim(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    // The wall faces x; trim of two thirds of its area turns away from it by up to 0.1 rad.
    pvtMesh mesh;
    pvtMesh trim;
    MakeBoxMesh(context, (pvtVec3){0.0, 0.0, 0.0}, (pvtVec3){0.0, 5.0, 5.0}, &mesh);
    MakeArc(context, 0.03, 0.1, 70, &trim);
    CHECK_OK(context, AppendMesh(context, &mesh, &trim));
    const pvtFaceDirectionOptions options = pvtDefaultFaceDirectionOptions();
    pvtFaceDirectionSet set;
    CHECK_OK(context, pvtFindFaceDirections(context, &options, &mesh, &set));
    assert_int_equal(set.count, 1);
    assert_true(set.directions[0].direction.x > 1.0 - 1e-12);
    assert_true(fabs(set.directions[0].area - 85.0) < 1e-6);
    pvtFaceDirectionSet_Free(context, &set);
    pvtMesh_Free(context, &trim);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void directions_of_a_curved_surface_are_spread_and_bounded(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    MakeArc(context, 0.0, 3.0, 256, &mesh);
    pvtFaceDirectionOptions options = pvtDefaultFaceDirectionOptions();
    options.maxCount = 7;
    pvtFaceDirectionSet set;
    CHECK_OK(context, pvtFindFaceDirections(context, &options, &mesh, &set));
    assert_int_equal(set.count, 7);
    for (size_t i = 0; i < set.count; ++i) {
        const pvtVec3 a = set.directions[i].direction;
        assert_true(fabs(AbsDot(a, a) - 1.0) < 1e-12);
        assert_true(a.x > 0.0 || (a.x == 0.0 && a.y > 0.0));
        assert_true(i == 0 || set.directions[i].area <= set.directions[i - 1].area);
        for (size_t j = 0; j < i; ++j) {
            assert_true(AbsDot(a, set.directions[j].direction) < cos(0.05));
        }
    }
    pvtFaceDirectionSet_Free(context, &set);
    options.minFraction = 0.5;
    CHECK_OK(context, pvtFindFaceDirections(context, &options, &mesh, &set));
    assert_int_equal(set.count, 0);
    pvtFaceDirectionSet_Free(context, &set);
    options.maxCount = 0;
    assert_int_equal(pvtFindFaceDirections(context, &options, &mesh, &set), PVT_INVALID_ARGUMENT);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// A bumpy strip: curved parts, flat ones, and triangles of every size.
static void MakeHills(pvtContext* context, pvtMesh* mesh)
{
    enum { SIDE = 24 };
    pvtVec3 positions[(SIDE + 1) * (SIDE + 1)];
    uint32_t indices[6 * SIDE * SIDE];
    for (int j = 0; j <= SIDE; ++j) {
        for (int i = 0; i <= SIDE; ++i) {
            const double y = i < SIDE / 2 ? 0.3 * i : sin(0.7 * i) * cos(0.9 * j);
            positions[j * (SIDE + 1) + i] = (pvtVec3){0.1 * i * i, y, 0.37 * j};
        }
    }
    for (uint32_t k = 0; k < SIDE * SIDE; ++k) {
        const uint32_t a = k / SIDE * (SIDE + 1) + k % SIDE;
        const uint32_t quad[6] = {a, a + 1, a + SIDE + 2, a, a + SIDE + 2, a + SIDE + 1};
        memcpy(&indices[6 * k], quad, sizeof quad);
    }
    CHECK_OK(context, pvtCreateMesh(context, positions, (SIDE + 1) * (SIDE + 1), indices,
                                    2 * SIDE * SIDE, mesh));
}

// Compressions store triangles in any order, and begin each at any of its corners.
static void face_directions_do_not_hang_on_the_order_of_triangles_or_corners(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtFaceDirectionOptions options = pvtDefaultFaceDirectionOptions();
    pvtMesh mesh;
    pvtFaceDirectionSet before, after;
    MakeHills(context, &mesh);
    CHECK_OK(context, pvtFindFaceDirections(context, &options, &mesh, &before));
    assert_true(before.count > 3);
    const size_t count = mesh.triangleCount;
    for (size_t round = 0; round < 3; ++round) {
        for (size_t t = 0; t < count; ++t) {
            uint32_t* a = &mesh.indices[3 * t];
            uint32_t* b = &mesh.indices[3 * ((t * 7919 + round * 31) % count)];
            for (int k = 0; k < 3; ++k) {
                const uint32_t corner = a[k];
                a[k] = b[k];
                b[k] = corner;
            }
            const uint32_t first = a[0];
            a[0] = a[1];
            a[1] = a[2];
            a[2] = first;
        }
        CHECK_OK(context, pvtFindFaceDirections(context, &options, &mesh, &after));
        assert_int_equal(after.count, before.count);
        assert_memory_equal(after.directions, before.directions,
                            before.count * sizeof *before.directions);
        pvtFaceDirectionSet_Free(context, &after);
    }
    pvtFaceDirectionSet_Free(context, &before);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static pvtStatus WorkOnMeshes(pvtContext* context, const void* data)
{
    (void)data;
    static const pvtVec3 positions[3] = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
    pvtMesh mesh;
    pvtMesh welded = {0};
    pvtFaceDirectionSet set = {0};
    const pvtFaceDirectionOptions options = pvtDefaultFaceDirectionOptions();
    pvtStatus status = pvtCreateMesh(context, positions, 3, NULL, 1, &mesh);
    if (status == PVT_OK) {
        status = pvtWeldMesh(context, &mesh, &welded);
    }
    if (status == PVT_OK) {
        status = AppendMesh(context, &welded, &mesh);
        assert_int_equal(welded.triangleCount, status == PVT_OK ? 2 : 1);
    }
    if (status == PVT_OK) {
        status = pvtFindFaceDirections(context, &options, &welded, &set);
        assert_int_equal(set.count, status == PVT_OK ? 1 : 0);
    }
    pvtMesh_Free(context, &mesh);
    pvtMesh_Free(context, &welded);
    pvtFaceDirectionSet_Free(context, &set);
    return status;
}

static void failing_allocations_leave_meshes_as_they_were(void** state)
{
    (void)state;
    CheckEveryAllocation(WorkOnMeshes, NULL);
    CheckEveryCancel(WorkOnMeshes, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_indices_and_positions_are_named),
        cmocka_unit_test(bounds_hold_what_triangles_use),
        cmocka_unit_test(welding_merges_equal_positions_in_order_of_first_use),
        cmocka_unit_test(welding_a_soup_gives_each_lattice_point_once),
        cmocka_unit_test(joining_keeps_both_and_moves_indices),
        cmocka_unit_test(a_box_faces_its_three_axes_with_the_area_of_both_sides),
        cmocka_unit_test(a_wall_keeps_its_own_direction_beside_slanted_trim),
        cmocka_unit_test(directions_of_a_curved_surface_are_spread_and_bounded),
        cmocka_unit_test(face_directions_do_not_hang_on_the_order_of_triangles_or_corners),
        cmocka_unit_test(failing_allocations_leave_meshes_as_they_were),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
