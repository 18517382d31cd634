// SPDX-License-Identifier: MIT
// Chamfer distances (Borgefors, Distance Transformations in Digital Images, 1986) with the weights
// 8, 11 and 14 in a band on both sides of the border, a row at a time. Nodes that are allowed in
// part start from their share of allowed cells, which for a flat border is its distance.
#include "field.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vectors.h"
#include "voxel/bit_grid.h"
#include "voxel/cell_grid.h"

#include <math.h>
#include <string.h>

enum {
    STEPS = PVT_FIELD_STEPS,
    ZERO = 128,                          // of the distances while they grow
    FAR = ZERO + STEPS * PVT_FIELD_BAND, // no sum of this and a weight passes 255
    EDGE = 11,                           // to a neighbour across an edge, in eighths
    CORNER = 14,
    SIDES = 2,
    BRICK = 4,
};

// Distances into one side, from the other one's nodes; rows have a node more at each end.
typedef struct Side {
    uint8_t* rows;
    int width, height, depth; // padded width
} Side;

typedef struct Maker {
    const pvtBitGrid* allowed;
    const pvtCellGrid* cells;
    pvtField* field;
    Side sides[SIDES]; // inside, outside
} Maker;

void pvtField_Free(pvtContext* context, pvtField* field)
{
    pvtRelease(context, field->depths);
    pvtRelease(context, field->places[0]);
    *field = (pvtField){0};
}

static uint8_t* GetRow(const Side* side, int y, int z)
{
    return side->rows + ((size_t)z * (size_t)side->height + (size_t)y) * (size_t)side->width;
}

// What of a node is inside, in 64ths of a voxel; the surface passes the middle of border cells.
static int CountAllowed(const Maker* maker, int x, int y, int z)
{
    const int n = maker->field->nodeSize;
    const int* size = maker->allowed->frame.size;
    int count = 0;
    for (int k = z * n; k < (z + 1) * n && k < size[2]; ++k) {
        for (int j = y * n; j < (y + 1) * n && j < size[1]; ++j) {
            const unsigned first = (unsigned)(x * n) & 63;
            const size_t word = (size_t)(x * n) / 64;
            const uint64_t mask = pvtMakeMask(first, first + (unsigned)n);
            count += 64 * pvtCountBits(pvtBitGrid_GetRow(maker->allowed, j, k)[word] & mask);
            if (maker->cells == NULL) {
                continue;
            }
            uint64_t some = pvtBitGrid_GetRow(&maker->cells->voxels, j, k)[word] & mask;
            for (; some != 0; some &= some - 1) {
                const int i = (int)(word * 64) + __builtin_ctzll(some);
                const size_t voxel = pvtCellGrid_Find(maker->cells, i, j, k);
                count += pvtCountBits(maker->cells->cells[voxel]);
                if (maker->cells->border != NULL) {
                    count += pvtCountBits(maker->cells->border[voxel]) / 2;
                }
            }
        }
    }
    return count;
}

// A node's own share tells how far it is from the border; nodes as a whole on one side of it are
// FAR on that side, and half a node away on the other.
static void StartNode(const Maker* maker, int x, int y, int z, uint8_t* inside, uint8_t* outside)
{
    const int n = maker->field->nodeSize;
    const int full = 64 * n * n * n;
    const int count = CountAllowed(maker, x, y, z);
    const int share = (2 * STEPS * count + full) / (2 * full) - STEPS / 2;
    *inside = (uint8_t)(count < full ? ZERO + share : FAR);
    *outside = (uint8_t)(count > 0 ? ZERO - share : FAR);
}

// Voxels of a node's rows that are allowed throughout, and those that are anywhere in part.
typedef struct RowBits {
    uint64_t all, some;
} RowBits;

static RowBits GetRowBits(const Maker* maker, int y, int z, size_t word)
{
    const int n = maker->field->nodeSize;
    const int* size = maker->allowed->frame.size;
    const bool isCut = (y + 1) * n > size[1] || (z + 1) * n > size[2];
    RowBits bits = {isCut ? 0 : ~UINT64_C(0), 0};
    for (int k = z * n; k < (z + 1) * n && k < size[2]; ++k) {
        for (int j = y * n; j < (y + 1) * n && j < size[1]; ++j) {
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

static void StartRow(const Maker* maker, int y, int z, uint8_t* inside, uint8_t* outside)
{
    const int n = maker->field->nodeSize, width = maker->field->size[0];
    const int perWord = 64 / n;
    const uint64_t node = pvtMakeMask(0, (unsigned)n);
    for (int first = 0; first < width; first += perWord) {
        const int count = width - first < perWord ? width - first : perWord;
        const RowBits bits = GetRowBits(maker, y, z, (size_t)(first / perWord));
        const bool isAll = bits.all == ~UINT64_C(0), isNone = bits.some == 0;
        memset(inside + first, isAll ? FAR : ZERO - STEPS / 2, (size_t)count);
        memset(outside + first, isNone ? FAR : ZERO - STEPS / 2, (size_t)count);
        for (int i = 0; i < count && !isAll && !isNone; ++i) {
            const uint64_t mask = node << (i * n);
            if ((bits.some & mask) == 0) {
                outside[first + i] = FAR;
            } else if ((bits.all & mask) == mask) {
                inside[first + i] = FAR;
            } else {
                StartNode(maker, first + i, y, z, inside + first + i, outside + first + i);
            }
        }
    }
}

static void StartLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Maker* maker = taskData;
    for (int z = (int)begin; z < (int)end; ++z) {
        for (int y = 0; y < maker->field->size[1]; ++y) {
            uint8_t* inside = GetRow(&maker->sides[0], y, z);
            uint8_t* outside = GetRow(&maker->sides[1], y, z);
            memset(inside, FAR, (size_t)maker->sides[0].width);
            memset(outside, FAR, (size_t)maker->sides[0].width);
            StartRow(maker, y, z, inside + 1, outside + 1);
        }
    }
}

PVT_VECTOR_CLONES
static void RelaxFromRow(const uint8_t* restrict from, int width, int straight, int slanted,
                         uint8_t* restrict row)
{
    for (int x = 1; x < width - 1; ++x) {
        const uint8_t side = from[x - 1] < from[x + 1] ? from[x - 1] : from[x + 1];
        const uint8_t a = (uint8_t)(from[x] + straight);
        const uint8_t b = (uint8_t)(side + slanted);
        const uint8_t least = a < b ? a : b;
        row[x] = least < row[x] ? least : row[x];
    }
}

// From `step` nodes away on both sides, through `copy`, which has as many more at its ends.
PVT_VECTOR_CLONES
static void RelaxWithin(const uint8_t* restrict copy, int width, int step, uint8_t* restrict row)
{
    const uint8_t added = (uint8_t)(STEPS * step);
    for (int x = 0; x < width; ++x) {
        const uint8_t left = copy[x - step], right = copy[x + step];
        const uint8_t side = left < right ? left : right;
        // The nearest that could still matter, so that no sum wraps around.
        const uint8_t near = side < FAR - added ? (uint8_t)(side + added) : FAR;
        row[x] = near < row[x] ? near : row[x];
    }
}

enum { MOST_STEP = 8 };

static void RelaxRow(const Side* side, int y, int z, int way, uint8_t* buffer)
{
    uint8_t* row = GetRow(side, y, z);
    const int width = side->width;
    for (int i = 0; i < 4; ++i) {
        // The row before in this layer, and three of the layer before.
        const int fromY = i == 0 ? y - way : y + i - 2;
        const int fromZ = i == 0 ? z : z - way;
        if (fromY < 0 || fromY >= side->height || fromZ < 0 || fromZ >= side->depth) {
            continue;
        }
        const bool isStraight = i == 0 || i == 2;
        RelaxFromRow(GetRow(side, fromY, fromZ), width, isStraight ? STEPS : EDGE,
                     isStraight ? EDGE : CORNER, row);
    }
    for (int step = 1; step <= MOST_STEP; step *= 2) {
        memcpy(buffer + MOST_STEP, row, (size_t)width);
        RelaxWithin(buffer + MOST_STEP, width, step, row);
    }
}

static void SpreadSides(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Maker* maker = taskData;
    enum { MOST_WIDTH = 2048 + 2 * MOST_STEP };
    uint8_t buffer[MOST_WIDTH];
    memset(buffer, FAR, sizeof buffer);
    for (size_t s = begin; s < end; ++s) {
        const Side* side = &maker->sides[s];
        for (int z = 0; z < side->depth; ++z) {
            for (int y = 0; y < side->height; ++y) {
                RelaxRow(side, y, z, 1, buffer);
            }
        }
        for (int z = side->depth - 1; z >= 0; --z) {
            for (int y = side->height - 1; y >= 0; --y) {
                RelaxRow(side, y, z, -1, buffer);
            }
        }
    }
}

// A node that is allowed in part has the same distance in both; what is clear as a whole counts as
// half a node away from the inside, which is as low as that goes.
static void JoinSides(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Maker* maker = taskData;
    const pvtField* field = maker->field;
    for (int z = (int)begin; z < (int)end; ++z) {
        for (int y = 0; y < field->size[1]; ++y) {
            const uint8_t* inside = GetRow(&maker->sides[0], y, z) + 1;
            const uint8_t* outside = GetRow(&maker->sides[1], y, z) + 1;
            int8_t* row = field->depths + field->places[1][y] + field->places[2][z];
            for (int x = 0; x < field->size[0]; ++x) {
                const int in = inside[x] - ZERO, out = outside[x] - ZERO;
                row[field->places[0][x]] = (int8_t)(in > -STEPS / 2 ? in : -out);
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
    field->depths = pvtAllocate(context, nodes, sizeof *field->depths);
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

static pvtStatus MakeSides(pvtContext* context, Maker* maker)
{
    const int* size = maker->field->size;
    const size_t rows = (size_t)size[1] * (size_t)size[2];
    for (int s = 0; s < SIDES; ++s) {
        Side* side = &maker->sides[s];
        *side = (Side){NULL, size[0] + 2, size[1], size[2]};
        side->rows = pvtAllocate(context, rows, (size_t)side->width);
        if (side->rows == NULL) {
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
    Maker maker = {allowed, cells != NULL && cells->count > 0 ? cells : NULL, field, {{0}, {0}}};
    pvtStatus status = MakePlaces(context, field);
    if (status == PVT_OK) {
        status = MakeSides(context, &maker);
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, StartLayers, (size_t)field->size[2], 4, &maker);
        pvtParallelFor(context, SpreadSides, SIDES, 1, &maker);
        pvtParallelFor(context, JoinSides, (size_t)field->size[2], 4, &maker);
    } else {
        pvtField_Free(context, field);
    }
    for (int s = 0; s < SIDES; ++s) {
        pvtRelease(context, maker.sides[s].rows);
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
