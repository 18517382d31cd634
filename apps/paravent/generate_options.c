// SPDX-License-Identifier: MIT
// The line of `paravent generate` as a table.
#include "choices.h"
#include "generate.h"

#include <math.h>
#include <string.h>

static const char* const slicerChoices[] = {"auto", "sample", "egl", "osmesa", NULL};

#define FIELD(kindName, field) .kind = (kindName), .offset = offsetof(pvtGenerateOptions, field)

static const pvtOption outputTable[] = {
    {.name = "output",
     .letter = 'o',
     .isRequired = true,
     FIELD(PVT_OPTION_TEXT, output),
     .placeholder = "FILE",
     .defaultText = "",
     .help =
         "where the occluder goes: .glb, .gltf, .obj, .ply, or .tscn (a scene of Godot 4) by the "
         "name's ending"},
    {.name = "stats",
     FIELD(PVT_OPTION_TEXT, stats),
     .placeholder = "FILE",
     .defaultText = "",
     .help = "numbers about the run as JSON; - is the standard output"},
    {.name = "preview",
     FIELD(PVT_OPTION_TEXT, preview),
     .placeholder = "FILE.png",
     .defaultText = "",
     .help = "a picture of six views, the original with the occluder over it"},
    {.name = "convention",
     FIELD(PVT_OPTION_CHOICE, convention),
     .choices = pvtConventionChoices,
     .help = "the occluder's node is called NAME_occluder, or NAME-occonly as Godot's import "
             "wants it; NAME is the input file's, or with --separate the node's"},
};

static const pvtOption occluderTable[] = {
    {.name = "budget",
     FIELD(PVT_OPTION_INT, budget),
     .placeholder = "N",
     .least = 1,
     .most = 65535,
     .help =
         "most triangles in the occluder; with --separate in all of them, each counted as "
         "often as its mesh is instanced, and unless it is given 16 a mesh node with an inside"},
    {.name = "separate",
     FIELD(PVT_OPTION_FLAG, separate),
     .help = "an occluder for each mesh node instead of one for all, named after it; nodes of one "
             "mesh share it. They share the budget by what each could hide, and --resolution is "
             "along each mesh's own longest side"},
    {.name = "resolution",
     FIELD(PVT_OPTION_INT, resolution),
     .placeholder = "N",
     .least = 8,
     .most = 2048,
     .help = "voxels along the longest side; finer follows the shape better and takes longer"},
    {.name = "error",
     FIELD(PVT_OPTION_DOUBLE, error),
     .placeholder = "E",
     .most = INFINITY,
     .isLeastExcluded = true,
     .defaultText = "",
     .help = "instead of --resolution: the largest error in world units, which sets the voxels' "
             "size"},
    {.name = "tolerance",
     FIELD(PVT_OPTION_LENGTH, tolerance),
     .placeholder = "T",
     .most = INFINITY,
     .help = "how far a polygon may leave the strict interior; 0 hides nothing that can be seen, "
             "1vx is the paper's way"},
    {.name = "deadline",
     FIELD(PVT_OPTION_DOUBLE, deadline),
     .placeholder = "S",
     .most = INFINITY,
     .isLeastExcluded = true,
     .defaultText = "",
     .help =
         "seconds after which the best occluder so far is taken; the result then depends on the "
         "machine"},
};

const pvtOption pvtOptimizerOptionTable[] = {
    {.name = "method",
     FIELD(PVT_OPTION_CHOICE, method),
     .choices = pvtMethodChoices,
     .help = "how polygons are chosen: by gain per triangle, or as in the paper"},
    {.name = "effort",
     FIELD(PVT_OPTION_CHOICE, effort),
     .choices = pvtEffortChoices,
     .help = "how long to go on improving the occluder; nothing to the paper's way"},
    {.name = "views",
     FIELD(PVT_OPTION_TEXT, views),
     .placeholder = "all|above|FILE",
     .help =
         "where the occluder is seen from: all sides, above only, or a file with a direction to "
         "look along and its weight a line (x y z weight; # begins a comment)"},
    {.name = "seed",
     FIELD(PVT_OPTION_COUNT, seed),
     .placeholder = "S",
     .most = 9007199254740991.0,
     .help = "another one may give another occluder, the same one always the same"},
};

const pvtOption pvtSolidOptionTable[] = {
    {.name = "smallest-hole",
     FIELD(PVT_OPTION_LENGTH, smallestHole),
     .placeholder = "D",
     .most = INFINITY,
     .help = "openings narrower than this count as closed"},
    {.name = "ground",
     FIELD(PVT_OPTION_FLAG, ground),
     .help = "the bottom counts as closed, for buildings without a floor"},
    {.name = "terrain",
     FIELD(PVT_OPTION_FLAG, terrain),
     .help = "all below the lowest surface is inside, for landscapes"},
    {.name = "up",
     FIELD(PVT_OPTION_CHOICE, up),
     .choices = pvtAxisChoices,
     .help = "the axis that points up, for --ground, --terrain and --views above"},
    {.name = "enclosed",
     FIELD(PVT_OPTION_INT, enclosed),
     .placeholder = "T",
     .least = 0,
     .most = 25,
     .defaultText = "off",
     .help = "a place from which at most T of 26 directions lead outside counts as inside; a guess "
             "that helps where walls stand but do not meet"},
};

const pvtOption pvtInputOptionTable[] = {
    {.name = "scene",
     FIELD(PVT_OPTION_INT, scene),
     .placeholder = "N",
     .least = 0,
     .most = 1000000,
     .defaultText = "the file's default scene",
     .help = "take this scene of a glTF file"},
    {.name = "node",
     FIELD(PVT_OPTION_TEXT, node),
     .placeholder = "NAME",
     .defaultText = "",
     .help = "take only this node and what is below it"},
    {.name = "masked",
     FIELD(PVT_OPTION_CHOICE, masked),
     .choices = pvtMaskedChoices,
     .help = "materials with an alpha mask: opaque where their texture is (left out, with a "
             "warning, where it cannot be read), opaque throughout, or left out"},
};

const pvtOption pvtSlicerOptionTable[] = {
    {.name = "slicer",
     FIELD(PVT_OPTION_CHOICE, slicer),
     .choices = slicerChoices,
     .help = "where slices are made: on the CPU (sample) or by OpenGL; auto is the CPU unless EGL "
             "offers graphics hardware"},
};

#define CHECK_COUNT(table, count)                                                                  \
    _Static_assert(sizeof(table) / sizeof *(table) == (count), "the counts in generate.h follow")

CHECK_COUNT(pvtOptimizerOptionTable, PVT_OPTIMIZER_OPTION_COUNT);
CHECK_COUNT(pvtSolidOptionTable, PVT_SOLID_OPTION_COUNT);
CHECK_COUNT(pvtInputOptionTable, PVT_INPUT_OPTION_COUNT);
CHECK_COUNT(pvtSlicerOptionTable, PVT_SLICER_OPTION_COUNT);

#define GROUP(title, table)                                                                        \
    {                                                                                              \
        title, table, sizeof(table) / sizeof *(table)                                              \
    }

static const pvtOptionGroup groups[] = {
    GROUP("Output", outputTable),
    GROUP("Occluder", occluderTable),
    GROUP("Optimizer", pvtOptimizerOptionTable),
    GROUP("What counts as inside", pvtSolidOptionTable),
    GROUP("Input", pvtInputOptionTable),
    GROUP("Work", pvtSlicerOptionTable),
    {"Common", pvtCommonOptionTable, PVT_COMMON_OPTION_COUNT},
};

const pvtSyntax pvtGenerateSyntax = {
    .name = "generate",
    .summary = "turn a mesh into a few polygons that hide what it hides",
    .operands = "INPUT -o OUTPUT",
    .leastOperands = 1,
    .mostOperands = 1,
    .operandHelp = "INPUT is a model: .glb, .gltf, .obj, .ply, .stl, .fbx or .dae.",
    .groups = groups,
    .groupCount = sizeof groups / sizeof *groups,
    .notes =
        "Lengths are in the input's world units; with the suffix vx they are in voxels.\n"
        "Examples:\n"
        "  paravent generate house.glb -o house_occluder.glb --ground --preview house.png\n"
        "  paravent generate bunny.glb -o bunny.ply --budget 53 --smallest-hole 6vx\n"
        "  paravent generate city.glb -o city_occluders.glb --separate --budget 4000\n"
        "Exit codes: 0 done, 1 wrong command line, 2 invalid input, 3 feature missing here, "
        "4 output cannot be written, 5 nothing to occlude with, 6 limit reached, 130 cancelled.",
};

pvtGenerateOptions pvtDefaultGenerateOptions(void)
{
    const pvtBuildOptions build = pvtDefaultBuildOptions();
    return (pvtGenerateOptions){
        .budget = build.budget,
        .resolution = build.resolution,
        .error = build.error,
        .deadline = build.deadline,
        .tolerance = build.tolerance,
        .smallestHole = build.smallestHole,
        .up = (int)build.up,
        .enclosed = build.enclosed,
        .method = (int)build.method,
        .effort = (int)build.effort,
        .views = "all",
        .slicer = PVT_SLICER_AUTO,
        .seed = build.seed,
        .scene = -1,
        .masked = PVT_MASKED_AUTO,
        .convention = PVT_CONVENTION_PLAIN,
    };
}

pvtBuildOptions pvtGetBuildOptions(const pvtGenerateOptions* options, const pvtViewList* views)
{
    pvtBuildOptions build = pvtDefaultBuildOptions();
    build.budget = options->budget;
    build.resolution = options->resolution;
    build.error = options->error;
    build.deadline = options->deadline;
    build.tolerance = options->tolerance;
    build.smallestHole = options->smallestHole;
    build.ground = options->ground;
    build.terrain = options->terrain;
    build.up = (pvtAxis)options->up;
    build.enclosed = options->enclosed;
    build.method = (pvtMethod)options->method;
    build.effort = (pvtEffort)options->effort;
    build.views.aboveOnly = strcmp(options->views, "above") == 0;
    build.views.list = views->directions;
    build.views.listCount = views->count;
    build.seed = options->seed;
    return build;
}
