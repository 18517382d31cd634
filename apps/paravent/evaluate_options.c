// SPDX-License-Identifier: MIT
// The line of `paravent evaluate` as a table, and what its numbers mean.
#include "choices.h"
#include "evaluate.h"

#include <paravent/evaluate.h>

#define FIELD(kindName, field) .kind = (kindName), .offset = offsetof(pvtEvaluateLine, field)

static const pvtOption inputTable[] = {
    {.name = "masked",
     FIELD(PVT_OPTION_CHOICE, masked),
     .choices = pvtMaskedChoices,
     .help = "ORIGINAL's materials with an alpha mask: opaque where their texture is (left out, "
             "with a warning, where it cannot be read), opaque throughout, or left out"},
};

static const pvtOption samplingTable[] = {
    {.name = "views",
     FIELD(PVT_OPTION_INT, views),
     .placeholder = "N",
     .least = 1,
     .most = 65536,
     .help = "random directions to look from"},
    {.name = "quads",
     FIELD(PVT_OPTION_INT, quads),
     .placeholder = "N",
     .least = 1,
     .most = 10000000,
     .help = "random quads a view, of each of the two kinds"},
    {.name = "pixels",
     FIELD(PVT_OPTION_INT, pixels),
     .placeholder = "N",
     .least = 16,
     .most = 4096,
     .help = "along the longer side of the original's box on the screen"},
    {.name = "seed",
     FIELD(PVT_OPTION_COUNT, seed),
     .placeholder = "S",
     .most = 0x1p53 - 1,
     .help = "of the random numbers: the same seed gives the same bytes"},
};

static const pvtOption outputTable[] = {
    {.name = "json",
     FIELD(PVT_OPTION_TEXT, json),
     .placeholder = "FILE",
     .defaultText = "",
     .help = "all numbers, those of each view too; - is the standard output"},
    {.name = "csv",
     FIELD(PVT_OPTION_TEXT, csv),
     .placeholder = "FILE",
     .defaultText = "",
     .help = "a line a view and occluder; - is the standard output"},
    {.name = "silhouettes",
     FIELD(PVT_OPTION_TEXT, silhouettes),
     .placeholder = "FILE.png",
     .defaultText = "",
     .help = "twelve views, the worst among them: original black, both yellow, over-occlusion "
             "blue"},
    {.name = "plot",
     FIELD(PVT_OPTION_TEXT, plot),
     .placeholder = "FILE.svg",
     .defaultText = "",
     .help = "how the recall is spread over the views, a curve an occluder; - is the standard "
             "output"},
    {.name = "report",
     FIELD(PVT_OPTION_TEXT, report),
     .placeholder = "FILE.html",
     .defaultText = "",
     .help = "one page with everything in it: the model in 3-D with the occluder over it, views, "
             "plot and numbers; opens without a network"},
};

static const pvtOptionGroup groups[] = {
    {"Input", inputTable, sizeof inputTable / sizeof *inputTable},
    {"Sampling", samplingTable, sizeof samplingTable / sizeof *samplingTable},
    {"Output", outputTable, sizeof outputTable / sizeof *outputTable},
    {"General", pvtCommonOptionTable, PVT_COMMON_OPTION_COUNT},
};

static const char notes[] =
    "What the numbers mean:\n"
    "\n"
    "Views are orthographic, their directions uniform on the sphere, without roll. A pixel is "
    "covered by a mesh when its centre lies in a triangle of it, seen from either side; a centre "
    "on an edge belongs to the triangle on its right, or below a level edge. Quads are "
    "axis-aligned "
    "on the screen, made of whole pixels, over the original's box: uniform quads have both corners "
    "anywhere in it, small ones have sides of up to an eighth of the box's. A mesh hides a quad "
    "when it covers all its pixels.\n"
    "\n"
    "  Nt  pixels of quads that original and occluder hide\n"
    "  Pf  pixels of quads that only the original hides: needless work\n"
    "  Nf  pixels beside the original, of quads that only the occluder hides: wrong pictures\n"
    "\n"
    "Precision is Nt/(Nt+Nf), recall is Nt/(Nt+Pf), 1 where there is no such quad; of all views by "
    "the summed counts. Coverage is the fraction of the original's pixels that the occluder "
    "covers, the mean over the views. Over-occluded are the pixels that the occluder covers alone: "
    "their area in world units, the mean over the views; their thickness is the largest distance "
    "of one of them from the original's silhouette, in world units, over all views. "
    "lib/PIPELINE.md "
    "has it all to the last detail.";

const pvtSyntax pvtEvaluateSyntax = {
    .name = "evaluate",
    .summary = "tell how good occluders are, in numbers and pictures",
    .operands = "ORIGINAL OCCLUDER...",
    .leastOperands = 2,
    .mostOperands = 1 + PVT_MOST_OCCLUDERS,
    .operandHelp =
        "ORIGINAL is the model, each OCCLUDER a file with what stands in for it, made by "
        "any program; several are compared over the same views and quads.",
    .groups = groups,
    .groupCount = sizeof groups / sizeof *groups,
    .notes = notes,
};

pvtEvaluateLine pvtDefaultEvaluateLine(void)
{
    const pvtEvaluateOptions defaults = pvtDefaultEvaluateOptions();
    return (pvtEvaluateLine){.views = defaults.views,
                             .quads = defaults.quads,
                             .pixels = defaults.pixels,
                             .seed = defaults.seed};
}
