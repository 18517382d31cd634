// SPDX-License-Identifier: MIT
#include "placement.h"

#include "base/context.h"
#include "mesh/transform.h"

#include <math.h>

// A file's floats are no better than this, and what is below it moves nothing by more than a
// float's rounding does.
static const double MAX_SHEAR = 4e-7;

// Ken Shoemake, Animating Rotation with Quaternion Curves, 1985, appendix: from the largest of the
// four numbers, so that nothing is divided by a small one. Columns are unit and at right angles.
static void FindQuaternion(const pvtVec3 c[3], double q[4])
{
    const double m[3][3] = {
        {c[0].x, c[1].x, c[2].x}, {c[0].y, c[1].y, c[2].y}, {c[0].z, c[1].z, c[2].z}};
    const double trace = m[0][0] + m[1][1] + m[2][2];
    if (trace > 0.0) {
        const double s = 2.0 * sqrt(1.0 + trace);
        q[0] = (m[2][1] - m[1][2]) / s;
        q[1] = (m[0][2] - m[2][0]) / s;
        q[2] = (m[1][0] - m[0][1]) / s;
        q[3] = 0.25 * s;
    } else {
        const int i = m[0][0] >= m[1][1] && m[0][0] >= m[2][2] ? 0 : m[1][1] >= m[2][2] ? 1 : 2;
        const int j = (i + 1) % 3;
        const int k = (i + 2) % 3;
        const double s = 2.0 * sqrt(1.0 + m[i][i] - m[j][j] - m[k][k]);
        q[i] = 0.25 * s;
        q[j] = (m[j][i] + m[i][j]) / s;
        q[k] = (m[k][i] + m[i][k]) / s;
        q[3] = (m[k][j] - m[j][k]) / s;
    }
    const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; ++i) {
        q[i] /= length;
    }
}

// A mirrored transform is a rotation and one negative scale, along any of the axes: the one that
// leaves the smallest rotation is most likely what the artist did.
static void TurnMirrorIntoScale(pvtVec3 columns[3], double scale[3])
{
    const double diagonal[3] = {columns[0].x, columns[1].y, columns[2].z};
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
        axis = diagonal[i] < diagonal[axis] ? i : axis;
    }
    columns[axis] = pvtScale(columns[axis], -1.0);
    scale[axis] = -scale[axis];
}

bool pvtFindPlacement(const double transform[16], pvtPlacement* placement)
{
    pvtVec3 columns[3];
    for (int i = 0; i < 3; ++i) {
        columns[i] = (pvtVec3){transform[4 * i], transform[4 * i + 1], transform[4 * i + 2]};
        placement->scale[i] = pvtLength3(columns[i]);
        placement->translation[i] = transform[12 + i];
        if (!(placement->scale[i] > 0.0)) {
            return false;
        }
        columns[i] = pvtScale(columns[i], 1.0 / placement->scale[i]);
    }
    for (int i = 0; i < 3; ++i) {
        if (!(fabs(pvtDot(columns[i], columns[(i + 1) % 3])) <= MAX_SHEAR)) {
            return false;
        }
    }
    if (pvtGetDeterminant(transform) < 0.0) {
        TurnMirrorIntoScale(columns, placement->scale);
    }
    FindQuaternion(columns, placement->rotation);
    return true;
}

static pvtStatus MoveMesh(pvtContext* context, pvtSaveItem* item, pvtMesh* moved)
{
    const pvtPlacedMesh placed = {item->mesh, item->transform};
    const pvtStatus status = pvtPlaceMeshes(context, &placed, 1, moved);
    item->mesh = moved;
    item->transform = NULL;
    return status;
}

pvtStatus pvtPlaceItems(const pvtSaveJob* job, bool canPlace, pvtPlacedItems* placed)
{
    pvtContext* context = job->context;
    *placed = (pvtPlacedItems){.count = job->count};
    placed->items = pvtAllocate(context, job->count, sizeof *placed->items);
    placed->meshes = pvtAllocate(context, job->count, sizeof *placed->meshes);
    pvtStatus status = PVT_OK;
    if (placed->items == NULL || placed->meshes == NULL) {
        status = pvtContext_GetStatus(context);
    }
    for (size_t i = 0; i < job->count && status == PVT_OK; ++i) {
        pvtSaveItem* item = &placed->items[i];
        pvtPlacement placement;
        *item = job->items[i];
        if (item->transform != NULL &&
            !(canPlace && pvtFindPlacement(item->transform, &placement))) {
            status = MoveMesh(context, item, &placed->meshes[i]);
        }
    }
    if (status != PVT_OK) {
        pvtPlacedItems_Free(context, placed);
    }
    return status;
}

void pvtPlacedItems_Free(pvtContext* context, pvtPlacedItems* placed)
{
    for (size_t i = 0; placed->meshes != NULL && i < placed->count; ++i) {
        pvtMesh_Free(context, &placed->meshes[i]);
    }
    pvtRelease(context, placed->meshes);
    pvtRelease(context, placed->items);
    *placed = (pvtPlacedItems){0};
}
