// SPDX-License-Identifier: MIT
// From the importer's result to a model: every number in it is checked before it is used.
#include "builder.h"
#include "import_process.h"
#include "text.h"

#include "base/context.h"

#include <stdio.h>
#include <string.h>

// The arrays of a result, all within it.
typedef struct Scene {
    const pvtImportHeader* header;
    const pvtImportNode* nodes;
    const pvtImportMesh* meshes;
    const uint64_t* uses; // meshes of nodes
    const float* positions;
    const uint32_t* indices;
    const char* names;
} Scene;

static pvtStatus FailDamaged(const pvtLoadJob* job, const char* what)
{
    return pvtFail(job->context, PVT_INVALID_INPUT,
                   "%s: assimp made nothing sound of it (%s); it is damaged: repair it, or convert "
                   "it to GLB",
                   job->path, what);
}

// Takes count × size bytes off the rest of the result; null when it has fewer.
static const void* TakeArray(const uint8_t** at, size_t* left, uint64_t count, size_t size)
{
    if (count > *left / size) {
        return NULL;
    }
    const void* array = *at;
    *at += count * size;
    *left -= count * size;
    return array;
}

static bool BindArrays(const pvtChildResult* result, Scene* scene)
{
    const pvtImportHeader* header = (const pvtImportHeader*)(const void*)result->bytes;
    const uint8_t* at = result->bytes + sizeof *header;
    size_t left = result->size - sizeof *header;
    scene->header = header;
    scene->nodes = TakeArray(&at, &left, header->nodeCount, sizeof(pvtImportNode));
    scene->meshes = TakeArray(&at, &left, header->meshCount, sizeof(pvtImportMesh));
    scene->uses = TakeArray(&at, &left, header->useCount, sizeof(uint64_t));
    scene->positions = TakeArray(&at, &left, header->positionCount, 3 * sizeof(float));
    scene->indices = TakeArray(&at, &left, header->indexCount, sizeof(uint32_t));
    scene->names = TakeArray(&at, &left, header->nameBytes, 1);
    return scene->nodes != NULL && scene->meshes != NULL && scene->uses != NULL &&
           scene->positions != NULL && scene->indices != NULL && scene->names != NULL &&
           left == 0 && header->nodeCount > 0 && header->nameBytes > 0 &&
           scene->names[header->nameBytes - 1] == '\0';
}

// Whether first to first + count − 1 lies below `limit`.
static bool IsRange(uint64_t first, uint64_t count, uint64_t limit)
{
    return first <= limit && count <= limit - first;
}

static bool AreNodesSound(const Scene* scene)
{
    const pvtImportHeader* header = scene->header;
    uint64_t useCount = 0;
    for (uint64_t i = 0; i < header->nodeCount; ++i) {
        const pvtImportNode* node = &scene->nodes[i];
        if ((i > 0 && node->parent >= i) || node->name >= header->nameBytes ||
            node->group >= header->nodeCount || node->firstUse != useCount ||
            !IsRange(node->firstUse, node->useCount, header->useCount)) {
            return false;
        }
        useCount += node->useCount;
    }
    for (uint64_t i = 0; i < header->useCount; ++i) {
        if (scene->uses[i] >= header->meshCount) {
            return false;
        }
    }
    return true;
}

static bool IsMeshSound(const Scene* scene, const pvtImportMesh* mesh)
{
    if (!IsRange(mesh->firstPosition, mesh->positionCount, scene->header->positionCount) ||
        mesh->triangleCount > scene->header->indexCount / 3 ||
        !IsRange(mesh->firstIndex, 3 * mesh->triangleCount, scene->header->indexCount)) {
        return false;
    }
    const uint32_t* indices = scene->indices + mesh->firstIndex;
    for (uint64_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        if (indices[i] >= mesh->positionCount) {
            return false;
        }
    }
    return true;
}

static pvtStatus BindScene(const pvtLoadJob* job, const pvtChildResult* result, Scene* scene)
{
    const pvtImportHeader* header = (const pvtImportHeader*)(const void*)result->bytes;
    if (header->status == PVT_IMPORT_OUT_OF_MEMORY) {
        return pvtFail(job->context, PVT_LIMIT,
                       "%s: assimp needs more memory than is left; raise the memory limit, or "
                       "convert the model to GLB",
                       job->path);
    }
    if (header->status != PVT_IMPORT_DONE) {
        char text[PVT_IMPORT_TEXT_SIZE], clean[PVT_IMPORT_TEXT_SIZE];
        memcpy(text, header->text, sizeof text);
        text[sizeof text - 1] = '\0';
        return pvtFail(job->context, PVT_INVALID_INPUT, "%s: %s", job->path,
                       pvtCleanText(text, clean, sizeof clean));
    }
    if (!BindArrays(result, scene) || !AreNodesSound(scene)) {
        return FailDamaged(job, "its nodes contradict each other");
    }
    for (uint64_t i = 0; i < header->meshCount; ++i) {
        if (!IsMeshSound(scene, &scene->meshes[i])) {
            return FailDamaged(job, "an index out of range");
        }
    }
    return PVT_OK;
}

// What stands where: one entry a node.
typedef struct Placement {
    double transform[16]; // to the world
    bool wanted;          // the node asked for, or below it
} Placement;

static bool PlaceNodes(const pvtLoadJob* job, const Scene* scene, Placement* places)
{
    const char* option = job->options->node;
    const char* wantedNode = option != NULL && option[0] != '\0' ? option : NULL;
    bool found = wantedNode == NULL;
    for (uint64_t i = 0; i < scene->header->nodeCount; ++i) {
        const pvtImportNode* node = &scene->nodes[i];
        const Placement* parent = i > 0 ? &places[node->parent] : NULL;
        if (parent == NULL) {
            memcpy(places[i].transform, node->transform, sizeof node->transform);
        } else {
            pvtMultiplyTransforms(parent->transform, node->transform, places[i].transform);
        }
        places[i].wanted = wantedNode == NULL || (parent != NULL && parent->wanted) ||
                           strcmp(scene->names + node->name, wantedNode) == 0;
        found = found || places[i].wanted;
    }
    return found;
}

static void CountUses(const Scene* scene, const pvtImportNode* node, uint64_t* positionCount,
                      uint64_t* triangleCount)
{
    *positionCount = *triangleCount = 0;
    for (uint64_t i = 0; i < node->useCount; ++i) {
        const pvtImportMesh* mesh = &scene->meshes[scene->uses[node->firstUse + i]];
        *positionCount += mesh->positionCount;
        *triangleCount += mesh->triangleCount;
    }
}

static void AppendMesh(const Scene* scene, const pvtImportMesh* mesh, pvtMesh* joined)
{
    const float* positions = scene->positions + 3 * mesh->firstPosition;
    const uint32_t* indices = scene->indices + mesh->firstIndex;
    const uint32_t base = (uint32_t)joined->positionCount;
    for (uint64_t i = 0; i < mesh->positionCount; ++i) {
        joined->positions[joined->positionCount++] = (pvtVec3){
            (double)positions[3 * i], (double)positions[3 * i + 1], (double)positions[3 * i + 2]};
    }
    for (uint64_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        joined->indices[3 * joined->triangleCount + i] = base + indices[i];
    }
    joined->triangleCount += mesh->triangleCount;
}

// A node's meshes as one.
static pvtStatus JoinMeshes(pvtContext* context, const Scene* scene, const pvtImportNode* node,
                            pvtMesh* joined)
{
    uint64_t positionCount = 0, triangleCount = 0;
    CountUses(scene, node, &positionCount, &triangleCount);
    *joined = (pvtMesh){0};
    joined->positions = pvtAllocate(context, positionCount, sizeof(pvtVec3));
    joined->indices = pvtAllocate(context, 3 * triangleCount, sizeof(uint32_t));
    if (joined->positions == NULL || joined->indices == NULL) {
        pvtMesh_Free(context, joined);
        return pvtContext_GetStatus(context);
    }
    for (uint64_t i = 0; i < node->useCount; ++i) {
        AppendMesh(scene, &scene->meshes[scene->uses[node->firstUse + i]], joined);
    }
    return PVT_OK;
}

// Whether a node becomes a part, and of what size: room is made for these and no others.
static bool IsPart(const Scene* scene, const Placement* places, uint64_t index,
                   uint64_t* positionCount, uint64_t* triangleCount)
{
    CountUses(scene, &scene->nodes[index], positionCount, triangleCount);
    return places[index].wanted && *triangleCount > 0;
}

static pvtStatus ReserveModel(const Scene* scene, const Placement* places, pvtModelBuilder* builder)
{
    uint64_t positionCount = 0, triangleCount = 0, partCount = 0;
    for (uint64_t i = 0; i < scene->header->nodeCount; ++i) {
        uint64_t positions = 0, triangles = 0;
        if (IsPart(scene, places, i, &positions, &triangles)) {
            positionCount += positions;
            triangleCount += triangles;
            ++partCount;
        }
    }
    if (triangleCount == 0) {
        return pvtFail(builder->context, PVT_INVALID_INPUT,
                       "%s: there is no triangle: it holds at most points and lines; export the "
                       "model with its surfaces",
                       builder->path);
    }
    return pvtModelBuilder_Reserve(builder, positionCount, triangleCount, partCount);
}

static pvtStatus AddNode(const Scene* scene, uint64_t index, const Placement* place,
                         pvtModelBuilder* builder)
{
    const pvtImportNode* node = &scene->nodes[index];
    pvtMesh joined;
    pvtStatus status = JoinMeshes(builder->context, scene, node, &joined);
    if (status != PVT_OK) {
        return status;
    }
    char fallback[32];
    const char* name = scene->names + node->name;
    if (name[0] == '\0') {
        (void)snprintf(fallback, sizeof fallback, "node_%zu", (size_t)index);
        name = fallback;
    }
    const pvtLocalMesh mesh = {joined.positions, joined.indices, joined.positionCount,
                               joined.triangleCount};
    status = pvtModelBuilder_AddPart(builder, name, node->group, place->transform, &mesh);
    pvtMesh_Free(builder->context, &joined);
    return status;
}

static pvtStatus AddNodes(const Scene* scene, const Placement* places, pvtModelBuilder* builder)
{
    pvtStatus status = ReserveModel(scene, places, builder);
    for (uint64_t i = 0; i < scene->header->nodeCount && status == PVT_OK; ++i) {
        uint64_t positions = 0, triangles = 0;
        if (IsPart(scene, places, i, &positions, &triangles)) {
            status = AddNode(scene, i, &places[i], builder);
        }
    }
    return status;
}

static void WarnOfPoses(const pvtLoadJob* job, const pvtImportHeader* header)
{
    if (header->skinnedCount > 0) {
        pvtLog(job->context, PVT_LOG_WARNING,
               "%s: skinned meshes that are taken in their bind pose: %zu", job->path,
               (size_t)header->skinnedCount);
    }
    if (header->morphedCount > 0) {
        pvtLog(job->context, PVT_LOG_WARNING,
               "%s: %zu meshes have morph targets; their base shape is taken", job->path,
               (size_t)header->morphedCount);
    }
}

static pvtStatus BuildModel(const pvtLoadJob* job, const Scene* scene, pvtModel* model)
{
    pvtContext* context = job->context;
    Placement* places = pvtAllocate(context, scene->header->nodeCount, sizeof *places);
    if (places == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtModelBuilder builder = {
        .context = context, .path = job->path, .keepsMeshes = job->options->keepMeshes};
    pvtStatus status = PVT_OK;
    if (PlaceNodes(job, scene, places)) {
        status = AddNodes(scene, places, &builder);
    } else {
        char name[PVT_NAME_SIZE];
        status = pvtFail(context, PVT_INVALID_ARGUMENT, "%s: there is no node named \"%s\"",
                         job->path, pvtCleanName(job->options->node, name));
    }
    if (status == PVT_OK) {
        WarnOfPoses(job, scene->header);
        status = pvtModelBuilder_Finish(&builder, model);
    }
    pvtModelBuilder_Free(&builder);
    pvtRelease(context, places);
    return status;
}

pvtStatus pvtImportModel(const pvtLoadJob* job, pvtModel* model)
{
    if (job->options->scene > 0) {
        return pvtFail(job->context, PVT_INVALID_ARGUMENT,
                       "%s: there is no scene %d; only glTF has several", job->path,
                       job->options->scene);
    }
    pvtChildResult result;
    pvtStatus status = pvtRunImporter(job, &result);
    if (status != PVT_OK) {
        return status;
    }
    pvtReportProgress(job->context, 0.7);
    Scene scene = {0};
    status = BindScene(job, &result, &scene);
    if (status == PVT_OK) {
        status = BuildModel(job, &scene, model);
    }
    pvtChildResult_Free(&result);
    return status;
}
