// SPDX-License-Identifier: MIT
// One mesh written in every way that glTF knows to store it.
#ifndef PVT_TEST_ENCODINGS_H
#define PVT_TEST_ENCODINGS_H

#include "files.h"

/// What is encoded: floats, as files store them.
typedef struct Plain {
    float (*positions)[3];
    uint32_t* indices;
    size_t pointCount, triangleCount;
    float lower[3], upper[3];
} Plain;

Plain MakePlain(const pvtMesh* mesh);
void Plain_Free(Plain* plain);

typedef struct Encoding {
    const char* name;
    /// Writes a file, and returns the most that a coordinate is moved by [wu]; 0 when nothing is
    /// lost.
    double (*write)(const Plain* plain, const char* path);
} Encoding;

/// Null behind the last one.
const Encoding* GetEncoding(size_t index);

/// Draco's data for the mesh: see draco_encoder.h. Adds a buffer view of its own to nothing: only
/// packs it.
size_t PackDraco(const Plain* plain, bool isSequential, int bits, Pack* pack, size_t* pointCount);

#endif
