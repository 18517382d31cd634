// SPDX-License-Identifier: MIT
// Planes that the surface itself lies on, nearly. What a polygon within such a part of a plane
// hides, the surface hides too: there needs to be no inside behind it. So walls of one polygon and
// tents have occluders as well.
#ifndef PVT_OCCLUDER_SHEETS_H
#define PVT_OCCLUDER_SHEETS_H

#include <paravent/occluder.h>

/// A plane, and its cells that the surface covers wholly.
typedef struct pvtSheet {
    pvtPlane plane;
    pvtBitmap cells; ///< a part of the plane's; bit (0, 0) is its cell (corner[0], corner[1])
    int corner[2];   ///< corner[0] is a multiple of 64
    double area;     ///< [vx²] true area of the cells that are set
    double gain;     ///< [vx²] of bare surface that it covers and no sheet before it does
} pvtSheet;

typedef struct pvtSheetSet {
    pvtSheet* sheets;
    size_t count;
    int cellsPerVoxel; ///< of all sheets: 1, 2 or 4
    double area;       ///< [vx²] of the surface
    double bare;       ///< [vx²] of it that has no strict interior behind it
} pvtSheetSet;

typedef struct pvtSheetOptions {
    double deviation; ///< [vx] of the surface from the plane, along its axis, at most
    int maxCount;     ///< of sheets
    uint64_t seed;
    /// Strict interior, whose surface needs no sheets; may be null; borrowed.
    const pvtBitGrid* allowed;
} pvtSheetOptions;

/// Finds planes with much of the surface near them, where no set voxel is close behind. The set is
/// empty when there is next to no such surface.
pvtStatus pvtFindSheets(pvtContext* context, const pvtSheetOptions* options, const pvtMesh* mesh,
                        const pvtGridFrame* frame, pvtSheetSet* set);
void pvtSheetSet_Free(pvtContext* context, pvtSheetSet* set);

/// A copy of `grid` with the voxels that the sheets pass.
pvtStatus pvtMarkSheets(pvtContext* context, const pvtSheetSet* set, const pvtBitGrid* grid,
                        pvtBitGrid* marked);

/// The sheet with exactly this plane; null when there is none.
const pvtSheet* pvtSheetSet_Find(const pvtSheetSet* set, const pvtPlane* plane);

/// Sets the cells of the plane's sheet, if it has one, in a slice of at least as many cells a
/// voxel as the sheets have.
void pvtAddSheetCells(const pvtSheetSet* set, const pvtPlane* plane, int cellsPerVoxel,
                      pvtBitmap* slice);

/// Appends chains on the sheets to `candidates`, which may be empty but has a frame.
pvtStatus pvtAddSheetCandidates(pvtContext* context, const pvtCandidateOptions* options,
                                const pvtSliceVolume* volume, const pvtSheetSet* sheets,
                                pvtCandidateSet* candidates);

/// Moves the corners of polygons on sheets outwards, to where the surface within `deviation` [vx]
/// ends, and takes away those of notches that it fills: triangles become fewer. Polygons on meshes
/// of very many triangles stay as they are: their sheets are pieces of what is curved.
pvtStatus pvtGrowSheetPanels(pvtContext* context, const pvtSheetSet* sheets, double deviation,
                             const pvtMesh* mesh, pvtOccluder* occluder);

#endif
