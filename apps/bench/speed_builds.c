// SPDX-License-Identifier: MIT
// Whole builds: each stage of ours, and all of it against the paper's way.
#include "speed.h"

#include <paravent/evaluate.h>
#include <paravent/gl.h>
#include <paravent/io.h>
#include <string.h>

typedef struct TimedBuild {
    const char* path;
    pvtBuildOptions options;
    bool isOnOsmesa;
    bool isJudged; // its recall is wanted as well
    // What comes out. The status is of the build alone: OK, nothing inside, or unsupported.
    pvtStatus status;
    pvtBuildStats stats;
    size_t trianglesIn, trianglesOut, peakBytes;
    double recall; // of uniform quads
} TimedBuild;

static pvtStatus CreateSlicer(pvtContext* context, void* user, const pvtGridFrame* frame,
                              const pvtMesh* voxelMesh, pvtSlicer* slicer)
{
    return pvtCreateStencilSlicer(context, user, frame, voxelMesh, slicer);
}

static void ReleaseSlicer(pvtContext* context, void* user, pvtSlicer* slicer)
{
    (void)user;
    pvtReleaseStencilSlicer(context, slicer);
}

static pvtStatus Judge(pvtRun* run, TimedBuild* build, const pvtMesh* original,
                       const pvtMesh* occluder)
{
    const pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    pvtEvaluation evaluation;
    const pvtStatus status =
        pvtEvaluateOccluders(run->context, &options, original, occluder, 1, &evaluation);
    if (status == PVT_OK) {
        build->recall = evaluation.occluders[0].uniform.recall;
        pvtEvaluation_Free(run->context, &evaluation);
    }
    return status;
}

static pvtStatus Build(pvtRun* run, TimedBuild* build, const pvtMesh* mesh)
{
    pvtOccluder occluder;
    pvtStatus status =
        pvtBuildOccluder(run->context, &build->options, mesh, &occluder, &build->stats);
    build->status = status;
    build->trianglesIn = mesh->triangleCount;
    build->peakBytes = pvtContext_GetPeakBytes(run->context);
    if (status == PVT_OK) {
        build->trianglesOut = occluder.mesh.triangleCount;
        if (build->isJudged) {
            status = Judge(run, build, mesh, &occluder.mesh);
        }
        pvtOccluder_Free(run->context, &occluder);
    }
    return status == PVT_NOTHING_INSIDE ? PVT_OK : status;
}

static pvtStatus BuildOnBackend(pvtRun* run, TimedBuild* build, const pvtMesh* mesh)
{
    if (!build->isOnOsmesa) {
        return Build(run, build, mesh);
    }
    pvtGl* gl = NULL;
    pvtStatus status = pvtOpenGl(run->context, PVT_GL_OSMESA, &gl);
    if (status == PVT_UNSUPPORTED) {
        build->status = status;
        return PVT_OK;
    }
    if (status == PVT_OK) {
        build->options.createSlicer = CreateSlicer;
        build->options.releaseSlicer = ReleaseSlicer;
        build->options.slicerUser = gl;
        status = Build(run, build, mesh);
        pvtCloseGl(run->context, gl);
    }
    return status;
}

static int RunBuild(const pvtSpeedLine* line, TimedBuild* build)
{
    pvtRun run;
    pvtCommonOptions common = line->bench.common;
    pvtStatus status = pvtBeginRun(&common, &run);
    if (status == PVT_OK) {
        const pvtLoadOptions load = pvtDefaultLoadOptions();
        pvtModel model;
        status = pvtLoadModel(run.context, &load, build->path, &model);
        if (status == PVT_OK) {
            status = BuildOnBackend(&run, build, &model.mesh);
            pvtModel_Free(run.context, &model);
        }
        pvtReport_ClearBar(&run.report);
    }
    return pvtEndRun(&run, status);
}

static void PrintStages(const TimedBuild* build, const char* effort)
{
    const pvtBuildStats* stats = &build->stats;
    const double seconds[] = {stats->seconds.voxelize, stats->seconds.solid,
                              stats->seconds.sections, stats->seconds.chains,
                              stats->seconds.select,   stats->seconds.refine,
                              stats->seconds.check,    stats->seconds.total};
    enum { COUNT = sizeof seconds / sizeof *seconds };
    char in[32], out[32];
    printf("%-8s %9s %6s", effort, pvtFormatCount(build->trianglesIn, in),
           build->status == PVT_OK ? pvtFormatCount(build->trianglesOut, out) : "none");
    for (int i = 0; i < COUNT; ++i) {
        printf(" %8.3f", seconds[i]);
    }
    printf(" %8.1f\n", (double)build->peakBytes * 1e-6);
    printf("%-25s", "");
    for (int i = 0; i < COUNT; ++i) {
        printf(" %6.1f %%", stats->seconds.total > 0 ? 100 * seconds[i] / stats->seconds.total : 0);
    }
    putchar('\n');
    fflush(stdout);
}

static int PrintModel(const pvtSpeedLine* line, const char* path)
{
    static const struct {
        pvtEffort effort;
        const char* name;
    } efforts[] = {{PVT_EFFORT_FAST, "fast"}, {PVT_EFFORT_DEFAULT, "default"}};
    printf("\n%s, resolution %d, budget %d; seconds a stage and their share\n",
           pvtGetFileName(path), line->bench.resolution, line->bench.budget);
    printf("%-8s %9s %6s %8s %8s %8s %8s %8s %8s %8s %8s %8s\n", "effort", "triangles", "to",
           "voxelize", "solid", "sections", "chains", "select", "refine", "check", "total",
           "peak MB");
    int exitCode = PVT_EXIT_DONE;
    for (size_t i = 0; i < sizeof efforts / sizeof *efforts && exitCode == PVT_EXIT_DONE; ++i) {
        TimedBuild build = {.path = path,
                            .options = pvtGetBenchBuildOptions(&line->bench, PVT_METHOD_PLANAR)};
        build.options.effort = efforts[i].effort;
        exitCode = RunBuild(line, &build);
        if (exitCode == PVT_EXIT_DONE) {
            PrintStages(&build, efforts[i].name);
        }
    }
    return exitCode;
}

int pvtPrintBuildSpeeds(const pvtSpeedLine* line, const char* const* paths, int count)
{
    int exitCode = PVT_EXIT_DONE;
    for (int i = 0; i < count && exitCode == PVT_EXIT_DONE; ++i) {
        exitCode = PrintModel(line, paths[i]);
    }
    return exitCode;
}

enum { FAST, DEFAULT, PAPER, WAYS };

static int RunWays(const pvtSpeedLine* line, const char* path, TimedBuild builds[WAYS])
{
    int exitCode = PVT_EXIT_DONE;
    for (int i = 0; i < WAYS && exitCode == PVT_EXIT_DONE; ++i) {
        builds[i] =
            (TimedBuild){.path = path,
                         .options = pvtGetBenchBuildOptions(
                             &line->bench, i == PAPER ? PVT_METHOD_PAPER : PVT_METHOD_PLANAR),
                         .isOnOsmesa = i == PAPER,
                         .isJudged = true};
        builds[i].options.resolution = line->paperResolution;
        builds[i].options.effort = i == FAST ? PVT_EFFORT_FAST : PVT_EFFORT_DEFAULT;
        exitCode = RunBuild(line, &builds[i]);
    }
    return exitCode;
}

static void PrintWays(const char* path, const TimedBuild builds[WAYS])
{
    const double paper = builds[PAPER].stats.seconds.total;
    printf("%-32s", pvtGetFileName(path));
    for (int i = 0; i < WAYS; ++i) {
        if (builds[i].status == PVT_OK) {
            printf(" %8.3f %5.1f %%", builds[i].stats.seconds.total, 100.0 * builds[i].recall);
        } else {
            printf(" %16s", builds[i].status == PVT_UNSUPPORTED ? "not here" : "nothing inside");
        }
    }
    for (int i = 0; i < PAPER; ++i) {
        if (builds[i].status == PVT_OK && builds[PAPER].status == PVT_OK) {
            printf(" %9.2f", paper / builds[i].stats.seconds.total);
        } else {
            printf(" %9s", "-");
        }
    }
    putchar('\n');
    fflush(stdout);
}

int pvtPrintPaperSpeeds(const pvtSpeedLine* line, const char* const* paths, int count)
{
    printf("\nagainst the paper's way with slices by OSMesa; resolution %d, budget %d; total "
           "seconds, and recall\n",
           line->paperResolution, line->bench.budget);
    printf("%-32s %16s %16s %16s %9s %9s\n", "model", "fast", "default", "paper's", "p/fast",
           "p/default");
    int exitCode = PVT_EXIT_DONE;
    for (int i = 0; i < count && exitCode == PVT_EXIT_DONE; ++i) {
        TimedBuild builds[WAYS];
        exitCode = RunWays(line, paths[i], builds);
        if (exitCode == PVT_EXIT_DONE) {
            PrintWays(paths[i], builds);
        }
    }
    return exitCode;
}
