// SPDX-License-Identifier: MIT
// Where a triangle passes through another one.
#ifndef PVT_OCCLUDER_CROSSING_H
#define PVT_OCCLUDER_CROSSING_H

#include <paravent/voxel.h>

/// Whether two triangles pass through each other along a line; `ends` are its ends. Triangles that
/// only touch, or lie in one plane, do not.
bool pvtFindCrossing(const pvtVec3 a[3], const pvtVec3 b[3], pvtVec3 ends[2]);

/// Whether a line in grid coordinates passes a border cell; `place` is a point of it that does.
bool pvtPassesBorder(const pvtCellGrid* cells, const pvtVec3 ends[2], pvtVec3* place);

#endif
