// SPDX-License-Identifier: MIT
// Polygons whose points all lie at cell corners, reduced to a few hundred points.
#ifndef PVT_SECTION_LATTICE_H
#define PVT_SECTION_LATTICE_H

#include "queue.h"

/// A point of the polygon and its place among the rows of bits.
typedef struct pvtLatticeNode {
    pvtPoint2 point;
    uint32_t before, after;
    uint32_t twinBefore, twinAfter; ///< the ring of those that are left at the same place
} pvtLatticeNode;

/// Work space for polygons of up to a number of points within a box.
typedef struct pvtLattice {
    uint32_t target; ///< points that are left when it is done, at least 3
    pvtLatticeNode* nodes;
    uint64_t* bits;     ///< places that hold a point, rows of wordsPerRow
    uint32_t* table;    ///< hash of a place → 1 + a node there; 0: none
    size_t tableSize;   ///< a power of two
    size_t wordsPerRow; ///< of the polygon at hand, as all that follows
    pvtPoint2 origin;
    int32_t unit;           ///< [point units] between places
    uint32_t count;         ///< points left
    const pvtBitmap* cells; ///< cells that the polygon must stay within, or null
    int32_t cellUnit;       ///< [point units] a cell of `cells`
    bool allowsPinch;
    pvtQueue queue;
} pvtLattice;

/// The widest spacing, 256, 128 or 64 point units, at which all points of a loop lie; else 0.
int32_t pvtFindLatticeUnit(const pvtPoint2* points, size_t count);

/// Room for each of the polygons that has more than `target` points and a lattice.
pvtStatus pvtCreateLattice(pvtContext* context, const pvtLoopSet* polygons, uint32_t target,
                           pvtLattice* lattice);
void pvtLattice_Free(pvtContext* context, pvtLattice* lattice);

/// Takes points out, those that cost least area first, until `target` are left. What is left,
/// lattice->count points, is written to `reduced` in order. More than `target` are left when the
/// polygon is not weakly simple.
pvtStatus pvtLattice_Reduce(pvtContext* context, pvtLattice* lattice, const pvtPoint2* points,
                            size_t count, pvtPoint2* reduced);

#endif
