// SPDX-License-Identifier: MIT
// Images through the module paravent_image: linking OpenImageIO itself would load 261 libraries at
// the start of every process.
#include "alpha.h"
#include "companion.h"
#include "image_module.h"
#include "png_strip.h"
#include "source.h"
#include "text.h"

#include "base/context.h"

#include <dlfcn.h>
#include <math.h>
#include <paravent/io.h>
#include <paravent/output.h>
#include <stdio.h>
#include <string.h>

enum { REASON_SIZE = 512 };

static const char kModuleFile[] = "paravent_image.so";

// Rows between two questions whether to stop; the widest ones take some 10 ms.
enum { ALPHA_ROWS = 16 };
static pvtStatus FailMissing(pvtContext* context, const char* path, pvtModuleState state,
                             const char* reason)
{
    if (state == PVT_MODULE_BROKEN) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "%s: images need OpenImageIO, which cannot be opened (%s); install "
                       "libopenimageio2.4",
                       path, reason);
    }
    return pvtFail(context, PVT_UNSUPPORTED,
                   "%s: images need the module %s, which is not installed; build paravent with "
                   "libopenimageio-dev, or name the module's folder in PARAVENT_MODULE_PATH",
                   path, kModuleFile);
}

static pvtStatus OpenImageModule(pvtContext* context, const char* path,
                                 const pvtImageModule** module)
{
    void* handle = NULL;
    char reason[REASON_SIZE];
    const pvtModuleState state = pvtOpenModule(kModuleFile, &handle, reason, sizeof reason);
    if (state != PVT_MODULE_OPEN) {
        return FailMissing(context, path, state, reason);
    }
    // A data pointer as a function pointer, in the one way that C allows.
    pvtGetImageModuleFcn* get = NULL;
    void* symbol = dlsym(handle, "pvtGetImageModule");
    memcpy(&get, &symbol, sizeof get);
    *module = get != NULL ? get() : NULL;
    if (*module == NULL || (*module)->version != PVT_IMAGE_MODULE_VERSION) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "%s: the module %s that was found belongs to another version of paravent",
                       path, kModuleFile);
    }
    return PVT_OK;
}

// Something like "-" or a device has no ending, and is fine.
static bool HasOtherEnding(const char* path)
{
    const char* slash = strrchr(path, '/');
    const char* name = slash != NULL ? slash + 1 : path;
    return strchr(name, '.') != NULL && !pvtHasEnding(name, ".png");
}

pvtStatus pvtSaveImage(pvtContext* context, const char* path, const pvtImage* image)
{
    if (image->pixels == NULL || image->width < 1 || image->height < 1) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%s: the image has no pixel to save", path);
    }
    if (HasOtherEnding(path)) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "%s: images are written as PNG; give a name that ends in .png", path);
    }
    const pvtImageModule* module = NULL;
    pvtStatus status = OpenImageModule(context, path, &module);
    if (status != PVT_OK) {
        return status;
    }
    pvtImageText error = {{0}};
    size_t size = 0;
    uint8_t* png = module->encodePng(image->pixels, image->width, image->height, &size, &error);
    if (png == NULL) {
        return pvtFail(context, PVT_OUTPUT_FAILED, "%s cannot be written: %s", path, error.text);
    }
    pvtOutput* output = NULL;
    status = pvtOpenOutput(context, path, &output);
    if (status == PVT_OK) {
        pvtOutput_Write(output, png, size);
        status = pvtCommitOutput(output);
    }
    module->release(png);
    return status;
}

static pvtStatus Decode(pvtContext* context, const pvtImageModule* module, const char* path,
                        const pvtSource* source, pvtImage* image)
{
    pvtImageText error = {{0}};
    int width = 0, height = 0;
    char text[PVT_IMAGE_TEXT_SIZE];
    void* opened = module->open(path, source->bytes, source->size, &width, &height, &error);
    if (opened == NULL) {
        return pvtFail(context, PVT_INVALID_INPUT, "%s: the image cannot be read: %s", path,
                       pvtCleanText(error.text, text, sizeof text));
    }
    pvtStatus status = pvtCreateImage(context, width, height, image);
    if (status == PVT_INVALID_ARGUMENT) {
        status = pvtFail(context, PVT_INVALID_INPUT,
                         "%s: the image has %d × %d pixels; at most 32768 a side are read", path,
                         width, height);
    }
    if (status == PVT_OK && !module->read(opened, image->pixels, &error)) {
        pvtImage_Free(context, image);
        status = pvtFail(context, PVT_INVALID_INPUT, "%s: the image cannot be read: %s", path,
                         pvtCleanText(error.text, text, sizeof text));
    }
    module->close(opened);
    return status;
}

pvtStatus pvtLoadImage(pvtContext* context, const char* path, pvtImage* image)
{
    *image = (pvtImage){0};
    pvtSource source;
    pvtStatus status = pvtReadSource(context, path, pvtDefaultLoadOptions().maxBytes, &source);
    if (status != PVT_OK) {
        return status;
    }
    const pvtImageModule* module = NULL;
    status = OpenImageModule(context, path, &module);
    if (status == PVT_OK && source.size == 0) {
        status = pvtFail(context, PVT_INVALID_INPUT, "%s: the file is empty", path);
    }
    if (status == PVT_OK) {
        status = Decode(context, module, path, &source, image);
    }
    pvtSource_Free(context, &source);
    return status;
}

// By the first bytes, since names and media types are often wrong. Null for another format.
static const char* FindFormat(const uint8_t* bytes, size_t size)
{
    static const struct {
        const char* name;
        const char* magic;
        size_t length, offset;
    } formats[] = {
        {"png", "\x89PNG\r\n\x1a\n", 8, 0}, {"jpeg", "\xff\xd8\xff", 3, 0}, {"webp", "WEBP", 4, 8}};
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; ++i) {
        const size_t end = formats[i].offset + formats[i].length;
        if (size >= end &&
            memcmp(bytes + formats[i].offset, formats[i].magic, formats[i].length) == 0) {
            return formats[i].name;
        }
    }
    return NULL;
}

static pvtStatus ReadAlphaRows(pvtContext* context, const pvtImageModule* module, void* opened,
                               const char* label, pvtAlpha* alpha)
{
    pvtImageText error = {{0}};
    char text[PVT_IMAGE_TEXT_SIZE];
    for (int row = 0; row < alpha->height; row += ALPHA_ROWS) {
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        const int left = alpha->height - row;
        uint8_t* values = alpha->values + (size_t)row * (size_t)alpha->width;
        if (!module->readAlpha(opened, row, left < ALPHA_ROWS ? left : ALPHA_ROWS, values,
                               &error)) {
            return pvtFail(context, PVT_INVALID_INPUT, "%s cannot be read: %s", label,
                           pvtCleanText(error.text, text, sizeof text));
        }
    }
    return PVT_OK;
}

// What a PNG can hold at most: deflate makes up to 1032 bytes of one, and a byte is at most 8
// pixels of an image with a palette.
static double GetMostPixels(size_t size)
{
    return 8.0 * 1032.0 * (double)size;
}

// What claims more than it can hold gets no memory.
static pvtStatus CheckShape(pvtContext* context, const char* format, const char* label,
                            const pvtImageShape* shape, size_t size)
{
    if (shape->width > PVT_MAX_ALPHA_SIDE || shape->height > PVT_MAX_ALPHA_SIDE) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "%s has %d × %d pixels; at most %d a side are read", label, shape->width,
                       shape->height, PVT_MAX_ALPHA_SIDE);
    }
    if (strcmp(format, "png") == 0 && (double)shape->width * shape->height > GetMostPixels(size)) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "%s claims %d × %d pixels, which its %zu bytes cannot hold", label,
                       shape->width, shape->height, size);
    }
    return PVT_OK;
}

static pvtStatus ReadAlpha(pvtContext* context, const pvtImageModule* module, void* opened,
                           const char* label, pvtAlpha* alpha)
{
    const size_t count = (size_t)alpha->width * (size_t)alpha->height;
    char purpose[PVT_IMAGE_TEXT_SIZE];
    (void)snprintf(purpose, sizeof purpose, "%s: the alpha of %d × %d pixels", label, alpha->width,
                   alpha->height);
    pvtStatus status = pvtCheckMemory(context, count, purpose);
    if (status != PVT_OK) {
        return status;
    }
    alpha->values = pvtAllocate(context, count, 1);
    status = alpha->values != NULL ? ReadAlphaRows(context, module, opened, label, alpha)
                                   : pvtContext_GetStatus(context);
    if (status != PVT_OK) {
        pvtAlpha_Free(context, alpha);
    }
    return status;
}

static double GetBytes(const uint8_t* bytes, int count, bool isBig)
{
    double value = 0.0;
    for (int i = 0; i < count; ++i) {
        value = 256.0 * value + bytes[isBig ? i : count - 1 - i];
    }
    return value;
}

// [bytes] What the decoder will hold beside its result, by the image's header: WebP is decoded as
// a whole when it is opened, and so is an interlaced PNG with its first row.
static double EstimateDecoder(const char* format, const uint8_t* bytes, size_t size)
{
    enum { HEADER = 30, INTERLACE = 28 };
    if (size < HEADER) {
        return 0.0;
    }
    if (strcmp(format, "png") == 0) {
        const double pixels = GetBytes(bytes + 16, 4, true) * GetBytes(bytes + 20, 4, true);
        return bytes[INTERLACE] != 0 ? 8.0 * fmin(pixels, GetMostPixels(size)) : 0.0;
    }
    const double side = 16384.0;
    double width = side, height = side;
    if (memcmp(bytes + 12, "VP8X", 4) == 0) {
        width = GetBytes(bytes + 24, 3, false) + 1.0;
        height = GetBytes(bytes + 27, 3, false) + 1.0;
    } else if (memcmp(bytes + 12, "VP8L", 4) == 0) {
        const double bits = GetBytes(bytes + 21, 4, false);
        width = fmod(bits, side) + 1.0;
        height = fmod(floor(bits / side), side) + 1.0;
    } else if (memcmp(bytes + 12, "VP8 ", 4) == 0) {
        width = fmod(GetBytes(bytes + 26, 2, false), side);
        height = fmod(GetBytes(bytes + 28, 2, false), side);
    }
    return 8.0 * width * height;
}

static pvtStatus CheckDecoder(pvtContext* context, const char* format, const char* label,
                              const uint8_t* bytes, size_t size)
{
    const double needed = EstimateDecoder(format, bytes, size);
    char purpose[PVT_IMAGE_TEXT_SIZE];
    (void)snprintf(purpose, sizeof purpose, "%s: decoding the image", label);
    return pvtCheckMemory(context, needed < (double)SIZE_MAX ? (size_t)needed : SIZE_MAX, purpose);
}

static pvtStatus DecodeAlpha(pvtContext* context, const char* format, const char* label,
                             const uint8_t* bytes, size_t size, pvtAlpha* alpha)
{
    const pvtImageModule* module = NULL;
    pvtStatus status = CheckDecoder(context, format, label, bytes, size);
    if (status == PVT_OK) {
        status = OpenImageModule(context, label, &module);
    }
    if (status != PVT_OK) {
        return status;
    }
    pvtImageText error = {{0}};
    pvtImageShape shape = {0};
    char text[PVT_IMAGE_TEXT_SIZE];
    void* opened = module->openMemory(format, bytes, size, &shape, &error);
    if (opened == NULL) {
        return pvtFail(context, PVT_INVALID_INPUT, "%s cannot be read: %s", label,
                       pvtCleanText(error.text, text, sizeof text));
    }
    status = CheckShape(context, format, label, &shape, size);
    if (status == PVT_OK && shape.hasAlpha) {
        alpha->width = shape.width;
        alpha->height = shape.height;
        status = ReadAlpha(context, module, opened, label, alpha);
    }
    module->close(opened);
    return status;
}

pvtStatus pvtDecodeAlpha(pvtContext* context, const char* label, const uint8_t* bytes, size_t size,
                         pvtAlpha* alpha)
{
    *alpha = (pvtAlpha){0};
    const char* format = FindFormat(bytes, size);
    if (format == NULL) {
        return pvtFail(context, PVT_UNSUPPORTED, "%s is neither PNG, JPEG nor WebP", label);
    }
    // JPEG has no alpha: there is no need to look into it.
    if (strcmp(format, "jpeg") == 0) {
        return PVT_OK;
    }
    if (strcmp(format, "png") != 0) {
        return DecodeAlpha(context, format, label, bytes, size, alpha);
    }
    pvtSource png;
    pvtStatus status = pvtStripPng(context, label, bytes, size, &png);
    if (status == PVT_OK) {
        status = DecodeAlpha(context, format, label, png.bytes, png.size, alpha);
        pvtSource_Free(context, &png);
    }
    return status;
}

void pvtAlpha_Free(pvtContext* context, pvtAlpha* alpha)
{
    pvtRelease(context, alpha->values);
    *alpha = (pvtAlpha){0};
}
