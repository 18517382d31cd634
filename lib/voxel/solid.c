// SPDX-License-Identifier: MIT
// What a surface encloses (paper, section 4.1, and beyond).
#include "bit_grid.h"
#include "outside.h"

#include "base/context.h"

#include <math.h>

// The copy of the surface and the inside.
enum { GRIDS_NEEDED = 2 };

pvtSolidOptions pvtDefaultSolidOptions(void)
{
    return (pvtSolidOptions){.smallestHole = 0.0,
                             .ground = false,
                             .terrain = false,
                             .below = 0,
                             .up = PVT_AXIS_Y,
                             .enclosed = -1};
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
    if (options->below < 0) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "below is %d; it may not be less than 0",
                       options->below);
    }
    if (options->up != PVT_AXIS_X && options->up != PVT_AXIS_Y && options->up != PVT_AXIS_Z) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "axis %d is none of x, y and z",
                       (int)options->up);
    }
    return PVT_OK;
}

pvtStatus pvtFindInside(pvtContext* context, const pvtSolidOptions* options,
                        const pvtBitGrid* surface, pvtBitGrid* inside)
{
    pvtStatus status = pvtFloodOutside(context, options, surface, inside);
    if (status == PVT_OK && options->terrain) {
        pvtFillBelowTerrain(options, surface, inside);
    }
    if (status == PVT_OK && options->enclosed >= 0) {
        status = pvtFillEnclosed(context, options->enclosed, inside);
    }
    if (status != PVT_OK) {
        pvtBitGrid_Free(context, inside);
    }
    return status;
}

static void CountVoxels(pvtSolid* solid)
{
    solid->insideCount = pvtBitGrid_Count(&solid->inside);
    solid->surfaceCount = pvtBitGrid_Count(&solid->surface);
    solid->strictCount = solid->insideCount - solid->surfaceCount;
    pvtGridBox box;
    if (pvtBitGrid_FindBounds(&solid->surface, &box)) {
        solid->insideFraction = (double)solid->strictCount / pvtGridBox_GetVolume(&box);
    }
}

// Says what would help when the flood found its way in.
void pvtWarnWhenHollow(pvtContext* context, const pvtSolid* solid)
{
    const pvtRemedy* remedy = &solid->remedy;
    const double percent = 100.0 * solid->insideFraction;
    const double voxels = remedy->smallestHole / solid->surface.frame.voxelSize;
    if (remedy->smallestHole > 0.0 && remedy->ground) {
        pvtWarnOnce(
            context,
            "the solid is hollow: only %.2g %% of the bounds is inside, because the surface is "
            "open below and has other openings; --ground closes the bottom, and --smallest-hole "
            "%g (%.1f voxels) the others, unless these are doors or windows",
            percent, remedy->smallestHole, voxels);
    } else if (remedy->smallestHole > 0.0) {
        pvtWarnOnce(
            context,
            "the solid is hollow: only %.2g %% of the bounds is inside, because the surface has "
            "openings; unless these are doors or windows, --smallest-hole %g (%.1f voxels) "
            "closes them",
            percent, remedy->smallestHole, voxels);
    } else if (remedy->ground) {
        pvtWarnOnce(
            context,
            "the solid is hollow: only %.2g %% of the bounds is inside, because the surface is "
            "open below; --ground would close it",
            percent);
    } else if (remedy->terrain) {
        pvtWarnOnce(
            context,
            "the solid is hollow: only %.2g %% of the bounds is inside, but the surface looks "
            "like a landscape; --terrain would fill what lies below",
            percent);
    }
}

pvtStatus pvtFillSolidInSilence(pvtContext* context, const pvtSolidOptions* options,
                                const pvtBitGrid* surface, pvtSolid* solid)
{
    *solid = (pvtSolid){0};
    pvtStatus status = CheckOptions(context, options);
    if (status != PVT_OK) {
        return status;
    }
    pvtBeginStage(context, "fill");
    status = pvtCheckGridMemory(context, surface, GRIDS_NEEDED, "the solid");
    if (status == PVT_OK) {
        status = pvtCopyBitGrid(context, surface, &solid->surface);
    }
    if (status == PVT_OK) {
        status = pvtFindInside(context, options, surface, &solid->inside);
    }
    if (status == PVT_OK) {
        pvtReportProgress(context, 0.7);
        CountVoxels(solid);
        status = pvtFindRemedy(context, options, surface, solid->strictCount, &solid->remedy);
    }
    if (status != PVT_OK) {
        pvtSolid_Free(context, solid);
        return status;
    }
    pvtReportProgress(context, 1.0);
    return PVT_OK;
}

pvtStatus pvtFillSolid(pvtContext* context, const pvtSolidOptions* options,
                       const pvtBitGrid* surface, pvtSolid* solid)
{
    const pvtStatus status = pvtFillSolidInSilence(context, options, surface, solid);
    if (status == PVT_OK) {
        pvtWarnWhenHollow(context, solid);
    }
    return status;
}
