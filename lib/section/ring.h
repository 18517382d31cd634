// SPDX-License-Identifier: MIT
// A polygon that points are taken out of and put into, small enough to look at every point each
// time: the coordinates lie side by side, so that the compiler compares several at once.
#ifndef PVT_SECTION_RING_H
#define PVT_SECTION_RING_H

#include "ear.h"

typedef struct pvtRingNode {
    pvtPoint2 point;
    uint32_t before, after;
    uint32_t lane; ///< where its coordinates lie in xs and ys
} pvtRingNode;

typedef struct pvtRing {
    pvtRingNode* nodes;       ///< those taken out keep what they were
    int32_t *xs, *ys;         ///< of the points in the ring
    int32_t *nextXs, *nextYs; ///< of the points behind them
    uint32_t* owners;         ///< lane → node
    uint32_t count;           ///< in the ring
    uint32_t nodeCount;       ///< ever in it
} pvtRing;

/// Room for `capacity` points in the ring at once, and for `nodeCapacity` ever.
pvtStatus pvtCreateRing(pvtContext* context, size_t capacity, size_t nodeCapacity, pvtRing* ring);
void pvtRing_Free(pvtContext* context, pvtRing* ring);
/// Nodes 0 to count − 1 are the points, in order.
void pvtRing_Reset(pvtRing* ring, const pvtPoint2* points, size_t count);
void pvtRing_Remove(pvtRing* ring, uint32_t node);
/// Returns the new node, which stands behind `node`.
uint32_t pvtRing_InsertAfter(pvtRing* ring, uint32_t node, pvtPoint2 point);
pvtPass pvtRing_GetPass(const pvtRing* ring, uint32_t node);
/// A point that keeps `node`, whose ear it is, from being taken out; UINT32_MAX when none does.
uint32_t pvtRing_FindBlocker(const pvtRing* ring, const pvtEar* ear, uint32_t node);
/// A point in the closed triangle that is not one of the four; UINT32_MAX when there is none.
uint32_t pvtRing_FindPoint(const pvtRing* ring, const pvtPoint2 corners[3],
                           const uint32_t except[4]);

/// An edge, by the node it begins at, that shares a point with the segment from a to b and does not
/// begin at one of the three; UINT32_MAX when there is none.
uint32_t pvtRing_FindEdge(const pvtRing* ring, pvtPoint2 a, pvtPoint2 b, const uint32_t except[3]);

#endif
