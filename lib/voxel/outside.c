// SPDX-License-Identifier: MIT
// What a ball that comes from far away cannot reach.
//
// This is a morphological closing by a ball (Serra, "Image Analysis and Mathematical Morphology",
// 1982) with one difference: only the ball's positions that connect to the border count, so that
// closed cavities fill however wide they are. The centre may be where no surface voxel is nearer
// than the radius; what the ball covers from there is outside. In every crease it leaves a fillet,
// most of them less than a voxel or two deep. Where nothing may stick out, a walk of so many steps
// from what it covers takes these.
//
// The ground is a mirror: below it everything is taken to repeat upside down. So the centre stops
// at the plane, the ball may dip below it, and no fillet forms where a wall stands on it.
#include "outside.h"

#include "bit_grid.h"
#include "dilate.h"
#include "flood.h"

#include "base/context.h"

#include <math.h>

enum { CREASE_DEPTH = 2 }; // [vx]

// How far the grid must grow on either side of an axis, so that the ball can pass all around.
static bool FindMissingMargin(const pvtBitGrid* surface, const pvtGridBox* box, int reach,
                              int offset[3], int size[3])
{
    bool isMissing = false;
    for (int axis = 0; axis < 3; ++axis) {
        const int needed = reach + 1;
        const int below = needed - box->lower[axis];
        const int above = needed - (surface->frame.size[axis] - box->upper[axis]);
        offset[axis] = below > 0 ? below : 0;
        size[axis] = surface->frame.size[axis] + offset[axis] + (above > 0 ? above : 0);
        isMissing = isMissing || below > 0 || above > 0;
    }
    return isMissing;
}

// The voxels that the ball's centre may not enter.
static pvtStatus FindBlocked(pvtContext* context, const pvtSolidOptions* options,
                             const pvtBitGrid* surface, uint32_t squaredReach, int groundLayer,
                             pvtBitGrid* blocked)
{
    const pvtStatus status = pvtDilateGrid(context, surface, squaredReach, blocked);
    if (status == PVT_OK && options->ground) {
        pvtBitGrid_SetLayers(blocked, options->up, 0, groundLayer);
    }
    return status;
}

// [wu] Of the ball. Between the centres of touched voxels an opening is up to a voxel wider than it
// is, and half a voxel wider on the average: by so much the ball is larger than the hole.
static double GetRadius(const pvtSolidOptions* options, const pvtGridFrame* frame)
{
    return options->smallestHole > 0.0 ? 0.5 * (options->smallestHole + 0.5 * frame->voxelSize)
                                       : 0.0;
}

// Over faces, which is a ball of one voxel. Where an opening is closed its lid moves in by as much.
static pvtStatus WalkIntoCreases(pvtContext* context, const pvtBitGrid* surface,
                                 pvtBitGrid* outside)
{
    pvtStatus status = PVT_OK;
    for (int step = 0; step < CREASE_DEPTH && status == PVT_OK; ++step) {
        pvtBitGrid covered = *outside;
        status = pvtDilateGrid(context, &covered, 1, outside);
        for (size_t i = 0; i < outside->wordCount; ++i) {
            outside->words[i] &= ~surface->words[i];
        }
        pvtBitGrid_Free(context, &covered);
    }
    return status;
}

// For a surface with margin enough around it.
static pvtStatus FloodPadded(pvtContext* context, const pvtSolidOptions* options,
                             const pvtBitGrid* surface, int groundLayer, pvtBitGrid* inside)
{
    const uint32_t squaredReach =
        pvtGetSquaredReach(&surface->frame, GetRadius(options, &surface->frame));
    const bool needsBlocked = squaredReach > 0 || options->ground;
    pvtBitGrid blocked = {0};
    pvtBitGrid reached = {0};
    pvtStatus status =
        pvtCheckGridMemory(context, surface, needsBlocked ? 2.0 : 1.0, "flooding the outside");
    if (status == PVT_OK && needsBlocked) {
        status = FindBlocked(context, options, surface, squaredReach, groundLayer, &blocked);
    }
    if (status == PVT_OK) {
        status = pvtCreateBitGrid(context, &surface->frame, &reached);
    }
    if (status == PVT_OK) {
        status = pvtFloodFromBorder(context, needsBlocked ? &blocked : surface, &reached);
    }
    pvtBitGrid_Free(context, &blocked);
    if (status == PVT_OK && squaredReach > 0) {
        status = pvtDilateGrid(context, &reached, squaredReach, inside);
        pvtBitGrid_Free(context, &reached);
        if (status == PVT_OK && options->strict) {
            status = WalkIntoCreases(context, surface, inside);
        }
    } else if (status == PVT_OK) {
        *inside = reached;
        reached = (pvtBitGrid){0};
    }
    pvtBitGrid_Free(context, &reached);
    if (status == PVT_OK) {
        if (options->ground) {
            pvtBitGrid_SetLayers(inside, options->up, 0, groundLayer);
        }
        pvtBitGrid_Complement(inside);
    }
    return status;
}

pvtStatus pvtFloodOutside(pvtContext* context, const pvtSolidOptions* options,
                          const pvtBitGrid* surface, pvtBitGrid* inside)
{
    *inside = (pvtBitGrid){0};
    pvtGridBox box;
    if (!pvtBitGrid_FindBounds(surface, &box)) {
        return pvtCreateBitGrid(context, &surface->frame, inside);
    }
    const double radius = GetRadius(options, &surface->frame) / surface->frame.voxelSize;
    int offset[3];
    int size[3];
    if (3.0 * radius > PVT_MAX_GRID_SIDE) {
        return pvtFail(context, PVT_LIMIT,
                       "a smallest hole of %g is %.0f voxels, more than a grid has room for",
                       options->smallestHole, 2.0 * radius);
    }
    if (!FindMissingMargin(surface, &box, (int)ceil(radius), offset, size)) {
        return FloodPadded(context, options, surface, box.lower[options->up], inside);
    }
    pvtBitGrid padded;
    pvtBitGrid paddedInside = {0};
    pvtStatus status = pvtMoveBitGrid(context, surface, offset, size, &padded);
    if (status == PVT_OK) {
        status = FloodPadded(context, options, &padded,
                             box.lower[options->up] + offset[options->up], &paddedInside);
    }
    pvtBitGrid_Free(context, &padded);
    if (status == PVT_OK) {
        const int back[3] = {-offset[0], -offset[1], -offset[2]};
        status = pvtMoveBitGrid(context, &paddedInside, back, surface->frame.size, inside);
        if (status == PVT_OK) {
            inside->frame = surface->frame;
        }
    }
    pvtBitGrid_Free(context, &paddedInside);
    return status;
}
