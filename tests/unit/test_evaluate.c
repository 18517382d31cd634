// SPDX-License-Identifier: MIT
#include "evaluate_shapes.h"

#include "evaluate/view.h"

static const pvtVec3 TOWARDS_MINUS_Z = {0, 0, -1};

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
    double spread = 0.0;
    for (size_t v = 0; v < score->viewCount; ++v) {
        spread += pow(score->views[v].coverage - coverage, 2.0);
    }
    assert_true(fabs(score->coverageError - sqrt(spread / 39.0 / 40.0)) < 1e-12);
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

// Nothing but the four operations and roots goes into the numbers, so that they are the same on
// every machine. These were also found by a program in another language, written from
// lib/PIPELINE.md alone. Who changes a definition changes these, and that file.
static void numbers_stay_what_they_were(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtVec3 positions[4] = {{-1, -1, -1}, {1, -1, 0}, {0, -1, 1}, {0.25, 1, 0}};
    uint32_t indices[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const pvtMesh tetrahedron = {positions, indices, 4, 4};
    Sheet sheet = MakeSheet(-0.5, -1.125, 0.5, 0.25, 0);
    const pvtMesh occluder = GetMesh(&sheet);
    const pvtEvaluateOptions options = MakeOptions(16, 1000, 100);
    pvtEvaluation evaluation;
    CHECK_OK(context,
             pvtEvaluateOccluders(context, &options, &tetrahedron, &occluder, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    const uint64_t found[6] = {score->uniform.hidden, score->uniform.lost, score->uniform.wrong,
                               score->small.hidden,   score->small.lost,   score->small.wrong};
    static const uint64_t golden[6] = {115454, 642942, 3456, 67572, 154219, 2797};
    for (int i = 0; i < 6; ++i) {
        assert_int_equal(found[i], golden[i]);
    }
    pvtEvaluation_Free(context, &evaluation);
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
        cmocka_unit_test(numbers_stay_what_they_were),
        cmocka_unit_test(silhouettes_are_black_yellow_and_blue_on_white),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
