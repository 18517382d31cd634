// SPDX-License-Identifier: MIT
// Planes as fixed-point graphs over their dominant axis.
#include "base/vector.h"
#include "voxel/bit_grid.h"

#include <assert.h>
#include <paravent/section.h>

#define PLANE_ONE 0x1p20
// Slopes come in steps of this, so that at four cells a voxel, where a cell's centre lies an odd
// number of eighths of a voxel along, they add an even number to the odd offset.
#define SLOPE_STEP 16
// Planes farther off than this [vx] miss any grid; the bound keeps offsets far from overflow.
#define FARTHEST 0x1p30

pvtAxis pvtPlane_GetU(const pvtPlane* plane)
{
    return plane->axis == PVT_AXIS_X ? PVT_AXIS_Y : PVT_AXIS_X;
}

pvtAxis pvtPlane_GetV(const pvtPlane* plane)
{
    return plane->axis == PVT_AXIS_Z ? PVT_AXIS_Y : PVT_AXIS_Z;
}

pvtVec3 pvtPlane_ToWorld(const pvtPlane* plane, const pvtGridFrame* frame, pvtPoint2 point)
{
    // Exact in integers up to here, so that a vertex shared by two triangles stays one vertex.
    const int64_t height = plane->offset * (1 << PVT_POINT_BITS) +
                           (int64_t)plane->slopeU * point.x + (int64_t)plane->slopeV * point.y;
    pvtVec3 grid = {0};
    pvtSetAxis(&grid, (int)plane->axis, (double)height / (PLANE_ONE * (1 << PVT_POINT_BITS)));
    pvtSetAxis(&grid, (int)pvtPlane_GetU(plane), (double)point.x / (1 << PVT_POINT_BITS));
    pvtSetAxis(&grid, (int)pvtPlane_GetV(plane), (double)point.y / (1 << PVT_POINT_BITS));
    return pvtAdd(frame->origin, pvtScale(grid, frame->voxelSize));
}

pvtVec3 pvtPlane_GetNormal(const pvtPlane* plane)
{
    pvtVec3 normal = {0};
    pvtSetAxis(&normal, (int)plane->axis, PLANE_ONE);
    pvtSetAxis(&normal, (int)pvtPlane_GetU(plane), -(double)plane->slopeU);
    pvtSetAxis(&normal, (int)pvtPlane_GetV(plane), -(double)plane->slopeV);
    return pvtNormalize(normal);
}

static pvtAxis FindDominantAxis(pvtVec3 direction)
{
    pvtAxis best = PVT_AXIS_X;
    for (int axis = 1; axis < 3; ++axis) {
        if (fabs(pvtGetAxis(direction, axis)) > fabs(pvtGetAxis(direction, (int)best))) {
            best = (pvtAxis)axis;
        }
    }
    return best;
}

static int32_t RoundSlope(double slope)
{
    return (int32_t)(SLOPE_STEP * floor(slope * (PLANE_ONE / SLOPE_STEP) + 0.5));
}

static int64_t RoundToOdd(double offset)
{
    const double bounded = fmax(-FARTHEST * PLANE_ONE, fmin(FARTHEST * PLANE_ONE, offset));
    return 2 * (int64_t)floor(bounded * 0.5) + 1;
}

pvtPlane pvtMakePlane(const pvtGridFrame* frame, pvtVec3 direction, pvtVec3 point)
{
    const pvtAxis axis = FindDominantAxis(direction);
    const double length = pvtGetAxis(direction, (int)axis);
    assert(length != 0.0 && pvtIsFinite3(direction) && pvtIsFinite3(point));
    pvtPlane plane = {.axis = axis};
    const int u = (int)pvtPlane_GetU(&plane), v = (int)pvtPlane_GetV(&plane);
    plane.slopeU = RoundSlope(-pvtGetAxis(direction, u) / length);
    plane.slopeV = RoundSlope(-pvtGetAxis(direction, v) / length);
    // With the rounded slopes, so that the plane turns about `point` and not about the origin.
    const pvtVec3 grid = pvtToGrid(frame, point);
    plane.offset =
        RoundToOdd(PLANE_ONE * pvtGetAxis(grid, (int)axis) - plane.slopeU * pvtGetAxis(grid, u) -
                   plane.slopeV * pvtGetAxis(grid, v));
    return plane;
}

double pvtPlane_GetAreaScale(const pvtPlane* plane)
{
    const double u = plane->slopeU / PLANE_ONE;
    const double v = plane->slopeV / PLANE_ONE;
    return sqrt(1.0 + u * u + v * v);
}
