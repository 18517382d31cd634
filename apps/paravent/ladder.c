// SPDX-License-Identifier: MIT
// paravent ladder: load, build every level, draw, save.
#include "ladder.h"

#include "command.h"
#include "setup.h"

#include <string.h>

static pvtStatus CheckEnding(pvtRun* run, const pvtGenerateOptions* options)
{
    if (strcmp(options->output, "-") != 0 && !pvtCanSaveLevels(options->output)) {
        return pvtRun_Fail(run, PVT_UNSUPPORTED,
                           "--output %s: ladders are written as .glb or .gltf; give the name one "
                           "of these endings",
                           options->output);
    }
    return PVT_OK;
}

// As closely as the finest level needs it.
static pvtStatus Load(pvtRun* run, const pvtLadderLine* options, const pvtLadderOptions* ladder,
                      pvtLadderResult* result)
{
    result->prepared = pvtGetClock();
    pvtGenerateOptions generate = options->generate;
    generate.error = options->errors != NULL ? ladder->errors[0] : 0.0;
    const pvtStatus status = pvtLoadInput(run, &generate, result->input, &result->model);
    result->loaded = pvtGetClock();
    return status;
}

static pvtStatus Build(pvtRun* run, const pvtLadderOptions* ladder, pvtLadderResult* result)
{
    const pvtStatus status =
        pvtBuildLadder(run->context, ladder, &result->model.mesh, &result->ladder);
    result->built = pvtGetClock();
    if (status != PVT_OK && status != PVT_CANCELLED) {
        // The stages know meshes, not files.
        return pvtRun_Fail(run, status, "%s: %s", result->input,
                           pvtContext_GetMessage(run->context));
    }
    return status;
}

// Each file is whole or not there; when a later one fails, the message says which are there.
static pvtStatus Save(pvtRun* run, const pvtLadderLine* options, pvtLadderResult* result,
                      const pvtImage* sheet)
{
    const pvtGenerateOptions* files = &options->generate;
    pvtStatus status = pvtSaveLadder(run, options, result);
    if (status != PVT_OK) {
        return status;
    }
    if (files->preview != NULL) {
        status = pvtSaveImage(run->context, files->preview, sheet);
    }
    result->saved = pvtGetClock();
    const bool hasPreview = status == PVT_OK && files->preview != NULL;
    if (status == PVT_OK && files->stats != NULL) {
        status = pvtSaveLadderStats(run, options, result);
    }
    if (status != PVT_OK) {
        pvtRun_AddToMessage(run, "; %s was written", files->output);
    }
    if (status != PVT_OK && hasPreview) {
        pvtRun_AddToMessage(run, ", and %s", files->preview);
    }
    return status;
}

static pvtStatus MakeLadder(pvtRun* run, const pvtLadderLine* options, pvtLadderOptions* ladder,
                            const pvtSetup* setup, pvtLadderResult* result)
{
    ladder->build = pvtSetup_GetBuildOptions(setup, &options->generate);
    if (options->generate.tolerance.value < 0.0) {
        ladder->build.tolerance = pvtDefaultBuildOptions().tolerance;
    }
    if (options->naming == PVT_NAMING_SUFFIX &&
        options->generate.convention == PVT_CONVENTION_GODOT) {
        pvtReport_Warn(&run->report,
                       "Godot's import makes one occluder of all nodes that end in -occonly, "
                       "coarse and fine; --naming msft shows it the finest level alone");
    }
    pvtImage sheet = {0};
    pvtStatus status = Load(run, options, ladder, result);
    if (status == PVT_OK) {
        status = Build(run, ladder, result);
    }
    if (status == PVT_OK && options->generate.preview != NULL) {
        status = pvtDrawLadder(run, setup->gl, options, result, &sheet);
    }
    result->previewed = pvtGetClock();
    if (status == PVT_OK) {
        status = pvtRun_CheckCancelled(run);
    }
    if (status == PVT_OK) {
        status = Save(run, options, result, &sheet);
    }
    if (status == PVT_OK) {
        pvtPrintLadder(run, options, result);
    }
    pvtImage_Free(run->context, &sheet);
    return status;
}

static int RunLadder(int count, char* const* words)
{
    pvtLadderLine options = pvtDefaultLadderLine();
    pvtLadderOptions ladder = pvtDefaultLadderOptions();
    const char* operands[1] = {NULL};
    pvtParsedLine line = {.operands = operands};
    int exitCode = PVT_EXIT_DONE;
    if (!pvtReadCommandLine(&pvtLadderSyntax, count, words, &options, &line, &exitCode)) {
        return exitCode;
    }
    pvtRun run;
    pvtSetup setup = {0};
    pvtLadderResult result = {.input = operands[0], .began = pvtGetClock()};
    pvtStatus status = pvtBeginRun(&options.generate.common, &run);
    if (status == PVT_OK) {
        status = pvtReadLevels(&run, &options, &line, &ladder);
    }
    if (status == PVT_OK) {
        status = CheckEnding(&run, &options.generate);
    }
    if (status == PVT_OK) {
        status = pvtOpenSetup(&run, &options.generate, operands[0], &setup);
    }
    if (status == PVT_OK) {
        status = MakeLadder(&run, &options, &ladder, &setup, &result);
    }
    if (run.context != NULL) {
        pvtLadder_Free(run.context, &result.ladder);
        pvtModel_Free(run.context, &result.model);
        pvtSetup_Close(&run, &setup);
    }
    return pvtEndRun(&run, status);
}

const pvtCommand pvtLadderCommand = {&pvtLadderSyntax, RunLadder};
