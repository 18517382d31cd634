// SPDX-License-Identifier: MIT
#include "soup.h"

#include "base/context.h"

#include <math.h>

// Squares of coordinates, and areas in pixels, stay finite below this.
static const double MOST_COORDINATE = 1e100;

static bool IsUsable(pvtVec3 p)
{
    return fabs(p.x) <= MOST_COORDINATE && fabs(p.y) <= MOST_COORDINATE &&
           fabs(p.z) <= MOST_COORDINATE;
}

static pvtStatus CheckIndex(pvtContext* context, const char* name, const pvtMesh* mesh,
                            size_t corner)
{
    const uint32_t index = mesh->indices[corner];
    if (index >= mesh->positionCount) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "%s: triangle %zu uses position %u of %zu; remove the triangle", name,
                       corner / 3, index, mesh->positionCount);
    }
    if (!IsUsable(mesh->positions[index])) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "%s: position %u is not finite, or farther than 1e100 from the origin; "
                       "remove the triangles that use it",
                       name, index);
    }
    return PVT_OK;
}

static void GrowBounds(pvtBox3* bounds, pvtVec3 p)
{
    bounds->lower.x = fmin(bounds->lower.x, p.x);
    bounds->lower.y = fmin(bounds->lower.y, p.y);
    bounds->lower.z = fmin(bounds->lower.z, p.z);
    bounds->upper.x = fmax(bounds->upper.x, p.x);
    bounds->upper.y = fmax(bounds->upper.y, p.y);
    bounds->upper.z = fmax(bounds->upper.z, p.z);
}

// `numbers[i]` is 1 + the new number of position i, or 0 as long as it has none.
static uint32_t AddPosition(pvtSoup* soup, uint32_t* numbers, const pvtMesh* mesh, uint32_t index)
{
    if (numbers[index] == 0) {
        soup->positions[soup->positionCount] = mesh->positions[index];
        numbers[index] = (uint32_t)++soup->positionCount;
        GrowBounds(&soup->bounds, mesh->positions[index]);
    }
    return numbers[index] - 1;
}

static pvtStatus AddTriangles(pvtContext* context, const char* name, const pvtMesh* mesh,
                              uint32_t* numbers, pvtSoup* soup)
{
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        if (t % 65536 == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        const uint32_t* from = mesh->indices + 3 * t;
        uint32_t* to = soup->indices + 3 * soup->triangleCount;
        for (size_t k = 0; k < 3; ++k) {
            const pvtStatus status = CheckIndex(context, name, mesh, 3 * t + k);
            if (status != PVT_OK) {
                return status;
            }
            to[k] = AddPosition(soup, numbers, mesh, from[k]);
        }
        // A triangle without area covers no pixel, but its corners count for the bounds.
        soup->triangleCount += to[0] != to[1] && to[1] != to[2] && to[2] != to[0];
    }
    return PVT_OK;
}

pvtStatus pvtCreateSoup(pvtContext* context, const char* name, const pvtMesh* mesh, pvtSoup* soup)
{
    *soup =
        (pvtSoup){.bounds = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}}};
    const size_t corners = 3 * mesh->triangleCount;
    const size_t most = mesh->positionCount < corners ? mesh->positionCount : corners;
    uint32_t* numbers = pvtAllocate(context, mesh->positionCount, sizeof *numbers);
    soup->positions = pvtAllocate(context, most, sizeof *soup->positions);
    soup->indices = pvtAllocate(context, corners, sizeof *soup->indices);
    pvtStatus status = PVT_OK;
    if (numbers == NULL || soup->positions == NULL || soup->indices == NULL) {
        status = pvtContext_GetStatus(context);
    } else {
        status = AddTriangles(context, name, mesh, numbers, soup);
    }
    pvtRelease(context, numbers);
    if (status != PVT_OK) {
        pvtSoup_Free(context, soup);
    }
    return status;
}

void pvtSoup_Free(pvtContext* context, pvtSoup* soup)
{
    pvtRelease(context, soup->positions);
    pvtRelease(context, soup->indices);
    *soup = (pvtSoup){0};
}
