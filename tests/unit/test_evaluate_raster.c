// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/bits.h"
#include "base/random.h"
#include "evaluate/raster.h"

#include <math.h>
#include <string.h>

static bool Get(const pvtRaster* raster, int x, int y)
{
    return pvtGetBit(raster->words + (size_t)y * raster->wordsPerRow, (size_t)x);
}

static uint64_t CountAll(const pvtRaster* raster)
{
    uint64_t count = 0;
    for (size_t i = 0; i < raster->wordsPerRow * (size_t)raster->height; ++i) {
        count += (uint64_t)pvtCountBits(raster->words[i]);
    }
    return count;
}

static pvtScreenPoint RandomPoint(pvtRandom* random, int range)
{
    const int x = (int)pvtRandom_Below(random, (uint32_t)range) - range / 4;
    const int y = (int)pvtRandom_Below(random, (uint32_t)range) - range / 4;
    return (pvtScreenPoint){x, y};
}

// The side of the line from a to b that the centre of (x, y) lies on; 0: on it.
static int64_t GetSide(pvtScreenPoint a, pvtScreenPoint b, int x, int y)
{
    const int64_t px = 256 * (int64_t)x + 128, py = 256 * (int64_t)y + 128;
    return ((int64_t)b.x - a.x) * (py - a.y) - ((int64_t)b.y - a.y) * (px - a.x);
}

// The fill rule in its own words: strictly inside, or on a left edge, or on a level upper edge.
static bool IsInside(const pvtScreenPoint p[3], int x, int y)
{
    for (int k = 0; k < 3; ++k) {
        const pvtScreenPoint a = p[k], b = p[(k + 1) % 3], c = p[(k + 2) % 3];
        const int64_t inner = ((int64_t)b.x - a.x) * ((int64_t)c.y - a.y) -
                              ((int64_t)b.y - a.y) * ((int64_t)c.x - a.x);
        const int64_t side = GetSide(a, b, x, y);
        // The edge bounds the triangle from the left when the third corner lies to the right of
        // the point of the edge's line at the third corner's height.
        const int64_t high = (int64_t)b.y - a.y;
        const bool left = high != 0 && (inner > 0) == (high < 0);
        const bool upper = high == 0 && c.y < a.y;
        if (inner == 0 || (side == 0 && !left && !upper) ||
            (side != 0 && (side > 0) != (inner > 0))) {
            return false;
        }
    }
    return true;
}

static void triangles_cover_the_centres_that_the_rule_names(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(7, 0);
    pvtRaster raster = {0};
    for (int round = 0; round < 3000; ++round) {
        // Small and large ones, some with corners right on pixel centres.
        const int range = round % 3 == 0 ? 1500 : 60000;
        pvtScreenPoint p[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = RandomPoint(&random, range);
            if (round % 2 == 0) {
                p[k] = (pvtScreenPoint){(p[k].x & ~255) + 128, (p[k].y & ~255) + 128};
            }
        }
        const int width = 20 + round % 110, height = 90;
        CHECK_OK(context, pvtRaster_Resize(context, &raster, width, height));
        pvtRaster_FillTriangle(&raster, p[0], p[1], p[2]);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                assert_int_equal(Get(&raster, x, y), IsInside(p, x, y));
            }
        }
        uint64_t inside = 0;
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                inside += Get(&raster, x, y);
            }
        }
        assert_int_equal(inside, CountAll(&raster)); // no bit past the width
    }
    pvtRaster_Free(context, &raster);
    DestroyTestContext(context);
}

// A fan around a point within a rectangle, of corners on its border: together they are the
// rectangle, and no two share a pixel.
static void a_fan_covers_each_pixel_once(void** state)
{
    (void)state;
    enum { SIDE = 100, CORNERS = 24 };
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(11, 0);
    pvtRaster raster = {0};
    for (int round = 0; round < 200; ++round) {
        const int snap = round % 2 == 0 ? 128 : 1; // centres and half pixels, or anything
        const int last = SIDE * 256;
        pvtScreenPoint ring[CORNERS];
        for (int k = 0; k < CORNERS; ++k) {
            const int part = k % (CORNERS / 4);
            const int along = part == 0 ? 0 : last * part / (CORNERS / 4) / snap * snap;
            const pvtScreenPoint sides[4] = {
                {along, 0}, {last, along}, {last - along, last}, {0, last - along}};
            ring[k] = sides[k / (CORNERS / 4)];
        }
        const pvtScreenPoint middle = {(int)pvtRandom_Below(&random, (uint32_t)last) / snap * snap,
                                       (int)pvtRandom_Below(&random, (uint32_t)last) / snap * snap};
        uint8_t counts[SIDE * SIDE] = {0};
        for (int k = 0; k < CORNERS; ++k) {
            CHECK_OK(context, pvtRaster_Resize(context, &raster, SIDE, SIDE));
            pvtRaster_FillTriangle(&raster, middle, ring[k], ring[(k + 1) % CORNERS]);
            for (int i = 0; i < SIDE * SIDE; ++i) {
                counts[i] = (uint8_t)(counts[i] + Get(&raster, i % SIDE, i / SIDE));
            }
        }
        for (int i = 0; i < SIDE * SIDE; ++i) {
            assert_int_equal(counts[i], 1);
        }
    }
    pvtRaster_Free(context, &raster);
    DestroyTestContext(context);
}

static void winding_does_not_matter(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(13, 0);
    pvtRaster one = {0}, other = {0};
    for (int round = 0; round < 500; ++round) {
        const pvtScreenPoint a = RandomPoint(&random, 30000), b = RandomPoint(&random, 30000),
                             c = RandomPoint(&random, 30000);
        CHECK_OK(context, pvtRaster_Resize(context, &one, 100, 100));
        CHECK_OK(context, pvtRaster_Resize(context, &other, 100, 100));
        pvtRaster_FillTriangle(&one, a, b, c);
        pvtRaster_FillTriangle(&other, c, b, a);
        assert_memory_equal(one.words, other.words, 200 * sizeof(uint64_t));
    }
    pvtRaster_Free(context, &one);
    pvtRaster_Free(context, &other);
    DestroyTestContext(context);
}

static void huge_triangles_are_cut_by_the_screen(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtVec3 positions[4] = {{-1e90, -1e90, 0}, {1e90, -1e90, 0}, {1e90, 1e90, 0}, {-1e90, 1e90, 0}};
    uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    const pvtMesh mesh = {positions, indices, 4, 2};
    pvtSoup soup;
    CHECK_OK(context, pvtCreateSoup(context, "the sheet", &mesh, &soup));
    pvtScreen screen = pvtMakeScreen((pvtVec3){0, 0, -1});
    screen.lower[0] = screen.lower[1] = -1.0;
    screen.pixelSize = 0.02;
    screen.width = screen.height = 100;
    pvtScreenPoint points[4];
    pvtRaster raster = {0};
    CHECK_OK(context, pvtRaster_Resize(context, &raster, 100, 100));
    assert_true(pvtRasterizeSoup(context, &screen, &soup, points, &raster));
    assert_int_equal(CountAll(&raster), 100 * 100);
    pvtRaster_Free(context, &raster);
    pvtSoup_Free(context, &soup);
    DestroyTestContext(context);
}

static void screens_are_orthonormal_and_upright(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(17, 0);
    for (int round = 0; round < 1000; ++round) {
        const pvtVec3 d = {pvtRandom_Unit(&random) - 0.5,
                           round % 9 == 0 ? 100.0 : pvtRandom_Unit(&random) - 0.5,
                           pvtRandom_Unit(&random) - 0.5};
        const pvtScreen s = pvtMakeScreen(d);
        const double rightUp = s.right.x * s.up.x + s.right.y * s.up.y + s.right.z * s.up.z;
        assert_true(fabs(rightUp) < 1e-14);
        const pvtVec3 out = {s.right.y * s.up.z - s.right.z * s.up.y,
                             s.right.z * s.up.x - s.right.x * s.up.z,
                             s.right.x * s.up.y - s.right.y * s.up.x};
        assert_true(fabs(out.x + s.direction.x) < 1e-14 && fabs(out.y + s.direction.y) < 1e-14 &&
                    fabs(out.z + s.direction.z) < 1e-14);
        assert_true(fabs(s.direction.y) > 0.999 || (s.right.y == 0.0 && s.up.y > 0.0));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_cover_the_centres_that_the_rule_names),
        cmocka_unit_test(a_fan_covers_each_pixel_once),
        cmocka_unit_test(winding_does_not_matter),
        cmocka_unit_test(huge_triangles_are_cut_by_the_screen),
        cmocka_unit_test(screens_are_orthonormal_and_upright),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
