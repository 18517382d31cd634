// SPDX-License-Identifier: MIT
// Room for meshes.
#ifndef PVT_MESH_ALLOCATE_H
#define PVT_MESH_ALLOCATE_H

#include <paravent/mesh.h>

/// PVT_LIMIT when indices do not reach that far.
pvtStatus pvtCheckMeshCounts(pvtContext* context, size_t positionCount, size_t triangleCount);

/// An empty mesh with room for these counts, which were checked.
pvtStatus pvtReserveMesh(pvtContext* context, size_t positionCount, size_t triangleCount,
                         pvtMesh* mesh);

#endif
