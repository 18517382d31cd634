// SPDX-License-Identifier: MIT
// The original beside its ladder, of formats whose files cannot be taken over as they are: a node a
// part, in world coordinates.
#include "ladder.h"

#include <stdlib.h>

void pvtOriginalParts_Free(pvtRun* run, pvtOriginalParts* parts)
{
    for (size_t i = 0; i < parts->count; ++i) {
        pvtMesh_Free(run->context, &parts->meshes[i]);
    }
    free(parts->meshes);
    free(parts->items);
    *parts = (pvtOriginalParts){0};
}

pvtStatus pvtCutOriginal(pvtRun* run, const pvtModel* model, pvtOriginalParts* parts)
{
    *parts = (pvtOriginalParts){0};
    parts->meshes = calloc(model->partCount, sizeof *parts->meshes);
    parts->items = calloc(model->partCount, sizeof *parts->items);
    if (parts->meshes == NULL || parts->items == NULL) {
        pvtOriginalParts_Free(run, parts);
        return pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory");
    }
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < model->partCount && status == PVT_OK; ++i) {
        const pvtModelPart* part = &model->parts[i];
        if (part->triangleCount == 0) {
            continue;
        }
        const pvtMesh triangles = {model->mesh.positions,
                                   model->mesh.indices + 3 * part->firstTriangle,
                                   model->mesh.positionCount, part->triangleCount};
        pvtMesh* mesh = &parts->meshes[parts->count];
        status = pvtWeldMesh(run->context, &triangles, mesh);
        if (status == PVT_OK) {
            parts->items[parts->count++] = (pvtSaveItem){.name = part->name, .mesh = mesh};
        }
    }
    if (status != PVT_OK) {
        pvtOriginalParts_Free(run, parts);
    }
    return status;
}
