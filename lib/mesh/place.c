// SPDX-License-Identifier: MIT
// Meshes put where their instances stand.
#include "allocate.h"

#include "base/context.h"
#include "transform.h"

static const double IDENTITY[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

static pvtStatus Reserve(pvtContext* context, const pvtPlacedMesh* placed, size_t count,
                         pvtMesh* joined)
{
    size_t positionCount = 0;
    size_t triangleCount = 0;
    for (size_t i = 0; i < count; ++i) {
        positionCount += placed[i].mesh->positionCount;
        triangleCount += placed[i].mesh->triangleCount;
    }
    const pvtStatus status = pvtCheckMeshCounts(context, positionCount, triangleCount);
    return status == PVT_OK ? pvtReserveMesh(context, positionCount, triangleCount, joined)
                            : status;
}

static pvtStatus Add(pvtContext* context, const pvtPlacedMesh* placed, pvtMesh* joined)
{
    const pvtMesh* mesh = placed->mesh;
    const double* transform = placed->transform != NULL ? placed->transform : IDENTITY;
    const bool isMirrored = pvtGetDeterminant(transform) < 0.0;
    const uint32_t base = (uint32_t)joined->positionCount;
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        const pvtVec3 p = pvtTransformPoint(transform, mesh->positions[i]);
        if (!pvtIsFinite3(p)) {
            return pvtFail(context, PVT_INVALID_INPUT,
                           "position %zu does not stay finite under its transform", i);
        }
        joined->positions[joined->positionCount++] = p;
    }
    uint32_t* out = joined->indices + 3 * joined->triangleCount;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const uint32_t* corner = mesh->indices + 3 * t;
        out[3 * t] = base + corner[0];
        out[3 * t + 1] = base + corner[isMirrored ? 2 : 1];
        out[3 * t + 2] = base + corner[isMirrored ? 1 : 2];
    }
    joined->triangleCount += mesh->triangleCount;
    return PVT_OK;
}

pvtStatus pvtPlaceMeshes(pvtContext* context, const pvtPlacedMesh* placed, size_t count,
                         pvtMesh* joined)
{
    *joined = (pvtMesh){0};
    pvtStatus status = Reserve(context, placed, count, joined);
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        status = Add(context, &placed[i], joined);
    }
    if (status != PVT_OK) {
        pvtMesh_Free(context, joined);
    }
    return status;
}
