// SPDX-License-Identifier: MIT
// Silhouettes of meshes in orthographic views: one bit a pixel, no depth.
#ifndef PVT_EVALUATE_RASTER_H
#define PVT_EVALUATE_RASTER_H

#include "soup.h"

/// Where a view looks, and the rectangle of its picture plane that pixels cover. Pixel (i, j) is
/// the square from lower + (i, j) × pixelSize to lower + (i + 1, j + 1) × pixelSize along `right`
/// and `up`; row 0 is the lowest.
typedef struct pvtScreen {
    pvtVec3 direction, right, up; ///< unit; right × up = −direction
    double lower[2];              ///< [wu] along right and up
    double pixelSize;             ///< [wu]
    int width, height;            ///< [px]
} pvtScreen;

/// A corner on the screen in 1/256 of a pixel, rounded to the nearest.
typedef struct pvtScreenPoint {
    int32_t x, y;
} pvtScreenPoint;

/// A bit a pixel; bits past `width` are 0. `capacity` words are there to be used again.
typedef struct pvtRaster {
    uint64_t* words;
    int width, height;
    size_t wordsPerRow, capacity;
} pvtRaster;

/// A rectangle on the picture plane [wu]; empty when lower[0] > upper[0].
typedef struct pvtScreenBox {
    double lower[2], upper[2];
} pvtScreenBox;

/// The quotient, of which the divisor is positive, rounded down.
static inline int64_t pvtDivideDown(int64_t numerator, int64_t denominator)
{
    return numerator / denominator - (numerator % denominator < 0);
}

/// PVT_INVALID_ARGUMENT, with the direction's number, unless its length is finite and above 0.
pvtStatus pvtCheckDirection(pvtContext* context, size_t number, pvtVec3 direction);

/// The view along `direction` (any length > 0) without roll: `up` is as near to +y as it can be,
/// or to +z where the view looks along y within 1 part in 1000. Nothing else is filled.
pvtScreen pvtMakeScreen(pvtVec3 direction);

/// The box around a soup seen in a view. False when it was cancelled.
bool pvtProjectBounds(pvtContext* context, const pvtScreen* screen, const pvtSoup* soup,
                      pvtScreenBox* box);

/// Clears the raster and gives it this size.
pvtStatus pvtRaster_Resize(pvtContext* context, pvtRaster* raster, int width, int height);
void pvtRaster_Free(pvtContext* context, pvtRaster* raster);

/// Covers one triangle, of either winding.
void pvtRaster_FillTriangle(pvtRaster* raster, pvtScreenPoint a, pvtScreenPoint b,
                            pvtScreenPoint c);

/// Covers all triangles. `points` has room for soup->positionCount; raster and screen have one
/// size. False when it was cancelled.
bool pvtRasterizeSoup(pvtContext* context, const pvtScreen* screen, const pvtSoup* soup,
                      pvtScreenPoint* points, pvtRaster* raster);

#endif
