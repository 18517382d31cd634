// SPDX-License-Identifier: MIT
// Previews: what must be seen in the six tiles.
#include "failures.h"

#include <limits.h>
#include <math.h>
#include <paravent/gl.h>
#include <stdlib.h>
#include <string.h>

enum { TILE = 96, TILES = 6 };

typedef struct Scene {
    pvtContext* context;
    pvtGl* gl;
    pvtPreviewOptions options;
} Scene;

static Scene OpenScene(void)
{
    Scene scene = {.context = CreateTestContext(1), .options = pvtDefaultPreviewOptions()};
    CHECK_OK(scene.context, pvtOpenGl(scene.context, PVT_GL_AUTO, &scene.gl));
    scene.options.tileSize = TILE;
    return scene;
}

static void CloseScene(Scene* scene)
{
    pvtCloseGl(scene->context, scene->gl);
    DestroyTestContext(scene->context);
}

// Positions and indices of a box: bit i of a corner's index says which end along axis i.
typedef struct Box {
    pvtVec3 positions[8];
    pvtMesh mesh;
} Box;

static uint32_t boxIndices[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                  2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

static void MakeBox(pvtVec3 lower, pvtVec3 upper, Box* box)
{
    for (int i = 0; i < 8; ++i) {
        box->positions[i] = (pvtVec3){i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y,
                                      i & 4 ? upper.z : lower.z};
    }
    box->mesh = (pvtMesh){box->positions, boxIndices, 8, 12};
}

static const uint8_t* GetPixel(const pvtImage* image, int tile, int x, int y)
{
    const size_t row = (size_t)(tile / 3 * TILE + y), column = (size_t)(tile % 3 * TILE + x);
    return image->pixels + 4 * (row * (size_t)image->width + column);
}

// How colourful a pixel is: the clay and the background are not.
static int GetChroma(const uint8_t* pixel)
{
    int least = 255, most = 0;
    for (int i = 0; i < 3; ++i) {
        least = pixel[i] < least ? pixel[i] : least;
        most = pixel[i] > most ? pixel[i] : most;
    }
    return most - least;
}

typedef enum Kind { BACKGROUND, ORIGINAL, OCCLUDER } Kind;

// The background is a gradient from top to bottom, and cool where the clay is warm.
static Kind Classify(const uint8_t* pixel)
{
    if (GetChroma(pixel) > 40) {
        return OCCLUDER;
    }
    return pixel[2] >= pixel[0] && pixel[0] > 215 ? BACKGROUND : ORIGINAL;
}

typedef struct Counts {
    int of[3];
    int left, right, top, bottom; // [px] free before the first that is not background
} Counts;

static Counts CountTile(const pvtImage* image, int tile)
{
    Counts counts = {{0, 0, 0}, TILE, TILE, TILE, TILE};
    for (int y = 1; y < TILE; ++y) {
        for (int x = 1; x < TILE; ++x) { // the first row and column may be a line between tiles
            const Kind kind = Classify(GetPixel(image, tile, x, y));
            ++counts.of[kind];
            if (kind != BACKGROUND) {
                counts.left = x < counts.left ? x : counts.left;
                counts.top = y < counts.top ? y : counts.top;
                counts.right = TILE - x < counts.right ? TILE - x : counts.right;
                counts.bottom = TILE - y < counts.bottom ? TILE - y : counts.bottom;
            }
        }
    }
    return counts;
}

static void every_tile_shows_original_occluder_and_background(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    Box original, occluder;
    MakeBox((pvtVec3){-2, -1, -1.5}, (pvtVec3){2, 1, 1.5}, &original);
    MakeBox((pvtVec3){-1, -0.5, -0.7}, (pvtVec3){1, 0.5, 0.7}, &occluder);
    pvtImage image;
    CHECK_OK(scene.context, pvtRenderPreview(scene.context, scene.gl, &scene.options,
                                             &original.mesh, &occluder.mesh, &image));
    assert_int_equal(image.width, 3 * TILE);
    assert_int_equal(image.height, 2 * TILE);
    for (int tile = 0; tile < TILES; ++tile) {
        const Counts counts = CountTile(&image, tile);
        for (int kind = 0; kind < 3; ++kind) {
            assert_true(counts.of[kind] > TILE * TILE / 20);
        }
    }
    for (size_t i = 0; i < (size_t)image.width * (size_t)image.height; ++i) {
        assert_int_equal(image.pixels[4 * i + 3], 255);
    }
    pvtImage_Free(scene.context, &image);
    CloseScene(&scene);
}

static void without_an_occluder_nothing_is_coloured(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    Box original;
    MakeBox((pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, &original);
    const pvtMesh none = {0};
    pvtImage image;
    CHECK_OK(scene.context, pvtRenderPreview(scene.context, scene.gl, &scene.options,
                                             &original.mesh, &none, &image));
    for (int tile = 0; tile < TILES; ++tile) {
        const Counts counts = CountTile(&image, tile);
        assert_int_equal(counts.of[OCCLUDER], 0);
        assert_true(counts.of[ORIGINAL] > TILE * TILE / 4);
    }
    pvtImage_Free(scene.context, &image);
    CloseScene(&scene);
}

static void each_view_is_framed_tightly(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    Box original;
    MakeBox((pvtVec3){100, -3, 7}, (pvtVec3){101, 9, 10}, &original);
    const pvtMesh none = {0};
    pvtImage image;
    CHECK_OK(scene.context, pvtRenderPreview(scene.context, scene.gl, &scene.options,
                                             &original.mesh, &none, &image));
    for (int tile = 0; tile < TILES; ++tile) {
        const Counts counts = CountTile(&image, tile);
        const int margins[4] = {counts.left, counts.right, counts.top, counts.bottom};
        for (int i = 0; i < 4; ++i) {
            assert_true(margins[i] >= 2);
        }
        assert_in_range(abs(counts.left - counts.right), 0, 3);
        assert_in_range(abs(counts.top - counts.bottom), 0, 3);
        const int across = counts.left + counts.right, down = counts.top + counts.bottom;
        assert_in_range(across < down ? across : down, 4, TILE / 5);
    }
    pvtImage_Free(scene.context, &image);
    CloseScene(&scene);
}

// Renders a wedge that looks different from everywhere, with a sheet in it. Model axis i runs along
// axes[i] of the world, factors[i] long.
static void RenderWedge(Scene* scene, const int axes[3], const double factors[3], pvtImage* image)
{
    const double model[7][3] = {{-2, -1, 3},  {2, -1, 3},  {-2, 3, 3},  {-2, -1, 4},
                                {-1, 0, 3.1}, {0, 0, 3.1}, {-1, 1, 3.1}};
    pvtVec3 positions[7];
    for (int i = 0; i < 7; ++i) {
        double at[3];
        for (int axis = 0; axis < 3; ++axis) {
            at[axes[axis]] = model[i][axis] * factors[axis];
        }
        positions[i] = (pvtVec3){at[0], at[1], at[2]};
    }
    uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, sheet[3] = {4, 5, 6};
    const pvtMesh original = {positions, faces, 4, 4}, occluder = {positions, sheet, 7, 1};
    CHECK_OK(scene->context, pvtRenderPreview(scene->context, scene->gl, &scene->options, &original,
                                              &occluder, image));
}

static void the_picture_does_not_depend_on_the_size_of_the_model(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    const int axes[3] = {0, 1, 2};
    const double scales[4] = {1.0, 0x1p-900, 0x1p-60, 0x1p1020};
    pvtImage images[4];
    for (int i = 0; i < 4; ++i) {
        RenderWedge(&scene, axes, (const double[]){scales[i], scales[i], scales[i]}, &images[i]);
    }
    for (int i = 3; i >= 0; --i) {
        assert_memory_equal(images[i].pixels, images[0].pixels, 4 * 3 * TILE * 2 * TILE);
        pvtImage_Free(scene.context, &images[i]);
    }
    CloseScene(&scene);
}

static void the_picture_stands_upright_along_any_axis(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    // The same model, turned so that its y points along x, y or z of the world.
    const int axes[3][3] = {{1, 0, 2}, {0, 1, 2}, {0, 2, 1}};
    const double factors[3][3] = {{1, 1, -1}, {1, 1, 1}, {1, 1, -1}};
    pvtImage images[3];
    for (int up = 0; up < 3; ++up) {
        scene.options.up = (pvtAxis)up;
        RenderWedge(&scene, axes[up], factors[up], &images[up]);
    }
    // From the front the right angle of the wedge is at the lower left.
    assert_int_not_equal(Classify(GetPixel(&images[1], 1, TILE / 4, TILE * 3 / 4)), BACKGROUND);
    assert_int_equal(Classify(GetPixel(&images[1], 1, TILE * 3 / 4, TILE / 4)), BACKGROUND);
    for (int up = 2; up >= 0; --up) {
        assert_memory_equal(images[up].pixels, images[1].pixels, 4 * 3 * TILE * 2 * TILE);
        if (up != 1) {
            pvtImage_Free(scene.context, &images[up]);
        }
    }
    pvtImage_Free(scene.context, &images[1]);
    CloseScene(&scene);
}

static void polygons_on_one_plane_share_a_colour_that_others_have_not(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    // Seen from the front: two triangles of one square to the left, and two squares of other depths
    // in the middle and to the right.
    pvtVec3 positions[12];
    uint32_t indices[18];
    for (uint32_t square = 0; square < 3; ++square) {
        for (uint32_t i = 0; i < 4; ++i) {
            positions[4 * square + i] =
                (pvtVec3){square + (i == 1 || i == 2 ? 0.9 : 0.0), i >= 2 ? 1.0 : 0.0, square};
        }
        const uint32_t order[6] = {0, 1, 2, 0, 2, 3};
        for (uint32_t i = 0; i < 6; ++i) {
            indices[6 * square + i] = 4 * square + order[i];
        }
    }
    const pvtMesh none = {0}, occluder = {positions, indices, 12, 6};
    pvtImage image;
    CHECK_OK(scene.context,
             pvtRenderPreview(scene.context, scene.gl, &scene.options, &none, &occluder, &image));
    const Counts counts = CountTile(&image, 1);
    const int width = TILE - counts.left - counts.right;
    const uint8_t* colours[4];
    for (int i = 0; i < 4; ++i) {
        // Off the diagonal of the first square, above and below it.
        const double across[4] = {0.07, 0.22, 0.46, 0.80};
        const int y = TILE / 2 + (i == 0 ? -1 : 1) * width / 14;
        colours[i] = GetPixel(&image, 1, counts.left + (int)(across[i] * width), y);
        assert_int_equal(Classify(colours[i]), OCCLUDER);
    }
    assert_memory_equal(colours[0], colours[1], 4);
    for (int i = 2; i < 4; ++i) {
        int difference = 0;
        for (int c = 0; c < 3; ++c) {
            difference += abs(colours[i][c] - colours[i - 1][c]);
        }
        assert_true(difference > 60);
    }
    pvtImage_Free(scene.context, &image);
    CloseScene(&scene);
}

static void what_sticks_out_is_more_solid_than_what_lies_within(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    Box original, within, outside;
    MakeBox((pvtVec3){0, 0, 0}, (pvtVec3){4, 4, 4}, &original);
    MakeBox((pvtVec3){1, 1, 1}, (pvtVec3){3, 3, 3}, &within);
    MakeBox((pvtVec3){1, 1, 1}, (pvtVec3){3, 3, 5}, &outside);
    int chroma[2];
    for (int i = 0; i < 2; ++i) {
        pvtImage image;
        const pvtMesh* occluder = i == 0 ? &within.mesh : &outside.mesh;
        CHECK_OK(scene.context, pvtRenderPreview(scene.context, scene.gl, &scene.options,
                                                 &original.mesh, occluder, &image));
        chroma[i] = GetChroma(GetPixel(&image, 1, TILE / 2 + 4, TILE / 2 - 9));
        pvtImage_Free(scene.context, &image);
    }
    assert_true(chroma[1] > chroma[0] + 20);
    CloseScene(&scene);
}

static void degenerate_models_have_a_picture(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    pvtVec3 flat[4] = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
    pvtVec3 needle[3] = {{5, 0, 0}, {5, 1e-300, 0}, {5, 7, 0}};
    pvtVec3 point[3] = {{1e300, 1e300, -1e300}, {1e300, 1e300, -1e300}, {1e300, 1e300, -1e300}};
    pvtVec3 huge[3] = {{-1.7e308, 0, 0}, {1.7e308, 0, 0}, {0, 1.7e308, 1.7e308}};
    uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    const pvtMesh meshes[] = {{flat, indices, 4, 2},
                              {needle, indices, 3, 1},
                              {point, indices, 3, 1},
                              {huge, indices, 3, 1},
                              {0}};
    for (size_t i = 0; i < sizeof meshes / sizeof meshes[0]; ++i) {
        pvtImage image;
        CHECK_OK(scene.context, pvtRenderPreview(scene.context, scene.gl, &scene.options,
                                                 &meshes[i], &meshes[4 - i], &image));
        assert_int_equal(Classify(GetPixel(&image, 0, 3, 3)), BACKGROUND);
        if (i == 0) {
            // The sheet is seen from above and from below.
            assert_true(CountTile(&image, 4).of[ORIGINAL] > TILE * TILE / 2);
            assert_true(CountTile(&image, 5).of[ORIGINAL] > TILE * TILE / 10);
        }
        pvtImage_Free(scene.context, &image);
    }
    CloseScene(&scene);
}

static void tile_sizes_out_of_range_are_refused(void** state)
{
    (void)state;
    Scene scene = OpenScene();
    const pvtMesh none = {0};
    const int sizes[] = {-1, 0, 63, 2049};
    for (size_t i = 0; i < 4; ++i) {
        scene.options.tileSize = sizes[i];
        pvtImage image;
        assert_int_equal(
            pvtRenderPreview(scene.context, scene.gl, &scene.options, &none, &none, &image),
            PVT_INVALID_ARGUMENT);
        assert_null(image.pixels);
    }
    CloseScene(&scene);
}

static void a_refused_allocation_leaks_nothing(void** state)
{
    (void)state;
    PoorHeap heap = {.failAt = INT_MAX, .failsOnce = true};
    pvtContext* context = CreatePoorContext(&heap);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    const size_t held = pvtContext_GetHeldBytes(context);
    Box box;
    MakeBox((pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, &box);
    const pvtPreviewOptions options = {.tileSize = 64, .up = PVT_AXIS_Y};
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int refused = 0; status != PVT_OK; ++refused) {
        pvtImage image;
        atomic_store(&heap.requests, 0);
        heap.failAt = refused;
        status = pvtRenderPreview(context, gl, &options, &box.mesh, &box.mesh, &image);
        heap.failAt = INT_MAX;
        assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
        assert_true(refused < 20 && (refused > 0 || status == PVT_OUT_OF_MEMORY));
        assert_true((image.pixels != NULL) == (status == PVT_OK));
        pvtImage_Free(context, &image);
        assert_int_equal(pvtContext_GetHeldBytes(context), held);
    }
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void a_cancelled_preview_leaves_no_image(void** state)
{
    (void)state;
    CancelCounter counter = {0};
    pvtContext* context = CreateCancelledContext(&counter, 1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    Box box;
    MakeBox((pvtVec3){0, 0, 0}, (pvtVec3){1, 1, 1}, &box);
    const pvtPreviewOptions options = {.tileSize = 64, .up = PVT_AXIS_Y};
    for (int later = 0; later < 5; ++later) {
        atomic_store(&counter.left, later);
        pvtImage image;
        assert_int_equal(pvtRenderPreview(context, gl, &options, &box.mesh, &box.mesh, &image),
                         PVT_CANCELLED);
        assert_null(image.pixels);
    }
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_tile_shows_original_occluder_and_background),
        cmocka_unit_test(without_an_occluder_nothing_is_coloured),
        cmocka_unit_test(each_view_is_framed_tightly),
        cmocka_unit_test(the_picture_does_not_depend_on_the_size_of_the_model),
        cmocka_unit_test(the_picture_stands_upright_along_any_axis),
        cmocka_unit_test(polygons_on_one_plane_share_a_colour_that_others_have_not),
        cmocka_unit_test(what_sticks_out_is_more_solid_than_what_lies_within),
        cmocka_unit_test(degenerate_models_have_a_picture),
        cmocka_unit_test(tile_sizes_out_of_range_are_refused),
        cmocka_unit_test(a_refused_allocation_leaks_nothing),
        cmocka_unit_test(a_cancelled_preview_leaves_no_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
