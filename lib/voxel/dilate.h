// SPDX-License-Identifier: MIT
// Growing a set of voxels by a ball.
#ifndef PVT_VOXEL_DILATE_H
#define PVT_VOXEL_DILATE_H

#include <paravent/voxel.h>

/// The largest squared distance [vx²] that is within `distance` [wu]. A length that was meant as a
/// whole number of voxels counts as that, rounding aside.
uint32_t pvtGetSquaredReach(const pvtGridFrame* frame, double distance);

/// Every voxel of the grid whose centre is within √squaredRadius [vx] of the centre of a set one.
pvtStatus pvtDilateGrid(pvtContext* context, const pvtBitGrid* grid, uint32_t squaredRadius,
                        pvtBitGrid* dilated);

/// The same for large radii: the time does not depend on them, but a count is kept for each voxel.
pvtStatus pvtDilateByDistance(pvtContext* context, const pvtBitGrid* grid, uint32_t squaredRadius,
                              pvtBitGrid* dilated);
double pvtGetDistanceDilationBytes(const pvtContext* context, const pvtBitGrid* grid);

#endif
