// SPDX-License-Identifier: MIT
// Projections of polygons as square bit masks.
#ifndef PVT_OCCLUSION_MASK_H
#define PVT_OCCLUSION_MASK_H

#include <paravent/occlusion.h>

enum { PVT_MASK_POINT_BITS = 8 };

/// A position on a mask: pixel (i, j) spans i to i + 1 and j to j + 1, in 1/256 pixel.
typedef struct pvtMaskPoint {
    int32_t x, y;
} pvtMaskPoint;

/// An orthographic projection onto a mask: x = dot(p, right) + offsetX in pixels, y alike.
typedef struct pvtMaskFrame {
    pvtVec3 right, up;       ///< the view's, over the pixel size
    double offsetX, offsetY; ///< [px]
    double pixelSize;        ///< [wu]
    double weight;           ///< the view's
} pvtMaskFrame;

/// The frame in which the projected bounds fill the mask up to half a pixel on each side.
pvtMaskFrame pvtMakeMaskFrame(const pvtView* view, const pvtBox3* bounds, int size);

/// Rounded to the nearest 1/256 pixel.
pvtMaskPoint pvtProjectToMask(const pvtMaskFrame* frame, pvtVec3 point);

/// Turns over the pixels whose centres a closed polygon encloses an odd number of times. Winding
/// does not matter; what lies off the mask is clipped.
void pvtToggleMaskPolygon(uint64_t* rows, int size, const pvtMaskPoint* points, size_t count);

/// Turns over, in each row that the edge crosses, all pixels to the right of the edge: one edge's
/// part of pvtToggleMaskPolygon.
void pvtToggleMaskEdge(uint64_t* rows, int size, pvtMaskPoint from, pvtMaskPoint to);

#endif
