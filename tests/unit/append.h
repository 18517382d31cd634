// SPDX-License-Identifier: MIT
#ifndef PVT_TEST_APPEND_H
#define PVT_TEST_APPEND_H

#include <paravent/mesh.h>

/// Puts `other`'s triangles behind those of `mesh`; on failure `mesh` is as it was.
static inline pvtStatus AppendMesh(pvtContext* context, pvtMesh* mesh, const pvtMesh* other)
{
    const pvtPlacedMesh both[2] = {{mesh, NULL}, {other, NULL}};
    pvtMesh whole;
    const pvtStatus status = pvtPlaceMeshes(context, both, 2, &whole);
    if (status == PVT_OK) {
        pvtMesh_Free(context, mesh);
        *mesh = whole;
    }
    return status;
}

#endif
