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
} pvtLinks;

/// Room for polygons of up to `capacity` points.
pvtStatus pvtCreateLinks(pvtContext* context, size_t capacity, uint32_t longest, pvtLinks* links);
void pvtLinks_Free(pvtContext* context, pvtLinks* links);

/// Finds all links of a polygon of three points or more. False when it is not weakly simple.
bool pvtLinks_Build(pvtLinks* links, const pvtPoint2* points, size_t count);

#endif
