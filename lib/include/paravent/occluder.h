// SPDX-License-Identifier: MIT
// From a mesh to an occluder: candidates, selection under a budget, and the driver
// (paper, section 4.5).
#ifndef PARAVENT_OCCLUDER_H
#define PARAVENT_OCCLUDER_H

#include <paravent/occlusion.h>
#include <paravent/section.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A length in world units or in voxels.
typedef struct pvtLength {
    double value;
    bool inVoxels;
} pvtLength;

/// Polygons on planes of one grid, and the triangles they make. Polygon p lies on planes[p] and is
/// loop p of `loops`; no loop is a hole. Triangles face the side that the plane's normal points to.
/// pvtBuildOccluder moves the triangles' corners on from there, out of the planes, when it refines:
/// then `mesh` is the occluder, and the polygons are what it began as.
typedef struct pvtOccluder {
    pvtGridFrame frame;
    pvtPlane* planes; ///< loops.loopCount
    pvtLoopSet loops;
    pvtMesh mesh;   ///< positions are rounded to float, as files store them
    double measure; ///< [wu³] total occlusion measure
} pvtOccluder;

PVT_API void pvtOccluder_Free(pvtContext* context, pvtOccluder* occluder);

typedef enum pvtMethod {
    PVT_METHOD_PLANAR, ///< chain levels by gain per triangle
    PVT_METHOD_PAPER,  ///< whole polygons by gain, then single steps back down to the budget
} pvtMethod;

/// Chains of candidate polygons: chain c lies on planes[c] of the grid with this frame.
typedef struct pvtCandidateSet {
    pvtChainSet chains;
    pvtPlane* planes;   ///< chains.count
    int32_t* triangles; ///< chains.count: of each chain's longest link
    pvtGridFrame frame;
} pvtCandidateSet;

typedef struct pvtCandidateOptions {
    pvtSliceRule rule;       ///< of the slices that contours are traced on; default COVERED
    int cellsPerVoxel;       ///< 1, 2 or 4; default 1
    const pvtSlicer* slicer; ///< makes CENTER slices; null: pvtSliceGrid; borrowed; default null
    double simplification;   ///< [vx] tolerance of Ramer–Douglas–Peucker; 0: none; default 0
    const pvtSliceVolume* guard; ///< whose COVERED cells a simplification may not leave; borrowed;
                                 ///< null: the contours' own cells
    int maxTriangles;            ///< longest link that is kept; default 64
    double minArea; ///< polygons below this part of the largest slice's area are dropped;
                    ///< default 0.002
} pvtCandidateOptions;

PVT_API pvtCandidateOptions pvtDefaultCandidateOptions(void);

/// Sections to chains: contours, bridges, simplification and chains of every section, in order.
PVT_API pvtStatus pvtBuildCandidates(pvtContext* context, const pvtCandidateOptions* options,
                                     const pvtSliceVolume* volume, const pvtSectionSet* sections,
                                     pvtCandidateSet* candidates);
PVT_API void pvtCandidateSet_Free(pvtContext* context, pvtCandidateSet* set);

/// How many triangles of each candidate are taken; 0: none.
typedef struct pvtCut {
    int32_t* triangles; ///< one a candidate
    size_t count;
    int32_t* ample; ///< the same with a surplus of triangles; null without one
} pvtCut;

PVT_API void pvtCut_Free(pvtContext* context, pvtCut* cut);

typedef struct pvtSelectOptions {
    int budget;              ///< 1 to 65535 triangles; default 64
    const pvtViewSet* views; ///< borrowed
    pvtBox3 bounds;          ///< [wu] what the masks span
    double completion;       ///< paper's α as a fraction: stop when a polygon gains less; default
                             ///< 0.01; used by pvtReduceOccluder only
    int surplus; ///< triangles beyond the budget that the cut's `ample` takes; default 0;
                 ///< used by pvtSelectOccluder only
} pvtSelectOptions;

PVT_API pvtSelectOptions pvtDefaultSelectOptions(void);

/// Adds chain levels one after the other, each time the one that gains most of the measure per
/// triangle, as long as the budget allows. With a surplus it goes on from there for cut->ample.
PVT_API pvtStatus pvtSelectOccluder(pvtContext* context, const pvtSelectOptions* options,
                                    const pvtCandidateSet* candidates, pvtCut* cut);

/// The paper's way: adds whole polygons by the measure until one gains less than `completion`, then
/// takes single chain steps back, each losing the least area, until the budget holds.
PVT_API pvtStatus pvtReduceOccluder(pvtContext* context, const pvtSelectOptions* options,
                                    const pvtCandidateSet* candidates, pvtCut* cut);

/// The polygons that a cut takes.
PVT_API pvtStatus pvtTakeCut(pvtContext* context, const pvtCandidateSet* candidates,
                             const pvtCut* cut, pvtOccluder* occluder);

/// Where triangles may lie: in allowed voxels, in allowed cells of others, and, where the surface
/// is known, in border cells as far as that.
typedef struct pvtInterior {
    const pvtBitGrid* allowed;   ///< borrowed
    const pvtCellGrid* cells;    ///< borrowed; may be null
    const pvtTouching* touching; ///< of `cells`; borrowed; null: border cells are outside
} pvtInterior;

/// Every triangle of the occluder against the interior, exactly, by code that the optimizer does
/// not share: `*outside` is the number of voxels in which some triangle is where it may not be, by
/// more than 1/1024 voxel, or cell, in voxels that have cells. In border cells that is where it
/// crosses a triangle of the surface. A triangle that is nowhere in what is allowed counts as well,
/// for nothing tells which side of the surface it is on.
PVT_API pvtStatus pvtCheckOccluder(pvtContext* context, const pvtInterior* interior,
                                   const pvtMesh* occluder, uint64_t* outside);

/// How close to a surface something lies on it.
typedef struct pvtSurfaceReach {
    double distance; ///< [wu] from the occluder's plane, along that axis
    double slack;    ///< [wu] what is nowhere wider than this is not looked at
} pvtSurfaceReach;

/// What is left of the occluder's triangles without those parts that `surface` covers, seen along
/// the axis that their normal is nearest to, with what of it is within reach->distance: no
/// triangles when the occluder lies on the surface. By code that the optimizer does not share.
PVT_API pvtStatus pvtTakeOffSurface(pvtContext* context, const pvtSurfaceReach* reach,
                                    const pvtMesh* surface, const pvtMesh* occluder, pvtMesh* rest);

/// How long the refinement may go on: changes of thousands, of tens and of hundreds of thousands.
typedef enum pvtEffort { PVT_EFFORT_FAST, PVT_EFFORT_DEFAULT, PVT_EFFORT_BEST } pvtEffort;

typedef struct pvtBuildOptions {
    int budget;             ///< 1 to 65535 triangles; default 64
    int resolution;         ///< [vx] 8 to 2048 along the longest side; default 256
    double error;           ///< [wu] > 0: sets the voxel size instead of resolution; default 0
    pvtLength tolerance;    ///< ≥ 0: how far a polygon may leave the strict interior; default 0
    pvtLength smallestHole; ///< ≥ 0: narrower openings count as closed; default 0
    bool ground, terrain;   ///< see pvtSolidOptions; default false
    pvtAxis up;             ///< default y
    int enclosed;           ///< see pvtSolidOptions; default −1
    pvtMethod method;       ///< default PVT_METHOD_PLANAR
    pvtEffort effort;       ///< default PVT_EFFORT_DEFAULT; the paper's way takes no notice of it
    pvtViewOptions views;   ///< what to optimise for; `up` follows the field above
    uint64_t seed;          ///< default 1
    double deadline; ///< [s] > 0: when so much time has passed since the start, refinement ends
                     ///< with the best so far, which then depends on the machine; default 0
    /// Null: never. Asked now and then from the first selected polygons on, by the thread that
    /// builds (with pvtBuildSeparateOccluders by several at once); true ends refinement as the
    /// deadline does. For a button that says enough: cancelling leaves nothing.
    pvtCancelFcn* isEnough;
    void* enoughUser; ///< handed to isEnough
    /// Null: slices are made on the CPU. Else called once the voxel mesh is there, to make the
    /// slicer that the build uses; `release` ends it.
    pvtStatus (*createSlicer)(pvtContext* context, void* user, const pvtGridFrame* frame,
                              const pvtMesh* voxelMesh, pvtSlicer* slicer);
    void (*releaseSlicer)(pvtContext* context, void* user, pvtSlicer* slicer);
    void* slicerUser;
} pvtBuildOptions;

/// What a build can tell about itself.
typedef struct pvtBuildStats {
    int resolution;   ///< [vx] along the longest side, as used
    double voxelSize; ///< [wu]
    double tolerance; ///< [wu] as asked for; or how far triangles may stray from a surface that is
                      ///< not flat and has no inside, or none that would hide anything, which is
                      ///< told by a warning
    double smallestHole;   ///< [wu]
    double errorBound;     ///< [wu] √3 voxels + max(tolerance, smallestHole / 2): no ray that the
                           ///< occluder blocks passes the original farther away than this
    int surfacePanels;     ///< polygons that lie on the surface itself: there is no inside
    double deviation;      ///< [wu] how far these may lie from it; 0 when there are none
    double insideFraction; ///< of the bounds that is strictly inside
    double measure;        ///< [wu³] of the occluder
    double measureOfSolid; ///< [wu³] of everything that may be covered: the ceiling
    uint64_t outside;      ///< what pvtCheckOccluder found
    size_t candidateCount;
    double suggestedHole; ///< [wu] 0 unless the solid came out hollow and this would fill it
    struct {
        double voxelize, solid, sections, chains, select, refine, check, total;
    } seconds;
} pvtBuildStats;

PVT_API pvtBuildOptions pvtDefaultBuildOptions(void);

/// The whole of it, from triangles to an occluder of at most options->budget triangles. Fills
/// `stats` (may be null) as far as it came, also on failure. PVT_NOTHING_INSIDE names the options
/// that would help.
PVT_API pvtStatus pvtBuildOccluder(pvtContext* context, const pvtBuildOptions* options,
                                   const pvtMesh* mesh, pvtOccluder* occluder,
                                   pvtBuildStats* stats);

#ifdef __cplusplus
}
#endif
#endif
