// SPDX-License-Identifier: MIT
// paravent generate: load, build, draw, save.
#include "generate.h"

#include "command.h"
#include "targets.h"

#include <stdlib.h>
#include <string.h>

// What is opened before the long work, so that nothing missing is found behind it.
typedef struct Setup {
    pvtViewList views;
    pvtGl* gl; // null: neither slicer nor preview needs it
    bool slicesOnGl;
} Setup;

static pvtStatus CheckEndings(pvtRun* run, const pvtGenerateOptions* options)
{
    if (strcmp(options->output, "-") != 0 && !pvtCanSaveModel(options->output)) {
        return pvtRun_Fail(run, PVT_UNSUPPORTED,
                           "--output %s: models are written as .glb, .gltf, .obj or .ply; give the "
                           "name one of these endings",
                           options->output);
    }
    if (options->preview != NULL && !pvtPathEndsIn(options->preview, ".png")) {
        return pvtRun_Fail(run, PVT_UNSUPPORTED,
                           "--preview %s: pictures are written as .png; give the name that ending",
                           options->preview);
    }
    return PVT_OK;
}

static pvtStatus CheckFiles(pvtRun* run, const pvtGenerateOptions* options, const char* input)
{
    const bool hasViewFile =
        strcmp(options->views, "all") != 0 && strcmp(options->views, "above") != 0;
    const pvtTarget targets[] = {
        {NULL, input, false},
        {NULL, hasViewFile ? options->views : NULL, false},
        {"--output", options->output, false},
        {"--stats", options->stats, true},
        {"--preview", options->preview, false},
    };
    return pvtCheckTargets(run, targets, sizeof targets / sizeof *targets);
}

// One backend serves both: the one that slices, or for a preview alone any that is there.
static pvtStatus OpenBackend(pvtRun* run, const pvtGenerateOptions* options, Setup* setup)
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

static pvtStatus Prepare(pvtRun* run, const pvtGenerateOptions* options, const char* input,
                         Setup* setup)
{
    pvtStatus status = CheckEndings(run, options);
    if (status == PVT_OK) {
        status = CheckFiles(run, options, input);
    }
    const bool isWord = strcmp(options->views, "all") == 0 || strcmp(options->views, "above") == 0;
    if (status == PVT_OK && !isWord) {
        status = pvtReadViewList(run, options->views, &setup->views);
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

static pvtStatus Load(pvtRun* run, const pvtGenerateOptions* options, pvtGenerated* generated)
{
    pvtLoadOptions load = pvtDefaultLoadOptions();
    load.scene = options->scene;
    load.node = options->node;
    load.masked = (pvtMasked)options->masked;
    generated->prepared = pvtGetClock();
    const pvtStatus status = pvtLoadModel(run->context, &load, generated->input, &generated->model);
    generated->loaded = pvtGetClock();
    return status;
}

static pvtStatus Build(pvtRun* run, const pvtGenerateOptions* options, const Setup* setup,
                       pvtGenerated* generated)
{
    pvtBuildOptions build = pvtGetBuildOptions(options, &setup->views);
    if (setup->slicesOnGl) {
        build.createSlicer = CreateSlicer;
        build.releaseSlicer = ReleaseSlicer;
        build.slicerUser = setup->gl;
    }
    const pvtStatus status = pvtBuildOccluder(run->context, &build, &generated->model.mesh,
                                              &generated->occluder, &generated->stats);
    generated->built = pvtGetClock();
    if (status == PVT_INVALID_INPUT || status == PVT_NOTHING_INSIDE || status == PVT_LIMIT) {
        // The stages know meshes, not files.
        return pvtRun_Fail(run, status, "%s: %s", generated->input,
                           pvtContext_GetMessage(run->context));
    }
    return status;
}

static pvtStatus DrawPreview(pvtRun* run, const pvtGenerateOptions* options, const Setup* setup,
                             pvtGenerated* generated, pvtImage* image)
{
    pvtStatus status = PVT_OK;
    if (options->preview != NULL) {
        pvtPreviewOptions preview = pvtDefaultPreviewOptions();
        preview.up = (pvtAxis)options->up;
        status = pvtRenderPreview(run->context, setup->gl, &preview, &generated->model.mesh,
                                  &generated->occluder.mesh, image);
    }
    generated->previewed = pvtGetClock();
    return status;
}

// Each file is whole or not there; when a later one fails, the message says which are there.
static pvtStatus Save(pvtRun* run, const pvtGenerateOptions* options, pvtGenerated* generated,
                      const pvtImage* image)
{
    pvtStatus status = pvtSaveOccluder(run, options, generated);
    if (status != PVT_OK) {
        return status;
    }
    if (options->preview != NULL) {
        status = pvtSaveImage(run->context, options->preview, image);
        if (status != PVT_OK) {
            pvtRun_AddToMessage(run, "; %s was written", options->output);
            return status;
        }
    }
    generated->saved = pvtGetClock();
    if (options->stats != NULL) {
        status = pvtSaveStats(run, options, generated);
        if (status != PVT_OK) {
            pvtRun_AddToMessage(run, "; %s was written", options->output);
        }
        if (status != PVT_OK && options->preview != NULL) {
            pvtRun_AddToMessage(run, ", and %s", options->preview);
        }
    }
    return status;
}

static pvtStatus Generate(pvtRun* run, const pvtGenerateOptions* options, const Setup* setup,
                          pvtGenerated* generated)
{
    pvtImage image = {0};
    pvtStatus status = Load(run, options, generated);
    if (status == PVT_OK) {
        status = Build(run, options, setup, generated);
    }
    if (status == PVT_OK) {
        status = DrawPreview(run, options, setup, generated, &image);
    }
    if (status == PVT_OK) {
        status = pvtRun_CheckCancelled(run);
    }
    if (status == PVT_OK) {
        status = Save(run, options, generated, &image);
    }
    if (status == PVT_OK) {
        pvtPrintSummary(run, options, generated);
    }
    pvtImage_Free(run->context, &image);
    return status;
}

static void Release(pvtRun* run, Setup* setup, pvtGenerated* generated)
{
    pvtOccluder_Free(run->context, &generated->occluder);
    pvtModel_Free(run->context, &generated->model);
    if (setup->gl != NULL) {
        pvtCloseGl(run->context, setup->gl);
    }
    pvtViewList_Free(&setup->views);
}

static int RunGenerate(int count, char* const* words)
{
    pvtGenerateOptions options = pvtDefaultGenerateOptions();
    const char* operands[1] = {NULL};
    pvtParsedLine line = {.operands = operands};
    int exitCode = PVT_EXIT_DONE;
    if (!pvtReadCommandLine(&pvtGenerateSyntax, count, words, &options, &line, &exitCode)) {
        return exitCode;
    }
    pvtRun run;
    Setup setup = {0};
    pvtGenerated generated = {.input = operands[0], .began = pvtGetClock()};
    pvtStatus status = pvtBeginRun(&options.common, &run);
    if (status == PVT_OK && options.error > 0.0 &&
        pvtIsOptionGiven(&pvtGenerateSyntax, &line, "resolution")) {
        status =
            pvtRun_Fail(&run, PVT_INVALID_ARGUMENT,
                        "--resolution and --error both set the voxels' size; give one of them");
    }
    if (status == PVT_OK) {
        status = Prepare(&run, &options, operands[0], &setup);
    }
    if (status == PVT_OK) {
        status = Generate(&run, &options, &setup, &generated);
    }
    if (run.context != NULL) {
        Release(&run, &setup, &generated);
    }
    return pvtEndRun(&run, status);
}

const pvtCommand pvtGenerateCommand = {&pvtGenerateSyntax, RunGenerate};
