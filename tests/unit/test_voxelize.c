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
    static const double scales[] = {1.0, 1e-20, 1e15};
    static const double offsets[] = {0.0, 0.0, 1e16};
    for (int round = 0; round < 3; ++round) {
        pvtVec3 corners[3 * 20];
        for (int i = 0; i < 3 * 20; ++i) {
            const pvtVec3 p = MakePoint(&random);
            // The box is 1 × 0.3 × 0.01: flat voxels along one axis, slivers along another.
            corners[i] = (pvtVec3){p.x * scales[round] + offsets[round], 0.3 * p.y * scales[round],
                                   0.01 * p.z * scales[round]};
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marks_exactly_the_voxels_that_integer_separating_axes_find),
        cmocka_unit_test(every_sampled_point_lies_in_a_marked_voxel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
