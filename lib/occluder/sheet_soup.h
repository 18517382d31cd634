// SPDX-License-Identifier: MIT
// A mesh's triangles in grid coordinates, in chunks that lie close together, so that what is near a
// plane is found without looking at all of them.
#ifndef PVT_OCCLUDER_SHEET_SOUP_H
#define PVT_OCCLUDER_SHEET_SOUP_H

#include <paravent/section.h>

typedef struct pvtSheetSoup {
    const pvtMesh* mesh;
    pvtGridFrame frame;
    uint32_t* triangles; ///< those with an area, chunk by chunk
    size_t count;
    struct pvtSheetSoupChunk* chunks;
    size_t chunkCount;
} pvtSheetSoup;

typedef struct pvtSheetSoupChunk {
    size_t begin, end; ///< into triangles
    pvtVec3 center, half;
} pvtSheetSoupChunk;

pvtStatus pvtCreateSheetSoup(pvtContext* context, const pvtMesh* mesh, const pvtGridFrame* frame,
                             pvtSheetSoup* soup);
void pvtSheetSoup_Free(pvtContext* context, pvtSheetSoup* soup);

/// Corners in grid coordinates.
void pvtSheetSoup_GetCorners(const pvtSheetSoup* soup, size_t triangle, pvtVec3 corners[3]);

/// normal · p = offset, in grid coordinates; the normal is a unit vector.
typedef struct pvtFlat {
    pvtVec3 normal;
    double offset;
    pvtVec3 center; ///< of the surface near it
    double area;    ///< [vx²] of the surface near it
} pvtFlat;

static inline bool pvtIsChunkNear(const pvtSheetSoupChunk* chunk, pvtVec3 normal, double offset,
                                  double distance)
{
    const double c = normal.x * chunk->center.x + normal.y * chunk->center.y +
                     normal.z * chunk->center.z - offset;
    const double r = (normal.x < 0.0 ? -normal.x : normal.x) * chunk->half.x +
                     (normal.y < 0.0 ? -normal.y : normal.y) * chunk->half.y +
                     (normal.z < 0.0 ? -normal.z : normal.z) * chunk->half.z;
    return (c < 0.0 ? -c : c) <= r + distance;
}

/// The plane near a triangle that has most of the surface within `distance` [vx] of it; a plane
/// that much of the surface lies on exactly goes before one that is only near to more.
pvtFlat pvtFitFlat(const pvtSheetSoup* soup, size_t triangle, double distance);

#endif
