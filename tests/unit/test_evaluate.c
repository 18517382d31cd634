// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/random.h"
#include "evaluate/view.h"

#include <limits.h>
#include <math.h>
#include <paravent/evaluate.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static const pvtVec3 TOWARDS_MINUS_Z = {0, 0, -1};

// A rectangle in the plane z, facing +z.
typedef struct Sheet {
    pvtVec3 positions[4];
    uint32_t indices[6];
} Sheet;

static Sheet MakeSheet(double x0, double y0, double x1, double y1, double z)
{
    return (Sheet){{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}, {0, 1, 2, 0, 2, 3}};
}

static pvtMesh GetMesh(Sheet* sheet)
{
    return (pvtMesh){sheet->positions, sheet->indices, 4, 2};
}

// A ball with bumps, of 2 × segments × segments triangles; its poles are on the y axis.
static pvtMesh CreateBall(int segments, double radius, pvtVec3 center)
{
    const size_t count = (size_t)segments * (size_t)(segments + 1);
    pvtMesh mesh = {malloc(count * sizeof(pvtVec3)),
                    malloc((size_t)segments * (size_t)segments * 6 * sizeof(uint32_t)), count, 0};
    for (int j = 0; j <= segments; ++j) {
        for (int i = 0; i < segments; ++i) {
            const double a = 2 * M_PI * i / segments, b = M_PI * j / segments;
            const double r = radius * (1.0 + 0.2 * sin(3 * a) * sin(2 * b));
            mesh.positions[j * segments + i] =
                (pvtVec3){center.x + r * sin(b) * cos(a), center.y + r * cos(b),
                          center.z + r * sin(b) * sin(a)};
        }
    }
    for (int j = 0; j < segments; ++j) {
        for (int i = 0; i < segments; ++i) {
            const uint32_t next = (uint32_t)((i + 1) % segments), here = (uint32_t)i;
            const uint32_t row = (uint32_t)(j * segments), above = row + (uint32_t)segments;
            uint32_t* to = mesh.indices + 3 * mesh.triangleCount;
            memcpy(to,
                   (uint32_t[6]){row + here, row + next, above + here, above + here, row + next,
                                 above + next},
                   6 * sizeof *to);
            mesh.triangleCount += 2;
        }
    }
    return mesh;
}

static void FreeBall(pvtMesh* mesh)
{
    free(mesh->positions);
    free(mesh->indices);
}

static pvtEvaluateOptions MakeOptions(int views, int quads, int pixels)
{
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = views;
    options.quads = quads;
    options.pixels = pixels;
    return options;
}

static void AssertScore(const pvtQuadScore* score, double precision, double recall)
{
    assert_true(score->precision == precision);
    assert_true(score->recall == recall);
}

static void a_mesh_against_itself_is_perfect(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh ball = CreateBall(40, 1.0, (pvtVec3){5, 6, 7});
    const pvtEvaluateOptions options = MakeOptions(20, 1000, 200);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &ball, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    AssertScore(&score->uniform, 1.0, 1.0);
    AssertScore(&score->small, 1.0, 1.0);
    assert_true(score->uniform.hidden > 0 && score->uniform.lost == 0 && score->small.wrong == 0);
    assert_true(score->uniform.recallError == 0.0 && score->small.precisionError == 0.0);
    assert_true(score->coverage == 1.0 && score->overArea == 0.0 && score->overThickness == 0.0);
    assert_int_equal(score->triangleCount, ball.triangleCount);
    assert_int_equal(score->viewCount, 20);
    pvtEvaluation_Free(context, &evaluation);
    FreeBall(&ball);
    DestroyTestContext(context);
}

// Mean pixels of a quad's side, with both ends uniform over n pixels.
static double GetMeanSide(double n)
{
    return (n * n - 1.0) / (3.0 * n) + 1.0;
}

static void half_of_a_square_has_the_recall_of_the_closed_form(void** state)
{
    (void)state;
    enum { PIXELS = 256 };
    pvtContext* context = CreateTestContext(2);
    Sheet whole = MakeSheet(0, 0, 2, 2, 0), half = MakeSheet(0, 0, 1, 2, -1);
    const pvtMesh original = GetMesh(&whole), occluder = GetMesh(&half);
    pvtEvaluateOptions options = MakeOptions(1, 200000, PIXELS);
    options.directions = &TOWARDS_MINUS_Z;
    pvtEvaluation evaluation;
    CHECK_OK(context,
             pvtEvaluateOccluders(context, &options, &original, &occluder, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];

    const double uniform = 0.25 * GetMeanSide(PIXELS / 2) / GetMeanSide(PIXELS);
    double hidden = 0.0, all = 0.0;
    for (double side = 1; side <= PIXELS / 8; ++side) {
        all += side;
        hidden += side * (PIXELS / 2 - side + 1) / (PIXELS - side + 1);
    }
    assert_true(score->uniform.recallError > 0.0 && score->uniform.recallError < 0.003);
    assert_true(score->small.recallError > 0.0 && score->small.recallError < 0.003);
    assert_true(fabs(score->uniform.recall - uniform) < 4.0 * score->uniform.recallError);
    assert_true(fabs(score->small.recall - hidden / all) < 4.0 * score->small.recallError);
    assert_true(score->uniform.precision == 1.0 && score->small.precision == 1.0);
    assert_true(score->coverage == 0.5 && score->overArea == 0.0);
    pvtEvaluation_Free(context, &evaluation);
    DestroyTestContext(context);
}

// The original is the half now, in a box as wide as the square because of a triangle without area.
static void a_square_over_its_half_has_the_precision_of_the_closed_form(void** state)
{
    (void)state;
    enum { PIXELS = 256 };
    pvtContext* context = CreateTestContext(2);
    pvtVec3 positions[5] = {{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}, {2, 1, 0}};
    uint32_t indices[9] = {0, 1, 2, 0, 2, 3, 0, 4, 4};
    const pvtMesh original = {positions, indices, 5, 3};
    Sheet whole = MakeSheet(0, 0, 2, 2, -1);
    const pvtMesh occluder = GetMesh(&whole);
    pvtEvaluateOptions options = MakeOptions(1, 100000, PIXELS);
    options.directions = &TOWARDS_MINUS_Z;
    pvtEvaluation evaluation;
    CHECK_OK(context,
             pvtEvaluateOccluders(context, &options, &original, &occluder, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    // By symmetry half of all quads' pixels lie in the empty half, and each of them is wrong.
    const double hidden = 0.25 * GetMeanSide(PIXELS / 2), wrong = 0.5 * GetMeanSide(PIXELS);
    const double precision = hidden / (hidden + wrong);
    assert_true(score->uniform.precisionError > 0.0 && score->uniform.precisionError < 0.003);
    assert_true(fabs(score->uniform.precision - precision) < 4.0 * score->uniform.precisionError);
    assert_true(score->uniform.recall == 1.0 && score->small.recall == 1.0);
    assert_true(score->coverage == 1.0);
    assert_true(fabs(score->overArea - 2.0) < 1e-9);
    assert_true(fabs(score->overThickness - 1.0) <= 2.0 / PIXELS);
    pvtEvaluation_Free(context, &evaluation);
    DestroyTestContext(context);
}

static void what_reaches_over_the_box_is_excess(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    // 200 × 100 pixels; the occluder reaches over the box on all sides.
    Sheet half = MakeSheet(0, 0, 2, 1, 0), whole = MakeSheet(-1, -1, 3, 3, -1);
    const pvtMesh original = GetMesh(&half), occluder = GetMesh(&whole);
    pvtEvaluateOptions options = MakeOptions(1, 20000, 200);
    options.directions = &TOWARDS_MINUS_Z;
    pvtEvaluation evaluation;
    CHECK_OK(context,
             pvtEvaluateOccluders(context, &options, &original, &occluder, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    // Quads lie over the original's box, which it fills: no quad is wrong, only the area tells.
    AssertScore(&score->uniform, 1.0, 1.0);
    assert_true(score->coverage == 1.0);
    assert_true(fabs(score->overArea - (16.0 - 2.0)) < 1e-9);
    // The corner of the sheet is (1, 2) from the rectangle's: pixel centres stay a pixel within.
    assert_true(fabs(score->overThickness - sqrt(5.0)) <= sqrt(2.0) * 2.0 / 200);
    pvtEvaluation_Free(context, &evaluation);
    DestroyTestContext(context);
}

// Standard errors are claims: over many seeds the spread of the recall is what they say.
static void sampling_errors_are_what_the_spread_over_seeds_is(void** state)
{
    (void)state;
    enum { SEEDS = 40 };
    pvtContext* context = CreateTestContext(2);
    pvtMesh ball = CreateBall(12, 1.0, (pvtVec3){0, 0, 0});
    Sheet sheet = MakeSheet(-0.6, -0.6, 0.6, 0.6, 0);
    const pvtMesh occluder = GetMesh(&sheet);
    double sum = 0.0, squares = 0.0, claimed = 0.0;
    for (int seed = 0; seed < SEEDS; ++seed) {
        pvtEvaluateOptions options = MakeOptions(48, 500, 64);
        options.seed = (uint64_t)seed;
        pvtEvaluation evaluation;
        CHECK_OK(context,
                 pvtEvaluateOccluders(context, &options, &ball, &occluder, 1, &evaluation));
        const pvtQuadScore* score = &evaluation.occluders[0].small;
        sum += score->recall;
        squares += score->recall * score->recall;
        claimed += score->recallError / SEEDS;
        pvtEvaluation_Free(context, &evaluation);
    }
    const double mean = sum / SEEDS;
    const double spread = sqrt((squares - sum * mean) / (SEEDS - 1));
    assert_true(claimed > 0.0);
    assert_true(spread / claimed > 0.6 && spread / claimed < 1.6);
    FreeBall(&ball);
    DestroyTestContext(context);
}

static void a_shifted_occluder_is_as_thick_as_its_projected_shift(void** state)
{
    (void)state;
    enum { VIEWS = 24, PIXELS = 256 };
    pvtContext* context = CreateTestContext(2);
    pvtMesh ball = CreateBall(60, 1.0, (pvtVec3){0, 0, 0});
    static const double shifts[] = {0.05, 0.4, 7.0};
    for (size_t s = 0; s < 3; ++s) {
        // A ball that is convex and smooth: what sticks out farthest is the shift's full length.
        const double x = shifts[s];
        pvtMesh round = CreateBall(60, 1.0, (pvtVec3){0, 0, 0});
        for (size_t i = 0; i < round.positionCount; ++i) {
            pvtVec3* p = &round.positions[i];
            const double r = sqrt(p->x * p->x + p->y * p->y + p->z * p->z);
            *p = (pvtVec3){p->x / r, p->y / r, p->z / r};
            ball.positions[i] = *p;
            p->x += x;
        }
        const pvtEvaluateOptions options = MakeOptions(VIEWS, 100, PIXELS);
        pvtEvaluation evaluation;
        CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &round, 1, &evaluation));
        for (size_t v = 0; v < VIEWS; ++v) {
            const pvtViewScore* view = &evaluation.occluders[0].views[v];
            const double along = view->direction.x;
            const double expected = x * sqrt(1.0 - along * along);
            assert_true(fabs(view->overThickness - expected) <= 1.5 * 2.0 / PIXELS);
        }
        pvtEvaluation_Free(context, &evaluation);
        FreeBall(&round);
    }
    FreeBall(&ball);
    DestroyTestContext(context);
}

static void bytes_do_not_depend_on_threads_or_company(void** state)
{
    (void)state;
    pvtMesh ball = CreateBall(30, 1.0, (pvtVec3){0, 0, 0});
    Sheet sheets[2] = {MakeSheet(-0.5, -0.5, 0.5, 0.5, 0), MakeSheet(-2, -0.1, 2, 0.3, 0.2)};
    const pvtMesh occluders[2] = {GetMesh(&sheets[0]), GetMesh(&sheets[1])};
    const pvtEvaluateOptions options = MakeOptions(33, 300, 96);
    pvtViewScore kept[2][33];
    pvtQuadScore sums[2];
    for (int threads = 1; threads <= 4; ++threads) {
        pvtContext* context = CreateTestContext(threads);
        pvtEvaluation evaluation;
        CHECK_OK(context,
                 pvtEvaluateOccluders(context, &options, &ball, occluders, 2, &evaluation));
        for (int i = 0; i < 2; ++i) {
            const pvtOccluderScore* score = &evaluation.occluders[i];
            if (threads == 1) {
                memcpy(kept[i], score->views, sizeof kept[i]);
                sums[i] = score->uniform;
            }
            assert_memory_equal(kept[i], score->views, sizeof kept[i]);
            assert_memory_equal(&sums[i], &score->uniform, sizeof sums[i]);
        }
        pvtEvaluation alone;
        CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &occluders[1], 1, &alone));
        assert_memory_equal(kept[1], alone.occluders[0].views, sizeof kept[1]);
        pvtEvaluation_Free(context, &alone);
        pvtEvaluation_Free(context, &evaluation);
        DestroyTestContext(context);
    }
    FreeBall(&ball);
}

static void sums_and_the_worst_view_follow_from_the_views(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh ball = CreateBall(30, 1.0, (pvtVec3){0, 0, 0});
    Sheet sheet = MakeSheet(-2, -0.5, 2, 0.5, 0);
    const pvtMesh occluder = GetMesh(&sheet);
    const pvtEvaluateOptions options = MakeOptions(40, 400, 96);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &occluder, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    uint64_t hidden = 0, lost = 0, wrong = 0;
    double coverage = 0.0, thickness = 0.0;
    size_t worst = 0;
    for (size_t v = 0; v < score->viewCount; ++v) {
        const pvtViewScore* view = &score->views[v];
        hidden += view->uniform.hidden;
        lost += view->uniform.lost;
        wrong += view->uniform.wrong;
        coverage += view->coverage / (double)score->viewCount;
        thickness = fmax(thickness, view->overThickness);
        worst = view->uniform.recall < score->views[worst].uniform.recall ? v : worst;
    }
    assert_true(hidden > 0 && lost > 0 && wrong > 0);
    assert_true(score->uniform.recall == (double)hidden / (double)(hidden + lost));
    assert_true(score->uniform.precision == (double)hidden / (double)(hidden + wrong));
    assert_true(fabs(score->coverage - coverage) < 1e-12);
    assert_true(score->overThickness == thickness);
    assert_int_equal(score->worstView, worst);
    pvtEvaluation_Free(context, &evaluation);
    FreeBall(&ball);
    DestroyTestContext(context);
}

static void directions_cover_the_sphere_evenly(void** state)
{
    (void)state;
    enum { COUNT = 8000 };
    const pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    int octants[8] = {0}, caps = 0;
    for (int v = 0; v < COUNT; ++v) {
        const pvtVec3 d = pvtGetViewDirection(&options, v);
        assert_true(fabs(d.x * d.x + d.y * d.y + d.z * d.z - 1.0) < 1e-12);
        ++octants[(d.x > 0) + 2 * (d.y > 0) + 4 * (d.z > 0)];
        caps += fabs(d.y) > 0.5; // half of the sphere's area, by Archimedes
    }
    for (int k = 0; k < 8; ++k) {
        assert_in_range(octants[k], 850, 1150); // 1000 ± 5 σ
    }
    assert_in_range(caps, 3770, 4230);
}

static void AssertFinite(const pvtOccluderScore* score)
{
    for (size_t v = 0; v < score->viewCount; ++v) {
        const pvtViewScore* s = &score->views[v];
        assert_true(isfinite(s->uniform.precision) && isfinite(s->uniform.recall));
        assert_true(isfinite(s->small.precision) && isfinite(s->small.recall));
        assert_true(isfinite(s->coverage) && isfinite(s->overArea) && isfinite(s->overThickness));
        assert_true(s->coverage >= 0.0 && s->coverage <= 1.0);
    }
    assert_true(isfinite(score->uniform.precisionError) && isfinite(score->uniform.recallError));
    assert_true(isfinite(score->small.precisionError) && isfinite(score->small.recallError));
    assert_true(isfinite(score->coverage) && isfinite(score->overArea));
    assert_true(isfinite(score->overThickness));
}

static void an_empty_occluder_hides_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh ball = CreateBall(10, 1.0, (pvtVec3){0, 0, 0});
    const pvtMesh none = {0};
    const pvtEvaluateOptions options = MakeOptions(8, 200, 64);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &none, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    AssertScore(&score->uniform, 1.0, 0.0);
    AssertScore(&score->small, 1.0, 0.0);
    assert_true(score->coverage == 0.0 && score->overArea == 0.0 && score->overThickness == 0.0);
    pvtEvaluation_Free(context, &evaluation);
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, NULL, 0, &evaluation));
    assert_int_equal(evaluation.count, 0);
    pvtEvaluation_Free(context, &evaluation);
    FreeBall(&ball);
    DestroyTestContext(context);
}

static void a_disjoint_occluder_only_hides_wrongly(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh ball = CreateBall(20, 1.0, (pvtVec3){0, 0, 0});
    pvtMesh far = CreateBall(20, 1.0, (pvtVec3){1e5, 3e5, -2e5});
    const pvtEvaluateOptions options = MakeOptions(6, 200, 64);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &far, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    AssertFinite(score);
    AssertScore(&score->uniform, 1.0, 0.0);
    assert_true(score->coverage == 0.0);
    for (size_t v = 0; v < score->viewCount; ++v) {
        const pvtVec3 d = score->views[v].direction;
        const double along = 1e5 * d.x + 3e5 * d.y - 2e5 * d.z;
        const double away = sqrt(14e10 - along * along);
        // Pixels are so coarse here that the far ball may fall between them.
        assert_true(score->views[v].overThickness <= 1.01 * away);
    }
    pvtEvaluation_Free(context, &evaluation);
    FreeBall(&ball);
    FreeBall(&far);
    DestroyTestContext(context);
}

// 10,000 times as large: 640,000 pixels a side, were they not made coarser.
static void the_excess_of_an_immense_occluder_is_measured_in_coarser_pixels(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Sheet small = MakeSheet(-0.5, -0.5, 0.5, 0.5, 0), large = MakeSheet(-5e3, -5e3, 5e3, 5e3, -1);
    const pvtMesh original = GetMesh(&small), occluder = GetMesh(&large);
    pvtEvaluateOptions options = MakeOptions(1, 200, 64);
    options.directions = &TOWARDS_MINUS_Z;
    pvtEvaluation evaluation;
    CHECK_OK(context,
             pvtEvaluateOccluders(context, &options, &original, &occluder, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    AssertScore(&score->uniform, 1.0, 1.0);
    assert_true(score->coverage == 1.0);
    assert_true(fabs(score->overArea / 1e8 - 1.0) < 0.002);
    assert_true(fabs(score->overThickness / (5e3 * sqrt(2.0)) - 1.0) < 0.002);
    assert_true(pvtContext_GetPeakBytes(context) < 32u << 20);
    pvtEvaluation_Free(context, &evaluation);
    DestroyTestContext(context);
}

static void an_original_seen_edge_on_has_no_recall_to_lose(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Sheet sheet = MakeSheet(0, 0, 1, 1, 0);
    const pvtMesh flat = GetMesh(&sheet);
    pvtMesh ball = CreateBall(20, 0.5, (pvtVec3){0.5, 0.5, 0});
    const pvtVec3 edgeOn = {1, 0, 0};
    pvtEvaluateOptions options = MakeOptions(1, 200, 64);
    options.directions = &edgeOn;
    pvtEvaluation evaluation;
    const pvtMesh occluders[2] = {flat, ball};
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &flat, occluders, 2, &evaluation));
    AssertFinite(&evaluation.occluders[0]);
    AssertFinite(&evaluation.occluders[1]);
    AssertScore(&evaluation.occluders[0].uniform, 1.0, 1.0);
    assert_true(evaluation.occluders[0].coverage == 1.0);
    // The ball hides quads where the sheet, being thin, hides none.
    AssertScore(&evaluation.occluders[1].uniform, 0.0, 1.0);
    assert_true(evaluation.occluders[1].coverage == 1.0);
    // Its picture is a disc on both sides of a line, which stands for the sheet.
    assert_true(fabs(evaluation.occluders[1].overThickness - 0.5) < 0.13);
    pvtEvaluation_Free(context, &evaluation);
    FreeBall(&ball);
    DestroyTestContext(context);
}

static void points_needles_and_giants_have_finite_scores(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    static const double sizes[] = {0.0, 1e-300, 1e-30, 1.0, 1e30, 1e99};
    const pvtEvaluateOptions options = MakeOptions(3, 50, 32);
    for (size_t a = 0; a < 6; ++a) {
        for (size_t b = 0; b < 6; ++b) {
            Sheet sheets[3] = {MakeSheet(0, 0, sizes[a], sizes[a], 0),
                               MakeSheet(-sizes[b], 0, sizes[b], sizes[b], 0),
                               MakeSheet(0, 0, 0, sizes[b], 0)};
            const pvtMesh original = GetMesh(&sheets[0]);
            const pvtMesh occluders[2] = {GetMesh(&sheets[1]), GetMesh(&sheets[2])};
            pvtEvaluation evaluation;
            CHECK_OK(context,
                     pvtEvaluateOccluders(context, &options, &original, occluders, 2, &evaluation));
            AssertFinite(&evaluation.occluders[0]);
            AssertFinite(&evaluation.occluders[1]);
            pvtEvaluation_Free(context, &evaluation);
        }
    }
    DestroyTestContext(context);
}

static void AssertRefused(pvtContext* context, const pvtEvaluateOptions* options,
                          const pvtMesh* original, const pvtMesh* occluder, pvtStatus status)
{
    pvtEvaluation evaluation;
    assert_int_equal(pvtEvaluateOccluders(context, options, original, occluder, 1, &evaluation),
                     status);
    assert_true(pvtContext_GetMessage(context)[0] != 0);
    assert_null(evaluation.occluders);
    assert_int_equal(evaluation.count, 0);
    pvtEvaluation_Free(context, &evaluation);
}

static void what_cannot_be_judged_is_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    const pvtEvaluateOptions good = MakeOptions(2, 10, 16);
    Sheet sheet = MakeSheet(0, 0, 1, 1, 0), wild = sheet, loose = sheet, distant = sheet;
    wild.positions[2].y = NAN;
    distant.positions[1].x = 2e100;
    loose.indices[5] = 4;
    const pvtMesh mesh = GetMesh(&sheet), none = {0};
    const pvtMesh bad[3] = {GetMesh(&wild), GetMesh(&loose), GetMesh(&distant)};
    for (size_t i = 0; i < 3; ++i) {
        AssertRefused(context, &good, &bad[i], &mesh, PVT_INVALID_INPUT);
        assert_non_null(strstr(pvtContext_GetMessage(context), "original"));
        AssertRefused(context, &good, &mesh, &bad[i], PVT_INVALID_INPUT);
        assert_non_null(strstr(pvtContext_GetMessage(context), "occluder 1"));
    }
    AssertRefused(context, &good, &none, &mesh, PVT_INVALID_INPUT);
    const pvtEvaluateOptions wrong[] = {MakeOptions(0, 10, 16), MakeOptions(65537, 10, 16),
                                        MakeOptions(2, 0, 16),  MakeOptions(2, 10000001, 16),
                                        MakeOptions(2, 10, 15), MakeOptions(2, 10, 4097)};
    for (size_t i = 0; i < 6; ++i) {
        AssertRefused(context, &wrong[i], &mesh, &mesh, PVT_INVALID_ARGUMENT);
    }
    pvtEvaluateOptions nowhere = good;
    const pvtVec3 directions[2] = {{1, 0, 0}, {0, 0, 0}};
    nowhere.directions = directions;
    AssertRefused(context, &nowhere, &mesh, &mesh, PVT_INVALID_ARGUMENT);
    DestroyTestContext(context);
}

// A position that no triangle uses may be anything.
static void unused_positions_do_not_count(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtVec3 positions[5] = {{0, 0, 0}, {NAN, 0, 0}, {1, 0, 0}, {1e300, 0, 0}, {0, 1, 0}};
    uint32_t indices[3] = {0, 2, 4};
    const pvtMesh mesh = {positions, indices, 5, 1};
    const pvtEvaluateOptions options = MakeOptions(2, 100, 32);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &mesh, &mesh, 1, &evaluation));
    AssertScore(&evaluation.occluders[0].small, 1.0, 1.0);
    assert_true(evaluation.occluders[0].small.hidden > 0);
    pvtEvaluation_Free(context, &evaluation);
    DestroyTestContext(context);
}

typedef struct Watch {
    atomic_int asked;
    int patience;
    double last;
    int reports;
} Watch;

static bool IsOutOfPatience(void* user)
{
    Watch* watch = user;
    return atomic_fetch_add(&watch->asked, 1) >= watch->patience;
}

static void WatchProgress(const char* stage, double fraction, void* user)
{
    Watch* watch = user;
    assert_string_equal(stage, "evaluate");
    assert_true(fraction >= watch->last && fraction <= 1.0);
    watch->last = fraction;
    ++watch->reports;
}

static void cancelling_leaves_nothing_and_progress_only_grows(void** state)
{
    (void)state;
    pvtMesh ball = CreateBall(20, 1.0, (pvtVec3){0, 0, 0});
    const pvtEvaluateOptions options = MakeOptions(16, 100, 32);
    Watch watch = {.patience = INT_MAX};
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = 2;
    def.isCancelled = IsOutOfPatience;
    def.progress = WatchProgress;
    def.user = &watch;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &ball, 1, &evaluation));
    pvtEvaluation_Free(context, &evaluation);
    assert_true(watch.reports > 1);
    const int all = atomic_load(&watch.asked);
    assert_true(all > 16 * 4);
    for (int patience = 0; patience < all - 1; patience += 1 + patience / 3) {
        watch = (Watch){.patience = patience};
        AssertRefused(context, &options, &ball, &ball, PVT_CANCELLED);
    }
    FreeBall(&ball);
    DestroyTestContext(context);
}

static const uint8_t* GetPixel(const pvtImage* image, int x, int y)
{
    return image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
}

static void AssertColour(const pvtImage* image, int x, int y, const uint8_t colour[3])
{
    const uint8_t* pixel = GetPixel(image, x, y);
    assert_memory_equal(pixel, colour, 3);
    assert_int_equal(pixel[3], 255);
}

// A square, and an occluder over its upper right quarter and as much beyond it.
static void silhouettes_are_black_yellow_and_blue_on_white(void** state)
{
    (void)state;
    static const uint8_t white[3] = {255, 255, 255}, black[3] = {0, 0, 0};
    static const uint8_t blue[3] = {30, 80, 230}, yellow[3] = {255, 221, 0};
    pvtContext* context = CreateTestContext(2);
    Sheet square = MakeSheet(0, 0, 2, 2, 0), corner = MakeSheet(1, 1, 3, 3, 1);
    const pvtMesh original = GetMesh(&square), occluder = GetMesh(&corner);
    const pvtVec3 directions[2] = {{0, 0, -5}, {0, 0, 1}};
    pvtSilhouetteOptions options = pvtDefaultSilhouetteOptions();
    options.directions = directions;
    options.count = 2;
    options.width = 100;
    options.height = 64; // 60 pixels for 3 units
    options.margin = 2;
    pvtImage images[2];
    CHECK_OK(context, pvtDrawSilhouettes(context, &options, &original, &occluder, images));
    AssertColour(&images[0], 1, 32, white);
    AssertColour(&images[0], 25, 57, black);
    AssertColour(&images[0], 50, 32, yellow);
    AssertColour(&images[0], 74, 6, blue);
    AssertColour(&images[0], 25, 6, white);
    AssertColour(&images[0], 74, 57, white);
    // From behind, left is right.
    AssertColour(&images[1], 74, 57, black);
    AssertColour(&images[1], 25, 6, blue);
    uint64_t counts[4] = {0};
    for (int i = 0; i < 6400; ++i) {
        const uint8_t* pixel = images[0].pixels + 4 * i;
        const uint8_t* colours[4] = {white, black, blue, yellow};
        for (int k = 0; k < 4; ++k) {
            counts[k] += memcmp(pixel, colours[k], 3) == 0;
        }
    }
    assert_int_equal(counts[1], 1200); // three quarters of 40 × 40
    assert_int_equal(counts[2], 1200);
    assert_int_equal(counts[3], 400);
    for (int i = 0; i < 2; ++i) {
        pvtImage_Free(context, &images[i]);
    }
    options.margin = 16;
    assert_int_equal(pvtDrawSilhouettes(context, &options, &original, &occluder, images),
                     PVT_INVALID_ARGUMENT);
    assert_null(images[1].pixels);
    DestroyTestContext(context);
}

// An allocator that serves so many requests and no more.
static void* AllocateSome(void* user, size_t size)
{
    return atomic_fetch_sub((atomic_int*)user, 1) > 0 ? malloc(size) : NULL;
}

static void ReleaseSome(void* user, void* memory)
{
    (void)user;
    free(memory);
}

static void each_refused_allocation_is_told_and_leaks_nothing(void** state)
{
    (void)state;
    pvtMesh ball = CreateBall(8, 1.0, (pvtVec3){0, 0, 0});
    pvtMesh other = CreateBall(8, 1.1, (pvtVec3){500, 0.1, 0}); // needs the coarse pictures too
    const pvtMesh occluders[2] = {ball, other};
    const pvtEvaluateOptions options = MakeOptions(3, 10, 32);
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int served = 1; status != PVT_OK; ++served) {
        atomic_int left = served;
        pvtContextDef def = pvtDefaultContextDef();
        def.allocator = (pvtAllocator){AllocateSome, ReleaseSome, &left};
        def.threadCount = 1;
        pvtContext* context = NULL;
        assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
        pvtEvaluation evaluation;
        status = pvtEvaluateOccluders(context, &options, &ball, occluders, 2, &evaluation);
        assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
        assert_true(status != PVT_OK || served > 12);
        assert_true((status == PVT_OK) == (evaluation.occluders != NULL));
        pvtEvaluation_Free(context, &evaluation);

        atomic_store(&left, served);
        const pvtVec3 direction = {1, 2, 3};
        pvtSilhouetteOptions silhouettes = {&direction, 1, 16, 16, 1};
        pvtImage image;
        const pvtStatus drawn = pvtDrawSilhouettes(context, &silhouettes, &ball, &other, &image);
        assert_true(drawn == PVT_OK || drawn == PVT_OUT_OF_MEMORY);
        assert_true((drawn == PVT_OK) == (image.pixels != NULL));
        pvtImage_Free(context, &image);
        DestroyTestContext(context);
    }
    FreeBall(&ball);
    FreeBall(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mesh_against_itself_is_perfect),
        cmocka_unit_test(half_of_a_square_has_the_recall_of_the_closed_form),
        cmocka_unit_test(a_square_over_its_half_has_the_precision_of_the_closed_form),
        cmocka_unit_test(sampling_errors_are_what_the_spread_over_seeds_is),
        cmocka_unit_test(what_reaches_over_the_box_is_excess),
        cmocka_unit_test(a_shifted_occluder_is_as_thick_as_its_projected_shift),
        cmocka_unit_test(bytes_do_not_depend_on_threads_or_company),
        cmocka_unit_test(sums_and_the_worst_view_follow_from_the_views),
        cmocka_unit_test(directions_cover_the_sphere_evenly),
        cmocka_unit_test(an_empty_occluder_hides_nothing),
        cmocka_unit_test(a_disjoint_occluder_only_hides_wrongly),
        cmocka_unit_test(the_excess_of_an_immense_occluder_is_measured_in_coarser_pixels),
        cmocka_unit_test(an_original_seen_edge_on_has_no_recall_to_lose),
        cmocka_unit_test(points_needles_and_giants_have_finite_scores),
        cmocka_unit_test(what_cannot_be_judged_is_refused),
        cmocka_unit_test(unused_positions_do_not_count),
        cmocka_unit_test(cancelling_leaves_nothing_and_progress_only_grows),
        cmocka_unit_test(silhouettes_are_black_yellow_and_blue_on_white),
        cmocka_unit_test(each_refused_allocation_is_told_and_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
