// SPDX-License-Identifier: MIT
#ifndef PVT_OCCLUDER_BEND_H
#define PVT_OCCLUDER_BEND_H

#include "enough.h"
#include "inside.h"

#include <paravent/occluder.h>

typedef struct pvtBendOptions {
    const pvtViewSet* views; ///< borrowed
    const pvtViewSet* more;  ///< borrowed; may be empty: others, which have the last word
    pvtBox3 bounds;          ///< [wu] what the masks span
    const pvtInsideTest* inside;
    uint64_t seed;
    int trials;       ///< random changes that are tried
    int sweeps;       ///< after them: corners that grow, by a voxel in the last one
    pvtEnough enough; ///< ends the trials
} pvtBendOptions;

/// Moves the corners of the occluder's triangles freely, and lets triangles share other corners,
/// for as long as that hides more rectangles of the screen. Triangles stay inside, but no longer
/// lie in the planes of their polygons: `planes` and `loops` stay as they were. Neither what
/// `views` hide nor what all views hide falls. At most PVT_MAX_FACETS triangles.
pvtStatus pvtBendOccluder(pvtContext* context, const pvtBendOptions* options,
                          pvtOccluder* occluder);

#endif
