// SPDX-License-Identifier: MIT
// The table on stdout: a row a measure, a column an occluder, in blocks that fit a terminal. No
// digit is printed that another seed would change altogether.
#include "judgement.h"
#include "report.h"

#include <math.h>
#include <string.h>

enum { LABEL_WIDTH = 26, CELL_WIDTH = 22, BLOCK = 4, MOST_DECIMALS = 4 };

// A measure of one occluder.
typedef struct Value {
    double value, error; // error 0: known exactly, or not known
} Value;

typedef struct Row {
    const char* label;
    Value (*get)(const pvtOccluderScore* score);
    bool isFraction; // shown in percent
    bool isLessBetter;
} Row;

static Value GetUniformPrecision(const pvtOccluderScore* score)
{
    return (Value){score->uniform.precision, score->uniform.precisionError};
}

static Value GetUniformRecall(const pvtOccluderScore* score)
{
    return (Value){score->uniform.recall, score->uniform.recallError};
}

static Value GetSmallPrecision(const pvtOccluderScore* score)
{
    return (Value){score->small.precision, score->small.precisionError};
}

static Value GetSmallRecall(const pvtOccluderScore* score)
{
    return (Value){score->small.recall, score->small.recallError};
}

static Value GetCoverage(const pvtOccluderScore* score)
{
    return (Value){score->coverage, score->coverageError};
}

static Value GetOverArea(const pvtOccluderScore* score)
{
    return (Value){score->overArea, 0.0};
}

static Value GetOverThickness(const pvtOccluderScore* score)
{
    return (Value){score->overThickness, 0.0};
}

static Value GetWorstRecall(const pvtOccluderScore* score)
{
    const pvtQuadScore* worst = &score->views[score->worstView].uniform;
    return (Value){worst->recall, worst->recallError};
}

static const Row ROWS[] = {
    {"uniform quads  precision", GetUniformPrecision, true, false},
    {"               recall", GetUniformRecall, true, false},
    {"small quads    precision", GetSmallPrecision, true, false},
    {"               recall", GetSmallRecall, true, false},
    {"coverage", GetCoverage, true, false},
    {"worst view's recall", GetWorstRecall, true, false},
    {"over-occluded  area", GetOverArea, false, true},
    {"               thickness", GetOverThickness, false, true},
};

// The first digit of the error is the last that is shown; nothing is rounded to a full hundred, or
// to nothing at all, that is not.
static int CountDecimals(Value percent)
{
    int decimals = 1;
    if (percent.error > 0.0) {
        decimals = -(int)floor(log10(percent.error));
    }
    const double rest = fmin(fabs(percent.value), fabs(100.0 - percent.value));
    if (rest > 0.0 && rest < 0.5) {
        const int shown = -(int)floor(log10(rest));
        decimals = shown > decimals ? shown : decimals;
    }
    return decimals < 0 ? 0 : decimals > MOST_DECIMALS ? MOST_DECIMALS : decimals;
}

static void FormatCell(const Row* row, Value value, char* text, size_t size)
{
    if (!row->isFraction) {
        (void)snprintf(text, size, "%.3g", value.value);
        return;
    }
    const Value percent = {100.0 * value.value, 100.0 * value.error};
    const bool isWhole = percent.value == 0.0 || percent.value == 100.0;
    if (percent.error == 0.0 && isWhole) {
        (void)snprintf(text, size, "%.0f %%", percent.value);
        return;
    }
    const int decimals = CountDecimals(percent);
    if (percent.error == 0.0) {
        (void)snprintf(text, size, "%.*f %%", decimals, percent.value);
    } else {
        (void)snprintf(text, size, "%.*f ±%.*f %%", decimals, percent.value, decimals,
                       percent.error);
    }
}

// Whether no other occluder does better by more than what is printed can tell.
static bool IsBest(const Row* row, const pvtEvaluation* evaluation, const char* cell)
{
    Value best = row->get(&evaluation->occluders[0]);
    for (size_t i = 1; i < evaluation->count; ++i) {
        const Value value = row->get(&evaluation->occluders[i]);
        const bool isBetter =
            row->isLessBetter ? value.value < best.value : value.value > best.value;
        best = isBetter ? value : best;
    }
    char text[64];
    FormatCell(row, best, text, sizeof text);
    return strcmp(text, cell) == 0;
}

static void PrintCell(FILE* file, const char* text, int width)
{
    const int rest = width - pvtCountTextColumns(text);
    fprintf(file, "%s%*s", text, rest > 0 ? rest : 0, "");
}

static void PrintRow(FILE* file, const Row* row, const pvtEvaluation* evaluation,
                     const size_t block[2])
{
    PrintCell(file, row->label, LABEL_WIDTH);
    for (size_t i = block[0]; i < block[1]; ++i) {
        char text[64];
        FormatCell(row, row->get(&evaluation->occluders[i]), text, sizeof text - 2);
        if (evaluation->count > 1 && IsBest(row, evaluation, text)) {
            strcat(text, " *");
        }
        PrintCell(file, text, i + 1 < block[1] ? CELL_WIDTH : 0);
    }
    fputc('\n', file);
}

static void PrintBlock(FILE* file, const pvtJudgement* judgement, const size_t block[2])
{
    const pvtEvaluation* evaluation = judgement->evaluation;
    char text[4 * CELL_WIDTH];
    fputc('\n', file);
    PrintCell(file, "", LABEL_WIDTH);
    for (size_t i = block[0]; i < block[1]; ++i) {
        pvtShortenName(judgement->names[i], CELL_WIDTH - 3, text, sizeof text);
        PrintCell(file, text, i + 1 < block[1] ? CELL_WIDTH : 0);
    }
    fputc('\n', file);
    PrintCell(file, "triangles", LABEL_WIDTH);
    for (size_t i = block[0]; i < block[1]; ++i) {
        pvtFormatCount(evaluation->occluders[i].triangleCount, text);
        PrintCell(file, text, i + 1 < block[1] ? CELL_WIDTH : 0);
    }
    fputc('\n', file);
    for (size_t r = 0; r < sizeof ROWS / sizeof *ROWS; ++r) {
        PrintRow(file, &ROWS[r], evaluation, block);
    }
}

void pvtPrintScores(FILE* file, const pvtJudgement* judgement)
{
    const pvtEvaluation* evaluation = judgement->evaluation;
    const pvtEvaluateOptions* options = &evaluation->options;
    char triangles[32], quads[32], name[256];
    pvtFormatCount(evaluation->originalTriangleCount, triangles);
    pvtFormatCount((uint64_t)options->quads, quads);
    pvtShortenName(judgement->originalName, 40, name, sizeof name);
    fprintf(
        file, "%s, %s triangles; %d views, %s quads of each kind a view, %d pixels, seed %llu\n",
        name, triangles, options->views, quads, options->pixels, (unsigned long long)options->seed);
    for (size_t first = 0; first < evaluation->count; first += BLOCK) {
        const size_t rest = evaluation->count - first;
        PrintBlock(file, judgement, (size_t[2]){first, first + (rest < BLOCK ? rest : BLOCK)});
    }
    fprintf(file,
            "\n± one standard error of the sampling, by %s. Areas and lengths in the model's "
            "units.\n",
            options->views > 1 ? "views and quads" : "quads");
    if (evaluation->count > 1) {
        fputs("* the best of the row, as far as the digits shown can tell.\n", file);
    }
}
