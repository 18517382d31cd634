// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

// A triangle or a voxel's corner in whole lattice units, so that products are exact.
typedef struct LatticePoint {
    int64_t c[3];
} LatticePoint;

static LatticePoint CrossLattice(LatticePoint a, LatticePoint b)
{
    return (LatticePoint){{a.c[1] * b.c[2] - a.c[2] * b.c[1], a.c[2] * b.c[0] - a.c[0] * b.c[2],
                           a.c[0] * b.c[1] - a.c[1] * b.c[0]}};
}

static LatticePoint SubLattice(LatticePoint a, LatticePoint b)
{
    return (LatticePoint){{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}

static int64_t DotLattice(LatticePoint a, LatticePoint b)
{
    return a.c[0] * b.c[0] + a.c[1] * b.c[1] + a.c[2] * b.c[2];
}

// True when the projections on `axis` do not even touch.
static bool IsSeparating(LatticePoint axis, const LatticePoint t[3], LatticePoint lower,
                         int64_t side)
{
    int64_t low = INT64_MAX;
    int64_t high = INT64_MIN;
    for (int i = 0; i < 3; ++i) {
        const int64_t dot = DotLattice(axis, t[i]);
        low = dot < low ? dot : low;
        high = dot > high ? dot : high;
    }
    int64_t boxLow = DotLattice(axis, lower);
    int64_t boxHigh = boxLow;
    for (int i = 0; i < 3; ++i) {
        boxLow += axis.c[i] < 0 ? axis.c[i] * side : 0;
        boxHigh += axis.c[i] > 0 ? axis.c[i] * side : 0;
    }
    return high < boxLow || low > boxHigh;
}

// Separating axes: two convex sets touch unless one of these 13 axes, and for degenerate
// triangles the normals of the edges within a common plane, keeps them apart.
static bool Touches(const LatticePoint t[3], LatticePoint lower, int64_t side)
{
    const LatticePoint unit[3] = {{{1, 0, 0}}, {{0, 1, 0}}, {{0, 0, 1}}};
    const LatticePoint edge[3] = {SubLattice(t[1], t[0]), SubLattice(t[2], t[1]),
                                  SubLattice(t[0], t[2])};
    if (IsSeparating(CrossLattice(edge[0], edge[1]), t, lower, side)) {
        return false;
    }
    for (int i = 0; i < 3; ++i) {
        if (IsSeparating(unit[i], t, lower, side)) {
            return false;
        }
        for (int j = 0; j < 3; ++j) {
            if (IsSeparating(CrossLattice(unit[i], edge[j]), t, lower, side)) {
                return false;
            }
        }
    }
    return true;
}

enum { UNITS_A_VOXEL = 16 };

static LatticePoint ToLattice(const pvtGridFrame* frame, pvtVec3 p)
{
    const double scale = UNITS_A_VOXEL / frame->voxelSize;
    const double c[3] = {(p.x - frame->origin.x) * scale, (p.y - frame->origin.y) * scale,
                         (p.z - frame->origin.z) * scale};
    LatticePoint lattice;
    for (int i = 0; i < 3; ++i) {
        lattice.c[i] = (int64_t)c[i];
        assert_true((double)lattice.c[i] == c[i]);
    }
    return lattice;
}

static void CheckAgainstSeparatingAxes(const pvtMesh* mesh, const pvtBitGrid* surface)
{
    const int* size = surface->frame.size;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x) {
                const LatticePoint lower = {
                    {x * UNITS_A_VOXEL, y * UNITS_A_VOXEL, z * UNITS_A_VOXEL}};
                bool touched = false;
                for (size_t i = 0; i < mesh->triangleCount && !touched; ++i) {
                    LatticePoint t[3];
                    for (int j = 0; j < 3; ++j) {
                        t[j] = ToLattice(&surface->frame,
                                         mesh->positions[mesh->indices[3 * i + (size_t)j]]);
                    }
                    touched = Touches(t, lower, UNITS_A_VOXEL);
                }
                assert_int_equal(pvtBitGrid_Get(surface, x, y, z), touched);
            }
        }
    }
}

// Lattice coordinates snap to a coarser lattice now and then, so that corners, edges and whole
// triangles lie in the planes between voxels, and triangles degenerate.
static pvtVec3 MakeLatticePoint(pvtRandom* random, uint32_t range, uint32_t snap)
{
    const uint32_t steps = range / snap + 1;
    return (pvtVec3){(double)(pvtRandom_Below(random, steps) * snap),
                     (double)(pvtRandom_Below(random, steps) * snap),
                     (double)(pvtRandom_Below(random, steps) * snap)};
}

static void marks_exactly_the_voxels_that_integer_separating_axes_find(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtRandom random = pvtMakeRandom(2, 0);
    static const uint32_t ranges[] = {8, 20, 60, 150};
    static const uint32_t snaps[] = {1, 2, 4, 8};
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.voxelSize = 8.0; // 16 lattice units: the frame lies on halves
    for (int round = 0; round < 600; ++round) {
        pvtVec3 corners[3];
        const uint32_t range = ranges[round % 4];
        const uint32_t snap = snaps[round / 4 % 4];
        for (int i = 0; i < 3; ++i) {
            corners[i] = MakeLatticePoint(&random, range, snap);
        }
        pvtMesh mesh;
        CHECK_OK(context, pvtCreateMesh(context, corners, 3, NULL, 1, &mesh));
        pvtBitGrid surface;
        if (memcmp(&corners[0], &corners[1], sizeof corners[0]) != 0) {
            CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
            CheckAgainstSeparatingAxes(&mesh, &surface);
            pvtBitGrid_Free(context, &surface);
        }
        pvtMesh_Free(context, &mesh);
    }
    DestroyTestContext(context);
}

static pvtVec3 MakePoint(pvtRandom* random)
{
    return (pvtVec3){pvtRandom_Unit(random), pvtRandom_Unit(random), pvtRandom_Unit(random)};
}

// Every sampled point of every triangle lies in a marked voxel.
static void CheckSamples(const pvtMesh* mesh, const pvtBitGrid* surface, int steps)
{
    const pvtGridFrame* frame = &surface->frame;
    for (size_t i = 0; i < mesh->triangleCount; ++i) {
        const pvtVec3 a = mesh->positions[mesh->indices[3 * i]];
        const pvtVec3 b = mesh->positions[mesh->indices[3 * i + 1]];
        const pvtVec3 c = mesh->positions[mesh->indices[3 * i + 2]];
        for (int j = 0; j <= steps * steps; ++j) {
            const double u = (double)(j % steps) / steps;
            const double v = (1.0 - u) * (double)(j / steps) / steps;
            const double w = 1.0 - u - v;
            const double x = a.x * w + b.x * u + c.x * v;
            const double y = a.y * w + b.y * u + c.y * v;
            const double z = a.z * w + b.z * u + c.z * v;
            assert_true(pvtBitGrid_Get(surface, (int)((x - frame->origin.x) / frame->voxelSize),
                                       (int)((y - frame->origin.y) / frame->voxelSize),
                                       (int)((z - frame->origin.z) / frame->voxelSize)));
        }
    }
}

static void every_sampled_point_lies_in_a_marked_voxel(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtRandom random = pvtMakeRandom(3, 0);
    static const double scales[] = {1.0, 1e-20, 1e15, 1.0};
    static const double offsets[] = {0.0, 0.0, 1e16, 1e7};
    for (int round = 0; round < 4; ++round) {
        pvtVec3 corners[3 * 20];
        for (int i = 0; i < 3 * 20; ++i) {
            const pvtVec3 p = MakePoint(&random);
            // The box is 1 × 0.3 × 0.00001, less than a voxel along z.
            corners[i] = (pvtVec3){p.x * scales[round] + offsets[round], 0.3 * p.y * scales[round],
                                   1e-5 * p.z * scales[round]};
        }
        pvtMesh mesh;
        CHECK_OK(context, pvtCreateMesh(context, corners, 60, NULL, 20, &mesh));
        pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
        options.resolution = 90;
        pvtBitGrid surface;
        CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
        CheckSamples(&mesh, &surface, 200);
        pvtBitGrid_Free(context, &surface);
        pvtMesh_Free(context, &mesh);
    }
    DestroyTestContext(context);
}

static void MakeTriangle(pvtContext* context, pvtVec3 a, pvtVec3 b, pvtVec3 c, pvtMesh* mesh)
{
    const pvtVec3 corners[3] = {a, b, c};
    CHECK_OK(context, pvtCreateMesh(context, corners, 3, NULL, 1, mesh));
}

static pvtStatus VoxelizeTriangle(pvtContext* context, pvtVec3 a, pvtVec3 b, pvtVec3 c,
                                  pvtBitGrid* surface)
{
    pvtMesh mesh;
    MakeTriangle(context, a, b, c, &mesh);
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 40;
    const pvtStatus status = pvtVoxelizeMesh(context, &options, &mesh, surface);
    pvtMesh_Free(context, &mesh);
    return status;
}

// The bounds of the surface, and at least two free voxels beyond them on every side.
static void CheckPadding(const pvtBitGrid* surface, const int padding[3], const int touched[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        int first = surface->frame.size[axis];
        int last = -1;
        for (int z = 0; z < surface->frame.size[2]; ++z) {
            for (int y = 0; y < surface->frame.size[1]; ++y) {
                for (int x = 0; x < surface->frame.size[0]; ++x) {
                    const int at = axis == 0 ? x : axis == 1 ? y : z;
                    if (pvtBitGrid_Get(surface, x, y, z)) {
                        first = at < first ? at : first;
                        last = at > last ? at : last;
                    }
                }
            }
        }
        assert_int_equal(first, padding[axis]);
        assert_int_equal(surface->frame.size[axis] - 1 - last, padding[axis]);
        assert_int_equal(last - first + 1, touched[axis]);
    }
}

static void bounds_lie_in_the_middle_with_free_voxels_around(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    MakeBoxMesh(context, (pvtVec3){-3.0, 5.0, 7.0}, (pvtVec3){7.0, 7.5, 8.3}, &mesh);
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 20; // voxels of 0.5: 20 × 5 × 2.6 of them
    pvtBitGrid surface;
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
    assert_true(surface.frame.voxelSize == 0.5);
    // The faces of a side of n voxels lie in the middle of voxels, n − 1 whole ones between them.
    CheckPadding(&surface, (int[3]){2, 2, 2}, (int[3]){21, 6, 4});
    for (int axis = 0; axis < 3; ++axis) {
        const double center = axis == 0 ? 2.0 : axis == 1 ? 6.25 : 7.65;
        const double origin = axis == 0   ? surface.frame.origin.x
                              : axis == 1 ? surface.frame.origin.y
                                          : surface.frame.origin.z;
        // An eighth of a voxel off the middle.
        assert_true(fabs(origin + 0.25 * surface.frame.size[axis] + 0.0625 - center) < 1e-12);
    }
    pvtBitGrid_Free(context, &surface);
    options.padding = 1.7; // four voxels
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
    CheckPadding(&surface, (int[3]){4, 4, 4}, (int[3]){21, 6, 4});
    pvtBitGrid_Free(context, &surface);
    options.voxelSize = 5.0;
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
    CheckPadding(&surface, (int[3]){2, 2, 2}, (int[3]){3, 1, 1});
    pvtBitGrid_Free(context, &surface);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void flat_meshes_segments_and_specks_are_voxelized(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid surface;
    // A triangle in a plane, and a segment along an axis; neither has an extent along the others.
    CHECK_OK(context, VoxelizeTriangle(context, (pvtVec3){0.0, 3.0, 0.0}, (pvtVec3){1.0, 3.0, 0.0},
                                       (pvtVec3){0.0, 3.0, 1.0}, &surface));
    assert_int_equal(surface.frame.size[1], 5);
    assert_true(pvtBitGrid_Count(&surface) > 40 * 40 / 2);
    pvtBitGrid_Free(context, &surface);
    CHECK_OK(context, VoxelizeTriangle(context, (pvtVec3){0.0, 3.0, 1.0}, (pvtVec3){0.0, 3.0, 0.0},
                                       (pvtVec3){0.0, 3.0, 0.5}, &surface));
    assert_int_equal(pvtBitGrid_Count(&surface), 41);
    pvtBitGrid_Free(context, &surface);
    // A speck of no extent beside a triangle still counts.
    const pvtVec3 corners[6] = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0},
                                {0.9, 0.9, 0.9}, {0.9, 0.9, 0.9}, {0.9, 0.9, 0.9}};
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateMesh(context, corners, 6, NULL, 2, &mesh));
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 10;
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
    CheckSamples(&mesh, &surface, 20);
    pvtBitGrid_Free(context, &surface);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void meshes_without_extent_or_beyond_numbers_are_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid surface;
    const pvtVec3 p = {1.0, 2.0, 3.0};
    assert_int_equal(VoxelizeTriangle(context, p, p, p, &surface), PVT_INVALID_INPUT);
    assert_null(surface.words);
    assert_int_equal(VoxelizeTriangle(context, (pvtVec3){-1e308, 0.0, 0.0},
                                      (pvtVec3){1e308, 0.0, 0.0}, p, &surface),
                     PVT_INVALID_INPUT);
    assert_int_equal(VoxelizeTriangle(context, (pvtVec3){0.0, 0.0, 0.0},
                                      (pvtVec3){1e-310, 0.0, 0.0}, (pvtVec3){0.0, 0.0, 0.0},
                                      &surface),
                     PVT_INVALID_INPUT);
    assert_int_equal(VoxelizeTriangle(context, (pvtVec3){1e16, 0.0, 0.0},
                                      (pvtVec3){1e16 + 8.0, 0.0, 0.0}, (pvtVec3){1e16, 1.0, 0.0},
                                      &surface),
                     PVT_INVALID_INPUT);
    assert_non_null(strstr(pvtContext_GetMessage(context), "origin"));
    const pvtMesh none = {0};
    const pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    assert_int_equal(pvtVoxelizeMesh(context, &options, &none, &surface), PVT_INVALID_INPUT);
    DestroyTestContext(context);
}

static void options_out_of_range_are_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    MakeBoxMesh(context, (pvtVec3){0.0, 0.0, 0.0}, (pvtVec3){1.0, 1.0, 1.0}, &mesh);
    const pvtVoxelizeOptions good = pvtDefaultVoxelizeOptions();
    pvtVoxelizeOptions bad[6] = {good, good, good, good, good, good};
    bad[0].resolution = 7;
    bad[1].resolution = 2049;
    bad[2].voxelSize = -1.0;
    bad[3].voxelSize = NAN;
    bad[4].padding = -1.0;
    bad[5].padding = INFINITY;
    pvtBitGrid surface;
    for (int i = 0; i < 6; ++i) {
        assert_int_equal(pvtVoxelizeMesh(context, &bad[i], &mesh, &surface), PVT_INVALID_ARGUMENT);
        assert_null(surface.words);
    }
    pvtVoxelizeOptions fine = good;
    fine.voxelSize = 1.0 / 2100.0;
    assert_int_equal(pvtVoxelizeMesh(context, &fine, &mesh, &surface), PVT_LIMIT);
    pvtVoxelizeOptions wide = good;
    wide.padding = 1e9;
    assert_int_equal(pvtVoxelizeMesh(context, &wide, &mesh, &surface), PVT_LIMIT);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// The resolution that the message names must be one that fits.
static void the_memory_limit_names_a_resolution_that_fits(void** state)
{
    (void)state;
    pvtContextDef def = pvtDefaultContextDef();
    def.memoryLimit = 16 << 20;
    def.threadCount = 1;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    pvtMesh mesh;
    MakeBoxMesh(context, (pvtVec3){0.0, 0.0, 0.0}, (pvtVec3){1.0, 1.0, 1.0}, &mesh);
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 2048;
    pvtBitGrid surface;
    assert_int_equal(pvtVoxelizeMesh(context, &options, &mesh, &surface), PVT_LIMIT);
    const char* named = strstr(pvtContext_GetMessage(context), "a resolution of ");
    assert_non_null(named);
    options.resolution = atoi(named + strlen("a resolution of "));
    assert_in_range(options.resolution, 90, 300);
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
    const pvtSolidOptions solidOptions = pvtDefaultSolidOptions();
    pvtSolid solid;
    CHECK_OK(context, pvtFillSolid(context, &solidOptions, &surface, &solid));
    assert_true(pvtContext_GetPeakBytes(context) <= def.memoryLimit);
    pvtSolid_Free(context, &solid);
    pvtBitGrid_Free(context, &surface);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// A thin diagonal triangle at 2048 voxels touches some thousand voxels of eight billion.
static void large_triangles_mark_no_more_than_they_touch(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    MakeTriangle(context, (pvtVec3){0.0, 0.0, 0.0}, (pvtVec3){1.0, 1.0, 0.02},
                 (pvtVec3){0.9, 0.9, 0.0179}, &mesh);
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 2048;
    pvtBitGrid surface;
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &mesh, &surface));
    CheckSamples(&mesh, &surface, 300);
    // Each of the 2049 steps along the diagonal touches at most seven voxels and the rise.
    assert_in_range(pvtBitGrid_Count(&surface), 2 * 2048, 10 * 2049 + 60);
    pvtBitGrid_Free(context, &surface);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static void MakeSoup(pvtContext* context, int triangles, pvtMesh* mesh)
{
    pvtRandom random = pvtMakeRandom(11, 0);
    pvtVec3* corners = malloc((size_t)triangles * 3 * sizeof *corners);
    assert_non_null(corners);
    for (int i = 0; i < triangles; ++i) {
        const pvtVec3 center = MakePoint(&random);
        const double size = i % 10 == 0 ? 1.0 : 0.05;
        for (int j = 0; j < 3; ++j) {
            const pvtVec3 p = MakePoint(&random);
            corners[3 * i + j] =
                (pvtVec3){center.x + size * p.x, center.y + size * p.y, center.z + size * p.z};
        }
    }
    CHECK_OK(context,
             pvtCreateMesh(context, corners, 3 * (size_t)triangles, NULL, (size_t)triangles, mesh));
    free(corners);
}

typedef struct Results {
    pvtSolid solid;
    pvtBitGrid allowed;
    pvtMesh mesh;
} Results;

static pvtStatus RunAll(pvtContext* context, Results* results)
{
    *results = (Results){0};
    pvtMesh soup;
    MakeSoup(context, 300, &soup);
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 50;
    pvtBitGrid surface;
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &soup, &surface));
    pvtSolidOptions solidOptions = pvtDefaultSolidOptions();
    solidOptions.smallestHole = 3.0 * surface.frame.voxelSize;
    solidOptions.enclosed = 5;
    CHECK_OK(context, pvtFillSolid(context, &solidOptions, &surface, &results->solid));
    CHECK_OK(context, pvtMakeAllowedGrid(context, &results->solid, 2.0 * surface.frame.voxelSize,
                                         &results->allowed));
    CHECK_OK(context, pvtBuildVoxelMesh(context, &results->solid.inside, &results->mesh));
    pvtBitGrid_Free(context, &surface);
    pvtMesh_Free(context, &soup);
    return PVT_OK;
}

static void FreeResults(pvtContext* context, Results* results)
{
    pvtSolid_Free(context, &results->solid);
    pvtBitGrid_Free(context, &results->allowed);
    pvtMesh_Free(context, &results->mesh);
}

static void results_do_not_depend_on_the_number_of_threads(void** state)
{
    (void)state;
    pvtContext* first = CreateTestContext(1);
    Results expected;
    RunAll(first, &expected);
    for (int threads = 2; threads <= 4; threads += 2) {
        pvtContext* context = CreateTestContext(threads);
        Results results;
        RunAll(context, &results);
        assert_memory_equal(results.solid.surface.words, expected.solid.surface.words,
                            expected.solid.surface.wordCount * sizeof(uint64_t));
        assert_memory_equal(results.solid.inside.words, expected.solid.inside.words,
                            expected.solid.inside.wordCount * sizeof(uint64_t));
        assert_memory_equal(results.allowed.words, expected.allowed.words,
                            expected.allowed.wordCount * sizeof(uint64_t));
        assert_int_equal(results.mesh.positionCount, expected.mesh.positionCount);
        assert_int_equal(results.mesh.triangleCount, expected.mesh.triangleCount);
        assert_memory_equal(results.mesh.positions, expected.mesh.positions,
                            expected.mesh.positionCount * sizeof(pvtVec3));
        assert_memory_equal(results.mesh.indices, expected.mesh.indices,
                            3 * expected.mesh.triangleCount * sizeof(uint32_t));
        FreeResults(context, &results);
        DestroyTestContext(context);
    }
    FreeResults(first, &expected);
    DestroyTestContext(first);
}

static pvtStatus VoxelizeAndFree(pvtContext* context, const void* data)
{
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 60;
    pvtBitGrid surface;
    const pvtStatus status = pvtVoxelizeMesh(context, &options, data, &surface);
    assert_true(status == PVT_OK || surface.words == NULL);
    pvtBitGrid_Free(context, &surface);
    return status;
}

static pvtStatus FillEveryWay(pvtContext* context, const void* data)
{
    pvtSolidOptions options = pvtDefaultSolidOptions();
    options.smallestHole = 4.0 * ((const pvtBitGrid*)data)->frame.voxelSize;
    options.ground = true;
    options.terrain = true;
    options.enclosed = 3;
    pvtSolid solid;
    const pvtStatus status = pvtFillSolid(context, &options, data, &solid);
    assert_true(status == PVT_OK || (solid.inside.words == NULL && solid.surface.words == NULL));
    pvtSolid_Free(context, &solid);
    return status;
}

static pvtStatus GrowFarAndFree(pvtContext* context, const void* data)
{
    pvtSolid solid = {.inside = *(const pvtBitGrid*)data, .surface = *(const pvtBitGrid*)data};
    pvtBitGrid allowed;
    pvtStatus status = pvtMakeAllowedGrid(context, &solid, 30.0, &allowed);
    assert_true(status == PVT_OK || allowed.words == NULL);
    pvtBitGrid_Free(context, &allowed);
    if (status == PVT_OK) {
        status = pvtMakeAllowedGrid(context, &solid, 0.0, &allowed);
        pvtBitGrid_Free(context, &allowed);
    }
    return status;
}

static pvtStatus TransformAndFree(pvtContext* context, const void* data)
{
    const int* size = ((const pvtBitGrid*)data)->frame.size;
    uint32_t* distances = malloc((size_t)size[0] * (size_t)size[1] * (size_t)size[2] * 4);
    assert_non_null(distances);
    const pvtStatus status = pvtTransformGridDistance(context, data, 1000, distances);
    free(distances);
    return status;
}

static pvtStatus BuildMeshAndFree(pvtContext* context, const void* data)
{
    pvtMesh mesh;
    const pvtStatus status = pvtBuildVoxelMesh(context, data, &mesh);
    assert_true(status == PVT_OK || (mesh.positions == NULL && mesh.triangleCount == 0));
    pvtMesh_Free(context, &mesh);
    return status;
}

static void failing_allocations_and_cancelling_leave_nothing_behind(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh soup;
    MakeSoup(context, 300, &soup);
    CheckEveryAllocation(VoxelizeAndFree, &soup);
    CheckEveryCancel(VoxelizeAndFree, &soup);
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 40;
    pvtBitGrid surface;
    CHECK_OK(context, pvtVoxelizeMesh(context, &options, &soup, &surface));
    StageFcn* stages[] = {FillEveryWay, GrowFarAndFree, TransformAndFree, BuildMeshAndFree};
    for (int i = 0; i < 4; ++i) {
        CheckEveryAllocation(stages[i], &surface);
        CheckEveryCancel(stages[i], &surface);
    }
    pvtBitGrid_Free(context, &surface);
    pvtMesh_Free(context, &soup);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marks_exactly_the_voxels_that_integer_separating_axes_find),
        cmocka_unit_test(every_sampled_point_lies_in_a_marked_voxel),
        cmocka_unit_test(bounds_lie_in_the_middle_with_free_voxels_around),
        cmocka_unit_test(flat_meshes_segments_and_specks_are_voxelized),
        cmocka_unit_test(meshes_without_extent_or_beyond_numbers_are_refused),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(the_memory_limit_names_a_resolution_that_fits),
        cmocka_unit_test(large_triangles_mark_no_more_than_they_touch),
        cmocka_unit_test(results_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(failing_allocations_and_cancelling_leave_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
