// SPDX-License-Identifier: MIT
// Where an occluder may lie.
#include "bit_grid.h"
#include "dilate.h"

#include "base/context.h"

#include <math.h>

pvtStatus pvtMakeAllowedGrid(pvtContext* context, const pvtSolid* solid, double tolerance,
                             pvtBitGrid* allowed)
{
    *allowed = (pvtBitGrid){0};
    if (!(tolerance >= 0.0 && isfinite(tolerance))) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the tolerance is %g; it may not be less than 0", tolerance);
    }
    if (tolerance > 0.0) {
        const uint32_t reach = pvtGetSquaredReach(&solid->inside.frame, tolerance);
        return pvtDilateGrid(context, &solid->inside, reach, allowed);
    }
    const pvtStatus status = pvtCopyBitGrid(context, &solid->inside, allowed);
    for (size_t i = 0; i < allowed->wordCount && status == PVT_OK; ++i) {
        allowed->words[i] &= ~solid->surface.words[i];
    }
    return status;
}
