// SPDX-License-Identifier: MIT
// A triangle is listed in the voxels of its box that its plane passes: row by row, the plane bounds
// where along x. That is a few voxels too many beside its edges, and none too few. Workers share
// the layers of voxels, not the triangles, so that lists need no locks and are in order.
#include "cell_grid.h"

#include "base/context.h"
#include "base/vector.h"

#include <math.h>

enum { CANCEL_INTERVAL = 4096, PARTS = 4 };

static const double MARGIN = 1e-6; // [vx]

void pvtTouching_Free(pvtContext* context, pvtTouching* touching)
{
    pvtRelease(context, touching->starts);
    pvtRelease(context, touching->triangles);
    *touching = (pvtTouching){0};
}

typedef struct Lister {
    pvtContext* context;
    const pvtCellGrid* cells;
    const pvtMesh* mesh;
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

// The plane n · p = d, for rows along x.
typedef struct RowPlane {
    pvtVec3 n;
    double d;
    double scale;  // 1 / n.x
    double margin; // [vx] along x
} RowPlane;

static double Least(double a, double b)
{
    return a < b ? a : b;
}

static double Most(double a, double b)
{
    return a > b ? a : b;
}

// The part of a row from range[0] to range[1] in which the plane passes within its voxels.
static bool CutRow(const RowPlane* plane, int y, int z, int range[2])
{
    const pvtVec3 n = plane->n;
    const double rest = plane->d - n.y * y - n.z * z;
    const double low = rest - Most(n.y, 0.0) - Most(n.z, 0.0);
    const double high = rest - Least(n.y, 0.0) - Least(n.z, 0.0);
    if (fabs(n.x) < 1e-9) {
        return low <= MARGIN && high >= -MARGIN;
    }
    const double from = low * plane->scale, to = high * plane->scale;
    const double a = Least(from, to) - plane->margin;
    const double b = Most(from, to) + plane->margin;
    if (a > range[1] + 1.0 || b < range[0]) {
        return false;
    }
    // Not below 0: cutting the fraction off rounds down.
    range[0] = a > range[0] ? (int)a : range[0];
    range[1] = b < range[1] ? (int)b : range[1];
    return range[0] <= range[1];
}

// In the layers from `first` to `last`.
static void AddTriangle(const Lister* lister, size_t triangle, int first, int last)
{
    const pvtGridFrame* frame = &lister->cells->voxels.frame;
    pvtVec3 corners[3];
    int low[3], high[3];
    pvtGetGridTriangle(frame, lister->mesh, triangle, corners);
    for (int axis = 2; axis >= 0; --axis) {
        const double a = pvtGetAxis(corners[0], axis), b = pvtGetAxis(corners[1], axis),
                     c = pvtGetAxis(corners[2], axis);
        const int least = axis == 2 ? first : 0;
        const int most = axis == 2 ? last : frame->size[axis] - 1;
        const double from = Least(a, Least(b, c)) - MARGIN;
        const double to = Most(a, Most(b, c)) + MARGIN;
        if (to < least || from >= most + 1) {
            return;
        }
        low[axis] = from > least ? (int)from : least;
        high[axis] = to < most ? (int)to : most;
    }
    const pvtVec3 n =
        pvtNormalize(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])));
    const RowPlane plane = {n, pvtDot(n, corners[0]), 1.0 / n.x, MARGIN / fabs(n.x)};
    for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1]; ++y) {
            int range[2] = {low[0], high[0]};
            // A triangle without area has no plane: all of its box then.
            if (CutRow(&plane, y, z, range)) {
                AddRow(lister, y, z, range, (uint32_t)triangle);
            }
        }
    }
}

static void AddToLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Lister* lister = taskData;
    for (size_t t = 0; t < lister->mesh->triangleCount; ++t) {
        if (t % CANCEL_INTERVAL == 0 && pvtIsCancelled(lister->context)) {
            return;
        }
        AddTriangle(lister, t, (int)begin, (int)end - 1);
    }
}

static pvtStatus AddTriangles(pvtContext* context, Lister* lister)
{
    const size_t layers = (size_t)lister->cells->voxels.frame.size[2];
    pvtParallelFor(context, AddToLayers, layers, layers / PARTS + 1, lister);
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
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
    touching->triangles = pvtAllocateUnset(context, (size_t)sum, sizeof *touching->triangles);
    if (touching->triangles == NULL) {
        return pvtContext_GetStatus(context);
    }
    lister->triangles = touching->triangles;
    return AddTriangles(context, lister);
}

pvtStatus pvtListTouching(pvtContext* context, const pvtMesh* mesh, const pvtCellGrid* cells,
                          pvtTouching* touching)
{
    *touching = (pvtTouching){.mesh = mesh};
    Lister lister = {.context = context, .cells = cells, .mesh = mesh};
    lister.counts = pvtAllocate(context, cells->count, sizeof *lister.counts);
    touching->starts = pvtAllocateUnset(context, cells->count + 1, sizeof *touching->starts);
    pvtStatus status = lister.counts == NULL || touching->starts == NULL
                           ? pvtContext_GetStatus(context)
                           : AddTriangles(context, &lister);
    if (status == PVT_OK) {
        status = FillLists(context, &lister, touching);
    }
    pvtRelease(context, lister.counts);
    if (status != PVT_OK) {
        pvtTouching_Free(context, touching);
    }
    return status;
}
