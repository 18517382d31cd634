// SPDX-License-Identifier: MIT
// Which cells of a plane the surface near it covers.
#ifndef PVT_OCCLUDER_SHEET_COVER_H
#define PVT_OCCLUDER_SHEET_COVER_H

#include "sheet_soup.h"

/// Clears `cells`, which spans the whole plane, and sets those that are wholly covered, seen along
/// the plane's axis, by parts of triangles that lie within `distance` [vx] of the plane; gaps that
/// are nowhere wider than 1/256 voxel count as covered.
pvtStatus pvtCoverPlane(pvtContext* context, const pvtSheetSoup* soup, const pvtPlane* plane,
                        double distance, int cellsPerVoxel, pvtBitmap* cells);

/// What is within `distance` of a plane, as it is seen along its axis.
typedef struct pvtPlaneShapes {
    struct pvtClipped* shapes;
    struct pvtShapeBox* boxes; ///< around each
    size_t count;
} pvtPlaneShapes;

pvtStatus pvtCollectPlaneShapes(pvtContext* context, const pvtSheetSoup* soup,
                                const pvtPlane* plane, double distance, pvtPlaneShapes* shapes);
void pvtPlaneShapes_Free(pvtContext* context, pvtPlaneShapes* shapes);

/// Whether the shapes cover a triangle of the plane, but for cracks: 1/64 of its area, and as much
/// as is left of what may stay open [vx²], from which they are taken.
bool pvtPlaneShapes_Cover(const pvtPlaneShapes* shapes, const pvtPoint2 triangle[3], double* open);

#endif
