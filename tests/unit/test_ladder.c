// SPDX-License-Identifier: MIT
#include "append.h"
#include "perspective.h"
#include "voxel_shapes.h"
#include "warnings.h"

#include <string.h>

// Eight upright bars, with gaps between them that widen from 0.05 to 0.35.
static void MakeFence(pvtContext* context, pvtMesh* mesh)
{
    *mesh = (pvtMesh){0};
    double x = 0.0;
    for (int i = 0; i < 8; ++i) {
        pvtMesh bar;
        MakeBoxMesh(context, (pvtVec3){x, 0, 0}, (pvtVec3){x + 0.5, 3, 0.8}, &bar);
        CHECK_OK(context, AppendMesh(context, mesh, &bar));
        pvtMesh_Free(context, &bar);
        x += 0.55 + 0.05 * i;
    }
}

static pvtLadderOptions GetQuickOptions(void)
{
    pvtLadderOptions options = pvtDefaultLadderOptions();
    options.build.views.count = 4;
    options.build.effort = PVT_EFFORT_FAST;
    options.levelCount = 3;
    const double errors[] = {0.2, 0.45, 1.2};
    memcpy(options.errors, errors, sizeof errors);
    const int budgets[] = {40, 16, 4};
    memcpy(options.budgets, budgets, sizeof budgets);
    return options;
}

static void errors_grow_and_triangles_fall(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh fence;
    MakeFence(context, &fence);
    const pvtLadderOptions options = GetQuickOptions();
    pvtLadder ladder;
    CHECK_OK(context, pvtBuildLadder(context, &options, &fence, &ladder));
    assert_int_equal(ladder.count, 3);
    for (size_t i = 0; i < ladder.count; ++i) {
        const pvtLevel* level = &ladder.levels[i];
        CHECK_NEAR(level->stats.errorBound, options.errors[i], 1e-9);
        assert_int_equal(level->number, i);
        assert_true(level->occluder.mesh.triangleCount <= (size_t)options.budgets[i]);
        assert_true(level->stats.outside == 0);
        if (i > 0) {
            assert_true(level->stats.voxelSize > level[-1].stats.voxelSize);
            assert_true(level->occluder.mesh.triangleCount < level[-1].occluder.mesh.triangleCount);
            assert_true(level->distance > level[-1].distance);
            assert_true(level->screenCoverage < level[-1].screenCoverage);
        }
    }
    pvtLadder_Free(context, &ladder);
    pvtMesh_Free(context, &fence);
    DestroyTestContext(context);
}

static void from_its_distance_on_a_level_shows_no_error_thicker_than_the_pixel_error(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh fence;
    MakeFence(context, &fence);
    pvtLadderOptions options = GetQuickOptions();
    CheckLadderPictures(context, &options, &fence);
    options.screen = (pvtScreenOptions){.pixelError = 2.5, .fieldOfView = 95.0, .height = 700};
    CheckLadderPictures(context, &options, &fence);
    pvtMesh_Free(context, &fence);
    DestroyTestContext(context);
}

// Whether a ray along z at (x, y) meets the mesh.
static bool IsBlocked(const pvtMesh* mesh, double x, double y)
{
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        int positive = 0;
        int negative = 0;
        for (int c = 0; c < 3; ++c) {
            const pvtVec3 a = mesh->positions[mesh->indices[3 * t + (size_t)c]];
            const pvtVec3 b = mesh->positions[mesh->indices[3 * t + (size_t)(c + 1) % 3]];
            const double side = (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
            positive += side > 0.0;
            negative += side < 0.0;
        }
        if (positive == 0 || negative == 0) {
            return true;
        }
    }
    return false;
}

// Of 60 rays through each of the seven gaps, those that meet the mesh.
static int CountBlockedRays(const pvtMesh* mesh)
{
    int count = 0;
    double x = 0.5;
    for (int i = 0; i < 7; ++i) {
        const double gap = 0.05 + 0.05 * i;
        for (int k = 0; k < 60; ++k) {
            count += IsBlocked(mesh, x + 0.5 * gap, 0.024 + 0.05 * k);
        }
        x += 0.5 + gap;
    }
    return count;
}

static void openings_close_as_voxels_grow(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh fence;
    MakeFence(context, &fence);
    pvtLadderOptions options = GetQuickOptions();
    options.errors[1] = 0.24;
    pvtLadder ladder;
    CHECK_OK(context, pvtBuildLadder(context, &options, &fence, &ladder));
    const int fine = CountBlockedRays(&ladder.levels[0].occluder.mesh);
    const int middle = CountBlockedRays(&ladder.levels[1].occluder.mesh);
    const int coarse = CountBlockedRays(&ladder.levels[2].occluder.mesh);
    assert_int_equal(fine, 0);
    assert_true(middle >= fine && coarse > middle);
    assert_true(coarse > 200);
    pvtLadder_Free(context, &ladder);
    pvtMesh_Free(context, &fence);
    DestroyTestContext(context);
}

static void the_default_errors_double_and_the_default_budgets_halve(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh box;
    MakeBoxMesh(context, (pvtVec3){0, 0, 0}, (pvtVec3){4, 2, 3}, &box);
    pvtLadderOptions options = pvtDefaultLadderOptions();
    options.build.views.count = 2;
    options.build.effort = PVT_EFFORT_FAST;
    options.build.resolution = 48;
    options.levelCount = 3;
    static const pvtLength holes[] = {{0.0, false}, {0.2, false}, {3.0, true}};
    for (size_t h = 0; h < sizeof holes / sizeof *holes; ++h) {
        options.build.smallestHole = holes[h];
        pvtLadder ladder;
        CHECK_OK(context, pvtBuildLadder(context, &options, &box, &ladder));
        assert_int_equal(ladder.count, 3);
        CHECK_NEAR(ladder.levels[0].stats.voxelSize, 4.0 / 48, 1e-12);
        assert_true(ladder.levels[0].stats.tolerance == 0.0);
        for (size_t i = 0; i < 3; ++i) {
            const pvtBuildStats* stats = &ladder.levels[i].stats;
            CHECK_NEAR(stats->errorBound, ldexp(ladder.levels[0].stats.errorBound, (int)i), 1e-9);
            assert_true(i == 0 || stats->tolerance == stats->voxelSize);
            assert_true(ladder.levels[i].budget <= 64 >> i);
        }
        pvtLadder_Free(context, &ladder);
    }
    pvtMesh_Free(context, &box);
    DestroyTestContext(context);
}

static void distance_and_coverage_follow_the_formula(void** state)
{
    (void)state;
    // At 90 degrees a pixel is 1/500 of the distance; at distance 10 the screen is 20 by 40.
    pvtScreenOptions screen = {
        .pixelError = 2.0, .fieldOfView = 90.0, .height = 1000, .width = 2000};
    CHECK_NEAR(pvtGetErrorDistance(&screen, 0.1, 3.0), 3.0 + 0.1 * 500.0 / 2.0, 1e-12);
    CHECK_NEAR(pvtGetErrorDistance(&screen, 1e-6, 3.0), 6.0, 1e-12);
    CHECK_NEAR(pvtGetScreenCoverage(&screen, 1.5, 10.0), M_PI * 1.5 * 1.5 / 800.0, 1e-12);
    CHECK_NEAR(pvtGetScreenCoverage(&screen, 30.0, 10.0), 1.0, 0.0);
    screen = pvtDefaultScreenOptions();
    const double implied = pvtGetScreenCoverage(&screen, 1.0, 10.0);
    screen.width = 1920;
    CHECK_NEAR(pvtGetScreenCoverage(&screen, 1.0, 10.0), implied, 1e-15);
}

typedef struct Notes {
    int warnings, levels;
    char text[512];
} Notes;

static void TakeNote(pvtLogLevel level, const char* text, void* user)
{
    Notes* notes = user;
    if (level == PVT_LOG_WARNING && strstr(text, "left out") != NULL) {
        ++notes->warnings;
        (void)snprintf(notes->text, sizeof notes->text, "%s", text);
    }
}

static void TakeStage(const char* stage, double fraction, void* user)
{
    Notes* notes = user;
    const int level = stage[3] - '0';
    assert_memory_equal(stage, "LOD", 3);
    assert_true(fraction >= 0.0 && level >= notes->levels - 1 && level < 3);
    notes->levels = level + 1;
}

static void a_coarser_level_that_cannot_be_had_is_left_out_and_named(void** state)
{
    (void)state;
    Notes notes = {0};
    pvtContextDef def = pvtDefaultContextDef();
    def.log = TakeNote;
    def.progress = TakeStage;
    def.user = &notes;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    pvtMesh box;
    MakeBoxMesh(context, (pvtVec3){0, 0, 0}, (pvtVec3){4, 2, 3}, &box);
    pvtLadderOptions options = GetQuickOptions();
    pvtLadder ladder;
    // The coarsest grid has eight voxels along the longest side.
    options.errors[1] = 10.0;
    options.errors[2] = 20.0;
    CHECK_OK(context, pvtBuildLadder(context, &options, &box, &ladder));
    assert_int_equal(ladder.count, 2);
    assert_int_equal(notes.warnings, 1);
    assert_int_equal(notes.levels, 3);
    assert_memory_equal(notes.text, "LOD2: ", 6);
    assert_true(ladder.levels[1].stats.errorBound < 10.0);
    pvtLadder_Free(context, &ladder);
    // After a single triangle there can be no fewer.
    notes = (Notes){0};
    options = GetQuickOptions();
    options.levelCount = 2;
    options.budgets[0] = 2;
    options.budgets[1] = 1;
    CHECK_OK(context, pvtBuildLadder(context, &options, &box, &ladder));
    assert_true(ladder.count + (size_t)notes.warnings == 2);
    pvtLadder_Free(context, &ladder);
    pvtMesh_Free(context, &box);
    DestroyTestContext(context);
}

static int CountText(const char* text, const char* part)
{
    int count = 0;
    for (const char* at = strstr(text, part); at != NULL; at = strstr(at + 1, part)) {
        ++count;
    }
    return count;
}

// A box without a floor.
static void MakeHood(pvtContext* context, pvtMesh* mesh)
{
    MakeBoxMesh(context, (pvtVec3){0, 0, 0}, (pvtVec3){4, 2, 3}, mesh);
    size_t kept = 0;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const uint32_t* corners = mesh->indices + 3 * t;
        const double top = fmax(mesh->positions[corners[0]].y,
                                fmax(mesh->positions[corners[1]].y, mesh->positions[corners[2]].y));
        if (top > 0.0) {
            memmove(mesh->indices + 3 * kept++, corners, sizeof(uint32_t[3]));
        }
    }
    mesh->triangleCount = kept;
    assert_int_equal(kept, 10);
}

static void what_is_said_of_the_mesh_is_said_once_a_ladder(void** state)
{
    (void)state;
    Warnings warnings;
    pvtContext* context = CreateWarningContext(&warnings);
    pvtMesh hood;
    MakeHood(context, &hood);
    const pvtLadderOptions options = GetQuickOptions();
    for (int run = 1; run <= 2; ++run) {
        pvtLadder ladder;
        CHECK_OK(context, pvtBuildLadder(context, &options, &hood, &ladder));
        assert_true(ladder.count > 1);
        assert_int_equal(CountText(warnings.text, "the solid is hollow"), run);
        assert_int_equal(CountText(warnings.text, "LOD0: the solid is hollow"), run);
        pvtLadder_Free(context, &ladder);
    }
    // Of occluders one after the other each is told of.
    for (int run = 3; run <= 4; ++run) {
        pvtOccluder occluder;
        CHECK_OK(context, pvtBuildOccluder(context, &options.build, &hood, &occluder, NULL));
        assert_int_equal(CountText(warnings.text, "the solid is hollow"), run);
        pvtOccluder_Free(context, &occluder);
    }
    pvtMesh_Free(context, &hood);
    DestroyTestContext(context);
}

static void the_finest_level_fails_by_its_name(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtVec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-4, 1e-5}};
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, corners, 3, NULL, 1, &mesh));
    const pvtLadderOptions options = GetQuickOptions();
    pvtLadder ladder;
    assert_int_equal(pvtBuildLadder(context, &options, &mesh, &ladder), PVT_NOTHING_INSIDE);
    assert_memory_equal(pvtContext_GetMessage(context), "LOD0: ", 6);
    assert_int_equal(ladder.count, 0);
    assert_null(ladder.levels);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void contradictions_are_refused_by_name(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh box;
    MakeBoxMesh(context, (pvtVec3){0, 0, 0}, (pvtVec3){4, 2, 3}, &box);
    pvtLadderOptions wrong[12];
    for (int i = 0; i < 12; ++i) {
        wrong[i] = GetQuickOptions();
    }
    wrong[0].levelCount = 0;
    wrong[1].levelCount = PVT_MAX_LEVELS + 1;
    wrong[2].errors[1] = wrong[2].errors[0];
    wrong[3].errors[2] = NAN;
    wrong[4].errors[0] = -1.0;
    wrong[5].budgets[1] = wrong[5].budgets[0];
    wrong[6].budgets[2] = 0;
    wrong[7].budgets[0] = 65536;
    wrong[8].screen.pixelError = 0.0;
    wrong[9].screen.fieldOfView = 180.0;
    wrong[10].screen.height = 0;
    wrong[11].coarseTolerance = (pvtLength){0.5, false}; // more than the second level's error
    for (int i = 0; i < 12; ++i) {
        pvtLadder ladder;
        assert_int_equal(pvtBuildLadder(context, &wrong[i], &box, &ladder), PVT_INVALID_ARGUMENT);
        assert_null(ladder.levels);
    }
    pvtMesh_Free(context, &box);
    DestroyTestContext(context);
}

static void threads_do_not_change_a_byte_of_any_level(void** state)
{
    (void)state;
    pvtContext* contexts[2] = {CreateTestContext(1), CreateTestContext(3)};
    pvtLadder ladders[2];
    const pvtLadderOptions options = GetQuickOptions();
    for (int i = 0; i < 2; ++i) {
        pvtMesh fence;
        MakeFence(contexts[i], &fence);
        CHECK_OK(contexts[i], pvtBuildLadder(contexts[i], &options, &fence, &ladders[i]));
        pvtMesh_Free(contexts[i], &fence);
    }
    assert_int_equal(ladders[0].count, ladders[1].count);
    for (size_t i = 0; i < ladders[0].count; ++i) {
        const pvtMesh* a = &ladders[0].levels[i].occluder.mesh;
        const pvtMesh* b = &ladders[1].levels[i].occluder.mesh;
        assert_int_equal(a->positionCount, b->positionCount);
        assert_int_equal(a->triangleCount, b->triangleCount);
        assert_memory_equal(a->positions, b->positions, a->positionCount * sizeof *a->positions);
        assert_memory_equal(a->indices, b->indices, 3 * a->triangleCount * sizeof *a->indices);
        assert_true(ladders[0].levels[i].distance == ladders[1].levels[i].distance);
    }
    for (int i = 0; i < 2; ++i) {
        pvtLadder_Free(contexts[i], &ladders[i]);
        DestroyTestContext(contexts[i]);
    }
}

// Two small levels of a box, seen from one side.
static pvtStatus BuildSmallLadder(pvtContext* context, const void* input)
{
    (void)input;
    static const pvtWeightedDirection direction = {{0.3, -0.4, 0.5}, 1.0};
    pvtLadderOptions options = GetQuickOptions();
    options.build.views.list = &direction;
    options.build.views.listCount = 1;
    options.levelCount = 2;
    options.errors[0] = 0.8;
    options.errors[1] = 1.3;
    options.budgets[0] = 2;
    options.budgets[1] = 1;
    const pvtVec3 corners[4] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}};
    static const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    pvtMesh mesh;
    pvtLadder ladder = {0};
    pvtStatus status = pvtCreateMesh(context, corners, 4, faces, 4, &mesh);
    if (status == PVT_OK) {
        status = pvtBuildLadder(context, &options, &mesh, &ladder);
    }
    pvtLadder_Free(context, &ladder);
    pvtMesh_Free(context, &mesh);
    return status;
}

static void a_cancelled_ladder_leaves_nothing(void** state)
{
    (void)state;
    CheckEveryCancel(BuildSmallLadder, NULL);
}

static void a_ladder_that_runs_out_of_memory_leaves_nothing(void** state)
{
    (void)state;
    // Every request of a build fails in a test of its own; here, more and more of them are granted.
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int failAt = 1; status != PVT_OK; failAt += 1 + failAt / 2) {
        PoorHeap heap = {.failAt = failAt};
        pvtContext* context = CreatePoorContext(&heap);
        status = BuildSmallLadder(context, NULL);
        assert_int_equal(status, PoorHeap_HasRefused(&heap) ? PVT_OUT_OF_MEMORY : PVT_OK);
        DestroyTestContext(context);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_grow_and_triangles_fall),
        cmocka_unit_test(from_its_distance_on_a_level_shows_no_error_thicker_than_the_pixel_error),
        cmocka_unit_test(openings_close_as_voxels_grow),
        cmocka_unit_test(the_default_errors_double_and_the_default_budgets_halve),
        cmocka_unit_test(distance_and_coverage_follow_the_formula),
        cmocka_unit_test(a_coarser_level_that_cannot_be_had_is_left_out_and_named),
        cmocka_unit_test(what_is_said_of_the_mesh_is_said_once_a_ladder),
        cmocka_unit_test(the_finest_level_fails_by_its_name),
        cmocka_unit_test(contradictions_are_refused_by_name),
        cmocka_unit_test(threads_do_not_change_a_byte_of_any_level),
        cmocka_unit_test(a_cancelled_ladder_leaves_nothing),
        cmocka_unit_test(a_ladder_that_runs_out_of_memory_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
