// SPDX-License-Identifier: MIT
// What an occluder covers beside its original in a view: how much, and how far off.
#ifndef PVT_EVALUATE_EXCESS_H
#define PVT_EVALUATE_EXCESS_H

#include "raster.h"

/// Room that is kept from view to view, and what is known of the original in this one.
typedef struct pvtExcessScratch {
    uint16_t* distances; ///< [px] to the nearest covered pixel of the same column, or NO_DISTANCE
    int* sites;          ///< columns on the envelope of a row
    int64_t* starts;     ///< where each site's stretch begins
    size_t distanceCapacity, siteCapacity;
    bool isReady; ///< distances belong to the original at hand; clear it when that changes
} pvtExcessScratch;

typedef struct pvtExcess {
    uint64_t pixels;    ///< covered by the occluder alone
    uint64_t distance2; ///< [px²] the largest squared distance of one of them from the original
} pvtExcess;

/// Two pictures on one lattice: pixel (0, 0) of `occluder` is pixel (x, y) of `original`. x is a
/// multiple of 64. Sides up to 32768.
typedef struct pvtRasterPair {
    const pvtRaster *original, *occluder;
    int x, y;
} pvtRasterPair;

/// Distances run from a pixel's centre to the centre of the nearest covered pixel of the original.
/// An original without any covered pixel is taken as covered all over.
pvtStatus pvtMeasureExcess(pvtContext* context, const pvtRasterPair* pair,
                           pvtExcessScratch* scratch, pvtExcess* excess);
void pvtExcessScratch_Free(pvtContext* context, pvtExcessScratch* scratch);

#endif
