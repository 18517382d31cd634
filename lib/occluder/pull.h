// SPDX-License-Identifier: MIT
// Which way the corners of triangles would have to go to hide more.
#ifndef PVT_OCCLUDER_PULL_H
#define PVT_OCCLUDER_PULL_H

#include "sights.h"
#include "triangle_set.h"

enum {
    PVT_MOST_BATCH = 64,  ///< sights at once
    PVT_MOST_WEIGHED = 32 ///< of these that triangles are weighed in
};

/// A rectangle of which m pixels are not covered counts as 1 ÷ (1 + m ÷ softness): with a softness
/// near 0 that is 1 if it is hidden and 0 if not, and with a large one it grows with every pixel.
typedef struct pvtPullOptions {
    size_t first;   ///< of the sights, and how many follow, around the end of the set
    int count;      ///< at most PVT_MOST_BATCH
    float softness; ///< [px]
    float inset; ///< [px] that open edges are drawn short of, so that no gap is too narrow to see
    bool mindsBeyond; ///< whether what is covered beyond a goal of voxels counts against it
    float wrongCost; ///< of a pixel that is hidden wrongly, as that of one that is rightly counts 1
    bool wantsEdges;
    bool wantsNoPulls; ///< `share` alone
} pvtPullOptions;

typedef struct pvtPuller {
    const pvtSightSet* sights; ///< borrowed
    const pvtTriangleSet* set; ///< borrowed
    pvtPullOptions options;
    float (*cornerPulls)[2]; ///< sight × corner: [px⁻¹]
    float (*edgePulls)[2];   ///< sight × edge
    double worth[PVT_MOST_BATCH];
    double most[PVT_MOST_BATCH];
    double rights[PVT_MOST_BATCH], wrongs[PVT_MOST_BATCH];
    pvtSightMask* masks;       ///< sight × triangle
    pvtSightRows* rows;        ///< sight × triangle: the rows that its mask may have pixels in
    pvtSightMask (*layers)[3]; ///< sight × covered at least once, twice, thrice
    uint32_t* singles;         ///< sight × triangle: pixels that no other triangle covers
    float* losses;             ///< sight × triangle
    bool* isWeighed;           ///< of each triangle
    // Of all sights together:
    float (*corners)[3]; ///< [vx⁻¹] what the worth grows by as each corner moves
    float (*edges)[3];   ///< the same for a corner between an edge's ends, if it had one
    double share;        ///< of the rectangles' worth if all were hidden
    double right, wrong; ///< what is hidden of the goals, and besides, where sights show a mesh
    double* triangles;   ///< what the worth would lose with each triangle
} pvtPuller;

/// `set` may change, within its capacity.
pvtStatus pvtCreatePuller(pvtContext* context, const pvtSightSet* sights, const pvtTriangleSet* set,
                          pvtPuller* puller);
void pvtPuller_Free(pvtContext* context, pvtPuller* puller);

/// The sight that comes `b` after the first of the options.
static inline const pvtSight* pvtPuller_GetSight(const pvtPuller* puller, size_t b)
{
    return &puller->sights->sights[(puller->options.first + b) % puller->sights->count];
}

/// Fills `share`, `right` and `wrong`, `corners` unless they are not wanted, and, if wanted,
/// `edges`. The share is that of the goals alone.
void pvtPullCorners(pvtContext* context, const pvtPullOptions* options, pvtPuller* puller);
/// Fills `triangles`, for at least a quarter of them, those that cover the fewest pixels alone; it
/// is HUGE_VAL for the others. `count` is at most PVT_MOST_WEIGHED.
void pvtWeighTriangles(pvtContext* context, const pvtPullOptions* options, pvtPuller* puller);
/// Whether two triangles cover pixels together that no other covers, in some sight that was last
/// weighed: then they are worth more than each alone.
bool pvtArePartners(const pvtPuller* puller, int a, int b);

#endif
