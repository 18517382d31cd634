// SPDX-License-Identifier: MIT
// Runs with their k-th allocation failing: the status says so, nothing is held, and the output is
// empty. Every k for the stages one after the other on a small plan; a sample of them for the
// driver, which asks tens of thousands of times.
#include "check.h"

#include "recipe_mesh.h"

#include <paravent/paravent.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

// Refuses the request number `failAt`, counted from 1, and none when it is 0.
typedef struct Doubtful {
    atomic_size_t requests, live;
    size_t failAt;
} Doubtful;

static void* Allocate(void* user, size_t size)
{
    Doubtful* doubtful = user;
    if (atomic_fetch_add(&doubtful->requests, 1) + 1 == doubtful->failAt) {
        return NULL;
    }
    atomic_fetch_add(&doubtful->live, 1);
    return malloc(size);
}

static void Release(void* user, void* memory)
{
    Doubtful* doubtful = user;
    if (memory != NULL) {
        atomic_fetch_sub(&doubtful->live, 1);
    }
    free(memory);
}

static bool IsZero(const void* bytes, size_t count)
{
    const uint8_t* byte = bytes;
    for (size_t i = 0; i < count; ++i) {
        if (byte[i] != 0) {
            return false;
        }
    }
    return true;
}

// Runs something whole on a mesh; `*empty` tells whether the output was left empty.
typedef pvtStatus RunFcn(pvtContext* context, const pvtMesh* mesh, bool* empty);

static pvtStatus RunBuildBy(pvtContext* context, const pvtMesh* mesh,
                            const pvtBuildOptions* options, pvtBuildStats* stats, bool* empty)
{
    pvtOccluder occluder;
    memset(&occluder, 0xA5, sizeof occluder);
    const pvtStatus status = pvtBuildOccluder(context, options, mesh, &occluder, stats);
    *empty = IsZero(&occluder, sizeof occluder);
    pvtOccluder_Free(context, &occluder);
    return status;
}

static pvtStatus RunBuildWithin(pvtContext* context, const pvtMesh* mesh, pvtMethod method,
                                double tolerance, bool* empty)
{
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.budget = 6;
    options.resolution = 8;
    options.smallestHole = (pvtLength){2.0 * tolerance, true};
    options.tolerance = (pvtLength){tolerance, true};
    options.method = method;
    options.views.count = 1;
    return RunBuildBy(context, mesh, &options, NULL, empty);
}

static pvtStatus RunBuild(pvtContext* context, const pvtMesh* mesh, pvtMethod method, bool* empty)
{
    return RunBuildWithin(context, mesh, method, 1.0, empty);
}

static pvtStatus RunPlanarBuild(pvtContext* context, const pvtMesh* mesh, bool* empty)
{
    return RunBuild(context, mesh, PVT_METHOD_PLANAR, empty);
}

static pvtStatus RunSheetBuild(pvtContext* context, const pvtMesh* mesh, bool* empty)
{
    return RunBuildWithin(context, mesh, PVT_METHOD_PLANAR, 0.0, empty);
}

// Begins again, with voxels small enough for a band within the error.
static pvtStatus RunBandBuild(pvtContext* context, const pvtMesh* mesh, bool* empty)
{
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.budget = 6;
    options.error = 0.5;
    options.views.count = 6;
    options.effort = PVT_EFFORT_FAST;
    pvtBuildStats stats;
    const pvtStatus status = RunBuildBy(context, mesh, &options, &stats, empty);
    assert_true(status != PVT_OK || stats.tolerance > 0.0);
    return status;
}

static pvtStatus RunPaperBuild(pvtContext* context, const pvtMesh* mesh, bool* empty)
{
    return RunBuild(context, mesh, PVT_METHOD_PAPER, empty);
}

static pvtStatus RunEvaluation(pvtContext* context, const pvtMesh* mesh, bool* empty)
{
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = 3;
    options.quads = 20;
    options.pixels = 16;
    pvtEvaluation evaluation;
    memset(&evaluation, 0xA5, sizeof evaluation);
    const pvtStatus status = pvtEvaluateOccluders(context, &options, mesh, mesh, 1, &evaluation);
    *empty = IsZero(&evaluation, sizeof evaluation);
    pvtEvaluation_Free(context, &evaluation);
    return status;
}

static pvtStatus RunVoxelMesh(pvtContext* context, const pvtMesh* mesh, bool* empty)
{
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 10;
    pvtBitGrid surface;
    pvtMesh voxelMesh;
    memset(&surface, 0xA5, sizeof surface);
    memset(&voxelMesh, 0xA5, sizeof voxelMesh);
    pvtStatus status = pvtVoxelizeMesh(context, &options, mesh, &surface);
    *empty = IsZero(&surface, sizeof surface);
    if (status == PVT_OK) {
        status = pvtBuildVoxelMesh(context, &surface, &voxelMesh);
        *empty = IsZero(&voxelMesh, sizeof voxelMesh);
        pvtMesh_Free(context, &voxelMesh);
    }
    pvtBitGrid_Free(context, &surface);
    return status;
}

// What the stages hand on.
typedef struct Stages {
    pvtBitGrid surface;
    pvtSolid solid;
    pvtBitGrid allowed;
    pvtSliceVolume volume;
    pvtFaceDirectionSet faces;
    pvtSectionPlan plan;
    pvtSectionSet sections;
    pvtCandidateSet candidates;
    pvtViewSet views;
    pvtCut selected, reduced;
} Stages;

static pvtStatus RunVoxelStages(pvtContext* context, const pvtMesh* mesh, Stages* stages)
{
    pvtVoxelizeOptions voxelize = pvtDefaultVoxelizeOptions();
    voxelize.resolution = 12;
    voxelize.padding = 0.5;
    pvtStatus status = pvtVoxelizeMesh(context, &voxelize, mesh, &stages->surface);
    if (status == PVT_OK) {
        pvtSolidOptions solid = pvtDefaultSolidOptions();
        solid.smallestHole = 0.5;
        solid.enclosed = 2;
        status = pvtFillSolid(context, &solid, &stages->surface, &stages->solid);
    }
    if (status == PVT_OK) {
        status = pvtMakeAllowedGrid(context, &stages->solid, 0.3, &stages->allowed);
    }
    if (status == PVT_OK) {
        status = pvtCreateSliceVolume(context, &stages->allowed, &stages->volume);
    }
    return status;
}

static pvtStatus RunSectionStages(pvtContext* context, const pvtMesh* mesh, Stages* stages)
{
    pvtFaceDirectionOptions faces = pvtDefaultFaceDirectionOptions();
    faces.maxCount = 1;
    pvtStatus status = pvtFindFaceDirections(context, &faces, mesh, &stages->faces);
    if (status == PVT_OK) {
        pvtPlanOptions plan = pvtDefaultPlanOptions();
        plan.directions = 2;
        plan.axes = false;
        plan.depths = 2;
        plan.faces = &stages->faces;
        status = pvtPlanSections(context, &plan, &stages->allowed, &stages->plan);
    }
    if (status == PVT_OK) {
        const pvtSearchOptions search = pvtDefaultSearchOptions();
        status =
            pvtSearchSections(context, &search, &stages->volume, &stages->plan, &stages->sections);
    }
    if (status == PVT_OK) {
        pvtCandidateOptions candidates = pvtDefaultCandidateOptions();
        candidates.simplification = 0.5;
        status = pvtBuildCandidates(context, &candidates, &stages->volume, &stages->sections,
                                    &stages->candidates);
    }
    return status;
}

static pvtStatus RunChoices(pvtContext* context, const pvtMesh* mesh, Stages* stages,
                            pvtOccluder* occluder)
{
    pvtViewOptions views = pvtDefaultViewOptions();
    views.count = 2;
    pvtStatus status = pvtMakeViews(context, &views, &stages->views);
    pvtSelectOptions select = pvtDefaultSelectOptions();
    select.budget = 6;
    select.views = &stages->views;
    select.bounds = pvtMesh_GetBounds(mesh);
    if (status == PVT_OK) {
        status = pvtSelectOccluder(context, &select, &stages->candidates, &stages->selected);
    }
    if (status == PVT_OK) {
        status = pvtReduceOccluder(context, &select, &stages->candidates, &stages->reduced);
    }
    if (status == PVT_OK) {
        status = pvtTakeCut(context, &stages->candidates, &stages->selected, occluder);
    }
    return status;
}

static pvtStatus CheckChoice(pvtContext* context, const Stages* stages, const pvtMesh* occluder)
{
    uint64_t outside = 0;
    double measure = 0.0;
    pvtStatus status =
        pvtCheckOccluder(context, &(pvtInterior){.allowed = &stages->allowed}, occluder, &outside);
    if (status == PVT_OK) {
        const pvtBox3 bounds = pvtMesh_GetBounds(occluder);
        status = pvtMeasureOcclusion(context, &stages->views, &bounds, 64, occluder, &measure);
    }
    return status;
}

static pvtStatus RunStages(pvtContext* context, const pvtMesh* mesh, bool* empty)
{
    Stages stages = {0};
    pvtOccluder occluder = {0};
    pvtStatus status = RunVoxelStages(context, mesh, &stages);
    if (status == PVT_OK) {
        status = RunSectionStages(context, mesh, &stages);
    }
    if (status == PVT_OK) {
        status = RunChoices(context, mesh, &stages, &occluder);
    }
    *empty = IsZero(&occluder, sizeof occluder);
    if (status == PVT_OK) {
        status = CheckChoice(context, &stages, &occluder.mesh);
        *empty = status != PVT_OK; // these two have numbers for output
    }
    pvtOccluder_Free(context, &occluder);
    pvtCut_Free(context, &stages.reduced);
    pvtCut_Free(context, &stages.selected);
    pvtViewSet_Free(context, &stages.views);
    pvtCandidateSet_Free(context, &stages.candidates);
    pvtSectionSet_Free(context, &stages.sections);
    pvtSectionPlan_Free(context, &stages.plan);
    pvtFaceDirectionSet_Free(context, &stages.faces);
    pvtSliceVolume_Free(context, &stages.volume);
    pvtBitGrid_Free(context, &stages.allowed);
    pvtSolid_Free(context, &stages.solid);
    pvtBitGrid_Free(context, &stages.surface);
    return status;
}

// One run with request `failAt` refused; returns the number of requests.
static size_t RunOnce(RunFcn* run, const pvtMesh* mesh, int threads, size_t failAt)
{
    Doubtful doubtful = {.failAt = 0};
    pvtContextDef def = pvtDefaultContextDef();
    def.allocator = (pvtAllocator){Allocate, Release, &doubtful};
    def.threadCount = threads;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    atomic_store(&doubtful.requests, 0);
    doubtful.failAt = failAt;

    bool empty = false;
    const pvtStatus status = run(context, mesh, &empty);
    if (failAt == 0) {
        assert_int_equal(status, PVT_OK);
        assert_false(empty);
    } else if (status != PVT_OUT_OF_MEMORY || !empty) {
        fail_msg("request %zu refused: status %s, output %s", failAt, pvtGetStatusName(status),
                 empty ? "empty" : "not empty");
    }
    if (pvtContext_GetHeldBytes(context) != 0 || atomic_load(&doubtful.live) != 1) {
        fail_msg("request %zu refused: %zu bytes still held", failAt,
                 pvtContext_GetHeldBytes(context));
    }
    pvtDestroyContext(context);
    assert_int_equal(atomic_load(&doubtful.live), 0);
    return atomic_load(&doubtful.requests);
}

// Refuses every request when `most` is 0, else about that many, spread over all.
static void CheckRequestsOn(const char* recipe, RunFcn* run, int threads, size_t most)
{
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    CHECK_OK(context, MakeRecipeMesh(context, recipe, &mesh));
    const size_t requests = RunOnce(run, &mesh, threads, 0);
    assert_true(requests > 3);
    const size_t step = most == 0 ? 1 : 1 + requests / most;
    for (size_t failAt = 1; failAt <= requests; failAt += step) {
        RunOnce(run, &mesh, threads, failAt);
    }
    print_message("%zu requests, one of every %zu refused\n", requests, step);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void CheckRequests(RunFcn* run, int threads, size_t most)
{
    CheckRequestsOn("boulder", run, threads, most);
}

static void stages_survive_every_refused_request(void** state)
{
    (void)state;
    CheckRequests(RunStages, 1, 0);
}

static void an_evaluation_survives_every_refused_request(void** state)
{
    (void)state;
    CheckRequests(RunEvaluation, 1, 0);
}

static void a_voxel_mesh_survives_every_refused_request(void** state)
{
    (void)state;
    CheckRequests(RunVoxelMesh, 1, 0);
}

static void a_planar_build_survives_refused_requests(void** state)
{
    (void)state;
    CheckRequests(RunPlanarBuild, 1, 60);
}

static void a_build_of_sheets_survives_refused_requests(void** state)
{
    (void)state;
    CheckRequestsOn("hangar", RunSheetBuild, 1, 60);
}

static void a_build_within_a_band_survives_refused_requests(void** state)
{
    (void)state;
    CheckRequestsOn("sheet", RunBandBuild, 1, 24);
}

static void a_paper_build_survives_refused_requests(void** state)
{
    (void)state;
    CheckRequests(RunPaperBuild, 1, 60);
}

static void a_build_on_four_threads_survives_refused_requests(void** state)
{
    (void)state;
    CheckRequests(RunPlanarBuild, 4, 20);
}

static void a_context_survives_a_refused_request(void** state)
{
    (void)state;
    Doubtful doubtful = {.failAt = 1};
    pvtContextDef def = pvtDefaultContextDef();
    def.allocator = (pvtAllocator){Allocate, Release, &doubtful};
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OUT_OF_MEMORY);
    assert_null(context);
    assert_int_equal(atomic_load(&doubtful.live), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_context_survives_a_refused_request),
        cmocka_unit_test(a_voxel_mesh_survives_every_refused_request),
        cmocka_unit_test(stages_survive_every_refused_request),
        cmocka_unit_test(an_evaluation_survives_every_refused_request),
        cmocka_unit_test(a_planar_build_survives_refused_requests),
        cmocka_unit_test(a_build_of_sheets_survives_refused_requests),
        cmocka_unit_test(a_build_within_a_band_survives_refused_requests),
        cmocka_unit_test(a_paper_build_survives_refused_requests),
        cmocka_unit_test(a_build_on_four_threads_survives_refused_requests),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
