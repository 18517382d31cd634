// SPDX-License-Identifier: MIT
// glTF as it may be: node trees, index widths, modes, sparse and quantized accessors, scenes.
#include "gltf_fixture.h"

#include <meshoptimizer.h>

static void a_glb_gives_the_cube_that_it_holds(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context, LoadCube(f, CUBE));
    assert_int_equal(f->model.mesh.positionCount, 8);
    assert_int_equal(f->model.mesh.triangleCount, 12);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
    assert_int_equal(f->model.partCount, 1);
    assert_string_equal(f->model.parts[0].name, "node_0");
    assert_int_equal(f->model.parts[0].triangleCount, 12);
    assert_string_equal(f->warnings.text, "");
}

static void contents_decide_whether_it_is_glb_or_json(void** state)
{
    Fixture* f = *state;
    const Pack cube = PackCube();
    WriteGlb(InFolder(&f->folder, "cube.gltf"), CUBE, &cube);
    CHECK_OK(f->context, LoadFile(f, "cube.gltf"));
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);

    WriteBytes(InFolder(&f->folder, "a b.bin"), cube.bytes, cube.size);
    char* json =
        MakeJson("\xef\xbb\xbf \n{" ASSET "'buffers':[{'byteLength':168,'uri':'a%20b.bin'}],"
                 "'bufferViews':[{'buffer':0,'byteLength':96},"
                 "{'buffer':0,'byteOffset':96,'byteLength':72}]," CUBE_ACCESSORS CUBE_MESH
                 ",'nodes':[{'mesh':0}]}");
    WriteText(InFolder(&f->folder, "cube.glb"), json);
    free(json);
    CHECK_OK(f->context, LoadFile(f, "cube.glb"));
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
}

static void transforms_compose_from_the_root_down(void** state)
{
    Fixture* f = *state;
    // Moved by 10, then turned by 90 degrees around z, then stretched by 2, 3 and 4.
    CHECK_OK(f->context,
             LoadCube(f, CUBE_NODES("{'translation':[10,0,0],'children':[1]},"
                                    "{'rotation':[0,0,0.7071067811865476,0.7071067811865476],"
                                    "'children':[2]},{'scale':[2,3,4],'mesh':0,'name':'box'}")));
    CheckBounds(&f->model.mesh, (pvtVec3){7, 0, 0}, (pvtVec3){10, 2, 4}, 1e-12);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 24.0, 1e-12);
    assert_string_equal(f->model.parts[0].name, "box");
    // Its y axis points along −x.
    CHECK_NEAR(f->model.parts[0].transform[4], -3.0, 1e-12);
    CHECK_NEAR(f->model.parts[0].transform[12], 10.0, 1e-12);

    // The same by a matrix, column after column.
    CHECK_OK(f->context, LoadCube(f, CUBE_NODES("{'mesh':0,'matrix':[0,2,0,0,-3,0,0,0,0,0,4,0,"
                                                "10,0,0,1]}")));
    CheckBounds(&f->model.mesh, (pvtVec3){7, 0, 0}, (pvtVec3){10, 2, 4}, 0.0);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 24.0, 1e-12);
}

static void quarter_turns_by_quaternion_and_by_matrix_are_the_same(void** state)
{
    Fixture* f = *state;
    pvtVec3 positions[8];
    CHECK_OK(f->context, LoadCube(f, CUBE_NODES("{'matrix':[1,0,0,0,0,0,-1,0,0,1,0,0,0,0,0,1],"
                                                "'mesh':0}")));
    assert_int_equal(f->model.mesh.positionCount, 8);
    memcpy(positions, f->model.mesh.positions, sizeof positions);
    CHECK_OK(f->context, LoadCube(f, CUBE_NODES("{'rotation':[-0.7071067811865475,0,0,"
                                                "0.7071067811865476],'mesh':0}")));
    for (int i = 0; i < 8; ++i) {
        assert_true(positions[i].x == f->model.mesh.positions[i].x);
        assert_true(positions[i].y == f->model.mesh.positions[i].y);
        assert_true(positions[i].z == f->model.mesh.positions[i].z);
    }
}

static void mirrored_nodes_stay_wound_outwards(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context, LoadCube(f, CUBE_NODES("{'mesh':0,'scale':[-1,1,1]}")));
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
    CheckBounds(&f->model.mesh, (pvtVec3){-1, 0, 0}, (pvtVec3){0, 1, 1}, 0.0);
    // Mirrored twice is not mirrored.
    CHECK_OK(f->context, LoadCube(f, CUBE_NODES("{'scale':[-1,1,1],'children':[1]},"
                                                "{'mesh':0,'scale':[1,-2,1]}")));
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 2.0, 0.0);
}

static void instances_of_a_mesh_share_its_number(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context,
             LoadCube(f, "{" CUBE_DATA ",'scenes':[{'nodes':[0,1,2]}],'nodes':[{'mesh':0},"
                         "{'mesh':0,'translation':[5,0,0]},{'mesh':0,'translation':[0,5,0]}]}"));
    assert_int_equal(f->model.partCount, 3);
    assert_int_equal(f->model.mesh.triangleCount, 36);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 3.0, 1e-12);
    for (size_t i = 0; i < 3; ++i) {
        assert_int_equal(f->model.parts[i].meshIndex, 0);
        assert_int_equal(f->model.parts[i].firstTriangle, 12 * i);
    }
    CHECK_NEAR(f->model.parts[1].transform[12], 5.0, 0.0);
}

static void a_chain_of_3000_nodes_is_walked(void** state)
{
    Fixture* f = *state;
    char* json = malloc(1 << 18);
    assert_non_null(json);
    int used = sprintf(json, "{" CUBE_DATA ",'scenes':[{'nodes':[0]}],'nodes':[");
    for (int i = 0; i < 3000; ++i) {
        used += sprintf(json + used, "{'translation':[0,0,1],'children':[%d]},", i + 1);
    }
    (void)sprintf(json + used, "{'mesh':0}]}");
    Pack cube = PackCube();
    char* quoted = MakeJson(json);
    // Too long for a Pack: the JSON goes into a file of its own.
    char* start = strstr(quoted, "{\"byteLength\":168}");
    assert_non_null(start);
    FILE* file = fopen(InFolder(&f->folder, "chain.gltf"), "wb");
    assert_non_null(file);
    (void)fprintf(file, "%.*s{\"byteLength\":168,\"uri\":\"cube.bin\"}%s", (int)(start - quoted),
                  quoted, start + strlen("{\"byteLength\":168}"));
    assert_int_equal(fclose(file), 0);
    WriteBytes(InFolder(&f->folder, "cube.bin"), cube.bytes, cube.size);
    free(quoted);
    free(json);
    CHECK_OK(f->context, LoadFile(f, "chain.gltf"));
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 3000}, (pvtVec3){1, 1, 3001}, 0.0);
}

static void scenes_and_nodes_are_chosen(void** state)
{
    Fixture* f = *state;
    const char* json = "{" CUBE_DATA ",'scene':1,'scenes':[{'nodes':[0]},{'nodes':[1]}],'nodes':["
                       "{'mesh':0,'name':'left'},{'children':[2],'translation':[9,0,0]},"
                       "{'name':'right','mesh':0,'children':[3]},"
                       "{'name':'below','mesh':0,'translation':[0,5,0]}]}";
    CHECK_OK(f->context, LoadCube(f, json));
    assert_int_equal(f->model.partCount, 2);
    CheckBounds(&f->model.mesh, (pvtVec3){9, 0, 0}, (pvtVec3){10, 6, 1}, 0.0);
    f->options.scene = 0;
    CHECK_OK(f->context, LoadCube(f, json));
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, 0.0);
    f->options.scene = 2;
    CheckRefused(f, LoadCube(f, json), PVT_INVALID_ARGUMENT, "no scene 2");

    f->options.scene = -1;
    f->options.node = "right";
    CHECK_OK(f->context, LoadCube(f, json));
    assert_int_equal(f->model.partCount, 2);
    f->options.node = "below";
    CHECK_OK(f->context, LoadCube(f, json));
    CheckBounds(&f->model.mesh, (pvtVec3){9, 5, 0}, (pvtVec3){10, 6, 1}, 0.0);
    f->options.node = "left";
    CheckRefused(f, LoadCube(f, json), PVT_INVALID_ARGUMENT, "in another; choose it by --scene");
    f->options.node = "nobody";
    CheckRefused(f, LoadCube(f, json), PVT_INVALID_ARGUMENT, "no node named \"nobody\"");
}

// A quad of two triangles, with its indices as `mode` and `type` want them.
static pvtStatus LoadQuad(Fixture* f, int mode, int type, const void* indices, size_t size,
                          size_t count)
{
    static const float corners[4][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    Pack pack = {.size = 0};
    PackBytes(&pack, corners, sizeof corners);
    PackBytes(&pack, indices, size);
    char json[1024];
    (void)snprintf(json, sizeof json,
                   "{" ASSET "'buffers':[{'byteLength':%zu}],'bufferViews':[{'buffer':0,"
                   "'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':%zu}],'accessors':["
                   "{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
                   "{'bufferView':1,'componentType':%d,'count':%zu,'type':'SCALAR'}],"
                   "'meshes':[{'name':'quad','primitives':[{'attributes':{'POSITION':0},"
                   "'indices':1,'mode':%d}]}],'nodes':[{'mesh':0}]}",
                   48 + size, size, type, count, mode);
    return LoadGlb(f, json, &pack);
}

// The z of the sum of all triangles' normals: 8 for the quad of side 2 facing +z.
static double GetFacing(const pvtMesh* mesh)
{
    double sum = 0.0;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const pvtVec3 a = mesh->positions[mesh->indices[3 * t]];
        const pvtVec3 b = mesh->positions[mesh->indices[3 * t + 1]];
        const pvtVec3 c = mesh->positions[mesh->indices[3 * t + 2]];
        sum += (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    }
    return sum;
}

static void every_index_width_and_mode_gives_the_quad(void** state)
{
    Fixture* f = *state;
    const uint8_t list8[] = {0, 1, 2, 0, 2, 3}, strip8[] = {0, 1, 3, 2}, fan8[] = {0, 1, 2, 3};
    const uint16_t list16[] = {0, 1, 2, 0, 2, 3}, strip16[] = {0, 1, 3, 2};
    const uint32_t list32[] = {0, 1, 2, 0, 2, 3}, fan32[] = {0, 1, 2, 3};
    const struct {
        int mode, type;
        const void* indices;
        size_t size, count;
    } cases[] = {
        {4, 5121, list8, sizeof list8, 6},     {4, 5123, list16, sizeof list16, 6},
        {4, 5125, list32, sizeof list32, 6},   {5, 5121, strip8, sizeof strip8, 4},
        {5, 5123, strip16, sizeof strip16, 4}, {6, 5121, fan8, sizeof fan8, 4},
        {6, 5125, fan32, sizeof fan32, 4},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        CHECK_OK(f->context, LoadQuad(f, cases[i].mode, cases[i].type, cases[i].indices,
                                      cases[i].size, cases[i].count));
        assert_int_equal(f->model.mesh.triangleCount, 2);
        assert_int_equal(f->model.mesh.positionCount, 4);
        CHECK_NEAR(GetFacing(&f->model.mesh), 8.0, 0.0);
        assert_string_equal(f->model.parts[0].name, "quad");
    }
}

static void stitches_of_a_strip_are_not_triangles(void** state)
{
    Fixture* f = *state;
    const uint8_t strip[] = {0, 1, 3, 2, 2, 0, 0, 1, 3, 2};
    CHECK_OK(f->context, LoadQuad(f, 5, 5121, strip, sizeof strip, sizeof strip));
    assert_int_equal(f->model.mesh.triangleCount, 4);
    CHECK_NEAR(GetFacing(&f->model.mesh), 16.0, 0.0);
}

static void points_lines_and_spare_indices_are_passed_over(void** state)
{
    Fixture* f = *state;
    const uint8_t indices[] = {0, 1, 2, 0, 2, 3, 1, 2};
    CHECK_OK(f->context, LoadQuad(f, 4, 5121, indices, sizeof indices, sizeof indices));
    assert_int_equal(f->model.mesh.triangleCount, 2);
    for (int mode = 0; mode <= 3; ++mode) {
        CheckRefused(f, LoadQuad(f, mode, 5121, indices, 6, 6), PVT_INVALID_INPUT, "no triangle");
    }
    CheckRefused(f, LoadQuad(f, 7, 5121, indices, 6, 6), PVT_INVALID_INPUT,
                 "meshes[0].primitives[0].mode is 7");
    CheckRefused(f, LoadQuad(f, 5, 5121, indices, 2, 2), PVT_INVALID_INPUT, "no triangle");
}

static void triangles_need_no_indices(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context, LoadCube(f, "{" ASSET CUBE_BUFFER CUBE_ACCESSORS
                                     "'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"
                                     "'nodes':[{'mesh':0}]}"));
    assert_int_equal(f->model.mesh.triangleCount, 2); // of 8 positions
    assert_int_equal(f->model.mesh.positionCount, 6);
}

static void a_position_used_by_two_primitives_is_kept_once(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context,
             LoadCube(f, "{" ASSET CUBE_BUFFER CUBE_ACCESSORS
                         "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1},"
                         "{'attributes':{'POSITION':0},'indices':1}]}],'nodes':[{'mesh':0}]}"));
    assert_int_equal(f->model.mesh.triangleCount, 24);
    assert_int_equal(f->model.mesh.positionCount, 8);
    assert_int_equal(f->model.partCount, 1);
}

static void interleaved_positions_are_strided(void** state)
{
    Fixture* f = *state;
    Pack pack = {.size = 0};
    for (int i = 0; i < 8; ++i) {
        PackU32(&pack, 0xffffffff); // a normal's place
        PackBytes(&pack, kCubePositions[i], 12);
    }
    PackBytes(&pack, kCubeIndices, sizeof kCubeIndices);
    CHECK_OK(f->context,
             LoadGlb(f,
                     "{" ASSET "'buffers':[{'byteLength':200}],'bufferViews':[{'buffer':0,"
                     "'byteLength':128,'byteStride':16},{'buffer':0,'byteOffset':128,'byteLength':"
                     "72}],'accessors':[{'bufferView':0,'byteOffset':4,'componentType':5126,"
                     "'count':8,'type':'VEC3'},{'bufferView':1,'componentType':5123,'count':36,"
                     "'type':'SCALAR'}]," CUBE_MESH ",'nodes':[{'mesh':0}]}",
                     &pack));
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
}

static void sparse_values_replace_those_below(void** state)
{
    Fixture* f = *state;
    Pack pack = PackCube();
    const uint16_t places[2] = {1, 7};
    const float values[2][3] = {{3, 0, 0}, {1, 1, 5}};
    PackBytes(&pack, places, sizeof places);
    PackBytes(&pack, values, sizeof values);
    const char* views = "'buffers':[{'byteLength':196}],'bufferViews':[{'buffer':0,'byteLength':96}"
                        ",{'buffer':0,'byteOffset':96,'byteLength':72},{'buffer':0,'byteOffset':"
                        "168,'byteLength':4},{'buffer':0,'byteOffset':172,'byteLength':24}],";
    const char* sparse = "'componentType':5126,'count':8,'type':'VEC3','sparse':{'count':2,"
                         "'indices':{'bufferView':2,'componentType':5123},'values':"
                         "{'bufferView':3}}},{'bufferView':1,'componentType':5123,'count':36,"
                         "'type':'SCALAR'}]";
    char json[2048];
    (void)snprintf(json, sizeof json,
                   "{" ASSET "%s'accessors':[{'bufferView':0,%s," CUBE_MESH
                   ",'nodes':[{'mesh':0}]}",
                   views, sparse);
    CHECK_OK(f->context, LoadGlb(f, json, &pack));
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){3, 1, 5}, 0.0);

    // Without a view below: zeroes there.
    (void)snprintf(json, sizeof json,
                   "{" ASSET "%s'accessors':[{%s," CUBE_MESH ",'nodes':[{'mesh':0}]}", views,
                   sparse);
    CHECK_OK(f->context, LoadGlb(f, json, &pack));
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){3, 1, 5}, 0.0);
    assert_int_equal(f->model.mesh.positionCount, 8);

    // Places that do not rise, or lie outside.
    pack.bytes[168] = 7;
    CheckRefused(f, LoadGlb(f, json, &pack), PVT_INVALID_INPUT,
                 "accessors[0].sparse: index 1 is 7");
    pack.bytes[168] = 8;
    CheckRefused(f, LoadGlb(f, json, &pack), PVT_INVALID_INPUT,
                 "accessors[0].sparse: index 0 is 8");
}

static void quantized_positions_are_unpacked(void** state)
{
    Fixture* f = *state;
    const struct {
        int type;
        bool normalized;
        uint32_t one; // as the file has it
        double expected;
    } cases[] = {
        {5120, false, 100, 100.0},  {5120, true, 127, 1.0},      {5121, false, 200, 200.0},
        {5121, true, 51, 0.2},      {5122, false, 30000, 3e4},   {5122, true, 32767, 1.0},
        {5123, false, 50000, 5e4},  {5123, true, 13107, 0.2},    {5120, true, 0x80, -1.0},
        {5122, true, 0x8000, -1.0}, {5120, false, 0x80, -128.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        Pack pack = {.size = 0};
        const size_t size = cases[i].type < 5122 ? 1 : 2;
        for (int p = 0; p < 8; ++p) {
            for (int k = 0; k < 3; ++k) {
                const uint16_t value = (uint16_t)(kCubePositions[p][k] * (float)cases[i].one);
                PackBytes(&pack, &value, size);
            }
            PackPadding(&pack, 0);
        }
        const size_t positionSize = pack.size;
        PackBytes(&pack, kCubeIndices, sizeof kCubeIndices);
        char json[2048];
        (void)snprintf(
            json, sizeof json,
            "{" ASSET "'extensionsRequired':['KHR_mesh_quantization'],'extensionsUsed':"
            "['KHR_mesh_quantization'],'buffers':[{'byteLength':%zu}],'bufferViews':[{'buffer':0,"
            "'byteLength':%zu,'byteStride':%zu},{'buffer':0,'byteOffset':%zu,'byteLength':72}],"
            "'accessors':[{'bufferView':0,'componentType':%d,'normalized':%s,'count':8,"
            "'type':'VEC3'},{'bufferView':1,'componentType':5123,'count':36,'type':'SCALAR'}]"
            "," CUBE_MESH ",'nodes':[{'mesh':0}]}",
            pack.size, positionSize, positionSize / 8, positionSize, cases[i].type,
            cases[i].normalized ? "true" : "false");
        CHECK_OK(f->context, LoadGlb(f, json, &pack));
        const double low = fmin(cases[i].expected, 0.0), high = fmax(cases[i].expected, 0.0);
        CheckBounds(&f->model.mesh, (pvtVec3){low, low, low}, (pvtVec3){high, high, high}, 1e-12);
        char* required = strstr(json, "'extensionsRequired'");
        assert_non_null(required);
        memmove(required, strstr(json, "'buffers'"), strlen(strstr(json, "'buffers'")) + 1);
        CheckRefused(f, LoadGlb(f, json, &pack), PVT_INVALID_INPUT, "KHR_mesh_quantization");
    }
}

static void triangles_that_are_not_finite_are_dropped_with_a_warning(void** state)
{
    Fixture* f = *state;
    Pack cube = PackCube();
    const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; ++i) {
        memcpy(cube.bytes + 12 + 4 * i, &bad[i],
               4); // a coordinate of position 1, of four triangles
        CHECK_OK(f->context, LoadGlb(f, CUBE, &cube));
        assert_int_equal(f->model.mesh.triangleCount, 8);
        assert_int_equal(f->model.mesh.positionCount, 7);
        for (size_t p = 0; p < f->model.mesh.positionCount; ++p) {
            const pvtVec3 v = f->model.mesh.positions[p];
            assert_true(isfinite(v.x) && isfinite(v.y) && isfinite(v.z));
        }
        assert_non_null(strstr(f->warnings.text, "model.glb: 4 triangles"));
    }
    // Finite in the file, but not in the world.
    CheckRefused(f, LoadCube(f, CUBE_NODES("{'mesh':0,'translation':[1e39,0,0]}")),
                 PVT_INVALID_INPUT, "all 12 triangles");
}

static void materials_that_let_light_through_are_left_out(void** state)
{
    Fixture* f = *state;
    const char* two = "{" ASSET CUBE_BUFFER CUBE_ACCESSORS
                      "'materials':[{'alphaMode':'BLEND'},{'alphaMode':'MASK'},{}],'meshes':["
                      "{'primitives':[{'attributes':{'POSITION':0},'indices':1,'material':0},"
                      "{'attributes':{'POSITION':0},'indices':1,'material':1},"
                      "{'attributes':{'POSITION':0},'indices':1,'material':2}]}],"
                      "'nodes':[{'mesh':0}]}";
    f->options.masked = PVT_MASKED_SKIP;
    CHECK_OK(f->context, LoadCube(f, two));
    assert_int_equal(f->model.mesh.triangleCount, 12);
    assert_non_null(strstr(f->warnings.text, "1 primitives with a blended material"));
    assert_non_null(strstr(f->warnings.text, "--masked opaque"));
    f->options.masked = PVT_MASKED_OPAQUE;
    CHECK_OK(f->context, LoadCube(f, two));
    assert_int_equal(f->model.mesh.triangleCount, 24);
    assert_null(strstr(f->warnings.text, "masked"));
    f->options.masked = PVT_MASKED_AUTO;
    CHECK_OK(f->context, LoadCube(f, two));
    assert_int_equal(f->model.mesh.triangleCount, 12);
    assert_non_null(
        strstr(f->warnings.text, "masked materials without a texture to be judged by: 1"));
    assert_non_null(strstr(f->warnings.text, "--masked opaque"));

    f->options.masked = PVT_MASKED_SKIP;
    const char* leaves = "{" ASSET CUBE_BUFFER CUBE_ACCESSORS
                         "'materials':[{'alphaMode':'MASK'}],'meshes':[{'primitives':[{"
                         "'attributes':{'POSITION':0},'indices':1,'material':0}]}],"
                         "'nodes':[{'mesh':0}]}";
    CheckRefused(f, LoadCube(f, leaves), PVT_INVALID_INPUT, "--masked opaque");
}

static void skins_and_morphs_give_the_bind_pose_with_a_warning(void** state)
{
    Fixture* f = *state;
    Pack pack = PackCube();
    // Takes the mesh to the joint's space: the joint stands at x = 4 in the bind pose.
    const float inverse[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -4, 0, 0, 1};
    PackBytes(&pack, inverse, sizeof inverse);
    const char* json =
        "{" ASSET "'buffers':[{'byteLength':232}],'bufferViews':[{'buffer':0,'byteLength':96},"
        "{'buffer':0,'byteOffset':96,'byteLength':72},{'buffer':0,'byteOffset':168,"
        "'byteLength':64}],'accessors':[{'bufferView':0,'componentType':5126,'count':8,"
        "'type':'VEC3'},{'bufferView':1,'componentType':5123,'count':36,'type':'SCALAR'},"
        "{'bufferView':2,'componentType':5126,'count':1,'type':'MAT4'}],"
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1,"
        "'targets':[{'POSITION':0}]}]}],'skins':[{'joints':[2],'inverseBindMatrices':2}],"
        "'nodes':[{'scale':[2,2,2],'children':[1,2]},{'mesh':0,'skin':0,'translation':[50,0,0]},"
        "{'translation':[4,0,0]}],'scenes':[{'nodes':[0]}]}";
    CHECK_OK(f->context, LoadGlb(f, json, &pack));
    // Twice as large by the root; what the mesh's own node says does not count.
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){2, 2, 2}, 1e-12);
    assert_non_null(strstr(f->warnings.text, "bind pose: 1"));
    assert_non_null(strstr(f->warnings.text, "morph"));
}

// Two joints, a hip and a knee: the hip is listed last, and stands where it was bound.
static void a_skin_stands_where_the_joint_nearest_to_the_root_puts_it(void** state)
{
    Fixture* f = *state;
    Pack pack = PackCube();
    const float knee[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -4, -1, 0, 1};
    const float hip[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -4, 0, 0, 1};
    PackBytes(&pack, knee, sizeof knee);
    PackBytes(&pack, hip, sizeof hip);
    static const char* const json =
        "{" ASSET "'buffers':[{'byteLength':296}],'bufferViews':[{'buffer':0,'byteLength':96},"
        "{'buffer':0,'byteOffset':96,'byteLength':72},{'buffer':0,'byteOffset':168,"
        "'byteLength':128}],'accessors':[{'bufferView':0,'componentType':5126,'count':8,"
        "'type':'VEC3'},{'bufferView':1,'componentType':5123,'count':36,'type':'SCALAR'},"
        "{'bufferView':2,'componentType':5126,'count':2,'type':'MAT4'}],"
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
        "'skins':[{'joints':[2,1],'inverseBindMatrices':2}],'nodes':[{'mesh':0,'skin':0},"
        "{'translation':[14,0,0],'children':[2]},{'translation':[0,%d,0]}],"
        "'scenes':[{'nodes':[0,1]}]}";
    char posed[2048];
    // The knee where it was bound: all joints agree.
    (void)snprintf(posed, sizeof posed, json, 1);
    CHECK_OK(f->context, LoadGlb(f, posed, &pack));
    CheckBounds(&f->model.mesh, (pvtVec3){10, 0, 0}, (pvtVec3){11, 1, 1}, 1e-12);
    assert_non_null(
        strstr(f->warnings.text, "skinned meshes that are taken in their bind pose: 1"));
    assert_null(strstr(f->warnings.text, "another pose"));
    // The knee elsewhere: the bind pose all the same, with another warning.
    (void)snprintf(posed, sizeof posed, json, 3);
    CHECK_OK(f->context, LoadGlb(f, posed, &pack));
    CheckBounds(&f->model.mesh, (pvtVec3){10, 0, 0}, (pvtVec3){11, 1, 1}, 1e-12);
    assert_non_null(strstr(f->warnings.text, "stand in another pose than they were bound in: 1"));
}

static void integers_written_as_fractions_are_read(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context, LoadCube(f, CUBE_NODES("{'mesh':0.0,'children':[]}")));
    assert_int_equal(f->model.mesh.triangleCount, 12);
}

static void copies_by_extension_are_instances(void** state)
{
    Fixture* f = *state;
    Pack pack = PackCube();
    const float places[3][3] = {{0, 0, 0}, {10, 0, 0}, {0, 20, 0}};
    const int8_t turns[3][4] = {{0, 0, 0, 127}, {0, 0, 127, 0}, {0, 0, 0, 127}}; // half a turn
    const float scales[3][3] = {{1, 1, 1}, {1, 1, 1}, {-2, 1, 1}};
    PackBytes(&pack, places, sizeof places);
    PackBytes(&pack, turns, sizeof turns);
    PackBytes(&pack, scales, sizeof scales);
    char json[2048];
    const char* format =
        "{" ASSET "'extensionsRequired':['EXT_mesh_gpu_instancing'],'buffers':[{'byteLength':252}],"
        "'bufferViews':[{'buffer':0,'byteLength':96},{'buffer':0,'byteOffset':96,'byteLength':72},"
        "{'buffer':0,'byteOffset':168,'byteLength':36},{'buffer':0,'byteOffset':204,'byteLength':"
        "12},{'buffer':0,'byteOffset':216,'byteLength':36}],'accessors':[{'bufferView':0,"
        "'componentType':5126,'count':8,'type':'VEC3'},{'bufferView':1,'componentType':5123,"
        "'count':36,'type':'SCALAR'},{'bufferView':2,'componentType':5126,'count':3,'type':'VEC3'},"
        "{'bufferView':3,'componentType':5120,'normalized':true,'count':%d,'type':'VEC4'},"
        "{'bufferView':4,'componentType':5126,'count':3,'type':'VEC3'}]," CUBE_MESH
        ",'nodes':[{'translation':[0,0,7],'mesh':0,'extensions':{'EXT_mesh_gpu_instancing':"
        "{'attributes':{'TRANSLATION':2,'ROTATION':3,'SCALE':4,'_ID':0}}}}]}";
    (void)snprintf(json, sizeof json, format, 3);
    CHECK_OK(f->context, LoadGlb(f, json, &pack));
    assert_int_equal(f->model.partCount, 3);
    assert_int_equal(f->model.parts[2].meshIndex, 0);
    CheckBounds(&f->model.mesh, (pvtVec3){-2, -1, 7}, (pvtVec3){10, 21, 8}, 1e-12);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 4.0, 1e-9);
    (void)snprintf(json, sizeof json, format, 2);
    CheckRefused(f, LoadGlb(f, json, &pack), PVT_INVALID_INPUT, "3 and 2 elements");
}

static void compressed_views_hold_what_was_packed(void** state)
{
    Fixture* f = *state;
    Pack pack = {.size = 0};
    uint32_t indices[36];
    for (int i = 0; i < 36; ++i) {
        indices[i] = kCubeIndices[i];
    }
    uint8_t packed[1024];
    const size_t vertexSize =
        meshopt_encodeVertexBuffer(packed, sizeof packed, kCubePositions, 8, 12);
    PackBytes(&pack, packed, vertexSize);
    const size_t indexSize = meshopt_encodeIndexBuffer(packed, sizeof packed, indices, 36);
    PackBytes(&pack, packed, indexSize);
    assert_true(vertexSize > 0 && indexSize > 0);
    char json[2048];
    // The second buffer is what readers without the extension would fall back to, and is not there.
    (void)snprintf(
        json, sizeof json,
        "{" ASSET "'extensionsRequired':['EXT_meshopt_compression'],'buffers':[{'byteLength':%zu},"
        "{'byteLength':168,'extensions':{'EXT_meshopt_compression':{'fallback':true}}}],"
        "'bufferViews':[{'buffer':1,'byteLength':96,'extensions':{'EXT_meshopt_compression':"
        "{'buffer':0,'byteLength':%zu,'byteStride':12,'count':8,'mode':'ATTRIBUTES'}}},"
        "{'buffer':1,'byteOffset':96,'byteLength':72,'extensions':{'EXT_meshopt_compression':"
        "{'buffer':0,'byteOffset':%zu,'byteLength':%zu,'byteStride':2,'count':36,"
        "'mode':'TRIANGLES'}}}]," CUBE_ACCESSORS CUBE_MESH ",'nodes':[{'mesh':0}]}",
        pack.size, vertexSize, vertexSize, indexSize);
    CHECK_OK(f->context, LoadGlb(f, json, &pack));
    assert_int_equal(f->model.mesh.triangleCount, 12);
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, 0.0);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
    // Damaged anywhere: refused, or another cube, but never anything worse.
    const Pack whole = pack;
    for (size_t i = 0; i < whole.size; ++i) {
        pack.bytes[i] ^= 0x55;
        const pvtStatus status = LoadGlb(f, json, &pack);
        assert_true(status == PVT_OK || status == PVT_INVALID_INPUT);
        pack = whole;
    }
}

// What the extension says is held against what a view of that kind can be.
static void compressed_views_are_checked_before_they_are_decoded(void** state)
{
    Fixture* f = *state;
    const struct {
        const char* extension;
        const char* reason;
    } cases[] = {
        {"'byteLength':40,'byteStride':12,'count':8,'mode':'ATTRIBUTES'", "damaged"},
        {"'byteLength':40,'byteStride':12,'count':9,'mode':'ATTRIBUTES'", "9 elements of 12"},
        {"'byteLength':40,'byteStride':6,'count':16,'mode':'ATTRIBUTES'", "do not fit mode"},
        {"'byteLength':40,'byteStride':12,'count':8,'mode':'TRIANGLES'", "do not fit mode"},
        {"'byteLength':40,'byteStride':12,'count':8,'mode':'ATTRIBUTES','filter':'QUATERNION'",
         "do not fit mode"},
        {"'byteLength':40,'byteStride':12,'count':8,'mode':'SQUEEZED'", "mode is \"SQUEEZED\""},
        {"'byteLength':400,'byteStride':12,'count':8,'mode':'ATTRIBUTES'", "reaches from byte"},
        {"'byteStride':12,'count':8,'mode':'ATTRIBUTES'", "byteLength is missing"},
    };
    const Pack cube = PackCube();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        char json[2048];
        (void)snprintf(json, sizeof json,
                       "{" ASSET "'extensionsRequired':['EXT_meshopt_compression'],'buffers':["
                       "{'byteLength':168},{'byteLength':96}],'bufferViews':[{'buffer':1,"
                       "'byteLength':96,'extensions':{'EXT_meshopt_compression':{'buffer':0,%s}}},"
                       "{'buffer':0,'byteOffset':96,'byteLength':72}]," CUBE_ACCESSORS CUBE_MESH
                       ",'nodes':[{'mesh':0}]}",
                       cases[i].extension);
        CheckRefused(f, LoadGlb(f, json, &cube), PVT_INVALID_INPUT, cases[i].reason);
        CheckMessage(f->context, "bufferViews[0].extensions.EXT_meshopt_compression");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_glb_gives_the_cube_that_it_holds),
        TEST(contents_decide_whether_it_is_glb_or_json),
        TEST(transforms_compose_from_the_root_down),
        TEST(quarter_turns_by_quaternion_and_by_matrix_are_the_same),
        TEST(mirrored_nodes_stay_wound_outwards),
        TEST(instances_of_a_mesh_share_its_number),
        TEST(a_chain_of_3000_nodes_is_walked),
        TEST(scenes_and_nodes_are_chosen),
        TEST(every_index_width_and_mode_gives_the_quad),
        TEST(stitches_of_a_strip_are_not_triangles),
        TEST(points_lines_and_spare_indices_are_passed_over),
        TEST(triangles_need_no_indices),
        TEST(a_position_used_by_two_primitives_is_kept_once),
        TEST(interleaved_positions_are_strided),
        TEST(sparse_values_replace_those_below),
        TEST(quantized_positions_are_unpacked),
        TEST(triangles_that_are_not_finite_are_dropped_with_a_warning),
        TEST(materials_that_let_light_through_are_left_out),
        TEST(skins_and_morphs_give_the_bind_pose_with_a_warning),
        TEST(a_skin_stands_where_the_joint_nearest_to_the_root_puts_it),
        TEST(integers_written_as_fractions_are_read),
        TEST(copies_by_extension_are_instances),
        TEST(compressed_views_hold_what_was_packed),
        TEST(compressed_views_are_checked_before_they_are_decoded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
