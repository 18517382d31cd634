// SPDX-License-Identifier: MIT
// What the files that make sights share.
#ifndef PVT_OCCLUDER_SIGHT_SUBJECT_H
#define PVT_OCCLUDER_SIGHT_SUBJECT_H

#include "sights.h"

/// What sights look at.
typedef struct pvtSightSubject {
    const void* data;
    float low[3], high[3]; ///< [vx] around it
    double share;          ///< 0 to 1: of the sights that are asked for, as far as time allows
    bool isExact; ///< what is not of a goal is background: rectangles there would be hidden wrongly
    /// Sets the pixels of a sight's goal, which is clear. Called by several workers at once.
    void (*draw)(const void* data, const pvtView* view, int worker, pvtSight* sight);
} pvtSightSubject;

pvtStatus pvtMakeSights(pvtContext* context, const pvtSightOptions* options,
                        const pvtSightSubject* subject, pvtSightSet* set);

#endif
