// SPDX-License-Identifier: MIT
// When refinement is to end, with the best so far.
#ifndef PVT_OCCLUDER_ENOUGH_H
#define PVT_OCCLUDER_ENOUGH_H

#include "base/context.h"

/// By a time or by the caller's word, as pvtBuildOptions tells.
typedef struct pvtEnough {
    double deadline;        ///< on pvtGetSeconds' clock; 0: none
    pvtCancelFcn* isEnough; ///< null: never
    void* user;
} pvtEnough;

/// What ended it, for a message; null while it may go on.
static inline const char* pvtEnough_FindEnd(const pvtEnough* enough)
{
    if (enough->deadline > 0.0 && pvtGetSeconds() > enough->deadline) {
        return "the deadline";
    }
    return enough->isEnough != NULL && enough->isEnough(enough->user) ? "the caller" : NULL;
}

/// Whether work is to end, which is told then: what work, of which parts, and the share of them
/// that is done.
static inline bool pvtEnough_Ends(pvtContext* context, const pvtEnough* enough, const char* work,
                                  const char* parts, double done)
{
    const char* cause = pvtEnough_FindEnd(enough);
    if (cause != NULL) {
        pvtLog(context, PVT_LOG_WARNING, "%s ended the %s after %.0f %% of its %s", cause, work,
               100.0 * done, parts);
    }
    return cause != NULL;
}

#endif
