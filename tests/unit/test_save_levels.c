// SPDX-License-Identifier: MIT
// Levels in glTF: how they are linked, and an original that comes out whole beside them.
#include "gltf_fixture.h"

enum { LEVELS = 3 };

// Three cubes, each larger and placed further on than the one before.
typedef struct Levels {
    pvtMesh meshes[LEVELS];
    pvtSaveItem items[LEVELS];
    double coverages[LEVELS];
    pvtLevelSet set;
} Levels;

static void MakeLevels(pvtContext* context, Levels* levels)
{
    static const char* const names[LEVELS] = {"fine", "middle", "coarse"};
    *levels = (Levels){.coverages = {0.5, 0.125, 0.0}};
    for (int level = 0; level < LEVELS; ++level) {
        pvtVec3 positions[8];
        uint32_t indices[36];
        for (int i = 0; i < 8; ++i) {
            const float* p = kCubePositions[i];
            positions[i] = (pvtVec3){10.0 + (level + 1) * (double)p[0], (level + 1) * (double)p[1],
                                     (level + 1) * (double)p[2]};
        }
        for (int i = 0; i < 36; ++i) {
            indices[i] = kCubeIndices[i];
        }
        CHECK_OK(context,
                 pvtCreateMesh(context, positions, 8, indices, 12, &levels->meshes[level]));
        levels->items[level] = (pvtSaveItem){.name = names[level], .mesh = &levels->meshes[level]};
    }
    levels->set = (pvtLevelSet){
        .levels = levels->items, .levelCount = LEVELS, .coverages = levels->coverages, .scene = -1};
}

static void FreeLevels(pvtContext* context, Levels* levels)
{
    for (int i = 0; i < LEVELS; ++i) {
        pvtMesh_Free(context, &levels->meshes[i]);
    }
}

// The JSON of a file, without white space; freed by the caller.
static char* ReadJson(const char* path)
{
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    char* bytes = calloc(1, 1 << 20);
    assert_non_null(bytes);
    const size_t size = fread(bytes, 1, (1 << 20) - 1, file);
    assert_int_equal(fclose(file), 0);
    size_t at = 0, end = size;
    if (memcmp(bytes, "glTF", 4) == 0) {
        uint32_t length = 0;
        memcpy(&length, bytes + 12, sizeof length);
        at = 20;
        end = 20 + length;
    }
    size_t used = 0;
    for (; at < end; ++at) {
        if (bytes[at] != ' ' && bytes[at] != '\n') {
            bytes[used++] = bytes[at];
        }
    }
    bytes[used] = '\0';
    return bytes;
}

// Single quotes stand for double ones.
static void CheckJson(const char* path, const char* part)
{
    char* json = ReadJson(path);
    char* quoted = MakeJson(part);
    if (strstr(json, quoted) == NULL) {
        fail_msg("%s does not hold %s but %s", path, quoted, json);
    }
    free(quoted);
    free(json);
}

static void the_finest_node_names_the_others_and_alone_is_in_the_scene(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    for (int i = 0; i < 2; ++i) {
        const char* path = InFolder(&f->folder, i == 0 ? "levels.gltf" : "levels.glb");
        CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
        CheckJson(path, "'extensions':{'MSFT_lod':{'ids':[1,2]}}");
        CheckJson(path, "'MSFT_screencoverage':[0.5,0.125,0.0]");
        CheckJson(path, "'extensionsUsed':['MSFT_lod']");
        CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
        assert_int_equal(f->model.partCount, 1);
        assert_string_equal(f->model.parts[0].name, "fine");
        pvtModel_Free(f->context, &f->model);
    }
    FreeLevels(f->context, &levels);
}

static void plain_levels_are_all_in_the_scene(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    levels.set.coverages = NULL;
    const char* path = InFolder(&f->folder, "levels.glb");
    CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
    assert_int_equal(f->model.partCount, LEVELS);
    assert_string_equal(f->model.parts[2].name, "coarse");
    FreeLevels(f->context, &levels);
}

static void other_nodes_stand_in_front_of_the_levels(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    const pvtSaveItem others[2] = {{.name = "wall", .mesh = &levels.meshes[0]},
                                   {.name = "roof", .mesh = &levels.meshes[1]}};
    levels.set.others = others;
    levels.set.otherCount = 2;
    const char* path = InFolder(&f->folder, "levels.gltf");
    CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
    CheckJson(path, "'ids':[3,4]");
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
    assert_int_equal(f->model.partCount, 3);
    assert_string_equal(f->model.parts[0].name, "wall");
    assert_string_equal(f->model.parts[2].name, "fine");
    FreeLevels(f->context, &levels);
}

// A node has no shear: a copy of the mesh is moved.
static void levels_and_others_stand_where_their_transforms_say(void** state)
{
    Fixture* f = *state;
    static const double moved[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 30, 0, 0, 1};
    static const double sheared[16] = {1, 0, 0, 0, 0.5, 1, 0, 0, 0, 0, 1, 0, 0, 40, 0, 1};
    Levels levels;
    MakeLevels(f->context, &levels);
    pvtSaveItem items[LEVELS];
    memcpy(items, levels.set.levels, sizeof items);
    items[0].transform = sheared;
    const pvtSaveItem others[2] = {
        {.name = "wall", .mesh = &levels.meshes[0], .transform = moved},
        {.name = "roof", .mesh = &levels.meshes[0], .transform = sheared}};
    levels.set.levels = items;
    levels.set.others = others;
    levels.set.otherCount = 2;
    const char* path = InFolder(&f->folder, "levels.glb");
    CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
    assert_int_equal(f->model.partCount, 3);
    CHECK_NEAR(f->model.parts[0].transform[12], 30.0, 0.0);
    for (size_t i = 1; i < 3; ++i) {
        const size_t first = f->model.parts[i].firstTriangle;
        const pvtVec3 p = f->model.mesh.positions[f->model.mesh.indices[3 * first]];
        assert_true(p.y > 30.0);
    }
    FreeLevels(f->context, &levels);
}

static void a_single_level_needs_no_extension(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    levels.set.levelCount = 1;
    const char* path = InFolder(&f->folder, "levels.gltf");
    CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
    char* json = ReadJson(path);
    assert_null(strstr(json, "MSFT_lod"));
    free(json);
    FreeLevels(f->context, &levels);
}

// Two buffers of which one lies beside the file, a third that compressed files fall back to, an
// image beside the file, one in a data URI and one that is not there, two scenes, and what this
// library does not know.
static const char kOriginal[] =
    "{" ASSET "'extensionsUsed':['ODD_one'],'extensions':{'ODD_one':{'deep':[1,{'x':2.5}]}},"
    "'buffers':[{'byteLength':96,'uri':'my%20positions.bin'},"
    "{'byteLength':72,'uri':'data:;base64,AAACAAMAAAADAAEABAAFAAcABAAHAAYAAAABAAUAAAAFAAQA"
    "AgAGAAcAAgAHAAMAAAAEAAYAAAAGAAIAAQADAAcAAQAHAAUA'},"
    "{'byteLength':64,'extensions':{'EXT_meshopt_compression':{'fallback':true}}}],"
    "'bufferViews':[{'buffer':0,'byteLength':96},{'buffer':1,'byteLength':72},"
    "{'buffer':2,'byteLength':64,'name':'empty'}]," CUBE_ACCESSORS CUBE_MESH ","
    "'images':[{'uri':'picture.png','name':'near'},{'uri':'data:image/png;base64,AAAA'},"
    "{'uri':'missing.jpg'}],'animations':[{'name':'turn','channels':[],'samplers':[]}],"
    "'nodes':[{'mesh':0,'name':'first','extras':{'kept':9007199254740993}},{'name':'root',"
    "'children':[2]},{'mesh':0,'name':'second','translation':[5,0,0]}],"
    "'scenes':[{'nodes':[0]},{'nodes':[1],'name':'other'}],'scene':1}";

static void WriteOriginal(Fixture* f)
{
    char* json = MakeJson(kOriginal);
    WriteText(InFolder(&f->folder, "original.gltf"), json);
    free(json);
    WriteBytes(InFolder(&f->folder, "my positions.bin"), kCubePositions, sizeof kCubePositions);
    WriteText(InFolder(&f->folder, "picture.png"), "\x89PNG\r\n\x1a\nnot quite");
}

static void CheckOriginal(Fixture* f, const char* path)
{
    CheckJson(path, "'ODD_one':{'deep':[1,{'x':2.5}]}");
    CheckJson(path, "'extensionsUsed':['ODD_one','MSFT_lod']");
    CheckJson(path, "'ids':[4,5]");
    CheckJson(path, "'kept':9007199254740993");
    CheckJson(path, "'animations':[{");
    CheckJson(path, "'uri':'missing.jpg'");
    CheckJson(path, "'uri':'data:image/png;base64,AAAA'");
    CheckJson(path, "{'bufferView':3,'mimeType':'image/png','name':'near'}");
    CheckJson(path, "{'buffer':1,'byteLength':64,'name':'empty'}");
    CheckJson(path, "{'byteLength':64,'extensions':{'EXT_meshopt_compression':{'fallback':true}}}");
    assert_non_null(strstr(f->warnings.text, "missing.jpg"));
    assert_null(strstr(f->warnings.text, "picture.png"));
    // The default scene has the second cube, and now the finest level.
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
    assert_int_equal(f->model.partCount, 2);
    assert_string_equal(f->model.parts[0].name, "second");
    assert_string_equal(f->model.parts[1].name, "fine");
    CheckBounds(&f->model.mesh, (pvtVec3){5, 0, 0}, (pvtVec3){11, 1, 1}, 0.0);
    CHECK_NEAR(GetSignedVolume(&f->model.mesh), 2.0, 1e-6);
    pvtModel_Free(f->context, &f->model);
}

static void a_gltf_original_comes_out_whole(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    WriteOriginal(f);
    char original[512];
    (void)snprintf(original, sizeof original, "%s", InFolder(&f->folder, "original.gltf"));
    levels.set.original = original;
    static const char* const names[] = {"both.gltf", "both.glb"};
    for (int i = 0; i < 2; ++i) {
        char path[512];
        (void)snprintf(path, sizeof path, "%s", InFolder(&f->folder, names[i]));
        CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
        CheckOriginal(f, path);
    }
    // And in the other scene.
    levels.set.scene = 0;
    const char* path = InFolder(&f->folder, "other.glb");
    CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
    f->options.scene = 0;
    CHECK_OK(f->context, pvtLoadModel(f->context, &f->options, path, &f->model));
    assert_int_equal(f->model.partCount, 2);
    assert_string_equal(f->model.parts[0].name, "first");
    FreeLevels(f->context, &levels);
}

static void an_original_without_a_scene_gets_one_with_its_roots(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    const Pack cube = PackCube();
    WriteGlb(InFolder(&f->folder, "bare.glb"),
             "{" CUBE_DATA ",'nodes':[{'children':[1]},{'mesh':0,'name':'child'}]}", &cube);
    char original[512];
    (void)snprintf(original, sizeof original, "%s", InFolder(&f->folder, "bare.glb"));
    levels.set.original = original;
    const char* path = InFolder(&f->folder, "both.glb");
    CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
    CheckJson(path, "'scenes':[{'nodes':[0,2]}]");
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
    assert_int_equal(f->model.partCount, 2);
    pvtModel_Free(f->context, &f->model);
    // And one with nothing in it.
    WriteGlb(InFolder(&f->folder, "bare.glb"), "{'asset':{'version':'2.0'}}", NULL);
    CHECK_OK(f->context, pvtSaveLevels(f->context, path, &levels.set));
    CheckJson(path, "'scenes':[{'nodes':[0]}]");
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &f->model));
    assert_int_equal(f->model.partCount, 1);
    FreeLevels(f->context, &levels);
}

static void what_cannot_be_saved_leaves_no_file(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    assert_int_equal(pvtSaveLevels(f->context, InFolder(&f->folder, "a.obj"), &levels.set),
                     PVT_UNSUPPORTED);
    assert_false(pvtCanSaveLevels("a.ply"));
    assert_true(pvtCanSaveLevels("a.GLB"));
    levels.set.original = "/nowhere/original.glb";
    assert_int_equal(pvtSaveLevels(f->context, InFolder(&f->folder, "a.glb"), &levels.set),
                     PVT_INVALID_INPUT);
    WriteText(InFolder(&f->folder, "broken.gltf"), "{\"asset\":");
    char original[512];
    (void)snprintf(original, sizeof original, "%s", InFolder(&f->folder, "broken.gltf"));
    levels.set.original = original;
    assert_int_equal(pvtSaveLevels(f->context, InFolder(&f->folder, "a.glb"), &levels.set),
                     PVT_INVALID_INPUT);
    assert_int_equal(access(InFolder(&f->folder, "a.glb"), F_OK), -1);
    levels.set.original = NULL;
    levels.set.levelCount = 0;
    assert_int_equal(pvtSaveLevels(f->context, InFolder(&f->folder, "a.glb"), &levels.set),
                     PVT_INVALID_ARGUMENT);
    FreeLevels(f->context, &levels);
}

static void gltf_is_known_by_its_contents(void** state)
{
    Fixture* f = *state;
    WriteText(InFolder(&f->folder, "text.obj"), " \n{\"asset\":{}}");
    WriteText(InFolder(&f->folder, "binary"), "glTF....");
    WriteText(InFolder(&f->folder, "model.glb"), "v 0 0 0\n");
    assert_true(pvtIsGltf(f->context, InFolder(&f->folder, "text.obj")));
    assert_true(pvtIsGltf(f->context, InFolder(&f->folder, "binary")));
    assert_false(pvtIsGltf(f->context, InFolder(&f->folder, "model.glb")));
    assert_false(pvtIsGltf(f->context, InFolder(&f->folder, "nothing.glb")));
}

typedef struct SaveJob {
    const Levels* levels;
    const char* path;
} SaveJob;

static pvtStatus SaveOnce(pvtContext* context, const void* input)
{
    const SaveJob* job = input;
    const pvtStatus status = pvtSaveLevels(context, job->path, &job->levels->set);
    assert_int_equal(access(job->path, F_OK), status == PVT_OK ? 0 : -1);
    return status;
}

static void every_failing_allocation_leaves_no_file(void** state)
{
    Fixture* f = *state;
    Levels levels;
    MakeLevels(f->context, &levels);
    WriteOriginal(f);
    char original[512];
    char path[512];
    (void)snprintf(original, sizeof original, "%s", InFolder(&f->folder, "original.gltf"));
    levels.set.original = original;
    static const char* const names[] = {"both.gltf", "both.glb"};
    for (int i = 0; i < 2; ++i) {
        (void)snprintf(path, sizeof path, "%s", InFolder(&f->folder, names[i]));
        const SaveJob job = {&levels, path};
        CheckEveryAllocation(SaveOnce, &job);
        assert_int_equal(unlink(path), 0);
        CheckEveryCancel(SaveOnce, &job);
    }
    FreeLevels(f->context, &levels);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(the_finest_node_names_the_others_and_alone_is_in_the_scene),
        TEST(plain_levels_are_all_in_the_scene),
        TEST(other_nodes_stand_in_front_of_the_levels),
        TEST(levels_and_others_stand_where_their_transforms_say),
        TEST(a_single_level_needs_no_extension),
        TEST(a_gltf_original_comes_out_whole),
        TEST(an_original_without_a_scene_gets_one_with_its_roots),
        TEST(what_cannot_be_saved_leaves_no_file),
        TEST(gltf_is_known_by_its_contents),
        TEST(every_failing_allocation_leaves_no_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
