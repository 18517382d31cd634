// SPDX-License-Identifier: MIT
// What would fill a hollow solid. No remedy is looked for as yet.
#include "outside.h"

pvtStatus pvtFindRemedy(pvtContext* context, const pvtSolidOptions* options,
                        const pvtBitGrid* surface, uint64_t strictCount, pvtRemedy* remedy)
{
    (void)context;
    (void)options;
    (void)surface;
    (void)strictCount;
    *remedy = (pvtRemedy){0};
    return PVT_OK;
}
