// SPDX-License-Identifier: MIT
// Whether a polygon stays simple and within the cells of a slice; exact.
#ifndef PVT_OCCLUDER_FIT_H
#define PVT_OCCLUDER_FIT_H

#include <paravent/section.h>

/// True when every cell whose interior the closed polygon meets is set. The polygon is simple, in
/// either winding, of at most PVT_MAX_FIT_POINTS points.
enum { PVT_MAX_FIT_POINTS = 64 };
bool pvtIsPolygonWithin(const pvtBitmap* cells, int cellsPerVoxel, const pvtPoint2* points,
                        size_t count);

/// True when the polygon is counter-clockwise, has an area, and no two edges meet but neighbours in
/// their common point.
bool pvtIsPolygonSimple(const pvtPoint2* points, size_t count);

/// True when the two edges at point `index` meet no other edge, given that all others are fine.
bool pvtIsPointSimple(const pvtPoint2* points, size_t count, size_t index);

/// Whether the edges at this point cross no others of a polygon with bridges: these may touch
/// themselves, and others may end where they do.
bool pvtIsPointFree(const pvtPoint2* points, size_t count, size_t index);

#endif
