// SPDX-License-Identifier: MIT
// Puts instances of meshes together to a model: transforms, winding, what is not finite.
#ifndef PVT_IO_BUILDER_H
#define PVT_IO_BUILDER_H

#include <paravent/io.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A mesh as its file has it, in its own space. Positions may be anything; indices are checked.
typedef struct pvtLocalMesh {
    const pvtVec3* positions;
    const uint32_t* indices;
    size_t positionCount, triangleCount;
} pvtLocalMesh;

typedef struct pvtModelBuilder {
    pvtContext* context;
    const char* path;
    bool keepsMeshes; ///< fills the model's meshes
    pvtModel model;
    size_t positionRoom, triangleRoom, partRoom, localRoom;
    size_t dropped; ///< triangles with a position that is not finite
} pvtModelBuilder;

/// Room for all parts to come. PVT_LIMIT when it does not fit in memory or in 32-bit indices.
pvtStatus pvtModelBuilder_Reserve(pvtModelBuilder* builder, size_t positionCount,
                                  size_t triangleCount, size_t partCount);

/// Adds an instance of `mesh`; `name` is cleaned to be UTF-8. No part comes of an instance that
/// has no triangle. Coordinates beyond a float's range count as not finite, since no format that
/// this library writes could hold them.
pvtStatus pvtModelBuilder_AddPart(pvtModelBuilder* builder, const char* name, size_t meshIndex,
                                  const double transform[16], const pvtLocalMesh* mesh);

/// Hands the model over, and warns of what was dropped. PVT_INVALID_INPUT when nothing is left.
pvtStatus pvtModelBuilder_Finish(pvtModelBuilder* builder, pvtModel* model);
void pvtModelBuilder_Free(pvtModelBuilder* builder);

/// 4 × 4 matrices, column after column: product = a × b. `product` may be neither a nor b.
void pvtMultiplyTransforms(const double a[16], const double b[16], double product[16]);

#ifdef __cplusplus
}
#endif
#endif
