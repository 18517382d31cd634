// SPDX-License-Identifier: MIT
// The promise, checked after the fact: which clear voxels does an occluder reach into? Each
// triangle, as it is stored, is clipped to slabs of voxels by z, then to rows by y (Sutherland and
// Hodgman, Reentrant Polygon Clipping, 1974); what is left spans the row's voxels that it touches.
// What lies in a border cell is cut by the planes of the surface's triangles there. Shares nothing
// with slices, masks, or the inside test.
#include "check.h"

#include "base/context.h"
#include "base/vector.h"
#include "voxel/cell_grid.h"

#include <limits.h>
#include <math.h>
#include <paravent/occluder.h>

// Boxes are shrunk by this much, so that rounding a coordinate to float is not a violation.
static const double SLACK = 1.0 / 1024.0;

typedef struct CheckTask {
    pvtContext* context;
    pvtInterior interior;
    const pvtMesh* mesh;
    uint64_t enough;
    uint64_t* outside; // one a triangle
} CheckTask;

// What is found of a triangle.
typedef struct Visit {
    const pvtInterior* interior;
    uint64_t outside, enough;
    bool isAnywhereAllowed;
} Visit;

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

// The cells in the box around a piece of a voxel.
static uint64_t GetBox(const Piece* piece, const int voxel[3])
{
    int ranges[3][2];
    uint64_t box = 0;
    for (int axis = 0; axis < 3; ++axis) {
        GetRange(piece, axis, INT_MAX, ranges[axis]);
        ranges[axis][0] -= PVT_CELLS * voxel[axis];
        ranges[axis][1] -= PVT_CELLS * voxel[axis];
    }
    for (int z = ranges[2][0]; z <= ranges[2][1]; ++z) {
        for (int y = ranges[1][0]; y <= ranges[1][1]; ++y) {
            for (int x = ranges[0][0]; x <= ranges[0][1]; ++x) {
                box |= UINT64_C(1) << (x + PVT_CELLS * (y + PVT_CELLS * z));
            }
        }
    }
    return box;
}

// Where the edges of a convex piece meet a plane; false unless it goes through by more than the
// slack.
static bool CutPiece(const Piece* piece, pvtVec3 normal, pvtVec3 on, pvtVec3 chord[2])
{
    double most = 0.0, least = 0.0;
    int count = 0;
    for (int i = 0; i < piece->count; ++i) {
        const pvtVec3 from = piece->points[i], to = piece->points[(i + 1) % piece->count];
        const double a = pvtDot(normal, pvtSub(from, on)), b = pvtDot(normal, pvtSub(to, on));
        most = fmax(most, a);
        least = fmin(least, a);
        if ((a < 0.0) != (b < 0.0) && count < 2) {
            chord[count++] = pvtAdd(from, pvtScale(pvtSub(to, from), a / (a - b)));
        }
    }
    return count == 2 && most > SLACK && least < -SLACK;
}

// Whether a piece goes through a triangle, both in cells.
static bool GoesThrough(const Piece* piece, const pvtVec3 corners[3])
{
    const pvtVec3 normal =
        pvtNormalize(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])));
    pvtVec3 chord[2];
    if (!CutPiece(piece, normal, corners[0], chord)) {
        return false;
    }
    double begin = 0.0, end = 1.0;
    for (int k = 0; k < 3; ++k) {
        const pvtVec3 edge = pvtSub(corners[(k + 1) % 3], corners[k]);
        const pvtVec3 inward = pvtNormalize(pvtCross(normal, edge));
        const double a = pvtDot(inward, pvtSub(chord[0], corners[k])) - SLACK;
        const double b = pvtDot(inward, pvtSub(chord[1], corners[k])) - SLACK;
        if (a < 0.0 && b < 0.0) {
            return false;
        }
        if (a < 0.0) {
            begin = fmax(begin, a / (a - b));
        } else if (b < 0.0) {
            end = fmin(end, a / (a - b));
        }
    }
    return (end - begin) * pvtLength3(pvtSub(chord[1], chord[0])) > SLACK;
}

// Whether a piece of a border cell goes through the surface there.
static bool CrossesSurface(const pvtInterior* interior, const Piece* piece, size_t voxel)
{
    const pvtTouching* touching = interior->touching;
    const pvtGridFrame* frame = &interior->allowed->frame;
    for (uint32_t i = touching->starts[voxel]; i < touching->starts[voxel + 1]; ++i) {
        pvtVec3 corners[3];
        for (size_t k = 0; k < 3; ++k) {
            const uint32_t corner = touching->mesh->indices[3 * (size_t)touching->triangles[i] + k];
            corners[k] = pvtScale(pvtSub(touching->mesh->positions[corner], frame->origin),
                                  PVT_CELLS / frame->voxelSize);
        }
        if (GoesThrough(piece, corners)) {
            return true;
        }
    }
    return false;
}

// Whether a piece is where it may not be in a cell. Coordinates count in cells.
static bool IsCellLeft(Visit* visit, const Piece* row, int x, size_t voxel, int cell)
{
    const pvtCellGrid* cells = visit->interior->cells;
    if ((cells->cells[voxel] >> cell & 1) != 0) {
        visit->isAnywhereAllowed = true;
        return false;
    }
    if (visit->interior->touching == NULL || (cells->border[voxel] >> cell & 1) == 0) {
        return true;
    }
    const Piece piece = ClipToSlab(row, 0, x);
    return CrossesSurface(visit->interior, &piece, voxel);
}

// Whether a piece of a voxel is where it may not be. Coordinates count in cells.
static bool IsAnyCellLeft(Visit* visit, const Piece* piece, size_t index, const int voxel[3])
{
    const pvtCellGrid* cells = visit->interior->cells;
    const bool hasBorder = visit->interior->touching != NULL;
    const uint64_t box = GetBox(piece, voxel);
    const uint64_t others = box & ~cells->cells[index];
    if (others == 0) {
        visit->isAnywhereAllowed = visit->isAnywhereAllowed || piece->count > 0;
        return false;
    }
    // What goes through no surface as a whole goes through none in any cell. Whether it passes an
    // allowed one is not looked at here: there is none, or it need not be known any more.
    if (hasBorder && (others & ~cells->border[index]) == 0 &&
        (others == box || visit->isAnywhereAllowed) &&
        !CrossesSurface(visit->interior, piece, index)) {
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
                if (IsCellLeft(visit, &row, x, index, cell)) {
                    return true;
                }
            }
        }
    }
    return false;
}

// The row's piece in a voxel that is not allowed as a whole.
static bool IsVoxelLeft(Visit* visit, const Piece* row, const int voxel[3])
{
    const pvtCellGrid* cells = visit->interior->cells;
    const int* size = visit->interior->allowed->frame.size;
    const bool isIn = voxel[0] >= 0 && voxel[1] >= 0 && voxel[2] >= 0 && voxel[0] < size[0] &&
                      voxel[1] < size[1] && voxel[2] < size[2];
    const size_t index = cells != NULL && isIn
                             ? pvtCellGrid_Find(cells, voxel[0], voxel[1], voxel[2])
                             : PVT_NO_CELLS;
    if (index == PVT_NO_CELLS) {
        return true;
    }
    Piece piece = ClipToSlab(row, 0, voxel[0]);
    for (int i = 0; i < piece.count; ++i) {
        piece.points[i] = pvtScale(piece.points[i], PVT_CELLS);
    }
    return IsAnyCellLeft(visit, &piece, index, voxel);
}

static void CheckRow(Visit* visit, const Piece* row, int y, int z)
{
    const pvtBitGrid* allowed = visit->interior->allowed;
    int xs[2];
    GetRange(row, 0, allowed->frame.size[0], xs);
    for (int x = xs[0]; x <= xs[1] && visit->outside < visit->enough; ++x) {
        if (pvtBitGrid_Get(allowed, x, y, z)) {
            visit->isAnywhereAllowed = true;
        } else {
            visit->outside += IsVoxelLeft(visit, row, (int[3]){x, y, z}) ? 1 : 0;
        }
    }
}

static uint64_t CheckTriangle(const CheckTask* task, size_t triangle)
{
    const pvtGridFrame* frame = &task->interior.allowed->frame;
    Piece whole = {.count = 3};
    for (int c = 0; c < 3; ++c) {
        const pvtVec3 p = task->mesh->positions[task->mesh->indices[3 * triangle + (size_t)c]];
        whole.points[c] = pvtScale(pvtSub(p, frame->origin), 1.0 / frame->voxelSize);
    }
    Visit visit = {.interior = &task->interior, .enough = task->enough};
    bool isSeen = false;
    int zs[2];
    GetRange(&whole, 2, frame->size[2], zs);
    for (int z = zs[0];
         z <= zs[1] && visit.outside < visit.enough && !pvtIsCancelled(task->context); ++z) {
        const Piece slab = ClipToSlab(&whole, 2, z);
        int ys[2];
        GetRange(&slab, 1, frame->size[1], ys);
        for (int y = ys[0]; y <= ys[1] && visit.outside < visit.enough; ++y) {
            const Piece row = ClipToSlab(&slab, 1, y);
            isSeen = isSeen || row.count > 0;
            CheckRow(&visit, &row, y, z);
        }
    }
    // One that is so thin that nothing of it is looked at hides nothing.
    return visit.outside + (isSeen && !visit.isAnywhereAllowed && visit.outside == 0 ? 1 : 0);
}

static void CheckTriangles(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const CheckTask* task = taskData;
    for (size_t t = begin; t < end; ++t) {
        task->outside[t] = CheckTriangle(task, t);
    }
}

pvtStatus pvtCheckTriangles(pvtContext* context, const pvtInterior* interior, const pvtMesh* mesh,
                            uint64_t enough, uint64_t* outside)
{
    CheckTask task = {.context = context,
                      .interior = *interior,
                      .mesh = mesh,
                      .enough = enough,
                      .outside = outside};
    if (interior->cells != NULL && interior->cells->count == 0) {
        task.interior.cells = NULL;
    }
    pvtParallelFor(context, CheckTriangles, mesh->triangleCount, 1, &task);
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
}

pvtStatus pvtCheckOccluder(pvtContext* context, const pvtInterior* interior,
                           const pvtMesh* occluder, uint64_t* outside)
{
    *outside = 0;
    uint64_t* counts = pvtAllocate(context, occluder->triangleCount, sizeof *counts);
    if (counts == NULL) {
        return pvtContext_GetStatus(context);
    }
    const pvtStatus status = pvtCheckTriangles(context, interior, occluder, UINT64_MAX, counts);
    for (size_t t = 0; t < occluder->triangleCount; ++t) {
        *outside += counts[t];
    }
    pvtRelease(context, counts);
    return status;
}
