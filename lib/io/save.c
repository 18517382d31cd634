// SPDX-License-Identifier: MIT
// What is saved is checked first, so that writers only write.
#include "formats.h"
#include "placement.h"
#include "text.h"

#include "base/context.h"

#include <float.h>
#include <math.h>

typedef enum Format {
    FORMAT_NONE,
    FORMAT_GLB,
    FORMAT_GLTF,
    FORMAT_OBJ,
    FORMAT_PLY,
    FORMAT_TSCN
} Format;

static Format GetFormat(const char* path)
{
    static const struct {
        const char* ending;
        Format format;
    } formats[] = {{".glb", FORMAT_GLB},
                   {".gltf", FORMAT_GLTF},
                   {".obj", FORMAT_OBJ},
                   {".ply", FORMAT_PLY},
                   {".tscn", FORMAT_TSCN}};
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; ++i) {
        if (pvtHasEnding(path, formats[i].ending)) {
            return formats[i].format;
        }
    }
    return FORMAT_NONE;
}

bool pvtCanSaveModel(const char* path)
{
    return GetFormat(path) != FORMAT_NONE;
}

static bool FitsFloat(pvtVec3 p)
{
    return fabs(p.x) <= FLT_MAX && fabs(p.y) <= FLT_MAX && fabs(p.z) <= FLT_MAX;
}

static pvtStatus CheckMesh(pvtContext* context, const char* name, const pvtMesh* mesh)
{
    if (mesh == NULL || mesh->triangleCount == 0) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "\"%s\" has no triangle to save", name);
    }
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        if (!FitsFloat(mesh->positions[i])) {
            return pvtFail(context, PVT_INVALID_ARGUMENT,
                           "\"%s\": position %zu does not fit in a float", name, i);
        }
    }
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        if (mesh->indices[i] >= mesh->positionCount) {
            return pvtFail(context, PVT_INVALID_ARGUMENT,
                           "\"%s\": index %zu is %u, but there are %zu positions", name, i,
                           mesh->indices[i], mesh->positionCount);
        }
    }
    return PVT_OK;
}

static pvtStatus CheckItems(const pvtSaveJob* job)
{
    if (job->count == 0) {
        return pvtFail(job->context, PVT_INVALID_ARGUMENT, "there is nothing to save");
    }
    const pvtMesh* checked = NULL;
    for (size_t i = 0; i < job->count; ++i) {
        const pvtSaveItem* item = &job->items[i];
        char name[PVT_NAME_SIZE];
        pvtCleanName(item->name != NULL ? item->name : "", name);
        // Instances come one behind the other.
        const pvtStatus status = item->mesh != NULL && item->mesh == checked
                                     ? PVT_OK
                                     : CheckMesh(job->context, name, item->mesh);
        if (status != PVT_OK) {
            return status;
        }
        checked = item->mesh;
    }
    return PVT_OK;
}

static pvtStatus Write(const pvtSaveJob* job, Format format, pvtOutput* output)
{
    switch (format) {
    case FORMAT_GLB:
    case FORMAT_GLTF:
        return pvtWriteGltf(job, format == FORMAT_GLB, output);
    case FORMAT_OBJ:
        return pvtWriteObj(job, output);
    case FORMAT_TSCN:
        return pvtWriteTscn(job, output);
    case FORMAT_PLY:
    case FORMAT_NONE:
        break;
    }
    return pvtWritePly(job, output);
}

// Whether nodes of the format have transforms, so that they can share a mesh.
static bool CanPlace(Format format)
{
    return format == FORMAT_GLB || format == FORMAT_GLTF || format == FORMAT_TSCN;
}

static pvtStatus WriteFile(const pvtSaveJob* job, Format format, const char* path)
{
    pvtOutput* output = NULL;
    pvtStatus status = pvtOpenOutput(job->context, path, &output);
    if (status != PVT_OK) {
        return status;
    }
    status = Write(job, format, output);
    if (status != PVT_OK) {
        pvtDiscardOutput(output);
        return status;
    }
    return pvtCommitOutput(output);
}

pvtStatus pvtSaveModel(pvtContext* context, const char* path, const pvtSaveItem* items,
                       size_t count)
{
    const Format format = GetFormat(path);
    if (format == FORMAT_NONE) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "%s: only names that end in .glb, .gltf, .obj, .ply or .tscn can be written",
                       path);
    }
    const pvtSaveJob job = {context, items, count};
    pvtPlacedItems placed = {0};
    pvtStatus status = CheckItems(&job);
    if (status == PVT_OK) {
        status = pvtPlaceItems(&job, CanPlace(format), &placed);
    }
    if (status == PVT_OK) {
        const pvtSaveJob placedJob = {context, placed.items, placed.count};
        status = CheckItems(&placedJob);
        if (status == PVT_OK) {
            status = WriteFile(&placedJob, format, path);
        }
    }
    pvtPlacedItems_Free(context, &placed);
    return status;
}

bool pvtCanSaveLevels(const char* path)
{
    const Format format = GetFormat(path);
    return format == FORMAT_GLB || format == FORMAT_GLTF;
}

static pvtStatus CheckLevels(pvtContext* context, const pvtLevelSet* set)
{
    const pvtSaveJob levels = {context, set->levels, set->levelCount};
    const pvtSaveJob others = {context, set->others, set->otherCount};
    const pvtStatus status = CheckItems(&levels);
    return status == PVT_OK && set->otherCount > 0 ? CheckItems(&others) : status;
}

static pvtStatus WriteLevelFile(pvtContext* context, const char* path, const pvtLevelSet* set)
{
    pvtOutput* output = NULL;
    pvtStatus status = pvtOpenOutput(context, path, &output);
    if (status != PVT_OK) {
        return status;
    }
    status = pvtWriteLevels(context, set, GetFormat(path) == FORMAT_GLB, output);
    if (status != PVT_OK) {
        pvtDiscardOutput(output);
        return status;
    }
    return pvtCommitOutput(output);
}

pvtStatus pvtSaveLevels(pvtContext* context, const char* path, const pvtLevelSet* set)
{
    if (!pvtCanSaveLevels(path)) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "%s: levels can be written only to names that end in .glb or .gltf", path);
    }
    const pvtSaveJob levels = {context, set->levels, set->levelCount};
    const pvtSaveJob others = {context, set->others, set->otherCount};
    pvtPlacedItems placedLevels = {0};
    pvtPlacedItems placedOthers = {0};
    pvtStatus status = CheckLevels(context, set);
    if (status == PVT_OK) {
        status = pvtPlaceItems(&levels, true, &placedLevels);
    }
    if (status == PVT_OK) {
        status = pvtPlaceItems(&others, true, &placedOthers);
    }
    if (status == PVT_OK) {
        pvtLevelSet placed = *set;
        placed.levels = placedLevels.items;
        placed.others = placedOthers.items;
        status = CheckLevels(context, &placed);
        if (status == PVT_OK) {
            status = WriteLevelFile(context, path, &placed);
        }
    }
    pvtPlacedItems_Free(context, &placedLevels);
    pvtPlacedItems_Free(context, &placedOthers);
    return status;
}
