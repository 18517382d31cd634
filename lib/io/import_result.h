// SPDX-License-Identifier: MIT
// What the importer process hands back: one file of these structs, in this machine's byte order.
// Whoever reads it believes nothing in it.
#ifndef PVT_IO_IMPORT_RESULT_H
#define PVT_IO_IMPORT_RESULT_H

#include <stdint.h>

enum {
    PVT_IMPORT_VERSION = 1,
    PVT_IMPORT_TEXT_SIZE = 512,
};

#define PVT_IMPORT_MAGIC "pvtimpr"

typedef enum pvtImportStatus {
    PVT_IMPORT_DONE,
    PVT_IMPORT_INVALID, ///< `text` says why
    PVT_IMPORT_OUT_OF_MEMORY,
} pvtImportStatus;

/// Written last, so that it is there only behind a whole result. Arrays follow in the order of
/// their counts: nodes, meshes, uses, positions, indices, names.
typedef struct pvtImportHeader {
    char magic[8];
    uint32_t version;
    uint32_t status; ///< pvtImportStatus
    uint64_t nodeCount, meshCount, useCount, positionCount, indexCount, nameBytes;
    uint64_t skinnedCount, morphedCount; ///< meshes
    char text[PVT_IMPORT_TEXT_SIZE];
} pvtImportHeader;

/// Parents stand before their children; the first node is the root.
typedef struct pvtImportNode {
    double transform[16]; ///< to the parent, column after column
    uint64_t firstUse, useCount;
    uint64_t name; ///< where it begins among the names; ends with a zero
    uint64_t parent;
    uint64_t group; ///< the same for all nodes with the same list of meshes
} pvtImportNode;

/// Positions are three floats each; indices count from the mesh's first position.
typedef struct pvtImportMesh {
    uint64_t firstPosition, positionCount;
    uint64_t firstIndex, triangleCount;
} pvtImportMesh;

#endif
