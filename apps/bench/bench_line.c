// SPDX-License-Identifier: MIT
// What the subcommands share: options for occluders, and the grid that they lie in.
#include "bench.h"

#include <math.h>

#define FIELD(kindName, field) .kind = (kindName), .offset = offsetof(pvtBenchLine, field)

const pvtOption pvtBenchOptionTable[] = {
    {.name = "budget",
     FIELD(PVT_OPTION_INT, budget),
     .placeholder = "N",
     .least = 1,
     .most = 65535,
     .help = "most triangles of an occluder"},
    {.name = "resolution",
     FIELD(PVT_OPTION_INT, resolution),
     .placeholder = "N",
     .least = 8,
     .most = 2048,
     .help = "voxels along the longest side"},
    {.name = "tolerance",
     FIELD(PVT_OPTION_LENGTH, tolerance),
     .placeholder = "T",
     .most = 1e30,
     .help = "as of paravent generate"},
};

_Static_assert(sizeof pvtBenchOptionTable / sizeof *pvtBenchOptionTable == PVT_BENCH_OPTION_COUNT,
               "the count in bench.h follows the table");

pvtBuildOptions pvtGetBenchBuildOptions(const pvtBenchLine* line, pvtMethod method)
{
    const pvtViewList none = {0};
    pvtBuildOptions options = pvtGetBuildOptions(line, &none);
    options.method = method;
    return options;
}

static double ToWorld(pvtLength length, double voxelSize)
{
    return length.inVoxels ? length.value * voxelSize : length.value;
}

static pvtStatus FillAllowed(pvtRun* run, const pvtSolidOptions* options, double tolerance,
                             const pvtBitGrid* surface, pvtBitGrid* allowed)
{
    pvtSolid solid;
    pvtStatus status = pvtFillSolid(run->context, options, surface, &solid);
    if (status == PVT_OK) {
        status = pvtMakeAllowedGrid(run->context, &solid, tolerance, allowed);
        pvtSolid_Free(run->context, &solid);
    }
    return status;
}

pvtStatus pvtMakeBenchGrid(pvtRun* run, const pvtBenchLine* line, int resolution,
                           const pvtMesh* mesh, pvtBitGrid* allowed)
{
    *allowed = (pvtBitGrid){0};
    const pvtBox3 bounds = pvtMesh_GetBounds(mesh);
    const double longest =
        fmax(bounds.upper.x - bounds.lower.x,
             fmax(bounds.upper.y - bounds.lower.y, bounds.upper.z - bounds.lower.z));
    const double tolerance = ToWorld(line->tolerance, longest / resolution);
    pvtSolidOptions solid = pvtDefaultSolidOptions();
    solid.smallestHole = ToWorld(line->smallestHole, longest / resolution);
    solid.ground = line->ground;
    solid.terrain = line->terrain;
    solid.up = (pvtAxis)line->up;
    solid.enclosed = line->enclosed;
    pvtVoxelizeOptions voxelize = pvtDefaultVoxelizeOptions();
    voxelize.resolution = resolution;
    voxelize.padding = fmax(solid.smallestHole, tolerance);
    pvtBitGrid surface;
    pvtStatus status = pvtVoxelizeMesh(run->context, &voxelize, mesh, &surface);
    if (status == PVT_OK) {
        status = FillAllowed(run, &solid, tolerance, &surface, allowed);
        pvtBitGrid_Free(run->context, &surface);
    }
    return status;
}
