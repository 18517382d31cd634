// SPDX-License-Identifier: MIT
// How often progress is shown.
#ifndef PVT_APP_PROGRESS_H
#define PVT_APP_PROGRESS_H

#include "report.h"

/// Thins what the stages report: ten updates a second on a terminal or as JSON, and a line every
/// five seconds as plain text.
typedef struct pvtProgress {
    pvtReport* report;
    double began; ///< [s] on the monotonic clock
    double shown; ///< [s] when something was shown last
    char stage[64];
    double fraction; ///< shown last
} pvtProgress;

pvtProgress pvtBeginProgress(pvtReport* report);
void pvtProgress_Update(pvtProgress* progress, const char* stage, double fraction);

/// Seconds on a clock that only runs forwards.
double pvtGetClock(void);

#endif
