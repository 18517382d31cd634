// SPDX-License-Identifier: MIT
// What a surface encloses (paper, section 4.1, and beyond).
#include "bit_grid.h"
#include "flood.h"

#include "base/context.h"

#include <math.h>

pvtSolidOptions pvtDefaultSolidOptions(void)
{
    return (pvtSolidOptions){
        .smallestHole = 0.0, .ground = false, .terrain = false, .up = PVT_AXIS_Y, .enclosed = -1};
}

void pvtSolid_Free(pvtContext* context, pvtSolid* solid)
{
    pvtBitGrid_Free(context, &solid->inside);
    pvtBitGrid_Free(context, &solid->surface);
    *solid = (pvtSolid){0};
}

static pvtStatus CheckOptions(pvtContext* context, const pvtSolidOptions* options)
{
    if (!(options->smallestHole >= 0.0 && isfinite(options->smallestHole))) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the smallest hole is %g; it may not be less than 0", options->smallestHole);
    }
    if (options->enclosed < -1 || options->enclosed > 25) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "enclosed is %d; it must be -1 (off) or 0 to 25 directions",
                       options->enclosed);
    }
    if (options->smallestHole > 0.0 || options->ground || options->terrain ||
        options->enclosed >= 0) {
        return pvtFail(context, PVT_UNSUPPORTED, "only the plain flood is there");
    }
    return PVT_OK;
}

static void Complement(pvtBitGrid* grid)
{
    const uint64_t tailMask = pvtBitGrid_GetTailMask(grid);
    for (size_t i = 0; i < grid->wordCount; ++i) {
        const bool isTail = (i + 1) % grid->wordsPerRow == 0;
        grid->words[i] = ~grid->words[i] & (isTail ? tailMask : ~UINT64_C(0));
    }
}

static void CountVoxels(pvtSolid* solid)
{
    solid->insideCount = pvtBitGrid_Count(&solid->inside);
    solid->surfaceCount = pvtBitGrid_Count(&solid->surface);
    solid->strictCount = solid->insideCount - solid->surfaceCount;
    pvtGridBox box;
    if (pvtBitGrid_FindBounds(&solid->surface, &box)) {
        const double volume = (double)(box.upper[0] - box.lower[0]) *
                              (double)(box.upper[1] - box.lower[1]) *
                              (double)(box.upper[2] - box.lower[2]);
        solid->insideFraction = (double)solid->strictCount / volume;
    }
}

pvtStatus pvtFillSolid(pvtContext* context, const pvtSolidOptions* options,
                       const pvtBitGrid* surface, pvtSolid* solid)
{
    *solid = (pvtSolid){0};
    pvtStatus status = CheckOptions(context, options);
    if (status != PVT_OK) {
        return status;
    }
    pvtBeginStage(context, "fill");
    status = pvtCopyBitGrid(context, surface, &solid->surface);
    if (status == PVT_OK) {
        status = pvtCreateBitGrid(context, &surface->frame, &solid->inside);
    }
    if (status == PVT_OK) {
        status = pvtFloodFromBorder(context, surface, &solid->inside);
    }
    if (status != PVT_OK) {
        pvtSolid_Free(context, solid);
        return status;
    }
    Complement(&solid->inside);
    CountVoxels(solid);
    pvtReportProgress(context, 1.0);
    return PVT_OK;
}
