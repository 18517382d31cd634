// SPDX-License-Identifier: MIT
// The last part of a chain: from a few hundred points to three, each step a link.
#ifndef PVT_SECTION_LINKS_H
#define PVT_SECTION_LINKS_H

#include "queue.h"
#include "ring.h"

/// Which links a point belongs to, and which point follows it in them.
typedef struct pvtLinkNode {
    uint32_t rank, limit; ///< least and greatest number of points of the links that have it
    uint32_t behind;      ///< the next node of any link; UINT32_MAX at the end
} pvtLinkNode;

/// Below this many points they slide after each step.
enum { PVT_SLIDE_POINTS = 12 };

/// Nodes that a polygon of `count` points may come to have: its own points, those where edges meet,
/// and those that points slide to.
static inline size_t pvtGetLinkNodeLimit(size_t count)
{
    return 2 * count + 3 * (count < PVT_SLIDE_POINTS ? count : PVT_SLIDE_POINTS);
}

/// Work space for one polygon after the other. Step 2n takes out node n; step 2n + 1 takes out the
/// edge from node n on, whose neighbours are lengthened until they meet.
typedef struct pvtLinks {
    uint32_t longest; ///< points of the longest link that is kept, at least 3
    pvtRing ring;
    pvtQueue queue;
    pvtLinkNode* nodes;     ///< as the ring's
    pvtPoint2* meetings;    ///< where the neighbours of node n's edge meet
    uint32_t first;         ///< of the nodes that belong to links; UINT32_MAX: none yet
    const pvtBitmap* cells; ///< cells that the polygon must stay within, or null
    int32_t cellUnit;       ///< [point units] a cell of `cells`
    bool allowsPinch;
    size_t slidesLeft;
} pvtLinks;

/// Room for polygons of up to `capacity` points.
pvtStatus pvtCreateLinks(pvtContext* context, size_t capacity, uint32_t longest, pvtLinks* links);
void pvtLinks_Free(pvtContext* context, pvtLinks* links);

/// True when a triangle may be added to the polygon.
bool pvtLinks_IsCovered(const pvtLinks* links, pvtPoint2 a, pvtPoint2 b, pvtPoint2 c);
/// A point in the closed triangle that is not of the way, or that is one of `others`; UINT32_MAX
/// when there is none, or when the triangle has no area. Corners counter-clockwise.
uint32_t pvtLinks_FindPoint(const pvtLinks* links, const pvtPoint2 corners[3],
                            const uint32_t way[4], const uint32_t others[2]);
/// True when an edge that begins or ends at `end`, a corner, runs into the triangle.
bool pvtLinks_RunsIn(const pvtLinks* links, const pvtPoint2 corners[3], uint32_t end);
/// Takes a point out of the ring, and out of all links of fewer than `rank` points.
void pvtLinks_TakeOut(pvtLinks* links, uint32_t node, uint32_t rank);
/// Puts a point into the ring behind `node`, and into all links of up to `limit` points; `behind`
/// is the node that it follows in the order of links.
uint32_t pvtLinks_PutIn(pvtLinks* links, uint32_t node, pvtPoint2 point, uint32_t limit,
                        uint32_t behind);

/// Slides `node` to where the polygon's area is greater: to a point that was taken out between it
/// and a neighbour. Returns the node that stands there, or UINT32_MAX.
uint32_t pvtLinks_Slide(pvtLinks* links, uint32_t node);

/// Finds all links of a polygon of three points or more. More than three points are left in the
/// ring when it is not weakly simple.
pvtStatus pvtLinks_Build(pvtContext* context, pvtLinks* links, const pvtPoint2* points,
                         size_t count);

#endif
