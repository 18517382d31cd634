// SPDX-License-Identifier: MIT
// OBJ, PLY, STL, DAE and FBX: what they say comes in, what they lie about is refused, and what
// crashes their parsers stops nobody else.
#include "file_fixture.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

static int TearDownChildren(void** state)
{
    (void)signal(SIGCHLD, SIG_DFL);
    return TearDown(state);
}

static pvtStatus LoadBytes(Fixture* f, const char* name, const void* bytes, size_t size)
{
    const char* path = InFolder(&f->folder, name);
    WriteBytes(path, bytes, size);
    pvtModel_Free(f->context, &f->model);
    return pvtLoadModel(f->context, &f->options, path, &f->model);
}

static pvtStatus LoadText(Fixture* f, const char* name, const char* text)
{
    return LoadBytes(f, name, text, strlen(text));
}

// The file's name, and the reason.
static void CheckRefused(Fixture* f, pvtStatus status, pvtStatus expected, const char* reason)
{
    if (status != expected) {
        fail_msg("status %d, not %d: %s", (int)status, (int)expected,
                 pvtContext_GetMessage(f->context));
    }
    CheckMessage(f->context, f->folder.path);
    CheckMessage(f->context, reason);
    assert_null(f->model.mesh.positions);
}

#define TETRAHEDRON "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"

static void obj_polygons_and_objects_come_in(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context, LoadText(f, "a.obj",
                                  "# two objects\no box\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n"
                                  "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\n"
                                  "o tetrahedron\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 5 0 1\n"
                                  "f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 \\\n-2 -1\n"));
    assert_int_equal(f->model.partCount, 2);
    assert_string_equal(f->model.parts[0].name, "box");
    assert_string_equal(f->model.parts[1].name, "tetrahedron");
    assert_int_equal(f->model.parts[0].triangleCount, 2);
    assert_int_equal(f->model.parts[1].triangleCount, 4);
    assert_int_equal(f->model.mesh.positionCount, 8);
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){6, 2, 1}, 0.0);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0 / 6.0, 1e-6);

    f->options.node = "tetrahedron";
    CHECK_OK(f->context, LoadText(f, "a.obj",
                                  "o one\n" TETRAHEDRON "f 1 2 3\no tetrahedron\n"
                                  "v 9 9 9\nf 2 3 5\n"));
    assert_int_equal(f->model.mesh.triangleCount, 1);
    f->options.node = "nobody";
    CheckRefused(f, LoadText(f, "a.obj", TETRAHEDRON "f 1 2 3\n"), PVT_INVALID_ARGUMENT,
                 "no node named \"nobody\"");
}

static void no_other_file_is_opened_by_an_obj(void** state)
{
    Fixture* f = *state;
    // Would hang: nobody writes to the pipe.
    assert_int_equal(mkfifo(InFolder(&f->folder, "pipe.mtl"), 0600), 0);
    CHECK_OK(f->context,
             LoadText(f, "a.obj", "mtllib pipe.mtl\nusemtl x\n" TETRAHEDRON "f 1 2 3\n"));
    assert_int_equal(f->model.mesh.triangleCount, 1);
}

static void what_was_saved_comes_back(void** state)
{
    Fixture* f = *state;
    pvtVec3 positions[8];
    uint32_t indices[36];
    for (int i = 0; i < 36; ++i) {
        indices[i] = kCubeIndices[i];
        const float* p = kCubePositions[i % 8];
        positions[i % 8] = (pvtVec3){(double)(p[0] + 0.1f), (double)(p[1] * 1e-7f), (double)p[2]};
    }
    pvtMesh cube;
    CHECK_OK(f->context, pvtCreateMesh(f->context, positions, 8, indices, 12, &cube));
    const pvtSaveItem items[2] = {{.name = "a", .mesh = &cube}, {.name = "b", .mesh = &cube}};
    const char* const names[] = {"cube.ply", "cube.obj", "CUBE.PLY"};
    for (int i = 0; i < 3; ++i) {
        const char* path = InFolder(&f->folder, names[i]);
        CHECK_OK(f->context, pvtSaveModel(f->context, path, items, 2));
        pvtModel_Free(f->context, &f->model);
        CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
        assert_int_equal(f->model.mesh.triangleCount, 24);
        // To the last bit of a float.
        for (size_t k = 0; k < 36; ++k) {
            const pvtVec3 p = f->model.mesh.positions[f->model.mesh.indices[k]];
            assert_memory_equal(&p, &positions[indices[k]], sizeof p);
        }
    }
    pvtMesh_Free(f->context, &cube);
}

// Of a triangle with 1.5, whose lowest byte is `byte`, as its first coordinate.
static size_t WriteBinaryPly(const char* lineEnd, uint8_t byte, char* ply, float* first)
{
    static const char* const lines[] = {"ply",
                                        "format binary_little_endian 1.0",
                                        "element vertex 3",
                                        "property float x",
                                        "property float y",
                                        "property float z",
                                        "element face 1",
                                        "property list uchar uint vertex_indices",
                                        "end_header"};
    char* at = ply;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; ++i) {
        at += sprintf(at, "%s%s", lines[i], lineEnd);
    }
    const uint32_t bits = 0x3fc00000 | byte;
    const float zeros[8] = {0, 0, 0, 1, 0, 0, 0, 1};
    const uint8_t face[13] = {3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0};
    memcpy(first, &bits, sizeof bits);
    memcpy(at, &bits, sizeof bits);
    memcpy(at + 4, zeros, sizeof zeros);
    memcpy(at + 36, face, sizeof face);
    return (size_t)(at - ply) + 36 + sizeof face;
}

// Among them those that could be taken for more of the header.
static void a_binary_ply_may_begin_with_any_byte(void** state)
{
    Fixture* f = *state;
    static const char* const lineEnds[] = {"\n", "\r\n"};
    static const uint8_t bytes[] = {0, '\t', '\n', '\f', '\r', ' ', 'e', 255};
    for (int i = 0; i < 2; ++i) {
        for (size_t b = 0; b < sizeof bytes; ++b) {
            char ply[512];
            float first;
            const size_t size = WriteBinaryPly(lineEnds[i], bytes[b], ply, &first);
            pvtModel_Free(f->context, &f->model);
            CHECK_OK(f->context, LoadBytes(f, "a.ply", (const uint8_t*)ply, size));
            assert_int_equal(f->model.mesh.triangleCount, 1);
            CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){(double)first, 1, 1}, 0.0);
        }
    }
}

static void stl_comes_in_as_text_and_as_bytes(void** state)
{
    Fixture* f = *state;
    const char* text = "solid tri\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\n"
                       "vertex 0 3 0\nendloop\nendfacet\nendsolid tri\n";
    CHECK_OK(f->context, LoadText(f, "a.stl", text));
    assert_int_equal(f->model.mesh.triangleCount, 1);
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){2, 3, 0}, 0.0);

    Pack pack = {.size = 0};
    const uint8_t title[80] = "solid in name only";
    PackBytes(&pack, title, sizeof title);
    PackU32(&pack, 2);
    for (int t = 0; t < 2; ++t) {
        const float facet[12] = {0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3 + (float)t, 0};
        PackBytes(&pack, facet, sizeof facet);
        PackBytes(&pack, "\0", 2);
    }
    CHECK_OK(f->context, LoadBytes(f, "a.stl", pack.bytes, pack.size));
    assert_int_equal(f->model.mesh.triangleCount, 2);
    assert_int_equal(f->model.mesh.positionCount, 4); // equal ones are one
    CheckRefused(f, LoadBytes(f, "a.stl", pack.bytes, pack.size - 7), PVT_INVALID_INPUT,
                 "2 triangles, which makes 184 bytes, but the file has 177");
    CheckRefused(f, LoadBytes(f, "a.stl", pack.bytes, 60), PVT_INVALID_INPUT, "60 bytes");
    CheckRefused(f, LoadBytes(f, "a.stl", text, 60), PVT_INVALID_INPUT, "cut short");
}

// A tetrahedron that stands twice: moved, and mirrored and stretched.
static const char kCollada[] =
    "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' "
    "version='1.4.1'><asset><up_axis>Y_UP</up_axis></asset><library_geometries>"
    "<geometry id='g'><mesh><source id='p'><float_array id='pa' count='12'>0 0 0 1 0 0 0 1 0 0 0 1"
    "</float_array><technique_common><accessor source='#pa' count='4' stride='3'>"
    "<param name='X' type='float'/><param name='Y' type='float'/><param name='Z' type='float'/>"
    "</accessor></technique_common></source><vertices id='v'><input semantic='POSITION' "
    "source='#p'/></vertices><triangles count='4'><input semantic='VERTEX' source='#v' offset='0'/>"
    "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>"
    "<library_visual_scenes><visual_scene id='s'><node id='a' name='a'><translate>5 0 0"
    "</translate><instance_geometry url='#g'/></node><node id='b' name='b'><scale>-2 1 1</scale>"
    "<instance_geometry url='#g'/></node></visual_scene></library_visual_scenes>"
    "<scene><instance_visual_scene url='#s'/></scene></COLLADA>";

static const char kFbx[] =
    "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXVersion: 7400\n}\n"
    "GlobalSettings:  {\n\tVersion: 1000\n}\nObjects:  {\n"
    "\tGeometry: 1000, \"Geometry::g\", \"Mesh\" {\n\t\tVertices: *12 {\n"
    "\t\t\ta: 0,0,0,1,0,0,0,1,0,0,0,1\n\t\t}\n\t\tPolygonVertexIndex: *12 {\n"
    "\t\t\ta: 0,2,-2,0,1,-4,0,3,-3,1,2,-4\n\t\t}\n\t}\n"
    "\tModel: 2000, \"Model::a\", \"Mesh\" {\n\t\tProperties70:  {\n"
    "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",5,0,0\n\t\t}\n\t}\n"
    "\tModel: 2001, \"Model::b\", \"Mesh\" {\n\t\tProperties70:  {\n"
    "\t\t\tP: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",-2,1,1\n\t\t}\n\t}\n}\n"
    "Connections:  {\n\tC: \"OO\",2000,0\n\tC: \"OO\",2001,0\n\tC: \"OO\",1000,2000\n"
    "\tC: \"OO\",1000,2001\n}\n";

static void nodes_of_dae_and_fbx_are_placed_and_wound_outwards(void** state)
{
    Fixture* f = *state;
    for (int i = 0; i < 2; ++i) {
        CHECK_OK(f->context, i == 0 ? LoadText(f, "a.dae", kCollada) : LoadText(f, "a.fbx", kFbx));
        assert_int_equal(f->model.partCount, 2);
        assert_string_equal(f->model.parts[0].name, "a");
        assert_string_equal(f->model.parts[1].name, "b");
        assert_int_equal(f->model.parts[0].meshIndex, f->model.parts[1].meshIndex);
        CHECK_NEAR(f->model.parts[0].transform[12], 5.0, 1e-6);
        CheckBounds(&f->model.mesh, (pvtVec3){-2, 0, 0}, (pvtVec3){6, 1, 1}, 1e-6);
        CHECK_NEAR(GetSignedVolume(&f->model.mesh), 0.5, 1e-6);
    }
    f->options.scene = 1;
    CheckRefused(f, LoadText(f, "a.dae", kCollada), PVT_INVALID_ARGUMENT, "no scene 1");
}

static void lies_are_refused_with_their_place_and_reason(void** state)
{
    Fixture* f = *state;
    const struct {
        const char* name;
        const char* text;
        const char* reason;
    } lies[] = {
        {"a.obj", TETRAHEDRON "f 1 2 9\n", "line 5: a face has index 9"},
        {"a.obj", TETRAHEDRON "\nf 1 2 -5\n", "line 6: a face has index -5"},
        {"a.obj", TETRAHEDRON "f 0 1 2\n", "line 5: a face has index 0"},
        {"a.obj", TETRAHEDRON "f 1 2 x\n", "line 5: \"x\" is no index"},
        {"a.obj", TETRAHEDRON "f 1 2 99999999999999999999\n", "line 5"},
        {"a.obj", "hello\n", "no position"},
        {"a.obj", TETRAHEDRON "p 1\nl 1 2\n", "no triangle"},
        {"a.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "all 1 triangles"},
        {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n", "no end_header"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n0 0 0\n",
         "ends after 1; it was cut short"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\n"
         "end_header\n0\n",
         "4000000000 elements"},
        {"a.ply",
         "ply\nformat binary_little_endian 1.0\nelement face 1\n"
         "property list uint int vertex_indices\nend_header\n\xff\xff\xff\xff",
         "ends after 0"},
        {"a.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
         "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
         "position 7, but there are only 3"},
        {"a.ply", "ply\nformat ascii 1.0\nelement vertex x\n", "counts \"x\""},
        {"a.ply", "PNG", "does not begin with \"ply\""},
        {"a.fbx", "junk", "assimp refuses it"},
        {"a.dae", "<?xml version='1.0'?><COLLADA/>", "assimp refuses it"},
        {"a.dae", "<?xml version='1.0'?><COLL", "assimp refuses it"},
    };
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; ++i) {
        CheckRefused(f, LoadText(f, lies[i].name, lies[i].text), PVT_INVALID_INPUT, lies[i].reason);
    }
}

static void a_parser_that_crashes_takes_nobody_with_it(void** state)
{
    Fixture* f = *state;
    enum { DEPTH = 200000 };
    char* text = malloc((size_t)DEPTH * 8);
    assert_non_null(text);
    size_t used = (size_t)sprintf(text, "; FBX 7.4.0 project file\n");
    for (int i = 0; i < DEPTH; ++i) {
        memcpy(text + used, "a: {\n", 5);
        used += 5;
    }
    CheckRefused(f, LoadBytes(f, "a.fbx", text, used), PVT_INVALID_INPUT, "damaged");
    free(text);
    CHECK_OK(f->context, LoadText(f, "a.fbx", kFbx));
}

static void a_program_that_ignores_its_children_can_import(void** state)
{
    Fixture* f = *state;
    (void)signal(SIGCHLD, SIG_IGN);
    CHECK_OK(f->context, LoadText(f, "a.fbx", kFbx));
    CheckRefused(f, LoadText(f, "a.obj", "hello\n"), PVT_INVALID_INPUT, "no position");
    (void)signal(SIGCHLD, SIG_DFL);
    // No child is left behind.
    CHECK_OK(f->context, LoadText(f, "a.fbx", kFbx));
    assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
}

static int CountDescriptors(void)
{
    int count = 0;
    DIR* listing = opendir("/proc/self/fd");
    assert_non_null(listing);
    while (readdir(listing) != NULL) {
        ++count;
    }
    closedir(listing);
    return count;
}

static void no_descriptor_is_left_open(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context, LoadText(f, "a.obj", TETRAHEDRON "f 1 2 3\n"));
    const int before = CountDescriptors();
    CHECK_OK(f->context, LoadText(f, "a.obj", TETRAHEDRON "f 1 2 3\n"));
    CheckRefused(f, LoadText(f, "a.obj", "hello\n"), PVT_INVALID_INPUT, "no position");
    assert_int_equal(CountDescriptors(), before);
}

static pvtStatus LoadAndFree(pvtContext* context, const void* path)
{
    pvtLoadOptions options = pvtDefaultLoadOptions();
    options.keepMeshes = true;
    pvtModel model;
    const pvtStatus status = pvtLoadModel(context, &options, path, &model);
    assert_int_equal(model.mesh.triangleCount, status == PVT_OK ? 1 : 0);
    assert_true((model.meshes != NULL) == (status == PVT_OK));
    pvtModel_Free(context, &model);
    return status;
}

// With a position that is not finite, so that others have to be moved together.
static const char* WriteTwoTriangles(Fixture* f)
{
    const char* path = InFolder(&f->folder, "a.obj");
    WriteText(path, TETRAHEDRON "v nan 0 0\nf 1 2 3\nf 3 4 5\n");
    return path;
}

static void importing_stops_when_asked(void** state)
{
    CheckEveryCancel(LoadAndFree, WriteTwoTriangles(*state));
}

static void every_failing_allocation_is_reported(void** state)
{
    CheckEveryAllocation(LoadAndFree, WriteTwoTriangles(*state));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(obj_polygons_and_objects_come_in),
        TEST(no_other_file_is_opened_by_an_obj),
        TEST(what_was_saved_comes_back),
        TEST(a_binary_ply_may_begin_with_any_byte),
        TEST(stl_comes_in_as_text_and_as_bytes),
        TEST(nodes_of_dae_and_fbx_are_placed_and_wound_outwards),
        TEST(lies_are_refused_with_their_place_and_reason),
        TEST(a_parser_that_crashes_takes_nobody_with_it),
        cmocka_unit_test_setup_teardown(a_program_that_ignores_its_children_can_import, SetUp,
                                        TearDownChildren),
        TEST(no_descriptor_is_left_open),
        TEST(importing_stops_when_asked),
        TEST(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
