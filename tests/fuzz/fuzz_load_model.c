// SPDX-License-Identifier: MIT
// Any bytes as a model: the reader refuses them with a message, or gives a mesh that is sound. With
// libFuzzer where the preset `fuzz` builds it, else over the files named on the command line.
#include <paravent/io.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

static void Require(bool holds, const char* what)
{
    if (!holds) {
        (void)fprintf(stderr, "%s\n", what);
        abort();
    }
}

static void CheckMesh(const pvtMesh* mesh)
{
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        Require(mesh->indices[i] < mesh->positionCount, "an index out of range came out");
    }
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        const pvtVec3 p = mesh->positions[i];
        Require(isfinite(p.x) && isfinite(p.y) && isfinite(p.z), "a position is not finite");
    }
}

static void CheckModel(const pvtModel* model)
{
    const pvtMesh* mesh = &model->mesh;
    Require(mesh->triangleCount > 0, "a model without triangles came out");
    CheckMesh(mesh);
    for (size_t i = 0; i < model->meshCount; ++i) {
        CheckMesh(&model->meshes[i]);
    }
    for (size_t i = 0; i < model->partCount; ++i) {
        const pvtModelPart* part = &model->parts[i];
        Require(part->name != NULL && part->triangleCount <= mesh->triangleCount &&
                    part->firstTriangle <= mesh->triangleCount - part->triangleCount,
                "a part lies outside the mesh");
        Require(part->meshIndex < model->meshCount, "a part's mesh is not there");
    }
}

static void LoadModel(const char* path)
{
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = 1;
    def.memoryLimit = (size_t)256 << 20;
    pvtContext* context = NULL;
    Require(pvtCreateContext(&def, &context) == PVT_OK, "no context");
    pvtLoadOptions options = pvtDefaultLoadOptions();
    options.keepMeshes = true;
    pvtModel model;
    const pvtStatus status = pvtLoadModel(context, &options, path, &model);
    if (status == PVT_OK) {
        CheckModel(&model);
    } else {
        Require(pvtContext_GetMessage(context)[0] != '\0', "a failure without a message");
        Require(model.mesh.positions == NULL && model.parts == NULL && model.meshes == NULL,
                "a failure left something");
    }
    pvtModel_Free(context, &model);
    Require(pvtContext_GetHeldBytes(context) == 0, "something leaked");
    pvtDestroyContext(context);
}

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    char path[] = "/tmp/pvt-fuzz-XXXXXX";
    const int file = mkstemp(path);
    Require(file >= 0 && write(file, data, size) == (ssize_t)size && close(file) == 0,
            "no temporary file");
    LoadModel(path);
    unlink(path);
    return 0;
}

#ifndef PVT_FUZZ
int main(int argc, char** argv)
{
    for (int i = 1; i < argc; ++i) {
        LoadModel(argv[i]);
    }
    printf("%d files\n", argc - 1);
    return argc > 1 ? 0 : 1;
}
#endif
