// SPDX-License-Identifier: MIT
// What is cut out of a masked triangle is opaque everywhere, and at the finest level it is all that
// is; however the texture is wrapped, turned or stretched over it.
#include "check.h"

#include "base/random.h"
#include "io/mask_cut.h"

#include <stdlib.h>
#include <string.h>

static pvtAlpha MakeAlpha(uint8_t* values, int width, int height)
{
    return (pvtAlpha){values, width, height};
}

// Which texel a renderer takes for index i.
static int WrapIndex(long i, int side, pvtWrap wrap)
{
    if (wrap == PVT_WRAP_CLAMP) {
        return i < 0 ? 0 : i >= side ? side - 1 : (int)i;
    }
    const long period = wrap == PVT_WRAP_MIRROR ? 2L * side : side;
    const long rest = (i % period + period) % period;
    return (int)(rest < side ? rest : period - 1 - rest);
}

// The least and the linearly mixed alpha of the four texels around a point, as OpenGL has it.
static int LeastAround(const pvtAlpha* alpha, const pvtWrap wraps[2], const double texel[2])
{
    const long x = (long)floor(texel[0] - 0.5), y = (long)floor(texel[1] - 0.5);
    int least = 255;
    for (int k = 0; k < 4; ++k) {
        const int column = WrapIndex(x + k % 2, alpha->width, wraps[0]);
        const int row = WrapIndex(y + k / 2, alpha->height, wraps[1]);
        const int value = alpha->values[row * alpha->width + column];
        least = value < least ? value : least;
    }
    return least;
}

// How far a point is from where two footprints meet: near it rounding decides.
static double DistanceToBorder(const double texel[2])
{
    const double x = fabs(texel[0] - 0.5 - floor(texel[0])),
                 y = fabs(texel[1] - 0.5 - floor(texel[1]));
    return fmin(x, y);
}

// In the plane of the test triangles, whose positions are (x, y, 0). Winding is checked too: a
// piece is turned as its triangle.
static bool IsInPiece(const pvtPieceSet* set, size_t index, double x, double y)
{
    const pvtPiece* piece = &set->pieces[index];
    for (size_t i = 0; i < piece->count; ++i) {
        const pvtVec3 a = set->points[piece->first + i].position;
        const pvtVec3 b = set->points[piece->first + (i + 1) % piece->count].position;
        if ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x) < 0.0) {
            return false;
        }
    }
    return true;
}

typedef struct Case {
    uint8_t values[40 * 40];
    pvtAlpha alpha;
    pvtWrap wraps[2];
    pvtAlphaMap map;
    pvtMaskedTriangle triangle;
    double toTexel[6]; // from (x, y)
    pvtPieceSet set;
} Case;

static void MapPoint(const Case* c, double x, double y, double texel[2])
{
    texel[0] = c->toTexel[0] * x + c->toTexel[1] * y + c->toTexel[2];
    texel[1] = c->toTexel[3] * x + c->toTexel[4] * y + c->toTexel[5];
}

static void MakeRandomCase(pvtContext* context, pvtRandom* random, Case* c)
{
    const int width = 1 + (int)pvtRandom_Below(random, 40),
              height = 1 + (int)pvtRandom_Below(random, 40);
    // Blobs rather than noise, so that coarser levels have something opaque.
    const double scale = 0.2 + pvtRandom_Unit(random), turn = 6.28 * pvtRandom_Unit(random);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double wave = sin(scale * x + turn) + cos(scale * y - turn);
            c->values[y * width + x] = (uint8_t)(127.0 + 60.0 * wave);
        }
    }
    c->alpha = MakeAlpha(c->values, width, height);
    c->wraps[0] = (pvtWrap)pvtRandom_Below(random, 3);
    c->wraps[1] = (pvtWrap)pvtRandom_Below(random, 3);
    CHECK_OK(context, pvtBuildAlphaMap(context, &c->alpha, c->wraps, &c->map));
    for (int k = 0; k < 6; ++k) {
        c->toTexel[k] = 60.0 * (pvtRandom_Unit(random) - 0.5);
    }
    const double corners[3][2] = {{0, 0}, {1, 0.1}, {0.2, 1}};
    for (int i = 0; i < 3; ++i) {
        c->triangle.corners[i].position = (pvtVec3){corners[i][0], corners[i][1], 0};
        MapPoint(c, corners[i][0], corners[i][1], c->triangle.corners[i].texel);
    }
    c->triangle.threshold = (int)pvtRandom_Below(random, 257);
}

// How many pieces hold the point; the whole triangle counts as one.
static int CountPieces(const Case* c, double x, double y)
{
    int count = c->set.isWhole ? 1 : 0;
    for (size_t i = 0; i < c->set.count; ++i) {
        count += IsInPiece(&c->set, i, x, y) ? 1 : 0;
    }
    return count;
}

static void CheckPoints(const Case* c, pvtRandom* random, bool isFinest)
{
    for (int i = 0; i < 300; ++i) {
        double s = pvtRandom_Unit(random), t = pvtRandom_Unit(random);
        if (s + t > 1.0) {
            s = 1.0 - s;
            t = 1.0 - t;
        }
        const double x = s + 0.2 * t, y = 0.1 * s + t;
        double texel[2];
        MapPoint(c, x, y, texel);
        if (DistanceToBorder(texel) < 1e-6 || fmin(fmin(s, t), 1.0 - s - t) < 1e-9) {
            continue;
        }
        const bool isOpaque = LeastAround(&c->alpha, c->wraps, texel) >= c->triangle.threshold;
        const int count = CountPieces(c, x, y);
        if (count > 1 || (count == 1 && !isOpaque) || (isFinest && isOpaque && count == 0)) {
            fail_msg("texel %g %g: %s, but in %d pieces", texel[0], texel[1],
                     isOpaque ? "opaque" : "transparent", count);
        }
    }
}

static void pieces_are_just_what_is_opaque(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(7, 1);
    Case* c = calloc(1, sizeof *c);
    assert_non_null(c);
    size_t pieceCount = 0;
    for (int i = 0; i < 400; ++i) {
        MakeRandomCase(context, &random, c);
        // The finest, then ever coarser cells: 0.02 of the triangle's unit sides on.
        const pvtCutRules rules = {i % 4 == 0 ? 0.0 : 0.02 * (i % 4), i % 7 == 6 ? 1 : 0, 10000};
        CHECK_OK(context, pvtCutMaskedTriangle(context, &c->map, &rules, &c->triangle, &c->set));
        assert_false(c->set.isTooMany);
        assert_false(c->set.isWhole && c->set.count > 0);
        pieceCount += c->set.count;
        CheckPoints(c, &random, rules.cell == 0.0 && rules.extraLevels == 0);
        pvtAlphaMap_Free(context, &c->map);
    }
    assert_true(pieceCount > 1000);
    pvtPieceSet_Free(context, &c->set);
    free(c);
    DestroyTestContext(context);
}

// Whether p lies on the edge a–b, away from its ends.
static bool IsOnEdge(pvtVec3 a, pvtVec3 b, pvtVec3 p)
{
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double length = hypot(dx, dy);
    const double along = ((p.x - a.x) * dx + (p.y - a.y) * dy) / length;
    const double across = fabs((p.x - a.x) * dy - (p.y - a.y) * dx) / length;
    return across < 1e-10 && along > 1e-7 && along < length - 1e-7;
}

static void CheckEdges(const pvtPieceSet* set, const pvtPiece* piece)
{
    for (size_t i = 0; i < piece->count; ++i) {
        const pvtVec3 a = set->points[piece->first + i].position;
        const pvtVec3 b = set->points[piece->first + (i + 1) % piece->count].position;
        for (size_t k = 0; k < set->pointCount; ++k) {
            if (IsOnEdge(a, b, set->points[k].position)) {
                fail_msg("point %zu lies on an edge that has no point there", k);
            }
        }
    }
}

static void pieces_meet_point_to_point(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(11, 1);
    Case* c = calloc(1, sizeof *c);
    assert_non_null(c);
    size_t added = 0;
    for (int i = 0; i < 100; ++i) {
        MakeRandomCase(context, &random, c);
        const pvtCutRules rules = {0.02 * (i % 3), 0, 10000};
        CHECK_OK(context, pvtCutMaskedTriangle(context, &c->map, &rules, &c->triangle, &c->set));
        for (size_t k = 0; k < c->set.count; ++k) {
            CheckEdges(&c->set, &c->set.pieces[k]);
            added += c->set.pieces[k].count > 7 ? 1 : 0;
        }
        pvtAlphaMap_Free(context, &c->map);
    }
    assert_true(added > 10);
    pvtPieceSet_Free(context, &c->set);
    free(c);
    DestroyTestContext(context);
}

// Two columns of 4 × 4 texels, the left ones opaque.
static const uint8_t kHalf[16] = {255, 255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 255, 255, 0, 0};

// A triangle over the unit square's lower left half, its corners at these texels.
static pvtMaskedTriangle MakeTriangle(const double texels[3][2])
{
    pvtMaskedTriangle triangle = {.threshold = 128};
    const pvtVec3 positions[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (int i = 0; i < 3; ++i) {
        triangle.corners[i] = (pvtMaskedCorner){positions[i], {texels[i][0], texels[i][1]}};
    }
    return triangle;
}

static double GetPieceArea(const pvtPieceSet* set)
{
    double sum = set->isWhole ? 1.0 : 0.0;
    for (size_t i = 0; i < set->count; ++i) {
        const pvtPiecePoint* points = set->points + set->pieces[i].first;
        for (size_t k = 2; k < set->pieces[i].count; ++k) {
            const pvtVec3 a = points[0].position, b = points[k - 1].position;
            const pvtVec3 c = points[k].position;
            sum += (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        }
    }
    return 0.5 * sum;
}

typedef struct OddCase {
    double texels[3][2];
    double area; // of what is opaque
} OddCase;

static void odd_texture_coordinates_never_add_surface(void** state)
{
    (void)state;
    // Clamped: opaque up to texel 1.5, where filtering begins to mix.
    const OddCase cases[] = {
        {{{0, 0}, {4, 0}, {0, 4}}, 0.5 - 0.5 * 0.625 * 0.625},
        {{{-1e9, 0}, {1e9, 0}, {-1e9, 1}}, 0.375},         // half of its width
        {{{1, 1}, {1, 1}, {1, 1}}, 0.5},                   // one opaque place
        {{{3, 1}, {3, 1}, {3, 1}}, 0.0},                   // one transparent place
        {{{1.5, 2}, {1.5, 2}, {1.5, 2}}, 0.0},             // where both meet, nothing is for sure
        {{{0, 1}, {3, 1}, {0, 1}}, 0.5 - 0.5 * 0.5 * 0.5}, // a line across both
        {{{0.5, 0}, {0.5, 3}, {0.5, 9}}, 0.5},             // a line within one
        {{{NAN, 0}, {4, 0}, {0, 4}}, 0.0},
        {{{0, 0}, {INFINITY, 0}, {0, 4}}, 0.0},
        {{{0, 0}, {4, 0}, {0, 1e300}}, 0.0},
        {{{0, 0}, {4, 0}, {0, -INFINITY}}, 0.0},
    };
    pvtContext* context = CreateTestContext(1);
    uint8_t values[16];
    memcpy(values, kHalf, sizeof values);
    const pvtAlpha alpha = {values, 4, 4};
    const pvtWrap clamp[2] = {PVT_WRAP_CLAMP, PVT_WRAP_CLAMP};
    pvtAlphaMap map;
    CHECK_OK(context, pvtBuildAlphaMap(context, &alpha, clamp, &map));
    pvtPieceSet set = {0};
    const pvtCutRules rules = {.maxPieces = 100};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        const pvtMaskedTriangle triangle = MakeTriangle(cases[i].texels);
        CHECK_OK(context, pvtCutMaskedTriangle(context, &map, &rules, &triangle, &set));
        CHECK_NEAR(GetPieceArea(&set), cases[i].area, 1e-6);
    }
    pvtPieceSet_Free(context, &set);
    pvtAlphaMap_Free(context, &map);
    DestroyTestContext(context);
}

// A texture that a triangle repeats 2 × 10⁹ times: no work and no surface, unless it is opaque.
static void endless_repetition_is_all_or_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    uint8_t values[16];
    memcpy(values, kHalf, sizeof values);
    const pvtAlpha alpha = {values, 4, 4};
    const pvtWrap repeat[2] = {PVT_WRAP_REPEAT, PVT_WRAP_MIRROR};
    pvtAlphaMap map;
    CHECK_OK(context, pvtBuildAlphaMap(context, &alpha, repeat, &map));
    pvtPieceSet set = {0};
    const pvtCutRules rules = {.maxPieces = 100};
    pvtMaskedTriangle triangle =
        MakeTriangle((const double[3][2]){{-4e9, -4e9}, {4e9, -4e9}, {-4e9, 4e9}});
    CHECK_OK(context, pvtCutMaskedTriangle(context, &map, &rules, &triangle, &set));
    assert_int_equal(set.count, 0);
    assert_false(set.isWhole);
    triangle.threshold = 0;
    CHECK_OK(context, pvtCutMaskedTriangle(context, &map, &rules, &triangle, &set));
    assert_true(set.isWhole);
    assert_int_equal(set.cellCount, 0);
    pvtPieceSet_Free(context, &set);
    pvtAlphaMap_Free(context, &map);
    DestroyTestContext(context);
}

static void stripes_become_one_piece_each(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    uint8_t values[64 * 64];
    for (int i = 0; i < 64 * 64; ++i) {
        values[i] = i % 8 < 4 ? 255 : 0;
    }
    const pvtAlpha alpha = {values, 64, 64};
    const pvtWrap repeat[2] = {PVT_WRAP_REPEAT, PVT_WRAP_REPEAT};
    pvtAlphaMap map;
    CHECK_OK(context, pvtBuildAlphaMap(context, &alpha, repeat, &map));
    pvtPieceSet set = {0};
    const pvtMaskedTriangle triangle = MakeTriangle((const double[3][2]){{0, 0}, {64, 0}, {0, 64}});
    pvtCutRules rules = {.maxPieces = 8};
    CHECK_OK(context, pvtCutMaskedTriangle(context, &map, &rules, &triangle, &set));
    assert_int_equal(set.count, 8);
    assert_false(set.isTooMany);
    rules.maxPieces = 7;
    CHECK_OK(context, pvtCutMaskedTriangle(context, &map, &rules, &triangle, &set));
    assert_true(set.isTooMany);
    // Cells of four texels hold a gap wherever they lie.
    rules.cell = 4.0 / 64.0;
    CHECK_OK(context, pvtCutMaskedTriangle(context, &map, &rules, &triangle, &set));
    assert_int_equal(set.count, 0);
    assert_false(set.isTooMany);
    pvtPieceSet_Free(context, &set);
    pvtAlphaMap_Free(context, &map);
    DestroyTestContext(context);
}

static bool StopAtOnce(void* user)
{
    (void)user;
    return true;
}

static void maps_and_cuts_stop_when_they_are_asked_to(void** state)
{
    (void)state;
    pvtContextDef def = pvtDefaultContextDef();
    pvtContext *context = NULL, *patient = CreateTestContext(1);
    def.threadCount = 1;
    def.isCancelled = StopAtOnce;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    uint8_t values[16];
    memcpy(values, kHalf, sizeof values);
    const pvtAlpha alpha = {values, 4, 4};
    const pvtWrap repeat[2] = {PVT_WRAP_REPEAT, PVT_WRAP_REPEAT};
    pvtAlphaMap map;
    assert_int_equal(pvtBuildAlphaMap(context, &alpha, repeat, &map), PVT_CANCELLED);
    CHECK_OK(patient, pvtBuildAlphaMap(patient, &alpha, repeat, &map));
    pvtPieceSet set = {0};
    const pvtMaskedTriangle triangle = MakeTriangle((const double[3][2]){{0, 0}, {4, 0}, {0, 4}});
    const pvtCutRules rules = {.maxPieces = 8};
    assert_int_equal(pvtCutMaskedTriangle(context, &map, &rules, &triangle, &set), PVT_CANCELLED);
    pvtPieceSet_Free(context, &set);
    pvtAlphaMap_Free(patient, &map);
    DestroyTestContext(context);
    DestroyTestContext(patient);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pieces_are_just_what_is_opaque),
        cmocka_unit_test(pieces_meet_point_to_point),
        cmocka_unit_test(odd_texture_coordinates_never_add_surface),
        cmocka_unit_test(endless_repetition_is_all_or_nothing),
        cmocka_unit_test(stripes_become_one_piece_each),
        cmocka_unit_test(maps_and_cuts_stop_when_they_are_asked_to),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
