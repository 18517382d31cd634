// SPDX-License-Identifier: MIT
// Meshes that stand in several places: placed, saved once for all of them, and read back.
#include "files.h"

static const double kMoved[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1};
// A quarter turn around y, twice as large, moved.
static const double kTurned[16] = {0, 0, -2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 10, 0, 0, 1};
static const double kMirrored[16] = {-1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 0.5, 0, -4, 0, 0, 1};
static const double kSheared[16] = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 20, 0, 1};

static pvtMesh MakeCube(pvtContext* context)
{
    pvtVec3 positions[8];
    uint32_t indices[36];
    for (int i = 0; i < 8; ++i) {
        const float* p = kCubePositions[i];
        positions[i] = (pvtVec3){(double)p[0], (double)p[1], (double)p[2]};
    }
    for (int i = 0; i < 36; ++i) {
        indices[i] = kCubeIndices[i];
    }
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, 8, indices, 12, &mesh));
    return mesh;
}

static pvtModel SaveAndLoad(pvtContext* context, const char* path, const pvtSaveItem* items,
                            size_t count)
{
    pvtLoadOptions options = pvtDefaultLoadOptions();
    options.keepMeshes = true;
    pvtModel model;
    CHECK_OK(context, pvtSaveModel(context, path, items, count));
    CHECK_OK(context, pvtLoadModel(context, &options, path, &model));
    return model;
}

static void placed_meshes_keep_their_outside_and_scale_their_volume(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh cube = MakeCube(context);
    const struct {
        const double* transform;
        double volume;
        pvtVec3 lower, upper;
    } cases[] = {{NULL, 1.0, {0, 0, 0}, {1, 1, 1}},
                 {kMoved, 1.0, {5, 6, 7}, {6, 7, 8}},
                 {kTurned, 8.0, {10, 0, -2}, {12, 2, 0}},
                 {kMirrored, 1.5, {-5, 0, 0}, {-4, 3, 0.5}},
                 {kSheared, 1.0, {0, 20, 0}, {1.5, 21, 1}}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const pvtPlacedMesh placed = {&cube, cases[i].transform};
        pvtMesh joined;
        CHECK_OK(context, pvtPlaceMeshes(context, &placed, 1, &joined));
        CHECK_NEAR(GetSignedVolume(&joined), cases[i].volume, 1e-12);
        CheckBounds(&joined, cases[i].lower, cases[i].upper, 1e-12);
        pvtMesh_Free(context, &joined);
    }
    const pvtPlacedMesh both[] = {{&cube, kMoved}, {&cube, kMirrored}};
    pvtMesh joined;
    CHECK_OK(context, pvtPlaceMeshes(context, both, 2, &joined));
    assert_int_equal(joined.triangleCount, 24);
    CHECK_NEAR(GetSignedVolume(&joined), 2.5, 1e-9);
    pvtMesh_Free(context, &joined);
    const double huge[16] = {1e308, 0, 0, 0, 1e308, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const pvtPlacedMesh far = {&cube, huge};
    assert_int_equal(pvtPlaceMeshes(context, &far, 1, &joined), PVT_INVALID_INPUT);
    assert_null(joined.positions);
    pvtMesh_Free(context, &cube);
    DestroyTestContext(context);
}

static void instances_share_a_mesh_and_come_back_with_their_transforms(void** state)
{
    (void)state;
    const TestFolder folder = MakeTestFolder();
    pvtContext* context = CreateTestContext(1);
    pvtMesh cube = MakeCube(context);
    pvtMesh other = MakeCube(context);
    const pvtSaveItem items[] = {{.name = "a", .mesh = &cube},
                                 {.name = "b", .mesh = &cube, .transform = kMoved},
                                 {.name = "c", .mesh = &other, .transform = kTurned},
                                 {.name = "d", .mesh = &cube, .transform = kMirrored}};
    const double* const transforms[] = {NULL, kMoved, kTurned, kMirrored};
    pvtModel model = SaveAndLoad(context, InFolder(&folder, "shared.glb"), items, 4);
    assert_int_equal(model.partCount, 4);
    assert_int_equal(model.meshCount, 2);
    for (size_t i = 0; i < 4; ++i) {
        const pvtModelPart* part = &model.parts[i];
        assert_string_equal(part->name, items[i].name);
        assert_int_equal(part->meshIndex, i == 2 ? 1 : 0);
        for (int k = 0; k < 16; ++k) {
            const double expected = transforms[i] != NULL ? transforms[i][k] : k % 5 == 0;
            CHECK_NEAR(part->transform[k], expected, 1e-14);
        }
    }
    for (size_t i = 0; i < 2; ++i) {
        const pvtMesh* mesh = &model.meshes[i];
        assert_int_equal(mesh->positionCount, 8);
        CheckBounds(mesh, (pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, 0.0);
        CHECK_NEAR(GetSignedVolume(mesh), 1.0, 0.0);
        assert_memory_equal(mesh->indices, model.meshes[0].indices, 36 * sizeof(uint32_t));
    }
    CHECK_NEAR(GetSignedVolume(&model.mesh), 1.0 + 1.0 + 8.0 + 1.5, 1e-9);
    pvtModel_Free(context, &model);
    pvtMesh_Free(context, &cube);
    pvtMesh_Free(context, &other);
    DestroyTestContext(context);
    assert_int_equal(RemoveTestFolder(&folder), 1);
}

// glTF's nodes have no shear, and the other formats no nodes: a copy of the mesh is moved.
static void what_cannot_be_a_node_is_moved(void** state)
{
    (void)state;
    const TestFolder folder = MakeTestFolder();
    pvtContext* context = CreateTestContext(1);
    pvtMesh cube = MakeCube(context);
    const double flat[16] = {2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1};
    const pvtSaveItem items[] = {{.name = "plain", .mesh = &cube, .transform = kMoved},
                                 {.name = "sheared", .mesh = &cube, .transform = kSheared},
                                 {.name = "flat", .mesh = &cube, .transform = flat}};
    pvtModel model = SaveAndLoad(context, InFolder(&folder, "sheared.gltf"), items, 3);
    assert_int_equal(model.meshCount, 3);
    CHECK_NEAR(model.parts[0].transform[12], 5.0, 0.0);
    CHECK_NEAR(model.parts[1].transform[4], 0.0, 0.0);
    CheckBounds(&model.meshes[1], (pvtVec3){0, 20, 0}, (pvtVec3){1.5, 21, 1}, 1e-6);
    CheckBounds(&model.meshes[2], (pvtVec3){0, 0, 0}, (pvtVec3){2, 0, 2}, 0.0);
    CHECK_NEAR(GetSignedVolume(&model.mesh), 2.0, 1e-5);
    pvtModel_Free(context, &model);
    CHECK_OK(context, pvtSaveModel(context, InFolder(&folder, "moved.obj"), items, 1));
    char text[512] = "";
    FILE* file = fopen(InFolder(&folder, "moved.obj"), "rb");
    assert_non_null(file);
    assert_true(fread(text, 1, sizeof text - 1, file) > 0);
    (void)fclose(file);
    assert_non_null(strstr(text, "o plain\nv 5 6 7\nv 6 6 7\n"));
    pvtMesh_Free(context, &cube);
    DestroyTestContext(context);
    assert_int_equal(RemoveTestFolder(&folder), 2);
}

static void an_instance_beyond_a_float_is_refused(void** state)
{
    (void)state;
    const TestFolder folder = MakeTestFolder();
    pvtContext* context = CreateTestContext(1);
    pvtMesh cube = MakeCube(context);
    const double huge[16] = {1e39, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const pvtSaveItem item = {.name = "huge", .mesh = &cube, .transform = huge};
    assert_int_equal(pvtSaveModel(context, InFolder(&folder, "huge.ply"), &item, 1),
                     PVT_INVALID_ARGUMENT);
    CheckMessage(context, "\"huge\": position 1 does not fit in a float");
    pvtMesh_Free(context, &cube);
    DestroyTestContext(context);
    assert_int_equal(RemoveTestFolder(&folder), 0);
}

static void every_failing_allocation_leaves_nothing(void** state)
{
    (void)state;
    const TestFolder folder = MakeTestFolder();
    pvtContext* context = CreateTestContext(1);
    pvtMesh cube = MakeCube(context);
    const pvtSaveItem items[] = {{.name = "a", .mesh = &cube, .transform = kTurned},
                                 {.name = "b", .mesh = &cube, .transform = kSheared}};
    const char* path = InFolder(&folder, "a.glb");
    pvtLoadOptions options = pvtDefaultLoadOptions();
    options.keepMeshes = true;
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int failAt = 1; status != PVT_OK; ++failAt) {
        PoorHeap heap = {.failAt = failAt};
        pvtContext* poor = CreatePoorContext(&heap);
        pvtModel model = {0};
        status = pvtSaveModel(poor, path, items, 2);
        if (status == PVT_OK) {
            status = pvtLoadModel(poor, &options, path, &model);
        }
        assert_true(status == PVT_OK || model.meshes == NULL);
        assert_true(failAt < 1000);
        pvtModel_Free(poor, &model);
        DestroyTestContext(poor);
    }
    pvtMesh_Free(context, &cube);
    DestroyTestContext(context);
    assert_int_equal(RemoveTestFolder(&folder), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(placed_meshes_keep_their_outside_and_scale_their_volume),
        cmocka_unit_test(instances_share_a_mesh_and_come_back_with_their_transforms),
        cmocka_unit_test(what_cannot_be_a_node_is_moved),
        cmocka_unit_test(an_instance_beyond_a_float_is_refused),
        cmocka_unit_test(every_failing_allocation_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
