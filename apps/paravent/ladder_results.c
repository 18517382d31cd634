// SPDX-License-Identifier: MIT
// What `paravent ladder` tells: the model, the stats file, the table.
#include "choices.h"
#include "convention.h"
#include "ladder.h"
#include "stages.h"
#include "targets.h"

#include <string.h>

enum { NAME_SIZE = 256, EXTRA_COUNT = 18 };

// NAME_LOD0 of plain nodes; NAME_occluder, NAME_occluder_LOD1 and so on of those in a chain.
static void MakeName(const pvtLadderLine* options, const char* stem, size_t level,
                     char name[NAME_SIZE + 32])
{
    const bool isPlain = options->naming == PVT_NAMING_SUFFIX;
    const bool isGodot = options->generate.convention == PVT_CONVENTION_GODOT;
    char lod[16] = "";
    if (isPlain || level > 0) {
        (void)snprintf(lod, sizeof lod, "_LOD%zu", level);
    }
    const char* middle = isPlain || isGodot ? "" : "_occluder";
    (void)snprintf(name, NAME_SIZE + 32, "%s%s%s%s", stem, middle, lod, isGodot ? "-occonly" : "");
    if (isGodot) {
        pvtMakeNameHarmless(name);
    }
}

static void ListExtras(const pvtLadderLine* options, const pvtLevel* level, size_t index,
                       pvtExtra extras[EXTRA_COUNT])
{
    const pvtBuildStats* stats = &level->stats;
    const pvtExtra all[EXTRA_COUNT] = {
        {"level", (double)index, NULL},
        {"error_bound", stats->errorBound, NULL},
        {"distance", level->distance, NULL},
        {"screen_coverage", level->screenCoverage, NULL},
        {"tolerance", stats->tolerance, NULL},
        {"smallest_hole", stats->smallestHole, NULL},
        {"resolution", stats->resolution, NULL},
        {"voxel_size", stats->voxelSize, NULL},
        {"surface_polygons", stats->surfacePanels, NULL},
        {"surface_deviation", stats->deviation, NULL},
        {"budget", level->budget, NULL},
        {"measure", stats->measure, NULL},
        {"measure_of_solid", stats->measureOfSolid, NULL},
        {"outside", (double)stats->outside, NULL},
        {"pixel_error", options->pixelError, NULL},
        {"method", 0.0, pvtMethodChoices[options->generate.method]},
        {"effort", 0.0, pvtEffortChoices[options->generate.effort]},
        {"seed", (double)options->generate.seed, NULL},
    };
    memcpy(extras, all, sizeof all);
}

pvtStatus pvtSaveLadder(pvtRun* run, const pvtLadderLine* options, const pvtLadderResult* result)
{
    char names[PVT_MAX_LEVELS][NAME_SIZE + 32];
    pvtSaveItem items[PVT_MAX_LEVELS];
    pvtExtra extras[PVT_MAX_LEVELS][EXTRA_COUNT];
    double coverages[PVT_MAX_LEVELS] = {0};
    char stem[NAME_SIZE];
    pvtGetStem(result->input, stem, sizeof stem);
    const pvtLadder* ladder = &result->ladder;
    for (size_t i = 0; i < ladder->count; ++i) {
        const pvtLevel* level = &ladder->levels[i];
        MakeName(options, stem, i, names[i]);
        ListExtras(options, level, i, extras[i]);
        items[i] = (pvtSaveItem){.name = names[i],
                                 .mesh = &level->occluder.mesh,
                                 .extras = extras[i],
                                 .extraCount = EXTRA_COUNT};
        // Down to where the next may be used; the last for ever.
        coverages[i] = i + 1 < ladder->count ? level[1].screenCoverage : 0.0;
    }
    pvtOriginalParts original = {0};
    pvtStatus status = PVT_OK;
    const bool isGltf = options->withOriginal && pvtIsGltf(run->context, result->input);
    if (options->withOriginal && !isGltf) {
        status = pvtCutOriginal(run, &result->model, &original);
    }
    if (status == PVT_OK) {
        const pvtLevelSet set = {.levels = items,
                                 .levelCount = ladder->count,
                                 .coverages = options->naming == PVT_NAMING_MSFT ? coverages : NULL,
                                 .others = original.items,
                                 .otherCount = original.count,
                                 .original = isGltf ? result->input : NULL,
                                 .scene = options->generate.scene};
        status = pvtSaveLevels(run->context, options->generate.output, &set);
    }
    pvtOriginalParts_Free(run, &original);
    return status;
}

static void WriteLevelSeconds(pvtJson* json, const pvtBuildStats* stats)
{
    pvtJson_BeginObject(json, "seconds");
    pvtWriteStages(json, stats);
    pvtWriteStage(json, "total", stats->seconds.total);
    pvtJson_EndObject(json);
}

static void WriteLevel(pvtJson* json, const pvtLevel* level, size_t index)
{
    const pvtBuildStats* stats = &level->stats;
    pvtJson_BeginObject(json, NULL);
    pvtJson_Integer(json, "level", (int64_t)index);
    pvtJson_Number(json, "error_bound", stats->errorBound);
    pvtJson_Number(json, "distance", level->distance);
    pvtJson_Number(json, "screen_coverage", level->screenCoverage);
    pvtJson_Integer(json, "budget", level->budget);
    pvtJson_Integer(json, "triangles", (int64_t)level->occluder.mesh.triangleCount);
    pvtJson_Integer(json, "polygons", (int64_t)level->occluder.loops.loopCount);
    pvtJson_Integer(json, "resolution", stats->resolution);
    pvtJson_Number(json, "voxel_size", stats->voxelSize);
    pvtJson_Number(json, "tolerance", stats->tolerance);
    pvtJson_Number(json, "smallest_hole", stats->smallestHole);
    pvtJson_Number(json, "inside_fraction", stats->insideFraction);
    pvtJson_Number(json, "measure", stats->measure);
    pvtJson_Number(json, "measure_of_solid", stats->measureOfSolid);
    pvtJson_Integer(json, "candidates", (int64_t)stats->candidateCount);
    pvtJson_Integer(json, "outside", (int64_t)stats->outside);
    pvtJson_Integer(json, "surface_polygons", stats->surfacePanels);
    pvtJson_Number(json, "surface_deviation", stats->deviation);
    WriteLevelSeconds(json, stats);
    pvtJson_EndObject(json);
}

static void WriteSphere(pvtJson* json, const pvtLadder* ladder)
{
    pvtJson_BeginArray(json, "center");
    pvtJson_Number(json, NULL, ladder->center.x);
    pvtJson_Number(json, NULL, ladder->center.y);
    pvtJson_Number(json, NULL, ladder->center.z);
    pvtJson_EndArray(json);
    pvtJson_Number(json, "radius", ladder->radius);
}

static void WriteSeconds(pvtJson* json, const pvtLadderResult* result)
{
    pvtJson_BeginObject(json, "seconds");
    pvtWriteStage(json, "load", result->loaded - result->prepared);
    pvtWriteStage(json, "levels", result->built - result->loaded);
    pvtWriteStage(json, "preview", result->previewed - result->built);
    pvtWriteStage(json, "save", result->saved - result->previewed);
    pvtWriteStage(json, "total", result->saved - result->began);
    pvtJson_EndObject(json);
}

// The resolution counts only where no errors set the voxels' size.
static void WriteLine(pvtJson* json, const pvtLadderLine* options)
{
    pvtLadderLine line = *options;
    line.generate.resolution = options->errors != NULL ? -1 : options->generate.resolution;
    pvtWriteOptions(json, &pvtLadderSyntax, &line.generate);
}

static void WriteStats(pvtJson* json, const pvtRun* run, const pvtLadderLine* options,
                       const pvtLadderResult* result)
{
    pvtJson_BeginObject(json, NULL);
    pvtJson_String(json, "version", pvtGetVersion());
    pvtJson_String(json, "input", result->input);
    pvtJson_Integer(json, "triangles_in", (int64_t)result->model.mesh.triangleCount);
    WriteSphere(json, &result->ladder);
    pvtJson_BeginArray(json, "levels");
    for (size_t i = 0; i < result->ladder.count; ++i) {
        WriteLevel(json, &result->ladder.levels[i], i);
    }
    pvtJson_EndArray(json);
    WriteSeconds(json, result);
    pvtJson_Integer(json, "peak_bytes", (int64_t)pvtRun_GetPeakBytes(run));
    WriteLine(json, options);
    pvtJson_BeginArray(json, "warnings");
    for (size_t i = 0; i < run->report.warningCount; ++i) {
        pvtJson_String(json, NULL, run->report.warnings[i]);
    }
    pvtJson_EndArray(json);
    pvtJson_EndObject(json);
}

pvtStatus pvtSaveLadderStats(pvtRun* run, const pvtLadderLine* options,
                             const pvtLadderResult* result)
{
    pvtOutput* output = NULL;
    const pvtStatus status = pvtOpenOutput(run->context, options->generate.stats, &output);
    if (status != PVT_OK) {
        return status;
    }
    pvtJson json = pvtMakeJson(output);
    WriteStats(&json, run, options, result);
    return pvtCommitOutput(output);
}

static double GetPercentage(double part, double whole)
{
    return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

void pvtPrintLadder(pvtRun* run, const pvtLadderLine* options, const pvtLadderResult* result)
{
    const pvtLadder* ladder = &result->ladder;
    const size_t trianglesIn = result->model.mesh.triangleCount;
    char in[32];
    pvtReport_Say(&run->report, "%s: %zu level%s, made from %s triangle%s",
                  options->generate.output, ladder->count, ladder->count == 1 ? "" : "s",
                  pvtFormatCount(trianglesIn, in), trianglesIn == 1 ? "" : "s");
    pvtReport_Say(&run->report, "        triangles  error bound  voxels  of solid  of LOD0  "
                                "from distance  coverage");
    const double finest = ladder->levels[0].stats.measure;
    for (size_t i = 0; i < ladder->count; ++i) {
        const pvtLevel* level = &ladder->levels[i];
        const pvtBuildStats* stats = &level->stats;
        pvtReport_Say(
            &run->report, "  LOD%zu  %9zu  %11.4g  %6d  %6.1f %%  %5.0f %%  %13.4g  %7.4f %%", i,
            level->occluder.mesh.triangleCount, stats->errorBound, stats->resolution,
            GetPercentage(stats->measure, stats->measureOfSolid),
            GetPercentage(stats->measure, finest), level->distance, 100.0 * level->screenCoverage);
    }
    pvtReport_Say(&run->report, "  time         %.2f s", result->saved - result->began);
}
