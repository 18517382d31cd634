// SPDX-License-Identifier: MIT
// Candidates, the two ways to choose among them, and refinement, on a solid of two balls.
#include "check.h"

#include "occluder/occluder.h"
#include "occluder/refine.h"
#include "voxel_shapes.h"

#include <paravent/occluder.h>

enum { SIDE = 40 };

typedef struct Fixture {
    pvtBitGrid grid;
    pvtSliceVolume volume;
    pvtSectionSet sections;
    pvtCandidateSet candidates;
    pvtViewSet views;
    pvtSelectOptions options;
} Fixture;

static void CreateFixture(pvtContext* context, Fixture* fixture)
{
    *fixture = (Fixture){0};
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, &fixture->grid);
    SetBall(&fixture->grid, (pvtVec3){14.0, SIDE / 2.0, SIDE / 2.0}, 11.0);
    SetBall(&fixture->grid, (pvtVec3){31.0, SIDE / 2.0, SIDE / 2.0}, 5.0);
    CHECK_OK(context, pvtCreateSliceVolume(context, &fixture->grid, &fixture->volume));
    pvtPlanOptions plan = pvtDefaultPlanOptions();
    plan.directions = 8;
    plan.depths = 8;
    pvtSectionPlan planned;
    CHECK_OK(context, pvtPlanSections(context, &plan, &fixture->grid, &planned));
    const pvtSearchOptions search = pvtDefaultSearchOptions();
    CHECK_OK(context,
             pvtSearchSections(context, &search, &fixture->volume, &planned, &fixture->sections));
    pvtSectionPlan_Free(context, &planned);
    const pvtCandidateOptions options = pvtDefaultCandidateOptions();
    CHECK_OK(context, pvtBuildCandidates(context, &options, &fixture->volume, &fixture->sections,
                                         &fixture->candidates));
    pvtViewOptions views = pvtDefaultViewOptions();
    views.count = 8;
    CHECK_OK(context, pvtMakeViews(context, &views, &fixture->views));
    fixture->options = pvtDefaultSelectOptions();
    fixture->options.views = &fixture->views;
    fixture->options.bounds = (pvtBox3){{0, 0, 0}, {SIDE, SIDE, SIDE}};
}

static void FreeFixture(pvtContext* context, Fixture* fixture)
{
    pvtViewSet_Free(context, &fixture->views);
    pvtCandidateSet_Free(context, &fixture->candidates);
    pvtSectionSet_Free(context, &fixture->sections);
    pvtSliceVolume_Free(context, &fixture->volume);
    pvtBitGrid_Free(context, &fixture->grid);
}

static double Measure(pvtContext* context, const Fixture* fixture, const pvtOccluder* occluder)
{
    double measure = 0.0;
    CHECK_OK(context, pvtMeasureOcclusion(context, &fixture->views, &fixture->options.bounds, 64,
                                          &occluder->mesh, &measure));
    return measure;
}

static int64_t CountTriangles(const pvtCut* cut)
{
    int64_t total = 0;
    for (size_t c = 0; c < cut->count; ++c) {
        total += cut->triangles[c];
    }
    return total;
}

static void every_link_of_every_candidate_stays_in_the_grid(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Fixture fixture;
    CreateFixture(context, &fixture);
    assert_true(fixture.candidates.chains.count >= fixture.sections.count / 2);
    for (size_t c = 0; c < fixture.candidates.chains.count; c += 7) {
        const int32_t most = fixture.candidates.triangles[c];
        for (int32_t triangles = 1; triangles <= most; triangles += 5) {
            pvtCut cut = {.count = fixture.candidates.chains.count};
            cut.triangles = pvtAllocate(context, cut.count, sizeof *cut.triangles);
            cut.triangles[c] = triangles;
            pvtOccluder occluder;
            CHECK_OK(context, pvtTakeCut(context, &fixture.candidates, &cut, &occluder));
            assert_int_equal(occluder.mesh.triangleCount, triangles);
            uint64_t outside = 1;
            CHECK_OK(context, pvtCheckOccluder(context, &(pvtInterior){.allowed = &fixture.grid},
                                               &occluder.mesh, &outside));
            assert_true(outside == 0);
            pvtOccluder_Free(context, &occluder);
            pvtCut_Free(context, &cut);
        }
    }
    FreeFixture(context, &fixture);
    DestroyTestContext(context);
}

static void a_larger_budget_never_hides_less(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Fixture fixture;
    CreateFixture(context, &fixture);
    static const int budgets[] = {1, 2, 5, 12, 40};
    double last = 0.0;
    for (size_t b = 0; b < sizeof budgets / sizeof *budgets; ++b) {
        fixture.options.budget = budgets[b];
        pvtCut cut;
        CHECK_OK(context, pvtSelectOccluder(context, &fixture.options, &fixture.candidates, &cut));
        assert_true(CountTriangles(&cut) >= 1);
        assert_true(CountTriangles(&cut) <= budgets[b]);
        pvtOccluder occluder;
        CHECK_OK(context, pvtTakeCut(context, &fixture.candidates, &cut, &occluder));
        const double measure = Measure(context, &fixture, &occluder);
        assert_true(measure >= last);
        last = measure;
        pvtOccluder_Free(context, &occluder);
        pvtCut_Free(context, &cut);
    }
    FreeFixture(context, &fixture);
    DestroyTestContext(context);
}

static void joined_occluders_keep_their_polygons_in_order(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Fixture fixture;
    CreateFixture(context, &fixture);
    pvtOccluder parts[3], joined;
    size_t polygons = 0, triangles = 0;
    for (int i = 0; i < 3; ++i) {
        fixture.options.budget = 5 + 9 * i;
        pvtCut cut;
        CHECK_OK(context, pvtSelectOccluder(context, &fixture.options, &fixture.candidates, &cut));
        CHECK_OK(context, pvtTakeCut(context, &fixture.candidates, &cut, &parts[i]));
        polygons += parts[i].loops.loopCount;
        triangles += parts[i].mesh.triangleCount;
        pvtCut_Free(context, &cut);
    }
    CHECK_OK(context, pvtJoinOccluders(context, parts, 3, &joined));
    assert_int_equal(joined.loops.loopCount, polygons);
    assert_int_equal(joined.mesh.triangleCount, triangles);
    size_t polygon = 0, triangle = 0;
    for (int i = 0; i < 3; ++i) {
        for (size_t p = 0; p < parts[i].loops.loopCount; ++p, ++polygon) {
            assert_memory_equal(&joined.planes[polygon], &parts[i].planes[p], sizeof(pvtPlane));
            assert_int_equal(pvtCountPolygonTriangles(&joined.loops, polygon),
                             pvtCountPolygonTriangles(&parts[i].loops, p));
        }
        for (size_t t = 0; t < 3 * parts[i].mesh.triangleCount; ++t) {
            const uint32_t own = parts[i].mesh.indices[t];
            const uint32_t other = joined.mesh.indices[3 * triangle + t];
            assert_memory_equal(&joined.mesh.positions[other], &parts[i].mesh.positions[own],
                                sizeof(pvtVec3));
        }
        triangle += parts[i].mesh.triangleCount;
        pvtOccluder_Free(context, &parts[i]);
    }
    pvtOccluder_Free(context, &joined);
    FreeFixture(context, &fixture);
    DestroyTestContext(context);
}

static void the_papers_way_steps_back_to_the_budget_exactly(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Fixture fixture;
    CreateFixture(context, &fixture);
    static const int budgets[] = {1, 9, 30};
    for (size_t b = 0; b < sizeof budgets / sizeof *budgets; ++b) {
        fixture.options.budget = budgets[b];
        pvtCut cut;
        CHECK_OK(context, pvtReduceOccluder(context, &fixture.options, &fixture.candidates, &cut));
        // Whole polygons of a ball have far more triangles than these.
        assert_int_equal(CountTriangles(&cut), budgets[b]);
        pvtCut_Free(context, &cut);
    }
    fixture.options.budget = 0;
    pvtCut cut;
    assert_int_equal(pvtReduceOccluder(context, &fixture.options, &fixture.candidates, &cut),
                     PVT_INVALID_ARGUMENT);
    assert_int_equal(pvtSelectOccluder(context, &fixture.options, &fixture.candidates, &cut),
                     PVT_INVALID_ARGUMENT);
    FreeFixture(context, &fixture);
    DestroyTestContext(context);
}

static void refinement_raises_the_measure_and_keeps_budget_and_promise(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Fixture fixture;
    CreateFixture(context, &fixture);
    fixture.options.budget = 14;
    pvtCut cut;
    CHECK_OK(context, pvtSelectOccluder(context, &fixture.options, &fixture.candidates, &cut));
    pvtOccluder occluder;
    CHECK_OK(context, pvtTakeCut(context, &fixture.candidates, &cut, &occluder));
    pvtCut_Free(context, &cut);
    double last = Measure(context, &fixture, &occluder);
    const double first = last;
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        const pvtRefineOptions refine = {.budget = 14,
                                         .views = &fixture.views,
                                         .bounds = fixture.options.bounds,
                                         .seed = seed,
                                         .trials = 600};
        CHECK_OK(context, pvtRefineOccluder(context, &refine, &fixture.volume, &fixture.candidates,
                                            &occluder));
        const double measure = Measure(context, &fixture, &occluder);
        // The mesh is rounded to float and drawn by triangles, not by polygons.
        assert_true(measure >= last * (1.0 - 1e-3));
        last = measure;
        assert_true(occluder.mesh.triangleCount <= 14);
        uint64_t outside = 1;
        CHECK_OK(context, pvtCheckOccluder(context, &(pvtInterior){.allowed = &fixture.grid},
                                           &occluder.mesh, &outside));
        assert_true(outside == 0);
    }
    assert_true(last > first);
    pvtOccluder_Free(context, &occluder);
    FreeFixture(context, &fixture);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_link_of_every_candidate_stays_in_the_grid),
        cmocka_unit_test(a_larger_budget_never_hides_less),
        cmocka_unit_test(joined_occluders_keep_their_polygons_in_order),
        cmocka_unit_test(the_papers_way_steps_back_to_the_budget_exactly),
        cmocka_unit_test(refinement_raises_the_measure_and_keeps_budget_and_promise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
