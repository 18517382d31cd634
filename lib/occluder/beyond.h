// SPDX-License-Identifier: MIT
// What of a sight no triangle should cover, where the inside reaches far beyond the goal: below a
// landscape's edge, as it is seen from the side.
#ifndef PVT_OCCLUDER_BEYOND_H
#define PVT_OCCLUDER_BEYOND_H

#include "sight_mask.h"

/// Pixels of cells that the goal has no pixel of, nor beside: a node that is splatted may reach a
/// pixel too far.
void pvtFindBeyond(const pvtSightMask* goal, pvtSightMask* beyond);

/// What is covered there costs, as a share of what all rectangles of a sight are worth.
double pvtGetCostBeyond(const pvtSightMask* goal, const pvtSightMask* beyond,
                        const pvtSightMask* covered);

/// Makes each cell there, of values[y + 1][x + 1] for cell (x, y), worth less than nothing: by a
/// part of what the goal's are worth on average.
void pvtPunishBeyond(const pvtSightMask* beyond, float (*values)[PVT_SIGHT_STRIDE]);

#endif
