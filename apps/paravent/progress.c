// SPDX-License-Identifier: MIT
#include "progress.h"

#include <string.h>
#include <time.h>

double pvtGetClock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

pvtProgress pvtBeginProgress(pvtReport* report)
{
    const double now = pvtGetClock();
    return (pvtProgress){.report = report, .began = now, .shown = now};
}

static bool IsDue(const pvtProgress* progress, bool isNewStage, double fraction, double now)
{
    const double since = now - progress->shown;
    // Plain text goes to logs, where a hundred lines of percentages would bury what matters.
    if (progress->report->style == PVT_REPORT_PLAIN) {
        return since >= 5.0;
    }
    // A program that reads along wants to see every stage begin and end.
    const bool isEdge = isNewStage || fraction >= 1.0;
    return since >= 0.1 || (isEdge && progress->report->style == PVT_REPORT_JSON);
}

void pvtProgress_Update(pvtProgress* progress, const char* stage, double fraction)
{
    const bool isNewStage = strncmp(progress->stage, stage, sizeof progress->stage - 1) != 0;
    if (isNewStage) {
        (void)snprintf(progress->stage, sizeof progress->stage, "%s", stage);
        progress->fraction = -1.0;
    }
    const double now = pvtGetClock();
    // A stage that is made of others ends where the last of them did.
    if (!isNewStage && fraction <= progress->fraction) {
        return;
    }
    if (IsDue(progress, isNewStage, fraction, now)) {
        progress->shown = now;
        progress->fraction = fraction;
        pvtReport_ShowProgress(progress->report, stage, fraction, now - progress->began);
    }
}
