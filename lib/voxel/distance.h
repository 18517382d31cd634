// SPDX-License-Identifier: MIT
// Distances within one slab, the part that all exact transforms of a grid share.
#ifndef PVT_VOXEL_DISTANCE_H
#define PVT_VOXEL_DISTANCE_H

#include "envelope.h"

#include <paravent/voxel.h>

/// Squared distances [vx²] to the nearest set voxel of the slab z, one value a voxel with rising y
/// and x; PVT_FAR above `limit` ≤ 2³⁰. False when the slab holds no set voxel: then nothing is
/// written.
bool pvtTransformSlab(const pvtBitGrid* grid, int z, uint32_t limit, pvtEnvelope* envelope,
                      uint32_t* slab);

#endif
