// SPDX-License-Identifier: MIT
// How the faces around a corner of the voxel mesh share its vertices.
#ifndef PVT_VOXEL_MESH_TABLE_H
#define PVT_VOXEL_MESH_TABLE_H

#include <stdint.h>

/// A corner has eight voxels around it: bit ox + 2 oy + 4 oz of a pattern is set when the voxel on
/// the lower (0) or upper (1) side along each axis is. Between them lie 12 faces: face
/// 4 axis + ou + 2 ov separates the two voxels along `axis`, where u and v are the axes that
/// follow it in turn. Six half-edges leave the corner: half-edge 2 axis + side.
enum {
    PVT_CORNER_PATTERNS = 256,
    PVT_CORNER_FACES = 12,
    PVT_CORNER_JOINED = 256, ///< added to a pattern: faces meet across the free voxels
    PVT_CORNER_CASES = 512,
    PVT_NO_HALF_EDGE = 255,
};

typedef struct pvtCornerTable {
    uint8_t vertexCount[PVT_CORNER_CASES];
    uint8_t vertexOfFace[PVT_CORNER_CASES][PVT_CORNER_FACES];
    /// The half-edge, if any, that the corner's one vertex meets twice.
    uint8_t doubleEdge[PVT_CORNER_PATTERNS];
} pvtCornerTable;

void pvtMakeCornerTable(pvtCornerTable* table);

#endif
