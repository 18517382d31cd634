// SPDX-License-Identifier: MIT
// What polygons hide, seen from a set of views: masks and the sums of their distance transforms,
// kept row by row so that a small change costs little.
#ifndef PVT_OCCLUDER_SCORER_H
#define PVT_OCCLUDER_SCORER_H

#include "occlusion/distance.h"
#include "occlusion/mask.h"

#include <paravent/section.h>

/// Views, pixel sizes and the worth of a distance: the same for everything that is compared. For
/// coarse work four views share a mask of 64 pixels, 31 pixels a side each, with clear pixels
/// between them: one transform then serves all four.
typedef struct pvtScorer {
    pvtGridFrame grid;
    int size;         ///< [px] of the masks
    int viewsPerMask; ///< 1 or 4
    size_t viewCount;
    size_t maskCount;
    size_t wordCount;     ///< of one mask
    pvtMaskFrame* frames; ///< one a view
    double* factors;      ///< four a mask: what one unit of a table sum is worth in that quarter
    uint32_t* table;
} pvtScorer;

/// `exponent` as in pvtFillDistanceTable; 1 gives the total occlusion measure in wu³.
typedef struct pvtScorerOptions {
    const pvtViewSet* views;
    pvtBox3 bounds;
    int size; ///< [px] for each view: 31, 64, 128 or 256
    int exponent;
} pvtScorerOptions;

pvtStatus pvtCreateScorer(pvtContext* context, const pvtScorerOptions* options,
                          const pvtGridFrame* grid, pvtScorer* scorer);
void pvtScorer_Free(pvtContext* context, pvtScorer* scorer);

/// Turns over the polygon's pixels in all views of a mask; the caller cleared `rows`.
void pvtDrawSectionPolygon(const pvtScorer* scorer, size_t mask, const pvtPlane* plane,
                           const pvtPoint2* points, size_t count, uint64_t* rows);

/// A mask with its transform.
typedef struct pvtScoredMask {
    uint64_t* rows;         ///< wordCount
    uint8_t* columns;       ///< size × size: see pvtTransformMaskColumns
    uint64_t (*rowSums)[2]; ///< size: table sums of each row's halves
    uint64_t sums[4];       ///< of the quarters; all in the first when there is one view
    double value;           ///< Σ factor × sum
} pvtScoredMask;

/// One for each mask of the scorer.
typedef struct pvtScoredMaskSet {
    pvtScoredMask* masks;
    size_t count;
    void* memory;
} pvtScoredMaskSet;

/// Empty masks.
pvtStatus pvtCreateScoredMasks(pvtContext* context, const pvtScorer* scorer, pvtScoredMaskSet* set);
void pvtScoredMaskSet_Free(pvtContext* context, pvtScoredMaskSet* set);

/// What the value of mask `index` would be with these rows. Only rows whose columns differ are
/// summed again.
double pvtScoreRows(const pvtScorer* scorer, const pvtScoredMaskSet* set, size_t index,
                    const uint64_t* rows);

/// Makes `rows` the mask's own.
void pvtAssignRows(const pvtScorer* scorer, pvtScoredMaskSet* set, size_t index,
                   const uint64_t* rows);

#endif
