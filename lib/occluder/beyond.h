// SPDX-License-Identifier: MIT
// What of a sight no triangle should cover, where the inside reaches farther than the goal.
#ifndef PVT_OCCLUDER_BEYOND_H
#define PVT_OCCLUDER_BEYOND_H

#include "sight_mask.h"

/// What it costs to cover pixels there.
typedef struct pvtBeyondRule {
    bool counts;   ///< else nothing
    bool isClose;  ///< beside the goal as well: else a pixel of what a sight shows is free
    float penalty; ///< of a pixel, as a part of what the goal's are worth on average
} pvtBeyondRule;

/// Pixels of cells that the goal has no pixel of, nor beside, unless it `isClose`: a node that is
/// splatted may reach a pixel too far.
void pvtFindBeyond(const pvtSightMask* goal, bool isClose, pvtSightMask* beyond);

/// What is covered there costs, as a share of what all rectangles of a sight are worth.
double pvtGetCostBeyond(const pvtSightMask* goal, const pvtSightMask* beyond,
                        const pvtSightMask* covered);

/// Makes each cell there, of values[y + 1][x + 1] for cell (x, y), worth less than nothing: by this
/// part of what the goal's are worth on average.
void pvtPunishBeyond(const pvtSightMask* beyond, float penalty, float (*values)[PVT_SIGHT_STRIDE]);

#endif
