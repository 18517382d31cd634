// SPDX-License-Identifier: MIT
#include "hills.h"
#include "score.h"
#include "warnings.h"

#include "base/vector.h"
#include "voxel_shapes.h"

#include <limits.h>
#include <math.h>
#include <paravent/evaluate.h>
#include <paravent/occluder.h>
#include <string.h>

// A ring that lies flat: 24 by 12 quads.
static void MakeTorus(pvtContext* context, pvtMesh* mesh)
{
    enum { AROUND = 24, ACROSS = 12 };
    pvtVec3 positions[AROUND * ACROSS];
    uint32_t indices[6 * AROUND * ACROSS];
    size_t count = 0;
    for (uint32_t i = 0; i < AROUND; ++i) {
        for (uint32_t j = 0; j < ACROSS; ++j) {
            const double a = 6.283185307179586 * i / AROUND;
            const double b = 6.283185307179586 * j / ACROSS;
            const double radius = 2.0 + 0.8 * cos(b);
            positions[i * ACROSS + j] = (pvtVec3){radius * cos(a), 0.8 * sin(b), radius * sin(a)};
            const uint32_t nextI = (i + 1) % AROUND * ACROSS;
            const uint32_t quad[4] = {i * ACROSS + j, nextI + j, nextI + (j + 1) % ACROSS,
                                      i * ACROSS + (j + 1) % ACROSS};
            const uint32_t two[6] = {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]};
            memcpy(indices + count, two, sizeof two);
            count += 6;
        }
    }
    CHECK_OK(context, pvtCreateMesh(context, positions, AROUND * ACROSS, indices,
                                    2 * AROUND * ACROSS, mesh));
}

// Half of a sphere of radius 1, open on top, with a wall inwards from there: 16 by 6 quads a side.
static void MakeBowl(pvtContext* context, double wall, pvtMesh* mesh)
{
    enum { AROUND = 16, DOWN = 6, SIDE = AROUND * (DOWN + 1) };
    pvtVec3 positions[2 * SIDE];
    uint32_t indices[6 * AROUND * (2 * DOWN + 1)];
    size_t count = 0;
    for (uint32_t i = 0; i < 2 * SIDE; ++i) {
        const double radius = i < SIDE ? 1.0 : 1.0 - wall;
        const double a = 6.283185307179586 * (i % AROUND) / AROUND;
        const uint32_t row = i % SIDE / AROUND;
        const double b = 1.5707963267948966 * row / DOWN;
        positions[i] = pvtScale((pvtVec3){cos(b) * cos(a), -sin(b), cos(b) * sin(a)}, radius);
    }
    for (uint32_t i = 0; i < AROUND; ++i) {
        const uint32_t next = (i + 1) % AROUND;
        AddQuad(indices, &count, (uint32_t[4]){i, SIDE + i, SIDE + next, next});
        for (uint32_t j = 0; j < DOWN; ++j) {
            const uint32_t above = j * AROUND, below = above + AROUND;
            AddQuad(indices, &count,
                    (uint32_t[4]){above + i, above + next, below + next, below + i});
            AddQuad(indices, &count,
                    (uint32_t[4]){SIDE + above + i, SIDE + below + i, SIDE + below + next,
                                  SIDE + above + next});
        }
    }
    CHECK_OK(context,
             pvtCreateMesh(context, positions, (size_t)2 * SIDE, indices, count / 3, mesh));
}

static pvtBuildOptions GetQuickOptions(void)
{
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.resolution = 32;
    options.views.count = 8;
    options.effort = PVT_EFFORT_FAST;
    return options;
}

// What of the original the occluder leaves uncovered is nowhere thicker than `most` [wu].
static void CheckUncovered(pvtContext* context, const pvtMesh* original, const pvtMesh* occluder,
                           int pixels, double most)
{
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.pixels = pixels;
    options.views = 64;
    options.quads = 1;
    pvtEvaluation evaluation;
    // The original takes the occluder's place: what it alone covers is what the other leaves.
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, occluder, original, 1, &evaluation));
    assert_true(evaluation.occluders[0].overThickness <= most);
    assert_true(evaluation.occluders[0].overThickness > 0.0);
    pvtEvaluation_Free(context, &evaluation);
}

static void a_cube_at_twelve_triangles_is_covered_to_within_a_voxel(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh cube;
    MakeBoxMesh(context, (pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, &cube);
    static const struct {
        int resolution, views, pixels;
        pvtEffort effort;
    } cases[] = {{32, 16, 512, PVT_EFFORT_DEFAULT}, {256, 256, 1536, PVT_EFFORT_FAST}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
        const int n = cases[c].resolution;
        pvtBuildOptions options = GetQuickOptions();
        options.budget = 12;
        options.effort = cases[c].effort;
        options.views.count = cases[c].views;
        options.resolution = n;
        pvtOccluder occluder;
        pvtBuildStats stats;
        CHECK_OK(context, pvtBuildOccluder(context, &options, &cube, &occluder, &stats));
        assert_true(occluder.mesh.triangleCount <= 12);
        assert_true(stats.outside == 0);
        // Nothing hides more than the cube itself, and one a voxel shorter on each side, less.
        assert_true(stats.measure <= stats.measureOfSolid * 1.01);
        assert_true(stats.measure >= stats.measureOfSolid * 0.92);
        // Distances are measured between pixels, of which at most √3 + 1/32 sides are seen.
        CheckUncovered(context, &cube, &occluder.mesh, cases[c].pixels,
                       stats.voxelSize + 1.77 / cases[c].pixels);
        CHECK_NEAR(stats.insideFraction, pow(1.0 - 2.0 / n, 3.0), 0.02);
        pvtOccluder_Free(context, &occluder);
    }
    pvtMesh_Free(context, &cube);
    DestroyTestContext(context);
}

static void an_occluder_never_hides_more_than_the_solid_at_any_resolution(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh torus;
    MakeTorus(context, &torus);
    static const int resolutions[] = {12, 20, 48};
    for (size_t r = 0; r < sizeof resolutions / sizeof *resolutions; ++r) {
        for (int loose = 0; loose < 2; ++loose) {
            pvtBuildOptions options = GetQuickOptions();
            options.resolution = resolutions[r];
            options.tolerance = (pvtLength){loose, true};
            pvtOccluder occluder;
            pvtBuildStats stats;
            CHECK_OK(context, pvtBuildOccluder(context, &options, &torus, &occluder, &stats));
            // The ceiling takes in whole cells that the surface passes: much of a tube of two
            // voxels.
            assert_true(stats.measure > 0.28 * stats.measureOfSolid);
            assert_true(stats.measure <= 1.001 * stats.measureOfSolid);
            pvtOccluder_Free(context, &occluder);
        }
    }
    pvtMesh_Free(context, &torus);
    DestroyTestContext(context);
}

static pvtQuadScore ScoreBuild(pvtContext* context, const pvtBuildOptions* options, int views,
                               const pvtMesh* mesh)
{
    pvtOccluder occluder;
    pvtBuildStats stats;
    CHECK_OK(context, pvtBuildOccluder(context, options, mesh, &occluder, &stats));
    assert_true(stats.outside == 0 || options->tolerance.value > 0.0);
    const pvtQuadScore score = ScoreUniform(context, mesh, &occluder.mesh, views);
    pvtOccluder_Free(context, &occluder);
    return score;
}

static pvtQuadScore ScoreOccluder(pvtContext* context, const pvtMesh* mesh, int resolution,
                                  int budget, double tolerance)
{
    pvtBuildOptions options = GetQuickOptions();
    options.resolution = resolution;
    options.budget = budget;
    options.tolerance = (pvtLength){tolerance, true};
    return ScoreBuild(context, &options, 32, mesh);
}

// At most 512 triangles are refined, from a start that differs a little with the budget. As they
// were selected 600 and 1,375 have 11 and 15 % less of the measure.
static void a_budget_beyond_what_is_refined_hides_no_less(void** state)
{
    (void)state;
    static const int budgets[] = {512, 600, 3000};
    pvtContext* context = CreateTestContext(2);
    pvtMesh torus;
    MakeTorus(context, &torus);
    double measures[3] = {0};
    for (int i = 0; i < 3; ++i) {
        pvtBuildOptions options = GetQuickOptions();
        options.effort = PVT_EFFORT_FAST;
        options.budget = budgets[i];
        options.resolution = 40;
        pvtOccluder occluder;
        pvtBuildStats stats;
        CHECK_OK(context, pvtBuildOccluder(context, &options, &torus, &occluder, &stats));
        assert_true(occluder.mesh.triangleCount <= (size_t)budgets[i]);
        assert_true(stats.outside == 0);
        measures[i] = stats.measure;
        pvtOccluder_Free(context, &occluder);
    }
    assert_true(measures[1] >= 0.99 * measures[0]);
    assert_true(measures[2] >= 0.99 * measures[0]);
    pvtMesh_Free(context, &torus);
    DestroyTestContext(context);
}

// Sticking out is allowed, but not worth anything by itself.
static void a_tolerance_hides_much_more_and_hardly_anything_that_is_seen(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh torus;
    MakeTorus(context, &torus);
    const pvtQuadScore strict = ScoreOccluder(context, &torus, 64, 48, 0.0);
    const pvtQuadScore loose = ScoreOccluder(context, &torus, 64, 48, 1.0);
    assert_true(strict.precision == 1.0);
    assert_true(loose.precision > 0.997);
    assert_true(loose.recall > strict.recall + 0.1);
    assert_true(loose.recall > 0.9);
    pvtMesh_Free(context, &torus);
    DestroyTestContext(context);
}

// A wall has no inside, but touched voxels that it hides something by.
static void a_wall_is_covered_within_a_tolerance(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    const pvtVec3 corners[] = {{0, 0, 0}, {3, 0, 1}, {3, 2, 1}, {0, 2, 0}};
    const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    pvtMesh wall;
    CHECK_OK(context, pvtCreateMesh(context, corners, 4, indices, 2, &wall));
    const pvtQuadScore score = ScoreOccluder(context, &wall, 64, 4, 1.0);
    assert_true(score.precision > 0.99);
    assert_true(score.recall > 0.95);
    pvtMesh_Free(context, &wall);
    DestroyTestContext(context);
}

// Below its edge a landscape hides nothing, though all of that counts as inside: what is seen there
// counts against an occluder. Otherwise precision is 96.9 % within a tolerance, and 95.0 % strictly
// inside. There it has room below all of it: with holes where valleys are lowest recall is 3.4 %.
static void a_landscape_is_covered_where_it_hides_something(void** state)
{
    (void)state;
    static const struct {
        double tolerance, precision, recall;
    } cases[] = {{1.0, 0.99, 0.96}, {0.0, 0.985, 0.7}};
    pvtContext* context = CreateTestContext(2);
    pvtMesh hills;
    MakeHills(context, &hills);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
        pvtBuildOptions options = GetQuickOptions();
        options.terrain = true;
        options.resolution = 64;
        options.tolerance = (pvtLength){cases[c].tolerance, true};
        options.budget = 24;
        options.views.count = 64;
        const pvtQuadScore uniform = ScoreBuild(context, &options, 256, &hills);
        assert_true(uniform.precision > cases[c].precision);
        assert_true(uniform.recall > cases[c].recall);
    }
    pvtMesh_Free(context, &hills);
    DestroyTestContext(context);
}

// A roof high above the ground: all below it counts as inside, and hides many times what the roof
// hides from the side. Whatever a climb ends at costs more than all that is to be hidden is worth.
static void what_is_mostly_beyond_the_goal_has_an_occluder_yet(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    const pvtVec3 corners[] = {{0, 6, 0}, {10, 6, 0}, {10, 6, 0.8}, {0, 6, 0.8},
                               {0, 0, 0}, {1, 0, 0},  {1, 0, 0.8},  {0, 0, 0.8}};
    const uint32_t indices[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    pvtMesh roof;
    CHECK_OK(context, pvtCreateMesh(context, corners, 8, indices, 4, &roof));
    pvtBuildOptions options = GetQuickOptions();
    options.terrain = true;
    options.resolution = 64;
    for (int budget = 1; budget <= 16; budget += 5) {
        options.budget = budget;
        pvtOccluder occluder;
        CHECK_OK(context, pvtBuildOccluder(context, &options, &roof, &occluder, NULL));
        assert_true(occluder.mesh.triangleCount >= 1);
        assert_true(occluder.mesh.triangleCount <= (size_t)budget);
        pvtOccluder_Free(context, &occluder);
    }
    pvtMesh_Free(context, &roof);
    DestroyTestContext(context);
}

// Three voxels of wall, curved both ways: triangles pushed off its one side come through the other.
static void triangles_find_their_places_within_a_shell(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh bowl;
    MakeBowl(context, 0.08, &bowl);
    const pvtQuadScore score = ScoreOccluder(context, &bowl, 80, 40, 0.0);
    assert_true(score.precision == 1.0);
    assert_true(score.recall > 0.4);
    pvtMesh_Free(context, &bowl);
    DestroyTestContext(context);
}

// At 2²⁰ floats are an eighth apart, at 2²⁴ 2, which is more than the ring is high. The ascent goes
// by what is stored; the paper's polygons are made without.
static void what_floats_cannot_hold_stays_inside_or_is_told(void** state)
{
    (void)state;
    static const struct {
        double up;
        pvtMethod method;
        pvtStatus status;
        const char* told;
    } cases[] = {{0.0, PVT_METHOD_PLANAR, PVT_OK, NULL},
                 {0.0, PVT_METHOD_PAPER, PVT_OK, NULL},
                 {1048576.0, PVT_METHOD_PLANAR, PVT_OK, "stored in steps of 0.12,"},
                 {16777217.0, PVT_METHOD_PLANAR, PVT_NOTHING_INSIDE, "stored in steps of 2,"},
                 {16777217.0, PVT_METHOD_PAPER, PVT_OK, "stored in steps of 2,"}};
    Warnings warnings;
    pvtContext* context = CreateWarningContext(&warnings);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; ++c) {
        pvtMesh torus;
        MakeTorus(context, &torus);
        for (size_t i = 0; i < torus.positionCount; ++i) {
            torus.positions[i].y += cases[c].up;
        }
        pvtBuildOptions options = GetQuickOptions();
        options.method = cases[c].method;
        pvtOccluder occluder;
        pvtBuildStats stats;
        warnings.text[0] = '\0';
        assert_int_equal(pvtBuildOccluder(context, &options, &torus, &occluder, &stats),
                         cases[c].status);
        const char* text =
            cases[c].status == PVT_OK ? warnings.text : pvtContext_GetMessage(context);
        assert_int_equal(stats.outside > 0, c == 4);
        assert_true(cases[c].told == NULL ? text[0] == '\0' : strstr(text, cases[c].told) != NULL);
        pvtOccluder_Free(context, &occluder);
        pvtMesh_Free(context, &torus);
    }
    DestroyTestContext(context);
}

static void the_budget_holds_and_nothing_leaves_the_allowed_voxels(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh torus;
    MakeTorus(context, &torus);
    static const int budgets[] = {1, 30};
    for (int method = 0; method < 2; ++method) {
        for (int loose = 0; loose < 2; ++loose) {
            for (size_t b = 0; b < sizeof budgets / sizeof *budgets; ++b) {
                pvtBuildOptions options = GetQuickOptions();
                options.method = method == 0 ? PVT_METHOD_PLANAR : PVT_METHOD_PAPER;
                options.tolerance = (pvtLength){loose, true};
                options.budget = budgets[b];
                pvtOccluder occluder;
                pvtBuildStats stats;
                CHECK_OK(context, pvtBuildOccluder(context, &options, &torus, &occluder, &stats));
                assert_true(occluder.mesh.triangleCount >= 1);
                assert_true(occluder.mesh.triangleCount <= (size_t)budgets[b]);
                assert_true(stats.outside == 0);
                assert_true(stats.measure > 0.0);
                pvtOccluder_Free(context, &occluder);
            }
        }
    }
    pvtMesh_Free(context, &torus);
    DestroyTestContext(context);
}

// The middle of a ring is free: a ray along its axis must not meet the occluder.
static void the_hole_of_a_torus_stays_open(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh torus;
    MakeTorus(context, &torus);
    const pvtBuildOptions options = GetQuickOptions();
    pvtOccluder occluder;
    CHECK_OK(context, pvtBuildOccluder(context, &options, &torus, &occluder, NULL));
    for (size_t t = 0; t < occluder.mesh.triangleCount; ++t) {
        bool left = false;
        bool right = false;
        const uint32_t* corner = occluder.mesh.indices + 3 * t;
        for (int c = 0; c < 3; ++c) {
            const pvtVec3 a = occluder.mesh.positions[corner[c]];
            const pvtVec3 b = occluder.mesh.positions[corner[(c + 1) % 3]];
            const double side = a.x * b.z - a.z * b.x;
            left = left || side > 0.0;
            right = right || side < 0.0;
        }
        assert_true(left && right); // the axis passes outside of its projection
    }
    pvtOccluder_Free(context, &occluder);
    pvtMesh_Free(context, &torus);
    DestroyTestContext(context);
}

static void threads_do_not_change_a_byte(void** state)
{
    (void)state;
    pvtOccluder first = {0};
    pvtContext* keeper = CreateTestContext(1);
    for (int threads = 1; threads <= 4; threads *= 2) {
        pvtContext* context = threads == 1 ? keeper : CreateTestContext(threads);
        pvtMesh torus;
        MakeTorus(context, &torus);
        pvtBuildOptions options = GetQuickOptions();
        options.budget = 30;
        pvtOccluder occluder;
        CHECK_OK(context, pvtBuildOccluder(context, &options, &torus, &occluder, NULL));
        pvtMesh_Free(context, &torus);
        if (threads == 1) {
            first = occluder;
            continue;
        }
        assert_int_equal(occluder.mesh.positionCount, first.mesh.positionCount);
        assert_int_equal(occluder.mesh.triangleCount, first.mesh.triangleCount);
        assert_memory_equal(occluder.mesh.positions, first.mesh.positions,
                            first.mesh.positionCount * sizeof(pvtVec3));
        assert_memory_equal(occluder.mesh.indices, first.mesh.indices,
                            3 * first.mesh.triangleCount * sizeof(uint32_t));
        assert_true(occluder.measure == first.measure);
        pvtOccluder_Free(context, &occluder);
        DestroyTestContext(context);
    }
    pvtOccluder_Free(keeper, &first);
    DestroyTestContext(keeper);
}

static void an_error_sets_the_voxel_size_that_keeps_it(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh box;
    MakeBoxMesh(context, (pvtVec3){0, 0, 0}, (pvtVec3){4, 2, 2}, &box);
    pvtBuildOptions options = GetQuickOptions();
    options.error = 0.2;
    static const pvtLength tolerances[] = {{0.0, true}, {1.0, true}, {0.05, false}};
    for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; ++i) {
        options.tolerance = tolerances[i];
        pvtOccluder occluder;
        pvtBuildStats stats;
        CHECK_OK(context, pvtBuildOccluder(context, &options, &box, &occluder, &stats));
        CHECK_NEAR(stats.errorBound, 0.2, 1e-9);
        pvtOccluder_Free(context, &occluder);
    }
    options.tolerance = (pvtLength){0.3, false};
    pvtOccluder occluder;
    assert_int_equal(pvtBuildOccluder(context, &options, &box, &occluder, NULL),
                     PVT_INVALID_ARGUMENT);
    options.tolerance = (pvtLength){0.0, true};
    options.error = 1e-4;
    assert_int_equal(pvtBuildOccluder(context, &options, &box, &occluder, NULL), PVT_LIMIT);
    pvtMesh_Free(context, &box);
    DestroyTestContext(context);
}

static void a_sliver_has_nothing_inside_and_the_message_names_remedies(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtVec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0.5, 1e-4, 1e-5}};
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, corners, 3, NULL, 1, &mesh));
    const pvtBuildOptions options = GetQuickOptions();
    pvtOccluder occluder;
    assert_int_equal(pvtBuildOccluder(context, &options, &mesh, &occluder, NULL),
                     PVT_NOTHING_INSIDE);
    assert_non_null(strstr(pvtContext_GetMessage(context), "--smallest-hole"));
    assert_int_equal(occluder.mesh.triangleCount, 0);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void a_cancelled_build_leaves_nothing(void** state)
{
    (void)state;
    static const int questions[] = {0, 3, 50, 200};
    for (size_t i = 0; i < sizeof questions / sizeof *questions; ++i) {
        CancelCounter counter = {questions[i]};
        pvtContext* context = CreateCancelledContext(&counter, 1);
        pvtMesh torus;
        MakeTorus(context, &torus);
        const pvtBuildOptions options = GetQuickOptions();
        pvtOccluder occluder;
        assert_int_equal(pvtBuildOccluder(context, &options, &torus, &occluder, NULL),
                         PVT_CANCELLED);
        assert_null(occluder.planes);
        pvtMesh_Free(context, &torus);
        DestroyTestContext(context);
    }
}

// Says enough from the question after so many on.
typedef struct Patience {
    int questions, asked;
} Patience;

static bool IsEnough(void* user)
{
    Patience* patience = user;
    return patience->asked++ >= patience->questions;
}

static void BuildPatiently(pvtContext* context, Patience* patience, pvtOccluder* occluder,
                           pvtBuildStats* stats)
{
    pvtMesh torus;
    MakeTorus(context, &torus);
    pvtBuildOptions options = GetQuickOptions();
    options.isEnough = patience != NULL ? IsEnough : NULL;
    options.enoughUser = patience;
    CHECK_OK(context, pvtBuildOccluder(context, &options, &torus, occluder, stats));
    pvtMesh_Free(context, &torus);
}

static void what_the_caller_calls_enough_is_kept(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtOccluder whole, part;
    pvtBuildStats stats;
    Patience patience = {INT_MAX, 0};
    BuildPatiently(context, NULL, &whole, &stats);
    BuildPatiently(context, &patience, &part, &stats);
    assert_true(patience.asked > 200); // each of its steps is one
    assert_int_equal(part.mesh.positionCount, whole.mesh.positionCount);
    assert_memory_equal(part.mesh.positions, whole.mesh.positions,
                        whole.mesh.positionCount * sizeof(pvtVec3));
    pvtOccluder_Free(context, &part);
    const int all = patience.asked;
    const double most = stats.measure;
    for (int questions = 0; questions < all; questions += 1 + 3 * questions) {
        patience = (Patience){questions, 0};
        BuildPatiently(context, &patience, &part, &stats);
        assert_true(patience.asked > questions && patience.asked < questions + 8);
        assert_true(part.mesh.triangleCount >= 1 && part.mesh.triangleCount <= 64);
        assert_true(stats.outside == 0);
        assert_true(stats.measure > 0.7 * most);
        pvtOccluder_Free(context, &part);
    }
    pvtOccluder_Free(context, &whole);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cube_at_twelve_triangles_is_covered_to_within_a_voxel),
        cmocka_unit_test(an_occluder_never_hides_more_than_the_solid_at_any_resolution),
        cmocka_unit_test(a_budget_beyond_what_is_refined_hides_no_less),
        cmocka_unit_test(a_tolerance_hides_much_more_and_hardly_anything_that_is_seen),
        cmocka_unit_test(a_wall_is_covered_within_a_tolerance),
        cmocka_unit_test(a_landscape_is_covered_where_it_hides_something),
        cmocka_unit_test(what_is_mostly_beyond_the_goal_has_an_occluder_yet),
        cmocka_unit_test(triangles_find_their_places_within_a_shell),
        cmocka_unit_test(what_floats_cannot_hold_stays_inside_or_is_told),
        cmocka_unit_test(the_budget_holds_and_nothing_leaves_the_allowed_voxels),
        cmocka_unit_test(the_hole_of_a_torus_stays_open),
        cmocka_unit_test(threads_do_not_change_a_byte),
        cmocka_unit_test(an_error_sets_the_voxel_size_that_keeps_it),
        cmocka_unit_test(a_sliver_has_nothing_inside_and_the_message_names_remedies),
        cmocka_unit_test(a_cancelled_build_leaves_nothing),
        cmocka_unit_test(what_the_caller_calls_enough_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
