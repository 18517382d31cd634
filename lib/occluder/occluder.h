// SPDX-License-Identifier: MIT
// Putting occluders together.
#ifndef PVT_OCCLUDER_OCCLUDER_H
#define PVT_OCCLUDER_OCCLUDER_H

#include <paravent/occluder.h>

/// Room for so many polygons and points, none of them there yet.
pvtStatus pvtAllocateOccluder(pvtContext* context, const pvtGridFrame* frame, size_t polygonCount,
                              size_t pointCount, pvtOccluder* occluder);

/// Within the room that pvtAllocateOccluder made; count ≥ 3.
void pvtAddOccluderPolygon(pvtOccluder* occluder, const pvtPlane* plane, const pvtPoint2* points,
                           size_t count);

/// All polygons of `count` occluders in one frame, one occluder after the other.
pvtStatus pvtJoinOccluders(pvtContext* context, const pvtOccluder* parts, size_t count,
                           pvtOccluder* joined);

/// Of one polygon.
static inline size_t pvtCountPolygonTriangles(const pvtLoopSet* loops, size_t loop)
{
    return loops->starts[loop + 1] - loops->starts[loop] - 2;
}

/// Triangulates the polygons into occluder->mesh, instead of what was there.
pvtStatus pvtMakeOccluderMesh(pvtContext* context, pvtOccluder* occluder);

#endif
