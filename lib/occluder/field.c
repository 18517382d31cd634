// SPDX-License-Identifier: MIT
// Chamfer distances (Borgefors, Distance Transformations in Digital Images, 1986) with the weights
// 8, 11 and 14 in a band on both sides of the border, a row at a time. Nodes that are allowed in
// part start from their share of allowed cells, which for a flat border is its distance. Distances
// into the inside and out of it are kept in one number, above and below 0, and found together.
#include "field.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vectors.h"
#include "voxel/bit_grid.h"
#include "voxel/cell_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    STEPS = PVT_FIELD_STEPS,
    FAR = STEPS * PVT_FIELD_BAND, // no sum of this and a weight passes 127
    NEAR = STEPS / 2,             // of a node as a whole on one side from the border of its own
    EDGE = 11,                    // to a neighbour across an edge, in eighths
    CORNER = 14,
    SLABS = 2,
    MOST_STEP = 8, // along a row
    MOST_WIDTH = 2048 + 2 * MOST_STEP,
    BRICK = 4,
};

// Layers that are made at once, with those around them from which distances may come: so slabs do
// not wait for each other. Rows have a node more at each end.
typedef struct Slab {
    int8_t* rows;
    uint8_t* kinds;           // of the rows
    int width, height, depth; // padded width
    int from;                 // the first layer
    int begin, end;           // the layers of its own
} Slab;

// A row whose nodes are all the same stays as it is while the rows are, too, that it is relaxed
// from.
typedef enum RowKind { ROW_MIXED, ROW_INSIDE, ROW_OUTSIDE } RowKind;

typedef struct Maker {
    const pvtBitGrid* allowed;
    const pvtCellGrid* cells;
    pvtField* field;
    Slab slabs[SLABS];
} Maker;

void pvtField_Free(pvtContext* context, pvtField* field)
{
    pvtRelease(context, field->depths);
    pvtRelease(context, field->places[0]);
    *field = (pvtField){0};
}

static size_t GetRowIndex(const Slab* slab, int y, int z)
{
    return (size_t)(z - slab->from) * (size_t)slab->height + (size_t)y;
}

static int8_t* GetRow(const Slab* slab, int y, int z)
{
    return slab->rows + GetRowIndex(slab, y, z) * (size_t)slab->width;
}

static RowKind FindKind(const int8_t* row, int width)
{
    const bool isSame = memcmp(row, row + 1, (size_t)width - 1) == 0;
    return !isSame || abs(row[0]) != FAR ? ROW_MIXED : row[0] > 0 ? ROW_INSIDE : ROW_OUTSIDE;
}

// The rows of voxels that a row of nodes has, as far as there are any.
typedef struct NodeRows {
    int begin[2], end[2]; // y and z [vx]
    bool isCut;           // by the end of the grid
} NodeRows;

PVT_IN_CLONES NodeRows GetNodeRows(const Maker* maker, int y, int z)
{
    const int n = maker->field->nodeSize;
    const int* size = maker->allowed->frame.size;
    NodeRows rows = {{y * n, z * n}, {(y + 1) * n, (z + 1) * n}, false};
    for (int i = 0; i < 2; ++i) {
        rows.isCut = rows.isCut || rows.end[i] > size[i + 1];
        rows.end[i] = rows.end[i] < size[i + 1] ? rows.end[i] : size[i + 1];
    }
    return rows;
}

// Of a word of voxels along x, those that are allowed in all rows, and those that are in part in
// any.
typedef struct WordBits {
    uint64_t all, some;
} WordBits;

PVT_IN_CLONES WordBits GetWordBits(const Maker* maker, const NodeRows* rows, size_t word)
{
    WordBits bits = {rows->isCut ? 0 : ~UINT64_C(0), 0};
    for (int k = rows->begin[1]; k < rows->end[1]; ++k) {
        for (int j = rows->begin[0]; j < rows->end[0]; ++j) {
            const uint64_t allowed = pvtBitGrid_GetRow(maker->allowed, j, k)[word];
            bits.all &= allowed;
            bits.some |= allowed;
            if (maker->cells != NULL) {
                bits.some |= pvtBitGrid_GetRow(&maker->cells->voxels, j, k)[word];
            }
        }
    }
    return bits;
}

// What of each node of a word is inside, in 64ths of a voxel; the surface passes the middle of
// border cells.
PVT_IN_CLONES void CountWord(const Maker* maker, const NodeRows* rows, size_t word, int counts[64])
{
    const int n = maker->field->nodeSize;
    const uint64_t node = pvtMakeMask(0, (unsigned)n);
    const pvtCellGrid* cells = maker->cells;
    memset(counts, 0, 64 * sizeof *counts);
    for (int k = rows->begin[1]; k < rows->end[1]; ++k) {
        for (int j = rows->begin[0]; j < rows->end[0]; ++j) {
            const uint64_t allowed = pvtBitGrid_GetRow(maker->allowed, j, k)[word];
            for (int i = 0; i < 64 / n && allowed != 0; ++i) {
                counts[i] += 64 * pvtCountBits(allowed >> (i * n) & node);
            }
            const size_t at =
                pvtGetRowIndex(maker->allowed, j, k) * maker->allowed->wordsPerRow + word;
            uint64_t some = cells != NULL ? cells->voxels.words[at] : 0;
            size_t voxel = some != 0 ? cells->ranks[at] : 0;
            for (; some != 0; some &= some - 1, ++voxel) {
                const uint64_t border = cells->border != NULL ? cells->border[voxel] : 0;
                counts[__builtin_ctzll(some) / n] +=
                    pvtCountBits(cells->cells[voxel]) + pvtCountBits(border) / 2;
            }
        }
    }
}

// A node's own share tells how far it is from the border. `full` is a power of two, 1 << shift.
PVT_IN_CLONES int8_t GetShare(int count, int shift)
{
    const int full = 1 << shift;
    const int share = ((2 * STEPS * count + full) >> (shift + 1)) - NEAR;
    return (int8_t)(count == 0 ? -FAR : count < full ? share : FAR);
}

PVT_VECTOR_CLONES
static void StartRow(const Maker* maker, int y, int z, int8_t* row)
{
    const int n = maker->field->nodeSize, width = maker->field->size[0];
    const int perWord = 64 / n;
    const int shift = 6 + 3 * __builtin_ctz((unsigned)n);
    const NodeRows rows = GetNodeRows(maker, y, z);
    for (int first = 0; first < width; first += perWord) {
        const size_t word = (size_t)(first / perWord);
        const int count = width - first < perWord ? width - first : perWord;
        const WordBits bits = GetWordBits(maker, &rows, word);
        if (bits.all == ~UINT64_C(0) || bits.some == 0) {
            memset(row + first, bits.some == 0 ? -FAR : FAR, (size_t)count);
            continue;
        }
        int counts[64];
        CountWord(maker, &rows, word, counts);
        for (int i = 0; i < count; ++i) {
            row[first + i] = GetShare(counts[i], shift);
        }
    }
}

static inline int8_t GetLeast(int8_t a, int8_t b)
{
    return a < b ? a : b;
}

static inline int8_t GetMost(int8_t a, int8_t b)
{
    return a > b ? a : b;
}

// Nodes inside get nearer to the border from below, those outside from above, and the border's own
// never: to either side the other one counts as half a node away as a whole.
static inline int8_t Relax(int8_t node, int8_t inside, int8_t outside)
{
    return GetMost(GetLeast(node, inside), outside);
}

PVT_VECTOR_CLONES
static void RelaxFromRow(const int8_t* restrict from, int width, int straight, int slanted,
                         int8_t* restrict row)
{
    for (int x = 1; x < width - 1; ++x) {
        const int8_t low = GetLeast(from[x - 1], from[x + 1]);
        const int8_t high = GetMost(from[x - 1], from[x + 1]);
        const int8_t inside = GetLeast((int8_t)(GetMost(from[x], -NEAR) + straight),
                                       (int8_t)(GetMost(low, -NEAR) + slanted));
        const int8_t outside = GetMost((int8_t)(GetLeast(from[x], NEAR) - straight),
                                       (int8_t)(GetLeast(high, NEAR) - slanted));
        row[x] = Relax(row[x], inside, outside);
    }
}

// From `step` nodes away on both sides, through `copy`, which has as many more at its ends.
PVT_VECTOR_CLONES
static void RelaxWithin(const int8_t* restrict copy, int width, int step, int8_t* restrict row)
{
    const int8_t added = (int8_t)(STEPS * step);
    // The farthest that could still matter, so that no sum passes what a byte holds.
    const int8_t most = (int8_t)(FAR - added);
    for (int x = 0; x < width; ++x) {
        const int8_t low = GetLeast(copy[x - step], copy[x + step]);
        const int8_t high = GetMost(copy[x - step], copy[x + step]);
        const int8_t inside = (int8_t)(GetLeast(GetMost(low, -NEAR), most) + added);
        const int8_t outside = (int8_t)(GetMost(GetLeast(high, NEAR), (int8_t)-most) - added);
        row[x] = Relax(row[x], inside, outside);
    }
}

// What lies beyond the ends of a row is as the nodes there, which keeps it from mattering.
static void FillEnds(int8_t* first, int width, int length)
{
    memset(first - length, first[0], (size_t)length);
    memset(first + width, first[width - 1], (size_t)length);
}

// The rows that one is relaxed from: that before it in its layer, and three of the layer before. As
// many as there are.
static int FindSources(const Slab* slab, int y, int z, int way, int sources[4][2])
{
    int count = 0;
    for (int i = 0; i < 4; ++i) {
        const int fromY = i == 0 ? y - way : y + i - 2;
        const int fromZ = i == 0 ? z : z - way;
        if (fromY >= 0 && fromY < slab->height && fromZ >= slab->from &&
            fromZ < slab->from + slab->depth) {
            sources[count][0] = fromY;
            sources[count++][1] = fromZ;
        }
    }
    return count;
}

static void RelaxRow(const Slab* slab, int y, int z, int way, int8_t* buffer)
{
    uint8_t* kind = &slab->kinds[GetRowIndex(slab, y, z)];
    int8_t* row = GetRow(slab, y, z);
    const int width = slab->width;
    int sources[4][2];
    const int count = FindSources(slab, y, z, way, sources);
    bool isSame = *kind != ROW_MIXED;
    for (int i = 0; i < count && isSame; ++i) {
        isSame = slab->kinds[GetRowIndex(slab, sources[i][0], sources[i][1])] == *kind;
    }
    if (isSame) {
        return;
    }
    for (int i = 0; i < count; ++i) {
        const bool isStraight = sources[i][0] == y || sources[i][1] == z;
        RelaxFromRow(GetRow(slab, sources[i][0], sources[i][1]), width, isStraight ? STEPS : EDGE,
                     isStraight ? EDGE : CORNER, row);
    }
    for (int step = 1; step <= MOST_STEP; step *= 2) {
        memcpy(buffer + MOST_STEP, row + 1, (size_t)width - 2);
        FillEnds(buffer + MOST_STEP, width - 2, MOST_STEP);
        RelaxWithin(buffer + MOST_STEP, width - 2, step, row + 1);
    }
    FillEnds(row + 1, width - 2, 1);
    *kind = (uint8_t)FindKind(row, width);
}

static void StoreRow(const pvtField* field, int y, int z, const int8_t* row)
{
    int8_t* depths = field->depths + field->places[1][y] + field->places[2][z];
    const int width = field->size[0], whole = width / BRICK * BRICK;
    for (int x = 0; x < whole; x += BRICK) {
        memcpy(depths + field->places[0][x], row + x, BRICK);
    }
    for (int x = whole; x < width; ++x) {
        depths[field->places[0][x]] = row[x];
    }
}

static void MakeSlabs(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Maker* maker = taskData;
    int8_t buffer[MOST_WIDTH];
    for (size_t s = begin; s < end; ++s) {
        const Slab* slab = &maker->slabs[s];
        const int last = slab->from + slab->depth - 1;
        for (int z = slab->from; z <= last; ++z) {
            for (int y = 0; y < slab->height; ++y) {
                int8_t* row = GetRow(slab, y, z);
                StartRow(maker, y, z, row + 1);
                FillEnds(row + 1, slab->width - 2, 1);
                slab->kinds[GetRowIndex(slab, y, z)] = (uint8_t)FindKind(row, slab->width);
                RelaxRow(slab, y, z, 1, buffer);
            }
        }
        for (int z = last; z >= slab->from; --z) {
            for (int y = slab->height - 1; y >= 0; --y) {
                RelaxRow(slab, y, z, -1, buffer);
                if (z >= slab->begin && z < slab->end) {
                    StoreRow(maker->field, y, z, GetRow(slab, y, z) + 1);
                }
            }
        }
    }
}

// Both ends of the last pair of nodes may be looked at when there is one only.
static pvtStatus MakePlaces(pvtContext* context, pvtField* field)
{
    size_t bricks[3], length = 0;
    for (int axis = 0; axis < 3; ++axis) {
        bricks[axis] = ((size_t)field->size[axis] + BRICK - 1) / BRICK;
        length += (size_t)field->size[axis] + 1;
    }
    uint32_t* next = pvtAllocate(context, length, sizeof *next);
    const size_t nodes = bricks[0] * bricks[1] * bricks[2] * BRICK * BRICK * BRICK;
    field->places[0] = next;
    field->depths = pvtAllocateUnset(context, nodes, sizeof *field->depths);
    if (next == NULL || field->depths == NULL) {
        return pvtContext_GetStatus(context);
    }
    size_t within = 1, brick = BRICK * BRICK * BRICK;
    for (int axis = 0; axis < 3; ++axis) {
        const size_t count = (size_t)field->size[axis];
        field->places[axis] = next;
        for (size_t i = 0; i <= count; ++i) {
            const size_t at = i < count ? i : count - 1;
            *next++ = (uint32_t)(at % BRICK * within + at / BRICK * brick);
        }
        within *= BRICK;
        brick *= bricks[axis];
    }
    return PVT_OK;
}

static pvtStatus PlaceSlabs(pvtContext* context, Maker* maker)
{
    const int* size = maker->field->size;
    for (int s = 0; s < SLABS; ++s) {
        Slab* slab = &maker->slabs[s];
        const int begin = size[2] * s / SLABS, end = size[2] * (s + 1) / SLABS;
        const int from = begin > PVT_FIELD_BAND ? begin - PVT_FIELD_BAND : 0;
        const int stop = end + PVT_FIELD_BAND < size[2] ? end + PVT_FIELD_BAND : size[2];
        *slab = (Slab){NULL, NULL, size[0] + 2, size[1], stop - from, from, begin, end};
        const size_t rows = (size_t)slab->height * (size_t)slab->depth;
        slab->rows = pvtAllocateUnset(context, rows, (size_t)slab->width);
        slab->kinds = pvtAllocateUnset(context, rows, sizeof *slab->kinds);
        if (slab->rows == NULL || slab->kinds == NULL) {
            return pvtContext_GetStatus(context);
        }
    }
    return PVT_OK;
}

pvtStatus pvtCreateField(pvtContext* context, const pvtBitGrid* allowed, const pvtCellGrid* cells,
                         int resolution, pvtField* field)
{
    const int* size = allowed->frame.size;
    const int longest = pvtGetLongestSide(size);
    *field = (pvtField){.nodeSize = 1};
    // Powers of two up to a word, so that a node's voxels lie in one.
    while (longest > resolution * field->nodeSize && field->nodeSize < 64) {
        field->nodeSize *= 2;
    }
    field->scale = 1.0F / (float)field->nodeSize;
    for (int axis = 0; axis < 3; ++axis) {
        field->size[axis] = (size[axis] + field->nodeSize - 1) / field->nodeSize;
    }
    Maker maker = {allowed, cells != NULL && cells->count > 0 ? cells : NULL, field, {{0}}};
    pvtStatus status = MakePlaces(context, field);
    if (status == PVT_OK) {
        status = PlaceSlabs(context, &maker);
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, MakeSlabs, SLABS, 1, &maker);
    } else {
        pvtField_Free(context, field);
    }
    for (int s = 0; s < SLABS; ++s) {
        pvtRelease(context, maker.slabs[s].rows);
        pvtRelease(context, maker.slabs[s].kinds);
    }
    return status;
}

float pvtField_GetDepthAndInward(const pvtField* field, const float point[3], float inward[3])
{
    const pvtFieldPlace place = pvtField_FindPlace(field, point);
    const float* part = place.part;
    float x[4];
    pvtMixAlongX(&place, x);
    float slopes[4];
    for (size_t i = 0; i < 4; ++i) {
        slopes[i] = place.nodes[2 * i + 1] - place.nodes[2 * i];
    }
    inward[0] = pvtMix(pvtMix(slopes[0], slopes[1], part[1]), pvtMix(slopes[2], slopes[3], part[1]),
                       part[2]);
    inward[1] = pvtMix(x[1] - x[0], x[3] - x[2], part[2]);
    const float front = pvtMix(x[0], x[1], part[1]), back = pvtMix(x[2], x[3], part[1]);
    inward[2] = back - front;
    const float length =
        sqrtf(inward[0] * inward[0] + inward[1] * inward[1] + inward[2] * inward[2]);
    for (int axis = 0; axis < 3 && length > 0.0F; ++axis) {
        inward[axis] /= length;
    }
    return pvtMix(front, back, part[2]) * (float)field->nodeSize / STEPS;
}
