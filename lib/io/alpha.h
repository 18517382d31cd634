// SPDX-License-Identifier: MIT
// The alpha of an image, and which parts of a texture it leaves opaque for sure.
#ifndef PVT_IO_ALPHA_H
#define PVT_IO_ALPHA_H

#include <paravent/base.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PVT_MAX_ALPHA_SIDE = 32768 };

/// One byte a pixel, the top row first. Null values: the image has no alpha, and is opaque.
typedef struct pvtAlpha {
    uint8_t* values; ///< width × height
    int width, height;
} pvtAlpha;

/// PNG, JPEG and WebP out of memory, by OpenImageIO. `label` is the image's name for messages.
/// PVT_UNSUPPORTED: another format, or no OpenImageIO; PVT_INVALID_INPUT: it is damaged, or claims
/// to be larger than its bytes can make it; PVT_LIMIT: it does not fit in memory.
pvtStatus pvtDecodeAlpha(pvtContext* context, const char* label, const uint8_t* bytes, size_t size,
                         pvtAlpha* alpha);
void pvtAlpha_Free(pvtContext* context, pvtAlpha* alpha);

/// What lies beyond an image's edge.
typedef enum pvtWrap { PVT_WRAP_REPEAT, PVT_WRAP_MIRROR, PVT_WRAP_CLAMP } pvtWrap;

/// Cells of a texture along one axis, at the finest level. Cell 0 begins at texel coordinate
/// `origin`, or at minus infinity when clamped; each is one texel wide.
typedef struct pvtAlphaAxis {
    bool isPeriodic; ///< the cells begin anew behind the last; else the last one goes on for ever
    size_t count;
    double origin; ///< where the first border between cells 0 and −1 (periodic), or 1 and 0, lies
} pvtAlphaAxis;

enum { PVT_MAX_ALPHA_LEVELS = 18 };

/// The least alpha in each cell of a texture, at several levels: 2^level texels a side.
///
/// A cell of the finest level is where bilinear filtering mixes the same four texels, from the
/// centre of one to the centre of the next. Its value is the least of the four, which no point in
/// it falls below, whether the sampler filters or takes the nearest texel.
typedef struct pvtAlphaMap {
    pvtAlphaAxis axes[2]; ///< u, v
    int levelCount;       ///< the last level has one cell
    uint8_t* levels[PVT_MAX_ALPHA_LEVELS];
    size_t columns[PVT_MAX_ALPHA_LEVELS], rows[PVT_MAX_ALPHA_LEVELS];
    uint8_t least, most; ///< of all cells of the finest level
} pvtAlphaMap;

pvtStatus pvtBuildAlphaMap(pvtContext* context, const pvtAlpha* alpha, const pvtWrap wraps[2],
                           pvtAlphaMap* map);
void pvtAlphaMap_Free(pvtContext* context, pvtAlphaMap* map);

/// The cell in which a texel coordinate of less than 2^40 lies, counted on over all repetitions.
int64_t pvtAlphaMap_FindCell(const pvtAlphaMap* map, int axis, int level, double texel);
/// Where that cell begins; minus infinity for the first of a clamped axis, infinity behind its
/// last.
double pvtAlphaMap_GetBorder(const pvtAlphaMap* map, int axis, int level, int64_t cell);
/// Its place among the level's columns or rows.
size_t pvtAlphaMap_GetPlace(const pvtAlphaMap* map, int axis, int level, int64_t cell);

#ifdef __cplusplus
}
#endif
#endif
