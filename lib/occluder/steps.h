// SPDX-License-Identifier: MIT
// The steps that a build is made of. Each reads what those before it left in the struct.
#ifndef PVT_OCCLUDER_STEPS_H
#define PVT_OCCLUDER_STEPS_H

#include "enough.h"
#include "inside.h"
#include "sheets.h"

enum { PVT_MOST_STARTS = 4 }; ///< of an ascent

/// How triangles are to lie around a surface that has no inside and is not flat. What that gives is
/// judged when it is made; should too much of what it hides be seen, the build begins again.
typedef struct pvtBandPlan {
    double reach;       ///< [wu] from the touched voxels; 0 before it is known
    double mostWrong;   ///< as pvtAscentOptions tells; 0 before one was not good enough
    int tries;          ///< that were not
    bool keepsClose;    ///< panels on the surface may not lie off it, as those beside an inside
    bool mayStray;      ///< there are none like that: they may lie off it, and it is told
    double sheetRecall; ///< 0 to 1: of panels on the surface instead, before they are refined
    bool isOff;         ///< none is good enough
    bool isBare;        ///< there is an inside, but not behind much of the surface
    bool isThin;        ///< there is one, but triangles strictly within it hide next to nothing
    int resolution;     ///< that nothing is inside at
    bool wantsAgain;    ///< another one is to be made
} pvtBandPlan;

/// What a build holds on its way; one place to free it.
typedef struct pvtBuild {
    const pvtBuildOptions* options;
    const pvtMesh* mesh;
    double started; ///< on pvtGetSeconds' clock
    pvtBuildStats stats;
    pvtBitGrid surface;
    pvtSolid solid;
    pvtBitGrid allowed;         ///< where polygons may lie
    pvtCellGrid cells;          ///< allowed parts of other voxels
    pvtTouching touching;       ///< the surface in these
    pvtInsideTest inside;       ///< of all three; only where the occluder ascends
    pvtSliceVolume volume;      ///< of `allowed`
    pvtSliceVolume solidVolume; ///< of the solid: what the paper's way slices
    pvtBox3 bounds;             ///< [wu] of the allowed voxels, and around sheets
    pvtBox3 allowedBounds;      ///< [wu] of the allowed voxels and cells
    pvtSlicer slicer;
    bool hasSlicer;
    pvtSectionSet sections;
    pvtSheetSet sheets;  ///< empty where the strict interior does
    double deviation;    ///< [vx] of the surface from them
    int triedDeviations; ///< of those that sheets are looked for with
    double sheetShare;   ///< of the surface without an inside behind it, that the best sheets take
    pvtBuildOptions ownOptions; ///< what `options` are where a band replaces them
    bool isBand;                ///< whether triangles lie within a band around the surface instead
    pvtBandPlan band;
    pvtBitGrid hiding; ///< the allowed voxels and those that the sheets pass; may have no words
    pvtCandidateSet candidates;
    pvtViewSet views;
    pvtOccluder occluder;              ///< before an ascent the polygons of all its starts
    size_t startEnds[PVT_MOST_STARTS]; ///< of these, where those of each start end
    int startCount;
    pvtOccluder flat; ///< selected for the budget alone, before the ascent; else empty
} pvtBuild;

typedef pvtStatus pvtBuildStep(pvtContext* context, pvtBuild* build);

pvtStatus pvtResolveSizes(pvtContext* context, pvtBuild* build);
pvtStatus pvtVoxelizeStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtFillStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtSheetStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtBandStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtSearchStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtChainStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtSelectStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtThinStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtRefineStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtAscendStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtBendStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtJudgeStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtCheckStep(pvtContext* context, pvtBuild* build);

/// What was selected, and what that was made of.
void pvtBuild_FreeSelection(pvtContext* context, pvtBuild* build);

/// From the voxels' size, the tolerance and the holes that close.
void pvtSetErrorBound(pvtBuildStats* stats);

enum { PVT_MEASURE_SIZE = 64 }; ///< [px] of the masks that the stats are measured on

/// PVT_NOTHING_INSIDE, with the options that would help.
pvtStatus pvtFailNothingInside(pvtContext* context, const pvtBuild* build);
/// [wu] Of the set voxels; false when there are none.
bool pvtFindVoxelBounds(const pvtBitGrid* grid, pvtBox3* bounds);
/// Makes the bounds hold the set voxels.
void pvtWidenBounds(const pvtBitGrid* grid, pvtBox3* bounds);
/// [wu³] The measure of a mesh in the build's views, which it needs.
pvtStatus pvtMeasureTriangles(pvtContext* context, const pvtBuild* build, const pvtMesh* mesh,
                              double* measure);
/// The measure of everything that may be covered, into the stats; needs the views.
pvtStatus pvtMeasureCeiling(pvtContext* context, pvtBuild* build);
static inline bool pvtIsPaper(const pvtBuild* build)
{
    return build->options->method == PVT_METHOD_PAPER;
}
/// How views are spread, with the build's own axis that is up.
static inline pvtViewOptions pvtGetViewOptions(const pvtBuild* build)
{
    pvtViewOptions views = build->options->views;
    views.up = (int)build->options->up;
    return views;
}
/// Whether triangles may leave the planes of their polygons.
bool pvtMayAscend(const pvtBuild* build);
/// Whether the measure tells which of two occluders is better: it grows with what sticks out as
/// well, or is seen below the edge of a landscape.
static inline bool pvtIsMeasured(const pvtBuild* build)
{
    return build->stats.tolerance == 0.0 && !build->options->terrain;
}
/// Whether panels lie on the surface only within a part of a voxel or more: what they hide besides
/// is nothing on flat walls.
bool pvtMayPanelsStray(const pvtBuild* build);
/// What of all that triangles hide may be wrong, as they climb within a band, 0 to 1; 0 elsewhere.
double pvtGetMostWrong(const pvtBuild* build);
/// How many triangles may at most, of the budget.
int pvtGetAscentBudget(const pvtBuild* build);
/// Where triangles may lie.
pvtInterior pvtGetInterior(const pvtBuild* build);
/// When the build's refinement is to end.
pvtEnough pvtGetEnough(const pvtBuild* build);
/// 1, or with --effort fast what is left of its time for refinement where there is much surface:
/// the stages before it take as much more.
double pvtGetTimeShare(const pvtBuild* build);
/// How many steps or sweeps there are: fewer for more triangles, so that the time stays about the
/// same.
static inline int pvtSpreadEffort(int count, int triangles)
{
    enum { FULL_BUDGET = 64 };
    return triangles <= FULL_BUDGET ? count : count * FULL_BUDGET / triangles;
}
/// Whether triangles may lie within a band around the surface, where it would help.
bool pvtMayUseBand(const pvtBuild* build);
/// Whether sheets have not been looked for yet as far from the surface as they may be.
bool pvtMayUseFartherSheets(const pvtBuild* build);
/// Looks for sheets farther from the surface than those that there are, in place of them.
pvtStatus pvtUseFartherSheets(pvtContext* context, pvtBuild* build);
/// Where there is no band: the sheets that were left for it to be tried before, and
/// PVT_NOTHING_INSIDE where there is no room at all.
pvtStatus pvtSheetStepWithoutBand(pvtContext* context, pvtBuild* build);
/// Whether a polygon may lie on the surface itself.
bool pvtMayUseSheets(const pvtBuild* build);
/// Adds chains on the sheets to the candidates.
pvtStatus pvtAddSheets(pvtContext* context, const pvtCandidateOptions* options, pvtBuild* build);
/// Polygons that lie on sheets, into the stats.
void pvtCountSurfacePanels(pvtBuild* build);
/// Checks what pvtCheckTriangles does not know of, and tells of panels on the surface. `outside` is
/// what that found, more than 0 for triangles that are to be looked at.
pvtStatus pvtCheckSheets(pvtContext* context, pvtBuild* build, const uint64_t* outside);
void pvtBuild_Free(pvtContext* context, pvtBuild* build);

#endif
