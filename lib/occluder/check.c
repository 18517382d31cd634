// SPDX-License-Identifier: MIT
// The promise, checked after the fact: which clear voxels does an occluder reach into? Each
// triangle, as it is stored, is clipped to slabs of voxels by z, then to rows by y (Sutherland and
// Hodgman, Reentrant Polygon Clipping, 1974); what is left spans the row's voxels that it touches.
// Shares nothing with slices, contours or masks.
#include "base/context.h"
#include "base/vector.h"

#include <limits.h>
#include <math.h>
#include <paravent/occluder.h>

// Boxes are shrunk by this much, so that rounding a coordinate to float is not a violation.
static const double SLACK = 1.0 / 1024.0;

typedef struct CheckTask {
    pvtContext* context;
    const pvtBitGrid* allowed;
    const pvtCellGrid* cells; // may be null
    const pvtMesh* mesh;
    uint64_t* outside; // one a triangle
} CheckTask;

// A convex polygon in grid coordinates: a triangle cut by up to ten planes.
typedef struct Piece {
    pvtVec3 points[16];
    int count;
} Piece;

// The part where sign × coordinate ≤ sign × bound.
static Piece ClipPiece(const Piece* piece, int axis, double sign, double bound)
{
    Piece kept = {.count = 0};
    for (int i = 0; i < piece->count; ++i) {
        const pvtVec3 from = piece->points[i];
        const pvtVec3 to = piece->points[(i + 1) % piece->count];
        const double a = sign * (pvtGetAxis(from, axis) - bound);
        const double b = sign * (pvtGetAxis(to, axis) - bound);
        if (a <= 0.0) {
            kept.points[kept.count++] = from;
        }
        if ((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) {
            kept.points[kept.count++] = pvtAdd(from, pvtScale(pvtSub(to, from), a / (a - b)));
        }
    }
    return kept;
}

static Piece ClipToSlab(const Piece* piece, int axis, int index)
{
    const Piece below = ClipPiece(piece, axis, 1.0, index + 1.0 - SLACK);
    return ClipPiece(&below, axis, -1.0, index + SLACK);
}

// First and last voxel along the axis that the piece reaches into by more than the slack.
static void GetRange(const Piece* piece, int axis, int size, int range[2])
{
    range[0] = 0;
    range[1] = -1;
    if (piece->count == 0) {
        return;
    }
    double low = HUGE_VAL;
    double high = -HUGE_VAL;
    for (int i = 0; i < piece->count; ++i) {
        low = fmin(low, pvtGetAxis(piece->points[i], axis));
        high = fmax(high, pvtGetAxis(piece->points[i], axis));
    }
    // Voxel i is reached when low < i + 1 − slack and high > i + slack. Outside of the grid one row
    // on each side stands for all.
    range[0] = (int)fmax(floor(low + SLACK), -1.0);
    range[1] = (int)fmin(ceil(high - SLACK) - 1.0, size);
}

// Whether the box around a piece of a voxel holds set cells only: most do, and need no clipping.
static bool IsBoxSet(const Piece* piece, uint64_t cells, const int voxel[3])
{
    int ranges[3][2];
    for (int axis = 0; axis < 3; ++axis) {
        GetRange(piece, axis, INT_MAX, ranges[axis]);
        ranges[axis][0] -= PVT_CELLS * voxel[axis];
        ranges[axis][1] -= PVT_CELLS * voxel[axis];
    }
    for (int z = ranges[2][0]; z <= ranges[2][1]; ++z) {
        for (int y = ranges[1][0]; y <= ranges[1][1]; ++y) {
            for (int x = ranges[0][0]; x <= ranges[0][1]; ++x) {
                if ((cells >> (x + PVT_CELLS * (y + PVT_CELLS * z)) & 1) == 0) {
                    return false;
                }
            }
        }
    }
    return true;
}

// Whether a piece of a voxel reaches into one of its clear cells. Coordinates count in cells.
static bool ReachesClearCell(const Piece* piece, uint64_t cells, const int voxel[3])
{
    if (IsBoxSet(piece, cells, voxel)) {
        return false;
    }
    int zs[2];
    GetRange(piece, 2, INT_MAX, zs);
    for (int z = zs[0]; z <= zs[1]; ++z) {
        const Piece slab = ClipToSlab(piece, 2, z);
        int ys[2];
        GetRange(&slab, 1, INT_MAX, ys);
        for (int y = ys[0]; y <= ys[1]; ++y) {
            const Piece row = ClipToSlab(&slab, 1, y);
            int xs[2];
            GetRange(&row, 0, INT_MAX, xs);
            for (int x = xs[0]; x <= xs[1]; ++x) {
                const int cell = (x - PVT_CELLS * voxel[0]) +
                                 PVT_CELLS * ((y - PVT_CELLS * voxel[1]) +
                                              PVT_CELLS * (z - PVT_CELLS * voxel[2]));
                if ((cells >> cell & 1) == 0) {
                    return true;
                }
            }
        }
    }
    return false;
}

// The row's piece in a voxel that is not allowed as a whole.
static bool IsVoxelLeft(const CheckTask* task, const Piece* row, const int voxel[3])
{
    const uint64_t cells =
        task->cells != NULL ? pvtCellGrid_Get(task->cells, voxel[0], voxel[1], voxel[2]) : 0;
    if (cells == 0) {
        return true;
    }
    Piece piece = ClipToSlab(row, 0, voxel[0]);
    for (int i = 0; i < piece.count; ++i) {
        piece.points[i] = pvtScale(piece.points[i], PVT_CELLS);
    }
    return ReachesClearCell(&piece, cells, voxel);
}

static uint64_t CheckRow(const CheckTask* task, const Piece* row, int y, int z)
{
    uint64_t outside = 0;
    int xs[2];
    GetRange(row, 0, task->allowed->frame.size[0], xs);
    for (int x = xs[0]; x <= xs[1]; ++x) {
        if (!pvtBitGrid_Get(task->allowed, x, y, z)) {
            outside += IsVoxelLeft(task, row, (int[3]){x, y, z}) ? 1 : 0;
        }
    }
    return outside;
}

static uint64_t CheckTriangle(const CheckTask* task, size_t triangle)
{
    const pvtGridFrame* frame = &task->allowed->frame;
    Piece whole = {.count = 3};
    for (int c = 0; c < 3; ++c) {
        const pvtVec3 p = task->mesh->positions[task->mesh->indices[3 * triangle + (size_t)c]];
        whole.points[c] = pvtScale(pvtSub(p, frame->origin), 1.0 / frame->voxelSize);
    }
    uint64_t outside = 0;
    int zs[2];
    GetRange(&whole, 2, frame->size[2], zs);
    for (int z = zs[0]; z <= zs[1] && !pvtIsCancelled(task->context); ++z) {
        const Piece slab = ClipToSlab(&whole, 2, z);
        int ys[2];
        GetRange(&slab, 1, frame->size[1], ys);
        for (int y = ys[0]; y <= ys[1]; ++y) {
            const Piece row = ClipToSlab(&slab, 1, y);
            outside += CheckRow(task, &row, y, z);
        }
    }
    return outside;
}

static void CheckTriangles(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const CheckTask* task = taskData;
    for (size_t t = begin; t < end; ++t) {
        task->outside[t] = CheckTriangle(task, t);
    }
}

pvtStatus pvtCheckOccluder(pvtContext* context, const pvtBitGrid* allowed, const pvtCellGrid* cells,
                           const pvtMesh* occluder, uint64_t* outside)
{
    *outside = 0;
    uint64_t* counts = pvtAllocate(context, occluder->triangleCount, sizeof *counts);
    if (counts == NULL) {
        return pvtContext_GetStatus(context);
    }
    CheckTask task = {.context = context,
                      .allowed = allowed,
                      .cells = cells != NULL && cells->count > 0 ? cells : NULL,
                      .mesh = occluder,
                      .outside = counts};
    pvtParallelFor(context, CheckTriangles, occluder->triangleCount, 1, &task);
    for (size_t t = 0; t < occluder->triangleCount; ++t) {
        *outside += counts[t];
    }
    pvtRelease(context, counts);
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
}
