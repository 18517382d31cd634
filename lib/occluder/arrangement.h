// SPDX-License-Identifier: MIT
// An occluder under refinement: polygons, what each hides from every view, and what a change to one
// or two of them would gain. Only views and rows that a change touches are evaluated again.
#ifndef PVT_OCCLUDER_ARRANGEMENT_H
#define PVT_OCCLUDER_ARRANGEMENT_H

#include "fit.h"
#include "scorer.h"
#include "sheets.h"

#include <paravent/occluder.h>

/// A polygon on a plane, simple and counter-clockwise in (u, v).
typedef struct pvtPanel {
    pvtPlane plane;
    int count; ///< of points; 0: none
    pvtPoint2 points[PVT_MAX_FIT_POINTS];
} pvtPanel;

/// A panel in its place, with what it hides.
typedef struct pvtPlacedPanel {
    pvtPanel panel;
    uint64_t* masks; ///< wordCount words a mask of the scorer
    pvtBitmap cells; ///< where its plane is allowed
} pvtPlacedPanel;

typedef struct pvtArrangement {
    pvtScorer scorer;
    const pvtSliceVolume* volume;
    const pvtSheetSet* sheets; ///< may be null; borrowed
    int cellsPerVoxel;
    pvtPlacedPanel* panels; ///< capacity; those with a count of 0 are free
    int capacity;
    int triangles;    ///< in all panels
    uint64_t* layers; ///< three a mask: pixels covered at least once, twice, three times
    pvtScoredMaskSet covered;
    double value; ///< Σ factor × sum
} pvtArrangement;

/// Up to two panels are replaced; a count of 0 takes one away.
typedef struct pvtChange {
    int count;
    int slots[2];
    pvtPanel panels[2];
    double value; ///< what the arrangement would be worth
} pvtChange;

pvtStatus pvtCreateArrangement(pvtContext* context, const pvtScorerOptions* options,
                               const pvtSliceVolume* volume, int capacity,
                               pvtArrangement* arrangement);
void pvtArrangement_Free(pvtContext* context, pvtArrangement* arrangement);

/// Panels may lie on sheets too, from now on; to be called before any is placed.
void pvtUseSheets(pvtArrangement* arrangement, const pvtSheetSet* sheets);

/// The bitmap of a plane's allowed cells, made anew when its size differs. Cells outside of the
/// window (null: there is none) may be clear.
pvtStatus pvtSliceAllowed(pvtContext* context, const pvtArrangement* arrangement,
                          const pvtPlane* plane, const pvtSliceWindow* window, pvtBitmap* cells);

/// Sets change->value. Safe on any thread as long as nothing is applied meanwhile.
void pvtEvaluateChange(const pvtArrangement* arrangement, pvtChange* change);
/// Makes the change, which fits.
pvtStatus pvtApplyChange(pvtContext* context, pvtArrangement* arrangement, const pvtChange* change);

#endif
