// SPDX-License-Identifier: MIT
#ifndef PVT_OCCLUDER_REFINE_H
#define PVT_OCCLUDER_REFINE_H

#include <paravent/occluder.h>

typedef struct pvtRefineOptions {
    int budget;
    const pvtViewSet* views;
    pvtBox3 bounds;
    uint64_t seed;
    int trials;
} pvtRefineOptions;

pvtStatus pvtRefineOccluder(pvtContext* context, const pvtRefineOptions* options,
                            const pvtSliceVolume* volume, const pvtCandidateSet* candidates,
                            pvtOccluder* occluder);

#endif
