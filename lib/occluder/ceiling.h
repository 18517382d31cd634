// SPDX-License-Identifier: MIT
// The measure of a whole grid: what an occluder within it can reach at most.
#ifndef PVT_OCCLUDER_CEILING_H
#define PVT_OCCLUDER_CEILING_H

#include <paravent/occlusion.h>
#include <paravent/voxel.h>

/// As pvtMeasureOcclusion, for the set voxels instead of a mesh.
pvtStatus pvtMeasureGrid(pvtContext* context, const pvtViewSet* views, const pvtBox3* bounds,
                         int size, const pvtBitGrid* grid, double* measure);

#endif
