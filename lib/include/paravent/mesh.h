// SPDX-License-Identifier: MIT
// Indexed triangle soup. Nothing is asked of it: holes, flips, duplicates and slivers are fine.
#ifndef PARAVENT_MESH_H
#define PARAVENT_MESH_H

#include <paravent/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Three indices a triangle, each below positionCount. Positions are finite [wu].
typedef struct pvtMesh {
    pvtVec3* positions; ///< positionCount
    uint32_t* indices;  ///< 3 × triangleCount
    size_t positionCount;
    size_t triangleCount;
} pvtMesh;

PVT_API void pvtMesh_Free(pvtContext* context, pvtMesh* mesh);

/// Copies and checks: PVT_INVALID_INPUT names the first index out of range or position that is
/// not finite. `indices` may be null: then every three positions are a triangle.
PVT_API pvtStatus pvtCreateMesh(pvtContext* context, const pvtVec3* positions, size_t positionCount,
                                const uint32_t* indices, size_t triangleCount, pvtMesh* mesh);

/// The box around the positions that triangles use; empty for a mesh without triangles.
PVT_API pvtBox3 pvtMesh_GetBounds(const pvtMesh* mesh);

/// Merges positions that are equal to the last bit (0 and −0 are) and drops the unused. Order of
/// first use.
PVT_API pvtStatus pvtWeldMesh(pvtContext* context, const pvtMesh* mesh, pvtMesh* welded);

/// A mesh and where it stands. The transform has 16 numbers, column after column; null: none.
typedef struct pvtPlacedMesh {
    const pvtMesh* mesh;
    const double* transform;
} pvtPlacedMesh;

/// All of them as one mesh, one behind the other. A transform that mirrors turns the triangles
/// round, so that they face the same side as before. PVT_INVALID_INPUT for a position that does not
/// stay finite.
PVT_API pvtStatus pvtPlaceMeshes(pvtContext* context, const pvtPlacedMesh* placed, size_t count,
                                 pvtMesh* joined);

typedef struct pvtFaceDirectionOptions {
    int maxCount;       ///< 1 to 256, default 16: most directions that come out
    double angle;       ///< [rad] faces closer than this share a cluster; default 0.12
    double minFraction; ///< of the whole area; smaller clusters are dropped; default 0.005
} pvtFaceDirectionOptions;

/// One cluster of parallel faces; direction and its opposite are the same.
typedef struct pvtFaceDirection {
    pvtVec3 direction; ///< unit; the first coordinate that is not 0 is positive
    double area;       ///< [wu²]
} pvtFaceDirection;

typedef struct pvtFaceDirectionSet {
    pvtFaceDirection* directions; ///< falling area
    size_t count;
} pvtFaceDirectionSet;

PVT_API pvtFaceDirectionOptions pvtDefaultFaceDirectionOptions(void);

/// The directions that most of the surface faces, clustered by area: a building's walls and roofs.
PVT_API pvtStatus pvtFindFaceDirections(pvtContext* context, const pvtFaceDirectionOptions* options,
                                        const pvtMesh* mesh, pvtFaceDirectionSet* set);
PVT_API void pvtFaceDirectionSet_Free(pvtContext* context, pvtFaceDirectionSet* set);

#ifdef __cplusplus
}
#endif
#endif
