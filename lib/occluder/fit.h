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

/// The same for a polygon with bridges: edges may end in the same point, and the two that a bridge
/// is may lie on each other.
bool pvtIsPointFree(const pvtPoint2* points, size_t count, size_t index);

/// How often the polygon runs around the middle of the triangle.
int pvtGetWinding(const pvtPoint2* points, size_t count, const pvtPoint2 triangle[3]);

#endif
