// SPDX-License-Identifier: MIT
// Many views of what could be hidden, each with rectangles drawn at random within it: what the
// ascent learns from, a few at a time.
#ifndef PVT_OCCLUDER_SIGHTS_H
#define PVT_OCCLUDER_SIGHTS_H

#include "field.h"

#include <paravent/occlusion.h>

enum { PVT_SIGHT_SIZE = 64 }; ///< [px] of the masks, a word a row

/// Pixels from x0 to x1 − 1 and from y0 to y1 − 1.
typedef struct pvtSightQuad {
    uint8_t x0, y0, x1, y1;
} pvtSightQuad;

/// An orthographic view: a point of the grid lies at pixel (dot(p, right) + x, dot(p, up) + y).
typedef struct pvtSight {
    float right[3], up[3];         ///< [px/vx]
    float x, y;                    ///< [px]
    float pixelSize;               ///< [vx]
    float weight;                  ///< of a mean of 1 over the set
    uint64_t goal[PVT_SIGHT_SIZE]; ///< pixels that what is allowed covers
    size_t firstQuad, quadCount;
} pvtSight;

typedef struct pvtSightSet {
    pvtSight* sights; ///< in an order in which any few of them look from all sides
    size_t count;
    pvtSightQuad* quads; ///< each within the goal of its sight
    size_t quadCount;
} pvtSightSet;

typedef struct pvtSightOptions {
    const pvtViewOptions* views; ///< how to spread them, or the list; `count` is not used
    int count;                   ///< of the sights
    int quads;                   ///< that are drawn at random on each screen, whole or not
    uint64_t seed;
} pvtSightOptions;

pvtStatus pvtCreateSights(pvtContext* context, const pvtSightOptions* options,
                          const pvtField* field, pvtSightSet* set);
void pvtSightSet_Free(pvtContext* context, pvtSightSet* set);

#endif
