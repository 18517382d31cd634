// SPDX-License-Identifier: MIT
// One occluder a mesh: shared by its instances, inside of each of them, and the same whoever made
// it on how many threads.
#include "failures.h"

#include <paravent/evaluate.h>
#include <paravent/separate.h>
#include <stdlib.h>
#include <string.h>

static const double kIdentity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
static const double kFar[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 9, 0, 0, 1};
static const double kLarge[16] = {3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, 12, 1};
static const double kMirrored[16] = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -9, 0, 0, 1};
static const double kSheared[16] = {1, 0, 0, 0, 0.4, 2, 0, 0, 0, 0.3, 1, 0, 0, 0, -12, 1};
static const double kFlat[16] = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 9, 0, 1};
// The mesh's z axis is up, and its y axis points down.
static const double kZUp[16] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1};
static const double kUpsideDown[16] = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 20, 0, 0, 1};

// A block of these sides around the origin; without its bottom (y) when it is open.
static pvtMesh MakeBlock(pvtContext* context, pvtVec3 sides, bool isOpen)
{
    static const uint32_t faces[] = {0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2,
                                     1, 3, 7, 1, 7, 5, 4, 5, 7, 4, 7, 6, 0, 2, 3, 0, 3, 1};
    pvtVec3 corners[8];
    for (int i = 0; i < 8; ++i) {
        corners[i] = (pvtVec3){sides.x * ((i & 1) - 0.5), sides.y * ((i >> 1 & 1) - 0.5),
                               sides.z * ((i >> 2 & 1) - 0.5)};
    }
    pvtMesh mesh;
    // The first two triangles are the bottom.
    CHECK_OK(context, pvtCreateMesh(context, corners, 8, isOpen ? faces + 6 : faces,
                                    isOpen ? 10 : 12, &mesh));
    return mesh;
}

static pvtMesh MakeSliver(pvtContext* context)
{
    const pvtVec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-4, 0}};
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, corners, 3, NULL, 1, &mesh));
    return mesh;
}

static pvtBuildOptions MakeOptions(void)
{
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.resolution = 16;
    options.effort = PVT_EFFORT_FAST;
    options.views.count = 8;
    options.budget = 40;
    return options;
}

// All instances of the meshes, or all occluders where they stand.
static pvtMesh Join(pvtContext* context, const pvtInstanceSet* set, const pvtSeparation* separation)
{
    pvtPlacedMesh placed[16];
    size_t count = 0;
    for (size_t i = 0; i < set->instanceCount; ++i) {
        const pvtInstance* instance = &set->instances[i];
        const ptrdiff_t index = separation != NULL ? separation->ofInstance[i] : 0;
        if (index != PVT_NO_OCCLUDER) {
            placed[count++] =
                (pvtPlacedMesh){separation != NULL ? &separation->occluders[index].mesh
                                                   : &set->meshes[instance->mesh],
                                instance->transform};
        }
    }
    pvtMesh joined;
    CHECK_OK(context, pvtPlaceMeshes(context, placed, count, &joined));
    return joined;
}

static void CheckHidesOnlyWhatIsHidden(pvtContext* context, const pvtInstanceSet* set,
                                       const pvtSeparation* separation)
{
    pvtMesh original = Join(context, set, NULL);
    pvtMesh occluder = Join(context, set, separation);
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = 12;
    options.quads = 500;
    options.pixels = 128;
    pvtEvaluation evaluation;
    CHECK_OK(context,
             pvtEvaluateOccluders(context, &options, &original, &occluder, 1, &evaluation));
    CHECK_NEAR(evaluation.occluders[0].uniform.precision, 1.0, 0.0);
    CHECK_NEAR(evaluation.occluders[0].overArea, 0.0, 0.0);
    assert_true(evaluation.occluders[0].uniform.recall > 0.5);
    pvtEvaluation_Free(context, &evaluation);
    pvtMesh_Free(context, &original);
    pvtMesh_Free(context, &occluder);
}

static void instances_share_one_occluder_that_lies_in_each_of_them(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh meshes[] = {MakeBlock(context, (pvtVec3){2, 3, 1}, false),
                        MakeBlock(context, (pvtVec3){1, 1, 4}, false),
                        MakeBlock(context, (pvtVec3){2, 3, 1}, false)};
    const pvtInstance instances[] = {{0, kIdentity, "a"}, {1, kFar, "b"},      {2, kLarge, "c"},
                                     {0, kMirrored, "d"}, {1, kSheared, NULL}, {0, kFlat, "f"}};
    const pvtInstanceSet set = {meshes, 3, instances, 6};
    const pvtBuildOptions options = MakeOptions();
    pvtSeparation separation;
    CHECK_OK(context, pvtBuildSeparateOccluders(context, &options, &set, &separation));
    // The third mesh is the first again.
    assert_int_equal(separation.count, 2);
    const ptrdiff_t expected[] = {0, 1, 0, 0, 1, PVT_NO_OCCLUDER};
    assert_memory_equal(separation.ofInstance, expected, sizeof expected);
    const pvtSeparateOccluder* first = &separation.occluders[0];
    assert_int_equal(first->instanceCount, 3);
    assert_int_equal(separation.occluders[1].instanceCount, 2);
    size_t drawn = 0;
    for (size_t i = 0; i < 2; ++i) {
        assert_int_equal(separation.occluders[i].result, PVT_SEPARATE_MADE);
        assert_int_equal(separation.occluders[i].stats.outside, 0);
        drawn += separation.occluders[i].instanceCount * separation.occluders[i].mesh.triangleCount;
    }
    assert_true(drawn <= 40);
    // Lengths are those of the instance that is three times as large, measures of all of them.
    CHECK_NEAR(first->scale, 3.0, 1e-12);
    CHECK_NEAR(first->stats.voxelSize, 3.0 * 3.0 / 16.0, 1e-12);
    CHECK_NEAR(first->stats.errorBound, sqrt(3.0) * first->stats.voxelSize, 1e-12);
    CheckHidesOnlyWhatIsHidden(context, &set, &separation);
    pvtSeparation_Free(context, &separation);
    for (int i = 0; i < 3; ++i) {
        pvtMesh_Free(context, &meshes[i]);
    }
    DestroyTestContext(context);
}

static void world_lengths_hold_for_the_largest_instance(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh = MakeBlock(context, (pvtVec3){2, 3, 1}, false);
    const pvtInstance instances[] = {{0, kIdentity, NULL}, {0, kLarge, NULL}};
    const pvtInstanceSet set = {&mesh, 1, instances, 2};
    pvtBuildOptions options = MakeOptions();
    options.budget = 0; // to be chosen
    options.error = 0.75;
    options.tolerance = (pvtLength){0.25, false};
    pvtSeparation separation;
    CHECK_OK(context, pvtBuildSeparateOccluders(context, &options, &set, &separation));
    assert_int_equal(separation.budget, 64);
    const pvtBuildStats* stats = &separation.occluders[0].stats;
    CHECK_NEAR(stats->errorBound, 0.75, 1e-12);
    CHECK_NEAR(stats->tolerance, 0.25, 1e-12);
    CHECK_NEAR(stats->voxelSize, 0.5 / sqrt(3.0), 1e-12);
    pvtSeparation_Free(context, &separation);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// --ground closes what is down in the world, wherever the mesh has that.
static void the_ground_is_below_the_instance_not_the_mesh(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh = MakeBlock(context, (pvtVec3){2, 3, 2}, true); // open towards −y
    const pvtInstance instances[] = {
        {0, kIdentity, "up"}, {0, kUpsideDown, "down"}, {0, kZUp, "aside"}};
    const pvtInstanceSet set = {&mesh, 1, instances, 3};
    pvtBuildOptions options = MakeOptions();
    options.ground = true;
    pvtSeparation separation;
    CHECK_OK(context, pvtBuildSeparateOccluders(context, &options, &set, &separation));
    assert_int_equal(separation.count, 3);
    assert_int_equal(separation.occluders[0].result, PVT_SEPARATE_MADE);
    // Without an inside there is only the surface.
    assert_true(separation.occluders[0].stats.insideFraction > 0.1);
    for (int i = 1; i < 3; ++i) {
        assert_true(separation.occluders[i].stats.insideFraction == 0.0);
        assert_true(separation.occluders[i].stats.surfacePanels > 0);
    }
    pvtSeparation_Free(context, &separation);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// Panels on the surface of an open block lie as close to it as the world's lengths tell.
static void panels_on_the_surface_stray_farther_in_a_larger_instance(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh = MakeBlock(context, (pvtVec3){2, 3, 2}, true);
    const pvtInstance instances[] = {{0, kIdentity, "small"}, {0, kLarge, "large"}};
    double deviations[2], bounds[2];
    for (int i = 0; i < 2; ++i) {
        const pvtInstanceSet set = {&mesh, 1, &instances[i], 1};
        const pvtBuildOptions options = MakeOptions();
        pvtSeparation separation;
        CHECK_OK(context, pvtBuildSeparateOccluders(context, &options, &set, &separation));
        assert_int_equal(separation.count, 1);
        assert_true(separation.occluders[0].stats.surfacePanels > 0);
        deviations[i] = separation.occluders[0].stats.deviation;
        bounds[i] = separation.occluders[0].stats.errorBound;
        pvtSeparation_Free(context, &separation);
    }
    assert_true(deviations[0] > 0.0 && bounds[1] > 1.5 * bounds[0]);
    CHECK_NEAR(deviations[1] / deviations[0], bounds[1] / bounds[0], 1e-9);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// Turned so that its opening is down in the world, the same block is closed by the ground, and its
// occluder lies in it.
static void an_occluder_comes_back_to_the_space_of_its_mesh(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtVec3 sides = {2, 3, 1};
    pvtMesh mesh = MakeBlock(context, sides, true);
    // −y of the mesh to −z, −x, … of the world; one axis of the world is up each time.
    const double turns[][16] = {{0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1},
                                {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                                {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1}};
    const pvtAxis ups[] = {PVT_AXIS_X, PVT_AXIS_X, PVT_AXIS_Z};
    for (int i = 0; i < 3; ++i) {
        const pvtInstance instance = {0, turns[i], "turned"};
        const pvtInstanceSet set = {&mesh, 1, &instance, 1};
        pvtBuildOptions options = MakeOptions();
        options.ground = true;
        options.up = ups[i];
        pvtSeparation separation;
        CHECK_OK(context, pvtBuildSeparateOccluders(context, &options, &set, &separation));
        const pvtMesh* made = &separation.occluders[0].mesh;
        assert_true(made->triangleCount > 0);
        const pvtBox3 bounds = pvtMesh_GetBounds(made);
        assert_true(bounds.lower.x >= -0.501 * sides.x && bounds.upper.x <= 0.501 * sides.x);
        assert_true(bounds.lower.y > -0.6 * sides.y && bounds.upper.y <= 0.501 * sides.y);
        assert_true(bounds.lower.z >= -0.501 * sides.z && bounds.upper.z <= 0.501 * sides.z);
        assert_true(bounds.upper.y - bounds.lower.y > 0.5 * sides.y);
        pvtSeparation_Free(context, &separation);
    }
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

typedef struct Log {
    char text[4096];
} Log;

static void TakeLog(pvtLogLevel level, const char* text, void* user)
{
    Log* log = user;
    if (level == PVT_LOG_WARNING) {
        const size_t used = strlen(log->text);
        (void)snprintf(log->text + used, sizeof log->text - used, "%s\n", text);
    }
}

static void meshes_without_an_occluder_are_told_and_stop_nobody(void** state)
{
    (void)state;
    Log log = {""};
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = 2;
    def.log = TakeLog;
    def.user = &log;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    pvtMesh meshes[] = {MakeSliver(context),
                        MakeBlock(context, (pvtVec3){1, 1, 1}, false),
                        MakeBlock(context, (pvtVec3){3, 3, 3}, false),
                        {0}};
    const pvtInstance instances[] = {{0, kIdentity, "wire"},  {1, kIdentity, "crate"},
                                     {1, kFar, "crate"},      {1, kMirrored, "crate"},
                                     {2, kIdentity, "house"}, {3, kIdentity, "void"}};
    const pvtInstanceSet set = {meshes, 4, instances, 6};
    pvtBuildOptions options = MakeOptions();
    options.budget = 4;
    pvtSeparation separation;
    CHECK_OK(context, pvtBuildSeparateOccluders(context, &options, &set, &separation));
    const pvtSeparateResult expected[] = {PVT_SEPARATE_HOLLOW, PVT_SEPARATE_NO_SHARE,
                                          PVT_SEPARATE_MADE, PVT_SEPARATE_HOLLOW};
    for (size_t i = 0; i < 4; ++i) {
        assert_int_equal(separation.occluders[i].result, expected[i]);
        assert_int_equal(separation.occluders[i].reason != NULL, expected[i] != PVT_SEPARATE_MADE);
        assert_int_equal(separation.occluders[i].mesh.triangleCount > 0,
                         expected[i] == PVT_SEPARATE_MADE);
    }
    assert_non_null(strstr(log.text, "\"wire\": no occluder: "));
    assert_non_null(strstr(log.text, "\"crate\" and 2 more of its mesh: no occluder: the budget of "
                                     "4 triangles is used up before its 3 instances; --budget 8 "
                                     "has two for every instance"));
    pvtSeparation_Free(context, &separation);
    const pvtInstanceSet sail = {meshes, 4, instances, 1};
    assert_int_equal(pvtBuildSeparateOccluders(context, &options, &sail, &separation),
                     PVT_NOTHING_INSIDE);
    assert_null(separation.occluders);
    assert_non_null(strstr(pvtContext_GetMessage(context), "\"wire\": "));
    const pvtInstanceSet empty = {meshes, 4, instances + 5, 1};
    assert_int_equal(pvtBuildSeparateOccluders(context, &options, &empty, &separation),
                     PVT_INVALID_INPUT);
    const pvtInstance flat = {1, kFlat, "flat"};
    const pvtInstanceSet flattened = {meshes, 4, &flat, 1};
    assert_int_equal(pvtBuildSeparateOccluders(context, &options, &flattened, &separation),
                     PVT_NOTHING_INSIDE);
    for (int i = 0; i < 4; ++i) {
        pvtMesh_Free(context, &meshes[i]);
    }
    DestroyTestContext(context);
}

static void more_instances_than_any_budget_are_told_to_be_parted(void** state)
{
    (void)state;
    enum { COUNT = 70000 };
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh = MakeBlock(context, (pvtVec3){1, 1, 1}, false);
    pvtInstance* instances = calloc(COUNT, sizeof *instances);
    assert_non_null(instances);
    for (int i = 0; i < COUNT; ++i) {
        instances[i] = (pvtInstance){0, kFar, "tree"};
    }
    const pvtInstanceSet set = {&mesh, 1, instances, COUNT};
    pvtBuildOptions options = MakeOptions();
    options.budget = 0;
    pvtSeparation separation;
    assert_int_equal(pvtBuildSeparateOccluders(context, &options, &set, &separation),
                     PVT_NOTHING_INSIDE);
    assert_non_null(strstr(pvtContext_GetMessage(context),
                           "\"tree\" and 69999 more of its mesh: the budget of 65535 triangles is "
                           "used up before its 70000 instances, and a budget is at most 65535; "
                           "take a part of the scene by --node"));
    free(instances);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

enum { MANY = 5 };

// Different blocks, so many that they are made side by side.
static pvtStatus BuildMany(pvtContext* context, pvtMethod method, double deadline,
                           pvtSeparation* separation)
{
    pvtMesh meshes[MANY];
    pvtInstance instances[MANY];
    for (int i = 0; i < MANY; ++i) {
        meshes[i] = MakeBlock(context, (pvtVec3){1 + i % 3, 2, 1 + 0.5 * i}, false);
        instances[i] = (pvtInstance){(size_t)i, i % 2 == 0 ? kMirrored : kSheared, "block"};
    }
    const pvtInstanceSet set = {meshes, MANY, instances, MANY};
    pvtBuildOptions options = MakeOptions();
    options.resolution = 10;
    options.views.count = 2;
    options.budget = 42;
    options.method = method;
    options.deadline = deadline;
    const pvtStatus status = pvtBuildSeparateOccluders(context, &options, &set, separation);
    for (int i = 0; i < MANY; ++i) {
        pvtMesh_Free(context, &meshes[i]);
    }
    return status;
}

static void the_same_comes_out_on_any_number_of_threads(void** state)
{
    (void)state;
    pvtContext* one = CreateTestContext(1);
    pvtSeparation expected;
    CHECK_OK(one, BuildMany(one, PVT_METHOD_PLANAR, 0.0, &expected));
    for (int threads = 2; threads <= 3; ++threads) { // at three they are made one by one
        pvtContext* context = CreateTestContext(threads);
        pvtSeparation separation;
        CHECK_OK(context, BuildMany(context, PVT_METHOD_PLANAR, 0.0, &separation));
        for (size_t i = 0; i < MANY; ++i) {
            const pvtMesh* a = &expected.occluders[i].mesh;
            const pvtMesh* b = &separation.occluders[i].mesh;
            assert_int_equal(a->positionCount, b->positionCount);
            assert_int_equal(a->triangleCount, b->triangleCount);
            assert_memory_equal(a->positions, b->positions, a->positionCount * sizeof(pvtVec3));
            assert_memory_equal(a->indices, b->indices, 3 * a->triangleCount * sizeof(uint32_t));
        }
        pvtSeparation_Free(context, &separation);
        DestroyTestContext(context);
    }
    pvtSeparation_Free(one, &expected);
    DestroyTestContext(one);
}

static void a_deadline_ends_all_with_what_there_is(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtSeparation separation;
    CHECK_OK(context, BuildMany(context, PVT_METHOD_PLANAR, 1e-3, &separation));
    for (size_t i = 0; i < MANY; ++i) {
        assert_int_equal(separation.occluders[i].result, PVT_SEPARATE_MADE);
    }
    pvtSeparation_Free(context, &separation);
    DestroyTestContext(context);
}

typedef struct Reports {
    double last;
    int count;
    bool isBackwards;
} Reports;

static void TakeProgress(const char* stage, double fraction, void* user)
{
    Reports* reports = user;
    if (strcmp(stage, "occluders") == 0) {
        reports->isBackwards = reports->isBackwards || fraction < reports->last;
        reports->last = fraction;
        ++reports->count;
    }
}

static void progress_is_that_of_the_whole(void** state)
{
    (void)state;
    for (int threads = 1; threads <= 2; ++threads) {
        Reports reports = {0};
        pvtContextDef def = pvtDefaultContextDef();
        def.threadCount = threads;
        def.progress = TakeProgress;
        def.user = &reports;
        pvtContext* context = NULL;
        assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
        pvtSeparation separation;
        CHECK_OK(context, BuildMany(context, PVT_METHOD_PAPER, 0.0, &separation));
        assert_false(reports.isBackwards);
        CHECK_NEAR(reports.last, 1.0, 0.0);
        assert_true(reports.count > 2);
        pvtSeparation_Free(context, &separation);
        DestroyTestContext(context);
    }
}

static pvtStatus BuildTwo(pvtContext* context, const void* input)
{
    const pvtInstanceSet* set = input;
    pvtBuildOptions options = MakeOptions();
    options.resolution = 8;
    options.views.count = 1;
    options.method = PVT_METHOD_PAPER;
    options.budget = 6;
    pvtSeparation separation;
    memset(&separation, 0xA5, sizeof separation);
    const pvtStatus status = pvtBuildSeparateOccluders(context, &options, set, &separation);
    assert_true(status == PVT_OK || (separation.occluders == NULL && separation.count == 0 &&
                                     separation.ofInstance == NULL));
    pvtSeparation_Free(context, &separation);
    return status;
}

// Side by side, then one by one; a limit that is met only side by side is no failure.
static void refused_memory_and_cancelling_leave_nothing(void** state)
{
    (void)state;
    pvtContext* owner = CreateTestContext(1);
    pvtMesh meshes[] = {MakeBlock(owner, (pvtVec3){2, 2, 2}, false), MakeSliver(owner)};
    const pvtInstance instances[] = {{0, kZUp, "a"}, {1, kIdentity, "b"}};
    const pvtInstanceSet set = {meshes, 2, instances, 2};
    PoorHeap counting = {.failAt = INT32_MAX};
    pvtContext* context = CreatePoorContext(&counting);
    assert_int_equal(BuildTwo(context, &set), PVT_OK);
    DestroyTestContext(context);
    const int requests = atomic_load(&counting.requests);
    for (int failAt = 1; failAt < requests; failAt += 1 + requests / 97) {
        PoorHeap heap = {.failAt = failAt};
        context = CreatePoorContext(&heap);
        assert_int_equal(BuildTwo(context, &set), PVT_OUT_OF_MEMORY);
        DestroyTestContext(context);
    }
    CheckEveryCancel(BuildTwo, &set);
    pvtMesh_Free(owner, &meshes[0]);
    pvtMesh_Free(owner, &meshes[1]);
    DestroyTestContext(owner);
}

static pvtStatus BuildManyWithin(size_t limit, int threads, size_t* peak)
{
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = threads;
    def.memoryLimit = limit;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    pvtSeparation separation;
    const pvtStatus status = BuildMany(context, PVT_METHOD_PAPER, 0.0, &separation);
    *peak = pvtContext_GetPeakBytes(context);
    if (status == PVT_OK) {
        pvtSeparation_Free(context, &separation);
    } else {
        assert_int_equal(status, PVT_LIMIT);
        assert_non_null(strstr(pvtContext_GetMessage(context), "block"));
    }
    DestroyTestContext(context);
    return status;
}

static void a_limit_that_is_met_side_by_side_only_is_no_failure(void** state)
{
    (void)state;
    size_t alone = 0;
    size_t most = 0;
    assert_int_equal(BuildManyWithin(0, 1, &alone), PVT_OK);
    // Room for one piece and the little that the crew itself holds.
    const size_t limit = alone + alone / 4;
    assert_int_equal(BuildManyWithin(limit, 3, &most), PVT_OK);
    assert_true(most <= limit);
    assert_int_equal(BuildManyWithin(alone / 2, 3, &most), PVT_LIMIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(instances_share_one_occluder_that_lies_in_each_of_them),
        cmocka_unit_test(world_lengths_hold_for_the_largest_instance),
        cmocka_unit_test(the_ground_is_below_the_instance_not_the_mesh),
        cmocka_unit_test(panels_on_the_surface_stray_farther_in_a_larger_instance),
        cmocka_unit_test(an_occluder_comes_back_to_the_space_of_its_mesh),
        cmocka_unit_test(meshes_without_an_occluder_are_told_and_stop_nobody),
        cmocka_unit_test(more_instances_than_any_budget_are_told_to_be_parted),
        cmocka_unit_test(the_same_comes_out_on_any_number_of_threads),
        cmocka_unit_test(a_deadline_ends_all_with_what_there_is),
        cmocka_unit_test(progress_is_that_of_the_whole),
        cmocka_unit_test(refused_memory_and_cancelling_leave_nothing),
        cmocka_unit_test(a_limit_that_is_met_side_by_side_only_is_no_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
