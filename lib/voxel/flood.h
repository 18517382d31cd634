// SPDX-License-Identifier: MIT
// Filling what can be reached from outside.
#ifndef PVT_VOXEL_FLOOD_H
#define PVT_VOXEL_FLOOD_H

#include <paravent/voxel.h>

/// Sets in `reached`, which comes empty and has the frame of `blocked`, every voxel that a walk
/// over faces reaches from the grid's border without entering a blocked one.
pvtStatus pvtFloodFromBorder(pvtContext* context, const pvtBitGrid* blocked, pvtBitGrid* reached);

#endif
