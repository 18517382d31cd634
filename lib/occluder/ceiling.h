// SPDX-License-Identifier: MIT
// The measure of a whole grid: what an occluder within it can reach at most.
#ifndef PVT_OCCLUDER_CEILING_H
#define PVT_OCCLUDER_CEILING_H

#include <paravent/occlusion.h>
#include <paravent/voxel.h>

typedef struct pvtMeasureGridOptions {
    const pvtViewSet* views;
    const pvtBox3* bounds; ///< [wu] what the masks span
    int size;              ///< [px] of the masks
} pvtMeasureGridOptions;

/// As pvtMeasureOcclusion, for the set voxels, and the cells of finer ones (may be null), instead
/// of a mesh.
pvtStatus pvtMeasureGrid(pvtContext* context, const pvtMeasureGridOptions* options,
                         const pvtBitGrid* grid, const pvtCellGrid* cells, double* measure);

#endif
