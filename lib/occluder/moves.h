// SPDX-License-Identifier: MIT
// Random changes to an arrangement, each of which keeps every panel simple, within its plane's
// allowed cells, and the triangles within the budget.
#ifndef PVT_OCCLUDER_MOVES_H
#define PVT_OCCLUDER_MOVES_H

#include "arrangement.h"
#include "base/random.h"

typedef struct pvtMoveOptions {
    int budget;
    double reach;     ///< [vx] farthest that a point moves
    double structure; ///< part of the moves that exchange or tilt panels, 0 to 1
    const pvtCandidateSet* candidates;
    const double* candidateSums; ///< running sums of the candidates' areas
} pvtMoveOptions;

/// Bitmaps that a maker of moves may draw slices into.
typedef struct pvtMoveScratch {
    pvtBitmap cells;
} pvtMoveScratch;

/// False when the dice gave nothing that fits. PVT_OUT_OF_MEMORY and the like are told in *status.
bool pvtMakeMove(pvtContext* context, const pvtArrangement* arrangement,
                 const pvtMoveOptions* options, pvtMoveScratch* scratch, pvtRandom* random,
                 pvtChange* change, pvtStatus* status);

#endif
