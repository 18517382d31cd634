// SPDX-License-Identifier: MIT
// Which reader a file goes to: glTF by its contents, the others by their names' endings.
#include "formats.h"
#include "source.h"
#include "text.h"

#include "base/context.h"

#include <ctype.h>
#include <string.h>

pvtLoadOptions pvtDefaultLoadOptions(void)
{
    return (pvtLoadOptions){
        .scene = -1,
        .node = NULL,
        .masked = PVT_MASKED_AUTO,
        .maxBytes = (size_t)4 << 30,
    };
}

void pvtModel_Free(pvtContext* context, pvtModel* model)
{
    pvtMesh_Free(context, &model->mesh);
    for (size_t i = 0; i < model->partCount; ++i) {
        pvtRelease(context, model->parts[i].name);
    }
    pvtRelease(context, model->parts);
    *model = (pvtModel){0};
}

static bool IsGlb(const pvtSource* source)
{
    return source->size >= 4 && memcmp(source->bytes, "glTF", 4) == 0;
}

// Whether the first thing in the file, after a byte order mark and white space, is an object.
static bool IsJson(const pvtSource* source)
{
    size_t at = source->size >= 3 && memcmp(source->bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (at < source->size && isspace(source->bytes[at])) {
        ++at;
    }
    return at < source->size && source->bytes[at] == '{';
}

static bool IsImported(const char* path)
{
    static const char* const endings[] = {".obj", ".ply", ".stl", ".fbx", ".dae"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; ++i) {
        if (pvtHasEnding(path, endings[i])) {
            return true;
        }
    }
    return false;
}

static pvtStatus FailUnknownFormat(pvtContext* context, const char* path)
{
    if (pvtHasEnding(path, ".glb") || pvtHasEnding(path, ".gltf")) {
        return pvtFail(context, PVT_INVALID_INPUT,
                       "%s: its contents are neither GLB (they do not begin with \"glTF\") nor "
                       "glTF (nor with \"{\"); export the model again",
                       path);
    }
    return pvtFail(context, PVT_UNSUPPORTED,
                   "%s: the format is not known; GLB, glTF, OBJ, PLY, STL, FBX and DAE are read",
                   path);
}

static pvtStatus LoadSource(const pvtLoadJob* job, pvtModel* model)
{
    if (job->source->size == 0) {
        return pvtFail(job->context, PVT_INVALID_INPUT,
                       "%s: the file is empty; export the model again", job->path);
    }
    if (IsGlb(job->source) || IsJson(job->source)) {
        return pvtLoadGltf(job, model);
    }
    if (IsImported(job->path)) {
        return pvtImportModel(job, model);
    }
    return FailUnknownFormat(job->context, job->path);
}

pvtStatus pvtLoadModel(pvtContext* context, const pvtLoadOptions* options, const char* path,
                       pvtModel* model)
{
    *model = (pvtModel){0};
    const pvtLoadOptions full = options != NULL ? *options : pvtDefaultLoadOptions();
    if (full.scene < -1 || full.masked < PVT_MASKED_AUTO || full.masked > PVT_MASKED_SKIP) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "scene is %d and masked %d; a scene is −1 or an index, masked 0 to 2",
                       full.scene, (int)full.masked);
    }
    pvtBeginStage(context, "load");
    pvtSource source;
    pvtStatus status = pvtReadSource(context, path, full.maxBytes, &source);
    if (status != PVT_OK) {
        return status;
    }
    pvtReportProgress(context, 0.3);
    const pvtLoadJob job = {context, &full, path, &source};
    status = LoadSource(&job, model);
    pvtSource_Free(context, &source);
    if (status == PVT_OK) {
        pvtReportProgress(context, 1.0);
    }
    return status;
}
