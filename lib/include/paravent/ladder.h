// SPDX-License-Identifier: MIT
// Levels of detail: occluders of one mesh from fine to coarse, each with its own error bound, and
// from where on each may stand for the mesh (paper, figure 5: openings close as voxels grow).
#ifndef PARAVENT_LADDER_H
#define PARAVENT_LADDER_H

#include <paravent/occluder.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { PVT_MAX_LEVELS = 8 };

/// How errors look on a screen. The camera is a pinhole with square pixels.
typedef struct pvtScreenOptions {
    double pixelError;  ///< [px] > 0: the thickest error that a level may show; default 1
    double fieldOfView; ///< [degrees] above 0, below 180: from the lower to the upper edge; default
                        ///< 60
    int height;         ///< [px] 1 to 65536; default 1080
    int width;          ///< [px] 0 to 65536; 0: 16/9 of the height; default 0. It matters for the
                        ///< screen coverage only, which is a part of the screen's area
} pvtScreenOptions;

typedef struct pvtLadderOptions {
    /// What all levels share. `resolution` is of the finest level, and only when its error is 0;
    /// `tolerance` is of the finest level; `budget`, `error` and `deadline` are not looked at.
    /// isEnough is asked in every level, and ends the refinement of that one.
    pvtBuildOptions build;
    pvtLength coarseTolerance; ///< of all levels but the finest; default 1 voxel
    int levelCount;            ///< 1 to PVT_MAX_LEVELS; default 4
    /// [wu] Error bounds, each above the one before. The first is 0 for the defaults: what
    /// build.resolution reaches, then always twice the error before.
    double errors[PVT_MAX_LEVELS];
    /// 1 to 65535 triangles, each below the one before. The first is 0 for the defaults: 64, 32,
    /// 16, 8; always half of the budget before, and at least 4 at the coarsest level.
    int budgets[PVT_MAX_LEVELS];
    pvtScreenOptions screen;
} pvtLadderOptions;

typedef struct pvtLevel {
    int number; ///< of the level that was asked for, from 0 for the finest
    int budget; ///< triangles
    pvtOccluder occluder;
    pvtBuildStats stats;   ///< with the error bound and the voxel size
    double distance;       ///< [wu] from the ladder's center: from here on the level shows no error
                           ///< thicker than the pixel error
    double screenCoverage; ///< of the ladder's sphere at this distance: up to here it may be used
} pvtLevel;

/// Error bounds grow, and triangles fall, from level to level.
typedef struct pvtLadder {
    pvtLevel* levels; ///< from fine to coarse
    size_t count;
    /// [wu] The sphere around the box around the finest level: what engines take for the object's
    /// size.
    pvtVec3 center;
    double radius;
} pvtLadder;

PVT_API pvtScreenOptions pvtDefaultScreenOptions(void);
PVT_API pvtLadderOptions pvtDefaultLadderOptions(void);

/// One build a level. A level but the finest that cannot be had (nothing is inside, no fewer
/// triangles than the one before, no larger error since the voxels are as large as they get) is
/// left out with a warning that names it. What else keeps a level from being built fails as a
/// whole, and so does the finest; the message names the level. PVT_INVALID_ARGUMENT names the
/// option.
PVT_API pvtStatus pvtBuildLadder(pvtContext* context, const pvtLadderOptions* options,
                                 const pvtMesh* mesh, pvtLadder* ladder);
PVT_API void pvtLadder_Free(pvtContext* context, pvtLadder* ladder);

/// [wu] How far a camera must be from the center of a sphere of radius `reach`, which holds the
/// mesh, so that an error of `error` [wu] shows no thicker than screen->pixelError, wherever on
/// the screen, when the camera looks at the center.
PVT_API double pvtGetErrorDistance(const pvtScreenOptions* screen, double error, double reach);

/// The part of the screen's area that a sphere covers as Babylon.js reckons it, at most 1:
/// π (radius ÷ distance)² over the area that the screen has at distance 1.
PVT_API double pvtGetScreenCoverage(const pvtScreenOptions* screen, double radius, double distance);

#ifdef __cplusplus
}
#endif
#endif
