// SPDX-License-Identifier: MIT
// paravent evaluate: load, judge, draw, save, and print the table.
#include "evaluate.h"

#include "command.h"
#include "html_report.h"
#include "judgement.h"
#include "targets.h"

#include <paravent/io.h>
#include <stdlib.h>
#include <string.h>

// The files of a run, the original first, and what was found.
typedef struct Session {
    int fileCount;
    const char** paths;
    const char* names[1 + PVT_MOST_OCCLUDERS]; // for people
    pvtMesh meshes[1 + PVT_MOST_OCCLUDERS];
    double* recalls; // room for the plot to sort them
    pvtEvaluation evaluation;
    pvtJudgement judgement;
    pvtImage sheet;
} Session;

static bool IsStdout(const char* path)
{
    return path != NULL && strcmp(path, "-") == 0;
}

static pvtStatus CheckFiles(pvtRun* run, const pvtEvaluateLine* line, const Session* session)
{
    pvtTarget targets[6 + PVT_MOST_OCCLUDERS];
    size_t count = 0;
    for (int i = 0; i < session->fileCount; ++i) {
        targets[count++] = (pvtTarget){NULL, session->paths[i], false};
    }
    targets[count++] = (pvtTarget){"--json", line->json, true};
    targets[count++] = (pvtTarget){"--csv", line->csv, true};
    targets[count++] = (pvtTarget){"--plot", line->plot, true};
    targets[count++] = (pvtTarget){"--silhouettes", line->silhouettes, false};
    targets[count++] = (pvtTarget){"--report", line->report, false};
    pvtStatus status = pvtCheckTargets(run, targets, count);
    if (status == PVT_OK) {
        status = pvtCheckPicture(run, "--silhouettes", line->silhouettes);
    }
    if (status == PVT_OK && line->silhouettes != NULL &&
        session->fileCount - 1 > PVT_MOST_IN_SHEET) {
        return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                           "--silhouettes shows at most %d occluders, and there are %d; name fewer",
                           PVT_MOST_IN_SHEET, session->fileCount - 1);
    }
    if (status == PVT_OK && line->plot != NULL && !IsStdout(line->plot) &&
        !pvtPathEndsIn(line->plot, ".svg")) {
        return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                           "--plot %s: a plot is written as .svg; give the name that ending",
                           line->plot);
    }
    return status;
}

// The file's name, or the whole path where two would look alike.
static void NameFiles(Session* session)
{
    for (int i = 0; i < session->fileCount; ++i) {
        session->names[i] = pvtGetFileName(session->paths[i]);
        for (int k = 0; k < session->fileCount; ++k) {
            if (k != i && strcmp(session->names[i], pvtGetFileName(session->paths[k])) == 0) {
                session->names[i] = session->paths[i];
            }
        }
    }
}

// Masked surfaces of the original are looked at as closely as half a pixel.
static pvtLoadOptions GetLoadOptions(const pvtEvaluateLine* line, int file)
{
    pvtLoadOptions options = pvtDefaultLoadOptions();
    options.maskedResolution = 2 * line->pixels;
    options.masked = file == 0 ? (pvtMasked)line->masked : PVT_MASKED_AUTO;
    return options;
}

static pvtStatus Load(pvtRun* run, const pvtEvaluateLine* line, Session* session)
{
    pvtStatus status = PVT_OK;
    for (int i = 0; i < session->fileCount && status == PVT_OK; ++i) {
        pvtModel model;
        const pvtLoadOptions options = GetLoadOptions(line, i);
        status = pvtLoadModel(run->context, &options, session->paths[i], &model);
        if (status == PVT_OK) {
            // Only the triangles are kept.
            session->meshes[i] = model.mesh;
            model.mesh = (pvtMesh){0};
            pvtModel_Free(run->context, &model);
        }
    }
    return status;
}

static pvtStatus Judge(pvtRun* run, const pvtEvaluateLine* line, Session* session)
{
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = line->views;
    options.quads = line->quads;
    options.pixels = line->pixels;
    options.seed = line->seed;
    session->recalls = calloc((size_t)line->views, sizeof *session->recalls);
    if (session->recalls == NULL) {
        return pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory");
    }
    session->judgement = (pvtJudgement){
        .evaluation = &session->evaluation,
        .original = session->paths[0],
        .occluders = session->paths + 1,
        .originalName = session->names[0],
        .names = session->names + 1,
        .recalls = session->recalls,
    };
    pvtStatus status =
        pvtEvaluateOccluders(run->context, &options, &session->meshes[0], session->meshes + 1,
                             (size_t)session->fileCount - 1, &session->evaluation);
    if (status == PVT_LIMIT) {
        pvtRun_AddToMessage(run, "; fewer --pixels or --threads need less");
    }
    if (status == PVT_OK && line->silhouettes != NULL) {
        status = pvtMakeContactSheet(run->context, &session->judgement, session->meshes,
                                     &session->sheet);
    }
    return status == PVT_OK ? pvtRun_CheckCancelled(run) : status;
}

typedef void WriterFcn(pvtOutput* output, const pvtJudgement* judgement);

static pvtStatus Write(pvtRun* run, const char* path, WriterFcn* writer, const Session* session)
{
    pvtOutput* output = NULL;
    const pvtStatus status = pvtOpenOutput(run->context, path, &output);
    if (status != PVT_OK) {
        return status;
    }
    writer(output, &session->judgement);
    return pvtCommitOutput(output);
}

static pvtStatus SaveSilhouettes(pvtRun* run, const char* path, const Session* session)
{
    return pvtSaveImage(run->context, path, &session->sheet);
}

static pvtStatus SavePlot(pvtRun* run, const char* path, const Session* session)
{
    return Write(run, path, pvtPlotRecall, session);
}

static pvtStatus SaveCsv(pvtRun* run, const char* path, const Session* session)
{
    return Write(run, path, pvtWriteScoresCsv, session);
}

static pvtStatus SaveJson(pvtRun* run, const char* path, const Session* session)
{
    return Write(run, path, pvtWriteScoresJson, session);
}

static pvtStatus SaveReport(pvtRun* run, const char* path, const Session* session)
{
    return pvtWriteReport(run, path, &session->judgement, session->meshes);
}

// Each file is whole or not there; when a later one fails, the message says which are there.
static pvtStatus Save(pvtRun* run, const pvtEvaluateLine* line, const Session* session)
{
    const struct {
        const char* path;
        pvtStatus (*save)(pvtRun* run, const char* path, const Session* session);
    } files[] = {{line->silhouettes, SaveSilhouettes},
                 {line->report, SaveReport},
                 {line->plot, SavePlot},
                 {line->csv, SaveCsv},
                 {line->json, SaveJson}};
    for (size_t i = 0; i < sizeof files / sizeof *files; ++i) {
        const pvtStatus status =
            files[i].path != NULL ? files[i].save(run, files[i].path, session) : PVT_OK;
        for (size_t k = 0; k < i && status != PVT_OK; ++k) {
            if (files[k].path != NULL) {
                pvtRun_AddToMessage(run, "; %s was written", files[k].path);
            }
        }
        if (status != PVT_OK) {
            return status;
        }
    }
    return PVT_OK;
}

static pvtStatus PrintTable(pvtRun* run, const pvtEvaluateLine* line, const Session* session)
{
    if (line->common.quiet || IsStdout(line->json) || IsStdout(line->csv) || IsStdout(line->plot)) {
        return PVT_OK;
    }
    pvtReport_ClearBar(&run->report);
    pvtPrintScores(stdout, &session->judgement);
    if (fflush(stdout) != 0) {
        return pvtRun_Fail(run, PVT_OUTPUT_FAILED, "the standard output cannot be written");
    }
    return PVT_OK;
}

static pvtStatus Evaluate(pvtRun* run, const pvtEvaluateLine* line, Session* session)
{
    NameFiles(session);
    pvtStatus status = CheckFiles(run, line, session);
    if (status == PVT_OK) {
        status = Load(run, line, session);
    }
    if (status == PVT_OK && line->report != NULL) {
        status = pvtCheckReport(run, session->meshes, (size_t)session->fileCount);
    }
    if (status == PVT_OK) {
        status = Judge(run, line, session);
    }
    if (status == PVT_OK) {
        status = Save(run, line, session);
    }
    return status == PVT_OK ? PrintTable(run, line, session) : status;
}

static void Release(pvtRun* run, Session* session)
{
    for (int i = 0; i < session->fileCount; ++i) {
        pvtMesh_Free(run->context, &session->meshes[i]);
    }
    pvtEvaluation_Free(run->context, &session->evaluation);
    pvtImage_Free(run->context, &session->sheet);
    free(session->recalls);
}

static int RunLine(void* values, const pvtParsedLine* line)
{
    pvtEvaluateLine* options = values;
    pvtRun run;
    Session session = {.fileCount = line->operandCount, .paths = line->operands};
    pvtStatus status = pvtBeginRun(&options->common, &run);
    if (status == PVT_OK) {
        status = Evaluate(&run, options, &session);
        Release(&run, &session);
    }
    return pvtEndRun(&run, status);
}

static int RunEvaluate(int count, char* const* words)
{
    pvtEvaluateLine values = pvtDefaultEvaluateLine();
    return pvtRunCommandLine(&pvtEvaluateSyntax, count, words, &values, RunLine);
}

const pvtCommand pvtEvaluateCommand = {&pvtEvaluateSyntax, RunEvaluate};
