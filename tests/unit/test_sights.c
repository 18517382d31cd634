// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include "base/bits.h"
#include "base/vector.h"
#include "occluder/sight_mask.h"

enum { SIDE = 48 };

static const double RADIUS = SIDE / 2.0 - 4.0;

static bool HasPixel(const pvtSightMask* mask, int x, int y)
{
    return (mask->words[x / 64][y] >> (x % 64) & 1) != 0;
}

static int CountPixels(const pvtSightMask* mask, const pvtSightQuad* quad)
{
    int count = 0;
    for (int y = 2 * quad->y0; y < 2 * quad->y1; ++y) {
        for (int x = 2 * quad->x0; x < 2 * quad->x1; ++x) {
            count += HasPixel(mask, x, y) ? 1 : 0;
        }
    }
    return count;
}

static void sums_of_cells_count_pixels(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(4, 2);
    for (int trial = 0; trial < 20; ++trial) {
        pvtSightMask mask = {0};
        for (int i = 0; i < 900 * trial; ++i) {
            const unsigned x = 1 + pvtRandom_Below(&random, PVT_SIGHT_SIZE - 2);
            mask.words[x / 64][1 + pvtRandom_Below(&random, PVT_SIGHT_SIZE - 2)] |= UINT64_C(1)
                                                                                    << (x % 64);
        }
        uint16_t sums[PVT_SIGHT_ENDS][PVT_SIGHT_STRIDE];
        pvtSumMissing(&mask, sums);
        for (int i = 0; i < 50; ++i) {
            pvtSightQuad quad;
            quad.x0 = (uint8_t)pvtRandom_Below(&random, PVT_SIGHT_CELLS);
            quad.y0 = (uint8_t)pvtRandom_Below(&random, PVT_SIGHT_CELLS);
            quad.x1 = (uint8_t)(quad.x0 + 1 + pvtRandom_Below(&random, PVT_SIGHT_CELLS - quad.x0));
            quad.y1 = (uint8_t)(quad.y0 + 1 + pvtRandom_Below(&random, PVT_SIGHT_CELLS - quad.y0));
            assert_int_equal(pvtCountMissing(sums, &quad), CountPixels(&mask, &quad));
            uint16_t open[PVT_SIGHT_ENDS][PVT_SIGHT_STRIDE];
            pvtSumOpen(&mask, open);
            const int all = 4 * (quad.x1 - quad.x0) * (quad.y1 - quad.y0);
            assert_int_equal(pvtCountMissing(open, &quad), all - CountPixels(&mask, &quad));
        }
    }
}

static bool AreCellsSet(const uint64_t rows[PVT_SIGHT_CELLS], const pvtSightQuad* quad)
{
    bool areSet = true;
    for (int y = quad->y0; y < quad->y1; ++y) {
        for (int x = quad->x0; x < quad->x1; ++x) {
            areSet = areSet && (rows[y] >> x & 1) != 0;
        }
    }
    return areSet;
}

// An angle of seven cells, at the border of the screen: each rectangle within it comes up as often
// as its area tells, and all of them weigh what they should.
static void rectangles_come_up_as_often_as_they_are_large(void** state)
{
    (void)state;
    enum { LEFT = 60, ARM = 4, DRAWS = 200000 };
    uint64_t rows[PVT_SIGHT_CELLS] = {0};
    rows[0] = UINT64_C(0xF) << LEFT;
    rows[1] = rows[2] = rows[3] = UINT64_C(1) << LEFT;
    static pvtSightQuad quads[DRAWS];
    double weight = 0.0;
    pvtRandom random = pvtMakeRandom(3, 8);
    const size_t count = pvtDrawSightQuads(rows, DRAWS, &random, quads, &weight);
    int tallies[ARM][ARM + 1][ARM][ARM + 1] = {{{{0}}}};
    for (size_t q = 0; q < count; ++q) {
        assert_true(AreCellsSet(rows, &quads[q]));
        ++tallies[quads[q].x0 - LEFT][quads[q].x1 - LEFT][quads[q].y0][quads[q].y1];
    }
    int all = 0;
    const double each = weight * ARM * ARM * ARM * ARM * ARM * ARM; // (w × h × longer)²
    for (int i = 0; i < ARM * ARM * ARM * ARM; ++i) {
        const int x0 = i % ARM, y0 = i / ARM % ARM;
        const int x1 = i / (ARM * ARM) % ARM + 1, y1 = i / (ARM * ARM * ARM) + 1;
        const pvtSightQuad quad = {(uint8_t)(LEFT + x0), (uint8_t)y0, (uint8_t)(LEFT + x1),
                                   (uint8_t)y1};
        if (x0 < x1 && y0 < y1 && AreCellsSet(rows, &quad)) {
            const double area = (x1 - x0) * (y1 - y0);
            CHECK_NEAR(each * tallies[x0][x1][y0][y1] / area, 1.0, 0.05);
            ++all;
        }
    }
    assert_int_equal(all, 19); // ten in each arm, of which the corner's cell is the same
    rows[0] = rows[1] = rows[2] = rows[3] = 0;
    assert_int_equal(pvtDrawSightQuads(rows, DRAWS, &random, quads, &weight), 0);
    assert_true(weight == 0.0);
}

// Four by three cells with a pixel more on the right: what rectangles that are drawn count is what
// all of them do, each by its pixels beyond the goal.
static void rectangles_that_reach_too_far_count_by_what_is_beyond(void** state)
{
    (void)state;
    enum { LEFT = 20, LOW = 30, WIDE = 4, HIGH = 3, RING = 2, DRAWS = 200000 };
    pvtSightMask goal = {0};
    for (unsigned y = 2 * LOW; y < 2 * (LOW + HIGH); ++y) {
        goal.words[0][y] |= pvtMakeMask(2 * LEFT, 2 * (LEFT + WIDE));
    }
    goal.words[0][2 * LOW] |= UINT64_C(1) << (2 * (LEFT + WIDE));
    double right = 0.0, wrong = 0.0;
    for (int x0 = LEFT - RING; x0 <= LEFT + WIDE + RING; ++x0) {
        for (int x1 = x0 + 1; x1 <= LEFT + WIDE + 1 + RING; ++x1) {
            for (int y0 = LOW - RING; y0 < LOW + HIGH + RING; ++y0) {
                for (int y1 = y0 + 1; y1 <= LOW + HIGH + RING; ++y1) {
                    // Right of the cell of one pixel the ring is as high as around that.
                    const bool isNear = x1 <= LEFT + WIDE + RING || y1 <= LOW + 1 + RING;
                    const pvtSightQuad quad = {(uint8_t)x0, (uint8_t)y0, (uint8_t)x1, (uint8_t)y1};
                    const int pixels = 4 * (x1 - x0) * (y1 - y0);
                    const int beyond = pixels - CountPixels(&goal, &quad);
                    right += beyond == 0 ? pixels : 0.0;
                    wrong += isNear ? beyond : 0.0;
                }
            }
        }
    }
    static pvtWrongQuad wrongs[DRAWS];
    pvtRandom random = pvtMakeRandom(5, 9);
    const size_t count = pvtDrawWrongQuads(&goal, RING, DRAWS, &random, wrongs);
    double sum = 0.0;
    for (size_t q = 0; q < count; ++q) {
        assert_true(CountPixels(&goal, &wrongs[q].quad) <
                    4 * (wrongs[q].quad.x1 - wrongs[q].quad.x0) *
                        (wrongs[q].quad.y1 - wrongs[q].quad.y0));
        sum += (double)wrongs[q].weight;
    }
    // Of those within the goal, a block, all that are drawn would be kept.
    CHECK_NEAR(sum / DRAWS / (wrong / right), 1.0, 0.02);
    const pvtSightMask nothing = {0};
    assert_int_equal(pvtDrawWrongQuads(&nothing, RING, DRAWS, &random, wrongs), 0);
}

// Left of all three edges, or right of all; 0 when that may be rounded away.
static int FindSide(float (*places)[2], float x, float y)
{
    int left = 0, right = 0;
    for (int k = 0; k < 3; ++k) {
        const float* a = places[k];
        const float* b = places[(k + 1) % 3];
        const double dx = b[0] - a[0], dy = b[1] - a[1];
        const double away = (dx * (y - a[1]) - dy * (x - a[0])) / hypot(dx, dy);
        if (fabs(away) < 0.01) {
            return 0;
        }
        left += away > 0.0 ? 1 : 0;
        right += away < 0.0 ? 1 : 0;
    }
    return left == 3 || right == 3 ? 1 : -1;
}

static void triangles_cover_the_pixels_whose_centres_they_hold(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtTriangleSet set;
    CHECK_OK(context, pvtCreateTriangleSet(context, 3, 1, &set));
    for (int k = 0; k < 3; ++k) {
        pvtTriangleSet_AddCorner(&set, (float[3]){(float)k, (float)(k * k), 0.0F}, false);
    }
    pvtTriangleSet_AddTriangle(&set, (uint32_t[3]){0, 1, 2}, 0);
    pvtTriangleSet_FindEdges(&set);
    pvtRandom random = pvtMakeRandom(6, 3);
    int covered = 0;
    for (int trial = 0; trial < 200; ++trial) {
        float places[3][2];
        for (int k = 0; k < 3; ++k) {
            for (int axis = 0; axis < 2; ++axis) {
                places[set.triangles[0][k]][axis] =
                    -40.0F + 208.0F * (float)pvtRandom_Unit(&random);
            }
        }
        pvtSightMask mask = {0};
        pvtDrawSightTriangle(&set, places, 0, 0.0F, &mask);
        for (int y = 0; y < PVT_SIGHT_SIZE; ++y) {
            for (int x = 0; x < PVT_SIGHT_SIZE; ++x) {
                const int side = FindSide(places, (float)x + 0.5F, (float)y + 0.5F);
                assert_true(side == 0 || HasPixel(&mask, x, y) == (side > 0));
                covered += side > 0 ? 1 : 0;
            }
        }
    }
    assert_true(covered > 100000);
    pvtTriangleSet_Free(context, &set);
    DestroyTestContext(context);
}

static void sights_see_a_disc_and_draw_their_rectangles_within_it(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(3);
    pvtBitGrid grid;
    pvtField field;
    pvtSightSet sights;
    MakeEmptyGrid(context, SIDE, SIDE, SIDE, &grid);
    SetBall(&grid, (pvtVec3){0.5 * SIDE, 0.5 * SIDE, 0.5 * SIDE}, RADIUS);
    CHECK_OK(context, pvtCreateField(context, &grid, NULL, 64, &field));
    const pvtViewOptions views = pvtDefaultViewOptions();
    const pvtSightOptions options = {.views = &views, .count = 64, .quads = 400, .seed = 1};
    CHECK_OK(context, pvtCreateSights(context, &options, &field, &sights));
    for (size_t s = 0; s < sights.count; ++s) {
        const pvtSight* sight = &sights.sights[s];
        int pixels = 0;
        for (int y = 0; y < PVT_SIGHT_SIZE; ++y) {
            pixels += pvtCountBits(sight->goal.words[0][y]) + pvtCountBits(sight->goal.words[1][y]);
        }
        const double radius = RADIUS / (double)sight->pixelSize;
        const double area = 3.14159265 * radius * radius;
        assert_true(pixels < area + 12.0 * radius && pixels > area - 12.0 * radius);
        assert_true(sight->quadCount > 5);
        for (size_t q = 0; q < sight->quadCount; ++q) {
            const pvtSightQuad quad = sights.quads[sight->firstQuad + q];
            assert_int_equal(CountPixels(&sight->goal, &quad),
                             4 * (quad.x1 - quad.x0) * (quad.y1 - quad.y0));
        }
    }
    pvtSightSet_Free(context, &sights);
    pvtField_Free(context, &field);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void sights_of_a_mesh_show_its_pixels(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(3);
    const pvtGridFrame frame = {{-3.0, 2.0, 1.0}, 0.25, {SIDE, SIDE, SIDE}};
    const pvtVec3 positions[] = {{0.0, 4.0, 5.0}, {7.0, 9.0, 4.0}, {2.0, 12.0, 11.0}};
    const uint32_t indices[] = {0, 1, 2};
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, positions, 3, indices, 1, &mesh));
    const pvtViewOptions views = pvtDefaultViewOptions();
    const pvtSightOptions options = {
        .views = &views, .count = 64, .stray = 3.0, .quads = 400, .seed = 1};
    pvtSightSet sights;
    CHECK_OK(context, pvtCreateMeshSights(context, &options, &frame, &mesh, &sights));
    assert_int_equal(sights.count, 64);
    assert_true(sights.wrongCount > 1000);
    int covered = 0;
    for (size_t s = 0; s < sights.count; ++s) {
        const pvtSight* sight = &sights.sights[s];
        float places[3][2];
        for (int k = 0; k < 3; ++k) {
            const pvtVec3 at = pvtScale(pvtSub(positions[k], frame.origin), 1.0 / frame.voxelSize);
            const float p[3] = {(float)at.x, (float)at.y, (float)at.z};
            places[k][0] = sight->x;
            places[k][1] = sight->y;
            for (int axis = 0; axis < 3; ++axis) {
                places[k][0] += p[axis] * sight->right[axis];
                places[k][1] += p[axis] * sight->up[axis];
            }
        }
        for (int y = 0; y < PVT_SIGHT_SIZE; ++y) {
            for (int x = 0; x < PVT_SIGHT_SIZE; ++x) {
                const int side = FindSide(places, (float)x + 0.5F, (float)y + 0.5F);
                assert_true(side == 0 || HasPixel(&sight->goal, x, y) == (side > 0));
                covered += side > 0 ? 1 : 0;
            }
        }
    }
    assert_true(covered > 50000);
    pvtSightSet_Free(context, &sights);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// Plates a voxel thick and a voxel apart, of 72 voxels: all of it is border. A block has much less,
// however many of its nodes there are.
static void what_is_full_of_gaps_gets_fewer_sights(void** state)
{
    (void)state;
    static const int sizes[] = {250, 76};
    pvtContext* context = CreateTestContext(2);
    size_t counts[2];
    for (int i = 0; i < 2; ++i) {
        pvtBitGrid grid;
        pvtField field;
        pvtSightSet sights;
        const int size = sizes[i];
        MakeEmptyGrid(context, size, size, size, &grid);
        for (int z = 2; z < size - 2; z += i == 0 ? size : 2) {
            SetBox(&grid, (int[3]){2, 2, z},
                   (int[3]){size - 2, size - 2, i == 0 ? size - 2 : z + 1});
        }
        CHECK_OK(context, pvtCreateField(context, &grid, NULL, 250, &field));
        const pvtViewOptions views = pvtDefaultViewOptions();
        const pvtSightOptions options = {.views = &views, .count = 256, .quads = 40, .seed = 1};
        CHECK_OK(context, pvtCreateSights(context, &options, &field, &sights));
        CHECK_NEAR(sights.share, (double)sights.count / 256, 1e-12);
        counts[i] = sights.count;
        pvtSightSet_Free(context, &sights);
        pvtField_Free(context, &field);
        pvtBitGrid_Free(context, &grid);
    }
    assert_int_equal(counts[0], 256);
    assert_true(counts[1] >= 64 && counts[1] < 256);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sights_see_a_disc_and_draw_their_rectangles_within_it),
        cmocka_unit_test(sights_of_a_mesh_show_its_pixels),
        cmocka_unit_test(what_is_full_of_gaps_gets_fewer_sights),
        cmocka_unit_test(sums_of_cells_count_pixels),
        cmocka_unit_test(rectangles_come_up_as_often_as_they_are_large),
        cmocka_unit_test(rectangles_that_reach_too_far_count_by_what_is_beyond),
        cmocka_unit_test(triangles_cover_the_pixels_whose_centres_they_hold),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
