// SPDX-License-Identifier: MIT
// The steps that make a solid of a surface.
#ifndef PVT_VOXEL_OUTSIDE_H
#define PVT_VOXEL_OUTSIDE_H

#include <paravent/voxel.h>

/// What a flood from outside does not reach, by smallestHole and ground of the options. The
/// surface needs no padding. `inside` is made here.
pvtStatus pvtFloodOutside(pvtContext* context, const pvtSolidOptions* options,
                          const pvtBitGrid* surface, pvtBitGrid* inside);

/// Adds all below the lowest surface voxel of each column, down to the surface's lowest layer and
/// `below` farther, in the grid.
void pvtFillBelowTerrain(const pvtSolidOptions* options, const pvtBitGrid* surface,
                         pvtBitGrid* inside);

/// The columns along an axis that hold surface voxels, how many runs of such all columns hold, and
/// the columns with more than `most` of them.
typedef struct pvtColumnStats {
    uint64_t touched, runs, tall;
} pvtColumnStats;

pvtColumnStats pvtCountColumns(const pvtBitGrid* surface, pvtAxis up, int most);

/// Adds the outside voxels from which at most `most` of the 26 directions escape.
pvtStatus pvtFillEnclosed(pvtContext* context, int most, pvtBitGrid* inside);

/// All of the above, as the options ask for them.
pvtStatus pvtFindInside(pvtContext* context, const pvtSolidOptions* options,
                        const pvtBitGrid* surface, pvtBitGrid* inside);

/// What would fill a hollow solid, of which `strictCount` voxels are strictly inside now.
pvtStatus pvtFindRemedy(pvtContext* context, const pvtSolidOptions* options,
                        const pvtBitGrid* surface, uint64_t strictCount, pvtRemedy* remedy);

/// pvtFillSolid without its warning, and that.
pvtStatus pvtFillSolidInSilence(pvtContext* context, const pvtSolidOptions* options,
                                const pvtBitGrid* surface, pvtSolid* solid);
void pvtWarnWhenHollow(pvtContext* context, const pvtSolid* solid);

#endif
