// SPDX-License-Identifier: MIT
// Images come back as they went, are there whole or not at all, and their module is found where it
// should be and nowhere else.
#include "file_fixture.h"

#include "io/companion.h"

#include <sys/stat.h>

static int TearDownModules(void** state)
{
    (void)unsetenv("PARAVENT_MODULE_PATH");
    return TearDown(state);
}

// Every value of red, green, blue and alpha somewhere.
static pvtImage MakeRamps(pvtContext* context, int width, int height)
{
    pvtImage image;
    CHECK_OK(context, pvtCreateImage(context, width, height, &image));
    for (int i = 0; i < width * height; ++i) {
        image.pixels[4 * i] = (uint8_t)i;
        image.pixels[4 * i + 1] = (uint8_t)(3 * i + 7);
        image.pixels[4 * i + 2] = (uint8_t)(255 - i);
        image.pixels[4 * i + 3] = (uint8_t)(i / 256 * 37);
    }
    return image;
}

static void a_png_comes_back_to_the_last_bit(void** state)
{
    Fixture* f = *state;
    pvtImage image = MakeRamps(f->context, 61, 43), back;
    const char* path = InFolder(&f->folder, "ramps.png");
    CHECK_OK(f->context, pvtSaveImage(f->context, path, &image));
    CHECK_OK(f->context, pvtLoadImage(f->context, path, &back));
    assert_int_equal(back.width, 61);
    assert_int_equal(back.height, 43);
    assert_memory_equal(back.pixels, image.pixels, 4 * 61 * 43);
    pvtImage_Free(f->context, &back);
    pvtImage_Free(f->context, &image);
}

static void the_same_picture_is_the_same_bytes(void** state)
{
    Fixture* f = *state;
    pvtImage image = MakeRamps(f->context, 40, 30);
    static uint8_t bytes[2][1 << 16];
    size_t sizes[2];
    for (int i = 0; i < 2; ++i) {
        const char* path = InFolder(&f->folder, i == 0 ? "a.png" : "b.png");
        CHECK_OK(f->context, pvtSaveImage(f->context, path, &image));
        FILE* file = fopen(path, "rb");
        assert_non_null(file);
        sizes[i] = fread(bytes[i], 1, sizeof bytes[i], file);
        (void)fclose(file);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    pvtImage_Free(f->context, &image);
}

static void other_formats_are_read_as_four_channels(void** state)
{
    Fixture* f = *state;
    pvtImage image;
    // Two grey pixels, then two with colours: PNM, which needs no library to write.
    WriteBytes(InFolder(&f->folder, "grey.pgm"), "P5\n2 1\n255\n\x10\xf0", 13);
    CHECK_OK(f->context, pvtLoadImage(f->context, InFolder(&f->folder, "grey.pgm"), &image));
    const uint8_t grey[8] = {0x10, 0x10, 0x10, 255, 0xf0, 0xf0, 0xf0, 255};
    assert_memory_equal(image.pixels, grey, 8);
    pvtImage_Free(f->context, &image);
    WriteBytes(InFolder(&f->folder, "colours.ppm"), "P6\n1 2\n255\n\x01\x02\x03\x04\x05\x06", 17);
    CHECK_OK(f->context, pvtLoadImage(f->context, InFolder(&f->folder, "colours.ppm"), &image));
    const uint8_t colours[8] = {1, 2, 3, 255, 4, 5, 6, 255};
    assert_int_equal(image.height, 2);
    assert_memory_equal(image.pixels, colours, 8);
    pvtImage_Free(f->context, &image);
}

static void what_is_no_image_is_refused_by_name(void** state)
{
    Fixture* f = *state;
    pvtImage image;
    const char* path = InFolder(&f->folder, "x.png");
    WriteText(path, "this is not a picture");
    assert_int_equal(pvtLoadImage(f->context, path, &image), PVT_INVALID_INPUT);
    CheckMessage(f->context, "x.png");
    assert_null(image.pixels);
    WriteText(path, "");
    assert_int_equal(pvtLoadImage(f->context, path, &image), PVT_INVALID_INPUT);
    CheckMessage(f->context, "empty");
    assert_int_equal(pvtLoadImage(f->context, "/dev/zero", &image), PVT_INVALID_INPUT);
    CheckMessage(f->context, "device");

    pvtImage whole = MakeRamps(f->context, 64, 64);
    CHECK_OK(f->context, pvtSaveImage(f->context, path, &whole));
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(truncate(path, info.st_size / 2), 0);
    assert_int_equal(pvtLoadImage(f->context, path, &image), PVT_INVALID_INPUT);
    CheckMessage(f->context, "x.png");
    assert_null(image.pixels);
    pvtImage_Free(f->context, &whole);
}

static void an_image_that_cannot_be_written_leaves_nothing(void** state)
{
    Fixture* f = *state;
    pvtImage image = MakeRamps(f->context, 8, 8);
    const pvtImage none = {0};
    assert_int_equal(pvtSaveImage(f->context, "/nonexistent/x.png", &image), PVT_OUTPUT_FAILED);
    assert_int_equal(pvtSaveImage(f->context, "/dev/full", &image), PVT_OUTPUT_FAILED);
    assert_int_equal(pvtSaveImage(f->context, InFolder(&f->folder, "x.jpg"), &image),
                     PVT_UNSUPPORTED);
    assert_int_equal(pvtSaveImage(f->context, InFolder(&f->folder, "x.png"), &none),
                     PVT_INVALID_ARGUMENT);
    pvtImage_Free(f->context, &image);
    assert_int_equal(RemoveTestFolder(&f->folder), 0);
    f->folder = MakeTestFolder();
}

static void every_failing_allocation_is_reported(void** state)
{
    Fixture* f = *state;
    pvtImage image = MakeRamps(f->context, 8, 8);
    const char* path = InFolder(&f->folder, "x.png");
    CHECK_OK(f->context, pvtSaveImage(f->context, path, &image));
    pvtImage_Free(f->context, &image);
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int failAt = 1; status != PVT_OK; ++failAt) {
        PoorHeap heap = {.failAt = failAt};
        pvtContext* context = CreatePoorContext(&heap);
        pvtImage back;
        status = pvtLoadImage(context, path, &back);
        assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
        assert_int_equal(back.pixels != NULL, status == PVT_OK);
        pvtImage_Free(context, &back);
        DestroyTestContext(context);
    }
}

static void a_module_is_taken_from_trusted_folders_only(void** state)
{
    Fixture* f = *state;
    char reason[256] = "";
    void* handle = NULL;
    assert_int_equal(pvtOpenModule("no_such_module.so", &handle, reason, sizeof reason),
                     PVT_MODULE_MISSING);
    assert_null(handle);
    // A file that is there, but no shared object, says why it cannot be used.
    char path[256];
    (void)snprintf(path, sizeof path, ":%s:/nonexistent", f->folder.path);
    assert_int_equal(setenv("PARAVENT_MODULE_PATH", path, 1), 0);
    WriteText(InFolder(&f->folder, "no_such_module.so"), "not a shared object");
    assert_int_equal(pvtOpenModule("no_such_module.so", &handle, reason, sizeof reason),
                     PVT_MODULE_BROKEN);
    assert_non_null(strstr(reason, "no_such_module.so"));
    // One that anybody may change is passed over.
    assert_int_equal(chmod(InFolder(&f->folder, "no_such_module.so"), 0777), 0);
    assert_int_equal(pvtOpenModule("no_such_module.so", &handle, reason, sizeof reason),
                     PVT_MODULE_MISSING);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_png_comes_back_to_the_last_bit),
        TEST(the_same_picture_is_the_same_bytes),
        TEST(other_formats_are_read_as_four_channels),
        TEST(what_is_no_image_is_refused_by_name),
        TEST(an_image_that_cannot_be_written_leaves_nothing),
        TEST(every_failing_allocation_is_reported),
        cmocka_unit_test_setup_teardown(a_module_is_taken_from_trusted_folders_only, SetUp,
                                        TearDownModules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
