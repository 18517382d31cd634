// SPDX-License-Identifier: MIT
#include "lesson.h"

#include "occluder/beyond.h"

static void following_the_pull_hides_more(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 10, 9.0F, &lesson);
    const pvtPullOptions options = {.count = 64, .softness = 20.0F, .wantsEdges = true};
    double before = 0.0;
    for (int step = 0; step < 20; ++step) {
        pvtPullCorners(context, &options, &lesson.puller);
        assert_true(lesson.puller.share > before);
        before = lesson.puller.share;
        double most = 0.0;
        for (int c = 0; c < lesson.set.cornerCount; ++c) {
            for (int axis = 0; axis < 3; ++axis) {
                most = fmax(most, fabs((double)lesson.puller.corners[c][axis]));
            }
        }
        assert_true(most > 0.0);
        for (int c = 0; c < lesson.set.cornerCount; ++c) {
            for (int axis = 0; axis < 3; ++axis) {
                lesson.set.corners[c][axis] += lesson.puller.corners[c][axis] / (float)most;
            }
        }
    }
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

static bool HasPixel(const pvtSightMask* mask, int x, int y)
{
    return x >= 0 && y >= 0 && x < PVT_SIGHT_SIZE && y < PVT_SIGHT_SIZE &&
           pvtGetBit(&mask->words[x / 64][y], (size_t)x % 64);
}

static int CountAround(const pvtSightMask* mask, int x, int y, int width)
{
    int count = 0;
    for (int i = 0; i < width * width; ++i) {
        count += HasPixel(mask, x + i % width, y + i / width) ? 1 : 0;
    }
    return count;
}

static void cells_away_from_the_goal_are_beyond_it(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 1, RADIUS, &lesson);
    pvtSightMask goals[2] = {lesson.sights.sights[0].goal, {{{0}}}};
    pvtRandom random = pvtMakeRandom(8, 3);
    for (int i = 0; i < 90; ++i) {
        const size_t x = pvtRandom_Below(&random, PVT_SIGHT_SIZE);
        pvtSetBit(&goals[1].words[x / 64][pvtRandom_Below(&random, PVT_SIGHT_SIZE)], x % 64);
    }
    for (int g = 0; g < 2; ++g) {
        const pvtSightMask* goal = &goals[g];
        pvtSightMask beyond;
        pvtFindBeyond(goal, &beyond);
        int all = 0, out = 0;
        for (int i = 0; i < PVT_SIGHT_CELLS * PVT_SIGHT_CELLS; ++i) {
            const int x = 2 * (i % PVT_SIGHT_CELLS), y = 2 * (i / PVT_SIGHT_CELLS);
            const bool isBeyond = CountAround(goal, x - 1, y - 1, 4) == 0;
            assert_int_equal(CountAround(&beyond, x, y, 2), isBeyond ? 4 : 0);
            out += isBeyond ? 4 : 0;
            all += CountAround(goal, x, y, 2);
        }
        assert_true(out > 0 && all > 0);
        CHECK_NEAR(pvtGetCostBeyond(goal, &beyond, &beyond), 20.0 * out / all, 1e-9);
        assert_true(pvtGetCostBeyond(goal, &beyond, goal) == 0.0);
    }
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

// The one triangle of a set: across x, with its corners so far from the middle [vx].
static void PlaceAcross(float reach, pvtTriangleSet* set)
{
    for (int k = 0; k < 3; ++k) {
        const float angle = 2.1F * (float)k;
        set->corners[k][0] = CENTER;
        set->corners[k][1] = CENTER + reach * cosf(angle);
        set->corners[k][2] = CENTER + reach * sinf(angle);
    }
}

// Whether all corners are pulled towards the middle.
static bool AreDrawnIn(const Lesson* lesson)
{
    bool areIn = true;
    for (int c = 0; c < 3; ++c) {
        const float* pull = lesson->puller.corners[c];
        const float* corner = lesson->set.corners[c];
        areIn = areIn && pull[1] * (corner[1] - CENTER) + pull[2] * (corner[2] - CENTER) < 0.0F;
    }
    return areIn;
}

// It hides all of the ball, so that nothing else pulls.
static void what_reaches_beyond_the_goal_is_pulled_back(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 1, RADIUS, &lesson);
    PlaceAcross(3.0F * RADIUS, &lesson.set);
    for (size_t s = 0; s < lesson.sights.count; ++s) {
        // From the side it is an edge, and hides little.
        const pvtSight* sight = &lesson.sights.sights[s];
        const float* r = sight->right;
        const float* u = sight->up;
        const float facing = fabsf(r[1] * u[2] - r[2] * u[1]) * sight->pixelSize * sight->pixelSize;
        lesson.sights.sights[s].weight *= facing > 0.9F ? 1.0F : 0.0F;
    }
    pvtPullOptions options = {.count = 64, .softness = 20.0F};
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(lesson.puller.share > 0.999);
    for (int c = 0; c < 3; ++c) {
        assert_true(lesson.puller.corners[c][1] == 0.0F && lesson.puller.corners[c][2] == 0.0F);
    }
    options.mindsBeyond = true;
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(lesson.puller.share > 0.999); // what edges are pulled by is as without
    assert_true(AreDrawnIn(&lesson));
    options.wantsNoPulls = true;
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(lesson.puller.share < 0.0);
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

// A plate across x with sights of itself, and a triangle that hides all of it, and more if `reach`
// is above 6 [vx].
static void MakePlateLesson(pvtContext* context, float reach, Lesson* lesson)
{
    MakeBall(context, &lesson->grid);
    CHECK_OK(context, pvtCreateField(context, &lesson->grid, NULL, 64, &lesson->field));
    pvtVec3 positions[3] = {{0}};
    for (int k = 0; k < 3; ++k) {
        const double angle = 2.1 * k;
        positions[k] = (pvtVec3){(double)CENTER, (double)CENTER + 6.0 * cos(angle),
                                 (double)CENTER + 6.0 * sin(angle)};
    }
    const uint32_t indices[3] = {0, 1, 2};
    pvtMesh plate;
    CHECK_OK(context, pvtCreateMesh(context, positions, 3, indices, 1, &plate));
    const pvtWeightedDirection along = {{1.0, 0.1, 0.2}, 1.0};
    pvtViewOptions views = pvtDefaultViewOptions();
    views.list = &along;
    views.listCount = 1;
    const pvtSightOptions options = {
        .views = &views, .count = 64, .stray = 4.0, .quads = 400, .seed = 1};
    CHECK_OK(context,
             pvtCreateMeshSights(context, &options, &lesson->grid.frame, &plate, &lesson->sights));
    pvtMesh_Free(context, &plate);
    RollTriangles(context, 1, reach, &lesson->set);
    PlaceAcross(reach, &lesson->set);
    CHECK_OK(context, pvtCreatePuller(context, &lesson->sights, &lesson->set, &lesson->puller));
}

static void what_is_hidden_wrongly_is_counted_and_pulled_back(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakePlateLesson(context, 6.0F, &lesson);
    pvtPullOptions options = {.count = 64, .softness = 1.0F};
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(lesson.puller.right > 0.0);
    assert_true(lesson.puller.wrong < 0.002 * lesson.puller.right);
    FreeLesson(context, &lesson);

    MakePlateLesson(context, 8.0F, &lesson);
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(lesson.puller.share > 0.999);
    assert_true(lesson.puller.wrong > 0.1 * lesson.puller.right);
    assert_false(AreDrawnIn(&lesson));
    options.wrongCost = 1.0F;
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(lesson.puller.share > 0.999);
    assert_true(AreDrawnIn(&lesson));
    const double wrong = lesson.puller.wrong;
    options.wantsNoPulls = true;
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(wrong == lesson.puller.wrong);
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

static void what_another_covers_as_well_is_worth_nothing_alone(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 6, 12.0F, &lesson);
    // Triangle 3 becomes a copy of triangle 1.
    memcpy(lesson.set.triangles[3], lesson.set.triangles[1], sizeof lesson.set.triangles[3]);
    pvtTriangleSet_FindEdges(&lesson.set);
    const pvtPullOptions options = {.count = PVT_MOST_WEIGHED, .softness = 10.0F};
    pvtWeighTriangles(context, &options, &lesson.puller);
    assert_true(lesson.puller.triangles[1] == 0.0 && lesson.puller.triangles[3] == 0.0);
    assert_true(pvtArePartners(&lesson.puller, 1, 3));
    for (int t = 0; t < 6; ++t) {
        assert_true(t == 1 || t == 3 || lesson.puller.triangles[t] > 0.0);
    }
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

// All over the triangles, not only where contacts were.

static void a_share_is_the_same_with_pulls_and_without(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Lesson lesson;
    MakeLesson(context, 8, 12.0F, &lesson);
    pvtPullOptions options = {.count = 64, .softness = 2.0F};
    pvtPullCorners(context, &options, &lesson.puller);
    const double share = lesson.puller.share;
    options.wantsNoPulls = true;
    pvtPullCorners(context, &options, &lesson.puller);
    assert_true(share > 0.0 && share == lesson.puller.share);
    FreeLesson(context, &lesson);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(following_the_pull_hides_more),
        cmocka_unit_test(cells_away_from_the_goal_are_beyond_it),
        cmocka_unit_test(what_reaches_beyond_the_goal_is_pulled_back),
        cmocka_unit_test(what_is_hidden_wrongly_is_counted_and_pulled_back),
        cmocka_unit_test(what_another_covers_as_well_is_worth_nothing_alone),
        cmocka_unit_test(a_share_is_the_same_with_pulls_and_without),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
