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

enum { PVT_MAX_VIEWS = 4096 }; ///< directions of a set

typedef struct pvtViewOptions {
    int count;      ///< 1 to PVT_MAX_VIEWS directions spread over the hemisphere; default 64
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

/// Masks are square bitmaps of 64, 128 or 256 pixels a side: row y starts at word y × size / 64,
/// lowest bit first. What lies outside of a mask counts as clear.

/// Entries of a table over squared distances in a mask of this size: (size / 2)² + 1.
PVT_API size_t pvtGetDistanceTableCount(int size);
/// table[d²] = d^exponent × 256, rounded: what a covered pixel is worth whose nearest clear pixel
/// is d pixels away. An exponent of 1 gives the paper's measure, which counts beams of every radius
/// alike; 2 and 3 weigh wide beams more, by their radius and its square.
PVT_API void pvtFillDistanceTable(int size, int exponent, uint32_t* table);
/// Σ table[d²] over the set pixels, d being the Euclidean distance [px] from a pixel's centre to
/// that of the nearest clear pixel: exact, and the same on every machine. `size` is 64, 128 or 256.
PVT_API uint64_t pvtSumDistances(const uint64_t* rows, int size, const uint32_t* table);
/// The squared distances themselves [px²], size × size of them, 0 where the mask is clear.
PVT_API void pvtTransformDistance(const uint64_t* rows, int size, uint16_t* distances);

/// The total occlusion measure of a mesh [wu³]: mean over the views, by weight, of
/// Σ distance × pixel area, on masks of `size` pixels a side that span the projected bounds. Only
/// numbers of the same bounds, size and views can be compared.
PVT_API pvtStatus pvtMeasureOcclusion(pvtContext* context, const pvtViewSet* views,
                                      const pvtBox3* bounds, int size, const pvtMesh* mesh,
                                      double* measure);

#ifdef __cplusplus
}
#endif
#endif
