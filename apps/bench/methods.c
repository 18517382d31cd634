// SPDX-License-Identifier: MIT
// What paravent is compared with, at the same budget: meshoptimizer's edge collapses and its vertex
// clustering, which aim at other things than occlusion; and all voxels that may be covered, which
// no occluder within them can surpass.
#include "bench.h"

#include <meshoptimizer.h>
#include <stdlib.h>

// The error that a simplification may reach: none is too large, the budget decides.
static const float ANY_ERROR = 1e9f;

static pvtStatus Build(pvtRun* run, const pvtBuildOptions* options, const pvtMesh* model,
                       pvtMesh* mesh)
{
    pvtOccluder occluder;
    const pvtStatus status = pvtBuildOccluder(run->context, options, model, &occluder, NULL);
    if (status == PVT_OK) {
        *mesh = occluder.mesh;
        occluder.mesh = (pvtMesh){0};
        pvtOccluder_Free(run->context, &occluder);
    }
    return status;
}

static pvtStatus BuildPlanar(pvtRun* run, const pvtBenchLine* line, const pvtMesh* model,
                             pvtMesh* mesh)
{
    const pvtBuildOptions options = pvtGetBenchBuildOptions(line, PVT_METHOD_PLANAR);
    return Build(run, &options, model, mesh);
}

static pvtStatus BuildPaper(pvtRun* run, const pvtBenchLine* line, const pvtMesh* model,
                            pvtMesh* mesh)
{
    const pvtBuildOptions options = pvtGetBenchBuildOptions(line, PVT_METHOD_PAPER);
    return Build(run, &options, model, mesh);
}

static size_t Simplify(const pvtMesh* mesh, const float* points, size_t target, bool isSloppy,
                       uint32_t* indices)
{
    const size_t stride = 3 * sizeof *points, all = 3 * mesh->triangleCount;
    return isSloppy ? meshopt_simplifySloppy(indices, mesh->indices, all, points,
                                             mesh->positionCount, stride, target, ANY_ERROR, NULL)
                    : meshopt_simplify(indices, mesh->indices, all, points, mesh->positionCount,
                                       stride, target, ANY_ERROR, 0, NULL);
}

// Welded first, since meshoptimizer keeps the edges where positions are not shared.
static pvtStatus SimplifyWelded(pvtRun* run, const pvtBenchLine* line, const pvtMesh* welded,
                                bool isSloppy, pvtMesh* mesh)
{
    float* points = calloc(3 * welded->positionCount, sizeof *points);
    uint32_t* indices = calloc(3 * welded->triangleCount, sizeof *indices);
    pvtStatus status = PVT_OUT_OF_MEMORY;
    if (points != NULL && indices != NULL) {
        for (size_t i = 0; i < welded->positionCount; ++i) {
            points[3 * i] = (float)welded->positions[i].x;
            points[3 * i + 1] = (float)welded->positions[i].y;
            points[3 * i + 2] = (float)welded->positions[i].z;
        }
        const size_t corners =
            Simplify(welded, points, 3 * (size_t)line->budget, isSloppy, indices);
        status = pvtCreateMesh(run->context, welded->positions, welded->positionCount, indices,
                               corners / 3, mesh);
    }
    free(points);
    free(indices);
    return status;
}

static pvtStatus RunMeshoptimizer(pvtRun* run, const pvtBenchLine* line, const pvtMesh* model,
                                  bool isSloppy, pvtMesh* mesh)
{
    pvtMesh welded;
    pvtStatus status = pvtWeldMesh(run->context, model, &welded);
    if (status == PVT_OK) {
        status = SimplifyWelded(run, line, &welded, isSloppy, mesh);
        pvtMesh_Free(run->context, &welded);
    }
    return status;
}

static pvtStatus RunSimplify(pvtRun* run, const pvtBenchLine* line, const pvtMesh* model,
                             pvtMesh* mesh)
{
    return RunMeshoptimizer(run, line, model, false, mesh);
}

static pvtStatus RunSloppy(pvtRun* run, const pvtBenchLine* line, const pvtMesh* model,
                           pvtMesh* mesh)
{
    return RunMeshoptimizer(run, line, model, true, mesh);
}

static pvtStatus WrapVoxels(pvtRun* run, const pvtBenchLine* line, const pvtMesh* model,
                            pvtMesh* mesh)
{
    pvtBitGrid allowed;
    pvtStatus status = pvtMakeBenchGrid(run, line, line->resolution, model, &allowed);
    if (status == PVT_OK) {
        status = pvtBuildVoxelMesh(run->context, &allowed, mesh);
        pvtBitGrid_Free(run->context, &allowed);
    }
    return status;
}

const pvtBenchMethod pvtBenchMethods[PVT_BENCH_METHOD_COUNT] = {
    {"paravent", BuildPlanar},     {"paravent, paper's", BuildPaper},    {"simplify", RunSimplify},
    {"simplifySloppy", RunSloppy}, {"voxel mesh (ceiling)", WrapVoxels},
};
