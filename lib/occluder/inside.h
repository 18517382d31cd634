// SPDX-License-Identifier: MIT
// Whether a triangle, wherever it lies, stays in what is allowed.
#ifndef PVT_OCCLUDER_INSIDE_H
#define PVT_OCCLUDER_INSIDE_H

#include <paravent/voxel.h>

typedef struct pvtInsideTest {
    const pvtBitGrid* allowed; ///< borrowed
    const pvtCellGrid* cells;  ///< borrowed; null: none
    int blockSize;             ///< [vx]
    int blocks[3];             ///< along each axis
    uint8_t* reach; ///< one a block: 0 when a voxel of it is clear, else how many blocks away,
                    ///< along the farthest axis, the nearest such block is
} pvtInsideTest;

/// `cells` may be null. Both stay the caller's.
pvtStatus pvtCreateInsideTest(pvtContext* context, const pvtBitGrid* allowed,
                              const pvtCellGrid* cells, pvtInsideTest* test);
void pvtInsideTest_Free(pvtContext* context, pvtInsideTest* test);

/// A point in grid coordinates. On the border between voxels it is inside when one of them is.
bool pvtInsideTest_HasPoint(const pvtInsideTest* test, pvtVec3 point);

/// False also when a triangle is inside but passes a clear voxel or cell so closely that telling
/// them apart would take pieces below 1/24 voxel.
bool pvtInsideTest_HasTriangle(const pvtInsideTest* test, const pvtVec3 corners[3]);

#endif
