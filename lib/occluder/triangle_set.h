// SPDX-License-Identifier: MIT
// Triangles that are moved about: corners in grid coordinates, and which edges they share.
#ifndef PVT_OCCLUDER_TRIANGLE_SET_H
#define PVT_OCCLUDER_TRIANGLE_SET_H

#include <paravent/mesh.h>

/// An edge of one triangle, or of two. Where more share it there is one for each pair.
typedef struct pvtTriangleEdge {
    uint32_t ends[2];
    int sideCount;
    uint32_t across[2]; ///< the third corner on each side
} pvtTriangleEdge;

typedef struct pvtTriangleSet {
    float (*corners)[3]; ///< [vx]
    float (*anchors)[3]; ///< [vx] where corners can go back to: there all triangles are inside
    bool* isFixed;       ///< of each corner: it stays where it is
    int cornerCount, cornerCapacity;
    uint32_t (*triangles)[3];
    int32_t* tags; ///< of each triangle: the caller's
    int triangleCount, triangleCapacity;
    pvtTriangleEdge* edges;
    int edgeCount;
    bool (*isOpen)[3]; ///< of each triangle: no other shares its edge from corner i to i + 1
    int32_t* heads;    ///< of each corner: the first edge that it is the lower end of, or −1
    int32_t* links;    ///< of each edge: the next such edge
} pvtTriangleSet;

/// An empty one.
pvtStatus pvtCreateTriangleSet(pvtContext* context, int cornerCapacity, int triangleCapacity,
                               pvtTriangleSet* set);
void pvtTriangleSet_Free(pvtContext* context, pvtTriangleSet* set);

/// Makes `to`, of the same capacity, equal to `from`.
void pvtTriangleSet_Copy(const pvtTriangleSet* from, pvtTriangleSet* to);

/// Both within the capacity. A corner is anchored where it is added.
uint32_t pvtTriangleSet_AddCorner(pvtTriangleSet* set, const float place[3], bool isFixed);
void pvtTriangleSet_AddTriangle(pvtTriangleSet* set, const uint32_t corners[3], int32_t tag);
/// Adds all of another set, within the capacity, with its corners where they are and are anchored.
void pvtTriangleSet_Append(pvtTriangleSet* set, const pvtTriangleSet* more);
/// The last triangle takes its place.
void pvtTriangleSet_Remove(pvtTriangleSet* set, int triangle);
/// Takes away corners that no triangle uses. `moved` (cornerCapacity) tells for each that is left
/// which it was.
void pvtTriangleSet_DropCorners(pvtTriangleSet* set, int32_t* moved);
/// To be called after triangles were added or removed, before the edges are used.
void pvtTriangleSet_FindEdges(pvtTriangleSet* set);

static inline bool pvtHasCorner(const uint32_t corners[3], uint32_t corner)
{
    return corners[0] == corner || corners[1] == corner || corners[2] == corner;
}

/// Whether none of a triangle's corners may move.
static inline bool pvtTriangleSet_IsFixed(const pvtTriangleSet* set, int triangle)
{
    const uint32_t* corners = set->triangles[triangle];
    return set->isFixed[corners[0]] && set->isFixed[corners[1]] && set->isFixed[corners[2]];
}

/// −1, 0 or 1: the side of the line from a to b that c lies on, left being 1.
static inline int pvtGetSide2(const float a[2], const float b[2], const float c[2])
{
    const float area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    return area > 0.0F ? 1 : area < 0.0F ? -1 : 0;
}

#endif
