// SPDX-License-Identifier: MIT
// A mesh made ready for drawing from many sides: checked, and without what no triangle uses.
#ifndef PVT_EVALUATE_SOUP_H
#define PVT_EVALUATE_SOUP_H

#include <paravent/mesh.h>

typedef struct pvtSoup {
    pvtVec3* positions; ///< in the order of their first use, so that triangles find them close by
    uint32_t* indices;  ///< 3 × triangleCount
    size_t positionCount;
    size_t triangleCount; ///< those with three different corners
    pvtBox3 bounds;       ///< of the positions; empty (lower above upper) without triangles
} pvtSoup;

/// `name` is what the message calls the mesh. PVT_INVALID_INPUT for an index out of range and for
/// a used position that is not finite or has a coordinate beyond ±10¹⁰⁰.
pvtStatus pvtCreateSoup(pvtContext* context, const char* name, const pvtMesh* mesh, pvtSoup* soup);
void pvtSoup_Free(pvtContext* context, pvtSoup* soup);

#endif
