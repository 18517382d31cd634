// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/bits.h"
#include "evaluate/excess.h"
#include "evaluate/quads.h"

#include <math.h>
#include <string.h>

static bool Get(const pvtRaster* raster, int x, int y)
{
    return x >= 0 && y >= 0 && x < raster->width && y < raster->height &&
           pvtGetBit(raster->words + (size_t)y * raster->wordsPerRow, (size_t)x);
}

// Random rectangles on and off, and some single pixels: runs, holes and noise.
static void DrawNoise(pvtContext* context, pvtRandom* random, int width, int height,
                      pvtRaster* raster)
{
    CHECK_OK(context, pvtRaster_Resize(context, raster, width, height));
    for (int k = 0; k < 14; ++k) {
        const pvtQuad quad =
            pvtDrawQuad(random, k % 2 == 0 ? PVT_QUADS_UNIFORM : PVT_QUADS_SMALL, width, height);
        for (int y = quad.y0; y <= quad.y1; ++y) {
            for (int x = quad.x0; x <= quad.x1; ++x) {
                uint64_t* row = raster->words + (size_t)y * raster->wordsPerRow;
                if (k % 3 < 2) {
                    pvtSetBit(row, (size_t)x);
                } else {
                    pvtClearBit(row, (size_t)x);
                }
            }
        }
    }
}

static pvtQuadTally TallyByHand(const pvtRaster* original, const pvtRaster* occluder,
                                const pvtQuad* quad)
{
    uint64_t pixels = 0, byOriginal = 0, byOccluder = 0;
    for (int y = quad->y0; y <= quad->y1; ++y) {
        for (int x = quad->x0; x <= quad->x1; ++x) {
            ++pixels;
            byOriginal += Get(original, x, y);
            byOccluder += Get(occluder, x, y);
        }
    }
    pvtQuadTally tally = {0};
    if (byOriginal == pixels && byOccluder == pixels) {
        tally.hidden = pixels;
    } else if (byOriginal == pixels) {
        tally.lost = pixels;
    } else if (byOccluder == pixels) {
        tally.wrong = pixels - byOriginal;
    }
    return tally;
}

static void each_quad_counts_as_by_hand(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(3, 0);
    pvtRaster original = {0}, occluder = {0};
    pvtCoverTable tables[2] = {0};
    uint64_t seen[3] = {0};
    for (int round = 0; round < 60; ++round) {
        const int width = 1 + (int)pvtRandom_Below(&random, 150);
        const int height = 1 + (int)pvtRandom_Below(&random, 90);
        DrawNoise(context, &random, width, height, &original);
        DrawNoise(context, &random, width, height, &occluder);
        const pvtQuad all = {0, 0, width - 1, height - 1};
        CHECK_OK(context, pvtCoverTable_Build(context, &tables[0], &original, &all));
        CHECK_OK(context, pvtCoverTable_Build(context, &tables[1], &occluder, &all));
        for (int q = 0; q < 400; ++q) {
            const pvtQuad quad = pvtDrawQuad(&random, (pvtQuadFamily)(q % 2), width, height);
            pvtQuadTally tally = {0};
            pvtTallyQuad(&tables[0], &tables[1], &quad, &tally);
            const pvtQuadTally truth = TallyByHand(&original, &occluder, &quad);
            assert_int_equal(tally.hidden, truth.hidden);
            assert_int_equal(tally.lost, truth.lost);
            assert_int_equal(tally.wrong, truth.wrong);
            seen[0] += truth.hidden;
            seen[1] += truth.lost;
            seen[2] += truth.wrong;
        }
    }
    assert_true(seen[0] > 0 && seen[1] > 0 && seen[2] > 0);
    pvtCoverTable_Free(context, &tables[0]);
    pvtCoverTable_Free(context, &tables[1]);
    pvtRaster_Free(context, &original);
    pvtRaster_Free(context, &occluder);
    DestroyTestContext(context);
}

static void a_table_of_a_part_counts_from_its_corner(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(5, 0);
    pvtRaster raster = {0};
    DrawNoise(context, &random, 300, 80, &raster);
    const pvtQuad part = {64, 7, 64 + 130, 60};
    pvtCoverTable table = {0};
    CHECK_OK(context, pvtCoverTable_Build(context, &table, &raster, &part));
    for (int k = 0; k < 500; ++k) {
        const pvtQuad quad = pvtDrawQuad(&random, PVT_QUADS_UNIFORM, table.width, table.height);
        uint32_t count = 0;
        for (int y = quad.y0; y <= quad.y1; ++y) {
            for (int x = quad.x0; x <= quad.x1; ++x) {
                count += Get(&raster, x + part.x0, y + part.y0);
            }
        }
        assert_int_equal(pvtCoverTable_Count(&table, &quad), count);
    }
    pvtCoverTable_Free(context, &table);
    pvtRaster_Free(context, &raster);
    DestroyTestContext(context);
}

static void quads_stay_on_the_screen_and_reach_all_of_it(void** state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {7, 3}, {8, 16}, {100, 33}};
    for (size_t s = 0; s < 4; ++s) {
        for (int family = 0; family < 2; ++family) {
            const int width = sizes[s][0], height = sizes[s][1];
            pvtRandom random = pvtMakeRandom(1, s);
            pvtQuad reach = {width, height, -1, -1};
            int widest = 0;
            for (int k = 0; k < 20000; ++k) {
                const pvtQuad q = pvtDrawQuad(&random, (pvtQuadFamily)family, width, height);
                assert_true(q.x0 <= q.x1 && q.y0 <= q.y1);
                reach.x0 = q.x0 < reach.x0 ? q.x0 : reach.x0;
                reach.y0 = q.y0 < reach.y0 ? q.y0 : reach.y0;
                reach.x1 = q.x1 > reach.x1 ? q.x1 : reach.x1;
                reach.y1 = q.y1 > reach.y1 ? q.y1 : reach.y1;
                widest = q.x1 - q.x0 + 1 > widest ? q.x1 - q.x0 + 1 : widest;
            }
            assert_true(reach.x0 == 0 && reach.y0 == 0);
            assert_true(reach.x1 == width - 1 && reach.y1 == height - 1);
            const int small = width / 8 > 1 ? width / 8 : 1;
            assert_int_equal(widest, family == PVT_QUADS_SMALL ? small : width);
        }
    }
}

// Every covered pixel of the original against every pixel that only the occluder covers.
static pvtExcess MeasureByHand(const pvtRasterPair* pair)
{
    pvtExcess excess = {0};
    for (int j = 0; j < pair->occluder->height; ++j) {
        for (int i = 0; i < pair->occluder->width; ++i) {
            const int x = i + pair->x, y = j + pair->y;
            if (!Get(pair->occluder, i, j) || Get(pair->original, x, y)) {
                continue;
            }
            ++excess.pixels;
            uint64_t least = UINT64_MAX;
            for (int b = 0; b < pair->original->height; ++b) {
                for (int a = 0; a < pair->original->width; ++a) {
                    const uint64_t d = (uint64_t)((a - x) * (a - x) + (b - y) * (b - y));
                    least = Get(pair->original, a, b) && d < least ? d : least;
                }
            }
            excess.distance2 = least > excess.distance2 ? least : excess.distance2;
        }
    }
    return excess;
}

static void excess_is_as_by_hand(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(23, 0);
    pvtRaster original = {0}, occluder = {0};
    pvtExcessScratch scratch = {0};
    for (int round = 0; round < 40; ++round) {
        const int width = 3 + (int)pvtRandom_Below(&random, 80);
        const int height = 3 + (int)pvtRandom_Below(&random, 20);
        const int beyond = (int)pvtRandom_Below(&random, 20);
        DrawNoise(context, &random, width, height, &original);
        pvtSetBit(original.words, 1); // by hand there is no distance from nothing
        const int at = -64 * (int)pvtRandom_Below(&random, 2);
        DrawNoise(context, &random, width - at, height + 2 * beyond, &occluder);
        const pvtRasterPair pair = {&original, &occluder, at, -beyond};
        const pvtExcess truth = MeasureByHand(&pair);
        scratch.isReady = false;
        pvtExcess excess;
        CHECK_OK(context, pvtMeasureExcess(context, &pair, &scratch, &excess));
        assert_int_equal(excess.pixels, truth.pixels);
        assert_int_equal(excess.distance2, truth.distance2);
    }
    pvtExcessScratch_Free(context, &scratch);
    pvtRaster_Free(context, &original);
    pvtRaster_Free(context, &occluder);
    DestroyTestContext(context);
}

static void beside_an_original_without_pixels_its_box_counts(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRaster original = {0}, occluder = {0};
    CHECK_OK(context, pvtRaster_Resize(context, &original, 10, 4));
    CHECK_OK(context, pvtRaster_Resize(context, &occluder, 64 + 10, 4));
    pvtSetBitRange(occluder.words, 64 - 5, 64 + 10); // five pixels to the left of the box
    const pvtRasterPair pair = {&original, &occluder, -64, 0};
    pvtExcessScratch scratch = {0};
    pvtExcess excess;
    CHECK_OK(context, pvtMeasureExcess(context, &pair, &scratch, &excess));
    assert_int_equal(excess.pixels, 15);
    assert_int_equal(excess.distance2, 25);
    pvtExcessScratch_Free(context, &scratch);
    pvtRaster_Free(context, &original);
    pvtRaster_Free(context, &occluder);
    DestroyTestContext(context);
}

static void scores_without_any_quad_are_one(void** state)
{
    (void)state;
    const pvtQuadScore none = pvtScoreTally(&(pvtQuadTally){0});
    assert_true(none.precision == 1.0 && none.recall == 1.0);
    assert_true(none.precisionError == 0.0 && none.recallError == 0.0);
    const pvtQuadScore some = pvtScoreTally(&(pvtQuadTally){30, 10, 20, 900, 100, 400});
    assert_true(fabs(some.recall - 0.75) < 1e-15 && fabs(some.precision - 0.6) < 1e-15);
    // One quad of each class: the formula by hand.
    assert_true(fabs(some.recallError - sqrt(0.0625 * 900 + 0.5625 * 100) / 40) < 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_quad_counts_as_by_hand),
        cmocka_unit_test(a_table_of_a_part_counts_from_its_corner),
        cmocka_unit_test(quads_stay_on_the_screen_and_reach_all_of_it),
        cmocka_unit_test(excess_is_as_by_hand),
        cmocka_unit_test(beside_an_original_without_pixels_its_box_counts),
        cmocka_unit_test(scores_without_any_quad_are_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
