// SPDX-License-Identifier: MIT
// What is saved can be read back, holds what it should, and is there whole or not at all.
#include "file_fixture.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

// A cube from `lower`, of this side.
static pvtMesh MakeCube(pvtContext* context, double lower, double side)
{
    pvtVec3 positions[8];
    uint32_t indices[36];
    for (int i = 0; i < 8; ++i) {
        positions[i] = (pvtVec3){lower + side * (double)kCubePositions[i][0],
                                 lower + side * (double)kCubePositions[i][1],
                                 lower + side * (double)kCubePositions[i][2]};
    }
    for (int i = 0; i < 36; ++i) {
        indices[i] = kCubeIndices[i];
    }
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, 8, indices, 12, &mesh));
    return mesh;
}

static char* ReadText(const char* path, size_t* size)
{
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    char* text = calloc(1, 1 << 22);
    assert_non_null(text);
    *size = fread(text, 1, (1 << 22) - 1, file);
    (void)fclose(file);
    return text;
}

static void CheckHolds(const char* path, const char* part)
{
    size_t size = 0;
    char* text = ReadText(path, &size);
    // In a GLB the text ends where the binary chunk begins.
    bool found = false;
    for (size_t i = 0; i + strlen(part) <= size && !found; ++i) {
        found = memcmp(text + i, part, strlen(part)) == 0;
    }
    free(text);
    if (!found) {
        fail_msg("%s does not hold %s", path, part);
    }
}

static void a_mesh_comes_back_from_glb_and_gltf_as_it_went(void** state)
{
    Fixture* f = *state;
    const char* const names[] = {"a.glb", "a.gltf", "a.GLB"};
    // A third is no float: what comes back is the nearest one.
    const double lower = 1.0 / 3.0;
    pvtMesh cube = MakeCube(f->context, lower, 2.0);
    const pvtSaveItem item = {.name = "house_occluder", .mesh = &cube};
    for (size_t i = 0; i < 3; ++i) {
        const char* path = InFolder(&f->folder, names[i]);
        CHECK_OK(f->context, pvtSaveModel(f->context, path, &item, 1));
        pvtModel model;
        CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &model));
        assert_int_equal(model.mesh.triangleCount, 12);
        assert_int_equal(model.mesh.positionCount, 8);
        assert_int_equal(model.partCount, 1);
        assert_string_equal(model.parts[0].name, "house_occluder");
        CHECK_NEAR(GetSignedVolume(&model.mesh), 8.0, 1e-5);
        const double low = (double)(float)lower, high = (double)(float)(lower + 2.0);
        CheckBounds(&model.mesh, (pvtVec3){low, low, low}, (pvtVec3){high, high, high}, 0.0);
        pvtModel_Free(f->context, &model);
    }
    pvtMesh_Free(f->context, &cube);
}

static void several_items_are_nodes_at_the_root_with_their_extras(void** state)
{
    Fixture* f = *state;
    pvtMesh cubes[2] = {MakeCube(f->context, 0.0, 1.0), MakeCube(f->context, 5.0, 2.0)};
    const pvtExtra extras[] = {
        {.key = "error_bound", .number = 0.125},
        {.key = "budget", .number = 5e9}, // beyond 32 bits
        {.key = "method", .text = "planar"},
        {.key = "measure", .number = NAN}, // JSON has no word for it
    };
    const pvtSaveItem items[2] = {{"near", &cubes[0], extras, 4, NULL},
                                  {"far", &cubes[1], NULL, 0, NULL}};
    const char* path = InFolder(&f->folder, "two.gltf");
    CHECK_OK(f->context, pvtSaveModel(f->context, path, items, 2));
    CheckHolds(path, "\"generator\": \"paravent ");
    CheckHolds(path, "\"paravent\": {");
    CheckHolds(path, "\"error_bound\": 0.125");
    CheckHolds(path, "\"budget\": 5000000000.0");
    CheckHolds(path, "\"method\": \"planar\"");
    CheckHolds(path, "\"doubleSided\": true");
    CheckHolds(path, "data:application/octet-stream;base64,");
    pvtModel model;
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &model));
    assert_int_equal(model.partCount, 2);
    assert_string_equal(model.parts[0].name, "near");
    assert_string_equal(model.parts[1].name, "far");
    CHECK_NEAR(GetSignedVolume(&model.mesh), 9.0, 1e-5);
    pvtModel_Free(f->context, &model);
    for (int i = 0; i < 2; ++i) {
        pvtMesh_Free(f->context, &cubes[i]);
    }
}

// A strip of triangles through `count` positions.
static pvtMesh MakeStrip(pvtContext* context, size_t count)
{
    pvtVec3* positions = calloc(count, sizeof *positions);
    uint32_t* indices = calloc(3 * (count - 2), sizeof *indices);
    for (size_t i = 0; i < count; ++i) {
        positions[i] = (pvtVec3){(double)i, (double)(i % 2), 0.0};
    }
    for (size_t t = 0; t + 2 < count; ++t) {
        for (size_t k = 0; k < 3; ++k) {
            indices[3 * t + k] = (uint32_t)(t + k);
        }
    }
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, count, indices, count - 2, &mesh));
    free(positions);
    free(indices);
    return mesh;
}

static void the_restart_index_is_never_written(void** state)
{
    Fixture* f = *state;
    const struct {
        size_t positionCount;
        const char* type;
    } cases[] = {{65535, "\"componentType\":5123"}, {65536, "\"componentType\":5125"}};
    for (int i = 0; i < 2; ++i) {
        pvtMesh strip = MakeStrip(f->context, cases[i].positionCount);
        const pvtSaveItem item = {.name = "strip", .mesh = &strip};
        const char* path = InFolder(&f->folder, "strip.glb");
        CHECK_OK(f->context, pvtSaveModel(f->context, path, &item, 1));
        CheckHolds(path, cases[i].type);
        pvtModel model;
        CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &model));
        assert_int_equal(model.mesh.positionCount, cases[i].positionCount);
        assert_memory_equal(model.mesh.indices, strip.indices,
                            3 * strip.triangleCount * sizeof(uint32_t));
        pvtModel_Free(f->context, &model);
        pvtMesh_Free(f->context, &strip);
    }
}

static void names_that_are_no_utf8_do_not_stop_a_save(void** state)
{
    Fixture* f = *state;
    pvtMesh cube = MakeCube(f->context, 0.0, 1.0);
    const pvtSaveItem items[2] = {{.name = "bad\xff\nname", .mesh = &cube},
                                  {.name = NULL, .mesh = &cube}};
    const char* path = InFolder(&f->folder, "odd.glb");
    CHECK_OK(f->context, pvtSaveModel(f->context, path, items, 2));
    pvtModel model;
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &model));
    assert_string_equal(model.parts[0].name, "bad??name");
    assert_string_equal(model.parts[1].name, "node_1");
    pvtModel_Free(f->context, &model);
    path = InFolder(&f->folder, "odd.obj");
    CHECK_OK(f->context, pvtSaveModel(f->context, path, items, 2));
    CheckHolds(path, "o bad\xff_name\n");
    pvtMesh_Free(f->context, &cube);
}

// Readers take it for a part of the header.
static void no_ply_begins_with_a_line_end(void** state)
{
    Fixture* f = *state;
    const uint32_t bits[2] = {0x3fc0000a, 0x3fc0000b};
    float x[2];
    memcpy(x, bits, sizeof x);
    const pvtVec3 positions[3] = {{(double)x[0], 2, 0}, {(double)x[0], 3, 0}, {(double)x[1], 0, 5}};
    const uint32_t indices[3] = {0, 1, 2};
    pvtMesh mesh;
    CHECK_OK(f->context, pvtCreateMesh(f->context, positions, 3, indices, 1, &mesh));
    const pvtSaveItem items[2] = {{.name = "a", .mesh = &mesh}, {.name = "b", .mesh = &mesh}};
    const char* path = InFolder(&f->folder, "a.ply");
    CHECK_OK(f->context, pvtSaveModel(f->context, path, items, 2));
    size_t size = 0;
    char* ply = ReadText(path, &size);
    const char* data = strstr(ply, "end_header\n") + strlen("end_header\n");
    assert_memory_equal(data, &bits[1], sizeof bits[1]);
    // Of the first triangle two indices changed places with them, of the second one none.
    const uint8_t faces[26] = {3, 2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0,
                               3, 3, 0, 0, 0, 4, 0, 0, 0, 5, 0, 0, 0};
    assert_memory_equal(data + 6 * 12, faces, sizeof faces);
    free(ply);
    pvtMesh_Free(f->context, &mesh);
}

static void obj_and_ply_are_written_to_the_letter(void** state)
{
    Fixture* f = *state;
    const pvtVec3 positions[3] = {{0, 0, 0}, {0.1, 0, -2.5}, {0, 1e-20, 3e10}};
    const uint32_t indices[3] = {0, 1, 2};
    pvtMesh mesh;
    CHECK_OK(f->context, pvtCreateMesh(f->context, positions, 3, indices, 1, &mesh));
    const pvtSaveItem items[2] = {{.name = "a b", .mesh = &mesh}, {.name = "c", .mesh = &mesh}};
    CHECK_OK(f->context, pvtSaveModel(f->context, InFolder(&f->folder, "a.obj"), items, 2));
    CheckHolds(InFolder(&f->folder, "a.obj"),
               "o a_b\nv 0 0 0\nv 0.1 0 -2.5\nv 0 1e-20 3e+10\nf 1 2 3\n"
               "o c\nv 0 0 0\nv 0.1 0 -2.5\nv 0 1e-20 3e+10\nf 4 5 6\n");
    CHECK_OK(f->context, pvtSaveModel(f->context, InFolder(&f->folder, "a.ply"), items, 2));
    size_t size = 0;
    char* ply = ReadText(InFolder(&f->folder, "a.ply"), &size);
    const char* end = strstr(ply, "end_header\n");
    assert_non_null(end);
    assert_non_null(strstr(ply, "element vertex 6\n"));
    assert_non_null(strstr(ply, "element face 2\n"));
    const size_t header = (size_t)(end - ply) + strlen("end_header\n");
    assert_int_equal(size - header, 6 * 12 + 2 * 13);
    // The second face: three indices, moved on by three.
    const uint8_t face[13] = {3, 3, 0, 0, 0, 4, 0, 0, 0, 5, 0, 0, 0};
    assert_memory_equal(ply + size - 13, face, 13);
    free(ply);
    pvtMesh_Free(f->context, &mesh);
}

// What the parser of the command's test cannot be given by a file's name.
static void a_scene_of_godot_is_written_to_the_letter(void** state)
{
    Fixture* f = *state;
    const pvtVec3 positions[3] = {{0, -0.0, 0}, {0.1, 16777216, -2.5}, {3.4e38, 1e-40, 3e10}};
    const uint32_t indices[3] = {2, 0, 1};
    pvtMesh mesh;
    CHECK_OK(f->context, pvtCreateMesh(f->context, positions, 3, indices, 1, &mesh));
    const pvtExtra extras[] = {
        {.key = "error_bound", .number = 0.125},
        {.key = "none", .number = NAN},
        {.key = "a \"key\"", .text = "back\\slash\nand \"quotes\""},
    };
    pvtMesh other = MakeCube(f->context, 0.0, 1.0);
    const pvtSaveItem items[2] = {{"wall", &mesh, extras, 3, NULL},
                                  {"gate", &other, extras + 1, 1, NULL}};
    const char* path = InFolder(&f->folder, "a.tscn");
    CHECK_OK(f->context, pvtSaveModel(f->context, path, items, 2));
    CheckHolds(path, "[gd_scene load_steps=3 format=3]\n\n"
                     "[sub_resource type=\"ArrayOccluder3D\" id=\"ArrayOccluder3D_1\"]\n"
                     "vertices = PackedVector3Array(0, -0.0, 0, 0.1, 16777216, -2.5, "
                     "3.4e+38, 1e-40, 3e+10)\n"
                     "indices = PackedInt32Array(2, 0, 1)\n");
    CheckHolds(path,
               "\n[node name=\"Occluders\" type=\"Node3D\"]\nmetadata/generator = \"paravent ");
    CheckHolds(path, "\n[node name=\"wall\" type=\"OccluderInstance3D\" parent=\".\"]\n"
                     "occluder = SubResource(\"ArrayOccluder3D_1\")\n"
                     "metadata/paravent = {\n\"error_bound\": 0.125,\n"
                     "\"a \\\"key\\\"\": \"back\\\\slash?and \\\"quotes\\\"\"\n}\n");
    CheckHolds(path, "\n[node name=\"gate\" type=\"OccluderInstance3D\" parent=\".\"]\n"
                     "occluder = SubResource(\"ArrayOccluder3D_2\")\n");
    pvtMesh_Free(f->context, &mesh);
    pvtMesh_Free(f->context, &other);
}

static void instances_in_a_scene_of_godot_share_their_occluder(void** state)
{
    Fixture* f = *state;
    pvtMesh cube = MakeCube(f->context, 0.0, 1.0);
    // A quarter turn around y, twice as large, moved; and a shear.
    const double turned[16] = {0, 0, -2, 0, 0, 2, 0, 0, 2, 0, 0, 0, 10, 0.5, -3, 1};
    const double sheared[16] = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 20, 0, 1};
    const pvtSaveItem items[3] = {
        {"a", &cube, NULL, 0, NULL}, {"b", &cube, NULL, 0, turned}, {"c", &cube, NULL, 0, sheared}};
    const char* path = InFolder(&f->folder, "a.tscn");
    CHECK_OK(f->context, pvtSaveModel(f->context, path, items, 3));
    CheckHolds(path, "[gd_scene load_steps=3 format=3]\n");
    CheckHolds(path,
               "parent=\".\"]\noccluder = SubResource(\"ArrayOccluder3D_1\")\n\n[node name=\"b\"");
    CheckHolds(path,
               "parent=\".\"]\ntransform = Transform3D(0, 0, 2, 0, 2, 0, -2, 0, 0, 10, 0.5, -3)\n"
               "occluder = SubResource(\"ArrayOccluder3D_1\")\n\n[node name=\"c\"");
    CheckHolds(path, "parent=\".\"]\noccluder = SubResource(\"ArrayOccluder3D_2\")\n");
    CheckHolds(path, "PackedVector3Array(0, 20, 0, "); // moved there
    pvtMesh_Free(f->context, &cube);
}

static void names_in_a_scene_of_godot_are_valid_and_its_own(void** state)
{
    Fixture* f = *state;
    pvtMesh cube = MakeCube(f->context, 0.0, 1.0);
    const struct {
        const char *name, *written;
    } cases[] = {
        {"a/b:c@d.e%f\"g", "a_b_c_d_e_f_g"},
        {"back\\slash", "back\\\\slash"},
        {"new\nline\t\x7f", "new?line??"},
        {"bad\xff"
         "utf8",
         "bad?utf8"},
        {"\xc3\xa4 b[c]; = {}", "\xc3\xa4 b[c]; = {}"},
        {"", "node_5"},
        {NULL, "node_6"},
        {"twin", "twin"},
        {"twin", "twin2"},
        {"twin2", "twin22"},
        {"twin", "twin3"},
        {"Twin", "Twin"},
        {"a.b", "a_b"},
        {"a/b", "a_b2"},
        {"..", "__"},
    };
    enum { COUNT = sizeof cases / sizeof *cases };
    pvtSaveItem items[COUNT];
    for (int i = 0; i < COUNT; ++i) {
        items[i] = (pvtSaveItem){.name = cases[i].name, .mesh = &cube};
    }
    const char* path = InFolder(&f->folder, "a.tscn");
    CHECK_OK(f->context, pvtSaveModel(f->context, path, items, COUNT));
    for (int i = 0; i < COUNT; ++i) {
        char line[128];
        (void)snprintf(line, sizeof line,
                       "[node name=\"%s\" type=\"OccluderInstance3D\" parent=\".\"]\n"
                       "occluder = SubResource(\"ArrayOccluder3D_1\")\n",
                       cases[i].written);
        CheckHolds(path, line);
    }
    pvtMesh_Free(f->context, &cube);
}

static void what_cannot_be_saved_is_refused_before_a_file_is_made(void** state)
{
    Fixture* f = *state;
    pvtMesh cube = MakeCube(f->context, 0.0, 1.0);
    const pvtMesh none = {0};
    const pvtSaveItem empty = {.name = "void", .mesh = &none};
    const pvtSaveItem item = {.name = "box", .mesh = &cube};
    const char* path = InFolder(&f->folder, "x.glb");
    assert_int_equal(pvtSaveModel(f->context, path, &empty, 1), PVT_INVALID_ARGUMENT);
    CheckMessage(f->context, "void");
    assert_int_equal(pvtSaveModel(f->context, path, &item, 0), PVT_INVALID_ARGUMENT);
    assert_int_equal(pvtSaveModel(f->context, InFolder(&f->folder, "x.stl"), &item, 1),
                     PVT_UNSUPPORTED);
    CheckMessage(f->context, ".glb, .gltf, .obj, .ply or .tscn");
    cube.indices[35] = 8;
    assert_int_equal(pvtSaveModel(f->context, path, &item, 1), PVT_INVALID_ARGUMENT);
    CheckMessage(f->context, "index 35 is 8");
    cube.indices[35] = 0;
    cube.positions[3].y = 1e39;
    assert_int_equal(pvtSaveModel(f->context, path, &item, 1), PVT_INVALID_ARGUMENT);
    CheckMessage(f->context, "position 3");
    pvtMesh_Free(f->context, &cube);
    assert_int_equal(RemoveTestFolder(&f->folder), 0);
    f->folder = MakeTestFolder();
    assert_false(pvtCanSaveModel("glb"));
    assert_false(pvtCanSaveModel("a.fbx"));
    assert_true(pvtCanSaveModel("a.gltf"));
    assert_true(pvtCanSaveModel("some/where.b/a.PLY"));
}

// A limit on the size of files stands in for the disk's.
static pvtStatus SaveOnFullDisk(pvtContext* context, const char* path, const pvtSaveItem* item)
{
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit tight = {100, before.rlim_max};
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &tight), 0);
    const pvtStatus status = pvtSaveModel(context, path, item, 1);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    (void)signal(SIGXFSZ, SIG_DFL);
    return status;
}

static void a_failed_save_leaves_what_was_there(void** state)
{
    Fixture* f = *state;
    pvtMesh cube = MakeCube(f->context, 0.0, 1.0);
    const pvtSaveItem item = {.name = "box", .mesh = &cube};
    assert_int_equal(pvtSaveModel(f->context, "/nonexistent/x.glb", &item, 1), PVT_OUTPUT_FAILED);
    CheckMessage(f->context, "/nonexistent/x.glb");
    const char* const endings[] = {"glb", "gltf", "obj", "ply", "tscn"};
    for (int i = 0; i < 5; ++i) {
        char name[32];
        (void)snprintf(name, sizeof name, "full.%s", endings[i]);
        const char* path = InFolder(&f->folder, name);
        assert_int_equal(symlink("/dev/full", path), 0);
        assert_int_equal(pvtSaveModel(f->context, path, &item, 1), PVT_OUTPUT_FAILED);
        struct stat info;
        assert_int_equal(lstat(path, &info), 0);
        assert_true(S_ISLNK(info.st_mode));

        (void)snprintf(name, sizeof name, "old.%s", endings[i]);
        path = InFolder(&f->folder, name);
        WriteText(path, "as it was");
        assert_int_equal(SaveOnFullDisk(f->context, path, &item), PVT_OUTPUT_FAILED);
        size_t size = 0;
        char* text = ReadText(path, &size);
        assert_string_equal(text, "as it was");
        free(text);
    }
    assert_int_equal(RemoveTestFolder(&f->folder), 10); // nothing half written beside them
    f->folder = MakeTestFolder();
    pvtMesh_Free(f->context, &cube);
}

static void every_failing_allocation_leaves_no_file(void** state)
{
    Fixture* f = *state;
    pvtMesh cube = MakeCube(f->context, 0.0, 1.0);
    const pvtExtra extra = {.key = "key", .text = "text"};
    const pvtSaveItem item = {"box", &cube, &extra, 1, NULL};
    const char* const names[] = {"a.glb", "a.gltf", "a.obj", "a.ply", "a.tscn"};
    for (int i = 0; i < 5; ++i) {
        pvtStatus status = PVT_OUT_OF_MEMORY;
        for (int failAt = 1; status != PVT_OK; ++failAt) {
            PoorHeap heap = {.failAt = failAt};
            pvtContext* context = CreatePoorContext(&heap);
            const char* path = InFolder(&f->folder, names[i]);
            status = pvtSaveModel(context, path, &item, 1);
            assert_int_equal(access(path, F_OK), status == PVT_OK ? 0 : -1);
            assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
            assert_true(failAt < 100);
            DestroyTestContext(context);
        }
    }
    pvtMesh_Free(f->context, &cube);
    assert_int_equal(RemoveTestFolder(&f->folder), 5);
    f->folder = MakeTestFolder();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_mesh_comes_back_from_glb_and_gltf_as_it_went),
        TEST(several_items_are_nodes_at_the_root_with_their_extras),
        TEST(the_restart_index_is_never_written),
        TEST(names_that_are_no_utf8_do_not_stop_a_save),
        TEST(obj_and_ply_are_written_to_the_letter),
        TEST(no_ply_begins_with_a_line_end),
        TEST(a_scene_of_godot_is_written_to_the_letter),
        TEST(instances_in_a_scene_of_godot_share_their_occluder),
        TEST(names_in_a_scene_of_godot_are_valid_and_its_own),
        TEST(what_cannot_be_saved_is_refused_before_a_file_is_made),
        TEST(a_failed_save_leaves_what_was_there),
        TEST(every_failing_allocation_leaves_no_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
