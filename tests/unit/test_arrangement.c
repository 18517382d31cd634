// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include "occluder/arrangement.h"

enum { SIDE = 48, PANELS = 6 };

static void RollPanel(pvtRandom* random, const pvtGridFrame* frame, pvtPanel* panel)
{
    const pvtVec3 direction = {pvtRandom_Unit(random) - 0.5, pvtRandom_Unit(random) - 0.5,
                               pvtRandom_Unit(random) - 0.5};
    const double at = (SIDE / 2.0 + pvtRandom_Unit(random)) * frame->voxelSize;
    panel->plane = pvtMakePlane(frame, direction, (pvtVec3){at, at, at});
    panel->count = 3 + (int)pvtRandom_Below(random, 2);
    const int32_t middle = SIDE * 128;
    static const int ways[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (int i = 0; i < panel->count; ++i) {
        const int32_t reach = (int32_t)pvtRandom_Below(random, 10 * 256) + 256;
        panel->points[i] = (pvtPoint2){middle + ways[i][0] * reach, middle + ways[i][1] * reach};
    }
}

// The value by drawing everything anew, each view on its own.
static double MeasureFromScratch(const pvtArrangement* arrangement)
{
    const pvtScorer* scorer = &arrangement->scorer;
    double value = 0.0;
    for (size_t m = 0; m < scorer->maskCount; ++m) {
        uint64_t rows[64] = {0};
        for (int slot = 0; slot < arrangement->capacity; ++slot) {
            const pvtPanel* panel = &arrangement->panels[slot].panel;
            uint64_t drawn[64] = {0};
            pvtDrawSectionPolygon(scorer, m, &panel->plane, panel->points, (size_t)panel->count,
                                  drawn);
            for (int row = 0; row < 64; ++row) {
                rows[row] |= drawn[row];
            }
        }
        const int tiles = scorer->viewsPerMask == 4 ? 2 : 1;
        double ofMask = 0.0;
        for (int tile = 0; tile < tiles * tiles; ++tile) {
            uint64_t own[64] = {0};
            for (int row = 0; row < 64 / tiles; ++row) {
                const uint64_t whole = rows[tile / tiles * 32 + row];
                own[row] = tiles == 1 ? whole : (whole >> (tile % tiles * 32)) & UINT32_MAX;
            }
            ofMask += scorer->factors[4 * m + (size_t)tile] *
                      (double)pvtSumDistances(own, 64, scorer->table);
        }
        value += ofMask;
    }
    return value;
}

static void CheckIncrementalValues(int size)
{
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, &grid);
    grid.frame.voxelSize = 0.25;
    // A ball that leaves four voxels free on each side.
    SetBall(&grid, (pvtVec3){SIDE / 2.0, SIDE / 2.0, SIDE / 2.0}, SIDE / 2.0 - 4.0);
    pvtSliceVolume volume;
    CHECK_OK(context, pvtCreateSliceVolume(context, &grid, &volume));
    pvtViewOptions viewOptions = pvtDefaultViewOptions();
    viewOptions.count = 12;
    pvtViewSet views;
    CHECK_OK(context, pvtMakeViews(context, &viewOptions, &views));
    const pvtScorerOptions options = {
        .views = &views, .bounds = {{0, 0, 0}, {12, 12, 12}}, .size = size, .exponent = 1};
    pvtArrangement arrangement;
    CHECK_OK(context, pvtCreateArrangement(context, &options, &volume, PANELS, &arrangement));

    pvtRandom random = pvtMakeRandom(21, 4);
    for (int step = 0; step < 1500; ++step) {
        pvtChange change = {.count = 1 + (int)pvtRandom_Below(&random, 2)};
        change.slots[0] = (int)pvtRandom_Below(&random, PANELS);
        change.slots[1] = (change.slots[0] + 1) % PANELS;
        for (int i = 0; i < change.count; ++i) {
            RollPanel(&random, &grid.frame, &change.panels[i]);
            if (pvtRandom_Below(&random, 4) == 0) {
                change.panels[i].count = 0;
            }
        }
        pvtEvaluateChange(&arrangement, &change);
        CHECK_OK(context, pvtApplyChange(context, &arrangement, &change));
        assert_true(change.value == arrangement.value);
        if (step % 50 == 0) {
            assert_true(arrangement.value == MeasureFromScratch(&arrangement));
        }
    }
    pvtArrangement_Free(context, &arrangement);
    pvtViewSet_Free(context, &views);
    pvtSliceVolume_Free(context, &volume);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void the_incremental_value_equals_the_full_one_bit_for_bit(void** state)
{
    (void)state;
    CheckIncrementalValues(64);
}

static void so_it_does_with_four_views_on_a_mask(void** state)
{
    (void)state;
    CheckIncrementalValues(31);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_incremental_value_equals_the_full_one_bit_for_bit),
        cmocka_unit_test(so_it_does_with_four_views_on_a_mask),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
