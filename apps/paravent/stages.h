// SPDX-License-Identifier: MIT
// The stages of a build and how long they took, for everything that tells, sums or shares them.
#ifndef PVT_APP_STAGES_H
#define PVT_APP_STAGES_H

#include "json.h"

#include <paravent/occluder.h>
#include <stddef.h>

enum {
    PVT_STAGE_COUNT = 7, ///< without the total
    PVT_STAGES_TEXT_SIZE = 256,
};

/// A number of seconds, to the microsecond.
void pvtWriteStage(pvtJson* json, const char* stage, double seconds);
/// All stages of the build, but not its total.
void pvtWriteStages(pvtJson* json, const pvtBuildStats* stats);
/// "voxelize 0.012, solid 0.003, …", without the total.
void pvtPrintStages(const pvtBuildStats* stats, char text[PVT_STAGES_TEXT_SIZE]);

/// Adds the seconds of `stats` to those of `sum`, the totals too.
void pvtAddSeconds(pvtBuildStats* sum, const pvtBuildStats* stats);
/// Multiplies the seconds, and the total.
void pvtScaleSeconds(pvtBuildStats* stats, double factor);

#endif
