// SPDX-License-Identifier: MIT
// What the voxel room's own files use of bit grids.
#ifndef PVT_VOXEL_BIT_GRID_H
#define PVT_VOXEL_BIT_GRID_H

#include "base/bits.h"
#include "base/vector.h"

#include <paravent/voxel.h>

/// Most voxels along a side, padding included.
enum { PVT_MAX_GRID_SIDE = 16384 };

/// Voxels from lower to upper − 1 along each axis.
typedef struct pvtGridBox {
    int lower[3], upper[3];
} pvtGridBox;

/// All bits 0. *grid is empty on failure.
pvtStatus pvtCreateBitGrid(pvtContext* context, const pvtGridFrame* frame, pvtBitGrid* grid);
pvtStatus pvtCopyBitGrid(pvtContext* context, const pvtBitGrid* grid, pvtBitGrid* copy);
/// The smallest box around all set bits; false when there are none.
bool pvtBitGrid_FindBounds(const pvtBitGrid* grid, pvtGridBox* box);

/// World to grid coordinates [vx].
static inline pvtVec3 pvtToGrid(const pvtGridFrame* frame, pvtVec3 place)
{
    return pvtScale(pvtSub(place, frame->origin), 1.0 / frame->voxelSize);
}

/// The same of a triangle's corners, from the least one on: what is computed from them does not
/// depend on which one a file names first.
static inline void pvtGetGridTriangle(const pvtGridFrame* frame, const pvtMesh* mesh,
                                      size_t triangle, pvtVec3 corners[3])
{
    const pvtVec3* positions = mesh->positions;
    const uint32_t* indices = mesh->indices + 3 * triangle;
    size_t first = 0;
    for (size_t k = 1; k < 3; ++k) {
        first = pvtIsBefore(positions[indices[k]], positions[indices[first]]) ? k : first;
    }
    for (size_t k = 0; k < 3; ++k) {
        corners[k] = pvtToGrid(frame, positions[indices[(first + k) % 3]]);
    }
}

/// The greatest of a grid's three sizes.
static inline int pvtGetLongestSide(const int size[3])
{
    const int longer = size[0] > size[1] ? size[0] : size[1];
    return longer > size[2] ? longer : size[2];
}

static inline double pvtGridBox_GetVolume(const pvtGridBox* box)
{
    return (double)(box->upper[0] - box->lower[0]) * (double)(box->upper[1] - box->lower[1]) *
           (double)(box->upper[2] - box->lower[2]);
}

/// A grid of the same voxels, `offset` voxels farther from its lower corner, in a frame of `size`:
/// padded where it grows, cropped where it shrinks.
pvtStatus pvtMoveBitGrid(pvtContext* context, const pvtBitGrid* grid, const int offset[3],
                         const int size[3], pvtBitGrid* moved);
/// Every voxel that is not set.
void pvtBitGrid_Complement(pvtBitGrid* grid);
/// Sets all voxels from `begin` to `end` − 1 along an axis.
void pvtBitGrid_SetLayers(pvtBitGrid* grid, pvtAxis axis, int begin, int end);
/// PVT_LIMIT, with the resolution that would fit, when `count` more grids like this one do not fit
/// in the memory limit.
pvtStatus pvtCheckGridMemory(pvtContext* context, const pvtBitGrid* grid, double count,
                             const char* purpose);

static inline size_t pvtGetRowIndex(const pvtBitGrid* grid, int y, int z)
{
    return (size_t)z * (size_t)grid->frame.size[1] + (size_t)y;
}

static inline uint64_t* pvtBitGrid_GetRow(const pvtBitGrid* grid, int y, int z)
{
    return grid->words + pvtGetRowIndex(grid, y, z) * grid->wordsPerRow;
}

/// The bits of a row's last word that stand for voxels.
static inline uint64_t pvtBitGrid_GetTailMask(const pvtBitGrid* grid)
{
    return ~UINT64_C(0) >> ((64 - grid->frame.size[0] % 64) % 64);
}

#endif
