// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/context.h"
#include "base/random.h"
#include "base/vector.h"
#include "occlusion/distance.h"
#include "occlusion/mask.h"

#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

static bool GetPixel(const uint64_t* rows, int size, int x, int y)
{
    if (x < 0 || y < 0 || x >= size || y >= size) {
        return false;
    }
    return (rows[(size_t)y * (size_t)(size / 64) + (size_t)x / 64] >> (x % 64)) & 1;
}

static int FindNearestClear(const uint64_t* rows, int size, int x, int y)
{
    int best = 1 << 30;
    for (int v = -1; v <= size; ++v) {
        for (int u = -1; u <= size; ++u) {
            const int squared = (u - x) * (u - x) + (v - y) * (v - y);
            if (squared < best && !GetPixel(rows, size, u, v)) {
                best = squared;
            }
        }
    }
    return best;
}

static void FillRandomBlobs(uint64_t* rows, int size, pvtRandom* random)
{
    memset(rows, 0, (size_t)size * (size_t)size / 8);
    for (int blob = 0; blob < 4; ++blob) {
        const int cx = (int)pvtRandom_Below(random, (uint32_t)size);
        const int cy = (int)pvtRandom_Below(random, (uint32_t)size);
        const int radius = (int)pvtRandom_Below(random, (uint32_t)size / 2);
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                if ((x - cx) * (x - cx) + (y - cy) * (y - cy) < radius * radius) {
                    rows[(size_t)y * (size_t)(size / 64) + (size_t)x / 64] |= UINT64_C(1)
                                                                              << (x % 64);
                }
            }
        }
    }
}

static void distances_equal_the_brute_force(void** state)
{
    (void)state;
    static uint64_t rows[256 * 4];
    static uint16_t distances[256 * 256];
    pvtRandom random = pvtMakeRandom(7, 1);
    for (int round = 0; round < 6; ++round) {
        const int size = round < 4 ? 64 : 128;
        FillRandomBlobs(rows, size, &random);
        pvtTransformDistance(rows, size, distances);
        for (int probe = 0; probe < 600; ++probe) {
            const int x = (int)pvtRandom_Below(&random, (uint32_t)size);
            const int y = (int)pvtRandom_Below(&random, (uint32_t)size);
            const int expected =
                GetPixel(rows, size, x, y) ? FindNearestClear(rows, size, x, y) : 0;
            assert_int_equal(distances[y * size + x], expected);
        }
    }
}

static void a_full_mask_is_as_deep_as_its_border(void** state)
{
    (void)state;
    static uint64_t rows[256 * 4];
    static uint16_t distances[256 * 256];
    for (int size = 64; size <= 256; size *= 2) {
        memset(rows, 255, sizeof rows);
        pvtTransformDistance(rows, size, distances);
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                const int nearX = x + 1 < size - x ? x + 1 : size - x;
                const int nearY = y + 1 < size - y ? y + 1 : size - y;
                const int nearest = nearX < nearY ? nearX : nearY;
                assert_int_equal(distances[y * size + x], nearest * nearest);
            }
        }
    }
}

static void the_sum_adds_up_the_distances(void** state)
{
    (void)state;
    static uint64_t rows[256 * 4];
    static uint16_t distances[256 * 256];
    static uint32_t table[128 * 128 + 1];
    pvtRandom random = pvtMakeRandom(9, 1);
    for (int size = 64; size <= 256; size *= 2) {
        pvtFillDistanceTable(size, 1, table);
        FillRandomBlobs(rows, size, &random);
        pvtTransformDistance(rows, size, distances);
        uint64_t expected = 0;
        for (int i = 0; i < size * size; ++i) {
            expected += (uint64_t)lrint(256.0 * sqrt((double)distances[i]));
        }
        assert_true(pvtSumDistances(rows, size, table) == expected);
    }
}

static void a_polygon_covers_the_centres_inside_it(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(11, 1);
    for (int round = 0; round < 300; ++round) {
        const int size = round % 2 == 0 ? 64 : 128;
        pvtMaskPoint p[3];
        for (int c = 0; c < 3; ++c) {
            // Some corners lie off the mask. Odd coordinates miss the centres.
            p[c].x = (int32_t)pvtRandom_Below(&random, 200 * 256) - 40 * 256;
            p[c].y = (int32_t)pvtRandom_Below(&random, 200 * 256) - 40 * 256;
        }
        uint64_t rows[256] = {0};
        pvtToggleMaskPolygon(rows, size, p, 3);
        for (int y = 0; y < size; ++y) {
            for (int x = 0; x < size; ++x) {
                int64_t area[3];
                bool near = false;
                for (int c = 0; c < 3; ++c) {
                    const pvtMaskPoint a = p[c];
                    const pvtMaskPoint b = p[(c + 1) % 3];
                    const int64_t dx = b.x - a.x;
                    const int64_t dy = b.y - a.y;
                    area[c] = dx * (y * 256 + 128 - a.y) - dy * (x * 256 + 128 - a.x);
                    // Within two units of an edge either answer is right: crossings are rounded.
                    near = near || llabs(area[c]) <= 2 * (llabs(dx) + llabs(dy));
                }
                const bool inside = (area[0] > 0 && area[1] > 0 && area[2] > 0) ||
                                    (area[0] < 0 && area[1] < 0 && area[2] < 0);
                assert_true(near || GetPixel(rows, size, x, y) == inside);
            }
        }
    }
}

static void views_are_orthonormal_and_weigh_one_in_all(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtViewOptions options = pvtDefaultViewOptions();
    pvtViewSet set;
    CHECK_OK(context, pvtMakeViews(context, &options, &set));
    double total = 0.0;
    pvtVec3 mean = {0};
    for (size_t i = 0; i < set.count; ++i) {
        const pvtView* view = &set.views[i];
        CHECK_NEAR(pvtDot(view->right, view->up), 0.0, 1e-12);
        CHECK_NEAR(pvtLength3(view->up), 1.0, 1e-12);
        const pvtVec3 back = pvtCross(view->right, view->up);
        CHECK_NEAR(pvtLength3(pvtAdd(back, view->direction)), 0.0, 1e-12);
        assert_true(view->direction.y <= 0.0);
        total += view->weight;
        mean = pvtAdd(mean, pvtScale(view->direction, view->weight));
    }
    CHECK_NEAR(total, 1.0, 1e-12);
    // The centre of a half sphere lies at half its radius.
    CHECK_NEAR(mean.y, -0.5, 0.01);
    CHECK_NEAR(mean.x, 0.0, 0.02);
    pvtViewSet_Free(context, &set);

    const pvtWeightedDirection list[] = {{{0, 0, 2}, 3.0}, {{1, 0, 0}, 0.0}, {{0, 5, 0}, 1.0}};
    options.list = list;
    options.listCount = 3;
    CHECK_OK(context, pvtMakeViews(context, &options, &set));
    assert_int_equal(set.count, 2);
    CHECK_NEAR(set.views[0].weight, 0.75, 1e-15);
    pvtViewSet_Free(context, &set);
    options.listCount = 0;
    assert_int_equal(pvtMakeViews(context, &options, &set), PVT_INVALID_ARGUMENT);
    DestroyTestContext(context);
}

// A disc of n corners in the xy plane.
static void MakeDisc(pvtContext* context, int n, double radius, pvtMesh* mesh)
{
    pvtVec3 positions[129];
    uint32_t indices[3 * 128];
    positions[128] = (pvtVec3){0};
    for (int i = 0; i < n; ++i) {
        const double angle = 2.0 * PI * i / n;
        positions[i] = (pvtVec3){radius * cos(angle), radius * sin(angle), 0.0};
        indices[3 * i] = 128;
        indices[3 * i + 1] = (uint32_t)i;
        indices[3 * i + 2] = (uint32_t)((i + 1) % n);
    }
    CHECK_OK(context, pvtCreateMesh(context, positions, 129, indices, (size_t)n, mesh));
}

static double MeasureFaceOn(pvtContext* context, const pvtMesh* mesh, double half, int size)
{
    const pvtWeightedDirection along = {{0, 0, -1}, 1.0};
    pvtViewOptions options = pvtDefaultViewOptions();
    options.list = &along;
    options.listCount = 1;
    pvtViewSet views;
    CHECK_OK(context, pvtMakeViews(context, &options, &views));
    const pvtBox3 bounds = {{-half, -half, -half}, {half, half, half}};
    double measure = 0.0;
    CHECK_OK(context, pvtMeasureOcclusion(context, &views, &bounds, size, mesh, &measure));
    pvtViewSet_Free(context, &views);
    return measure;
}

// A covered centre's distance to the nearest clear centre exceeds that to the true edge by 0 to 1
// pixel, over the whole area: by half a pixel on average for straight edges, less for round ones,
// where many clear centres compete.
static void the_measure_of_a_disc_is_pi_r_cubed_over_three(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh disc;
    MakeDisc(context, 128, 2.0, &disc);
    const double expected = PI * 8.0 / 3.0;
    for (int size = 64; size <= 256; size *= 2) {
        const double pixel = 5.0 / (size - 1);
        const double rounding = pixel * PI * 4.0;
        const double measured = MeasureFaceOn(context, &disc, 2.5, size);
        CHECK_NEAR(measured - 0.35 * rounding, expected, 0.2 * rounding);
    }
    pvtMesh_Free(context, &disc);
    DestroyTestContext(context);
}

static void the_measure_of_a_square_is_side_cubed_over_six(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    const pvtVec3 corners[] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    pvtMesh square;
    CHECK_OK(context, pvtCreateMesh(context, corners, 4, indices, 2, &square));
    for (int size = 64; size <= 256; size *= 2) {
        const double pixel = 3.0 / (size - 1);
        const double rounding = pixel * 4.0;
        const double measured = MeasureFaceOn(context, &square, 1.5, size);
        CHECK_NEAR(measured - 0.5 * rounding, 8.0 / 6.0, 0.5 * rounding);
    }
    pvtMesh_Free(context, &square);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_equal_the_brute_force),
        cmocka_unit_test(a_full_mask_is_as_deep_as_its_border),
        cmocka_unit_test(the_sum_adds_up_the_distances),
        cmocka_unit_test(a_polygon_covers_the_centres_inside_it),
        cmocka_unit_test(views_are_orthonormal_and_weigh_one_in_all),
        cmocka_unit_test(the_measure_of_a_disc_is_pi_r_cubed_over_three),
        cmocka_unit_test(the_measure_of_a_square_is_side_cubed_over_six),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
