// SPDX-License-Identifier: MIT
// Bands around a surface that triangles may lie in: what the files share that choose, use and judge
// them.
#ifndef PVT_OCCLUDER_BANDS_H
#define PVT_OCCLUDER_BANDS_H

#include "steps.h"

#include <paravent/evaluate.h>

enum {
    PVT_BAND_COUNT = 7,        ///< widths, numbered from the narrowest
    PVT_BAND_STEP = 2,         ///< from one that is looked for to the next
    PVT_BAND_RESOLUTION = 256, ///< [vx] along the longest side, that widths are given at
};

/// [wu] How far a band reaches from the touched voxels, in the build's resolution.
double pvtGetBandReach(const pvtBuild* build, int number);

/// What looks like a landscape may have an inside in a few folds, which counts as none.
bool pvtHasNoInside(const pvtBuild* build);
/// Whether there is no inside behind much of the surface: a buoy's hull is open below, though its
/// lamp is not.
bool pvtIsOpen(const pvtBuild* build);

/// The same solid with room for a band around it, and for a voxel more: what lies beyond a grid is
/// not known to be outside of the band.
pvtStatus pvtPadSolid(pvtContext* context, const pvtSolid* solid, double reach, pvtSolid* padded);
/// Lets triangles lie in the touched voxels of `solid` and within `reach` [wu] of them.
pvtStatus pvtAllowBand(pvtContext* context, const pvtSolid* solid, double reach, pvtBuild* build);
/// The steps from the allowed voxels to a selection.
pvtStatus pvtSelectWithin(pvtContext* context, pvtBuild* build);

/// The sheets that hide most, where the surface is flat enough for any, and whether they hide
/// enough. The plan tells their recall.
pvtStatus pvtChooseSheets(pvtContext* context, pvtBuild* build, bool* areEnough);
/// The narrowest band that is wide enough, or the widest; 0 where it would close gaps. With an
/// error that was asked for only whether there may be one.
pvtStatus pvtFindBandReach(pvtContext* context, const pvtBuild* build, double* reach);

/// What `occluder` hides of what the mesh does, and besides, from where it is looked at. Where that
/// is all around, and it is no trial, it is what pvtEvaluateOccluders tells by default.
pvtStatus pvtScoreOccluder(pvtContext* context, const pvtBuild* build, const pvtMesh* occluder,
                           bool isTrial, pvtQuadScore* score);

#endif
