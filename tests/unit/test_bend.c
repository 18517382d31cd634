// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include "base/vector.h"
#include "occluder/bend.h"
#include "occluder/facets.h"
#include "occlusion/rectangles.h"

#include <string.h>

enum { SIDE = 48, TRIANGLES = 12, POSITIONS = 14 };

static double RollIn(pvtRandom* random, double low, double high)
{
    return low + (high - low) * pvtRandom_Unit(random);
}

static pvtVec3 RollPoint(pvtRandom* random, double low, double high)
{
    const double x = RollIn(random, low, high);
    const double y = RollIn(random, low, high);
    const double z = RollIn(random, low, high);
    return (pvtVec3){(float)x, (float)y, (float)z};
}

// A ball that leaves four voxels free on each side, in a frame in which voxels are 1 wu.
static void MakeBall(pvtContext* context, pvtBitGrid* grid)
{
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, grid);
    grid->frame.origin = (pvtVec3){0};
    grid->frame.voxelSize = 1.0;
    SetBall(grid, (pvtVec3){SIDE / 2.0, SIDE / 2.0, SIDE / 2.0}, SIDE / 2.0 - 4.0);
}

// Triangles with random corners, many of them shared.
static void RollMesh(pvtContext* context, pvtRandom* random, double low, double high, pvtMesh* mesh)
{
    pvtVec3 positions[POSITIONS];
    for (int i = 0; i < POSITIONS; ++i) {
        positions[i] = RollPoint(random, low, high);
    }
    uint32_t indices[3 * TRIANGLES];
    for (uint32_t t = 0; t < TRIANGLES; ++t) {
        indices[3 * t] = t;
        indices[3 * t + 1] = t + 1;
        indices[3 * t + 2] = (t + 2 + pvtRandom_Below(random, POSITIONS - 3)) % POSITIONS;
        if (indices[3 * t + 2] == t || indices[3 * t + 2] == t + 1) {
            indices[3 * t + 2] = t + 2;
        }
    }
    CHECK_OK(context, pvtCreateMesh(context, positions, POSITIONS, indices, TRIANGLES, mesh));
}

static void MakeSomeViews(pvtContext* context, int count, pvtViewSet* views)
{
    pvtViewOptions options = pvtDefaultViewOptions();
    options.count = count;
    CHECK_OK(context, pvtMakeViews(context, &options, views));
}

static uint64_t SumRectanglesOneByOne(const uint64_t rows[64])
{
    uint64_t sum = 0;
    for (unsigned left = 0; left < 64; ++left) {
        for (unsigned right = left; right < 64; ++right) {
            const uint64_t columns = pvtMakeMask(left, right + 1);
            for (int first = 0; first < 64; ++first) {
                for (int last = first; last < 64 && (rows[last] & columns) == columns; ++last) {
                    sum += (uint64_t)(right + 1 - left) * (uint64_t)(last + 1 - first);
                }
            }
        }
    }
    return sum;
}

static void rectangles_are_summed_as_if_counted_one_by_one(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(3, 1);
    for (int round = 0; round < 30; ++round) {
        uint64_t rows[64] = {0};
        for (int box = 0; box < 6; ++box) {
            const unsigned left = pvtRandom_Below(&random, 64);
            const unsigned right = left + pvtRandom_Below(&random, 64 - left);
            const uint32_t first = pvtRandom_Below(&random, 64);
            const uint32_t last = first + pvtRandom_Below(&random, 64 - first);
            for (uint32_t y = first; y <= last; ++y) {
                rows[y] ^= pvtMakeMask(left, right + 1);
            }
        }
        assert_true(pvtSumRectangles(rows) == SumRectanglesOneByOne(rows));
    }
    uint64_t full[64];
    memset(full, 255, sizeof full);
    assert_true(pvtSumRectangles(full) == UINT64_C(45760) * 45760);
}

static void triangles_found_inside_pass_the_check(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeBall(context, &grid);
    pvtInsideTest test;
    CHECK_OK(context, pvtCreateInsideTest(context, &(pvtInterior){.allowed = &grid}, &test));
    pvtRandom random = pvtMakeRandom(5, 2);
    int inside = 0;
    for (int round = 0; round < 3000; ++round) {
        pvtVec3 corners[3];
        const double reach = RollIn(&random, 2.0, SIDE / 2.0);
        for (int c = 0; c < 3; ++c) {
            corners[c] = RollPoint(&random, SIDE / 2.0 - reach, SIDE / 2.0 + reach);
        }
        double farthest = 0.0;
        for (int c = 0; c < 3; ++c) {
            const pvtVec3 center = {SIDE / 2.0, SIDE / 2.0, SIDE / 2.0};
            farthest = fmax(farthest, pvtLength3(pvtSub(corners[c], center)));
        }
        const bool isInside = pvtInsideTest_HasTriangle(&test, corners);
        pvtMesh mesh;
        uint64_t outside = 0;
        CHECK_OK(context, pvtCreateMesh(context, corners, 3, NULL, 1, &mesh));
        CHECK_OK(context,
                 pvtCheckOccluder(context, &(pvtInterior){.allowed = &grid}, &mesh, &outside));
        pvtMesh_Free(context, &mesh);
        assert_true(!isInside || outside == 0);
        // A ball is convex, and its voxels reach no less than a voxel's diagonal less far.
        assert_true(isInside || farthest > SIDE / 2.0 - 4.0 - sqrt(3.0));
        inside += isInside ? 1 : 0;
    }
    assert_true(inside > 300 && inside < 2700);
    pvtInsideTest_Free(context, &test);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void a_flat_triangle_between_two_layers_is_inside_when_one_of_them_is(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, &grid);
    SetBox(&grid, (int[]){10, 10, 10}, (int[]){30, 30, 30});
    pvtInsideTest test;
    CHECK_OK(context, pvtCreateInsideTest(context, &(pvtInterior){.allowed = &grid}, &test));
    static const double layers[] = {10, 20, 30, 9, 31};
    for (int i = 0; i < 5; ++i) {
        const pvtVec3 corners[3] = {{11, layers[i], 12}, {30, layers[i], 10}, {25, layers[i], 30}};
        assert_true(pvtInsideTest_HasTriangle(&test, corners) == (i < 3));
    }
    pvtInsideTest_Free(context, &test);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void RollChange(pvtRandom* random, const pvtFacets* facets, pvtFacetChange* change)
{
    *change = (pvtFacetChange){.movedCount = 1};
    change->moved[0] = pvtRandom_Below(random, POSITIONS);
    change->places[0] = RollPoint(random, 4.0, SIDE - 4.0);
    for (size_t t = 0; t < TRIANGLES; ++t) {
        const uint32_t* corners = facets->mesh.indices + 3 * t;
        bool changes = pvtRandom_Below(random, 12) == 0;
        memcpy(change->corners[change->count], corners, sizeof(pvtFacetCorners));
        if (changes) {
            change->corners[change->count][0] = change->moved[0];
        }
        for (int c = 0; c < 3; ++c) {
            changes = changes || corners[c] == change->moved[0];
        }
        if (changes) {
            change->triangles[change->count++] = t;
        }
    }
}

static void the_value_of_a_change_is_that_of_the_changed_mesh_bit_for_bit(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(7, 3);
    pvtMesh mesh;
    RollMesh(context, &random, 4.0, SIDE - 4.0, &mesh);
    pvtViewSet views;
    pvtViewSet more;
    MakeSomeViews(context, 6, &views);
    MakeSomeViews(context, 9, &more);
    const pvtFacetOptions options = {&views, &more, {{0, 0, 0}, {SIDE, SIDE, SIDE}}};
    pvtFacets facets;
    CHECK_OK(context, pvtCreateFacets(context, &options, &mesh, &facets));
    for (int step = 0; step < 2000; ++step) {
        pvtFacetChange change;
        RollChange(&random, &facets, &change);
        const bool seemsToGain = pvtScreenFacetChange(&facets, &change);
        pvtEvaluateFacetChange(&facets, &change);
        assert_true(!seemsToGain || change.screened > facets.screened);
        pvtApplyFacetChange(context, &facets, &change);
        assert_true(change.screened == facets.screened && change.total == facets.total);
        if (step % 100 == 0) {
            pvtFacets anew;
            CHECK_OK(context, pvtCreateFacets(context, &options, &facets.mesh, &anew));
            assert_true(anew.screened == facets.screened && anew.total == facets.total);
            pvtFacets_Free(context, &anew);
        }
    }
    pvtFacets_Free(context, &facets);
    pvtViewSet_Free(context, &views);
    pvtViewSet_Free(context, &more);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

typedef struct Bent {
    pvtOccluder occluder;
    double before[2], after[2]; // what the views hide, and what all views hide
    uint64_t outside;
} Bent;

static void Bend(pvtContext* context, int trials, int sweeps, Bent* bent)
{
    pvtRandom random = pvtMakeRandom(11, 6);
    pvtBitGrid grid;
    MakeBall(context, &grid);
    pvtInsideTest inside;
    CHECK_OK(context, pvtCreateInsideTest(context, &(pvtInterior){.allowed = &grid}, &inside));
    pvtViewSet views;
    pvtViewSet more;
    MakeSomeViews(context, 8, &views);
    MakeSomeViews(context, 20, &more);
    *bent = (Bent){.occluder = {.frame = grid.frame}};
    RollMesh(context, &random, SIDE / 2.0 - 9.0, SIDE / 2.0 + 9.0, &bent->occluder.mesh);
    const pvtBendOptions options = {.views = &views,
                                    .more = &more,
                                    .bounds = {{4, 4, 4}, {SIDE - 4, SIDE - 4, SIDE - 4}},
                                    .inside = &inside,
                                    .seed = 1,
                                    .trials = trials,
                                    .sweeps = sweeps};
    const pvtFacetOptions measured = {&views, &more, options.bounds};
    pvtFacets facets;
    CHECK_OK(context, pvtCreateFacets(context, &measured, &bent->occluder.mesh, &facets));
    bent->before[0] = facets.screened;
    bent->before[1] = facets.total;
    pvtFacets_Free(context, &facets);
    CHECK_OK(context, pvtBendOccluder(context, &options, &bent->occluder));
    CHECK_OK(context, pvtCreateFacets(context, &measured, &bent->occluder.mesh, &facets));
    bent->after[0] = facets.screened;
    bent->after[1] = facets.total;
    pvtFacets_Free(context, &facets);
    CHECK_OK(context, pvtCheckOccluder(context, &(pvtInterior){.allowed = &grid},
                                       &bent->occluder.mesh, &bent->outside));
    pvtViewSet_Free(context, &views);
    pvtViewSet_Free(context, &more);
    pvtInsideTest_Free(context, &inside);
    pvtBitGrid_Free(context, &grid);
}

static void CheckBent(const Bent* bent, double gain)
{
    assert_true(bent->occluder.mesh.triangleCount == TRIANGLES);
    assert_true(bent->outside == 0);
    assert_true(bent->after[0] > gain * bent->before[0]);
    assert_true(bent->after[1] > gain * bent->before[1]);
}

static void bending_hides_more_with_no_more_triangles_and_stays_inside(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Bent drawn, swept, both;
    Bend(context, 1200, 0, &drawn);
    Bend(context, 0, 3, &swept);
    Bend(context, 1200, 1, &both);
    CheckBent(&drawn, 1.2);
    // Steps of 4, 2 and 1 voxels.
    CheckBent(&swept, 1.05);
    // Where random steps have left off there is something left.
    CheckBent(&both, drawn.after[1] / drawn.before[1]);
    pvtOccluder_Free(context, &drawn.occluder);
    pvtOccluder_Free(context, &swept.occluder);
    pvtOccluder_Free(context, &both.occluder);
    DestroyTestContext(context);
}

static void threads_do_not_change_how_triangles_bend(void** state)
{
    (void)state;
    pvtContext* one = CreateTestContext(1);
    pvtContext* many = CreateTestContext(5);
    Bent a;
    Bent b;
    Bend(one, 600, 2, &a);
    Bend(many, 600, 2, &b);
    assert_true(a.occluder.mesh.positionCount == b.occluder.mesh.positionCount);
    assert_memory_equal(a.occluder.mesh.positions, b.occluder.mesh.positions,
                        a.occluder.mesh.positionCount * sizeof(pvtVec3));
    assert_memory_equal(a.occluder.mesh.indices, b.occluder.mesh.indices,
                        sizeof(uint32_t[3 * TRIANGLES]));
    pvtOccluder_Free(one, &a.occluder);
    pvtOccluder_Free(many, &b.occluder);
    DestroyTestContext(one);
    DestroyTestContext(many);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rectangles_are_summed_as_if_counted_one_by_one),
        cmocka_unit_test(triangles_found_inside_pass_the_check),
        cmocka_unit_test(a_flat_triangle_between_two_layers_is_inside_when_one_of_them_is),
        cmocka_unit_test(the_value_of_a_change_is_that_of_the_changed_mesh_bit_for_bit),
        cmocka_unit_test(bending_hides_more_with_no_more_triangles_and_stays_inside),
        cmocka_unit_test(threads_do_not_change_how_triangles_bend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
