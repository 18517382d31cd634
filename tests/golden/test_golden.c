// SPDX-License-Identifier: MIT
// Every stage on two small models, hashed. A hash that changes says which stage changed first; one
// that depends on the number of threads is a mistake in any case.
//   test_golden hashes.txt            compares
//   test_golden hashes.txt --update   writes what is found
#include "append.h"
#include "check.h"

#include "recipe_mesh.h"
#include "trail.h"

#include <paravent/paravent.h>
#include <stdlib.h>
#include <string.h>

// What the stages hand on, and the trail that they leave.
typedef struct Run {
    pvtContext* context;
    Trail* trail;
    bool hollow; // a house: it needs its openings closed
    pvtMesh mesh;
    pvtBitGrid surface;
    pvtSolid solid;
    pvtBitGrid allowed;
    pvtCellGrid cells;
    pvtSliceVolume volume;
    pvtFaceDirectionSet faces;
    pvtSectionPlan plan;
    pvtSectionSet sections;
    pvtCandidateSet candidates;
    pvtViewSet views;
} Run;

enum { RESOLUTION = 16, BUDGET = 12, VIEWS = 2 };
static const double HOLE = 1.4; // [m] wider than the house's door and windows

static uint64_t HashVec3(uint64_t hash, pvtVec3 v)
{
    return HashDoubles(hash, (const double[]){v.x, v.y, v.z}, 3);
}

static uint64_t HashGrid(const pvtBitGrid* grid)
{
    uint64_t hash = HashVec3(HASH_START, grid->frame.origin);
    hash = HashDouble(hash, grid->frame.voxelSize);
    hash = HashBytes(hash, grid->frame.size, sizeof grid->frame.size);
    return HashBytes(hash, grid->words, grid->wordCount * sizeof *grid->words);
}

static uint64_t HashMesh(uint64_t hash, const pvtMesh* mesh)
{
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        hash = HashVec3(hash, mesh->positions[i]);
    }
    return HashBytes(hash, mesh->indices, 3 * mesh->triangleCount * sizeof *mesh->indices);
}

static uint64_t HashPlane(uint64_t hash, const pvtPlane* plane)
{
    hash = HashNumber(hash, plane->axis);
    hash = HashNumber(hash, (uint64_t)plane->slopeU);
    hash = HashNumber(hash, (uint64_t)plane->slopeV);
    return HashNumber(hash, (uint64_t)plane->offset);
}

static uint64_t HashLoops(uint64_t hash, const pvtLoopSet* loops)
{
    hash = HashBytes(hash, loops->points, loops->pointCount * sizeof *loops->points);
    for (size_t i = 0; i < loops->loopCount; ++i) {
        hash = HashNumber(hash, loops->starts[i]);
        hash = HashNumber(hash, (uint64_t)loops->parents[i]);
    }
    return hash;
}

static uint64_t HashChains(uint64_t hash, const pvtChainSet* chains)
{
    hash = HashBytes(hash, chains->points, chains->pointCount * sizeof *chains->points);
    hash = HashBytes(hash, chains->ranks, chains->pointCount * sizeof *chains->ranks);
    hash = HashBytes(hash, chains->limits, chains->pointCount * sizeof *chains->limits);
    for (size_t i = 0; i < chains->count; ++i) {
        hash = HashNumber(hash, chains->starts[i]);
    }
    return hash;
}

static void RunVoxelStages(Run* run)
{
    pvtContext* context = run->context;
    pvtVoxelizeOptions voxelize = pvtDefaultVoxelizeOptions();
    voxelize.resolution = RESOLUTION;
    voxelize.padding = run->hollow ? HOLE : 0.0;
    CHECK_OK(context, pvtVoxelizeMesh(context, &voxelize, &run->mesh, &run->surface));
    Trail_Add(run->trail, "voxelize", HashGrid(&run->surface));

    pvtSolidOptions solid = pvtDefaultSolidOptions();
    solid.smallestHole = run->hollow ? HOLE : 0.0;
    solid.ground = run->hollow;
    CHECK_OK(context, pvtFillSolid(context, &solid, &run->surface, &run->solid));
    assert_true(run->solid.strictCount > 100);
    Trail_Add(run->trail, "solid", HashGrid(&run->solid.inside));

    CHECK_OK(context, pvtMakeAllowedGrid(context, &run->solid, 0.0, &run->allowed));
    Trail_Add(run->trail, "allowed", HashGrid(&run->allowed));
    CHECK_OK(context,
             pvtRefineAllowedGrid(context, &run->mesh, &run->solid, &run->allowed, &run->cells));
    uint64_t hash = HashGrid(&run->allowed);
    hash = HashBytes(hash, run->cells.cells, run->cells.count * sizeof *run->cells.cells);
    Trail_Add(run->trail, "cells", hash);

    pvtMesh voxelMesh;
    CHECK_OK(context, pvtBuildVoxelMesh(context, &run->solid.inside, &voxelMesh));
    Trail_Add(run->trail, "voxel-mesh", HashMesh(HASH_START, &voxelMesh));
    pvtMesh_Free(context, &voxelMesh);
}

static void RunSectionStages(Run* run)
{
    pvtContext* context = run->context;
    const pvtFaceDirectionOptions faces = pvtDefaultFaceDirectionOptions();
    CHECK_OK(context, pvtFindFaceDirections(context, &faces, &run->mesh, &run->faces));
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < run->faces.count; ++i) {
        hash = HashVec3(hash, run->faces.directions[i].direction);
        hash = HashDouble(hash, run->faces.directions[i].area);
    }
    Trail_Add(run->trail, "face-directions", hash);

    pvtPlanOptions plan = pvtDefaultPlanOptions();
    plan.directions = 8;
    plan.depths = 6;
    plan.faces = &run->faces;
    CHECK_OK(context, pvtPlanSections(context, &plan, &run->allowed, &run->plan));
    hash = HASH_START;
    for (size_t i = 0; i < run->plan.planeCount; ++i) {
        hash = HashPlane(hash, &run->plan.planes[i]);
    }
    for (size_t i = 0; i <= run->plan.binCount; ++i) {
        hash = HashNumber(hash, run->plan.binStarts[i]);
    }
    Trail_Add(run->trail, "plan", hash);

    CHECK_OK(context, pvtCreateSliceVolume(context, &run->allowed, &run->volume));
    const pvtSearchOptions search = pvtDefaultSearchOptions();
    CHECK_OK(context,
             pvtSearchSections(context, &search, &run->volume, &run->plan, &run->sections));
    hash = HASH_START;
    for (size_t i = 0; i < run->sections.count; ++i) {
        hash = HashPlane(hash, &run->sections.sections[i].plane);
        hash = HashDouble(hash, run->sections.sections[i].area);
    }
    Trail_Add(run->trail, "search", hash);
}

typedef struct PolygonHashes {
    uint64_t slice, contours, simplified, bridged, chains;
} PolygonHashes;

// One section by the public stages, one after the other.
static void RunPolygonStages(Run* run, const pvtPlane* plane, PolygonHashes* hashes)
{
    pvtContext* context = run->context;
    const int* size = run->allowed.frame.size;
    pvtBitmap slice;
    CHECK_OK(context, pvtCreateBitmap(context, size[pvtPlane_GetU(plane)],
                                      size[pvtPlane_GetV(plane)], &slice));
    pvtSliceGrid(&run->volume, plane, PVT_SLICE_COVERED, 1, &slice);
    hashes->slice = HashBytes(hashes->slice, slice.words,
                              slice.wordsPerRow * (size_t)slice.height * sizeof *slice.words);

    pvtLoopSet contours, simplified, bridged;
    CHECK_OK(context, pvtTraceContours(context, &slice, 1, &contours));
    hashes->contours = HashLoops(hashes->contours, &contours);

    pvtSimplifyOptions simplify = pvtDefaultSimplifyOptions();
    simplify.plane = plane;
    simplify.guard = &slice;
    simplify.cellsPerVoxel = 1;
    CHECK_OK(context, pvtSimplifyContours(context, &simplify, &contours, &simplified));
    hashes->simplified = HashLoops(hashes->simplified, &simplified);

    CHECK_OK(context, pvtBridgeHoles(context, &simplified, &bridged));
    hashes->bridged = HashLoops(hashes->bridged, &bridged);

    pvtChainOptions chain = pvtDefaultChainOptions();
    chain.allowed = &slice;
    chain.cellsPerVoxel = 1;
    pvtChainSet chains;
    CHECK_OK(context, pvtBuildChains(context, &chain, &bridged, &chains));
    hashes->chains = HashChains(hashes->chains, &chains);

    pvtChainSet_Free(context, &chains);
    pvtLoopSet_Free(context, &bridged);
    pvtLoopSet_Free(context, &simplified);
    pvtLoopSet_Free(context, &contours);
    pvtBitmap_Free(context, &slice);
}

static void RunChainStages(Run* run)
{
    PolygonHashes hashes = {HASH_START, HASH_START, HASH_START, HASH_START, HASH_START};
    assert_true(run->sections.count > 0);
    for (size_t i = 0; i < run->sections.count; ++i) {
        RunPolygonStages(run, &run->sections.sections[i].plane, &hashes);
    }
    Trail_Add(run->trail, "slices", hashes.slice);
    Trail_Add(run->trail, "contours", hashes.contours);
    Trail_Add(run->trail, "simplify", hashes.simplified);
    Trail_Add(run->trail, "bridge", hashes.bridged);
    Trail_Add(run->trail, "chains", hashes.chains);

    const pvtCandidateOptions options = pvtDefaultCandidateOptions();
    CHECK_OK(run->context, pvtBuildCandidates(run->context, &options, &run->volume, &run->sections,
                                              &run->candidates));
    uint64_t hash = HashChains(HASH_START, &run->candidates.chains);
    for (size_t i = 0; i < run->candidates.chains.count; ++i) {
        hash = HashPlane(hash, &run->candidates.planes[i]);
    }
    Trail_Add(run->trail, "candidates", hash);
}

static void RunOcclusionStages(Run* run)
{
    pvtContext* context = run->context;
    pvtViewOptions options = pvtDefaultViewOptions();
    options.count = VIEWS;
    CHECK_OK(context, pvtMakeViews(context, &options, &run->views));
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < run->views.count; ++i) {
        hash = HashVec3(hash, run->views.views[i].direction);
        hash = HashVec3(hash, run->views.views[i].right);
        hash = HashDouble(hash, run->views.views[i].weight);
    }
    Trail_Add(run->trail, "views", hash);

    const pvtBox3 bounds = pvtMesh_GetBounds(&run->mesh);
    double measure = 0.0;
    CHECK_OK(context, pvtMeasureOcclusion(context, &run->views, &bounds, 64, &run->mesh, &measure));
    Trail_Add(run->trail, "measure", HashDouble(HASH_START, measure));
}

typedef pvtStatus ChooseFcn(pvtContext* context, const pvtSelectOptions* options,
                            const pvtCandidateSet* candidates, pvtCut* cut);

static void RunChoice(Run* run, const char* stage, ChooseFcn* choose)
{
    pvtSelectOptions options = pvtDefaultSelectOptions();
    options.budget = BUDGET;
    options.views = &run->views;
    options.bounds = pvtMesh_GetBounds(&run->mesh);
    pvtCut cut;
    CHECK_OK(run->context, choose(run->context, &options, &run->candidates, &cut));
    Trail_Add(run->trail, stage,
              HashBytes(HASH_START, cut.triangles, cut.count * sizeof *cut.triangles));
    pvtCut_Free(run->context, &cut);
}

static void RunBuild(Run* run, const char* stage, pvtMethod method, pvtMesh* occluder)
{
    pvtContext* context = run->context;
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.budget = BUDGET;
    options.resolution = RESOLUTION;
    options.smallestHole = (pvtLength){run->hollow ? HOLE : 0.0, false};
    options.ground = run->hollow;
    options.method = method;
    options.views.count = VIEWS;
    pvtOccluder built;
    CHECK_OK(context, pvtBuildOccluder(context, &options, &run->mesh, &built, NULL));
    assert_in_range(built.mesh.triangleCount, 1, BUDGET);
    for (size_t i = 0; i < built.mesh.positionCount; ++i) {
        // Some compilers need `volatile` to round at all.
        const volatile float stored = (float)built.mesh.positions[i].x;
        assert_true((double)stored == built.mesh.positions[i].x);
    }
    uint64_t hash = HashMesh(HASH_START, &built.mesh);
    for (size_t i = 0; i < built.loops.loopCount; ++i) {
        hash = HashPlane(hash, &built.planes[i]);
    }
    Trail_Add(run->trail, stage, HashDouble(hash, built.measure));
    CHECK_OK(context, AppendMesh(context, occluder, &built.mesh));
    pvtOccluder_Free(context, &built);
}

// Distances stay out of the hash: the last bit of a tangent is not the same everywhere.
static void RunLadder(Run* run)
{
    pvtContext* context = run->context;
    pvtLadderOptions options = pvtDefaultLadderOptions();
    options.build.resolution = RESOLUTION;
    options.build.smallestHole = (pvtLength){run->hollow ? HOLE : 0.0, false};
    options.build.ground = run->hollow;
    options.build.views.count = VIEWS;
    options.build.effort = PVT_EFFORT_FAST;
    options.levelCount = 2;
    options.budgets[0] = BUDGET;
    options.budgets[1] = BUDGET / 2;
    pvtLadder ladder;
    CHECK_OK(context, pvtBuildLadder(context, &options, &run->mesh, &ladder));
    uint64_t hash = HashNumber(HASH_START, ladder.count);
    for (size_t i = 0; i < ladder.count; ++i) {
        hash = HashMesh(hash, &ladder.levels[i].occluder.mesh);
        hash = HashDouble(hash, ladder.levels[i].stats.errorBound);
    }
    Trail_Add(run->trail, "ladder", hash);
    pvtLadder_Free(context, &ladder);
}

// The model twice, the second time mirrored and half as wide, and what it is made of once.
static void RunSeparate(Run* run)
{
    static const double mirrored[16] = {-0.5, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 9, 0, 0, 1};
    static const double moved[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 9, 1};
    const pvtInstance instances[] = {{0, moved, "a"}, {0, mirrored, "b"}};
    const pvtInstanceSet set = {&run->mesh, 1, instances, 2};
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.budget = 2 * BUDGET;
    options.resolution = RESOLUTION;
    options.smallestHole = (pvtLength){run->hollow ? HOLE : 0.0, false};
    options.ground = run->hollow;
    options.views.count = VIEWS;
    pvtSeparation separation;
    CHECK_OK(run->context, pvtBuildSeparateOccluders(run->context, &options, &set, &separation));
    assert_int_equal(separation.count, 1);
    const pvtSeparateOccluder* occluder = &separation.occluders[0];
    const uint64_t hash = HashDouble(HASH_START, occluder->stats.measureOfSolid);
    Trail_Add(run->trail, "separate", HashMesh(hash, &occluder->mesh));
    pvtSeparation_Free(run->context, &separation);
}

static void RunEvaluation(Run* run, const pvtMesh* occluder)
{
    pvtContext* context = run->context;
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = 12;
    options.quads = 500;
    options.pixels = 96;
    pvtEvaluation evaluation;
    CHECK_OK(context,
             pvtEvaluateOccluders(context, &options, &run->mesh, occluder, 1, &evaluation));
    const pvtOccluderScore* score = &evaluation.occluders[0];
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < score->viewCount; ++i) {
        const pvtViewScore* view = &score->views[i];
        const double numbers[] = {view->uniform.precision, view->uniform.recall,
                                  view->small.precision,   view->small.recall,
                                  view->coverage,          view->overArea,
                                  view->overThickness};
        hash = HashDoubles(HashVec3(hash, view->direction), numbers, 7);
    }
    Trail_Add(run->trail, "evaluate", hash);
    pvtEvaluation_Free(context, &evaluation);
}

static void FreeRun(Run* run)
{
    pvtContext* context = run->context;
    pvtViewSet_Free(context, &run->views);
    pvtCandidateSet_Free(context, &run->candidates);
    pvtSectionSet_Free(context, &run->sections);
    pvtSectionPlan_Free(context, &run->plan);
    pvtFaceDirectionSet_Free(context, &run->faces);
    pvtSliceVolume_Free(context, &run->volume);
    pvtBitGrid_Free(context, &run->allowed);
    pvtCellGrid_Free(context, &run->cells);
    pvtSolid_Free(context, &run->solid);
    pvtBitGrid_Free(context, &run->surface);
    pvtMesh_Free(context, &run->mesh);
}

static void RunModel(Trail* trail, const char* name, bool hollow, int threads)
{
    Run run = {.context = CreateTestContext(threads), .trail = trail, .hollow = hollow};
    trail->model = name;
    CHECK_OK(run.context, MakeRecipeMesh(run.context, name, &run.mesh));
    RunVoxelStages(&run);
    RunSectionStages(&run);
    RunChainStages(&run);
    RunOcclusionStages(&run);
    RunChoice(&run, "select", pvtSelectOccluder);
    RunChoice(&run, "reduce", pvtReduceOccluder);
    pvtMesh occluder = {0};
    RunBuild(&run, "build-planar", PVT_METHOD_PLANAR, &occluder);
    RunBuild(&run, "build-paper", PVT_METHOD_PAPER, &occluder);
    RunLadder(&run);
    RunSeparate(&run);
    RunEvaluation(&run, &occluder);
    pvtMesh_Free(run.context, &occluder);
    FreeRun(&run);
    DestroyTestContext(run.context);
}

// Of what has no inside, the build alone: on flat panels, or within a band.
static void RunSurface(Trail* trail, const char* name, int threads)
{
    Run run = {.context = CreateTestContext(threads), .trail = trail};
    trail->model = name;
    CHECK_OK(run.context, MakeRecipeMesh(run.context, name, &run.mesh));
    pvtMesh occluder = {0};
    RunBuild(&run, "build-planar", PVT_METHOD_PLANAR, &occluder);
    pvtMesh_Free(run.context, &occluder);
    FreeRun(&run);
    DestroyTestContext(run.context);
}

typedef struct Golden {
    const char* path;
    bool update;
    Trail expected, one, other;
} Golden;

static void RunModels(Trail* trail, int threads)
{
    trail->count = 0;
    RunModel(trail, "boulder", false, threads);
    RunModel(trail, "house", true, threads);
    RunSurface(trail, "hangar", threads);
    RunSurface(trail, "sheet", threads);
}

static void stages_give_the_committed_bytes(void** state)
{
    Golden* golden = *state;
    RunModels(&golden->one, 1);
    if (golden->update) {
        assert_true(Trail_Write(&golden->one, golden->path));
    }
    assert_true(Trail_Read(&golden->expected, golden->path));
    assert_int_equal(Trail_Compare(&golden->expected, &golden->one, "one thread"), 0);
}

static void stages_give_the_same_bytes_on_two_threads_and_four(void** state)
{
    Golden* golden = *state;
    RunModels(&golden->other, 2);
    assert_int_equal(Trail_Compare(&golden->one, &golden->other, "two threads"), 0);
    RunModels(&golden->other, 4);
    assert_int_equal(Trail_Compare(&golden->one, &golden->other, "four threads"), 0);
}

int main(int argc, char** argv)
{
    if (argc < 2) {
        (void)fprintf(stderr, "usage: test_golden HASHES [--update]\n");
        return 1;
    }
    static Golden golden;
    golden.path = argv[1];
    golden.update = argc > 2 && strcmp(argv[2], "--update") == 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(stages_give_the_committed_bytes, &golden),
        cmocka_unit_test_prestate(stages_give_the_same_bytes_on_two_threads_and_four, &golden),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
