// SPDX-License-Identifier: MIT
// Making, joining and measuring meshes.
#include "allocate.h"

#include "base/context.h"
#include "base/vector.h"

#include <assert.h>
#include <string.h>

void pvtMesh_Free(pvtContext* context, pvtMesh* mesh)
{
    pvtRelease(context, mesh->positions);
    pvtRelease(context, mesh->indices);
    *mesh = (pvtMesh){0};
}

static pvtStatus CheckPositions(pvtContext* context, const pvtVec3* positions, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        if (!pvtIsFinite3(positions[i])) {
            return pvtFail(context, PVT_INVALID_INPUT,
                           "position %zu is (%g, %g, %g); every coordinate must be finite", i,
                           positions[i].x, positions[i].y, positions[i].z);
        }
    }
    return PVT_OK;
}

static pvtStatus CheckIndices(pvtContext* context, const uint32_t* indices, size_t triangleCount,
                              size_t positionCount)
{
    for (size_t i = 0; i < 3 * triangleCount; ++i) {
        if (indices[i] >= positionCount) {
            return pvtFail(context, PVT_INVALID_INPUT,
                           "index %u of triangle %zu is out of range: there are %zu positions",
                           indices[i], i / 3, positionCount);
        }
    }
    return PVT_OK;
}

pvtStatus pvtCheckMeshCounts(pvtContext* context, size_t positionCount, size_t triangleCount)
{
    if (positionCount > UINT32_MAX || triangleCount > SIZE_MAX / (3 * sizeof(uint32_t))) {
        return pvtFail(context, PVT_LIMIT,
                       "%zu positions and %zu triangles are more than 32-bit "
                       "indices reach",
                       positionCount, triangleCount);
    }
    return PVT_OK;
}

pvtStatus pvtReserveMesh(pvtContext* context, size_t positionCount, size_t triangleCount,
                         pvtMesh* mesh)
{
    *mesh = (pvtMesh){0};
    mesh->positions = pvtAllocate(context, positionCount, sizeof *mesh->positions);
    mesh->indices = mesh->positions == NULL
                        ? NULL
                        : pvtAllocate(context, 3 * triangleCount, sizeof *mesh->indices);
    if (mesh->indices == NULL) {
        pvtMesh_Free(context, mesh);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

static pvtStatus AllocateMesh(pvtContext* context, size_t positionCount, size_t triangleCount,
                              pvtMesh* mesh)
{
    const pvtStatus status = pvtReserveMesh(context, positionCount, triangleCount, mesh);
    if (status == PVT_OK) {
        mesh->positionCount = positionCount;
        mesh->triangleCount = triangleCount;
    }
    return status;
}

pvtStatus pvtCreateMesh(pvtContext* context, const pvtVec3* positions, size_t positionCount,
                        const uint32_t* indices, size_t triangleCount, pvtMesh* mesh)
{
    *mesh = (pvtMesh){0};
    pvtStatus status = pvtCheckMeshCounts(context, positionCount, triangleCount);
    if (status == PVT_OK && indices == NULL && triangleCount > positionCount / 3) {
        status = pvtFail(context, PVT_INVALID_INPUT,
                         "%zu triangles without indices need %zu positions, there are %zu",
                         triangleCount, 3 * triangleCount, positionCount);
    }
    if (status == PVT_OK) {
        status = CheckPositions(context, positions, positionCount);
    }
    if (status == PVT_OK && indices != NULL) {
        status = CheckIndices(context, indices, triangleCount, positionCount);
    }
    if (status == PVT_OK) {
        status = AllocateMesh(context, positionCount, triangleCount, mesh);
    }
    if (status != PVT_OK) {
        return status;
    }
    if (positionCount > 0) {
        memcpy(mesh->positions, positions, positionCount * sizeof *positions);
    }
    for (size_t i = 0; i < 3 * triangleCount; ++i) {
        mesh->indices[i] = indices != NULL ? indices[i] : (uint32_t)i;
    }
    return PVT_OK;
}

static void Include(pvtBox3* box, pvtVec3 p)
{
    box->lower.x = p.x < box->lower.x ? p.x : box->lower.x;
    box->lower.y = p.y < box->lower.y ? p.y : box->lower.y;
    box->lower.z = p.z < box->lower.z ? p.z : box->lower.z;
    box->upper.x = p.x > box->upper.x ? p.x : box->upper.x;
    box->upper.y = p.y > box->upper.y ? p.y : box->upper.y;
    box->upper.z = p.z > box->upper.z ? p.z : box->upper.z;
}

pvtBox3 pvtMesh_GetBounds(const pvtMesh* mesh)
{
    if (mesh->triangleCount == 0) {
        return (pvtBox3){{1.0, 1.0, 1.0}, {-1.0, -1.0, -1.0}};
    }
    const pvtVec3 first = mesh->positions[mesh->indices[0]];
    // A box for each corner: three short chains of comparisons instead of one long one.
    pvtBox3 boxes[3] = {{first, first}, {first, first}, {first, first}};
    for (size_t i = 0; i < 3 * mesh->triangleCount; i += 3) {
        for (size_t corner = 0; corner < 3; ++corner) {
            assert(mesh->indices[i + corner] < mesh->positionCount);
            Include(&boxes[corner], mesh->positions[mesh->indices[i + corner]]);
        }
    }
    for (int i = 1; i < 3; ++i) {
        Include(&boxes[0], boxes[i].lower);
        Include(&boxes[0], boxes[i].upper);
    }
    return boxes[0];
}
