// SPDX-License-Identifier: MIT
// The closed mesh around the set voxels (paper, section 4.1).
//
// Unlike a plain list of voxel faces, corners are split where voxels meet along an edge or in a
// corner only (see voxel_mesh_table.c), so that the result is a 2-manifold. Coplanar faces are
// not merged: larger faces would meet the corners of smaller ones in the middle of their edges.
#include "bit_grid.h"
#include "voxel_mesh_table.h"

#include "base/context.h"

#include <stdatomic.h>
#include <string.h>

// One slab's corners: the first vertex and the case of each, at y × (size[0] + 1) + x. Only the
// entries of corners on the boundary are valid.
typedef struct CornerSlab {
    uint32_t* vertices;
    uint16_t* cases;
} CornerSlab;

typedef struct Mesher {
    pvtContext* context;
    const pvtBitGrid* grid;
    pvtMesh* mesh;
    pvtCornerTable table;
    const uint64_t* emptyRow;
    uint64_t* firstVertices; // of each slab of corners, size[2] + 2
    uint64_t* firstFaces;    // of each slab of voxels, size[2] + 1
    CornerSlab* corners;     // two for each worker
    atomic_bool cancelled;
} Mesher;

static const uint64_t* GetRowOrEmpty(const Mesher* mesher, int y, int z)
{
    const int* size = mesher->grid->frame.size;
    return y < 0 || z < 0 || y >= size[1] || z >= size[2] ? mesher->emptyRow
                                                          : pvtBitGrid_GetRow(mesher->grid, y, z);
}

static size_t GetCornerStep(const Mesher* mesher)
{
    return (size_t)mesher->grid->frame.size[0] + 1;
}

// The voxel rows around a row of corners, in the order of the pattern's bits.
typedef struct CornerRows {
    const uint64_t* row[4];
    size_t count;
} CornerRows;

static CornerRows GetCornerRows(const Mesher* mesher, int y, int z)
{
    return (CornerRows){{GetRowOrEmpty(mesher, y - 1, z - 1), GetRowOrEmpty(mesher, y, z - 1),
                         GetRowOrEmpty(mesher, y - 1, z), GetRowOrEmpty(mesher, y, z)},
                        mesher->grid->wordsPerRow};
}

// Bits of the corners, 64 from word × 64 on, that have set and free voxels around them.
static uint64_t FindBoundaryCorners(const CornerRows* rows, size_t word)
{
    uint64_t any[2] = {0, 0};
    uint64_t all[2] = {~UINT64_C(0), ~UINT64_C(0)};
    for (int i = 0; i < 4; ++i) {
        const uint64_t here = word < rows->count ? rows->row[i][word] : 0;
        const uint64_t before = word > 0 ? rows->row[i][word - 1] : 0;
        any[0] |= before;
        all[0] &= before;
        any[1] |= here;
        all[1] &= here;
    }
    const uint64_t touched = any[1] | any[1] << 1 | any[0] >> 63;
    const uint64_t buried = all[1] & (all[1] << 1 | all[0] >> 63);
    return touched & ~buried;
}

static int GetPattern(const CornerRows* rows, int x)
{
    int pattern = 0;
    for (int i = 0; i < 4; ++i) {
        const bool lower = x > 0 && pvtGetBit(rows->row[i], (size_t)x - 1);
        const bool upper = (size_t)x < rows->count * 64 && pvtGetBit(rows->row[i], (size_t)x);
        pattern |= ((int)lower | (int)upper << 1) << (2 * i);
    }
    return pattern;
}

// The pattern, and whether its double edge is one at the other end as well.
static int FindCase(const Mesher* mesher, const CornerRows* rows, const int corner[3])
{
    const int pattern = GetPattern(rows, corner[0]);
    const uint8_t halfEdge = mesher->table.doubleEdge[pattern];
    if (halfEdge == PVT_NO_HALF_EDGE) {
        return pattern;
    }
    int other[3] = {corner[0], corner[1], corner[2]};
    other[halfEdge / 2] += halfEdge % 2 == 1 ? 1 : -1;
    const CornerRows otherRows = GetCornerRows(mesher, other[1], other[2]);
    const int opposite = mesher->table.doubleEdge[GetPattern(&otherRows, other[0])];
    return opposite == (halfEdge ^ 1) ? pattern + PVT_CORNER_JOINED : pattern;
}

typedef void CornerFcn(int x, int y, int cornerCase, void* data);

// Calls `visit` for the boundary corners of a slab, with rising y and x.
static void VisitCorners(const Mesher* mesher, int z, CornerFcn* visit, void* data)
{
    const int* size = mesher->grid->frame.size;
    const size_t words = pvtGetWordCount((size_t)size[0] + 1);
    for (int y = 0; y <= size[1]; ++y) {
        const CornerRows rows = GetCornerRows(mesher, y, z);
        for (size_t word = 0; word < words; ++word) {
            uint64_t corners = FindBoundaryCorners(&rows, word);
            for (; corners != 0; corners &= corners - 1) {
                const int x = (int)(word * 64) + __builtin_ctzll(corners);
                visit(x, y, FindCase(mesher, &rows, (int[3]){x, y, z}), data);
            }
        }
    }
}

typedef struct VertexCounter {
    const pvtCornerTable* table;
    uint64_t count;
} VertexCounter;

static void CountVertices(int x, int y, int cornerCase, void* data)
{
    (void)x;
    (void)y;
    VertexCounter* counter = data;
    counter->count += counter->table->vertexCount[cornerCase];
}

// Faces of the six directions, −x, +x, −y, +y, −z, +z, as bits of the voxels that have them.
static void FindFaces(const Mesher* mesher, int y, int z, size_t word, uint64_t faces[6])
{
    const size_t count = mesher->grid->wordsPerRow;
    const uint64_t* row = pvtBitGrid_GetRow(mesher->grid, y, z);
    const uint64_t before = word > 0 ? row[word - 1] : 0;
    const uint64_t after = word + 1 < count ? row[word + 1] : 0;
    const uint64_t set = row[word];
    faces[0] = set & ~(set << 1 | before >> 63);
    faces[1] = set & ~(set >> 1 | after << 63);
    faces[2] = set & ~GetRowOrEmpty(mesher, y - 1, z)[word];
    faces[3] = set & ~GetRowOrEmpty(mesher, y + 1, z)[word];
    faces[4] = set & ~GetRowOrEmpty(mesher, y, z - 1)[word];
    faces[5] = set & ~GetRowOrEmpty(mesher, y, z + 1)[word];
}

static uint64_t CountFaces(const Mesher* mesher, int z)
{
    uint64_t count = 0;
    for (int y = 0; y < mesher->grid->frame.size[1]; ++y) {
        for (size_t word = 0; word < mesher->grid->wordsPerRow; ++word) {
            uint64_t faces[6];
            FindFaces(mesher, y, z, word, faces);
            for (int direction = 0; direction < 6; ++direction) {
                count += (uint64_t)pvtCountBits(faces[direction]);
            }
        }
    }
    return count;
}

// Counting is the first third of the work.
static bool ShouldStop(Mesher* mesher, size_t z, int worker, bool isWriting)
{
    if (worker == 0) {
        const double share = (double)z / mesher->grid->frame.size[2] / 3.0;
        pvtReportProgress(mesher->context, isWriting ? 1.0 / 3.0 + 2.0 * share : share);
    }
    if (pvtIsCancelled(mesher->context)) {
        atomic_store(&mesher->cancelled, true);
    }
    return atomic_load(&mesher->cancelled);
}

static void CountSlabs(size_t begin, size_t end, int worker, void* taskData)
{
    Mesher* mesher = taskData;
    for (size_t z = begin; z < end && !ShouldStop(mesher, z, worker, false); ++z) {
        VertexCounter counter = {&mesher->table, 0};
        VisitCorners(mesher, (int)z, CountVertices, &counter);
        mesher->firstVertices[z + 1] = counter.count;
        if (z < (size_t)mesher->grid->frame.size[2]) {
            mesher->firstFaces[z + 1] = CountFaces(mesher, (int)z);
        }
    }
}

typedef struct VertexWriter {
    const Mesher* mesher;
    const CornerSlab* slab;
    uint64_t next;
    int z;
    bool ownsPositions; // each slab of corners is visited twice, and written once
} VertexWriter;

static void WriteVertices(int x, int y, int cornerCase, void* data)
{
    VertexWriter* writer = data;
    const Mesher* mesher = writer->mesher;
    const size_t index = (size_t)y * GetCornerStep(mesher) + (size_t)x;
    writer->slab->vertices[index] = (uint32_t)writer->next;
    writer->slab->cases[index] = (uint16_t)cornerCase;
    const pvtGridFrame* frame = &mesher->grid->frame;
    const pvtVec3 position = {frame->origin.x + x * frame->voxelSize,
                              frame->origin.y + y * frame->voxelSize,
                              frame->origin.z + writer->z * frame->voxelSize};
    for (int i = 0; i < mesher->table.vertexCount[cornerCase]; ++i, ++writer->next) {
        if (writer->ownsPositions) {
            mesher->mesh->positions[writer->next] = position;
        }
    }
}

static void WriteCorners(const Mesher* mesher, const CornerSlab* slab, int z, bool ownsPositions)
{
    VertexWriter writer = {mesher, slab, mesher->firstVertices[z], z, ownsPositions};
    VisitCorners(mesher, z, WriteVertices, &writer);
}

// The two triangles of one face of the voxel (x, y); `slabs` are the corners below and above it.
static void WriteFace(const Mesher* mesher, const CornerSlab slabs[2], const int voxel[2],
                      int direction, uint32_t* indices)
{
    static const int turns[2][4][2] = {{{0, 0}, {0, 1}, {1, 1}, {1, 0}},
                                       {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    const int axis = direction / 2;
    uint32_t vertex[4];
    for (int i = 0; i < 4; ++i) {
        const int* turn = turns[direction % 2][i];
        int offset[3];
        offset[axis] = direction % 2;
        offset[(axis + 1) % 3] = turn[0];
        offset[(axis + 2) % 3] = turn[1];
        const CornerSlab* slab = &slabs[offset[2]];
        const size_t corner =
            (size_t)(voxel[1] + offset[1]) * GetCornerStep(mesher) + (size_t)(voxel[0] + offset[0]);
        // Seen from the corner, the face lies on the other side along both its axes.
        const int face = 4 * axis + (1 - turn[0]) + 2 * (1 - turn[1]);
        vertex[i] = slab->vertices[corner] + mesher->table.vertexOfFace[slab->cases[corner]][face];
    }
    const uint32_t triangles[6] = {vertex[0], vertex[1], vertex[2],
                                   vertex[0], vertex[2], vertex[3]};
    memcpy(indices, triangles, sizeof triangles);
}

static void WriteFaces(const Mesher* mesher, const CornerSlab slabs[2], int z)
{
    uint32_t* indices = mesher->mesh->indices + 6 * mesher->firstFaces[z];
    for (int y = 0; y < mesher->grid->frame.size[1]; ++y) {
        for (size_t word = 0; word < mesher->grid->wordsPerRow; ++word) {
            uint64_t faces[6];
            FindFaces(mesher, y, z, word, faces);
            for (int direction = 0; direction < 6; ++direction) {
                for (uint64_t bits = faces[direction]; bits != 0; bits &= bits - 1) {
                    const int voxel[2] = {(int)(word * 64) + __builtin_ctzll(bits), y};
                    WriteFace(mesher, slabs, voxel, direction, indices);
                    indices += 6;
                }
            }
        }
    }
}

static void WriteSlabs(size_t begin, size_t end, int worker, void* taskData)
{
    Mesher* mesher = taskData;
    CornerSlab slabs[2] = {mesher->corners[2 * worker], mesher->corners[2 * worker + 1]};
    WriteCorners(mesher, &slabs[0], (int)begin, true);
    for (size_t z = begin; z < end && !ShouldStop(mesher, z, worker, true); ++z) {
        const bool isLast = z + 1 == (size_t)mesher->grid->frame.size[2];
        WriteCorners(mesher, &slabs[1], (int)z + 1, isLast || z + 1 < end);
        WriteFaces(mesher, slabs, (int)z);
        const CornerSlab swapped = slabs[0];
        slabs[0] = slabs[1];
        slabs[1] = swapped;
    }
}

static void SumUp(uint64_t* counts, size_t count)
{
    for (size_t i = 1; i < count; ++i) {
        counts[i] += counts[i - 1];
    }
}

static pvtStatus AllocateCounts(Mesher* mesher)
{
    const size_t depth = (size_t)mesher->grid->frame.size[2];
    pvtContext* context = mesher->context;
    uint64_t* counts =
        pvtAllocate(context, 2 * depth + 3 + mesher->grid->wordsPerRow, sizeof *counts);
    if (counts == NULL) {
        return pvtContext_GetStatus(context);
    }
    mesher->firstVertices = counts;
    mesher->firstFaces = counts + depth + 2;
    mesher->emptyRow = counts + 2 * depth + 3;
    return PVT_OK;
}

static pvtStatus AllocateCorners(Mesher* mesher)
{
    pvtContext* context = mesher->context;
    const size_t workers = (size_t)pvtContext_GetThreadCount(context);
    const size_t step = GetCornerStep(mesher) * ((size_t)mesher->grid->frame.size[1] + 1);
    mesher->corners = pvtAllocate(context, 2 * workers, sizeof *mesher->corners);
    for (size_t i = 0; mesher->corners != NULL && i < 2 * workers; ++i) {
        CornerSlab* slab = &mesher->corners[i];
        slab->vertices = pvtAllocate(context, step, sizeof *slab->vertices);
        slab->cases =
            slab->vertices == NULL ? NULL : pvtAllocate(context, step, sizeof *slab->cases);
        if (slab->cases == NULL) {
            return pvtContext_GetStatus(context);
        }
    }
    return mesher->corners == NULL ? pvtContext_GetStatus(context) : PVT_OK;
}

static void FreeMesher(Mesher* mesher)
{
    pvtContext* context = mesher->context;
    for (int i = 0; mesher->corners != NULL && i < 2 * pvtContext_GetThreadCount(context); ++i) {
        pvtRelease(context, mesher->corners[i].vertices);
        pvtRelease(context, mesher->corners[i].cases);
    }
    pvtRelease(context, mesher->corners);
    pvtRelease(context, mesher->firstVertices);
}

static pvtStatus CountMesh(Mesher* mesher)
{
    pvtContext* context = mesher->context;
    pvtMesh* mesh = mesher->mesh;
    const size_t depth = (size_t)mesher->grid->frame.size[2];
    pvtParallelFor(context, CountSlabs, depth + 1, 1, mesher);
    if (atomic_load(&mesher->cancelled)) {
        return pvtFailCancelled(context);
    }
    SumUp(mesher->firstVertices, depth + 2);
    SumUp(mesher->firstFaces, depth + 1);
    const uint64_t vertices = mesher->firstVertices[depth + 1];
    const uint64_t faces = mesher->firstFaces[depth];
    if (vertices > UINT32_MAX) {
        return pvtFail(context, PVT_LIMIT,
                       "the voxel mesh has %.0f vertices, more than 32-bit "
                       "indices reach; lower the resolution",
                       (double)vertices);
    }
    mesh->positions = pvtAllocate(context, (size_t)vertices, sizeof *mesh->positions);
    mesh->indices = mesh->positions == NULL
                        ? NULL
                        : pvtAllocate(context, 6 * (size_t)faces, sizeof *mesh->indices);
    if (mesh->indices == NULL) {
        return pvtContext_GetStatus(context);
    }
    mesh->positionCount = (size_t)vertices;
    mesh->triangleCount = 2 * (size_t)faces;
    return PVT_OK;
}

pvtStatus pvtBuildVoxelMesh(pvtContext* context, const pvtBitGrid* grid, pvtMesh* mesh)
{
    *mesh = (pvtMesh){0};
    pvtBeginStage(context, "voxel mesh");
    Mesher mesher = {.context = context, .grid = grid, .mesh = mesh};
    pvtMakeCornerTable(&mesher.table);
    pvtStatus status = AllocateCounts(&mesher);
    if (status == PVT_OK) {
        status = CountMesh(&mesher);
    }
    if (status == PVT_OK) {
        status = AllocateCorners(&mesher);
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, WriteSlabs, (size_t)grid->frame.size[2], 1, &mesher);
        status = atomic_load(&mesher.cancelled) ? pvtFailCancelled(context) : PVT_OK;
    }
    FreeMesher(&mesher);
    if (status != PVT_OK) {
        pvtMesh_Free(context, mesh);
        return status;
    }
    pvtReportProgress(context, 1.0);
    return PVT_OK;
}
