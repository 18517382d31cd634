// SPDX-License-Identifier: MIT
// What the module paravent_image offers: OpenImageIO behind plain C. It knows nothing of the
// library that opens it, so that either can be linked in any way.
#ifndef PVT_IO_IMAGE_MODULE_H
#define PVT_IO_IMAGE_MODULE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Raised with every change of pvtImageModule.
enum { PVT_IMAGE_MODULE_VERSION = 2, PVT_IMAGE_TEXT_SIZE = 512 };

/// Why a call failed.
typedef struct pvtImageText {
    char text[PVT_IMAGE_TEXT_SIZE];
} pvtImageText;

/// What is known of an image before its pixels are read.
typedef struct pvtImageShape {
    int width, height;
    bool hasAlpha;
} pvtImageShape;

typedef struct pvtImageModule {
    uint32_t version;

    /// Four bytes a pixel, red, green, blue (sRGB), alpha, the top row first, to the bytes of a
    /// PNG, which are freed by `release`. Null on failure.
    uint8_t* (*encodePng)(const uint8_t* pixels, int width, int height, size_t* size,
                          pvtImageText* error);
    void (*release)(uint8_t* bytes);

    /// Opens an image whose file was read into memory; `path` is for formats that OpenImageIO can
    /// only read from a file, and for the ending. Null on failure.
    void* (*open)(const char* path, const uint8_t* bytes, size_t size, int* width, int* height,
                  pvtImageText* error);
    /// Fills 4 × width × height bytes, in the layout of encodePng.
    bool (*read)(void* image, uint8_t* pixels, pvtImageText* error);
    void (*close)(void* image);

    /// Opens an image of `format`, such as "png", out of memory and nowhere else. Null on failure.
    /// To be closed by `close`.
    void* (*openMemory)(const char* format, const uint8_t* bytes, size_t size, pvtImageShape* shape,
                        pvtImageText* error);
    /// The alpha of `rowCount` rows, one byte a pixel, rounded down; rows are asked for from the
    /// top on. Only of an image that has alpha.
    bool (*readAlpha)(void* image, int firstRow, int rowCount, uint8_t* alpha, pvtImageText* error);
} pvtImageModule;

/// The one symbol of the module.
typedef const pvtImageModule* pvtGetImageModuleFcn(void);

#ifdef __cplusplus
}
#endif
#endif
