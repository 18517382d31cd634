// SPDX-License-Identifier: MIT
// A triangle is listed in the voxels of its box that its plane passes: row by row, the plane bounds
// where along x. That is a few voxels too many beside its edges, and none too few.
#include "cell_grid.h"

#include "base/context.h"
#include "base/vector.h"

#include <math.h>

enum { CANCEL_INTERVAL = 4096 };

static const double MARGIN = 1e-6; // [vx]

void pvtTouching_Free(pvtContext* context, pvtTouching* touching)
{
    pvtRelease(context, touching->starts);
    pvtRelease(context, touching->triangles);
    *touching = (pvtTouching){0};
}

typedef struct Lister {
    const pvtCellGrid* cells;
    uint32_t* counts;    // of each voxel; in the second pass where its next triangle goes
    uint32_t* triangles; // null in the first pass
} Lister;

static void AddRow(const Lister* lister, int y, int z, const int range[2], uint32_t triangle)
{
    const pvtBitGrid* voxels = &lister->cells->voxels;
    const size_t base = pvtGetRowIndex(voxels, y, z) * voxels->wordsPerRow;
    for (size_t w = (size_t)range[0] / 64; w <= (size_t)range[1] / 64; ++w) {
        const int first = range[0] - (int)(w * 64), last = range[1] - (int)(w * 64);
        const uint64_t word = voxels->words[base + w];
        uint64_t bits = word & pvtMakeMask((unsigned)(first > 0 ? first : 0),
                                           (unsigned)(last < 63 ? last + 1 : 64));
        for (; bits != 0; bits &= bits - 1) {
            const uint64_t below = (bits & (~bits + 1)) - 1;
            const size_t voxel =
                lister->cells->ranks[base + w] + (size_t)pvtCountBits(word & below);
            if (lister->triangles != NULL) {
                lister->triangles[lister->counts[voxel]] = triangle;
            }
            ++lister->counts[voxel];
        }
    }
}

// The part of a row from range[0] to range[1] in which the plane n · p = d passes within its
// voxels.
static bool CutRow(pvtVec3 n, double d, int y, int z, int range[2])
{
    const double low = d - fmax(n.y * y, n.y * (y + 1)) - fmax(n.z * z, n.z * (z + 1));
    const double high = d - fmin(n.y * y, n.y * (y + 1)) - fmin(n.z * z, n.z * (z + 1));
    if (fabs(n.x) < 1e-9) {
        return low <= MARGIN && high >= -MARGIN;
    }
    const double a = fmin(low / n.x, high / n.x) - MARGIN / fabs(n.x);
    const double b = fmax(low / n.x, high / n.x) + MARGIN / fabs(n.x);
    if (a > range[1] + 1.0 || b < range[0]) {
        return false;
    }
    range[0] = a > range[0] ? (int)floor(a) : range[0];
    range[1] = b < range[1] ? (int)floor(b) : range[1];
    return range[0] <= range[1];
}

static void AddTriangle(const Lister* lister, const pvtMesh* mesh, size_t triangle)
{
    const pvtGridFrame* frame = &lister->cells->voxels.frame;
    pvtVec3 corners[3];
    int low[3], high[3];
    pvtGetGridTriangle(frame, mesh, triangle, corners);
    for (int axis = 0; axis < 3; ++axis) {
        const double a = pvtGetAxis(corners[0], axis), b = pvtGetAxis(corners[1], axis),
                     c = pvtGetAxis(corners[2], axis);
        const int last = frame->size[axis] - 1;
        const int from = (int)floor(fmin(a, fmin(b, c)) - MARGIN);
        const int to = (int)floor(fmax(a, fmax(b, c)) + MARGIN);
        low[axis] = from > 0 ? from : 0;
        high[axis] = to < last ? to : last;
    }
    const pvtVec3 n =
        pvtNormalize(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])));
    const double d = pvtDot(n, corners[0]);
    for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1]; ++y) {
            int range[2] = {low[0], high[0]};
            // A triangle without area has no plane: all of its box then.
            if (range[0] <= range[1] && CutRow(n, d, y, z, range)) {
                AddRow(lister, y, z, range, (uint32_t)triangle);
            }
        }
    }
}

static pvtStatus AddTriangles(pvtContext* context, const Lister* lister, const pvtMesh* mesh)
{
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        if (t % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        AddTriangle(lister, mesh, t);
    }
    return PVT_OK;
}

static pvtStatus FillLists(pvtContext* context, Lister* lister, pvtTouching* touching)
{
    const size_t count = lister->cells->count;
    uint64_t sum = 0;
    for (size_t v = 0; v < count; ++v) {
        touching->starts[v] = (uint32_t)sum;
        sum += lister->counts[v];
        lister->counts[v] = touching->starts[v];
    }
    if (sum > UINT32_MAX) {
        return pvtFail(context, PVT_LIMIT,
                       "the surface's triangles lie in too many voxels; lower the resolution");
    }
    touching->starts[count] = (uint32_t)sum;
    touching->triangles = pvtAllocate(context, (size_t)sum, sizeof *touching->triangles);
    if (touching->triangles == NULL) {
        return pvtContext_GetStatus(context);
    }
    lister->triangles = touching->triangles;
    return AddTriangles(context, lister, touching->mesh);
}

pvtStatus pvtListTouching(pvtContext* context, const pvtMesh* mesh, const pvtCellGrid* cells,
                          pvtTouching* touching)
{
    *touching = (pvtTouching){.mesh = mesh};
    Lister lister = {.cells = cells};
    lister.counts = pvtAllocate(context, cells->count, sizeof *lister.counts);
    touching->starts = pvtAllocate(context, cells->count + 1, sizeof *touching->starts);
    pvtStatus status = lister.counts == NULL || touching->starts == NULL
                           ? pvtContext_GetStatus(context)
                           : AddTriangles(context, &lister, mesh);
    if (status == PVT_OK) {
        status = FillLists(context, &lister, touching);
    }
    pvtRelease(context, lister.counts);
    if (status != PVT_OK) {
        pvtTouching_Free(context, touching);
    }
    return status;
}
