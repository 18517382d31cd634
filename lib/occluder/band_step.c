// SPDX-License-Identifier: MIT
// A surface that has no inside, or little, and is not flat, a landscape above all: triangles may
// lie within a band around it, which is as narrow as the budget allows. So they may around a solid
// in which what is strictly inside is too thin to hide anything.
#include "bands.h"
#include "ceiling.h"

#include "base/context.h"
#include "voxel/bit_grid.h"

#include <math.h>

// [vx] at PVT_BAND_RESOLUTION.
static const double REACHES[PVT_BAND_COUNT] = {1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0};
enum { MOST_RESOLUTION = 640 }; // along the longest side, for an error that was asked for
// Of the touched voxels: an inside of fewer is none.
static const double LEAST_INSIDE = 0.01;
// Of the surface: where as much has no inside behind it, a band may help although there is one.
static const double BARE_SHARE = 0.3;
// Of what touched voxels and all within them hide: where a selection hides less, it is looked at
// whether its recall is hopeless.
static const double LITTLE_SHARE = 0.3, HOPELESS_RECALL = 0.05;

double pvtGetBandReach(const pvtBuild* build, int number)
{
    const double voxels = REACHES[number] * build->stats.resolution / PVT_BAND_RESOLUTION;
    return fmax(voxels, 1.0) * build->stats.voxelSize;
}

bool pvtHasNoInside(const pvtBuild* build)
{
    const pvtSolid* solid = &build->solid;
    return solid->remedy.terrain ||
           (double)solid->strictCount < LEAST_INSIDE * (double)solid->surfaceCount;
}

bool pvtIsOpen(const pvtBuild* build)
{
    return pvtHasNoInside(build) || build->band.isBare ||
           build->sheets.bare > BARE_SHARE * build->sheets.area;
}

bool pvtMayUseBand(const pvtBuild* build)
{
    return pvtMayUseSheets(build) && !build->band.isOff && pvtIsOpen(build);
}

pvtStatus pvtPadSolid(pvtContext* context, const pvtSolid* solid, double reach, pvtSolid* padded)
{
    *padded = *solid;
    padded->inside = padded->surface = (pvtBitGrid){0};
    const int room = (int)ceil(reach / solid->inside.frame.voxelSize - 1e-9) + 1;
    pvtGridBox box = {{0, 0, 0}, {0, 0, 0}};
    pvtBitGrid_FindBounds(&solid->inside, &box);
    int offset[3], size[3];
    for (int axis = 0; axis < 3; ++axis) {
        offset[axis] = room - box.lower[axis];
        size[axis] = box.upper[axis] - box.lower[axis] + 2 * room;
    }
    pvtStatus status = pvtMoveBitGrid(context, &solid->inside, offset, size, &padded->inside);
    if (status == PVT_OK) {
        status = pvtMoveBitGrid(context, &solid->surface, offset, size, &padded->surface);
    }
    return status;
}

pvtStatus pvtAllowBand(pvtContext* context, const pvtSolid* solid, double reach, pvtBuild* build)
{
    pvtBitGrid_Free(context, &build->allowed);
    pvtSliceVolume_Free(context, &build->volume);
    build->stats.tolerance = reach;
    pvtStatus status = pvtMakeAllowedGrid(context, solid, reach, &build->allowed);
    if (status == PVT_OK) {
        pvtFindVoxelBounds(&build->allowed, &build->bounds);
        status = pvtCreateSliceVolume(context, &build->allowed, &build->volume);
    }
    return status;
}

pvtStatus pvtSelectWithin(pvtContext* context, pvtBuild* build)
{
    pvtStatus status = pvtSearchStep(context, build);
    if (status == PVT_OK) {
        status = pvtChainStep(context, build);
    }
    return status == PVT_OK ? pvtSelectStep(context, build) : status;
}

static pvtStatus UseBand(pvtContext* context, pvtBuild* build, double reach)
{
    pvtSheetSet_Free(context, &build->sheets);
    pvtBitGrid_Free(context, &build->hiding);
    pvtCellGrid_Free(context, &build->cells);
    pvtTouching_Free(context, &build->touching);
    build->isBand = true;
    pvtSolid padded;
    pvtStatus status = pvtPadSolid(context, &build->solid, reach, &padded);
    pvtSolid_Free(context, &build->solid);
    build->solid = padded;
    if (status == PVT_OK) {
        status = pvtAllowBand(context, &build->solid, reach, build);
    }
    pvtSetErrorBound(&build->stats);
    return status;
}

// A bound of the error leaves most to a band of small voxels; of those that are not too many the
// smallest. 0: none.
static double FindErrorReach(const pvtBuild* build)
{
    static const double voxels[] = {4.0, 2.0, 1.0};
    for (int i = 0; i < 3; ++i) {
        const double finer = (sqrt(3.0) + voxels[i]) / sqrt(3.0);
        if (build->stats.resolution * finer <= MOST_RESOLUTION) {
            return voxels[i];
        }
    }
    return 0.0;
}

// From the beginning, with so many voxels as the tolerance, and the same error.
static pvtStatus Restart(pvtContext* context, pvtBuild* build, double voxels)
{
    build->ownOptions = *build->options;
    build->ownOptions.tolerance = (pvtLength){voxels, true};
    pvtBuild_Free(context, build);
    build->options = &build->ownOptions;
    pvtStatus status = pvtResolveSizes(context, build);
    if (status == PVT_OK) {
        status = pvtVoxelizeStep(context, build);
    }
    if (status == PVT_OK) {
        status = pvtFillStep(context, build);
    }
    // Smaller voxels may have found one.
    build->isBand = status == PVT_OK && (pvtHasNoInside(build) || build->band.isBare);
    pvtBeginStage(context, "band");
    return status;
}

static pvtStatus TakeReach(pvtContext* context, pvtBuild* build, double reach)
{
    build->band.reach = reach;
    build->band.resolution = build->stats.resolution;
    build->band.isBare = !pvtHasNoInside(build);
    if (build->options->error == 0.0) {
        return UseBand(context, build, reach);
    }
    const double voxels = FindErrorReach(build);
    if (voxels == 0.0) {
        build->band = (pvtBandPlan){.isOff = true};
        return PVT_OK;
    }
    return Restart(context, build, voxels);
}

static pvtStatus TryBand(pvtContext* context, pvtBuild* build)
{
    bool areEnough = false;
    double reach = 0.0;
    pvtStatus status = pvtChooseSheets(context, build, &areEnough);
    if (status == PVT_OK && pvtMayUseBand(build) && !areEnough) {
        status = pvtFindBandReach(context, build, &reach);
    }
    return status == PVT_OK && reach > 0.0 ? TakeReach(context, build, reach) : status;
}

pvtStatus pvtBandStep(pvtContext* context, pvtBuild* build)
{
    pvtStatus status = PVT_OK;
    if (pvtMayUseSheets(build) && pvtIsOpen(build)) {
        status = build->band.reach > 0.0 ? TakeReach(context, build, build->band.reach)
                                         : TryBand(context, build);
    }
    // A band is a tolerance, with which there are no sheets.
    return status == PVT_OK && pvtMayUseSheets(build) ? pvtSheetStepWithoutBand(context, build)
                                                      : status;
}

// Whether what is strictly inside may be too thin to hide anything: with a tolerance there is more,
// and where there are panels on the surface it was looked at before.
static bool MayBeThin(const pvtBuild* build)
{
    return pvtMayUseSheets(build) && !build->band.isOff && !build->band.isBare &&
           build->options->effort != PVT_EFFORT_FAST && build->options->error == 0.0 &&
           build->flat.loops.loopCount > 0 && pvtMayAscend(build);
}

// Whether what was selected for the budget hides next to nothing of what the mesh does.
static pvtStatus IsHopeless(pvtContext* context, const pvtBuild* build, bool* isHopeless)
{
    const pvtMeasureGridOptions options = {&build->views, &build->bounds, PVT_MEASURE_SIZE};
    double selected = 0.0, whole = 0.0;
    *isHopeless = false;
    pvtStatus status = pvtMeasureTriangles(context, build, &build->flat.mesh, &selected);
    if (status == PVT_OK) {
        status = pvtMeasureGrid(context, &options, &build->solid.inside, NULL, &whole);
    }
    if (status == PVT_OK && selected < LITTLE_SHARE * whole) {
        pvtQuadScore score = {0};
        status = pvtScoreOccluder(context, build, &build->flat.mesh, true, &score);
        *isHopeless = status == PVT_OK && score.recall < HOPELESS_RECALL;
    }
    return status;
}

pvtStatus pvtThinStep(pvtContext* context, pvtBuild* build)
{
    bool isHopeless = false;
    double reach = 0.0;
    pvtStatus status = MayBeThin(build) ? IsHopeless(context, build, &isHopeless) : PVT_OK;
    if (status == PVT_OK && isHopeless) {
        status = pvtFindBandReach(context, build, &reach);
    }
    if (status == PVT_OK && reach > 0.0) {
        build->band.isThin = true;
        pvtBuild_FreeSelection(context, build);
        status = TakeReach(context, build, reach);
        if (status == PVT_OK) {
            status = pvtSelectWithin(context, build);
        }
    }
    return status;
}
