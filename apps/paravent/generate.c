// SPDX-License-Identifier: MIT
// paravent generate: load, build, draw, save.
#include "generate.h"

#include "command.h"
#include "separate.h"
#include "setup.h"

#include <stdlib.h>
#include <string.h>

static pvtStatus CheckEnding(pvtRun* run, const pvtGenerateOptions* options)
{
    if (strcmp(options->output, "-") != 0 && !pvtCanSaveModel(options->output)) {
        return pvtRun_Fail(
            run, PVT_UNSUPPORTED,
            "--output %s: models are written as .glb, .gltf, .obj, .ply or .tscn; give "
            "the name one of these endings",
            options->output);
    }
    return PVT_OK;
}

static pvtStatus Load(pvtRun* run, const pvtGenerateOptions* options, pvtGenerated* generated)
{
    generated->prepared = pvtGetClock();
    const pvtStatus status = pvtLoadInput(run, options, generated->input, &generated->model);
    generated->loaded = pvtGetClock();
    return status;
}

static pvtStatus Build(pvtRun* run, pvtGenerateOptions* options, const pvtSetup* setup,
                       pvtGenerated* generated)
{
    const pvtBuildOptions build = pvtSetup_GetBuildOptions(setup, options);
    pvtStatus status = PVT_OK;
    if (options->separate) {
        status = pvtBuildSeparately(run, &build, generated);
        options->budget = generated->separation.budget;
    } else {
        status = pvtBuildOccluder(run->context, &build, &generated->model.mesh,
                                  &generated->occluder, &generated->stats);
        generated->polygonCount = generated->occluder.loops.loopCount;
    }
    generated->built = pvtGetClock();
    if (status == PVT_INVALID_INPUT || status == PVT_NOTHING_INSIDE || status == PVT_LIMIT) {
        // The stages know meshes, not files.
        return pvtRun_Fail(run, status, "%s: %s", generated->input,
                           pvtContext_GetMessage(run->context));
    }
    return status;
}

static pvtStatus DrawPreview(pvtRun* run, const pvtGenerateOptions* options, const pvtSetup* setup,
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

static pvtStatus Generate(pvtRun* run, pvtGenerateOptions* options, const pvtSetup* setup,
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

static void Release(pvtRun* run, pvtSetup* setup, pvtGenerated* generated)
{
    pvtOccluder_Free(run->context, &generated->occluder);
    pvtSeparation_Free(run->context, &generated->separation);
    pvtModel_Free(run->context, &generated->model);
    pvtSetup_Close(run, setup);
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
    if (options.separate && !pvtIsOptionGiven(&pvtGenerateSyntax, &line, "budget")) {
        options.budget = 0;
    }
    pvtRun run;
    pvtSetup setup = {0};
    pvtGenerated generated = {.input = operands[0], .began = pvtGetClock()};
    pvtStatus status = pvtBeginRun(&options.common, &run);
    if (status == PVT_OK && options.error > 0.0 &&
        pvtIsOptionGiven(&pvtGenerateSyntax, &line, "resolution")) {
        status =
            pvtRun_Fail(&run, PVT_INVALID_ARGUMENT,
                        "--resolution and --error both set the voxels' size; give one of them");
    }
    if (status == PVT_OK) {
        status = CheckEnding(&run, &options);
    }
    if (status == PVT_OK) {
        status = pvtOpenSetup(&run, &options, operands[0], &setup);
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
