// SPDX-License-Identifier: MIT
#include "recipe_mesh.h"

#include "append.h"
#include "recipes.h"

#include <stdlib.h>

static pvtVec3 PlacePoint(const Node* node, const float p[3])
{
    static const double turns[4][2] = {{0.0, 1.0}, {1.0, 0.0}, {0.0, -1.0}, {-1.0, 0.0}};
    const double* turn = turns[node->quarters]; // sine and cosine
    const double x = node->scale.x * (double)p[0];
    const double z = node->scale.z * (double)p[2];
    return (pvtVec3){turn[1] * x + turn[0] * z + node->translation.x,
                     node->scale.y * (double)p[1] + node->translation.y,
                     turn[1] * z - turn[0] * x + node->translation.z};
}

static pvtStatus AppendNode(pvtContext* context, const Model* model, const Node* node,
                            pvtMesh* mesh)
{
    const Shape* shape = &model->shapes[node->shape];
    const bool isMirrored = node->scale.x * node->scale.y * node->scale.z < 0.0;
    pvtVec3* positions = calloc(shape->pointCount, sizeof *positions);
    uint32_t* indices = calloc(shape->triangleCount, 3 * sizeof *indices);
    pvtStatus status = positions != NULL && indices != NULL ? PVT_OK : PVT_OUT_OF_MEMORY;
    for (uint32_t i = 0; i < shape->pointCount && status == PVT_OK; ++i) {
        positions[i] = PlacePoint(node, shape->positions[i]);
    }
    for (uint32_t i = 0; i < 3 * shape->triangleCount && status == PVT_OK; ++i) {
        indices[i] = shape->indices[i / 3][isMirrored ? 2 - i % 3 : i % 3];
    }
    pvtMesh part = {0};
    if (status == PVT_OK) {
        status = pvtCreateMesh(context, positions, shape->pointCount, indices, shape->triangleCount,
                               &part);
    }
    if (status == PVT_OK) {
        status = AppendMesh(context, mesh, &part);
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
        for (int i = 0; i < GetNodeCount(model) && status == PVT_OK; ++i) {
            const Node node = GetNode(model, i);
            status = AppendNode(context, model, &node, mesh);
        }
    }
    free(model);
    if (status != PVT_OK) {
        pvtMesh_Free(context, mesh);
    }
    return status;
}
