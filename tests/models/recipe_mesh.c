// SPDX-License-Identifier: MIT
#include "recipe_mesh.h"

#include "recipes.h"

#include <stdlib.h>

static pvtStatus AppendShape(pvtContext* context, const Shape* shape, pvtMesh* mesh)
{
    pvtVec3* positions = calloc(shape->pointCount, sizeof *positions);
    uint32_t* indices = calloc(shape->triangleCount, 3 * sizeof *indices);
    pvtStatus status = positions != NULL && indices != NULL ? PVT_OK : PVT_OUT_OF_MEMORY;
    for (uint32_t i = 0; i < shape->pointCount && status == PVT_OK; ++i) {
        const float* p = shape->positions[i];
        positions[i] =
            (pvtVec3){(double)p[0] + shape->translation.x, (double)p[1] + shape->translation.y,
                      (double)p[2] + shape->translation.z};
    }
    for (uint32_t i = 0; i < 3 * shape->triangleCount && status == PVT_OK; ++i) {
        indices[i] = shape->indices[i / 3][i % 3];
    }
    pvtMesh part = {0};
    if (status == PVT_OK) {
        status = pvtCreateMesh(context, positions, shape->pointCount, indices, shape->triangleCount,
                               &part);
    }
    if (status == PVT_OK) {
        status = pvtMesh_Append(context, mesh, &part);
    }
    pvtMesh_Free(context, &part);
    free(indices);
    free(positions);
    return status;
}

pvtStatus MakeRecipeMesh(pvtContext* context, const char* name, pvtMesh* mesh)
{
    *mesh = (pvtMesh){0};
    const Recipe* recipe = FindRecipe(name);
    Model* model = calloc(1, sizeof *model);
    pvtStatus status = recipe == NULL  ? PVT_INVALID_ARGUMENT
                       : model == NULL ? PVT_OUT_OF_MEMORY
                                       : PVT_OK;
    if (status == PVT_OK) {
        recipe->make(model);
        for (int i = 0; i < model->shapeCount && status == PVT_OK; ++i) {
            status = AppendShape(context, &model->shapes[i], mesh);
        }
    }
    free(model);
    if (status != PVT_OK) {
        pvtMesh_Free(context, mesh);
    }
    return status;
}
