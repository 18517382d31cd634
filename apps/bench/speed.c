// SPDX-License-Identifier: MIT
// paravent-bench speed: the small things that a build does most, then whole builds.
#include "speed.h"

#define FIELD(kindName, field) .kind = (kindName), .offset = offsetof(pvtSpeedLine, field)

static const pvtOption measureTable[] = {
    {.name = "repeats",
     FIELD(PVT_OPTION_INT, repeats),
     .placeholder = "N",
     .least = 1,
     .most = 1000,
     .help = "least number of repeats of a slice or mask measurement; the median counts"},
    {.name = "seconds",
     FIELD(PVT_OPTION_DOUBLE, seconds),
     .placeholder = "S",
     .least = 0,
     .most = 60,
     .help = "time for the repeats of each"},
    {.name = "against-paper",
     FIELD(PVT_OPTION_FLAG, againstPaper),
     .help = "each model by the paper's way with slices by OSMesa, too"},
    {.name = "paper-resolution",
     FIELD(PVT_OPTION_INT, paperResolution),
     .placeholder = "N",
     .least = 8,
     .most = 2048,
     .help = "voxels along the longest side, for both sides of that comparison"},
};

static const pvtOptionGroup groups[] = {
    {"Occluders", pvtBenchOptionTable, PVT_BENCH_OPTION_COUNT},
    {"What counts as inside", pvtSolidOptionTable, PVT_SOLID_OPTION_COUNT},
    {"Measuring", measureTable, sizeof measureTable / sizeof *measureTable},
    {"General", pvtCommonOptionTable, PVT_COMMON_OPTION_COUNT},
};

static const pvtSyntax syntax = {
    .program = "paravent-bench",
    .name = "speed",
    .summary = "time slices, distance transforms, and whole builds",
    .operands = "[MODEL...]",
    .mostOperands = PVT_MOST_MODELS,
    .operandHelp = "models to build occluders of; the first is sliced, else a ball",
    .groups = groups,
    .groupCount = sizeof groups / sizeof *groups,
    .notes = "Slices and masks are timed on one thread, but for what a graphics driver does; "
             "builds take --threads. The peak is what the library held, with the model.",
};

static int RunMeasurements(const pvtSpeedLine* values, const char* path)
{
    pvtRun run;
    pvtCommonOptions common = values->bench.common;
    pvtStatus status = pvtBeginRun(&common, &run);
    if (status == PVT_OK) {
        printf("slices of %s, mean over 32 directions, 3 planes each; one thread\n",
               path != NULL ? pvtGetFileName(path) : "a ball");
        status = pvtPrintSliceSpeeds(&run, values, path);
    }
    if (status == PVT_OK) {
        status = pvtPrintMaskSpeeds(&run, values);
    }
    return pvtEndRun(&run, status);
}

static int RunLine(void* values, const pvtParsedLine* line)
{
    const pvtSpeedLine* speed = values;
    const char* const* paths = line->operands;
    const int count = line->operandCount;
    int exitCode = RunMeasurements(speed, count > 0 ? paths[0] : NULL);
    if (exitCode == PVT_EXIT_DONE) {
        exitCode = pvtPrintBuildSpeeds(speed, paths, count);
    }
    if (exitCode == PVT_EXIT_DONE && speed->againstPaper) {
        exitCode = pvtPrintPaperSpeeds(speed, paths, count);
    }
    return exitCode;
}

static int RunSpeed(int count, char* const* words)
{
    pvtSpeedLine values = {
        .bench = pvtDefaultGenerateOptions(), .repeats = 5, .seconds = 0.2, .paperResolution = 128};
    return pvtRunCommandLine(&syntax, count, words, &values, RunLine);
}

const pvtCommand pvtSpeedCommand = {&syntax, RunSpeed};
