// SPDX-License-Identifier: MIT
// Occlusion accuracy after Ari Silvennoinen, Hannu Saransaari, Samuli Laine and Jaakko Lehtinen,
// "Occluder Simplification using Planar Sections" (Computer Graphics Forum 33, 2014), section 6.1.
// The paper leaves open how its quads are sized, so there are two families of them; coverage and
// over-occlusion are added, and so is what the numbers would vary by under another seed. Nothing
// here shares code with the builder of occluders but vectors, tasks and random numbers.
#include "base/context.h"
#include "view.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>

enum { MAX_VIEWS = 65536, MAX_QUADS = 10000000, MIN_PIXELS = 16, MAX_PIXELS = 4096 };

// What the workers share. Each takes the next view when it is done with one.
typedef struct EvaluateTask {
    pvtContext* context;
    pvtViewJob job;
    pvtViewScratch* scratches; // one a worker
    pvtViewResult* results;    // job.count a view
    atomic_int next, done;
    _Atomic pvtStatus status; // the first failure
} EvaluateTask;

pvtEvaluateOptions pvtDefaultEvaluateOptions(void)
{
    return (pvtEvaluateOptions){.views = 256, .quads = 32000, .pixels = 512, .seed = 1};
}

static pvtStatus CheckRange(pvtContext* context, const char* name, int value, const int range[2])
{
    if (value >= range[0] && value <= range[1]) {
        return PVT_OK;
    }
    return pvtFail(context, PVT_INVALID_ARGUMENT, "%s is %d; it must be %d to %d", name, value,
                   range[0], range[1]);
}

static pvtStatus CheckOptions(pvtContext* context, const pvtEvaluateOptions* options)
{
    pvtStatus status = CheckRange(context, "views", options->views, (int[]){1, MAX_VIEWS});
    if (status == PVT_OK) {
        status = CheckRange(context, "quads", options->quads, (int[]){1, MAX_QUADS});
    }
    if (status == PVT_OK) {
        status = CheckRange(context, "pixels", options->pixels, (int[]){MIN_PIXELS, MAX_PIXELS});
    }
    for (int v = 0; status == PVT_OK && options->directions != NULL && v < options->views; ++v) {
        status = pvtCheckDirection(context, (size_t)v, options->directions[v]);
    }
    return status;
}

static void RunViews(size_t begin, size_t end, int worker, void* taskData)
{
    (void)begin;
    (void)end;
    EvaluateTask* task = taskData;
    const int views = task->job.options->views;
    for (;;) {
        const int view = atomic_fetch_add(&task->next, 1);
        if (view >= views || atomic_load(&task->status) != PVT_OK) {
            return;
        }
        pvtStatus none = PVT_OK;
        const pvtStatus status =
            pvtJudgeView(task->context, &task->job, view, &task->scratches[worker],
                         task->results + (size_t)view * task->job.count);
        atomic_compare_exchange_strong(&task->status, &none, status);
        const int done = atomic_fetch_add(&task->done, 1) + 1;
        if (worker == 0) {
            pvtReportProgress(task->context, (double)done / views);
        }
    }
}

static pvtStatus RunTask(EvaluateTask* task)
{
    pvtContext* context = task->context;
    const int views = task->job.options->views;
    const int threads = pvtContext_GetThreadCount(context);
    const int workers = threads < views ? threads : views;
    task->scratches = pvtAllocate(context, (size_t)threads, sizeof *task->scratches);
    if (task->scratches == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtStatus status = PVT_OK;
    for (int i = 0; i < threads && status == PVT_OK; ++i) {
        status = pvtCreateViewScratch(context, &task->job, &task->scratches[i]);
    }
    if (status == PVT_OK) {
        pvtParallelFor(context, RunViews, (size_t)workers, 1, task);
        status = atomic_load(&task->status);
    }
    if (status == PVT_OK) {
        pvtReportProgress(context, 1.0); // the caller's thread may have had no view to tell of
    }
    for (int i = 0; i < threads; ++i) {
        pvtViewScratch_Free(context, &task->scratches[i]);
    }
    pvtRelease(context, task->scratches);
    return status;
}

// The standard error of a ratio of sums over independent views, hit / (hit + missed), to first
// order. It holds the quads' share too, since each view draws quads of its own.
static double GetViewError(const pvtOccluderScore* score, bool small, bool recall)
{
    const pvtQuadScore* sum = small ? &score->small : &score->uniform;
    const double all = (double)sum->hidden + (double)(recall ? sum->lost : sum->wrong);
    const double ratio = recall ? sum->recall : sum->precision;
    double spread = 0.0;
    for (size_t v = 0; v < score->viewCount; ++v) {
        const pvtQuadScore* part = small ? &score->views[v].small : &score->views[v].uniform;
        const double missed = (double)(recall ? part->lost : part->wrong);
        const double rest = (1.0 - ratio) * (double)part->hidden - ratio * missed;
        spread += rest * rest;
    }
    const double views = (double)score->viewCount;
    return all > 0.0 ? sqrt(spread * views / (views - 1.0)) / all : 0.0;
}

static void ScoreFamily(const EvaluateTask* task, size_t index, pvtQuadFamily family,
                        pvtOccluderScore* score)
{
    pvtQuadTally tally = {0};
    for (size_t v = 0; v < score->viewCount; ++v) {
        const pvtViewResult* result = &task->results[v * task->job.count + index];
        tally = pvtAddTallies(&tally, &result->tallies[family]);
    }
    const bool small = family == PVT_QUADS_SMALL;
    pvtQuadScore* sum = small ? &score->small : &score->uniform;
    *sum = pvtScoreTally(&tally);
    if (task->job.options->directions == NULL && score->viewCount > 1) {
        sum->precisionError = GetViewError(score, small, false);
        sum->recallError = GetViewError(score, small, true);
    }
}

static double GetCoverageError(const pvtOccluderScore* score)
{
    double spread = 0.0;
    for (size_t v = 0; v < score->viewCount; ++v) {
        const double rest = score->views[v].coverage - score->coverage;
        spread += rest * rest;
    }
    const double views = (double)score->viewCount;
    return sqrt(spread / (views * (views - 1.0)));
}

// `score` has its views' array.
static void ScoreOccluder(const EvaluateTask* task, size_t index, pvtOccluderScore* score)
{
    score->viewCount = (size_t)task->job.options->views;
    for (size_t v = 0; v < score->viewCount; ++v) {
        const pvtViewScore* view = &task->results[v * task->job.count + index].score;
        score->views[v] = *view;
        score->coverage += view->coverage;
        score->overArea += view->overArea;
        score->overThickness = fmax(score->overThickness, view->overThickness);
        if (view->uniform.recall < score->views[score->worstView].uniform.recall) {
            score->worstView = v;
        }
    }
    score->coverage /= (double)score->viewCount;
    score->overArea /= (double)score->viewCount;
    if (task->job.options->directions == NULL && score->viewCount > 1) {
        score->coverageError = GetCoverageError(score);
    }
    ScoreFamily(task, index, PVT_QUADS_UNIFORM, score);
    ScoreFamily(task, index, PVT_QUADS_SMALL, score);
}

static pvtStatus AllocateScores(pvtContext* context, const pvtMesh* occluders,
                                pvtEvaluation* evaluation)
{
    evaluation->occluders = pvtAllocate(context, evaluation->count, sizeof *evaluation->occluders);
    if (evaluation->occluders == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t i = 0; i < evaluation->count; ++i) {
        pvtOccluderScore* score = &evaluation->occluders[i];
        score->triangleCount = occluders[i].triangleCount;
        score->views =
            pvtAllocate(context, (size_t)evaluation->options.views, sizeof *score->views);
        if (score->views == NULL) {
            return pvtContext_GetStatus(context);
        }
    }
    return PVT_OK;
}

static pvtStatus Evaluate(pvtContext* context, const pvtViewJob* job, const pvtMesh* occluders,
                          pvtEvaluation* evaluation)
{
    EvaluateTask task = {.context = context, .job = *job};
    const size_t results = (size_t)job->options->views * job->count;
    task.results = pvtAllocate(context, results, sizeof *task.results);
    pvtStatus status = task.results == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    if (status == PVT_OK) {
        status = AllocateScores(context, occluders, evaluation);
    }
    if (status == PVT_OK) {
        status = RunTask(&task);
    }
    for (size_t i = 0; i < job->count && status == PVT_OK; ++i) {
        ScoreOccluder(&task, i, &evaluation->occluders[i]);
    }
    pvtRelease(context, task.results);
    return status;
}

static pvtStatus CreateOccluderSoups(pvtContext* context, const pvtMesh* occluders, size_t count,
                                     pvtSoup* soups)
{
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        char name[48];
        (void)snprintf(name, sizeof name, "occluder %zu", i + 1);
        status = pvtCreateSoup(context, name, &occluders[i], &soups[i]);
    }
    return status;
}

pvtStatus pvtEvaluateOccluders(pvtContext* context, const pvtEvaluateOptions* options,
                               const pvtMesh* original, const pvtMesh* occluders, size_t count,
                               pvtEvaluation* evaluation)
{
    *evaluation = (pvtEvaluation){0};
    pvtStatus status = CheckOptions(context, options);
    if (status == PVT_OK && original->triangleCount == 0) {
        status = pvtFail(context, PVT_INVALID_INPUT,
                         "the original has no triangles: there is nothing to compare with");
    }
    if (status != PVT_OK) {
        return status;
    }
    pvtBeginStage(context, "evaluate");
    evaluation->options = *options;
    evaluation->options.directions = NULL;
    evaluation->originalTriangleCount = original->triangleCount;
    evaluation->count = count;

    pvtSoup soup = {0};
    pvtSoup* soups = pvtAllocate(context, count, sizeof *soups);
    status = soups == NULL ? pvtContext_GetStatus(context)
                           : pvtCreateSoup(context, "the original", original, &soup);
    if (status == PVT_OK) {
        status = CreateOccluderSoups(context, occluders, count, soups);
    }
    if (status == PVT_OK) {
        const pvtViewJob job = {options, &soup, soups, count};
        status = Evaluate(context, &job, occluders, evaluation);
    }
    for (size_t i = 0; soups != NULL && i < count; ++i) {
        pvtSoup_Free(context, &soups[i]);
    }
    pvtRelease(context, soups);
    pvtSoup_Free(context, &soup);
    if (status != PVT_OK) {
        pvtEvaluation_Free(context, evaluation);
    }
    return status;
}

void pvtEvaluation_Free(pvtContext* context, pvtEvaluation* evaluation)
{
    for (size_t i = 0; evaluation->occluders != NULL && i < evaluation->count; ++i) {
        pvtRelease(context, evaluation->occluders[i].views);
    }
    pvtRelease(context, evaluation->occluders);
    *evaluation = (pvtEvaluation){0};
}
