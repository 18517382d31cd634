// SPDX-License-Identifier: MIT
// KHR_draco_mesh_compression: what its data and its accessors say of each other, what becomes of
// data that is damaged, and a decoder that is not there, dies, lies or never ends.
#include "draco_encoder.h"
#include "encodings.h"
#include "gltf_fixture.h"

#include "io/draco_result.h"

#include <sys/stat.h>
#include <time.h>

typedef struct Cube {
    Plain plain;
    Pack pack; // two streams: by edges, then in sequence
    size_t edgesSize, sequenceSize;
    size_t edgesPoints;
} Cube;

static Cube* MakeCube(void)
{
    Cube* cube = calloc(1, sizeof *cube);
    assert_non_null(cube);
    pvtVec3 positions[8];
    uint32_t indices[36];
    for (int i = 0; i < 8; ++i) {
        const float* p = kCubePositions[i];
        positions[i] = (pvtVec3){(double)p[0], (double)p[1], (double)p[2]};
    }
    for (int i = 0; i < 36; ++i) {
        indices[i] = kCubeIndices[i];
    }
    cube->plain = MakePlain(&(pvtMesh){positions, indices, 8, 12});
    size_t points = 0;
    cube->edgesSize = PackDraco(&cube->plain, false, 0, &cube->pack, &cube->edgesPoints);
    cube->sequenceSize = PackDraco(&cube->plain, true, 0, &cube->pack, &points);
    assert_int_equal(cube->edgesPoints, 8);
    assert_int_equal(points, 8);
    return cube;
}

static void FreeCube(Cube* cube)
{
    Plain_Free(&cube->plain);
    free(cube);
}

#define DRACO "KHR_draco_mesh_compression"
#define EXTENSION "'extensions':{'" DRACO "':{'bufferView':0,'attributes':{'POSITION':1}}}"
#define PLACE "meshes[0].primitives[0].extensions." DRACO

// The cube by its first stream, or by its second.
static void PrintCube(const Cube* cube, bool isSequence, char json[2048])
{
    (void)snprintf(json, 2048,
                   "{" ASSET "'extensionsRequired':['" DRACO "'],'buffers':[{'byteLength':%zu}],"
                   "'bufferViews':[{'buffer':0,'byteOffset':%zu,'byteLength':%zu}],"
                   "'accessors':[{'componentType':5126,'count':8,'type':'VEC3','min':[0,0,0],"
                   "'max':[1,1,1]},{'componentType':5123,'count':36,'type':'SCALAR'}],"
                   "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1," EXTENSION
                   "}]}],'nodes':[{'mesh':0}]}",
                   cube->pack.size, isSequence ? cube->edgesSize : (size_t)0,
                   isSequence ? cube->sequenceSize : cube->edgesSize);
}

static pvtStatus LoadDraco(Fixture* f, const Cube* cube, bool isSequence)
{
    char json[2048];
    PrintCube(cube, isSequence, json);
    return LoadGlb(f, json, &cube->pack);
}

static void a_compressed_cube_is_the_cube(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    for (int isSequence = 0; isSequence < 2; ++isSequence) {
        CHECK_OK(f->context, LoadDraco(f, cube, isSequence == 1));
        assert_int_equal(f->model.mesh.triangleCount, 12);
        assert_int_equal(f->model.mesh.positionCount, 8);
        CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, 0.0);
        CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
        assert_string_equal(f->warnings.text, "");
    }
    FreeCube(cube);
}

// Compressed and plain primitives, in one mesh and in two, two of them by the same accessors.
static void primitives_are_told_apart(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    PackPadding(&cube->pack, 0);
    const size_t plainAt = cube->pack.size;
    const Pack plain = PackCube();
    PackBytes(&cube->pack, plain.bytes, plain.size);
    char json[2048];
    (void)snprintf(json, sizeof json,
                   "{" ASSET "'extensionsUsed':['" DRACO "'],'buffers':[{'byteLength':%zu}],"
                   "'bufferViews':[{'buffer':0,'byteLength':%zu},{'buffer':0,'byteOffset':%zu,"
                   "'byteLength':96},{'buffer':0,'byteOffset':%zu,'byteLength':72},{'buffer':0,"
                   "'byteOffset':%zu,'byteLength':%zu}],'accessors':[{'componentType':5126,"
                   "'count':8,'type':'VEC3'},{'componentType':5123,'count':36,'type':'SCALAR'},"
                   "{'bufferView':1,'componentType':5126,'count':8,'type':'VEC3'},{'bufferView':2,"
                   "'componentType':5123,'count':36,'type':'SCALAR'}],'meshes':[{'primitives':["
                   "{'attributes':{'POSITION':2},'indices':3},{'attributes':{'POSITION':0},"
                   "'indices':1," EXTENSION "},{'attributes':{'POSITION':0},'indices':1,"
                   "'extensions':{'" DRACO "':{'bufferView':3,'attributes':{'POSITION':1}}}}]},"
                   "{'primitives':[{'attributes':{'POSITION':0}," EXTENSION "}]}],'nodes':["
                   "{'mesh':0},{'mesh':1,'translation':[5,0,0]}]}",
                   cube->pack.size, cube->edgesSize, plainAt, plainAt + 96, cube->edgesSize,
                   cube->sequenceSize);
    CHECK_OK(f->context, LoadGlb(f, json, &cube->pack));
    assert_int_equal(f->model.mesh.triangleCount, 48);
    assert_int_equal(f->model.mesh.positionCount, 32);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 4.0, 1e-12);
    FreeCube(cube);
}

// Data that was a strip is stored as a list, and its indices' count says nothing of it.
static void a_strip_is_read_as_the_list_that_it_is_stored_as(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    char json[2048], strip[2048];
    PrintCube(cube, false, json);
    const char* at = strstr(json, "'indices':1,");
    assert_non_null(at);
    (void)snprintf(strip, sizeof strip, "%.*s'mode':5,%s", (int)(at - json), json, at);
    CHECK_OK(f->context, LoadGlb(f, strip, &cube->pack));
    assert_int_equal(f->model.mesh.triangleCount, 12);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
    FreeCube(cube);
}

typedef struct Lie {
    const char* truth;
    const char* lie;
    const char* reason;
    pvtStatus status; // 0: PVT_INVALID_INPUT
} Lie;

static void CheckLies(Fixture* f, const Cube* cube, bool isSequence, const Lie* lies, size_t count)
{
    char json[2048], changed[2048];
    PrintCube(cube, isSequence, json);
    for (size_t i = 0; i < count; ++i) {
        const char* at = strstr(json, lies[i].truth);
        assert_non_null(at);
        (void)snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - json), json, lies[i].lie,
                       at + strlen(lies[i].truth));
        const pvtStatus expected = lies[i].status != 0 ? lies[i].status : PVT_INVALID_INPUT;
        CheckRefused(f, LoadGlb(f, changed, &cube->pack), expected, lies[i].reason);
    }
}

static void what_the_file_says_of_its_streams_is_checked(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    static const Lie lies[] = {
        {"'count':36", "'count':33",
         PLACE " says that it holds 12 triangles, but accessors[1] counts 33 indices", 0},
        {"'count':36", "'count':37", "make no whole triangles", 0},
        {"'count':36", "'count':3000000000000", PLACE " says that it holds 12 triangles", 0},
        {"'count':8", "'count':9", PLACE " holds 8 points and 12 triangles", 0},
        {"'count':8,'type':'VEC3','min':[0,0,0],'max':[1,1,1]},{'componentType':5123",
         "'count':900000000,'type':'VEC3'},{'componentType':5125", "memory limit", PVT_LIMIT},
        {"'count':8", "'count':70000", "which indices of accessors[1].componentType 5123", 0},
        {"'POSITION':1", "'POSITION':7",
         PLACE ".attributes.POSITION is 7, but the data has no attribute of that id", 0},
        {"'POSITION':1", "'POSITION':0",
         PLACE ".attributes.POSITION: its data has 1 components of FLOAT, but accessors[0] 3 of",
         0},
        {"'POSITION':1", "'POSITION':4294967296", PLACE ".attributes.POSITION is 4294967296", 0},
        {"'POSITION':1", "'POSITION':'one'", PLACE ".attributes.POSITION is not an integer", 0},
        {"'POSITION':1", "'NORMAL':1", PLACE ".attributes.NORMAL is not among", 0},
        {"{'POSITION':1}", "{}", PLACE ".attributes has no POSITION", 0},
        {"{'POSITION':1}", "[1]", PLACE ".attributes is not an object", 0},
        {"'componentType':5126", "'componentType':5123",
         "3 components of FLOAT, but accessors[0] 3 of UNSIGNED_SHORT", 0},
        {"'type':'VEC3','min':[0,0,0],'max':[1,1,1]", "'type':'VEC2'", "has 3 components", 0},
        {"{'bufferView':0,'attributes'", "{'bufferView':1,'attributes'",
         PLACE ".bufferView is 1, but there are only 1", 0},
        {"{'bufferView':0,'attributes'", "{'attributes'", PLACE ".bufferView is missing", 0},
        {"'max':[1,1,1]", "'max':[1,0.5,1]", "meshes[0].primitives[0].attributes.POSITION", 0},
        {"'indices':1,", "'indices':1,'mode':6,", "mode is 6", 0},
        {"'byteOffset':0", "'byteOffset':1", PLACE ": its buffer view holds no Draco data", 0},
    };
    CheckLies(f, cube, false, lies, sizeof lies / sizeof lies[0]);
    static const Lie ofSequence[] = {
        {"'count':8", "'count':9", PLACE " says that it holds 8 points, but accessors[0]", 0},
    };
    CheckLies(f, cube, true, ofSequence, 1);
    FreeCube(cube);
}

static void a_point_cloud_is_refused(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    const DracoSource source = {
        .positions = &cube->plain.positions[0][0], .pointCount = 8, .isCloud = true};
    size_t points = 0;
    cube->pack.size = 0;
    cube->edgesSize = EncodeDraco(&source, cube->pack.bytes, sizeof cube->pack.bytes, &points);
    cube->pack.size = cube->edgesSize;
    assert_true(cube->edgesSize > 0);
    CheckRefused(f, LoadDraco(f, cube, false), PVT_INVALID_INPUT,
                 PLACE ": its data is a point cloud");
    FreeCube(cube);
}

// Each byte wrong, and cut off anywhere: refused with the place, or another cube; never worse.
static void damaged_streams_do_no_harm(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    const Pack whole = cube->pack;
    int refused = 0;
    for (size_t i = 0; i < whole.size; i += i < 24 ? 1 : 5) {
        cube->pack.bytes[i] ^= 0x41;
        const pvtStatus status = LoadDraco(f, cube, i >= cube->edgesSize);
        assert_true(status == PVT_OK || status == PVT_INVALID_INPUT || status == PVT_LIMIT);
        if (status != PVT_OK) {
            CheckMessage(f->context, "meshes[0].primitives[0]");
            ++refused;
        }
        cube->pack = whole;
    }
    assert_true(refused > 20);
    const size_t size = cube->edgesSize;
    for (cube->edgesSize = 1; cube->edgesSize < size; cube->edgesSize += 7) {
        assert_int_equal(LoadDraco(f, cube, false), PVT_INVALID_INPUT);
        CheckMessage(f->context, PLACE);
    }
    FreeCube(cube);
}

// Puts a script in the decoder's place.
static void ReplaceDecoder(Fixture* f, const char* commands)
{
    char script[512];
    (void)snprintf(script, sizeof script, "#!/bin/sh\n%s\n", commands);
    const char* path = InFolder(&f->folder, "paravent-draco");
    WriteText(path, script);
    assert_int_equal(chmod(path, 0700), 0);
    assert_int_equal(setenv("PARAVENT_MODULE_PATH", f->folder.path, 1), 0);
}

static void a_decoder_that_fails_is_told_with_the_place(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    static const struct {
        const char* commands;
        pvtStatus status;
        const char* reason;
    } cases[] = {
        {"exit 3", PVT_INVALID_INPUT, PLACE ": Draco's decoder ended early (status 3)"},
        {"kill -SEGV $$", PVT_INVALID_INPUT, PLACE ": Draco crashed over it"},
        {"kill -XCPU $$", PVT_INVALID_INPUT, "took longer than"},
        {"kill -KILL $$", PVT_LIMIT, "took more memory"},
        {"head -c 700 /dev/zero >&4", PVT_INVALID_INPUT, "ended early"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        ReplaceDecoder(f, cases[i].commands);
        CheckRefused(f, LoadDraco(f, cube, false), cases[i].status, cases[i].reason);
    }
    assert_int_equal(unsetenv("PARAVENT_MODULE_PATH"), 0);
    FreeCube(cube);
}

// What the decoder's process would say of the cube.
typedef struct Result {
    pvtDracoHeader header;
    pvtDracoMesh mesh;
    pvtDracoAttribute attribute;
    uint32_t indices[36];
    float positions[24];
} Result;

static pvtStatus LoadResult(Fixture* f, const Cube* cube, const Result* result)
{
    char commands[256];
    WriteBytes(InFolder(&f->folder, "result"), result, sizeof *result);
    (void)snprintf(commands, sizeof commands, "cat '%s/result' >&4", f->folder.path);
    ReplaceDecoder(f, commands);
    const pvtStatus status = LoadDraco(f, cube, false);
    assert_int_equal(unsetenv("PARAVENT_MODULE_PATH"), 0);
    return status;
}

static void a_decoder_that_lies_is_not_believed(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    Result result = {
        .header = {.magic = PVT_DRACO_MAGIC, .version = PVT_DRACO_VERSION},
        .mesh = {.faceCount = 12, .indices = offsetof(Result, indices)},
        .attribute = {.isFound = 1,
                      .componentType = 5126,
                      .componentCount = 3,
                      .data = offsetof(Result, positions)},
    };
    memcpy(result.indices, cube->plain.indices, sizeof result.indices);
    memcpy(result.positions, cube->plain.positions, sizeof result.positions);
    CHECK_OK(f->context, LoadResult(f, cube, &result));
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 1.0, 0.0);
    const Result sound = result;
    // Far off and just off.
    static const size_t places[] = {
        offsetof(Result, mesh.faceCount), offsetof(Result, mesh.indices),
        offsetof(Result, attribute.data), offsetof(Result, indices[35])};
    static const uint64_t lies[] = {0xffffffffffffffff, 0x7fffffff00000000, 600};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; ++i) {
        for (size_t k = 0; k < sizeof lies / sizeof lies[0]; ++k) {
            memcpy((char*)&result + places[i], &lies[k], i == 3 ? 4 : 8);
            const pvtStatus status = LoadResult(f, cube, &result);
            if (memcmp(&result, &sound, sizeof sound) != 0 && status == PVT_OK) {
                // Offsets that still lie in the result give other numbers, but no other harm.
                assert_true(i == 1 || i == 2 || (i == 3 && k == 1));
            }
            result = sound;
        }
    }
    result.mesh.faceCount = 11;
    CheckRefused(f, LoadResult(f, cube, &result), PVT_INVALID_INPUT, "11 triangles instead of 12");
    result = sound;
    result.attribute.componentCount = 4;
    CheckRefused(f, LoadResult(f, cube, &result), PVT_INVALID_INPUT, "");
    FreeCube(cube);
}

static bool HasElapsed(void* user)
{
    struct timespec now, *end = user;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec > end->tv_sec || (now.tv_sec == end->tv_sec && now.tv_nsec > end->tv_nsec);
}

static void decoding_stops_when_asked(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    char json[2048];
    PrintCube(cube, false, json);
    WriteGlb(InFolder(&f->folder, "model.glb"), json, &cube->pack);
    ReplaceDecoder(f, "exec sleep 60");
    struct timespec begin, end, after;
    (void)clock_gettime(CLOCK_MONOTONIC, &begin);
    end = begin;
    end.tv_nsec += 100000000;
    if (end.tv_nsec >= 1000000000) {
        end.tv_nsec -= 1000000000;
        ++end.tv_sec;
    }
    pvtContextDef def = pvtDefaultContextDef();
    def.isCancelled = HasElapsed;
    def.user = &end;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    pvtModel model;
    assert_int_equal(pvtLoadModel(context, NULL, InFolder(&f->folder, "model.glb"), &model),
                     PVT_CANCELLED);
    (void)clock_gettime(CLOCK_MONOTONIC, &after);
    // Half of what the decoder would sleep, for a machine that is busy with other things.
    assert_true(after.tv_sec - begin.tv_sec < 30);
    assert_int_equal(unsetenv("PARAVENT_MODULE_PATH"), 0);
    DestroyTestContext(context);
    FreeCube(cube);
}

static void every_failing_allocation_is_reported(void** state)
{
    Fixture* f = *state;
    Cube* cube = MakeCube();
    char json[2048];
    PrintCube(cube, false, json);
    WriteGlb(InFolder(&f->folder, "model.glb"), json, &cube->pack);
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int failAt = 1; status != PVT_OK; ++failAt) {
        PoorHeap heap = {.failAt = failAt};
        pvtContext* context = CreatePoorContext(&heap);
        pvtModel model;
        status = pvtLoadModel(context, NULL, InFolder(&f->folder, "model.glb"), &model);
        assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
        pvtModel_Free(context, &model);
        assert_true(failAt < 100);
        DestroyTestContext(context);
    }
    FreeCube(cube);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_compressed_cube_is_the_cube),
        TEST(primitives_are_told_apart),
        TEST(a_strip_is_read_as_the_list_that_it_is_stored_as),
        TEST(what_the_file_says_of_its_streams_is_checked),
        TEST(a_point_cloud_is_refused),
        TEST(damaged_streams_do_no_harm),
        TEST(a_decoder_that_fails_is_told_with_the_place),
        TEST(a_decoder_that_lies_is_not_believed),
        TEST(decoding_stops_when_asked),
        TEST(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
