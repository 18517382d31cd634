// SPDX-License-Identifier: MIT
#include "builder.h"

#include "base/context.h"
#include "mesh/transform.h"
#include "text.h"

#include <assert.h>
#include <float.h>
#include <stdio.h>
#include <string.h>

void pvtMultiplyTransforms(const double a[16], const double b[16], double product[16])
{
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            double sum = 0.0;
            for (int k = 0; k < 4; ++k) {
                sum += a[4 * k + row] * b[4 * column + k];
            }
            product[4 * column + row] = sum;
        }
    }
}

// False for NaN too.
static bool IsUsable(pvtVec3 p)
{
    return fabs(p.x) <= FLT_MAX && fabs(p.y) <= FLT_MAX && fabs(p.z) <= FLT_MAX;
}

pvtStatus pvtModelBuilder_Reserve(pvtModelBuilder* builder, size_t positionCount,
                                  size_t triangleCount, size_t partCount)
{
    pvtContext* context = builder->context;
    // The largest index is kept free: files use it to restart strips.
    if (positionCount >= UINT32_MAX || triangleCount > SIZE_MAX / 64) {
        return pvtFail(context, PVT_LIMIT,
                       "%s: %zu positions with all instances; at most %u can be indexed; take a "
                       "part of the file by --node",
                       builder->path, positionCount, UINT32_MAX - 1);
    }
    const size_t bytes = positionCount * sizeof(pvtVec3) + triangleCount * 3 * sizeof(uint32_t);
    char purpose[1024];
    (void)snprintf(purpose, sizeof purpose, "%s: the model with all its instances", builder->path);
    const pvtStatus status = pvtCheckMemory(context, bytes, purpose);
    if (status != PVT_OK) {
        return status;
    }
    pvtModel* model = &builder->model;
    model->mesh.positions = pvtAllocate(context, positionCount, sizeof(pvtVec3));
    model->mesh.indices = pvtAllocate(context, 3 * triangleCount, sizeof(uint32_t));
    model->parts = pvtAllocate(context, partCount, sizeof(pvtModelPart));
    if (model->mesh.positions == NULL || model->mesh.indices == NULL || model->parts == NULL) {
        return pvtContext_GetStatus(context);
    }
    builder->positionRoom = positionCount;
    builder->triangleRoom = triangleCount;
    builder->partRoom = partCount;
    return PVT_OK;
}

// Transforms all positions behind those of the model. False when one of them is not usable.
static bool PlacePositions(pvtModelBuilder* builder, const double transform[16],
                           const pvtLocalMesh* mesh)
{
    pvtVec3* placed = builder->model.mesh.positions + builder->model.mesh.positionCount;
    bool usable = true;
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        placed[i] = pvtTransformPoint(transform, mesh->positions[i]);
        usable = usable && IsUsable(placed[i]);
    }
    return usable;
}

// Closes the gaps that unusable positions leave; `moved` gets each position's new place. Returns
// how many are left.
static size_t CompactPositions(pvtVec3* positions, size_t count, uint32_t* moved)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; ++i) {
        moved[i] = UINT32_MAX;
        if (IsUsable(positions[i])) {
            positions[kept] = positions[i];
            moved[i] = (uint32_t)kept++;
        }
    }
    return kept;
}

// Copies the triangles all of whose positions are left; returns how many. `moved` is null when
// every position is.
static size_t CopyTriangles(pvtModelBuilder* builder, const pvtLocalMesh* mesh, bool mirrored,
                            const uint32_t* moved)
{
    const uint32_t base = (uint32_t)builder->model.mesh.positionCount;
    uint32_t* out = builder->model.mesh.indices + 3 * builder->model.mesh.triangleCount;
    size_t kept = 0;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        uint32_t corner[3];
        bool usable = true;
        for (int k = 0; k < 3; ++k) {
            const uint32_t index = mesh->indices[3 * t + (size_t)k];
            corner[k] = moved == NULL ? index : moved[index];
            usable = usable && corner[k] != UINT32_MAX;
        }
        if (usable) {
            out[3 * kept] = base + corner[0];
            out[3 * kept + 1] = base + corner[mirrored ? 2 : 1];
            out[3 * kept + 2] = base + corner[mirrored ? 1 : 2];
            ++kept;
        }
    }
    builder->dropped += mesh->triangleCount - kept;
    return kept;
}

static pvtStatus PlaceMesh(pvtModelBuilder* builder, const double transform[16],
                           const pvtLocalMesh* mesh, size_t* triangleCount)
{
    pvtContext* context = builder->context;
    pvtMesh* all = &builder->model.mesh;
    const bool mirrored = pvtGetDeterminant(transform) < 0.0;
    size_t positionCount = mesh->positionCount;
    if (PlacePositions(builder, transform, mesh)) {
        *triangleCount = CopyTriangles(builder, mesh, mirrored, NULL);
    } else {
        uint32_t* moved = pvtAllocate(context, mesh->positionCount, sizeof(uint32_t));
        if (moved == NULL) {
            return pvtContext_GetStatus(context);
        }
        pvtVec3* placed = all->positions + all->positionCount;
        positionCount = CompactPositions(placed, mesh->positionCount, moved);
        *triangleCount = CopyTriangles(builder, mesh, mirrored, moved);
        pvtRelease(context, moved);
    }
    all->triangleCount += *triangleCount;
    all->positionCount += *triangleCount > 0 ? positionCount : 0;
    return PVT_OK;
}

// Makes room for the mesh with this number. They are small and count from 0, but may come in any
// order.
static pvtStatus ReserveLocal(pvtModelBuilder* builder, size_t meshIndex)
{
    pvtModel* model = &builder->model;
    if (meshIndex >= builder->localRoom) {
        const size_t room = meshIndex + meshIndex / 2 + 8;
        pvtMesh* grown =
            pvtReallocate(builder->context, model->meshes, room, sizeof *model->meshes);
        if (grown == NULL) {
            return pvtContext_GetStatus(builder->context);
        }
        model->meshes = grown;
        builder->localRoom = room;
    }
    model->meshCount = meshIndex < model->meshCount ? model->meshCount : meshIndex + 1;
    return PVT_OK;
}

// Keeps the mesh as its file has it, but for what is not finite: a model of one part that stands
// where it is.
static pvtStatus KeepLocal(pvtModelBuilder* builder, size_t meshIndex, const pvtLocalMesh* mesh)
{
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    pvtStatus status = ReserveLocal(builder, meshIndex);
    if (status != PVT_OK || builder->model.meshes[meshIndex].triangleCount > 0) {
        return status;
    }
    pvtModelBuilder own = {.context = builder->context, .path = builder->path};
    size_t triangleCount = 0;
    status = pvtModelBuilder_Reserve(&own, mesh->positionCount, mesh->triangleCount, 1);
    if (status == PVT_OK) {
        status = PlaceMesh(&own, identity, mesh, &triangleCount);
    }
    if (status == PVT_OK) {
        builder->model.meshes[meshIndex] = own.model.mesh;
        own.model.mesh = (pvtMesh){0};
    }
    pvtModelBuilder_Free(&own);
    return status;
}

pvtStatus pvtModelBuilder_AddPart(pvtModelBuilder* builder, const char* name, size_t meshIndex,
                                  const double transform[16], const pvtLocalMesh* mesh)
{
    pvtContext* context = builder->context;
    pvtModel* model = &builder->model;
    if (pvtIsCancelled(context)) {
        return pvtFailCancelled(context);
    }
    const size_t first = model->mesh.triangleCount;
    size_t triangleCount = 0;
    assert(mesh->positionCount <= builder->positionRoom - model->mesh.positionCount);
    assert(mesh->triangleCount <= builder->triangleRoom - first);
    assert(model->partCount < builder->partRoom);
    pvtStatus status = PlaceMesh(builder, transform, mesh, &triangleCount);
    if (status == PVT_OK && triangleCount > 0 && builder->keepsMeshes) {
        status = KeepLocal(builder, meshIndex, mesh);
    }
    if (status != PVT_OK || triangleCount == 0) {
        return status;
    }
    pvtModelPart* part = &model->parts[model->partCount];
    part->name = pvtCopyCleanText(context, name);
    if (part->name == NULL) {
        return pvtContext_GetStatus(context);
    }
    part->firstTriangle = first;
    part->triangleCount = triangleCount;
    part->meshIndex = meshIndex;
    memcpy(part->transform, transform, sizeof part->transform);
    ++model->partCount;
    return PVT_OK;
}

pvtStatus pvtModelBuilder_Finish(pvtModelBuilder* builder, pvtModel* model)
{
    pvtContext* context = builder->context;
    if (builder->dropped > 0 && builder->model.mesh.triangleCount == 0) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "%s: all %zu triangles have a position that is not a finite number; export "
                       "the model again",
                       builder->path, builder->dropped);
    }
    if (builder->dropped > 0) {
        pvtLog(context, PVT_LOG_WARNING,
               "%s: %zu triangles with a position that is not a finite number were dropped",
               builder->path, builder->dropped);
    }
    *model = builder->model;
    builder->model = (pvtModel){0};
    return PVT_OK;
}

void pvtModelBuilder_Free(pvtModelBuilder* builder)
{
    pvtModel_Free(builder->context, &builder->model);
}
