// SPDX-License-Identifier: MIT
// Which reader a file goes to: glTF by its contents, the others by their names' endings.
#include "formats.h"
#include "source.h"
#include "text.h"

#include "base/context.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum { MAX_MASKED_RESOLUTION = 65536 };

pvtLoadOptions pvtDefaultLoadOptions(void)
{
    return (pvtLoadOptions){
        .scene = -1,
        .node = NULL,
        .masked = PVT_MASKED_AUTO,
        .maskedResolution = 1024,
        .maskedCell = 0.0,
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
    for (size_t i = 0; i < model->meshCount; ++i) {
        pvtMesh_Free(context, &model->meshes[i]);
    }
    pvtRelease(context, model->meshes);
    *model = (pvtModel){0};
}

// The first bytes of a file, enough to tell what it is.
typedef struct Head {
    char bytes[1024];
    size_t size;
} Head;

static bool ReadHead(int file, Head* head)
{
    const ssize_t got = pread(file, head->bytes, sizeof head->bytes, 0);
    head->size = got < 0 ? 0 : (size_t)got;
    return got >= 0;
}

static bool IsGlb(const Head* head)
{
    return head->size >= 4 && memcmp(head->bytes, "glTF", 4) == 0;
}

static bool IsBlank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// Whether the first thing in the file, after a byte order mark and white space, is an object.
static bool IsJson(const Head* head)
{
    size_t at = head->size >= 3 && memcmp(head->bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (at < head->size && IsBlank(head->bytes[at])) {
        ++at;
    }
    return at < head->size && head->bytes[at] == '{';
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

static pvtStatus LoadGltf(const pvtLoadJob* job, pvtModel* model)
{
    pvtSource source;
    pvtStatus status = pvtReadOpenSource(job->context, job->file, job->size, job->path, &source);
    if (status == PVT_OK) {
        pvtReportProgress(job->context, 0.3);
        status = pvtLoadGltf(job, &source, model);
        pvtSource_Free(job->context, &source);
    }
    return status;
}

static pvtStatus LoadOpenFile(const pvtLoadJob* job, pvtModel* model)
{
    if (job->size == 0) {
        return pvtFail(job->context, PVT_INVALID_INPUT,
                       "%s: the file is empty; export the model again", job->path);
    }
    Head head;
    if (!ReadHead(job->file, &head)) {
        return pvtFail(job->context, PVT_INVALID_INPUT, "%s cannot be read: %s", job->path,
                       strerror(errno));
    }
    if (IsGlb(&head) || IsJson(&head)) {
        return LoadGltf(job, model);
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
    if (full.maskedResolution < 1 || full.maskedResolution > MAX_MASKED_RESOLUTION ||
        !(full.maskedCell >= 0.0 && isfinite(full.maskedCell))) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "maskedResolution is %d and maskedCell %g; they may be 1 to %d, and 0 or "
                       "more",
                       full.maskedResolution, full.maskedCell, MAX_MASKED_RESOLUTION);
    }
    pvtBeginStage(context, "load");
    pvtLoadJob job = {context, &full, path, -1, 0};
    pvtStatus status = pvtOpenSource(context, path, full.maxBytes, &job.file, &job.size);
    if (status == PVT_OK) {
        status = LoadOpenFile(&job, model);
        close(job.file);
    }
    if (status == PVT_OK) {
        pvtReportProgress(context, 1.0);
    }
    return status;
}

bool pvtIsGltf(pvtContext* context, const char* path)
{
    int file = -1;
    size_t size = 0;
    if (pvtOpenSource(context, path, SIZE_MAX, &file, &size) != PVT_OK) {
        return false;
    }
    Head head;
    const bool isGltf = ReadHead(file, &head) && (IsGlb(&head) || IsJson(&head));
    close(file);
    return isGltf;
}
