// SPDX-License-Identifier: MIT
// One view: the original drawn once, and every occluder judged against it.
#ifndef PVT_EVALUATE_VIEW_H
#define PVT_EVALUATE_VIEW_H

#include "excess.h"
#include "quads.h"

/// What is judged, and how.
typedef struct pvtViewJob {
    const pvtEvaluateOptions* options;
    const pvtSoup* original;
    const pvtSoup* occluders;
    size_t count;
} pvtViewJob;

/// What a worker keeps from view to view.
typedef struct pvtViewScratch {
    pvtScreenPoint* points; ///< room for the soup with the most positions
    pvtRaster original, occluder, coarse;
    pvtCoverTable originalTable, occluderTable;
    pvtExcessScratch excess;
} pvtViewScratch;

/// An occluder in a view, with what the sums over all views need.
typedef struct pvtViewResult {
    pvtViewScore score;
    pvtQuadTally tallies[2]; ///< by family
} pvtViewResult;

pvtStatus pvtCreateViewScratch(pvtContext* context, const pvtViewJob* job, pvtViewScratch* scratch);
void pvtViewScratch_Free(pvtContext* context, pvtViewScratch* scratch);

/// The direction of view `view`: given, or uniform on the sphere.
pvtVec3 pvtGetViewDirection(const pvtEvaluateOptions* options, int view);

/// Puts pixels over the original's box: `pixels` along its longer side.
pvtStatus pvtFitScreen(pvtContext* context, const pvtSoup* original, int pixels, pvtScreen* screen);

/// The original's screen and, on the same lattice, one that holds the occluder too.
typedef struct pvtScreenPair {
    pvtScreen original, both;
    int x, y; ///< [px] of `original` where `both` begins; ≤ 0, x a multiple of 64
} pvtScreenPair;

/// Where `both` would need more than 4 × pixels + 4096 pixels a side, the pixels of the pair are
/// doubled in size until it does not.
pvtStatus pvtPairScreens(pvtContext* context, const pvtScreen* screen, const pvtSoup* occluder,
                         int pixels, pvtScreenPair* pair);

/// Fills results[0] to results[count − 1], one an occluder.
pvtStatus pvtJudgeView(pvtContext* context, const pvtViewJob* job, int view,
                       pvtViewScratch* scratch, pvtViewResult* results);

#endif
