// SPDX-License-Identifier: MIT
// What polygons hide, seen from a set of views: masks and the sums of their distance transforms,
// kept row by row so that a small change costs little.
#ifndef PVT_OCCLUDER_SCORER_H
#define PVT_OCCLUDER_SCORER_H

#include "occlusion/distance.h"
#include "occlusion/mask.h"

#include <paravent/section.h>

/// Views, pixel sizes and the worth of a distance: the same for everything that is compared.
typedef struct pvtScorer {
    pvtGridFrame grid;
    int size; ///< [px] of the masks
    size_t viewCount;
    size_t wordCount;     ///< of one mask
    pvtMaskFrame* frames; ///< one a view
    double* factors;      ///< one a view: what one unit of a table sum is worth
    uint32_t* table;
} pvtScorer;

/// `exponent` as in pvtFillDistanceTable; 1 gives the total occlusion measure in wu³.
typedef struct pvtScorerOptions {
    const pvtViewSet* views;
    pvtBox3 bounds;
    int size;
    int exponent;
} pvtScorerOptions;

pvtStatus pvtCreateScorer(pvtContext* context, const pvtScorerOptions* options,
                          const pvtGridFrame* grid, pvtScorer* scorer);
void pvtScorer_Free(pvtContext* context, pvtScorer* scorer);

/// (u, v) of a plane to mask coordinates in 1/256 pixel: x = xu × u + xv × v + x0, y alike.
typedef struct pvtPlaneProjection {
    double xu, xv, x0, yu, yv, y0;
} pvtPlaneProjection;

pvtPlaneProjection pvtProjectPlane(const pvtScorer* scorer, size_t view, const pvtPlane* plane);

/// Turns the polygon's pixels over in `rows`, which the caller cleared.
void pvtDrawSectionPolygon(const pvtScorer* scorer, const pvtPlaneProjection* projection,
                           const pvtPoint2* points, size_t count, uint64_t* rows);

/// A mask with its transform.
typedef struct pvtScoredMask {
    uint64_t* rows;    ///< wordCount
    uint8_t* columns;  ///< size × size: see pvtTransformMaskColumns
    uint64_t* rowSums; ///< size
    uint64_t sum;      ///< of rowSums
} pvtScoredMask;

/// One mask a view.
typedef struct pvtScoredMaskSet {
    pvtScoredMask* masks;
    size_t count;
    void* memory;
} pvtScoredMaskSet;

/// Empty masks.
pvtStatus pvtCreateScoredMasks(pvtContext* context, const pvtScorer* scorer, pvtScoredMaskSet* set);
void pvtScoredMaskSet_Free(pvtContext* context, pvtScoredMaskSet* set);

/// What mask->sum would be with these rows. Only rows whose columns differ are summed again.
uint64_t pvtScoreRows(const pvtScorer* scorer, const pvtScoredMask* mask, const uint64_t* rows);

/// Makes `rows` the mask's own.
void pvtScoredMask_Assign(const pvtScorer* scorer, pvtScoredMask* mask, const uint64_t* rows);

#endif
