// SPDX-License-Identifier: MIT
// What is empty, flat, far away, wrong, cancelled or short of memory.
#include "evaluate_shapes.h"
#include "failures.h"

#include <limits.h>

static const pvtVec3 TOWARDS_MINUS_Z = {0, 0, -1};

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

static pvtContext* CreateWatchedContext(Watch* watch, pvtParallelForFcn* parallelFor)
{
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = 2;
    def.parallelFor = parallelFor;
    def.isCancelled = IsOutOfPatience;
    def.progress = WatchProgress;
    def.user = watch;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    return context;
}

static void cancelling_leaves_nothing_and_progress_only_grows(void** state)
{
    (void)state;
    pvtMesh ball = CreateBall(20, 1.0, (pvtVec3){0, 0, 0});
    const pvtEvaluateOptions options = MakeOptions(16, 100, 32);
    Watch watch = {.patience = INT_MAX};
    pvtContext* context = CreateWatchedContext(&watch, NULL);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &ball, 1, &evaluation));
    pvtEvaluation_Free(context, &evaluation);
    assert_true(watch.reports > 1 && watch.last == 1.0);
    const int all = atomic_load(&watch.asked);
    assert_true(all > 16 * 4);
    for (int patience = 0; patience < all - 1; patience += 1 + patience / 3) {
        watch = (Watch){.patience = patience};
        AssertRefused(context, &options, &ball, &ball, PVT_CANCELLED);
    }
    FreeBall(&ball);
    DestroyTestContext(context);
}

// All on the second worker, as when the caller's thread gets no time of a busy machine.
static void RunOnOtherWorker(pvtTaskFcn* task, size_t count, size_t minRange, void* taskData,
                             void* user)
{
    (void)minRange;
    (void)user;
    task(0, count, 1, taskData);
}

static void the_end_is_reported_even_when_the_caller_did_nothing(void** state)
{
    (void)state;
    pvtMesh ball = CreateBall(8, 1.0, (pvtVec3){0, 0, 0});
    const pvtEvaluateOptions options = MakeOptions(4, 10, 32);
    Watch watch = {.patience = INT_MAX};
    pvtContext* context = CreateWatchedContext(&watch, RunOnOtherWorker);
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, &ball, &ball, 1, &evaluation));
    pvtEvaluation_Free(context, &evaluation);
    assert_int_equal(watch.reports, 2);
    assert_true(watch.last == 1.0);
    FreeBall(&ball);
    DestroyTestContext(context);
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
        PoorHeap heap = {.failAt = served};
        pvtContext* context = CreatePoorContext(&heap);
        pvtEvaluation evaluation;
        status = pvtEvaluateOccluders(context, &options, &ball, occluders, 2, &evaluation);
        assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
        assert_true(status != PVT_OK || served > 12);
        assert_true((status == PVT_OK) == (evaluation.occluders != NULL));
        pvtEvaluation_Free(context, &evaluation);

        atomic_store(&heap.requests, 0);
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
        cmocka_unit_test(an_empty_occluder_hides_nothing),
        cmocka_unit_test(a_disjoint_occluder_only_hides_wrongly),
        cmocka_unit_test(the_excess_of_an_immense_occluder_is_measured_in_coarser_pixels),
        cmocka_unit_test(an_original_seen_edge_on_has_no_recall_to_lose),
        cmocka_unit_test(points_needles_and_giants_have_finite_scores),
        cmocka_unit_test(what_cannot_be_judged_is_refused),
        cmocka_unit_test(unused_positions_do_not_count),
        cmocka_unit_test(the_end_is_reported_even_when_the_caller_did_nothing),
        cmocka_unit_test(cancelling_leaves_nothing_and_progress_only_grows),
        cmocka_unit_test(each_refused_allocation_is_told_and_leaks_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
