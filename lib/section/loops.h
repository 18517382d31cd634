// SPDX-License-Identifier: MIT
// How the stages of this room make their loop sets.
#ifndef PVT_SECTION_LOOPS_H
#define PVT_SECTION_LOOPS_H

#include <paravent/section.h>

/// An empty set with room for this many points and loops; starts[0] is 0.
pvtStatus pvtCreateLoopSet(pvtContext* context, size_t pointCapacity, size_t loopCapacity,
                           pvtLoopSet* set);

/// Ends the loop of the points added since the last one.
static inline void pvtLoopSet_EndLoop(pvtLoopSet* set, int32_t parent)
{
    set->parents[set->loopCount] = parent;
    set->starts[++set->loopCount] = set->pointCount;
}

static inline size_t pvtLoopSet_GetSize(const pvtLoopSet* set, size_t loop)
{
    return set->starts[loop + 1] - set->starts[loop];
}

#endif
