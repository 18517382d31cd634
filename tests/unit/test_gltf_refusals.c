// SPDX-License-Identifier: MIT
// glTF as it may not be: lies, damage, cycles, links out of the folder. Each is refused with the
// file, the place and the reason.
#include "gltf_fixture.h"

#include "io/source.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>

static void cycles_and_second_parents_are_refused(void** state)
{
    Fixture* f = *state;
    CheckRefused(f, LoadCube(f, CUBE_NODES("{'mesh':0},{'children':[2]},{'children':[1]}")),
                 PVT_INVALID_INPUT, "nodes[1] is an ancestor of itself");
    CheckRefused(f, LoadCube(f, CUBE_NODES("{'children':[0],'mesh':0}")), PVT_INVALID_INPUT,
                 "nodes[0] is an ancestor of itself");
    CheckRefused(f, LoadCube(f, CUBE_NODES("{'children':[1,2]},{'children':[2]},{'mesh':0}")),
                 PVT_INVALID_INPUT, "nodes[2] is a child of nodes[0] and of nodes[1]");
    CheckRefused(f, LoadCube(f, CUBE_NODES("{'children':[1,1]},{'mesh':0}")), PVT_INVALID_INPUT,
                 "nodes[1] is a child of");
    CheckRefused(f,
                 LoadCube(f, "{" CUBE_DATA ",'scenes':[{'nodes':[1]}],"
                             "'nodes':[{'children':[1]},{'mesh':0}]}"),
                 PVT_INVALID_INPUT, "not a root");
    CheckRefused(f, LoadCube(f, "{" CUBE_DATA ",'scenes':[{'nodes':[0,0]}],'nodes':[{'mesh':0}]}"),
                 PVT_INVALID_INPUT, "twice");
}

static void extensions_that_are_required_and_unknown_are_named(void** state)
{
    Fixture* f = *state;
    CheckRefused(f,
                 LoadCube(f, "{'extensionsRequired':['KHR_materials_unlit','ACME_cubes']"
                             "," CUBE_DATA ",'nodes':[{'mesh':0}]}"),
                 PVT_UNSUPPORTED, "ACME_cubes");
    CHECK_OK(f->context, LoadCube(f, "{'extensionsRequired':['KHR_materials_unlit']"
                                     "," CUBE_DATA ",'nodes':[{'mesh':0}]}"));
    CHECK_OK(f->context, LoadCube(f, "{'extensionsUsed':['ACME_cubes']"
                                     "," CUBE_DATA ",'nodes':[{'mesh':0}]}"));
}

// One thing wrong with the cube, and what the message says of it.
typedef struct Lie {
    const char* truth;
    const char* lie;
    const char* reason;
    pvtStatus status;
} Lie;

static void CheckLie(Fixture* f, const char* json, const Pack* binary, const Lie* lie)
{
    const char* at = strstr(json, lie->truth);
    assert_non_null(at);
    char changed[2048];
    (void)snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - json), json, lie->lie,
                   at + strlen(lie->truth));
    CheckRefused(f, LoadGlb(f, changed, binary),
                 lie->status != PVT_OK ? lie->status : PVT_INVALID_INPUT, lie->reason);
}

static void lies_are_refused_with_their_place_and_reason(void** state)
{
    Fixture* f = *state;
    const Pack cube = PackCube();
    const Lie lies[] = {
        {"'byteLength':168", "'byteLength':172", "buffers[0].byteLength is 172", 0},
        {"'byteLength':168", "'byteLength':4294967464", "buffers[0].byteLength is 4294967464", 0},
        {"'byteLength':168", "'byteLength':-1", "buffers[0].byteLength is -1", 0},
        {"'byteLength':168", "'byteLength':'168'", "not an integer", 0},
        {"'byteLength':168", "'byteLength':1e999", "JSON", 0},
        {"'byteLength':96", "'byteLength':95", "accessors[0] counts 8 elements", 0},
        {"'byteOffset':96", "'byteOffset':97", "bufferViews[1] reaches", 0},
        {"'byteOffset':96", "'byteOffset':18446744073709551600", "bufferViews[1].byteOffset", 0},
        {"'count':8", "'count':9", "accessors[0] counts 9 elements", 0},
        {"'count':8", "'count':281474976710655", "accessors[0] counts", 0},
        {"'count':8", "'count':4.5", "accessors[0].count is not an integer", 0},
        {"'count':8", "'count':7", "is 7, but there are only 7 positions", 0},
        {"'count':36", "'count':37", "accessors[1] counts 37", 0},
        {"'componentType':5126", "'componentType':5124", "accessors[0].componentType is 5124", 0},
        {"'componentType':5126", "'componentType':5130", "accessors[0].componentType is 5130", 0},
        {"'componentType':5123", "'componentType':5126", "accessors[1] counts 36 elements", 0},
        {"'componentType':5123", "'componentType':5122", "meshes[0].primitives[0].indices are", 0},
        {"'type':'VEC3'", "'type':'VEC5'", "accessors[0].type is \"VEC5\"", 0},
        {"'type':'VEC3'", "'type':'VEC2'",
         "meshes[0].primitives[0].attributes.POSITION is a VEC2 of FLOAT", 0},
        {"'bufferView':0", "'bufferView':2", "accessors[0].bufferView is 2", 0},
        {"'buffer':0", "'buffer':1", "bufferViews[0].buffer is 1", 0},
        {"'POSITION':0", "'POSITION':2", "primitives[0].attributes.POSITION is 2", 0},
        {"'POSITION':0", "'NORMAL':0", "1 without a POSITION", 0},
        {"'indices':1", "'indices':2", "meshes[0].primitives[0].indices is 2", 0},
        {"'indices':1", "'indices':4294967297", "meshes[0].primitives[0].indices", 0},
        {"'indices':1", "'indices':'1'", "meshes[0].primitives[0].indices is not an integer", 0},
        {"'indices':1", "'indices':1,'material':0", "material is 0, but there are only 0", 0},
        {"'mesh':0", "'mesh':1", "nodes[0].mesh is 1", 0},
        {"'mesh':0", "'mesh':0,'skin':0", "nodes[0].skin is 0", 0},
        {"'mesh':0", "'mesh':0,'children':[1]", "nodes[0].children[0] is 1", 0},
        {"'mesh':0", "'mesh':0,'scale':[1,1]", "nodes[0].scale is not a list of 3", 0},
        {"'mesh':0", "'mesh':0,'matrix':[1,2,3]", "nodes[0].matrix is not a list of 16", 0},
        {"'nodes':[0]", "'nodes':[1]", "scenes[0].nodes[0] is 1", 0},
        {"'scenes':[", "'scene':1,'scenes':[", "scene is 1", 0},
        {"'meshes':[", "'meshes':{},'x':[", "meshes is not a list", 0},
        {"'version':'2.0'", "'version':'1.0'", "version 1.0", PVT_UNSUPPORTED},
        {"'version':'2.0'", "'version':'2.0','minVersion':'2.7'", "2.7", PVT_UNSUPPORTED},
        {"'asset'", "'esset'", "no asset", 0},
        {"'version'", "'virsion'", "asset.version is missing", 0},
        {"}]}]", "}]}", "JSON is not valid", 0},
    };
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; ++i) {
        CheckLie(f, CUBE, &cube, &lies[i]);
    }
}

static void a_range_that_the_positions_leave_is_refused(void** state)
{
    Fixture* f = *state;
    const Pack cube = PackCube();
    const Lie lies[] = {
        {"'count':8", "'count':8,'min':[0,0,0],'max':[1,0.5,1]",
         "meshes[0].primitives[0].attributes.POSITION: element 2 has y = 1, but accessors[0].max "
         "says that it is at most 0.5",
         0},
        {"'count':8", "'count':8,'min':[0,0,0.25],'max':[1,1,1]",
         "meshes[0].primitives[0].attributes.POSITION: element 0 has z = 0, but accessors[0].min "
         "says that it is at least 0.25",
         0},
        {"'count':8", "'count':8,'min':[0,0,0],'max':[1,1,-1]",
         "meshes[0].primitives[0].attributes.POSITION: accessors[0].min[2] is 0, which is more "
         "than max, -1",
         0},
        {"'count':8", "'count':8,'min':[0,0]", "accessors[0].min has 2 numbers", 0},
    };
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; ++i) {
        CheckLie(f, CUBE, &cube, &lies[i]);
    }
}

static void a_stride_below_the_element_is_refused(void** state)
{
    Fixture* f = *state;
    const Pack cube = PackCube();
    const Lie lies[] = {
        {"'byteLength':96", "'byteLength':96,'byteStride':8", "byteStride is 8", 0},
        {"'byteLength':96", "'byteLength':96,'byteStride':256", "byteStride is 256", 0},
        {"'byteLength':96", "'byteLength':96,'byteStride':16", "accessors[0] counts 8", 0},
    };
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; ++i) {
        CheckLie(f, CUBE, &cube, &lies[i]);
    }
}

static void indices_out_of_range_are_refused(void** state)
{
    Fixture* f = *state;
    Pack cube = PackCube();
    const uint16_t bad = 8;
    memcpy(cube.bytes + 96 + 2 * 35, &bad, 2);
    CheckRefused(
        f, LoadGlb(f, CUBE, &cube), PVT_INVALID_INPUT,
        "meshes[0].primitives[0].indices: element 35 (of accessors[1]) is 8, but there are only 8");
}

static void counts_without_data_are_limited(void** state)
{
    Fixture* f = *state;
    CheckRefused(f,
                 LoadGlb(f,
                         "{" ASSET "'accessors':[{'componentType':5126,'count':4000000000,"
                         "'type':'VEC3'}],'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}]"
                         ",'nodes':[{'mesh':0}]}",
                         NULL),
                 PVT_LIMIT, "accessors[0] counts 4000000000");
    // Zeroes are valid as long as they are few: three equal positions.
    CHECK_OK(f->context,
             LoadGlb(f,
                     "{" ASSET "'accessors':[{'componentType':5126,'count':3,'type':'VEC3'},"
                     "{'componentType':5123,'count':3,'type':'SCALAR'}],'meshes':[{'primitives':["
                     "{'attributes':{'POSITION':0},'indices':1}]}],'nodes':[{'mesh':0}]}",
                     NULL));
    assert_int_equal(f->model.mesh.triangleCount, 1);
}

static void instances_beyond_the_memory_limit_are_refused_before_they_are_made(void** state)
{
    Fixture* f = *state;
    char* json = malloc(1 << 16);
    assert_non_null(json);
    int used = sprintf(json, "{" ASSET "'accessors':[{'componentType':5126,'count':3000000,"
                             "'type':'VEC3'}],'meshes':[{'primitives':[{'attributes':"
                             "{'POSITION':0}}]}],'nodes':[{'mesh':0}");
    for (int i = 0; i < 500; ++i) {
        used += sprintf(json + used, ",{'mesh':0}");
    }
    (void)sprintf(json + used, "]}");
    CheckRefused(f, LoadGlb(f, json, NULL), PVT_LIMIT, "model");
    free(json);
    CheckMessage(f->context, "memory limit");
}

static void PatchU32(Pack* pack, size_t at, uint32_t value)
{
    memcpy(pack->bytes + at, &value, sizeof value);
}

static void a_damaged_container_is_refused(void** state)
{
    Fixture* f = *state;
    const Pack cube = PackCube();
    Pack* glb = calloc(1, sizeof *glb);
    char* json = MakeJson(CUBE);
    PackGlb(glb, json, &cube);
    const Pack whole = *glb;
    uint32_t jsonSize;
    memcpy(&jsonSize, whole.bytes + 12, 4);
    const struct {
        size_t at;
        uint32_t value;
        pvtStatus status;
        const char* reason;
    } patches[] = {
        {4, 1, PVT_UNSUPPORTED, "GLB version 1"},
        {8, (uint32_t)whole.size + 4, PVT_INVALID_INPUT, "cut short"},
        {8, 0xffffffff, PVT_INVALID_INPUT, "cut short"},
        {8, 12, PVT_INVALID_INPUT, "too few"},
        {12, 0xfffffff0, PVT_INVALID_INPUT, "chunk 0 of the GLB says 4294967280 bytes"},
        {16, 0x004e4942, PVT_INVALID_INPUT, "not JSON"},
        {20 + jsonSize, 0x7fffffff, PVT_INVALID_INPUT, "chunk 1 of the GLB"},
        {20 + jsonSize + 4, 0x12345678, PVT_INVALID_INPUT, "buffers[0]"},
    };
    for (size_t i = 0; i < sizeof patches / sizeof patches[0]; ++i) {
        *glb = whole;
        PatchU32(glb, patches[i].at, patches[i].value);
        WriteBytes(InFolder(&f->folder, "model.glb"), glb->bytes, glb->size);
        CheckRefused(f, LoadFile(f, "model.glb"), patches[i].status, patches[i].reason);
    }
    // Cut off anywhere: never a crash, never a model.
    for (size_t size = 0; size < whole.size; size += size < 24 ? 1 : 7) {
        WriteBytes(InFolder(&f->folder, "model.glb"), whole.bytes, size);
        assert_int_equal(LoadFile(f, "model.glb"), PVT_INVALID_INPUT);
        CheckMessage(f->context, "model.glb");
    }
    // Bytes behind the end do no harm.
    *glb = whole;
    PackU32(glb, 0xdeadbeef);
    WriteBytes(InFolder(&f->folder, "model.glb"), glb->bytes, glb->size);
    CHECK_OK(f->context, LoadFile(f, "model.glb"));
    free(json);
    free(glb);
}

static void deep_nesting_is_refused_before_it_is_parsed(void** state)
{
    Fixture* f = *state;
    enum { DEPTH = 20000 };
    char* json = malloc(2 * DEPTH + 64);
    assert_non_null(json);
    const int used = sprintf(json, "{\"asset\":{\"version\":\"2.0\"},\"x\":");
    memset(json + used, '[', DEPTH);
    memset(json + used + DEPTH, ']', DEPTH);
    memcpy(json + used + 2 * DEPTH, "}", 2);
    WriteText(InFolder(&f->folder, "model.gltf"), json);
    CheckRefused(f, LoadFile(f, "model.gltf"), PVT_INVALID_INPUT, "deeper than 64");
    free(json);
    // Brackets in a string nest nothing.
    CHECK_OK(f->context,
             LoadCube(f, CUBE_NODES("{'mesh':0,'name':'[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[["
                                    "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[{{{{{{{{{{{{{{{{{{{{'}")));
}

static pvtStatus LoadUri(Fixture* f, const char* uri, size_t length)
{
    char json[4096];
    (void)snprintf(json, sizeof json,
                   "{" ASSET "'buffers':[{'byteLength':%zu,'uri':'%s'}],'bufferViews':[{'buffer':0,"
                   "'byteLength':%zu}],'accessors':[{'bufferView':0,'componentType':5126,"
                   "'count':3,'type':'VEC3'}],'meshes':[{'primitives':[{'attributes':"
                   "{'POSITION':0}}]}],'nodes':[{'mesh':0}]}",
                   length, uri, length);
    char* quoted = MakeJson(json);
    WriteText(InFolder(&f->folder, "model.gltf"), quoted);
    free(quoted);
    return LoadFile(f, "model.gltf");
}

static void nothing_outside_of_the_folder_is_read(void** state)
{
    Fixture* f = *state;
    const char* outside = "leaves the model's folder";
    CheckRefused(f, LoadUri(f, "../../../etc/passwd", 36), PVT_INVALID_INPUT, outside);
    CheckRefused(f, LoadUri(f, "%2e%2e/%2E./etc/passwd", 36), PVT_INVALID_INPUT, outside);
    CheckRefused(f, LoadUri(f, "/etc/passwd", 36), PVT_INVALID_INPUT, outside);
    CheckRefused(f, LoadUri(f, "file:///etc/passwd", 36), PVT_INVALID_INPUT, "nothing is fetched");
    CheckRefused(f, LoadUri(f, "http://example.org/a.bin", 36), PVT_INVALID_INPUT,
                 "nothing is fetched");
    CheckRefused(f, LoadUri(f, "a%00b", 36), PVT_INVALID_INPUT, "not the name of a file");
    CheckRefused(f, LoadUri(f, "", 36), PVT_INVALID_INPUT, "not the name of a file");
    CheckRefused(f, LoadUri(f, "gone.bin", 36), PVT_INVALID_INPUT, "no such file");
    CheckRefused(f, LoadUri(f, ".", 36), PVT_INVALID_INPUT, "is a folder");
    assert_int_equal(symlink("/etc/passwd", InFolder(&f->folder, "link.bin")), 0);
    CheckRefused(f, LoadUri(f, "link.bin", 36), PVT_INVALID_INPUT, outside);
    assert_int_equal(mkfifo(InFolder(&f->folder, "pipe.bin"), 0600), 0);
    CheckRefused(f, LoadUri(f, "pipe.bin", 36), PVT_INVALID_INPUT, "is a pipe");
    WriteText(InFolder(&f->folder, "short.bin"), "0123456789");
    CheckRefused(f, LoadUri(f, "short.bin", 36), PVT_INVALID_INPUT, "has only 10 bytes");
}

static void the_walk_by_parts_keeps_to_the_folder_too(void** state)
{
    Fixture* f = *state;
    assert_int_equal(mkdir(InFolder(&f->folder, "sub"), 0700), 0);
    WriteText(InFolder(&f->folder, "sub/file"), "inside");
    assert_int_equal(symlink("/etc", InFolder(&f->folder, "sub/etc")), 0);
    const int folder = open(f->folder.path, O_PATH | O_DIRECTORY);
    assert_true(folder >= 0);
    const char* const names[] = {"sub/file", "./sub//file"};
    for (size_t i = 0; i < 2; ++i) {
        char text[16] = {0};
        const int file = pvtOpenBeneathByParts(folder, names[i]);
        assert_true(file >= 0);
        assert_int_equal(read(file, text, sizeof text), 6);
        assert_string_equal(text, "inside");
        close(file);
    }
    const char* const bad[] = {"/etc/passwd", "../x", "sub/../../x", "sub/etc/passwd", "sub/etc"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        assert_int_equal(pvtOpenBeneathByParts(folder, bad[i]), -1);
        assert_true(errno == EXDEV || errno == ENOTDIR);
    }
    assert_int_equal(pvtOpenBeneathByParts(folder, ""), -1);
    close(folder);
    assert_int_equal(unlink(InFolder(&f->folder, "sub/file")), 0);
    assert_int_equal(unlink(InFolder(&f->folder, "sub/etc")), 0);
    assert_int_equal(rmdir(InFolder(&f->folder, "sub")), 0);
}

static void data_uris_are_decoded_strictly(void** state)
{
    Fixture* f = *state;
    // (0, 0, 0), (1, 0, 0), (0, 1, 0)
    const char* good = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAA"
                       "AAgD8AAAAA";
    CHECK_OK(f->context, LoadUri(f, good, 36));
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 0}, 0.0);
    char padded[256];
    (void)snprintf(padded, sizeof padded, "%sAA==", good);
    CHECK_OK(f->context, LoadUri(f, padded, 37));
    CheckRefused(f, LoadUri(f, padded, 38), PVT_INVALID_INPUT, "has only 37 bytes");
    CheckRefused(f, LoadUri(f, good, 40), PVT_INVALID_INPUT, "has only 36 bytes");
    CheckRefused(f, LoadUri(f, "data:;base64,AAAA*AAA", 6), PVT_INVALID_INPUT, "not base64");
    CheckRefused(f, LoadUri(f, "data:,AAAA", 3), PVT_INVALID_INPUT, "not in base64");
    CheckRefused(f, LoadUri(f, "data:", 3), PVT_INVALID_INPUT, "not in base64");
}

static void files_that_are_no_files_are_refused_at_once(void** state)
{
    Fixture* f = *state;
    pvtModel model;
    const pvtLoadOptions* options = &f->options;
    assert_int_equal(mkfifo(InFolder(&f->folder, "model.glb"), 0600), 0);
    CheckRefused(f, LoadFile(f, "model.glb"), PVT_INVALID_INPUT, "is a pipe");
    assert_int_equal(pvtLoadModel(f->context, options, "/dev/zero", &model), PVT_INVALID_INPUT);
    CheckMessage(f->context, "/dev/zero is a device");
    assert_int_equal(pvtLoadModel(f->context, options, f->folder.path, &model), PVT_INVALID_INPUT);
    CheckMessage(f->context, "is a folder");
    assert_int_equal(pvtLoadModel(f->context, options, "/nonexistent.glb", &model),
                     PVT_INVALID_INPUT);
    CheckMessage(f->context, "/nonexistent.glb cannot be read");
    WriteText(InFolder(&f->folder, "empty.glb"), "");
    assert_int_equal(LoadFile(f, "empty.glb"), PVT_INVALID_INPUT);
    CheckMessage(f->context, "empty.glb: the file is empty");
    WriteText(InFolder(&f->folder, "noise.glb"), "neither this nor that");
    assert_int_equal(LoadFile(f, "noise.glb"), PVT_INVALID_INPUT);
    CheckMessage(f->context, "neither GLB");
    WriteText(InFolder(&f->folder, "model.blend"), "something else");
    assert_int_equal(LoadFile(f, "model.blend"), PVT_UNSUPPORTED);
    f->options.maxBytes = 100;
    assert_int_equal(unlink(InFolder(&f->folder, "model.glb")), 0);
    CheckRefused(f, LoadCube(f, CUBE), PVT_LIMIT, "at most 100 bytes");
}

static void names_are_cleaned(void** state)
{
    Fixture* f = *state;
    CHECK_OK(f->context,
             LoadCube(f, CUBE_NODES("{'mesh':0,'name':'a\\u001b[2J\\n\xc3\xa9\\u0000hidden'}")));
    assert_string_equal(f->model.parts[0].name, "a?[2J?\xc3\xa9");
    // A file's own words do not reach the terminal as commands.
    CheckRefused(f, LoadCube(f, "{'extensionsRequired':['\\u001b[2J']," CUBE_DATA "}"),
                 PVT_UNSUPPORTED, "?[2J");
}

static pvtStatus LoadAndFree(pvtContext* context, const void* path)
{
    pvtLoadOptions options = pvtDefaultLoadOptions();
    options.keepMeshes = true;
    pvtModel model;
    const pvtStatus status = pvtLoadModel(context, &options, path, &model);
    assert_int_equal(model.mesh.triangleCount, status == PVT_OK ? 6 : 0);
    assert_true((model.meshes != NULL) == (status == PVT_OK));
    pvtModel_Free(context, &model);
    return status;
}

// With a position that is not finite, so that others have to be moved together.
static const char* WriteHalfACube(Fixture* f)
{
    const char* path = InFolder(&f->folder, "model.glb");
    Pack cube = PackCube();
    const float bad = NAN;
    memcpy(cube.bytes, &bad, sizeof bad);
    WriteGlb(path, CUBE, &cube);
    return path;
}

static void loading_stops_when_asked(void** state)
{
    CheckEveryCancel(LoadAndFree, WriteHalfACube(*state));
}

static void every_failing_allocation_is_reported(void** state)
{
    CheckEveryAllocation(LoadAndFree, WriteHalfACube(*state));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(cycles_and_second_parents_are_refused),
        TEST(extensions_that_are_required_and_unknown_are_named),
        TEST(lies_are_refused_with_their_place_and_reason),
        TEST(a_range_that_the_positions_leave_is_refused),
        TEST(a_stride_below_the_element_is_refused),
        TEST(indices_out_of_range_are_refused),
        TEST(counts_without_data_are_limited),
        TEST(instances_beyond_the_memory_limit_are_refused_before_they_are_made),
        TEST(a_damaged_container_is_refused),
        TEST(deep_nesting_is_refused_before_it_is_parsed),
        TEST(nothing_outside_of_the_folder_is_read),
        TEST(the_walk_by_parts_keeps_to_the_folder_too),
        TEST(data_uris_are_decoded_strictly),
        TEST(files_that_are_no_files_are_refused_at_once),
        TEST(names_are_cleaned),
        TEST(loading_stops_when_asked),
        TEST(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
