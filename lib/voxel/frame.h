// SPDX-License-Identifier: MIT
// Where the grid of a mesh stands.
#ifndef PVT_VOXEL_FRAME_H
#define PVT_VOXEL_FRAME_H

#include <paravent/voxel.h>

/// Checks the options, the mesh's extent and the memory that the grid will take.
pvtStatus pvtMakeGridFrame(pvtContext* context, const pvtVoxelizeOptions* options,
                           const pvtMesh* mesh, pvtGridFrame* frame);

#endif
