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

// All nodes of a layer, as far from the border as their own share tells.
static void StartLayers(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Maker* maker = taskData;
    const int* size = maker->field->size;
    const int n = maker->field->nodeSize;
    const int full = 64 * n * n * n;
    for (int z = (int)begin; z < (int)end; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            uint8_t* inside = GetRow(&maker->sides[0], y, z);
            uint8_t* outside = GetRow(&maker->sides[1], y, z);
            memset(inside, FAR, (size_t)maker->sides[0].width);
            memset(outside, FAR, (size_t)maker->sides[0].width);
            for (int x = 0; x < size[0]; ++x) {
                const int count = CountAllowed(maker, x, y, z);
                const int share = (2 * STEPS * count + full) / (2 * full) - STEPS / 2;
                if (count < full) {
                    inside[x + 1] = (uint8_t)(ZERO + share);
                }
                if (count > 0) {
                    outside[x + 1] = (uint8_t)(ZERO - share);
                }
            }
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
static void JoinSides(const Maker* maker)
{
    const int* size = maker->field->size;
    int8_t* depths = maker->field->depths;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            const uint8_t* inside = GetRow(&maker->sides[0], y, z) + 1;
            const uint8_t* outside = GetRow(&maker->sides[1], y, z) + 1;
            for (int x = 0; x < size[0]; ++x) {
                const int in = inside[x] - ZERO, out = outside[x] - ZERO;
                *depths++ = (int8_t)(in > -STEPS / 2 ? in : -out);
            }
        }
    }
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
    size_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        field->size[axis] = (size[axis] + field->nodeSize - 1) / field->nodeSize;
        count *= (size_t)field->size[axis];
    }
    Maker maker = {allowed, cells != NULL && cells->count > 0 ? cells : NULL, field, {{0}, {0}}};
    field->depths = pvtAllocate(context, count, sizeof *field->depths);
    pvtStatus status = field->depths == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    for (int s = 0; s < SIDES && status == PVT_OK; ++s) {
        Side* side = &maker.sides[s];
        *side = (Side){NULL, field->size[0] + 2, field->size[1], field->size[2]};
        side->rows = pvtAllocate(context, count / (size_t)field->size[0], (size_t)side->width);
        status = side->rows == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, StartLayers, (size_t)field->size[2], 4, &maker);
        pvtParallelFor(context, SpreadSides, SIDES, 1, &maker);
        JoinSides(&maker);
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
        const int8_t* nodes = place.nodes + (i & 1) * place.row + (i >> 1) * place.layer;
        slopes[i] = (float)(nodes[1] - nodes[0]);
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
