// SPDX-License-Identifier: MIT
// How often progress is shown.
#ifndef PVT_APP_PROGRESS_H
#define PVT_APP_PROGRESS_H

#include "report.h"

/// Thins what the stages report: ten updates a second on a terminal or as JSON; as plain text at
/// most a line a second, when a stage begins, and one every five seconds within it.
typedef struct pvtProgress {
    pvtReport* report;
    double began; ///< [s] on the monotonic clock
    double shown; ///< [s] when something was shown last
    char stage[64];
} pvtProgress;

pvtProgress pvtBeginProgress(pvtReport* report);
void pvtProgress_Update(pvtProgress* progress, const char* stage, double fraction);

/// Seconds on a clock that only runs forwards.
double pvtGetClock(void);

#endif
