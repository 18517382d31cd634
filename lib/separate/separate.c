// SPDX-License-Identifier: MIT
// One occluder a mesh, as a list of steps. Being inside a solid does not depend on an affine
// transform, so that an occluder which is made in the space of its mesh keeps the promise wherever
// the mesh is instanced; only lengths grow, by the largest stretch of the transform at most.
#include <paravent/separate.h>

#include "base/context.h"
#include "crew.h"
#include "groups.h"
#include "occluder/steps.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    FEW = 8,
    AN_INSTANCE = 16,
    LEAST_BUDGET = 64,
    MAX_BUDGET = 65535,
    MAX_TOLD = 12, // warnings of one kind: the rest are counted
};

// A piece of work and about how long it takes.
typedef struct Job {
    size_t group;
    double cost;
} Job;

typedef struct Separate {
    pvtContext* context; // the caller's, that owns what comes out
    const pvtBuildOptions* options;
    const pvtInstanceSet* set;
    double started; // [s] on pvtGetSeconds' clock
    pvtGroupSet groups;
    pvtSeparation out;
    Job* jobs; // the long ones first, so that no thread is left with one at the end
    size_t jobCount;
    int crewSize;
    atomic_size_t begun;   // of the jobs
    atomic_size_t invalid; // meshes that cannot be used at all, such as a point
} Separate;

static int CompareJobs(const void* left, const void* right)
{
    const Job* a = left;
    const Job* b = right;
    if (a->cost != b->cost) {
        return a->cost > b->cost ? -1 : 1;
    }
    return a->group < b->group ? -1 : a->group > b->group ? 1 : 0;
}

static void SortJobs(Separate* separate)
{
    if (separate->jobCount > 0) {
        qsort(separate->jobs, separate->jobCount, sizeof *separate->jobs, CompareJobs);
    }
}

static void NameJob(size_t job, char* text, size_t size, void* user)
{
    const Separate* separate = user;
    const pvtGroup* group = &separate->groups.groups[separate->jobs[job].group];
    const char* name = separate->set->instances[group->firstInstance].name;
    const size_t others = group->instanceCount - 1;
    if (name == NULL) {
        (void)snprintf(text, size, "mesh %zu", group->source);
    } else if (others == 0) {
        (void)snprintf(text, size, "\"%.80s\"", name);
    } else {
        (void)snprintf(text, size, "\"%.80s\" and %zu more of its mesh", name, others);
    }
}

static pvtStatus GiveReason(const Separate* separate, const char* text,
                            pvtSeparateOccluder* occluder)
{
    pvtContext* context = separate->context;
    const size_t size = strlen(text) + 1;
    pvtRelease(context, occluder->reason);
    occluder->reason = pvtAllocate(context, size, 1);
    if (occluder->reason == NULL) {
        return pvtContext_GetStatus(context);
    }
    memcpy(occluder->reason, text, size);
    return PVT_OK;
}

// What everything that may be covered would hide, in the space of the build.
static pvtStatus MeasureSolid(pvtContext* context, const pvtBuildOptions* options,
                              const pvtMesh* mesh, pvtBuildStats* stats)
{
    pvtBuildOptions alone = *options;
    alone.budget = LEAST_BUDGET; // the share is what it is measured for
    pvtBuild build = {.options = &alone, .mesh = mesh, .started = pvtGetSeconds()};
    pvtViewOptions views = options->views;
    views.up = (int)options->up;
    pvtStatus status = pvtResolveSizes(context, &build);
    if (status == PVT_OK) {
        status = pvtVoxelizeStep(context, &build);
    }
    if (status == PVT_OK) {
        status = pvtFillStep(context, &build);
    }
    if (status == PVT_OK) {
        status = pvtSheetStep(context, &build);
    }
    if (status == PVT_OK) {
        status = pvtBandStep(context, &build);
    }
    if (status == PVT_OK) {
        status = pvtMakeViews(context, &views, &build.views);
    }
    if (status == PVT_OK) {
        status = pvtMeasureCeiling(context, &build);
    }
    pvtBuild_Free(context, &build);
    *stats = build.stats;
    return status;
}

static bool IsHollow(pvtStatus status)
{
    return status == PVT_NOTHING_INSIDE || status == PVT_INVALID_INPUT;
}

// One mesh without an inside is no reason to fail: it is told why, and the others go on.
static pvtStatus TakeHollow(Separate* separate, const pvtContext* context, pvtStatus status,
                            pvtSeparateOccluder* occluder)
{
    if (!IsHollow(status)) {
        return status;
    }
    if (status == PVT_INVALID_INPUT) {
        atomic_fetch_add(&separate->invalid, 1);
    }
    occluder->result = PVT_SEPARATE_HOLLOW;
    return GiveReason(separate, pvtContext_GetMessage(context), occluder);
}

static pvtStatus RunMeasure(pvtContext* context, size_t job, void* user)
{
    Separate* separate = user;
    const size_t index = separate->jobs[job].group;
    const pvtGroup* group = &separate->groups.groups[index];
    pvtSeparateOccluder* occluder = &separate->out.occluders[index];
    const pvtStatus status = MeasureSolid(context, &group->options,
                                          pvtGroup_GetMesh(group, separate->set), &occluder->stats);
    return TakeHollow(separate, context, status, occluder);
}

static pvtStatus RunJobs(Separate* separate, const char* stage, bool keepsWarnings,
                         pvtStatus (*run)(pvtContext* context, size_t job, void* user))
{
    const bool isAlone = separate->options->createSlicer != NULL; // a slicer has one thread
    const pvtCrewWork work = {.stage = stage,
                              .count = separate->jobCount,
                              .isAlone = isAlone,
                              .keepsWarnings = keepsWarnings,
                              .run = run,
                              .name = NameJob,
                              .user = separate};
    SortJobs(separate);
    atomic_store(&separate->begun, 0);
    separate->crewSize = pvtGetCrewSize(separate->context, work.count, isAlone);
    return pvtRunCrew(separate->context, &work);
}

static pvtStatus GroupStep(pvtContext* context, Separate* separate)
{
    pvtSeparation* out = &separate->out;
    pvtStatus status =
        pvtGroupInstances(context, separate->options, separate->set, &separate->groups);
    if (status != PVT_OK) {
        return status;
    }
    const size_t count = separate->groups.count;
    separate->jobs = pvtAllocate(context, count, sizeof *separate->jobs);
    out->occluders = pvtAllocate(context, count, sizeof *out->occluders);
    if (separate->jobs == NULL || out->occluders == NULL) {
        return pvtContext_GetStatus(context);
    }
    out->count = count;
    out->ofInstance = separate->groups.ofInstance;
    out->instanceCount = separate->set->instanceCount;
    separate->groups.ofInstance = NULL;
    for (size_t i = 0; i < count; ++i) {
        const pvtGroup* group = &separate->groups.groups[i];
        out->occluders[i] = (pvtSeparateOccluder){.source = group->source,
                                                  .firstInstance = group->firstInstance,
                                                  .instanceCount = group->instanceCount,
                                                  .scale = group->scale};
    }
    return PVT_OK;
}

static pvtStatus MeasureStep(pvtContext* context, Separate* separate)
{
    (void)context;
    separate->jobCount = separate->groups.count;
    for (size_t i = 0; i < separate->jobCount; ++i) {
        const pvtMesh* mesh = pvtGroup_GetMesh(&separate->groups.groups[i], separate->set);
        separate->jobs[i] = (Job){i, (double)mesh->triangleCount};
    }
    return RunJobs(separate, "measure", false, RunMeasure);
}

static int ChooseBudget(const Separate* separate)
{
    size_t instances = 0;
    for (size_t i = 0; i < separate->out.count; ++i) {
        const pvtSeparateOccluder* occluder = &separate->out.occluders[i];
        instances += occluder->result == PVT_SEPARATE_HOLLOW ? 0 : occluder->instanceCount;
    }
    const size_t wanted = instances < MAX_BUDGET ? AN_INSTANCE * instances : MAX_BUDGET;
    return wanted < LEAST_BUDGET ? LEAST_BUDGET : wanted > MAX_BUDGET ? MAX_BUDGET : (int)wanted;
}

static pvtStatus ShareStep(pvtContext* context, Separate* separate)
{
    const size_t count = separate->out.count;
    const int given = separate->options->budget;
    separate->out.budget = given > 0 ? given : ChooseBudget(separate);
    pvtClaim* claims = pvtAllocate(context, count, sizeof *claims);
    int* shares = pvtAllocate(context, count, sizeof *shares);
    pvtStatus status = claims == NULL || shares == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        const pvtSeparateOccluder* occluder = &separate->out.occluders[i];
        const double instances = (double)occluder->instanceCount;
        const double measure =
            occluder->result == PVT_SEPARATE_HOLLOW ? 0.0 : occluder->stats.measureOfSolid;
        claims[i] = (pvtClaim){measure * separate->groups.groups[i].volume / instances,
                               occluder->instanceCount};
    }
    if (status == PVT_OK) {
        status = pvtShareBudget(context, claims, count, separate->out.budget, shares);
    }
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        separate->out.occluders[i].budget = shares[i];
    }
    pvtRelease(context, claims);
    pvtRelease(context, shares);
    return status;
}

// Two triangles are what pvtShareBudget gives each instance first.
static double CountWanted(const Separate* separate)
{
    double wanted = 0.0;
    for (size_t i = 0; i < separate->out.count; ++i) {
        const pvtSeparateOccluder* occluder = &separate->out.occluders[i];
        wanted +=
            occluder->result == PVT_SEPARATE_HOLLOW ? 0.0 : 2.0 * (double)occluder->instanceCount;
    }
    return wanted;
}

static pvtStatus RefuseShare(const Separate* separate, pvtSeparateOccluder* occluder)
{
    char text[256];
    const double wanted = CountWanted(separate);
    const int used = snprintf(
        text, sizeof text, "the budget of %d triangles is used up before its %zu instance%s",
        separate->out.budget, occluder->instanceCount, occluder->instanceCount == 1 ? "" : "s");
    if (wanted <= MAX_BUDGET) {
        (void)snprintf(text + used, sizeof text - (size_t)used,
                       "; --budget %.0f has two for every instance", wanted);
    } else {
        (void)snprintf(text + used, sizeof text - (size_t)used,
                       ", and a budget is at most %d; take a part of the scene by --node",
                       MAX_BUDGET);
    }
    occluder->result = PVT_SEPARATE_NO_SHARE;
    return GiveReason(separate, text, occluder);
}

// The deadline is that of the whole: what is left of it is for the rounds that are left.
static double GetDeadline(Separate* separate)
{
    const size_t begun = atomic_fetch_add(&separate->begun, 1);
    const double whole = separate->options->deadline;
    if (!(whole > 0.0)) {
        return whole;
    }
    const size_t left = begun < separate->jobCount ? separate->jobCount - begun : 1;
    const size_t size = (size_t)separate->crewSize;
    const size_t rounds = (left + size - 1) / size;
    return fmax(1e-6, (whole - (pvtGetSeconds() - separate->started)) / (double)rounds);
}

// To the world's lengths, and to all instances.
static void ScaleStats(const pvtGroup* group, pvtBuildStats* stats)
{
    stats->voxelSize *= group->scale;
    stats->tolerance *= group->scale;
    stats->smallestHole *= group->scale;
    stats->errorBound *= group->scale;
    stats->deviation *= group->scale;
    stats->suggestedHole *= group->scale;
    stats->measure *= group->volume;
    stats->measureOfSolid *= group->volume;
}

// A few triangles have few ways to lie: they are as good after a tenth of the trials, and a scene
// may have hundreds of meshes that get no more.
static pvtEffort GetEffort(int budget, pvtEffort effort)
{
    return budget >= FEW || effort == PVT_EFFORT_FAST ? effort : (pvtEffort)((int)effort - 1);
}

static pvtStatus RunBuild(pvtContext* context, size_t job, void* user)
{
    Separate* separate = user;
    const size_t index = separate->jobs[job].group;
    const pvtGroup* group = &separate->groups.groups[index];
    pvtSeparateOccluder* out = &separate->out.occluders[index];
    pvtBuildOptions options = group->options;
    options.budget = out->budget;
    options.effort = GetEffort(out->budget, options.effort);
    options.deadline = GetDeadline(separate);
    pvtOccluder occluder;
    pvtStatus status = pvtBuildOccluder(context, &options, pvtGroup_GetMesh(group, separate->set),
                                        &occluder, &out->stats);
    if (status != PVT_OK) {
        return TakeHollow(separate, context, status, out);
    }
    pvtGroup_TurnBack(group, &occluder.mesh);
    pvtMesh_Free(separate->context, &out->mesh);
    const pvtMesh* made = &occluder.mesh;
    status = pvtCreateMesh(separate->context, made->positions, made->positionCount, made->indices,
                           made->triangleCount, &out->mesh);
    out->polygonCount = occluder.loops.loopCount;
    out->result = PVT_SEPARATE_MADE;
    pvtOccluder_Free(context, &occluder);
    return status;
}

static pvtStatus BuildStep(pvtContext* context, Separate* separate)
{
    (void)context;
    separate->jobCount = 0;
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < separate->out.count && status == PVT_OK; ++i) {
        pvtSeparateOccluder* occluder = &separate->out.occluders[i];
        if (occluder->budget > 0) {
            separate->jobs[separate->jobCount++] = (Job){i, occluder->budget};
        } else if (occluder->result != PVT_SEPARATE_HOLLOW) {
            status = RefuseShare(separate, occluder);
        }
    }
    if (status == PVT_OK) {
        status = RunJobs(separate, "occluders", true, RunBuild);
    }
    for (size_t i = 0; i < separate->out.count; ++i) {
        ScaleStats(&separate->groups.groups[i], &separate->out.occluders[i].stats);
    }
    return status;
}

// A scene of a thousand sheets is told of a few of them.
static void TellMissing(pvtContext* context, Separate* separate, size_t missing)
{
    size_t told = 0;
    for (size_t i = 0; i < separate->out.count && told < MAX_TOLD; ++i) {
        if (separate->out.occluders[i].result != PVT_SEPARATE_MADE) {
            char name[128];
            NameJob(i, name, sizeof name, separate);
            pvtLog(context, PVT_LOG_WARNING, "%s: no occluder: %s", name,
                   separate->out.occluders[i].reason);
            ++told;
        }
    }
    if (missing > told) {
        pvtLog(context, PVT_LOG_WARNING, "and %zu more meshes have no occluder, of %zu in all",
               missing - told, separate->out.count);
    }
}

// A file whose meshes all cannot be used is not valid; else it has nothing to occlude with.
static pvtStatus FailWithout(pvtContext* context, Separate* separate)
{
    const size_t count = separate->out.count;
    const pvtStatus status =
        atomic_load(&separate->invalid) == count ? PVT_INVALID_INPUT : PVT_NOTHING_INSIDE;
    char name[128];
    if (count == 0) {
        return pvtFail(context, PVT_NOTHING_INSIDE,
                       "every instance is flattened by its transform, so that nothing is inside");
    }
    NameJob(0, name, sizeof name, separate);
    if (count == 1) {
        return pvtFail(context, status, "%s: %s", name, separate->out.occluders[0].reason);
    }
    return pvtFail(context, status, "none of the %zu meshes gets an occluder; of the first, %s: %s",
                   count, name, separate->out.occluders[0].reason);
}

// What has no occluder is told, in the order of the instances; without any the run has failed.
static pvtStatus TellStep(pvtContext* context, Separate* separate)
{
    size_t made = 0;
    for (size_t i = 0; i < separate->out.count; ++i) {
        const pvtSeparateOccluder* occluder = &separate->out.occluders[i];
        made += occluder->result == PVT_SEPARATE_MADE ? 1 : 0;
        separate->jobs[i] = (Job){i, 0.0};
    }
    if (made == 0) {
        return FailWithout(context, separate);
    }
    TellMissing(context, separate, separate->out.count - made);
    return PVT_OK;
}

pvtStatus pvtBuildSeparateOccluders(pvtContext* context, const pvtBuildOptions* options,
                                    const pvtInstanceSet* set, pvtSeparation* separation)
{
    pvtStatus (*const steps[])(pvtContext*, Separate*) = {
        // Instances of one mesh share an occluder, and meshes that are alike count as one.
        GroupStep,
        // What each could hide decides on its share of the budget.
        MeasureStep,
        ShareStep,
        // Each by itself, as if it were alone.
        BuildStep,
        // Which have none, and why.
        TellStep,
    };
    *separation = (pvtSeparation){0};
    Separate separate = {
        .context = context, .options = options, .set = set, .started = pvtGetSeconds()};
    pvtStatus status = PVT_OK;
    if (options->budget < 0 || options->budget > MAX_BUDGET) {
        status = pvtFail(context, PVT_INVALID_ARGUMENT,
                         "budget is %d triangles; it must be 1 to %d, or 0 to be chosen",
                         options->budget, MAX_BUDGET);
    }
    for (size_t i = 0; i < sizeof steps / sizeof *steps && status == PVT_OK; ++i) {
        status = steps[i](context, &separate);
    }
    if (status == PVT_OK) {
        *separation = separate.out;
    } else {
        pvtSeparation_Free(context, &separate.out);
    }
    pvtGroupSet_Free(context, &separate.groups);
    pvtRelease(context, separate.jobs);
    return status;
}

void pvtSeparation_Free(pvtContext* context, pvtSeparation* separation)
{
    for (size_t i = 0; i < separation->count; ++i) {
        pvtMesh_Free(context, &separation->occluders[i].mesh);
        pvtRelease(context, separation->occluders[i].reason);
    }
    pvtRelease(context, separation->occluders);
    pvtRelease(context, separation->ofInstance);
    *separation = (pvtSeparation){0};
}
