// SPDX-License-Identifier: MIT
// paravent-bench quality: every method on every model, judged over the same views and quads.
#include "bench.h"

#include <paravent/io.h>

#define FIELD(kindName, field) .kind = (kindName), .offset = offsetof(pvtQualityLine, field)

static const pvtOption samplingTable[] = {
    {.name = "views",
     FIELD(PVT_OPTION_INT, views),
     .placeholder = "N",
     .least = 1,
     .most = 65536,
     .help = "as of paravent evaluate"},
    {.name = "quads",
     FIELD(PVT_OPTION_INT, quads),
     .placeholder = "N",
     .least = 1,
     .most = 10000000,
     .help = "as of paravent evaluate"},
    {.name = "pixels",
     FIELD(PVT_OPTION_INT, pixels),
     .placeholder = "N",
     .least = 16,
     .most = 4096,
     .help = "as of paravent evaluate"},
    {.name = "seed",
     FIELD(PVT_OPTION_COUNT, seed),
     .placeholder = "S",
     .most = 0x1p53 - 1,
     .help = "as of paravent evaluate"},
};

static const pvtOptionGroup groups[] = {
    {"Occluders", pvtBenchOptionTable, PVT_BENCH_OPTION_COUNT},
    {"What counts as inside", pvtSolidOptionTable, PVT_SOLID_OPTION_COUNT},
    {"Sampling", samplingTable, sizeof samplingTable / sizeof *samplingTable},
    {"General", pvtCommonOptionTable, PVT_COMMON_OPTION_COUNT},
};

static const pvtSyntax syntax = {
    .program = "paravent-bench",
    .name = "quality",
    .summary = "compare occluders by several methods, on the same budget",
    .operands = "MODEL...",
    .leastOperands = 1,
    .mostOperands = PVT_MOST_MODELS,
    .operandHelp = "models to make occluders for",
    .groups = groups,
    .groupCount = sizeof groups / sizeof *groups,
};

static pvtQualityLine GetDefaultLine(void)
{
    const pvtEvaluateOptions evaluate = pvtDefaultEvaluateOptions();
    return (pvtQualityLine){.bench = pvtDefaultGenerateOptions(),
                            .views = evaluate.views,
                            .quads = evaluate.quads,
                            .pixels = evaluate.pixels,
                            .seed = evaluate.seed};
}

// What the methods made of one model.
typedef struct Contest {
    pvtMesh occluders[PVT_BENCH_METHOD_COUNT];
    double seconds[PVT_BENCH_METHOD_COUNT];
} Contest;

// The voxel mesh is the last, and has no budget.
static bool IsOverBudget(const pvtQualityLine* line, size_t method, size_t triangles)
{
    return method + 1 < PVT_BENCH_METHOD_COUNT && triangles > (size_t)line->bench.budget;
}

static void PrintContest(const pvtQualityLine* line, const char* path,
                         const pvtEvaluation* evaluation, const Contest* contest)
{
    bool isAnyOver = false;
    char count[32];
    printf("\n%s, %s triangles\n", pvtGetFileName(path),
           pvtFormatCount(evaluation->originalTriangleCount, count));
    printf("%-21s %9s  %9s %9s  %9s %9s  %8s  %7s\n", "method", "triangles", "precision", "recall",
           "precision", "recall", "coverage", "seconds");
    for (size_t i = 0; i < evaluation->count; ++i) {
        const pvtOccluderScore* score = &evaluation->occluders[i];
        const bool isOver = IsOverBudget(line, i, score->triangleCount);
        isAnyOver = isAnyOver || isOver;
        printf("%-21s %9s%c %9.5f %9.4f  %9.5f %9.4f  %8.4f  %7.2f\n", pvtBenchMethods[i].name,
               pvtFormatCount(score->triangleCount, count), isOver ? '!' : ' ',
               score->uniform.precision, score->uniform.recall, score->small.precision,
               score->small.recall, score->coverage, contest->seconds[i]);
    }
    if (isAnyOver) {
        puts("! the method does not reach the budget on this model");
    }
    fflush(stdout);
}

static pvtStatus MakeOccluders(pvtRun* run, const pvtQualityLine* line, const pvtMesh* model,
                               Contest* contest)
{
    for (size_t i = 0; i < PVT_BENCH_METHOD_COUNT; ++i) {
        const double began = pvtGetClock();
        const pvtStatus status =
            pvtBenchMethods[i].make(run, &line->bench, model, &contest->occluders[i]);
        contest->seconds[i] = pvtGetClock() - began;
        if (status == PVT_NOTHING_INSIDE) {
            pvtReport_Warn(&run->report, "%s: %s", pvtBenchMethods[i].name,
                           pvtContext_GetMessage(run->context));
        } else if (status != PVT_OK) {
            return status;
        }
    }
    return PVT_OK;
}

static pvtStatus JudgeModel(pvtRun* run, const pvtQualityLine* line, const char* path,
                            const pvtMesh* model, Contest* contest)
{
    pvtStatus status = MakeOccluders(run, line, model, contest);
    if (status != PVT_OK) {
        return status;
    }
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = line->views;
    options.quads = line->quads;
    options.pixels = line->pixels;
    options.seed = line->seed;
    pvtEvaluation evaluation;
    status = pvtEvaluateOccluders(run->context, &options, model, contest->occluders,
                                  PVT_BENCH_METHOD_COUNT, &evaluation);
    if (status == PVT_OK) {
        pvtReport_ClearBar(&run->report);
        PrintContest(line, path, &evaluation, contest);
    }
    pvtEvaluation_Free(run->context, &evaluation);
    return status;
}

static pvtStatus RunModel(pvtRun* run, const pvtQualityLine* line, const char* path)
{
    const pvtLoadOptions options = pvtDefaultLoadOptions();
    pvtModel model;
    pvtStatus status = pvtLoadModel(run->context, &options, path, &model);
    if (status != PVT_OK) {
        return status;
    }
    Contest contest = {0};
    status = JudgeModel(run, line, path, &model.mesh, &contest);
    for (size_t i = 0; i < PVT_BENCH_METHOD_COUNT; ++i) {
        pvtMesh_Free(run->context, &contest.occluders[i]);
    }
    pvtModel_Free(run->context, &model);
    return status;
}

static int RunLine(void* values, const pvtParsedLine* line)
{
    pvtQualityLine* quality = values;
    pvtRun run;
    pvtStatus status = pvtBeginRun(&quality->bench.common, &run);
    if (status == PVT_OK) {
        printf("budget %d triangles; %d views; first uniform quads, then small ones\n",
               quality->bench.budget, quality->views);
    }
    for (int i = 0; i < line->operandCount && status == PVT_OK; ++i) {
        status = RunModel(&run, quality, line->operands[i]);
    }
    return pvtEndRun(&run, status);
}

static int RunQuality(int count, char* const* words)
{
    pvtQualityLine values = GetDefaultLine();
    return pvtRunCommandLine(&syntax, count, words, &values, RunLine);
}

const pvtCommand pvtQualityCommand = {&syntax, RunQuality};
