// SPDX-License-Identifier: MIT
// Images through the module paravent_image: linking OpenImageIO itself would load 261 libraries at
// the start of every process.
#include "companion.h"
#include "image_module.h"
#include "source.h"
#include "text.h"

#include "base/context.h"

#include <dlfcn.h>
#include <paravent/io.h>
#include <paravent/output.h>
#include <string.h>

enum { REASON_SIZE = 512 };

static const char kModuleFile[] = "paravent_image.so";

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
