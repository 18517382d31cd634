// SPDX-License-Identifier: MIT
// Contexts and silhouettes. Needs libegl1, libgl1-mesa-dri and libosmesa6 at run time.
#include "failures.h"

#include "base/context.h"
#include "gl/gl_context.h"

#include <pthread.h>
#include <string.h>

static const pvtGlBackend backends[] = {PVT_GL_EGL, PVT_GL_OSMESA};

// Looks along −z with x to the right and y up.
static const pvtView frontView = {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, 1.0};

// A rectangle in the plane z = 0.5, one triangle wound each way.
static void MakeRectangle(const double lower[2], const double upper[2], pvtVec3 positions[4])
{
    positions[0] = (pvtVec3){lower[0], lower[1], 0.5};
    positions[1] = (pvtVec3){upper[0], lower[1], 0.5};
    positions[2] = (pvtVec3){upper[0], upper[1], 0.5};
    positions[3] = (pvtVec3){lower[0], upper[1], 0.5};
}

static uint32_t rectangleIndices[6] = {0, 1, 2, 0, 3, 2};

// Fails unless exactly the pixels of [left, right) × [bottom, top) are set.
static void CheckRectangle(const pvtBitmap* bitmap, const int lower[2], const int upper[2])
{
    for (int y = 0; y < bitmap->height; ++y) {
        for (int x = 0; x < bitmap->width; ++x) {
            const bool within = x >= lower[0] && x < upper[0] && y >= lower[1] && y < upper[1];
            if (pvtBitmap_Get(bitmap, x, y) != within) {
                fail_msg("pixel (%d, %d) should be %d", x, y, within);
            }
        }
    }
}

// Renders the rectangle from pixel centre to pixel centre of a frame that is far off the origin.
static void RenderRectangle(pvtContext* context, pvtGl* gl, const int lower[2], const int upper[2],
                            pvtBitmap* bitmap)
{
    const double pixelSize = 0.37, frame[2] = {1000.25, -77.0};
    double from[2], to[2];
    for (int i = 0; i < 2; ++i) {
        // A quarter of a pixel before the first centre and behind the last.
        from[i] = frame[i] + (lower[i] + 0.25) * pixelSize;
        to[i] = frame[i] + (upper[i] - 0.25) * pixelSize;
    }
    pvtVec3 positions[4];
    MakeRectangle(from, to, positions);
    const pvtMesh mesh = {positions, rectangleIndices, 4, 2};
    CHECK_OK(context,
             pvtRenderSilhouette(context, gl, &mesh, &frontView, frame, pixelSize, bitmap));
}

static void a_context_says_what_it_is(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (size_t i = 0; i < 2; ++i) {
        pvtGl* gl = NULL;
        CHECK_OK(context, pvtOpenGl(context, backends[i], &gl));
        assert_int_equal(pvtGl_GetBackend(gl), backends[i]);
        assert_memory_equal(pvtGl_GetName(gl), i == 0 ? "EGL (" : "OSMesa, ", 5);
        pvtCloseGl(context, gl);
    }
    pvtCloseGl(context, NULL);
    DestroyTestContext(context);
}

static void a_missing_library_names_the_packages_to_install(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtGlLibraries none = {"libEGL-missing.so.1", "libOSMesa-missing.so.8"};
    pvtGl* gl = NULL;
    assert_int_equal(pvtOpenGlFrom(context, PVT_GL_EGL, &none, &gl), PVT_UNSUPPORTED);
    assert_null(gl);
    assert_non_null(strstr(pvtContext_GetMessage(context), "libegl1"));
    assert_non_null(strstr(pvtContext_GetMessage(context), "libgl1-mesa-dri"));
    assert_int_equal(pvtOpenGlFrom(context, PVT_GL_OSMESA, &none, &gl), PVT_UNSUPPORTED);
    assert_non_null(strstr(pvtContext_GetMessage(context), "libosmesa6"));
    assert_int_equal(pvtOpenGlFrom(context, PVT_GL_AUTO, &none, &gl), PVT_UNSUPPORTED);
    assert_non_null(strstr(pvtContext_GetMessage(context), "libegl1"));
    assert_non_null(strstr(pvtContext_GetMessage(context), "libosmesa6"));
    assert_null(gl);
    assert_int_equal(pvtOpenGlFrom(context, (pvtGlBackend)7, &none, &gl), PVT_INVALID_ARGUMENT);
    DestroyTestContext(context);
}

static void a_library_of_something_else_is_unsupported(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtGlLibraries other = {"libm.so.6", "libm.so.6"};
    pvtGl* gl = NULL;
    assert_int_equal(pvtOpenGlFrom(context, PVT_GL_AUTO, &other, &gl), PVT_UNSUPPORTED);
    assert_null(gl);
    assert_false(pvtHasGlHardwareIn("libm.so.6"));
    DestroyTestContext(context);
}

static void without_egl_there_is_no_hardware_and_osmesa_is_taken(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const pvtGlLibraries onlyOsMesa = {"libEGL-missing.so.1", "libOSMesa.so.8"};
    assert_false(pvtHasGlHardwareIn(onlyOsMesa.egl));
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGlFrom(context, PVT_GL_AUTO, &onlyOsMesa, &gl));
    assert_int_equal(pvtGl_GetBackend(gl), PVT_GL_OSMESA);
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void hardware_is_what_auto_opens_first(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const bool hardware = pvtHasGlHardware();
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    assert_int_equal(pvtGl_GetBackend(gl), PVT_GL_EGL);
    const char* name = pvtGl_GetName(gl);
    if (hardware) {
        assert_non_null(strstr(name, "EGL (device)"));
    }
    if (strstr(name, "llvmpipe") != NULL) {
        assert_false(hardware);
    }
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void a_square_covers_the_pixels_whose_centres_it_covers(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (size_t i = 0; i < 2; ++i) {
        pvtGl* gl = NULL;
        CHECK_OK(context, pvtOpenGl(context, backends[i], &gl));
        pvtBitmap bitmap;
        CHECK_OK(context, pvtCreateBitmap(context, 131, 70, &bitmap));
        // The second image has nothing of the first in it, nor the third what is outside.
        const int lower[3][2] = {{3, 5}, {60, 1}, {-50, 40}};
        const int upper[3][2] = {{20, 12}, {131, 70}, {200, 41}};
        for (int round = 0; round < 3; ++round) {
            RenderRectangle(context, gl, lower[round], upper[round], &bitmap);
            CheckRectangle(&bitmap, lower[round], upper[round]);
        }
        assert_int_equal(pvtBitmap_Count(&bitmap), 131);
        pvtBitmap_Free(context, &bitmap);
        pvtCloseGl(context, gl);
    }
    DestroyTestContext(context);
}

static void a_view_from_behind_is_mirrored(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    const pvtView back = {{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}, 1.0};
    const double from[2] = {1, 1}, to[2] = {3, 6}, frame[2] = {-8, 0};
    pvtVec3 positions[4];
    MakeRectangle(from, to, positions);
    const pvtMesh mesh = {positions, rectangleIndices, 4, 2};
    pvtBitmap bitmap;
    CHECK_OK(context, pvtCreateBitmap(context, 8, 8, &bitmap));
    CHECK_OK(context, pvtRenderSilhouette(context, gl, &mesh, &back, frame, 1.0, &bitmap));
    CheckRectangle(&bitmap, (const int[]){5, 1}, (const int[]){7, 6});
    pvtBitmap_Free(context, &bitmap);
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void an_image_too_large_for_the_context_is_a_limit(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    const pvtMesh nothing = {0};
    const double lower[2] = {0, 0};
    pvtBitmap bitmap;
    CHECK_OK(context, pvtCreateBitmap(context, gl->maxSize + 1, 1, &bitmap));
    assert_int_equal(pvtRenderSilhouette(context, gl, &nothing, &frontView, lower, 1.0, &bitmap),
                     PVT_LIMIT);
    pvtBitmap_Free(context, &bitmap);
    // And the context still works.
    CHECK_OK(context, pvtCreateBitmap(context, 16, 1, &bitmap));
    CHECK_OK(context, pvtRenderSilhouette(context, gl, &nothing, &frontView, lower, 1.0, &bitmap));
    assert_int_equal(pvtBitmap_Count(&bitmap), 0);
    pvtBitmap_Free(context, &bitmap);
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void contexts_take_turns_on_one_thread(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtGl* gls[3] = {0};
    for (int i = 0; i < 3; ++i) {
        CHECK_OK(context, pvtOpenGl(context, backends[i % 2], &gls[i]));
    }
    pvtBitmap bitmap;
    CHECK_OK(context, pvtCreateBitmap(context, 64, 32, &bitmap));
    for (int round = 0; round < 12; ++round) {
        const int lower[2] = {round, 2}, upper[2] = {2 * round + 10, 3 + round};
        RenderRectangle(context, gls[round % 3], lower, upper, &bitmap);
        CheckRectangle(&bitmap, lower, upper);
    }
    pvtBitmap_Free(context, &bitmap);
    for (int i = 0; i < 3; ++i) {
        pvtCloseGl(context, gls[i]);
    }
    DestroyTestContext(context);
}

typedef struct Worker {
    pvtGlBackend backend;
    pthread_barrier_t* bothAreOpen;
    int wrong;
} Worker;

static void* DrawOnThread(void* user)
{
    Worker* worker = user;
    pvtContext* context = CreateTestContext(1);
    pvtGl* gl = NULL;
    pvtBitmap bitmap = {0};
    const bool ready = pvtOpenGl(context, worker->backend, &gl) == PVT_OK &&
                       pvtCreateBitmap(context, 90, 90, &bitmap) == PVT_OK;
    pthread_barrier_wait(worker->bothAreOpen);
    worker->wrong = ready ? 0 : 1000;
    const double frame[2] = {0, 0};
    for (int round = 0; ready && round < 40; ++round) {
        const int side = 3 + 2 * round + (int)worker->backend;
        const double from[2] = {0, 0}, to[2] = {side, side};
        pvtVec3 positions[4];
        MakeRectangle(from, to, positions);
        const pvtMesh mesh = {positions, rectangleIndices, 4, 2};
        worker->wrong +=
            pvtRenderSilhouette(context, gl, &mesh, &frontView, frame, 1.0, &bitmap) != PVT_OK;
        worker->wrong += pvtBitmap_Count(&bitmap) != (uint64_t)(side * side);
    }
    pvtBitmap_Free(context, &bitmap);
    pvtCloseGl(context, gl);
    worker->wrong += pvtContext_GetHeldBytes(context) != 0;
    pvtDestroyContext(context);
    return NULL;
}

static void contexts_draw_at_once_on_threads_of_their_own(void** state)
{
    (void)state;
    enum { THREADS = 4 };
    pthread_barrier_t bothAreOpen;
    pthread_t threads[THREADS];
    Worker workers[THREADS];
    assert_int_equal(pthread_barrier_init(&bothAreOpen, NULL, THREADS), 0);
    for (int i = 0; i < THREADS; ++i) {
        workers[i] = (Worker){backends[i % 2], &bothAreOpen, 0};
        assert_int_equal(pthread_create(&threads[i], NULL, DrawOnThread, &workers[i]), 0);
    }
    for (int i = 0; i < THREADS; ++i) {
        pthread_join(threads[i], NULL);
    }
    pthread_barrier_destroy(&bothAreOpen);
    for (int i = 0; i < THREADS; ++i) {
        assert_int_equal(workers[i].wrong, 0);
    }
}

static pvtStatus OpenAndDraw(pvtContext* context, pvtGlBackend backend)
{
    pvtGl* gl = NULL;
    pvtStatus status = pvtOpenGl(context, backend, &gl);
    if (status != PVT_OK) {
        assert_null(gl);
        return status;
    }
    uint64_t row = 0;
    pvtBitmap bitmap = {&row, 8, 1, 1};
    const double frame[2] = {0, 0};
    pvtVec3 positions[4];
    MakeRectangle((const double[]){0, 0}, (const double[]){3, 1}, positions);
    const pvtMesh mesh = {positions, rectangleIndices, 4, 2};
    status = pvtRenderSilhouette(context, gl, &mesh, &frontView, frame, 1.0, &bitmap);
    assert_int_equal(row, status == PVT_OK ? 7 : 0);
    pvtCloseGl(context, gl);
    return status;
}

static void a_refused_allocation_leaks_nothing(void** state)
{
    (void)state;
    for (size_t i = 0; i < 2; ++i) {
        bool refused = true;
        for (int first = 1; refused; ++first) {
            PoorHeap heap = {.failAt = first, .failsOnce = true};
            pvtContext* context = CreatePoorContext(&heap);
            const pvtStatus status = OpenAndDraw(context, backends[i]);
            refused = PoorHeap_HasRefused(&heap);
            assert_int_equal(status, refused ? PVT_OUT_OF_MEMORY : PVT_OK);
            assert_true(first < 20);
            DestroyTestContext(context);
        }
    }
}

static void a_cancelled_silhouette_stops(void** state)
{
    (void)state;
    CancelCounter counter = {0};
    pvtContext* context = CreateCancelledContext(&counter, 1);
    assert_int_equal(OpenAndDraw(context, PVT_GL_AUTO), PVT_CANCELLED);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_context_says_what_it_is),
        cmocka_unit_test(a_missing_library_names_the_packages_to_install),
        cmocka_unit_test(a_library_of_something_else_is_unsupported),
        cmocka_unit_test(without_egl_there_is_no_hardware_and_osmesa_is_taken),
        cmocka_unit_test(hardware_is_what_auto_opens_first),
        cmocka_unit_test(a_square_covers_the_pixels_whose_centres_it_covers),
        cmocka_unit_test(a_view_from_behind_is_mirrored),
        cmocka_unit_test(an_image_too_large_for_the_context_is_a_limit),
        cmocka_unit_test(contexts_take_turns_on_one_thread),
        cmocka_unit_test(contexts_draw_at_once_on_threads_of_their_own),
        cmocka_unit_test(a_refused_allocation_leaks_nothing),
        cmocka_unit_test(a_cancelled_silhouette_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
