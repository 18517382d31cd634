// SPDX-License-Identifier: MIT
#include "setup.h"

#include "targets.h"

#include <math.h>
#include <string.h>

// The file that --views names, or null.
static const char* GetViewFile(const pvtGenerateOptions* options)
{
    const bool isWord = strcmp(options->views, "all") == 0 || strcmp(options->views, "above") == 0;
    return isWord ? NULL : options->views;
}

// One backend serves both: the one that slices, or for a preview alone any that is there.
static pvtStatus OpenBackend(pvtRun* run, const pvtGenerateOptions* options, pvtSetup* setup)
{
    int slicer = options->slicer;
    if (slicer == PVT_SLICER_AUTO) {
        slicer = pvtHasGlHardware() ? PVT_SLICER_EGL : PVT_SLICER_SAMPLE;
    }
    setup->slicesOnGl = slicer == PVT_SLICER_EGL || slicer == PVT_SLICER_OSMESA;
    if (!setup->slicesOnGl && options->preview == NULL) {
        return PVT_OK;
    }
    const pvtGlBackend backend = slicer == PVT_SLICER_EGL      ? PVT_GL_EGL
                                 : slicer == PVT_SLICER_OSMESA ? PVT_GL_OSMESA
                                                               : PVT_GL_AUTO;
    const pvtStatus status = pvtOpenGl(run->context, backend, &setup->gl);
    if (status == PVT_OK) {
        pvtReport_Detail(&run->report, "graphics: %s", pvtGl_GetName(setup->gl));
    }
    return status;
}

// Whether pictures can be written at all is seen by writing one, of a pixel, to nowhere.
static pvtStatus CheckImages(pvtRun* run, const pvtGenerateOptions* options)
{
    static const char nowhere[] = "/dev/null";
    pvtImage pixel = {0};
    pvtStatus status = pvtCreateImage(run->context, 1, 1, &pixel);
    if (status != PVT_OK) {
        return status;
    }
    status = pvtSaveImage(run->context, nowhere, &pixel);
    pvtImage_Free(run->context, &pixel);
    if (status == PVT_OK) {
        return PVT_OK;
    }
    const char* reason = pvtContext_GetMessage(run->context);
    const size_t length = strlen(nowhere);
    if (strncmp(reason, nowhere, length) == 0 && strncmp(reason + length, ": ", 2) == 0) {
        reason += length + 2;
    }
    return pvtRun_Fail(run, status, "--preview %s: %s", options->preview, reason);
}

static pvtStatus CheckFiles(pvtRun* run, const pvtGenerateOptions* options, const char* input)
{
    const pvtTarget targets[] = {
        {NULL, input, false},
        {NULL, GetViewFile(options), false},
        {"--output", options->output, false},
        {"--stats", options->stats, true},
        {"--preview", options->preview, false},
    };
    const pvtStatus status = pvtCheckPicture(run, "--preview", options->preview);
    return status == PVT_OK ? pvtCheckTargets(run, targets, sizeof targets / sizeof *targets)
                            : status;
}

pvtStatus pvtOpenSetup(pvtRun* run, const pvtGenerateOptions* options, const char* input,
                       pvtSetup* setup)
{
    pvtStatus status = CheckFiles(run, options, input);
    const char* viewFile = GetViewFile(options);
    if (status == PVT_OK && viewFile != NULL) {
        status = pvtReadViewList(run, viewFile, &setup->views);
    }
    if (status == PVT_OK && options->preview != NULL) {
        status = CheckImages(run, options);
    }
    return status == PVT_OK ? OpenBackend(run, options, setup) : status;
}

static pvtStatus CreateSlicer(pvtContext* context, void* user, const pvtGridFrame* frame,
                              const pvtMesh* voxelMesh, pvtSlicer* slicer)
{
    return pvtCreateStencilSlicer(context, user, frame, voxelMesh, slicer);
}

static void ReleaseSlicer(pvtContext* context, void* user, pvtSlicer* slicer)
{
    (void)user;
    pvtReleaseStencilSlicer(context, slicer);
}

pvtBuildOptions pvtSetup_GetBuildOptions(const pvtSetup* setup, const pvtGenerateOptions* options)
{
    pvtBuildOptions build = pvtGetBuildOptions(options, &setup->views);
    if (setup->slicesOnGl) {
        build.createSlicer = CreateSlicer;
        build.releaseSlicer = ReleaseSlicer;
        build.slicerUser = setup->gl;
    }
    return build;
}

void pvtSetup_Close(pvtRun* run, pvtSetup* setup)
{
    if (setup->gl != NULL) {
        pvtCloseGl(run->context, setup->gl);
    }
    pvtViewList_Free(&setup->views);
    *setup = (pvtSetup){0};
}

pvtStatus pvtLoadInput(pvtRun* run, const pvtGenerateOptions* options, const char* path,
                       pvtModel* model)
{
    pvtLoadOptions load = pvtDefaultLoadOptions();
    load.scene = options->scene;
    load.node = options->node;
    load.masked = (pvtMasked)options->masked;
    // What a voxel cannot tell apart need not be cut out; √3 voxels are within the error.
    load.maskedResolution = options->resolution;
    load.maskedCell = options->error > 0.0 ? options->error / sqrt(3.0) : 0.0;
    load.keepMeshes = options->separate;
    return pvtLoadModel(run->context, &load, path, model);
}
