// SPDX-License-Identifier: MIT
// The line of `paravent ladder` as a table, and its lists.
#include "choices.h"
#include "ladder.h"
#include "values.h"

#include <math.h>
#include <string.h>

static const char* const namingChoices[] = {"msft", "suffix", NULL};

#define FIELD(kindName, field) .kind = (kindName), .offset = offsetof(pvtLadderLine, field)

static const pvtOption outputTable[] = {
    {.name = "output",
     .letter = 'o',
     .isRequired = true,
     FIELD(PVT_OPTION_TEXT, generate.output),
     .placeholder = "FILE",
     .defaultText = "",
     .help = "where the ladder goes: .glb or .gltf by the name's ending"},
    {.name = "naming",
     FIELD(PVT_OPTION_CHOICE, naming),
     .choices = namingChoices,
     .help = "msft: the finest level's node names the others by MSFT_lod, with "
             "MSFT_screencoverage; suffix: plain nodes NAME_LOD0, NAME_LOD1 and so on, all in the "
             "scene"},
    {.name = "with-original",
     FIELD(PVT_OPTION_FLAG, withOriginal),
     .help =
         "the original comes out too, with the ladder in its scene: of GLB and glTF everything, "
         "with buffers and images beside the file taken in; of other formats the triangles, a "
         "node a part, in world coordinates, without materials and all else"},
    {.name = "convention",
     FIELD(PVT_OPTION_CHOICE, generate.convention),
     .choices = pvtConventionChoices,
     .help = "names end in _occluder, or in -occonly as Godot's import wants it; with --naming "
             "suffix plain names end in _LOD0 and so on"},
    {.name = "stats",
     FIELD(PVT_OPTION_TEXT, generate.stats),
     .placeholder = "FILE",
     .defaultText = "",
     .help = "numbers about the run and each level as JSON; - is the standard output"},
    {.name = "preview",
     FIELD(PVT_OPTION_TEXT, generate.preview),
     .placeholder = "FILE.png",
     .defaultText = "",
     .help = "a picture: for each level six views, the original with the occluder over it"},
};

static const pvtOption levelTable[] = {
    {.name = "levels",
     FIELD(PVT_OPTION_INT, levels),
     .placeholder = "N",
     .least = 1,
     .most = PVT_MAX_LEVELS,
     .help = "how many levels; the lists below may tell it instead"},
    {.name = "errors",
     FIELD(PVT_OPTION_TEXT, errors),
     .placeholder = "A,B,C",
     .defaultText = "what --resolution reaches, then always twice the one before",
     .help = "each level's error bound in world units, growing; it sets the level's voxel size"},
    {.name = "budgets",
     FIELD(PVT_OPTION_TEXT, budgets),
     .placeholder = "A,B,C",
     .defaultText = "64,32,16,8: halves, from as much as leaves 4 at the last level",
     .help = "most triangles of each level, falling"},
    {.name = "resolution",
     FIELD(PVT_OPTION_INT, generate.resolution),
     .placeholder = "N",
     .least = 8,
     .most = 2048,
     .help = "voxels along the longest side at the finest level, unless --errors is given"},
    {.name = "tolerance",
     FIELD(PVT_OPTION_LENGTH, generate.tolerance),
     .placeholder = "T",
     .most = INFINITY,
     .defaultText = "0 at the finest level, which is used however near, else 1vx",
     .help = "how far polygons may leave the strict interior; it is part of the error bound"},
    {.name = "pixel-error",
     FIELD(PVT_OPTION_DOUBLE, pixelError),
     .placeholder = "P",
     .most = 65536.0,
     .isLeastExcluded = true,
     .help = "the thickest error in pixels that a level may show"},
    {.name = "fov",
     FIELD(PVT_OPTION_DOUBLE, fieldOfView),
     .placeholder = "DEGREES",
     .least = 1.0,
     .most = 179.0,
     .help = "the field of view, from the screen's lower to its upper edge"},
    {.name = "screen-height",
     FIELD(PVT_OPTION_INT, screenHeight),
     .placeholder = "N",
     .least = 1,
     .most = 65536,
     .help = "pixels from the screen's lower to its upper edge"},
    {.name = "screen-width",
     FIELD(PVT_OPTION_INT, screenWidth),
     .placeholder = "N",
     .least = 1,
     .most = 65536,
     .defaultText = "16/9 of the height",
     .help = "pixels from the screen's left to its right edge, for the coverage"},
};

#define GROUP(title, table)                                                                        \
    {                                                                                              \
        title, table, sizeof(table) / sizeof *(table)                                              \
    }

static const pvtOptionGroup groups[] = {
    GROUP("Output", outputTable),
    GROUP("Levels", levelTable),
    {"Optimizer", pvtOptimizerOptionTable, PVT_OPTIMIZER_OPTION_COUNT},
    {"What counts as inside", pvtSolidOptionTable, PVT_SOLID_OPTION_COUNT},
    {"Input", pvtInputOptionTable, PVT_INPUT_OPTION_COUNT},
    {"Work", pvtSlicerOptionTable, PVT_SLICER_OPTION_COUNT},
    {"Common", pvtCommonOptionTable, PVT_COMMON_OPTION_COUNT},
};

const pvtSyntax pvtLadderSyntax = {
    .name = "ladder",
    .summary = "levels of detail: occluders from fine to coarse, and from where on each will do",
    .operands = "INPUT -o OUTPUT",
    .leastOperands = 1,
    .mostOperands = 1,
    .operandHelp = "INPUT is a model: .glb, .gltf, .obj, .ply, .stl, .fbx or .dae.",
    .groups = groups,
    .groupCount = sizeof groups / sizeof *groups,
    .notes =
        "Lengths are in the input's world units; with the suffix vx they are in the voxels of each "
        "level, so that openings up to --smallest-hole 3vx close one after the other as voxels "
        "grow.\n"
        "A level with error bound E may be used from the distance\n"
        "  D = R + E x H / (2 tan(F/2)) / P, and no less than 2 R\n"
        "from the ladder's center on, with P = --pixel-error, F = --fov and H = --screen-height: "
        "there no pixel that it hides wrongly is farther than P pixels from the original (as "
        "far as the error bound goes: --ground, --terrain and --enclosed declare more to be "
        "inside). The center and r are those of the sphere around the finest level's bounding box; "
        "R reaches "
        "from there to the farthest corner of the original's.\n"
        "The screen coverage at a distance D is the part of the screen's area that the sphere "
        "covers, as Babylon.js reckons it:\n"
        "  C = pi (r/D)^2 H / (4 tan(F/2)^2 W), at most 1, with W = --screen-width.\n"
        "Each entry of MSFT_screencoverage is the C of the next level: down to it a level is "
        "shown. The last is 0, so that the coarsest level stays.\n"
        "Examples:\n"
        "  paravent ladder house.glb -o house_ladder.glb --ground --with-original\n"
        "  paravent ladder bunny.glb -o lods.glb --errors 0.01,0.05,0.2 --budgets 90,40,9\n"
        "Exit codes: 0 done, 1 wrong command line, 2 invalid input, 3 feature missing here, "
        "4 output cannot be written, 5 nothing to occlude with, 6 limit reached, 130 cancelled.",
};

pvtLadderLine pvtDefaultLadderLine(void)
{
    const pvtLadderOptions ladder = pvtDefaultLadderOptions();
    pvtLadderLine options = {
        .generate = pvtDefaultGenerateOptions(),
        .levels = ladder.levelCount,
        .pixelError = ladder.screen.pixelError,
        .fieldOfView = ladder.screen.fieldOfView,
        .screenHeight = ladder.screen.height,
        .screenWidth = -1,
    };
    options.generate.tolerance = (pvtLength){-1.0, false};
    return options;
}

// Splits "a,b,c" into numbers. `wanted` says what each has to be.
static pvtStatus ReadList(pvtRun* run, const char* option, const char* text, double* numbers,
                          int* count)
{
    *count = 0;
    for (const char* at = text;;) {
        const size_t length = strcspn(at, ",");
        char word[64];
        if (*count == PVT_MAX_LEVELS) {
            return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                               "--%s %s: there are at most %d levels, and so numbers", option, text,
                               PVT_MAX_LEVELS);
        }
        (void)snprintf(word, sizeof word, "%.*s", (int)(length < 63 ? length : 63), at);
        if (length > 63 || !pvtReadNumber(word, &numbers[*count])) {
            return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                               "--%s %s: '%s' is not a number; it takes numbers with commas "
                               "between them, one a level",
                               option, text, word);
        }
        ++*count;
        if (at[length] == '\0') {
            return PVT_OK;
        }
        at += length + 1;
    }
}

static pvtStatus ReadErrors(pvtRun* run, const char* text, double* errors, int* count)
{
    const pvtStatus status = ReadList(run, "errors", text, errors, count);
    for (int i = 0; i < *count && status == PVT_OK; ++i) {
        if (errors[i] <= 0.0) {
            return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                               "--errors %s: %g is not above 0; every level has an error", text,
                               errors[i]);
        }
        if (i > 0 && errors[i] <= errors[i - 1]) {
            return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                               "--errors %s: %g follows %g; errors grow from level to level", text,
                               errors[i], errors[i - 1]);
        }
    }
    return status;
}

static pvtStatus ReadBudgets(pvtRun* run, const char* text, int* budgets, int* count)
{
    double numbers[PVT_MAX_LEVELS];
    const pvtStatus status = ReadList(run, "budgets", text, numbers, count);
    for (int i = 0; i < *count && status == PVT_OK; ++i) {
        if (numbers[i] != floor(numbers[i]) || numbers[i] < 1.0 || numbers[i] > 65535.0) {
            return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                               "--budgets %s: %.17g is not a whole number, 1 to 65535", text,
                               numbers[i]);
        }
        budgets[i] = (int)numbers[i];
        if (i > 0 && budgets[i] >= budgets[i - 1]) {
            return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                               "--budgets %s: %d follows %d; triangles fall from level to level",
                               text, budgets[i], budgets[i - 1]);
        }
    }
    return status;
}

// How many levels there are: --levels and the lists must agree as far as they are given.
static pvtStatus CountLevels(pvtRun* run, const pvtLadderLine* options, const pvtParsedLine* line,
                             int errorCount, int budgetCount, int* count)
{
    *count = errorCount > 0 ? errorCount : budgetCount > 0 ? budgetCount : options->levels;
    if (errorCount > 0 && budgetCount > 0 && errorCount != budgetCount) {
        return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                           "--errors has %d number%s and --budgets %d; give as many of each, one a "
                           "level",
                           errorCount, errorCount == 1 ? "" : "s", budgetCount);
    }
    if (*count != options->levels && pvtIsOptionGiven(&pvtLadderSyntax, line, "levels")) {
        return pvtRun_Fail(
            run, PVT_INVALID_ARGUMENT, "--levels is %d, but --%s has %d number%s; give one a level",
            options->levels, errorCount > 0 ? "errors" : "budgets", *count, *count == 1 ? "" : "s");
    }
    return PVT_OK;
}

pvtStatus pvtReadLevels(pvtRun* run, pvtLadderLine* options, const pvtParsedLine* line,
                        pvtLadderOptions* ladder)
{
    int errorCount = 0;
    int budgetCount = 0;
    pvtStatus status = PVT_OK;
    if (options->errors != NULL) {
        status = ReadErrors(run, options->errors, ladder->errors, &errorCount);
    }
    if (status == PVT_OK && options->budgets != NULL) {
        status = ReadBudgets(run, options->budgets, ladder->budgets, &budgetCount);
    }
    if (status == PVT_OK) {
        status = CountLevels(run, options, line, errorCount, budgetCount, &ladder->levelCount);
    }
    options->levels = ladder->levelCount;
    if (status == PVT_OK && errorCount > 0 &&
        pvtIsOptionGiven(&pvtLadderSyntax, line, "resolution")) {
        status =
            pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                        "--resolution and --errors both set the voxels' size; give one of them");
    }
    ladder->screen =
        (pvtScreenOptions){.pixelError = options->pixelError,
                           .fieldOfView = options->fieldOfView,
                           .height = options->screenHeight,
                           .width = options->screenWidth > 0 ? options->screenWidth : 0};
    if (options->generate.tolerance.value >= 0.0) {
        ladder->coarseTolerance = options->generate.tolerance;
    }
    return status;
}
