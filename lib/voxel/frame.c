// SPDX-License-Identifier: MIT
// Where the grid of a mesh stands: voxel size, padding, and how the bounds lie within.
#include "frame.h"

#include "bit_grid.h"

#include "base/context.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>

enum { MIN_PADDING = 2, MIN_RESOLUTION = 8, MAX_RESOLUTION = 2048 };

// The bounds lie an eighth of a voxel off the middle, which is half a cell: faces that are whole
// voxels, halves or quarters of them apart, as those of buildings often are, then run through
// cells and not between two, both of which they would touch.
static const double OFF_MIDDLE = 0.125;

// What a whole run holds at its peak, measured in grids: the solid that follows has three, one more
// is at work, and sections, chains and polygons take as much again and a little more. To these
// come bytes for each touched voxel, of which there are about as many as on the sides of the grid;
// three for each node of a field, of which there are no more than so many along a side; and what
// any run holds, however small.
enum { GRIDS_OF_A_RUN = 9, BYTES_OF_A_TOUCHED_VOXEL = 100, BYTES_OF_A_NODE = 3, MOST_NODES = 272 };

static const double BYTES_OF_ANY_RUN = 4e6;

pvtVoxelizeOptions pvtDefaultVoxelizeOptions(void)
{
    return (pvtVoxelizeOptions){.resolution = 256, .voxelSize = 0.0, .padding = 0.0};
}

static pvtStatus CheckOptions(pvtContext* context, const pvtVoxelizeOptions* options)
{
    if (!(options->voxelSize >= 0.0 && isfinite(options->voxelSize))) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the voxel size is %g; it may not be less "
                       "than 0",
                       options->voxelSize);
    }
    if (options->voxelSize == 0.0 &&
        (options->resolution < MIN_RESOLUTION || options->resolution > MAX_RESOLUTION)) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the resolution is %d; it must lie in %d to "
                       "%d",
                       options->resolution, MIN_RESOLUTION, MAX_RESOLUTION);
    }
    if (!(options->padding >= 0.0 && isfinite(options->padding))) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the padding is %g; it may not be less than "
                       "0",
                       options->padding);
    }
    return PVT_OK;
}

static double GetLongest(pvtVec3 v)
{
    return fmax(v.x, fmax(v.y, v.z));
}

static double GetFarthest(const pvtBox3* box)
{
    const pvtVec3 farthest = {fmax(fabs(box->lower.x), fabs(box->upper.x)),
                              fmax(fabs(box->lower.y), fabs(box->upper.y)),
                              fmax(fabs(box->lower.z), fabs(box->upper.z))};
    return GetLongest(farthest);
}

static pvtStatus CheckExtent(pvtContext* context, const pvtMesh* mesh, double longest)
{
    if (mesh->triangleCount == 0) {
        return pvtFail(context, PVT_INVALID_INPUT, "the mesh has no triangles");
    }
    if (!isfinite(longest)) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "the mesh is larger than numbers reach; scale it down");
    }
    if (longest == 0.0) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "the mesh has no extent: all its triangles "
                       "lie in one point");
    }
    return PVT_OK;
}

static pvtStatus CheckVoxelSize(pvtContext* context, const pvtBox3* box, double longest,
                                double voxelSize)
{
    if (longest / voxelSize > MAX_RESOLUTION * (1.0 + 1e-9)) {
        return pvtFail(context, PVT_LIMIT,
                       "a voxel size of %g makes %.0f voxels of the longest "
                       "side; at most %d are possible, with a voxel size of %g",
                       voxelSize, longest / voxelSize, MAX_RESOLUTION, longest / MAX_RESOLUTION);
    }
    // Below these, neighbouring voxels could not be told apart in world units.
    if (voxelSize < DBL_MIN / DBL_EPSILON) {
        return pvtFail(context, PVT_INVALID_INPUT, "the mesh is only %g long; scale it up",
                       longest);
    }
    if (voxelSize < 64.0 * DBL_EPSILON * GetFarthest(box)) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "the mesh is %g long, but reaches %g away from "
                       "the origin, which is too far for its size; move it closer",
                       longest, GetFarthest(box));
    }
    return PVT_OK;
}

// Voxels along a side of `extent` voxels, with `padding` of them free at each end. The bounds lie
// in the middle, and the count is such that their faces fall inside voxels rather than on the
// border of two, which would touch both: a side of exactly n voxels has n − 1 whole ones within.
static double CountSide(double extent, double padding)
{
    const double nearby = floor(extent + 0.5);
    const double snapped = fabs(extent - nearby) < 1e-6 ? nearby : ceil(extent);
    return (extent < 1.0 - 1e-6 ? 1.0 : snapped + 1.0) + 2.0 * padding;
}

static double CountBytes(const double size[3])
{
    return ceil(size[0] / 64.0) * 8.0 * size[1] * size[2];
}

static double CountBytesOfRun(const double size[3])
{
    const double touched = 2.0 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
    double nodes = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        nodes *= fmin(size[axis], MOST_NODES);
    }
    return GRIDS_OF_A_RUN * CountBytes(size) + BYTES_OF_A_TOUCHED_VOXEL * touched +
           BYTES_OF_A_NODE * nodes + BYTES_OF_ANY_RUN;
}

static void CountSides(pvtVec3 extent, double voxelSize, double padding, double size[3])
{
    const double free = fmax(MIN_PADDING, ceil(padding / voxelSize - 1e-9));
    for (int axis = 0; axis < 3; ++axis) {
        size[axis] = CountSide(pvtGetAxis(extent, axis) / voxelSize, free);
    }
}

// The finest resolution with which a run fits in `bytes`; below the minimum when none does.
static int FindFittingResolution(pvtVec3 extent, double padding, double bytes)
{
    int fits = MIN_RESOLUTION - 1;
    int tooFine = MAX_RESOLUTION + 1;
    while (tooFine - fits > 1) {
        const int middle = (fits + tooFine) / 2;
        double size[3];
        CountSides(extent, GetLongest(extent) / middle, padding, size);
        if (CountBytesOfRun(size) <= bytes) {
            fits = middle;
        } else {
            tooFine = middle;
        }
    }
    return fits;
}

static pvtStatus CheckSides(pvtContext* context, pvtVec3 extent, double padding,
                            const double size[3])
{
    const double sides = fmax(size[0], fmax(size[1], size[2]));
    if (sides > PVT_MAX_GRID_SIDE) {
        return pvtFail(context, PVT_LIMIT,
                       "with its padding of %g the grid is %.0f voxels long; "
                       "at most %d are possible",
                       padding, sides, PVT_MAX_GRID_SIDE);
    }
    const double left = (double)pvtGetFreeBytes(context);
    if (CountBytes(size) <= left) {
        return PVT_OK;
    }
    const int fits = FindFittingResolution(extent, padding, left);
    if (fits < MIN_RESOLUTION) {
        return pvtFail(context, PVT_LIMIT,
                       "a grid of %.0f × %.0f × %.0f voxels needs %.1f MB, but "
                       "only %.1f MB of the memory limit are left; raise the limit",
                       size[0], size[1], size[2], CountBytes(size) / 1e6, left / 1e6);
    }
    return pvtFail(context, PVT_LIMIT,
                   "a grid of %.0f × %.0f × %.0f voxels needs %.1f MB, but only "
                   "%.1f MB of the memory limit are left; a resolution of %d would fit",
                   size[0], size[1], size[2], CountBytes(size) / 1e6, left / 1e6, fits);
}

pvtStatus pvtMakeGridFrame(pvtContext* context, const pvtVoxelizeOptions* options,
                           const pvtMesh* mesh, pvtGridFrame* frame)
{
    const pvtBox3 box = pvtMesh_GetBounds(mesh);
    const pvtVec3 extent = pvtSub(box.upper, box.lower);
    const double longest = GetLongest(extent);
    pvtStatus status = CheckOptions(context, options);
    if (status == PVT_OK) {
        status = CheckExtent(context, mesh, longest);
    }
    const double voxelSize =
        options->voxelSize > 0.0 ? options->voxelSize : longest / options->resolution;
    if (status == PVT_OK) {
        status = CheckVoxelSize(context, &box, longest, voxelSize);
    }
    if (status != PVT_OK) {
        return status;
    }
    double size[3];
    CountSides(extent, voxelSize, options->padding, size);
    status = CheckSides(context, extent, options->padding, size);
    if (status != PVT_OK) {
        return status;
    }
    frame->voxelSize = voxelSize;
    for (int axis = 0; axis < 3; ++axis) {
        const double center = pvtGetAxis(box.lower, axis) + 0.5 * pvtGetAxis(extent, axis);
        frame->size[axis] = (int)size[axis];
        pvtSetAxis(&frame->origin, axis, center - (0.5 * size[axis] + OFF_MIDDLE) * voxelSize);
    }
    return PVT_OK;
}
