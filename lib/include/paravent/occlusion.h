// SPDX-License-Identifier: MIT
// Views, masks, the exact distance transform and the total occlusion measure (paper, section 3).
#ifndef PARAVENT_OCCLUSION_H
#define PARAVENT_OCCLUSION_H

#include <paravent/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/// An orthographic view: looking along `direction`; right × up = −direction, all unit.
typedef struct pvtView {
    pvtVec3 direction, right, up;
    double weight; ///< ≥ 0; the weights of a set sum to 1
} pvtView;

typedef struct pvtViewSet {
    pvtView* views;
    size_t count;
} pvtViewSet;

/// A direction to look along (any length > 0) and its weight ≥ 0.
typedef struct pvtWeightedDirection {
    pvtVec3 direction;
    double weight;
} pvtWeightedDirection;

typedef struct pvtViewOptions {
    int count;      ///< 1 to 4096 directions spread over the hemisphere; default 64
    bool aboveOnly; ///< only directions that look down or level along `up`; default false
    int up;         ///< 0, 1, 2: the axis of aboveOnly; default 1
    const pvtWeightedDirection* list; ///< not null: these, instead of the even spread; borrowed
    size_t listCount;
} pvtViewOptions;

PVT_API pvtViewOptions pvtDefaultViewOptions(void);

/// Opposite directions have mirrored images, so that a hemisphere is enough; directions of weight
/// 0 are left out. PVT_INVALID_ARGUMENT when no weight is left.
PVT_API pvtStatus pvtMakeViews(pvtContext* context, const pvtViewOptions* options, pvtViewSet* set);
PVT_API void pvtViewSet_Free(pvtContext* context, pvtViewSet* set);

/// Sum over the set bits of the Euclidean distance [px] from the pixel's centre to the nearest
/// clear pixel's centre; everything outside the mask is clear. Exact squared distances; each root
/// rounded to 1/256 px. `rows` has wordsPerRow × height words, lowest bit first; width up to
/// 64 × wordsPerRow, at most 4096 a side.
PVT_API uint64_t pvtSumDistances(const uint64_t* rows, int wordsPerRow, int height,
                                 uint32_t* scratch);
/// Words of scratch that pvtSumDistances needs.
PVT_API size_t pvtGetDistanceScratchCount(int wordsPerRow, int height);
/// The squared distances themselves [px²], 64 × wordsPerRow × height of them.
PVT_API void pvtTransformDistance(const uint64_t* rows, int wordsPerRow, int height,
                                  uint32_t* distances);

typedef struct pvtMeasureOptions {
    int pixels; ///< 64, 128 or 256 a side of the mask, stretched over the bounds; default 64
} pvtMeasureOptions;

PVT_API pvtMeasureOptions pvtDefaultMeasureOptions(void);

/// The total occlusion measure of a mesh [wu³]: mean over the views, by weight, of
/// Σ distance × pixel area. `bounds` fixes the pixel size, the same for all that are compared.
PVT_API pvtStatus pvtMeasureOcclusion(pvtContext* context, const pvtMeasureOptions* options,
                                      const pvtViewSet* views, const pvtBox3* bounds,
                                      const pvtMesh* mesh, double* measure);

#ifdef __cplusplus
}
#endif
#endif
