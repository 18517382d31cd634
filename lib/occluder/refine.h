// SPDX-License-Identifier: MIT
#ifndef PVT_OCCLUDER_REFINE_H
#define PVT_OCCLUDER_REFINE_H

#include "enough.h"
#include "sheets.h"

typedef struct pvtRefineOptions {
    int budget;                ///< triangles
    const pvtViewSet* views;   ///< borrowed
    pvtBox3 bounds;            ///< [wu] what the masks span
    const pvtSheetSet* sheets; ///< where panels may lie besides the volume; borrowed; may be null
    uint64_t seed;
    int trials;       ///< changes that are tried
    pvtEnough enough; ///< ends the trials
} pvtRefineOptions;

/// Changes panels at random for as long as that raises the measure: points move as far as the
/// allowed cells let them, planes shift and tilt, triangles go from panel to panel, panels give way
/// to candidates. The measure never falls.
pvtStatus pvtRefineOccluder(pvtContext* context, const pvtRefineOptions* options,
                            const pvtSliceVolume* volume, const pvtCandidateSet* candidates,
                            pvtOccluder* occluder);

#endif
