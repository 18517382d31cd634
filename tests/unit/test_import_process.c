// SPDX-License-Identifier: MIT
// The importer is not believed: a program in its place that lies, dies or never ends does no harm.
#include "file_fixture.h"

#include "io/import_result.h"

#include <sys/stat.h>
#include <time.h>

static int SetUpModules(void** state)
{
    (void)SetUp(state);
    const Fixture* fixture = *state;
    assert_int_equal(setenv("PARAVENT_MODULE_PATH", fixture->folder.path, 1), 0);
    WriteText(InFolder(&fixture->folder, "a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    return 0;
}

static int TearDownModules(void** state)
{
    (void)unsetenv("PARAVENT_MODULE_PATH");
    return TearDown(state);
}

// Puts a script in the importer's place.
static void WriteImporter(Fixture* f, const char* commands)
{
    const char* path = InFolder(&f->folder, "paravent-import");
    char script[512];
    (void)snprintf(script, sizeof script, "#!/bin/sh\n%s\n", commands);
    WriteText(path, script);
    assert_int_equal(chmod(path, 0700), 0);
}

static pvtStatus Load(Fixture* f)
{
    pvtModel_Free(f->context, &f->model);
    return pvtLoadModel(f->context, NULL, InFolder(&f->folder, "a.obj"), &f->model);
}

// One triangle: the smallest sound result.
typedef struct Result {
    pvtImportHeader header;
    pvtImportNode nodes[2];
    pvtImportMesh mesh;
    uint64_t use;
    float positions[9];
    uint32_t indices[3];
    char names[16];
} Result;

static Result MakeResult(void)
{
    Result result = {
        .header = {.magic = PVT_IMPORT_MAGIC,
                   .version = PVT_IMPORT_VERSION,
                   .nodeCount = 2,
                   .meshCount = 1,
                   .useCount = 1,
                   .positionCount = 3,
                   .indexCount = 3,
                   .nameBytes = 16},
        .nodes = {{.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}},
                  {.transform = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1},
                   .useCount = 1,
                   .name = 5}},
        .mesh = {.positionCount = 3, .triangleCount = 1},
        .positions = {0, 0, 0, 1, 0, 0, 0, 1, 0},
        .indices = {0, 1, 2},
        .names = "root\0part",
    };
    return result;
}

static pvtStatus LoadResult(Fixture* f, const void* result, size_t size)
{
    char commands[256];
    WriteBytes(InFolder(&f->folder, "result"), result, size);
    (void)snprintf(commands, sizeof commands, "cat '%s/result' >&4", f->folder.path);
    WriteImporter(f, commands);
    return Load(f);
}

static void a_sound_result_is_a_model(void** state)
{
    Fixture* f = *state;
    const Result result = MakeResult();
    CHECK_OK(f->context, LoadResult(f, &result, sizeof result));
    assert_int_equal(f->model.mesh.triangleCount, 1);
    assert_string_equal(f->model.parts[0].name, "part");
    CheckBounds(&f->model.mesh, (pvtVec3){0, 0, 0}, (pvtVec3){2, 2, 0}, 0.0);
}

static void a_result_that_lies_is_refused(void** state)
{
    Fixture* f = *state;
    // Each number that counts or points, far off and just off.
    static const size_t places[] = {
        offsetof(Result, header.nodeCount),
        offsetof(Result, header.meshCount),
        offsetof(Result, header.useCount),
        offsetof(Result, header.positionCount),
        offsetof(Result, header.indexCount),
        offsetof(Result, header.nameBytes),
        offsetof(Result, nodes[0].firstUse),
        offsetof(Result, nodes[1].firstUse),
        offsetof(Result, nodes[1].useCount),
        offsetof(Result, nodes[1].name),
        offsetof(Result, nodes[1].parent),
        offsetof(Result, nodes[1].group),
        offsetof(Result, mesh.firstPosition),
        offsetof(Result, mesh.positionCount),
        offsetof(Result, mesh.firstIndex),
        offsetof(Result, mesh.triangleCount),
        offsetof(Result, use),
    };
    static const uint64_t lies[] = {UINT64_MAX, UINT64_MAX / 3, (uint64_t)1 << 32, 17};
    for (size_t i = 0; i < sizeof places / sizeof places[0]; ++i) {
        for (size_t k = 0; k < sizeof lies / sizeof lies[0]; ++k) {
            Result result = MakeResult();
            memcpy((char*)&result + places[i], &lies[k], sizeof lies[k]);
            assert_int_equal(LoadResult(f, &result, sizeof result), PVT_INVALID_INPUT);
            CheckMessage(f->context, "nothing sound");
        }
    }
    Result result = MakeResult();
    result.indices[1] = 3;
    assert_int_equal(LoadResult(f, &result, sizeof result), PVT_INVALID_INPUT);
    CheckMessage(f->context, "an index out of range");
    result = MakeResult();
    result.names[15] = 'x';
    assert_int_equal(LoadResult(f, &result, sizeof result), PVT_INVALID_INPUT);
    // Positions may be anything: they are dropped.
    result = MakeResult();
    result.positions[4] = NAN;
    assert_int_equal(LoadResult(f, &result, sizeof result), PVT_INVALID_INPUT);
    CheckMessage(f->context, "not a finite number");
}

// No room is made for positions without a triangle, so that none may be written.
static void positions_without_a_triangle_are_left_out(void** state)
{
    enum { MANY = 1 << 19 };
    typedef struct PointResult {
        pvtImportHeader header;
        pvtImportNode nodes[3];
        pvtImportMesh meshes[2];
        uint64_t uses[2];
        float positions[3 * (3 + MANY)];
        uint32_t indices[3];
        char names[24];
    } PointResult;
    Fixture* f = *state;
    const Result one = MakeResult();
    PointResult* result = calloc(1, sizeof *result);
    assert_non_null(result);
    result->header = one.header;
    result->header.nodeCount = 3;
    result->header.meshCount = result->header.useCount = 2;
    result->header.positionCount = 3 + MANY;
    result->header.nameBytes = sizeof result->names;
    memcpy(result->nodes, one.nodes, sizeof one.nodes);
    result->nodes[2] = one.nodes[1];
    result->nodes[2].firstUse = result->uses[1] = 1;
    result->meshes[0] = one.mesh;
    result->meshes[1] = (pvtImportMesh){.firstPosition = 3, .positionCount = MANY, .firstIndex = 3};
    memcpy(result->positions, one.positions, sizeof one.positions);
    memcpy(result->indices, one.indices, sizeof one.indices);
    memcpy(result->names, one.names, sizeof one.names);
    CHECK_OK(f->context, LoadResult(f, result, sizeof *result));
    assert_int_equal(f->model.partCount, 1);
    assert_int_equal(f->model.mesh.positionCount, 3);
    free(result);
}

static void a_result_that_ends_early_is_refused(void** state)
{
    Fixture* f = *state;
    Result result = MakeResult();
    for (size_t size = 0; size < sizeof result; size += 97) {
        assert_int_equal(LoadResult(f, &result, size), PVT_INVALID_INPUT);
        CheckMessage(f->context, "a.obj");
    }
    result.header.version = PVT_IMPORT_VERSION + 1;
    assert_int_equal(LoadResult(f, &result, sizeof result), PVT_INVALID_INPUT);
    WriteImporter(f, "exit 7");
    assert_int_equal(Load(f), PVT_INVALID_INPUT);
    CheckMessage(f->context, "status 7");
    WriteImporter(f, "kill -SEGV $$");
    assert_int_equal(Load(f), PVT_INVALID_INPUT);
    CheckMessage(f->context, "crashed");
    WriteImporter(f, "kill -XCPU $$");
    assert_int_equal(Load(f), PVT_INVALID_INPUT);
    CheckMessage(f->context, "took longer");
    WriteImporter(f, "kill -KILL $$");
    assert_int_equal(Load(f), PVT_LIMIT);
}

static void its_text_is_cleaned(void** state)
{
    Fixture* f = *state;
    Result result = MakeResult();
    result.header.status = PVT_IMPORT_INVALID;
    memset(result.header.text, '\x1b', sizeof result.header.text);
    assert_int_equal(LoadResult(f, &result, sizeof result), PVT_INVALID_INPUT);
    CheckMessage(f->context, "a.obj: ????");
    assert_null(strchr(pvtContext_GetMessage(f->context), '\x1b'));
}

static void an_importer_that_never_ends_is_killed_when_cancelled(void** state)
{
    Fixture* f = *state;
    WriteImporter(f, "exec sleep 100");
    CancelCounter counter = {4};
    pvtContext* context = CreateCancelledContext(&counter, 1);
    struct timespec before, after;
    (void)clock_gettime(CLOCK_MONOTONIC, &before);
    assert_int_equal(pvtLoadModel(context, NULL, InFolder(&f->folder, "a.obj"), &f->model),
                     PVT_CANCELLED);
    (void)clock_gettime(CLOCK_MONOTONIC, &after);
    // Half of what the importer would sleep, for a machine that is busy with other things.
    assert_true(after.tv_sec - before.tv_sec < 50);
    DestroyTestContext(context);
}

// The pipe is closed as if it had ended.
static void an_importer_that_feigns_its_end_is_killed(void** state)
{
    Fixture* f = *state;
    WriteImporter(f, "exec 5>&-\nexec sleep 100");
    struct timespec before, after;
    (void)clock_gettime(CLOCK_MONOTONIC, &before);
    assert_int_equal(Load(f), PVT_INVALID_INPUT);
    CancelCounter counter = {4};
    pvtContext* context = CreateCancelledContext(&counter, 1);
    assert_int_equal(pvtLoadModel(context, NULL, InFolder(&f->folder, "a.obj"), &f->model),
                     PVT_CANCELLED);
    (void)clock_gettime(CLOCK_MONOTONIC, &after);
    assert_true(after.tv_sec - before.tv_sec < 50);
    DestroyTestContext(context);
}

static void it_inherits_no_descriptor(void** state)
{
    Fixture* f = *state;
    // A descriptor that is not closed on exec, as a careless program would have.
    const int careless = dup(0);
    assert_true(careless >= 0);
    char commands[256];
    (void)snprintf(commands, sizeof commands, "ls /proc/self/fd > '%s/list'", f->folder.path);
    WriteImporter(f, commands);
    assert_int_equal(Load(f), PVT_INVALID_INPUT);
    close(careless);
    char list[256] = "";
    FILE* file = fopen(InFolder(&f->folder, "list"), "rb");
    assert_non_null(file);
    (void)fread(list, 1, sizeof list - 1, file);
    (void)fclose(file);
    // ls itself opens one more, to read the folder.
    assert_string_equal(list, "0\n1\n2\n3\n4\n5\n6\n");
}

static void an_importer_that_anybody_may_change_is_passed_over(void** state)
{
    Fixture* f = *state;
    WriteImporter(f, "exit 0");
    assert_int_equal(chmod(InFolder(&f->folder, "paravent-import"), 0777), 0);
    // One that anybody may change is passed over, and the next is taken: the real one.
    assert_int_equal(Load(f), PVT_INVALID_INPUT);
    CheckMessage(f->context, "no triangle");
}

#define MODULE_TEST(name) cmocka_unit_test_setup_teardown(name, SetUpModules, TearDownModules)

int main(void)
{
    const struct CMUnitTest tests[] = {
        MODULE_TEST(a_sound_result_is_a_model),
        MODULE_TEST(a_result_that_lies_is_refused),
        MODULE_TEST(positions_without_a_triangle_are_left_out),
        MODULE_TEST(a_result_that_ends_early_is_refused),
        MODULE_TEST(its_text_is_cleaned),
        MODULE_TEST(an_importer_that_never_ends_is_killed_when_cancelled),
        MODULE_TEST(an_importer_that_feigns_its_end_is_killed),
        MODULE_TEST(it_inherits_no_descriptor),
        MODULE_TEST(an_importer_that_anybody_may_change_is_passed_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
