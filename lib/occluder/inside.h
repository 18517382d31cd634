// SPDX-License-Identifier: MIT
// Whether a triangle, wherever it lies, stays inside.
#ifndef PVT_OCCLUDER_INSIDE_H
#define PVT_OCCLUDER_INSIDE_H

#include <paravent/occluder.h>

typedef struct pvtInsideTest {
    pvtInterior interior;
    int blockSize;  ///< [vx]
    int blocks[3];  ///< along each axis
    uint8_t* reach; ///< one a block: 0 when a voxel of it is clear, else how many blocks away,
                    ///< along the farthest axis, the nearest such block is
} pvtInsideTest;

/// [vx] How far beyond the face between two voxels or cells counts as on it.
#define PVT_INSIDE_SLACK (1.0 / 8192.0)

/// What `interior` refers to stays the caller's.
pvtStatus pvtCreateInsideTest(pvtContext* context, const pvtInterior* interior,
                              pvtInsideTest* test);
void pvtInsideTest_Free(pvtContext* context, pvtInsideTest* test);

/// A point in grid coordinates that is inside or in a border cell. Between voxels it is when one of
/// them is.
bool pvtInsideTest_HasPoint(const pvtInsideTest* test, pvtVec3 point);

/// Whether a triangle lies in allowed and border cells, somewhere in an allowed one, and crosses no
/// triangle of the surface in a border cell. Then none of it is outside, since whoever walks on it
/// from the inside never passes the surface.
bool pvtInsideTest_HasTriangle(const pvtInsideTest* test, const pvtVec3 corners[3]);
/// The same; when it is false, `outside` is a point of the triangle's plane where it is not inside,
/// beyond the triangle by less than a cell if at all, or where it crosses the surface.
bool pvtInsideTest_FindOutside(const pvtInsideTest* test, const pvtVec3 corners[3],
                               pvtVec3* outside);

/// Of a voxel of interior.cells, by its place there: cells that a triangle may enter.
static inline uint64_t pvtInsideTest_GetOpen(const pvtInsideTest* test, size_t place)
{
    const pvtCellGrid* cells = test->interior.cells;
    return cells->cells[place] | (test->interior.touching != NULL ? cells->border[place] : 0);
}

/// Place of a block in `reach`.
static inline size_t pvtInsideTest_GetBlock(const pvtInsideTest* test, int x, int y, int z)
{
    return ((size_t)z * (size_t)test->blocks[1] + (size_t)y) * (size_t)test->blocks[0] + (size_t)x;
}

/// One look at the blocks: whether a ball lies where voxels are allowed as wholes. False may be
/// wrong, by up to two blocks.
static inline bool pvtInsideTest_HasBall(const pvtInsideTest* test, const float center[3],
                                         float radius)
{
    const float scale = 1.0F / (float)test->blockSize;
    int block[3];
    for (int axis = 0; axis < 3; ++axis) {
        const float at = center[axis] * scale;
        if (!(at >= 0.0F) || at >= (float)test->blocks[axis]) {
            return false;
        }
        block[axis] = (int)at;
    }
    const int reach = test->reach[pvtInsideTest_GetBlock(test, block[0], block[1], block[2])];
    return radius <= (float)((reach - 1) * test->blockSize);
}

#endif
