// SPDX-License-Identifier: MIT
// What `paravent generate` tells: the model's extras, the stats file, the summary.
#include "choices.h"
#include "generate.h"
#include "json.h"
#include "separate.h"
#include "stages.h"
#include "targets.h"
#include "values.h"

#include <paravent/output.h>
#include <string.h>

enum { NAME_SIZE = 256 };

void pvtListExtras(const pvtGenerateOptions* options, const pvtBuildStats* stats, int budget,
                   pvtExtra extras[PVT_OCCLUDER_EXTRA_COUNT])
{
    const pvtExtra all[PVT_OCCLUDER_EXTRA_COUNT] = {
        {"error_bound", stats->errorBound, NULL},
        {"surface_polygons", stats->surfacePanels, NULL},
        {"surface_deviation", stats->deviation, NULL},
        {"tolerance", stats->tolerance, NULL},
        {"smallest_hole", stats->smallestHole, NULL},
        {"resolution", stats->resolution, NULL},
        {"voxel_size", stats->voxelSize, NULL},
        {"budget", budget, NULL},
        {"measure", stats->measure, NULL},
        {"measure_of_solid", stats->measureOfSolid, NULL},
        {"outside", (double)stats->outside, NULL},
        {"method", 0.0, pvtMethodChoices[options->method]},
        {"effort", 0.0, pvtEffortChoices[options->effort]},
        {"seed", (double)options->seed, NULL},
    };
    memcpy(extras, all, sizeof all);
}

pvtStatus pvtSaveOccluder(pvtRun* run, const pvtGenerateOptions* options,
                          const pvtGenerated* generated)
{
    if (options->separate) {
        return pvtSaveSeparately(run, options, generated);
    }
    char stem[NAME_SIZE];
    char name[NAME_SIZE + 16];
    pvtGetStem(generated->input, stem, sizeof stem);
    pvtMakeNodeName(stem, options->convention, name, sizeof name);
    pvtExtra extras[PVT_OCCLUDER_EXTRA_COUNT];
    pvtListExtras(options, &generated->stats, options->budget, extras);
    const pvtSaveItem item = {name, &generated->occluder.mesh, extras, PVT_OCCLUDER_EXTRA_COUNT,
                              NULL};
    return pvtSaveModel(run->context, options->output, &item, 1);
}

static void WriteSeconds(pvtJson* json, const pvtGenerated* generated)
{
    pvtJson_BeginObject(json, "seconds");
    pvtWriteStage(json, "load", generated->loaded - generated->prepared);
    pvtWriteStages(json, &generated->stats);
    pvtWriteStage(json, "preview", generated->previewed - generated->built);
    pvtWriteStage(json, "save", generated->saved - generated->previewed);
    pvtWriteStage(json, "total", generated->saved - generated->began);
    pvtJson_EndObject(json);
}

// Numbers as numbers, lengths and words as the line would take them, and null for what holds only
// when it is given.
static void WriteOption(pvtJson* json, const pvtOption* option, const void* field, bool isSet)
{
    char key[64];
    char text[64];
    (void)snprintf(key, sizeof key, "%s", option->name);
    for (char* dash = strchr(key, '-'); dash != NULL; dash = strchr(dash, '-')) {
        *dash = '_';
    }
    if (!isSet) {
        pvtJson_String(json, key, NULL);
    } else if (option->kind == PVT_OPTION_FLAG) {
        pvtJson_Bool(json, key, *(const bool*)field);
    } else if (option->kind == PVT_OPTION_INT) {
        pvtJson_Integer(json, key, *(const int*)field);
    } else if (option->kind == PVT_OPTION_COUNT || option->kind == PVT_OPTION_SIZE) {
        pvtJson_Integer(json, key, (int64_t) * (const uint64_t*)field);
    } else if (option->kind == PVT_OPTION_DOUBLE) {
        pvtJson_Number(json, key, *(const double*)field);
    } else if (option->kind == PVT_OPTION_TEXT) {
        pvtJson_String(json, key, *(const char* const*)field);
    } else {
        pvtPrintValue(option, field, text, sizeof text);
        pvtJson_String(json, key, text);
    }
}

// Whether the field says anything: −1 and 0 stand for "not given" where no value could be meant.
static bool IsSet(const pvtOption* option, const pvtGenerateOptions* options)
{
    if (strcmp(option->name, "error") == 0) {
        return options->error > 0.0;
    }
    if (strcmp(option->name, "deadline") == 0) {
        return options->deadline > 0.0;
    }
    if (strcmp(option->name, "resolution") == 0 && options->error > 0.0) {
        return false;
    }
    const void* field = (const char*)options + option->offset;
    switch (option->kind) {
    case PVT_OPTION_INT:
        return *(const int*)field >= 0;
    case PVT_OPTION_LENGTH:
        return ((const pvtLength*)field)->value >= 0.0;
    default:
        return true;
    }
}

void pvtWriteOptions(pvtJson* json, const pvtSyntax* syntax, const pvtGenerateOptions* options)
{
    static const char* const skipped[] = {"output", "stats",   "preview", "progress",
                                          "quiet",  "verbose", NULL};
    pvtJson_BeginObject(json, "options");
    for (size_t group = 0; group < syntax->groupCount; ++group) {
        for (size_t i = 0; i < syntax->groups[group].count; ++i) {
            const pvtOption* option = &syntax->groups[group].options[i];
            bool isSkipped = false;
            for (size_t j = 0; skipped[j] != NULL; ++j) {
                isSkipped = isSkipped || strcmp(option->name, skipped[j]) == 0;
            }
            if (!isSkipped) {
                WriteOption(json, option, (const char*)options + option->offset,
                            IsSet(option, options));
            }
        }
    }
    pvtJson_EndObject(json);
}

static void WriteStats(pvtJson* json, const pvtRun* run, const pvtGenerateOptions* options,
                       const pvtGenerated* generated)
{
    const pvtBuildStats* stats = &generated->stats;
    pvtJson_BeginObject(json, NULL);
    pvtJson_String(json, "version", pvtGetVersion());
    pvtJson_String(json, "input", generated->input);
    pvtJson_Integer(json, "triangles_in", (int64_t)generated->model.mesh.triangleCount);
    pvtJson_Integer(json, "triangles", (int64_t)generated->occluder.mesh.triangleCount);
    pvtJson_Integer(json, "polygons", (int64_t)generated->polygonCount);
    pvtJson_Integer(json, "resolution", stats->resolution);
    pvtJson_Number(json, "voxel_size", stats->voxelSize);
    pvtJson_Number(json, "error_bound", stats->errorBound);
    pvtJson_Integer(json, "surface_polygons", stats->surfacePanels);
    pvtJson_Number(json, "surface_deviation", stats->deviation);
    pvtJson_Number(json, "inside_fraction", stats->insideFraction);
    pvtJson_Number(json, "measure", stats->measure);
    pvtJson_Number(json, "measure_of_solid", stats->measureOfSolid);
    pvtJson_Integer(json, "candidates", (int64_t)stats->candidateCount);
    pvtJson_Integer(json, "outside", (int64_t)stats->outside);
    if (options->separate) {
        pvtWriteSeparate(json, generated);
    }
    WriteSeconds(json, generated);
    pvtJson_Integer(json, "peak_bytes", (int64_t)pvtRun_GetPeakBytes(run));
    pvtWriteOptions(json, &pvtGenerateSyntax, options);
    pvtJson_BeginArray(json, "warnings");
    for (size_t i = 0; i < run->report.warningCount; ++i) {
        pvtJson_String(json, NULL, run->report.warnings[i]);
    }
    pvtJson_EndArray(json);
    pvtJson_EndObject(json);
}

pvtStatus pvtSaveStats(pvtRun* run, const pvtGenerateOptions* options,
                       const pvtGenerated* generated)
{
    pvtOutput* output = NULL;
    const pvtStatus status = pvtOpenOutput(run->context, options->stats, &output);
    if (status != PVT_OK) {
        return status;
    }
    pvtJson json = pvtMakeJson(output);
    WriteStats(&json, run, options, generated);
    return pvtCommitOutput(output);
}

static void PrintSeconds(pvtRun* run, const pvtGenerated* generated)
{
    char stages[PVT_STAGES_TEXT_SIZE];
    pvtPrintStages(&generated->stats, stages);
    pvtReport_Detail(&run->report, "  seconds: load %.3f, %s, preview %.3f, save %.3f",
                     generated->loaded - generated->prepared, stages,
                     generated->previewed - generated->built,
                     generated->saved - generated->previewed);
}

static void PrintOccluder(pvtRun* run, const pvtGenerateOptions* options,
                          const pvtGenerated* generated)
{
    const size_t triangles = generated->occluder.mesh.triangleCount;
    const size_t polygons = generated->polygonCount;
    const size_t trianglesIn = generated->model.mesh.triangleCount;
    char in[32];
    char out[32];
    pvtReport_Say(&run->report, "%s: %s triangle%s in %zu polygon%s, made from %s triangle%s",
                  options->output, pvtFormatCount(triangles, out), triangles == 1 ? "" : "s",
                  polygons, polygons == 1 ? "" : "s", pvtFormatCount(trianglesIn, in),
                  trianglesIn == 1 ? "" : "s");
}

void pvtPrintSummary(pvtRun* run, const pvtGenerateOptions* options, const pvtGenerated* generated)
{
    const pvtBuildStats* stats = &generated->stats;
    if (options->separate) {
        pvtPrintSeparate(run, options, generated);
    } else {
        PrintOccluder(run, options, generated);
    }
    if (stats->measureOfSolid > 0.0) {
        pvtReport_Say(&run->report,
                      "  measure      %.1f %% of the solid's; evaluate tells precision and recall",
                      100.0 * stats->measure / stats->measureOfSolid);
    }
    pvtReport_Say(&run->report, "  error bound  %.4g (voxels of %.4g, %d along the longest side)",
                  stats->errorBound, stats->voxelSize, stats->resolution);
    if (stats->surfacePanels > 0) {
        pvtReport_Say(&run->report, "  on surface   %d of the polygons, within %.4g",
                      stats->surfacePanels, stats->deviation);
    }
    pvtReport_Say(&run->report, "  time         %.2f s", generated->saved - generated->began);
    PrintSeconds(run, generated);
}
