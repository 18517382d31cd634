// SPDX-License-Identifier: MIT
#include "loops.h"

#include "base/context.h"

pvtStatus pvtCreateLoopSet(pvtContext* context, size_t pointCapacity, size_t loopCapacity,
                           pvtLoopSet* set)
{
    *set = (pvtLoopSet){
        .points = pvtAllocate(context, pointCapacity, sizeof *set->points),
        .starts = pvtAllocate(context, loopCapacity + 1, sizeof *set->starts),
        .parents = pvtAllocate(context, loopCapacity, sizeof *set->parents),
    };
    if (set->points == NULL || set->starts == NULL || set->parents == NULL) {
        pvtLoopSet_Free(context, set);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

void pvtLoopSet_Free(pvtContext* context, pvtLoopSet* set)
{
    pvtRelease(context, set->points);
    pvtRelease(context, set->starts);
    pvtRelease(context, set->parents);
    *set = (pvtLoopSet){0};
}

int64_t pvtGetLoopArea2(const pvtPoint2* points, size_t count)
{
    int64_t area = 0;
    for (size_t i = 0, last = count - 1; i < count; last = i++) {
        area += (int64_t)points[last].x * points[i].y - (int64_t)points[last].y * points[i].x;
    }
    return area;
}
