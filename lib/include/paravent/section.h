// SPDX-License-Identifier: MIT
// Planes through a grid, their slices, and the polygons and chains made of them
// (paper, sections 4.2 to 4.4).
#ifndef PARAVENT_SECTION_H
#define PARAVENT_SECTION_H

#include <paravent/voxel.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Fractional bits of a plane's coefficients, and of a polygon's coordinates.
enum { PVT_PLANE_BITS = 20, PVT_POINT_BITS = 8 };

/// A plane in grid coordinates g = (p − origin) / voxelSize, as a graph over its dominant axis:
/// g[axis] = offset + slopeU × g[u] + slopeV × g[v], all three fixed point with PVT_PLANE_BITS
/// fractional bits. The slopes lie in −1 to 1, so that a voxel column crosses at most three voxels.
/// (u, v) is (y, z) for axis x, (x, z) for axis y, (x, y) for axis z.
typedef struct pvtPlane {
    pvtAxis axis;
    int32_t slopeU, slopeV; ///< multiples of 16 when planned
    int64_t offset;         ///< odd when planned: then no cell centre lies on a voxel's face
} pvtPlane;

/// A position on a plane: (u, v) in grid coordinates with PVT_POINT_BITS fractional bits.
typedef struct pvtPoint2 {
    int32_t x, y;
} pvtPoint2;

/// The axes that u and v of a plane run along.
PVT_API pvtAxis pvtPlane_GetU(const pvtPlane* plane);
PVT_API pvtAxis pvtPlane_GetV(const pvtPlane* plane);
/// The point in the world [wu].
PVT_API pvtVec3 pvtPlane_ToWorld(const pvtPlane* plane, const pvtGridFrame* frame, pvtPoint2 point);
/// Unit normal in the world; its dominant coordinate is positive.
PVT_API pvtVec3 pvtPlane_GetNormal(const pvtPlane* plane);
/// The planned plane nearest to the one through `point` [wu] across `direction` (any length > 0).
/// Its axis is that of the direction's largest coordinate; the lowest axis of equals.
PVT_API pvtPlane pvtMakePlane(const pvtGridFrame* frame, pvtVec3 direction, pvtVec3 point);
/// True area [vx²] per unit area of (u, v): 1 / |normal[axis]|, 1 to √3.
PVT_API double pvtPlane_GetAreaScale(const pvtPlane* plane);

/// One bit a cell, rows along u. Bits past width are 0.
typedef struct pvtBitmap {
    uint64_t* words;
    int width, height; ///< [px]
    size_t wordsPerRow;
} pvtBitmap;

PVT_API pvtStatus pvtCreateBitmap(pvtContext* context, int width, int height, pvtBitmap* bitmap);
PVT_API void pvtBitmap_Free(pvtContext* context, pvtBitmap* bitmap);
/// False outside.
PVT_API bool pvtBitmap_Get(const pvtBitmap* bitmap, int x, int y);
PVT_API void pvtBitmap_Set(pvtBitmap* bitmap, int x, int y, bool value);
PVT_API uint64_t pvtBitmap_Count(const pvtBitmap* bitmap);

/// The words of a grid for planes over one axis: word w of the row along u at v and at position n
/// along the axis is words[(v × wordsPerRow + w) × stride + n], so that the few positions that 64
/// neighbouring cells of a slanted plane look at lie in one or two cache lines.
typedef struct pvtSliceColumns {
    uint64_t* words;
    int32_t (*ranges)[2]; ///< of column v × wordsPerRow + w: no word is set before [0], or from [1]
    size_t wordsPerRow;
    size_t stride; ///< [words] a column; those past the axis's size are 0, at least three
} pvtSliceColumns;

/// A grid made ready for slicing: its words in three more orders.
typedef struct pvtSliceVolume {
    const pvtBitGrid* grid; ///< borrowed
    pvtSliceColumns axes[3];
    const pvtCellGrid* cells;  ///< borrowed; null until pvtAddSliceCells
    pvtSliceColumns partly[3]; ///< of its voxels and those of the grid
} pvtSliceVolume;

/// Takes a little more than three times the grid's memory.
PVT_API pvtStatus pvtCreateSliceVolume(pvtContext* context, const pvtBitGrid* grid,
                                       pvtSliceVolume* volume);
PVT_API void pvtSliceVolume_Free(pvtContext* context, pvtSliceVolume* volume);
/// Adds finer voxels to those of the volume's grid, in the same frame, for pvtSliceCells. None of
/// them is set in that grid.
PVT_API pvtStatus pvtAddSliceCells(pvtContext* context, const pvtCellGrid* cells,
                                   pvtSliceVolume* volume);

/// What a cell says. Both are decided in exact integer arithmetic; voxels outside the grid count as
/// clear.
typedef enum pvtSliceRule {
    /// The voxel at the cell's centre is set. On a face between two voxels (which no planned plane
    /// meets) the upper one along the axis counts.
    PVT_SLICE_CENTER,
    /// Every voxel that the patch touches is set, the patch being the part of the plane over the
    /// cell: among the voxels of the cell's own column, those whose closed extent along the axis
    /// meets the patch's closed extent over the closed cell. A patch that just reaches a face
    /// touches the voxels on both sides of it. Neighbouring columns do not count, although the
    /// patch's border may run along their sides: the patches of neighbouring cells see to those, so
    /// that a region of covered cells lies in set voxels up to its own border.
    PVT_SLICE_COVERED,
} pvtSliceRule;

/// A slice has cellsPerVoxel (1, 2 or 4) cells a voxel: cell (i, j) covers u from i to i + 1 and
/// v from j to j + 1, in cells. The bitmap has size[u] × cellsPerVoxel by size[v] × cellsPerVoxel
/// cells and is created by the caller, so that it can be used again; all of it is overwritten.
PVT_API void pvtSliceGrid(const pvtSliceVolume* volume, const pvtPlane* plane, pvtSliceRule rule,
                          int cellsPerVoxel, pvtBitmap* slice);

/// Part of a plane [vx]: from lower to upper along u and v.
typedef struct pvtSliceWindow {
    int lower[2], upper[2];
} pvtSliceWindow;

/// PVT_SLICE_COVERED at PVT_CELLS cells a voxel, where a patch may also lie in the finer voxels
/// that pvtAddSliceCells brought, if all of their cells that it touches are set. What lies outside
/// of the window (null: there is none) may be left clear.
PVT_API void pvtSliceCells(const pvtSliceVolume* volume, const pvtPlane* plane, int cellsPerVoxel,
                           const pvtSliceWindow* window, pvtBitmap* slice);

/// The number of cells set, times pvtPlane_GetAreaScale, over cellsPerVoxel²: the true area [vx²].
PVT_API double pvtMeasureSlice(const pvtBitmap* slice, const pvtPlane* plane, int cellsPerVoxel);

/// A place where centre slices are made other than pvtSliceGrid, such as a GPU. `slice` is called
/// from one thread, and fills a bitmap as pvtSliceGrid does with PVT_SLICE_CENTER.
typedef struct pvtSlicer {
    pvtStatus (*slice)(pvtContext* context, void* user, const pvtPlane* plane, int cellsPerVoxel,
                       pvtBitmap* slice);
    void* user;
} pvtSlicer;

/// Depths are measured along a plane's dominant axis, as offsets are. Near duplicates among the
/// directions (within 2°) are dropped: faces come first, then axes, face diagonals, and the rest.
typedef struct pvtPlanOptions {
    int directions;    ///< 0 to 4096 spread evenly between the others; default 32
    bool axes;         ///< the three axes and the six face diagonals too; default true
    int depths;        ///< 1 to 256: most depth bins a direction, and no more than its extent has
                       ///< voxels, begun ones included; default 24
    int samplesPerBin; ///< 1 to 64: most planes tried in each bin, one a voxel at most; across
                       ///< axes and face directions it is 64, so that no wall falls between two
                       ///< planes; default 8, which finds 99 % of the area that 64 do
    double outermost;  ///< > 0: axes and face directions get an extra bin at both ends, of a few
                       ///< planes between half a voxel below the outermost extent and the depth
                       ///< below which a half-space's slices are whole, all times this; default 1
    const pvtFaceDirectionSet* faces; ///< may be null; borrowed; default null
} pvtPlanOptions;

/// Planes in bins: bin b holds planes binStarts[b] to binStarts[b + 1] − 1.
typedef struct pvtSectionPlan {
    pvtPlane* planes;
    size_t planeCount;
    size_t* binStarts; ///< binCount + 1
    size_t binCount;
} pvtSectionPlan;

PVT_API pvtPlanOptions pvtDefaultPlanOptions(void);

/// Bins over direction × depth within the exact extents of the set voxels of `grid`. A plan without
/// any plane is not an error: the grid was empty. There are at most directions × depths ×
/// samplesPerBin planes, and for each axis and face direction as many as its extent has voxels (but
/// depths × 64 at most) and 12 more: about 13,000 with the defaults on a grid of 256 voxels.
PVT_API pvtStatus pvtPlanSections(pvtContext* context, const pvtPlanOptions* options,
                                  const pvtBitGrid* grid, pvtSectionPlan* plan);
PVT_API void pvtSectionPlan_Free(pvtContext* context, pvtSectionPlan* plan);

typedef struct pvtSearchOptions {
    pvtSliceRule rule;       ///< of the areas that come out; default PVT_SLICE_COVERED
    int cellsPerVoxel;       ///< 1, 2 or 4, of the areas that come out; default 1
    const pvtSlicer* slicer; ///< null: pvtSliceGrid; borrowed; default null
} pvtSearchOptions;

/// A plane worth keeping. Its bitmap is not stored: at the finest grids thousands of them would
/// fill the memory, and pvtSliceGrid makes one again in far less time than its contours take.
typedef struct pvtSection {
    pvtPlane plane;
    double area; ///< [vx²] of the slice by options->rule at options->cellsPerVoxel, above 0
} pvtSection;

/// The best section of each bin that has any, in the plan's order.
typedef struct pvtSectionSet {
    pvtSection* sections;
    size_t count;
    pvtSliceRule rule; ///< of the areas
    int cellsPerVoxel; ///< of the areas
} pvtSectionSet;

PVT_API pvtSearchOptions pvtDefaultSearchOptions(void);

/// Slices every plane of the plan by PVT_SLICE_CENTER at one cell a voxel, in the slicer if there
/// is one, then those that may be a bin's largest by options->rule and options->cellsPerVoxel:
/// keeps the largest of each bin (ties: the first in the plan), unless its area is 0.
PVT_API pvtStatus pvtSearchSections(pvtContext* context, const pvtSearchOptions* options,
                                    const pvtSliceVolume* volume, const pvtSectionPlan* plan,
                                    pvtSectionSet* set);
PVT_API void pvtSectionSet_Free(pvtContext* context, pvtSectionSet* set);

/// Closed loops of points, one behind the other. Loop l holds points starts[l] to
/// starts[l + 1] − 1. parents[l] is −1 for an outer loop, which runs counter-clockwise (positive
/// area), or the outer loop around a hole, which runs clockwise.
typedef struct pvtLoopSet {
    pvtPoint2* points;
    size_t pointCount;
    size_t* starts; ///< loopCount + 1
    int32_t* parents;
    size_t loopCount;
} pvtLoopSet;

PVT_API void pvtLoopSet_Free(pvtContext* context, pvtLoopSet* set);
/// Twice the signed area of a loop, in squared point units; exact.
PVT_API int64_t pvtGetLoopArea2(const pvtPoint2* points, size_t count);

/// Loops along the edges between set and clear cells, set cells on the left, points at cell corners
/// where the loop turns. Where two set cells meet in a corner only, the loops stay apart: each
/// turns so as to keep to its own cell. Sum of areas = number of set cells.
PVT_API pvtStatus pvtTraceContours(pvtContext* context, const pvtBitmap* slice, int cellsPerVoxel,
                                   pvtLoopSet* contours);

/// Ramer–Douglas–Peucker on closed loops. A chord is refused when it leaves `guard`, or would
/// cross another edge of any loop.
typedef struct pvtSimplifyOptions {
    double tolerance;       ///< [vx] in the plane, ≥ 0; default 1
    const pvtPlane* plane;  ///< for true distances; null: distances in (u, v)
    const pvtBitmap* guard; ///< cells that loops must stay within; null: anywhere; borrowed
    int cellsPerVoxel;      ///< of guard
} pvtSimplifyOptions;

PVT_API pvtSimplifyOptions pvtDefaultSimplifyOptions(void);
PVT_API pvtStatus pvtSimplifyContours(pvtContext* context, const pvtSimplifyOptions* options,
                                      const pvtLoopSet* contours, pvtLoopSet* simplified);

/// Joins each hole to the loop around it by the shortest bridge that crosses nothing: one weakly
/// simple polygon for each outer loop. No loop of `polygons` is a hole.
PVT_API pvtStatus pvtBridgeHoles(pvtContext* context, const pvtLoopSet* contours,
                                 pvtLoopSet* polygons);

typedef struct pvtChainOptions {
    int maxTriangles; ///< ≥ 1: longer links are not kept; default 64
    double minArea;   ///< [vx²] in (u, v): polygons smaller than this are skipped; default 1
    const pvtBitmap* allowed; ///< the cells of the original polygon's slice, or more; null: the
                              ///< polygon only ever shrinks; borrowed; default null
    int cellsPerVoxel;        ///< of allowed: 1, 2 or 4; default 1
} pvtChainOptions;

/// Chains, one polygon each: points starts[c] to starts[c + 1] − 1. The link of t triangles is made
/// of the points with ranks[i] ≤ t + 2 ≤ limits[i], in order. A chain's longest link is its polygon
/// simplified to maxTriangles or fewer.
typedef struct pvtChainSet {
    pvtPoint2* points;
    uint32_t* ranks;  ///< one a point: least number of points of the links that have it
    uint32_t* limits; ///< and the greatest; UINT32_MAX for the points of the longest link
    size_t pointCount;
    size_t* starts; ///< count + 1
    size_t count;
} pvtChainSet;

PVT_API pvtChainOptions pvtDefaultChainOptions(void);

/// From each polygon down to one triangle (paper, section 4.4). Each step takes out the point whose
/// triangle with its neighbours has the least area, or an edge whose neighbours are lengthened
/// until they meet, if that costs less; what adds area within the allowed cells goes before what
/// costs any. In short links points may slide, too, to where the area is greater. Every link is
/// weakly simple, and within the allowed cells if the polygon was; where allowed is null, each lies
/// within the one before. Polygons that are not weakly simple are skipped.
PVT_API pvtStatus pvtBuildChains(pvtContext* context, const pvtChainOptions* options,
                                 const pvtLoopSet* polygons, pvtChainSet* chains);
PVT_API void pvtChainSet_Free(pvtContext* context, pvtChainSet* chains);

/// Copies the points of a link of `chain` with `triangles` triangles; returns their number, at most
/// triangles + 2. `points` has room for that.
PVT_API size_t pvtChainSet_GetLink(const pvtChainSet* chains, size_t chain, int triangles,
                                   pvtPoint2* points);

/// Triangulates a weakly simple counter-clockwise polygon of count ≥ 3 points into count − 2
/// counter-clockwise triangles by ear clipping, exact. `indices` has room for 3 × (count − 2).
/// Ears with the greatest least angle go first; a triangle without area only comes of points that
/// no other can have. PVT_INVALID_ARGUMENT when no ear is left: the polygon crosses itself.
PVT_API pvtStatus pvtTriangulatePolygon(pvtContext* context, const pvtPoint2* points, size_t count,
                                        uint32_t* indices);

#ifdef __cplusplus
}
#endif
#endif
