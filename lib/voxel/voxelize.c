// SPDX-License-Identifier: MIT
// Surface voxels, exactly and conservatively.
//
// The usual test is separating axes on each voxel of a bounding box (Akenine-Möller, "Fast 3D
// triangle-box overlap testing", 2001), or a plane and three projections on each voxel of the
// columns along the dominant axis (Schwarz and Seidel, "Fast parallel surface and solid
// voxelization on GPUs", 2010). Here nothing is tested: the part of a triangle inside the row of
// voxels (y, z) is convex, so the voxels that it touches are the ones between its least and its
// greatest x. Each slab of z cuts the triangle to a polygon, each row of y takes the extremes of
// x over that polygon's edges, and a row is written as a span of bits. The work grows with the
// rows touched, never with the bounding box.
//
// Rounding: coordinates count in voxels, from 1 to 16384. A corner is off by less than 1e-11, a
// cut by less again, and every interval is widened by 2e-9 at each of its ends. So no touched
// voxel is missed, and none is marked that is farther from the triangle than 4e-9 along any axis.
#include "bit_grid.h"
#include "cell_grid.h"
#include "cut.h"
#include "frame.h"

#include "base/context.h"
#include "base/vector.h"

#include <assert.h>
#include <limits.h>
#include <stdatomic.h>

enum { CANCEL_INTERVAL = 256, ALIGN_INTS = 16 };

static const double margin = 2e-9;

// The least and the greatest voxel of a row, for the slab at hand. Empty when first > last.
typedef struct RowSpan {
    int first, last;
} RowSpan;

typedef struct Voxelizer {
    pvtContext* context;
    const pvtMesh* mesh;
    const pvtGridFrame* frame;
    pvtBitGrid* grid;
    pvtCellGrid* cells; // instead of the grid: coordinates count in cells then
    double scale;       // [vx/wu]
    RowSpan* spans;     // for each worker and layer, one for each y
    size_t layerStep;   // entries for a layer
    int layerCount;     // slabs that are marked together: those of a voxel
    atomic_bool cancelled;
} Voxelizer;

// One slab's rows while a triangle is cut.
typedef struct Slab {
    RowSpan* spans;
    int z;
    int firstRow, lastRow;
} Slab;

// Points in voxels.
typedef struct Triangle {
    pvtVec3 corner[3];
} Triangle;

static double Min(double a, double b)
{
    return a < b ? a : b;
}

static double Max(double a, double b)
{
    return a > b ? a : b;
}

static double Clamp(double value, double low, double high)
{
    return Max(low, Min(high, value));
}

// Several workers may write the same word. Bits only ever turn on, so the result does not depend
// on who comes first; looking before writing keeps most of the traffic away.
static void MarkBits(uint64_t* word, uint64_t mask)
{
    if ((__atomic_load_n(word, __ATOMIC_RELAXED) & mask) != mask) {
        __atomic_fetch_or(word, mask, __ATOMIC_RELAXED);
    }
}

// The cells of a span that lie in voxel x, as bits of their row; none when it lies elsewhere.
static uint64_t GetCellBits(int x, RowSpan span)
{
    const int first = span.first > PVT_CELLS * x ? span.first - PVT_CELLS * x : 0;
    const int last =
        span.last < PVT_CELLS * x + PVT_CELLS - 1 ? span.last - PVT_CELLS * x : PVT_CELLS - 1;
    return first > last ? 0 : pvtMakeMask((unsigned)first, (unsigned)last + 1);
}

// The place of a row's first cell in its voxel's word.
static int GetCellRow(int y, int z)
{
    return PVT_CELLS * (y % PVT_CELLS + PVT_CELLS * (z % PVT_CELLS));
}

// Rows of cells within a row of voxels, and the cells from the first to the last of all of them.
typedef struct CellRows {
    RowSpan span[PVT_CELLS * PVT_CELLS];
    int place[PVT_CELLS * PVT_CELLS]; // of the row's bits in a word
    int count;
    RowSpan all;
} CellRows;

// A word is written once for all rows that pass it.
static void MarkCellRows(const pvtCellGrid* cells, int voxelY, int voxelZ, const CellRows* rows)
{
    const uint64_t* voxels = pvtBitGrid_GetRow(&cells->voxels, voxelY, voxelZ);
    const int first = rows->all.first / PVT_CELLS;
    size_t place = pvtCellGrid_Rank(cells, first, voxelY, voxelZ);
    for (int x = first; x <= rows->all.last / PVT_CELLS; ++x) {
        if (!pvtGetBit(voxels, (size_t)x)) {
            continue;
        }
        uint64_t bits = 0;
        for (int i = 0; i < rows->count; ++i) {
            bits |= GetCellBits(x, rows->span[i]) << rows->place[i];
        }
        MarkBits(&cells->cells[place++], bits);
    }
}

static void MarkCells(const pvtCellGrid* cells, int y, int z, RowSpan span)
{
    CellRows rows;
    rows.span[0] = rows.all = span;
    rows.place[0] = GetCellRow(y, z);
    rows.count = 1;
    MarkCellRows(cells, y / PVT_CELLS, z / PVT_CELLS, &rows);
}

static void MarkSpan(const Voxelizer* voxelizer, int y, int z, int firstX, int lastX)
{
    if (voxelizer->cells != NULL) {
        MarkCells(voxelizer->cells, y, z, (RowSpan){firstX, lastX});
        return;
    }
    const pvtBitGrid* grid = voxelizer->grid;
    uint64_t* row = pvtBitGrid_GetRow(grid, y, z);
    const size_t first = (size_t)firstX >> 6;
    const size_t last = (size_t)lastX >> 6;
    const uint64_t head = ~UINT64_C(0) << (firstX & 63);
    const uint64_t tail = ~UINT64_C(0) >> (63 - (lastX & 63));
    if (first == last) {
        MarkBits(&row[first], head & tail);
        return;
    }
    MarkBits(&row[first], head);
    for (size_t i = first + 1; i < last; ++i) {
        MarkBits(&row[i], ~UINT64_C(0));
    }
    MarkBits(&row[last], tail);
}

static bool AreCellsMarked(const pvtCellGrid* cells, int y, int z, RowSpan span)
{
    for (int x = span.first / PVT_CELLS; x <= span.last / PVT_CELLS; ++x) {
        const size_t index = pvtCellGrid_Find(cells, x, y / PVT_CELLS, z / PVT_CELLS);
        const uint64_t bits = GetCellBits(x, span) << GetCellRow(y, z);
        if (index != PVT_NO_CELLS &&
            (~__atomic_load_n(&cells->cells[index], __ATOMIC_RELAXED) & bits) != 0) {
            return false;
        }
    }
    return true;
}

// True when the words of a short span are marked already.
static bool IsSpanMarked(const Voxelizer* voxelizer, int y, int z, RowSpan span)
{
    if (voxelizer->cells != NULL) {
        return AreCellsMarked(voxelizer->cells, y, z, span);
    }
    const pvtBitGrid* grid = voxelizer->grid;
    const uint64_t* row = pvtBitGrid_GetRow(grid, y, z);
    const size_t first = (size_t)span.first >> 6;
    const size_t last = (size_t)span.last >> 6;
    const uint64_t head = ~UINT64_C(0) << (span.first & 63);
    const uint64_t tail = ~UINT64_C(0) >> (63 - (span.last & 63));
    if (first == last) {
        return (~__atomic_load_n(&row[first], __ATOMIC_RELAXED) & head & tail) == 0;
    }
    return last == first + 1 && (~__atomic_load_n(&row[first], __ATOMIC_RELAXED) & head) == 0 &&
           (~__atomic_load_n(&row[last], __ATOMIC_RELAXED) & tail) == 0;
}

static void WidenSpan(RowSpan* span, double a, double b)
{
    // Coordinates are positive: cutting the fraction off rounds down.
    const int first = (int)(Min(a, b) - margin);
    const int last = (int)(Max(a, b) + margin);
    span->first = first < span->first ? first : span->first;
    span->last = last > span->last ? last : span->last;
}

// Widens the rows that the segment passes by the part of it within each.
static void AddSegment(const Slab* slab, pvtFlatPoint a, pvtFlatPoint b)
{
    if (a.y > b.y) {
        const pvtFlatPoint swapped = a;
        a = b;
        b = swapped;
    }
    const int first = (int)(a.y - margin);
    const int last = (int)(b.y + margin);
    if (first == last) {
        WidenSpan(&slab->spans[first], a.x, b.x);
        return;
    }
    // Coordinates are above 1, so two that differ do so by at least 2^-52: the slope is finite,
    // and within the segment it is never multiplied by more than the segment's height.
    const double slope = b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0;
    double from = a.x;
    for (int y = first; y < last; ++y) {
        const double top = Clamp(y + 1 + margin, a.y, b.y);
        const double bottom = Clamp(y + 1 - margin, a.y, b.y);
        WidenSpan(&slab->spans[y], from, a.x + (top - a.y) * slope);
        from = a.x + (bottom - a.y) * slope;
    }
    WidenSpan(&slab->spans[last], from, b.x);
}

static void BeginRows(Slab* slab, double low, double high)
{
    slab->firstRow = (int)(low - margin);
    slab->lastRow = (int)(high + margin);
    for (int y = slab->firstRow; y <= slab->lastRow; ++y) {
        slab->spans[y] = (RowSpan){INT_MAX, -1};
    }
}

// The whole triangle lies within the slab.
static void AddWhole(Slab* slab, const Triangle* t)
{
    const pvtVec3* c = t->corner;
    BeginRows(slab, Min(c[0].y, Min(c[1].y, c[2].y)), Max(c[0].y, Max(c[1].y, c[2].y)));
    AddSegment(slab, pvtFlatten(c[0]), pvtFlatten(c[1]));
    AddSegment(slab, pvtFlatten(c[1]), pvtFlatten(c[2]));
    AddSegment(slab, pvtFlatten(c[2]), pvtFlatten(c[0]));
}

// The part of the triangle between two heights. Corners are sorted by z and low ≤ high lie
// within them. The edge from the first to the last corner runs along all heights, the other two
// meet it at both ends.
static void AddPart(Slab* slab, const Triangle* t, double low, double high)
{
    const pvtVec3* c = t->corner;
    const pvtFlatPoint longLow = pvtCutEdge(c[0], c[2], low);
    const pvtFlatPoint longHigh = pvtCutEdge(c[0], c[2], high);
    const pvtFlatPoint middle = pvtFlatten(c[1]);
    const pvtFlatPoint shortLow = pvtCutWay(c, low);
    const pvtFlatPoint shortHigh = pvtCutWay(c, high);
    const bool bends = low < c[1].z && c[1].z < high;
    const double lowest = Min(Min(longLow.y, longHigh.y), Min(shortLow.y, shortHigh.y));
    const double highest = Max(Max(longLow.y, longHigh.y), Max(shortLow.y, shortHigh.y));
    BeginRows(slab, bends ? Min(lowest, middle.y) : lowest,
              bends ? Max(highest, middle.y) : highest);
    AddSegment(slab, longLow, longHigh);
    AddSegment(slab, longLow, shortLow);
    AddSegment(slab, longHigh, shortHigh);
    AddSegment(slab, shortLow, bends ? middle : shortHigh);
    if (bends) {
        AddSegment(slab, middle, shortHigh);
    }
}

static void CutSlab(const Triangle* t, Slab* slab)
{
    const double bottom = t->corner[0].z;
    const double top = t->corner[2].z;
    const double low = Clamp(slab->z - margin, bottom, top);
    const double high = Clamp(slab->z + 1 + margin, bottom, top);
    if (low == bottom && high == top) {
        AddWhole(slab, t);
    } else {
        AddPart(slab, t, low, high);
    }
}

static void MarkSlab(const Voxelizer* voxelizer, const Slab* slab)
{
    for (int y = slab->firstRow; y <= slab->lastRow; ++y) {
        // Read one by one, as they were written just before: as a pair they would not be forwarded
        // from the processor's store buffer.
        const int first = slab->spans[y].first;
        const int last = slab->spans[y].last;
        if (first <= last) {
            MarkSpan(voxelizer, y, slab->z, first, last);
        }
    }
}

static void CollectRows(const Slab* slabs, int slabCount, int voxelY, CellRows* rows)
{
    rows->count = 0;
    rows->all = (RowSpan){INT_MAX, -1};
    for (int k = 0; k < slabCount; ++k) {
        const Slab* slab = &slabs[k];
        const int begin = voxelY * PVT_CELLS, end = begin + PVT_CELLS - 1;
        const int first = begin > slab->firstRow ? begin : slab->firstRow;
        const int last = end < slab->lastRow ? end : slab->lastRow;
        for (int y = first; y <= last; ++y) {
            const RowSpan span = slab->spans[y];
            if (span.first <= span.last) {
                rows->span[rows->count] = span;
                rows->place[rows->count++] = GetCellRow(y, slab->z);
                rows->all.first = span.first < rows->all.first ? span.first : rows->all.first;
                rows->all.last = span.last > rows->all.last ? span.last : rows->all.last;
            }
        }
    }
}

// Slabs within one layer of voxels.
static void MarkCellSlabs(const Voxelizer* voxelizer, const Slab* slabs, int slabCount)
{
    int first = slabs[0].firstRow;
    int last = slabs[0].lastRow;
    for (int k = 1; k < slabCount; ++k) {
        first = slabs[k].firstRow < first ? slabs[k].firstRow : first;
        last = slabs[k].lastRow > last ? slabs[k].lastRow : last;
    }
    for (int y = first / PVT_CELLS; y <= last / PVT_CELLS; ++y) {
        CellRows rows;
        CollectRows(slabs, slabCount, y, &rows);
        if (rows.count > 0) {
            MarkCellRows(voxelizer->cells, y, slabs[0].z / PVT_CELLS, &rows);
        }
    }
}

// Slabs from z.first to z.last, as many at a time as make a layer of voxels.
static void MarkSlabs(const Voxelizer* voxelizer, const Triangle* t, RowSpan z, RowSpan* spans)
{
    Slab slabs[PVT_CELLS];
    int count = 0;
    for (int k = z.first; k <= z.last; ++k) {
        slabs[count] = (Slab){.spans = spans + (size_t)count * voxelizer->layerStep, .z = k};
        CutSlab(t, &slabs[count++]);
        if (k < z.last && (k + 1) % voxelizer->layerCount != 0) {
            continue;
        }
        if (voxelizer->cells != NULL) {
            MarkCellSlabs(voxelizer, slabs, count);
        } else {
            MarkSlab(voxelizer, slabs);
        }
        count = 0;
    }
}

static void MarkTriangle(const Voxelizer* voxelizer, Triangle* t, RowSpan* spans)
{
    const pvtVec3* c = t->corner;
    const RowSpan x = {(int)(Min(c[0].x, Min(c[1].x, c[2].x)) - margin),
                       (int)(Max(c[0].x, Max(c[1].x, c[2].x)) + margin)};
    const RowSpan y = {(int)(Min(c[0].y, Min(c[1].y, c[2].y)) - margin),
                       (int)(Max(c[0].y, Max(c[1].y, c[2].y)) + margin)};
    const RowSpan z = {(int)(Min(c[0].z, Min(c[1].z, c[2].z)) - margin),
                       (int)(Max(c[0].z, Max(c[1].z, c[2].z)) + margin)};
    // A connected set that spans voxels along one axis only touches all of them.
    if ((x.first < x.last) + (y.first < y.last) + (z.first < z.last) <= 1) {
        for (int k = z.first; k <= z.last; ++k) {
            for (int j = y.first; j <= y.last; ++j) {
                MarkSpan(voxelizer, j, k, x.first, x.last);
            }
        }
        return;
    }
    // Where triangles are smaller than voxels, others have often marked all there is to mark.
    if (x.last - x.first <= 1 && y.last - y.first <= 1 && z.last - z.first <= 1 &&
        IsSpanMarked(voxelizer, y.first, z.first, x) &&
        IsSpanMarked(voxelizer, y.last, z.first, x) &&
        IsSpanMarked(voxelizer, y.first, z.last, x) && IsSpanMarked(voxelizer, y.last, z.last, x)) {
        return;
    }
    pvtSortByZ(t->corner);
    MarkSlabs(voxelizer, t, z, spans);
}

static bool ShouldStop(Voxelizer* voxelizer, size_t begin, int worker)
{
    if (pvtIsCancelled(voxelizer->context)) {
        atomic_store(&voxelizer->cancelled, true);
    }
    if (worker == 0) {
        pvtReportProgress(voxelizer->context,
                          (double)begin / (double)voxelizer->mesh->triangleCount);
    }
    return atomic_load(&voxelizer->cancelled);
}

static void MarkTriangles(size_t begin, size_t end, int worker, void* taskData)
{
    Voxelizer* voxelizer = taskData;
    const pvtMesh* mesh = voxelizer->mesh;
    const pvtVec3 origin = voxelizer->frame->origin;
    RowSpan* spans =
        voxelizer->spans + (size_t)worker * (size_t)voxelizer->layerCount * voxelizer->layerStep;
    for (size_t i = begin; i < end; ++i) {
        if ((i - begin) % CANCEL_INTERVAL == 0 && ShouldStop(voxelizer, i, worker)) {
            return;
        }
        Triangle t;
        for (int corner = 0; corner < 3; ++corner) {
            const pvtVec3 p = mesh->positions[mesh->indices[3 * i + (size_t)corner]];
            t.corner[corner] = pvtScale(pvtSub(p, origin), voxelizer->scale);
        }
        MarkTriangle(voxelizer, &t, spans);
    }
}

static pvtStatus MarkMesh(Voxelizer* voxelizer)
{
    assert(voxelizer->frame != NULL);
    pvtContext* context = voxelizer->context;
    const int parts = voxelizer->cells != NULL ? PVT_CELLS : 1;
    voxelizer->scale = parts / voxelizer->frame->voxelSize;
    voxelizer->layerCount = parts;
    voxelizer->layerStep =
        ((size_t)(voxelizer->frame->size[1] * parts) / ALIGN_INTS + 1) * ALIGN_INTS;
    const size_t layers = (size_t)pvtContext_GetThreadCount(context) * (size_t)parts;
    voxelizer->spans =
        pvtAllocate(context, layers * voxelizer->layerStep, sizeof *voxelizer->spans);
    if (voxelizer->spans == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtParallelFor(context, MarkTriangles, voxelizer->mesh->triangleCount, 1, voxelizer);
    pvtRelease(context, voxelizer->spans);
    return atomic_load(&voxelizer->cancelled) ? pvtFailCancelled(context) : PVT_OK;
}

pvtStatus pvtVoxelizeCells(pvtContext* context, const pvtMesh* mesh, pvtCellGrid* cells)
{
    Voxelizer voxelizer = {
        .context = context, .mesh = mesh, .frame = &cells->voxels.frame, .cells = cells};
    return MarkMesh(&voxelizer);
}

pvtStatus pvtVoxelizeMesh(pvtContext* context, const pvtVoxelizeOptions* options,
                          const pvtMesh* mesh, pvtBitGrid* surface)
{
    *surface = (pvtBitGrid){0};
    pvtBeginStage(context, "voxelize");
    pvtGridFrame frame;
    pvtStatus status = pvtMakeGridFrame(context, options, mesh, &frame);
    if (status == PVT_OK) {
        status = pvtCreateBitGrid(context, &frame, surface);
    }
    if (status == PVT_OK) {
        Voxelizer voxelizer = {
            .context = context, .mesh = mesh, .frame = &surface->frame, .grid = surface};
        status = MarkMesh(&voxelizer);
    }
    if (status != PVT_OK) {
        pvtBitGrid_Free(context, surface);
        return status;
    }
    pvtReportProgress(context, 1.0);
    return PVT_OK;
}
