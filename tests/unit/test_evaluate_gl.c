// SPDX-License-Identifier: MIT
// The evaluator's pictures against those of a graphics driver, which shares no code with them.
// Needs libegl1 and libgl1-mesa-dri at run time.
#include "evaluate_shapes.h"

#include "base/bits.h"
#include "base/random.h"
#include "base/vector.h"
#include "evaluate/view.h"

#include <paravent/gl.h>
#include <paravent/io.h>

enum { PIXELS = 256, VIEWS = 6 };

// Both round corners to 1/256 pixel, the driver after rounding to float: a pixel may differ where
// its centre is this near to an edge, and only there.
static const double NEAR = 3.0 / 256.0; // [px]

// Distance [px] of a point from a segment.
static double GetDistance(const double a[2], const double b[2], const double p[2])
{
    const double along[2] = {b[0] - a[0], b[1] - a[1]}, off[2] = {p[0] - a[0], p[1] - a[1]};
    const double square = along[0] * along[0] + along[1] * along[1];
    const double t = square > 0.0 ? (along[0] * off[0] + along[1] * off[1]) / square : 0.0;
    const double s = fmin(fmax(t, 0.0), 1.0);
    return hypot(off[0] - s * along[0], off[1] - s * along[1]);
}

static void Project(const pvtScreen* screen, pvtVec3 position, double pixel[2])
{
    pixel[0] = (pvtDot(screen->right, position) - screen->lower[0]) / screen->pixelSize;
    pixel[1] = (pvtDot(screen->up, position) - screen->lower[1]) / screen->pixelSize;
}

static bool IsNearAnEdge(const pvtScreen* screen, const pvtMesh* mesh, int x, int y)
{
    const double center[2] = {x + 0.5, y + 0.5};
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        double corners[3][2];
        for (size_t k = 0; k < 3; ++k) {
            Project(screen, mesh->positions[mesh->indices[3 * t + k]], corners[k]);
        }
        for (size_t k = 0; k < 3; ++k) {
            if (GetDistance(corners[k], corners[(k + 1) % 3], center) < NEAR) {
                return true;
            }
        }
    }
    return false;
}

// The number of covered pixels; adds those that differ, each of which must be excused.
static uint64_t CompareView(pvtContext* context, pvtGl* gl, const pvtMesh* mesh, pvtVec3 direction,
                            uint64_t* different)
{
    pvtSoup soup;
    pvtRaster raster = {0};
    pvtBitmap bitmap;
    pvtScreen screen = pvtMakeScreen(direction);
    CHECK_OK(context, pvtCreateSoup(context, "the mesh", mesh, &soup));
    CHECK_OK(context, pvtFitScreen(context, &soup, PIXELS, &screen));
    CHECK_OK(context, pvtRaster_Resize(context, &raster, screen.width, screen.height));
    pvtScreenPoint* points = malloc(soup.positionCount * sizeof *points);
    assert_true(pvtRasterizeSoup(context, &screen, &soup, points, &raster));

    const pvtView view = {screen.direction, screen.right, screen.up, 1.0};
    CHECK_OK(context, pvtCreateBitmap(context, screen.width, screen.height, &bitmap));
    CHECK_OK(context, pvtRenderSilhouette(context, gl, mesh, &view, screen.lower, screen.pixelSize,
                                          &bitmap));
    for (int y = 0; y < screen.height; ++y) {
        const uint64_t* row = raster.words + (size_t)y * raster.wordsPerRow;
        for (int x = 0; x < screen.width; ++x) {
            if (pvtGetBit(row, (size_t)x) != pvtBitmap_Get(&bitmap, x, y)) {
                ++*different;
                assert_true(IsNearAnEdge(&screen, mesh, x, y));
            }
        }
    }
    const uint64_t covered = pvtBitmap_Count(&bitmap);
    free(points);
    pvtBitmap_Free(context, &bitmap);
    pvtRaster_Free(context, &raster);
    pvtSoup_Free(context, &soup);
    return covered;
}

static void CompareMesh(pvtContext* context, pvtGl* gl, const char* name, const pvtMesh* mesh)
{
    const pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    uint64_t covered = 0, different = 0;
    for (int v = 0; v < VIEWS; ++v) {
        covered += CompareView(context, gl, mesh, pvtGetViewDirection(&options, v), &different);
    }
    assert_true(covered > 1000);
    print_message("%s: %llu of %llu pixels differ\n", name, (unsigned long long)different,
                  (unsigned long long)covered);
    assert_true(different * 1000 <= covered);
}

static void CompareFile(pvtContext* context, pvtGl* gl, const char* folder, const char* name)
{
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    const pvtLoadOptions options = pvtDefaultLoadOptions();
    pvtModel model;
    CHECK_OK(context, pvtLoadModel(context, &options, path, &model));
    CompareMesh(context, gl, name, &model.mesh);
    pvtModel_Free(context, &model);
}

static void pixels_are_those_of_a_driver_but_where_centres_touch_edges(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    pvtMesh ball = CreateBall(70, 1.0, (pvtVec3){100, -30, 7});
    CompareMesh(context, gl, "a ball", &ball);
    FreeBall(&ball);
    static const char* const names[] = {"building_kaykit_a.glb", "foliage_commontree_1.glb",
                                        "prop_rock1.glb", "vehicle_kaykit_police.glb"};
    for (size_t i = 0; i < sizeof names / sizeof *names; ++i) {
        CompareFile(context, gl, PVT_TEST_MODELS, names[i]);
    }
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void pixels_of_large_models_are_those_of_a_driver(void** state)
{
    (void)state;
    const char* folder = getenv("PVT_MODELS");
    if (folder == NULL) {
        skip();
    }
    pvtContext* context = CreateTestContext(1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    CompareFile(context, gl, folder, "dragon_res2_202520.glb");
    CompareFile(context, gl, folder, "bunny_4968.glb");
    CompareFile(context, gl, folder, "interior_dream_apartment.glb");
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_are_those_of_a_driver_but_where_centres_touch_edges),
        cmocka_unit_test(pixels_of_large_models_are_those_of_a_driver),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
