// SPDX-License-Identifier: MIT
// The stencil's slices against a lookup of each cell's centre, and against the CPU slicer.
#include "stencil_check.h"
#include "voxel_shapes.h"

#include <limits.h>
#include <math.h>
#include <paravent/gl.h>
#include <string.h>

enum { MAX_VOXELS = 48 };

static const pvtGlBackend backends[] = {PVT_GL_EGL, PVT_GL_OSMESA};

typedef bool SolidFcn(double x, double y, double z);

static bool IsInSphere(double x, double y, double z)
{
    return x * x + y * y + z * z < 0.9 * 0.9;
}

static bool IsInTorus(double x, double y, double z)
{
    const double ring = sqrt(x * x + z * z) - 0.6;
    return ring * ring + y * y < 0.3 * 0.3;
}

// Waves: many pieces, tunnels and hollows.
static bool IsInWaves(double x, double y, double z)
{
    return sin(7 * x + 1) + sin(6 * y + 2 * z) + sin(8 * z) > 0.4 && IsInSphere(x, y, z);
}

// Every voxel by itself: corners and edges that meet, faces everywhere.
static bool IsInNoise(double x, double y, double z)
{
    pvtRandom random =
        pvtMakeRandom((uint64_t)((x + 2) * 1e4), (uint64_t)((y + 2) * 1e4 + 1e6 * (z + 2)));
    return pvtRandom_Below(&random, 3) == 0;
}

// A grid with three different sides, the solid up to its border.
static pvtBitGrid MakeGrid(pvtContext* context, SolidFcn* solid, const int size[3])
{
    pvtBitGrid grid;
    MakeEmptyGrid(context, size[0], size[1], size[2], &grid);
    grid.frame.origin = (pvtVec3){-3.0, 0.7, 12.0};
    grid.frame.voxelSize = 0.3;
    for (int z = 0; z < size[2]; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x) {
                if (solid((2 * x + 1.0) / size[0] - 1, (2 * y + 1.0) / size[1] - 1,
                          (2 * z + 1.0) / size[2] - 1)) {
                    SetVoxel(&grid, x, y, z);
                }
            }
        }
    }
    return grid;
}

static bool LookUpCell(const pvtBitGrid* grid, const pvtPlane* plane, int cellsPerVoxel, int i,
                       int j)
{
    const int64_t voxel = 2 * cellsPerVoxel * (INT64_C(1) << PVT_PLANE_BITS);
    const int64_t height = GetHeight(plane, cellsPerVoxel, i, j);
    if (height < 0) {
        return false;
    }
    int at[3];
    at[plane->axis] = (int)(height / voxel);
    at[pvtPlane_GetU(plane)] = i / cellsPerVoxel;
    at[pvtPlane_GetV(plane)] = j / cellsPerVoxel;
    return pvtBitGrid_Get(grid, at[0], at[1], at[2]);
}

// Cells counted over all checks, so that the share of mismatches can be judged too.
typedef struct Tally {
    uint64_t cells, set, mismatches;
} Tally;

static void CompareSlice(const pvtBitGrid* grid, const pvtPlane* plane, int cellsPerVoxel,
                         const pvtBitmap* slice, Tally* tally)
{
    for (int j = 0; j < slice->height; ++j) {
        for (int i = 0; i < slice->width; ++i) {
            const bool expected = LookUpCell(grid, plane, cellsPerVoxel, i, j);
            ++tally->cells;
            tally->set += expected;
            if (pvtBitmap_Get(slice, i, j) != expected) {
                ++tally->mismatches;
                if (!IsNextToFace(plane, cellsPerVoxel, i, j)) {
                    fail_msg("axis %d, slopes %d %d, offset %lld, %d cells a voxel: cell (%d, %d) "
                             "should be %d",
                             (int)plane->axis, plane->slopeU, plane->slopeV,
                             (long long)plane->offset, cellsPerVoxel, i, j, expected);
                }
            }
        }
    }
}

static void SliceAndCompare(pvtContext* context, const pvtSlicer* slicer, const pvtBitGrid* grid,
                            const pvtPlane* plane, Tally* tally)
{
    for (int cells = 1; cells <= 4; cells *= 2) {
        pvtBitmap slice;
        CHECK_OK(context, pvtCreateBitmap(context, grid->frame.size[pvtPlane_GetU(plane)] * cells,
                                          grid->frame.size[pvtPlane_GetV(plane)] * cells, &slice));
        CHECK_OK(context, slicer->slice(context, slicer->user, plane, cells, &slice));
        CompareSlice(grid, plane, cells, &slice, tally);
        pvtBitmap_Free(context, &slice);
    }
}

// Planned planes through the middle half of the grid, and a few of special slopes.
static pvtPlane MakeTestPlane(const pvtGridFrame* frame, pvtRandom* random, int index)
{
    if (index < 9) {
        // Level, diagonal, and steepest, each axis.
        const int32_t one = 1 << PVT_PLANE_BITS;
        const int32_t slopes[3][2] = {{0, 0}, {one, 0}, {one, -one}};
        const int32_t u = slopes[index / 3][0], v = slopes[index / 3][1];
        return (pvtPlane){(pvtAxis)(index % 3), u, v, (int64_t)9 * one + 1};
    }
    double values[6];
    for (int i = 0; i < 3; ++i) {
        values[i] = pvtRandom_Unit(random) - 0.5;
        values[3 + i] = (0.25 + 0.5 * pvtRandom_Unit(random)) * frame->size[i] * frame->voxelSize;
    }
    const pvtVec3 point = {frame->origin.x + values[3], frame->origin.y + values[4],
                           frame->origin.z + values[5]};
    return pvtMakePlane(frame, (pvtVec3){values[0], values[1], values[2]}, point);
}

static void CheckSolid(pvtContext* context, pvtGl* gl, SolidFcn* solid, Tally* tally)
{
    const int size[3] = {MAX_VOXELS, 31, 40};
    pvtBitGrid grid = MakeGrid(context, solid, size);
    pvtMesh mesh;
    CHECK_OK(context, pvtBuildVoxelMesh(context, &grid, &mesh));
    pvtSlicer slicer;
    CHECK_OK(context, pvtCreateStencilSlicer(context, gl, &grid.frame, &mesh, &slicer));
    pvtRandom random = pvtMakeRandom(7, 0);
    for (int i = 0; i < 21; ++i) {
        const pvtPlane plane = MakeTestPlane(&grid.frame, &random, i);
        SliceAndCompare(context, &slicer, &grid, &plane, tally);
    }
    pvtReleaseStencilSlicer(context, &slicer);
    pvtMesh_Free(context, &mesh);
    pvtBitGrid_Free(context, &grid);
}

static void a_slice_holds_the_cells_whose_centres_are_inside(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    SolidFcn* const solids[] = {IsInSphere, IsInTorus, IsInWaves, IsInNoise};
    for (size_t b = 0; b < 2; ++b) {
        pvtGl* gl = NULL;
        CHECK_OK(context, pvtOpenGl(context, backends[b], &gl));
        Tally tally = {0};
        for (size_t s = 0; s < sizeof solids / sizeof solids[0]; ++s) {
            CheckSolid(context, gl, solids[s], &tally);
        }
        print_message("%s: %llu of %llu cells differ\n", pvtGl_GetName(gl),
                      (unsigned long long)tally.mismatches, (unsigned long long)tally.cells);
        assert_true(tally.set > tally.cells / 10);
        assert_true(tally.mismatches <= tally.cells / 10000);
        pvtCloseGl(context, gl);
    }
    DestroyTestContext(context);
}

// The slicers of a test: one on each backend, and the CPU's.
static void CompareWithCpu(pvtContext* context, const pvtBitGrid* grid, const pvtSlicer slicers[2])
{
    pvtSliceVolume volume;
    CHECK_OK(context, pvtCreateSliceVolume(context, grid, &volume));
    pvtRandom random = pvtMakeRandom(11, 0);
    for (int i = 9; i < 30; ++i) {
        const pvtPlane plane = MakeTestPlane(&grid->frame, &random, i);
        const int width = grid->frame.size[pvtPlane_GetU(&plane)] * 2;
        const int height = grid->frame.size[pvtPlane_GetV(&plane)] * 2;
        pvtBitmap cpu, gpu[2];
        CHECK_OK(context, pvtCreateBitmap(context, width, height, &cpu));
        pvtSliceGrid(&volume, &plane, PVT_SLICE_CENTER, 2, &cpu);
        for (int b = 0; b < 2; ++b) {
            CHECK_OK(context, pvtCreateBitmap(context, width, height, &gpu[b]));
            CHECK_OK(context, slicers[b].slice(context, slicers[b].user, &plane, 2, &gpu[b]));
        }
        for (int cell = 0; cell < width * height; ++cell) {
            const int x = cell % width, y = cell / width;
            const bool expected = pvtBitmap_Get(&cpu, x, y);
            if ((pvtBitmap_Get(&gpu[0], x, y) != expected ||
                 pvtBitmap_Get(&gpu[1], x, y) != expected) &&
                !IsNextToFace(&plane, 2, x, y)) {
                fail_msg("plane %d: cell (%d, %d) should be %d", i, x, y, expected);
            }
        }
        pvtBitmap_Free(context, &cpu);
        pvtBitmap_Free(context, &gpu[0]);
        pvtBitmap_Free(context, &gpu[1]);
    }
    pvtSliceVolume_Free(context, &volume);
}

static void three_slicers_agree(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    const int size[3] = {37, MAX_VOXELS, 33};
    pvtBitGrid grid = MakeGrid(context, IsInWaves, size);
    pvtMesh mesh;
    CHECK_OK(context, pvtBuildVoxelMesh(context, &grid, &mesh));
    pvtGl* gls[2];
    pvtSlicer slicers[2];
    for (int b = 0; b < 2; ++b) {
        CHECK_OK(context, pvtOpenGl(context, backends[b], &gls[b]));
        CHECK_OK(context, pvtCreateStencilSlicer(context, gls[b], &grid.frame, &mesh, &slicers[b]));
    }
    CompareWithCpu(context, &grid, slicers);
    for (int b = 0; b < 2; ++b) {
        pvtReleaseStencilSlicer(context, &slicers[b]);
        pvtCloseGl(context, gls[b]);
    }
    pvtMesh_Free(context, &mesh);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void a_plane_past_the_grid_slices_nothing(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    const int size[3] = {16, 16, 16};
    pvtBitGrid grid = MakeGrid(context, IsInNoise, size);
    pvtMesh mesh;
    CHECK_OK(context, pvtBuildVoxelMesh(context, &grid, &mesh));
    pvtSlicer slicer;
    CHECK_OK(context, pvtCreateStencilSlicer(context, gl, &grid.frame, &mesh, &slicer));
    pvtBitmap slice;
    CHECK_OK(context, pvtCreateBitmap(context, 16, 16, &slice));
    // The last two would come out in the middle of the grid if they were cut to 32 bits.
    const int64_t middle = (INT64_C(17) << PVT_PLANE_BITS) / 2 + 1;
    const int64_t offsets[] = {-1, (INT64_C(16) << PVT_PLANE_BITS) + 1, middle - (INT64_C(1) << 52),
                               middle + (INT64_C(1) << 52)};
    for (int i = 0; i < 12; ++i) {
        memset(slice.words, 0xff, slice.wordsPerRow * 16 * sizeof *slice.words);
        const pvtPlane plane = {(pvtAxis)(i % 3), 0, 0, offsets[i / 3]};
        CHECK_OK(context, slicer.slice(context, slicer.user, &plane, 1, &slice));
        assert_int_equal(pvtBitmap_Count(&slice), 0);
    }
    pvtBitmap_Free(context, &slice);
    pvtReleaseStencilSlicer(context, &slicer);
    pvtMesh_Free(context, &mesh);
    pvtBitGrid_Free(context, &grid);
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void a_mesh_that_is_not_of_the_grid_is_refused(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    const pvtGridFrame frame = {{0, 0, 0}, 1.0, {8, 8, 8}};
    const pvtVec3 wrong[] = {{0.5, 1, 1}, {-1, 0, 0}, {0, 9, 0}, {0, 0, NAN}};
    for (size_t i = 0; i < 4; ++i) {
        pvtVec3 positions[3] = {{0, 0, 0}, {1, 0, 0}, wrong[i]};
        uint32_t indices[3] = {0, 1, 2};
        const pvtMesh mesh = {positions, indices, 3, 1};
        pvtSlicer slicer;
        assert_int_equal(pvtCreateStencilSlicer(context, gl, &frame, &mesh, &slicer),
                         PVT_INVALID_ARGUMENT);
        assert_non_null(strstr(pvtContext_GetMessage(context), "position 2"));
        pvtReleaseStencilSlicer(context, &slicer); // empty, so that this is safe
    }
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

// One voxel, sliced through its middle.
static pvtStatus SliceOneVoxel(pvtContext* context, pvtGl* gl)
{
    const pvtGridFrame frame = {{0, 0, 0}, 1.0, {3, 3, 3}};
    pvtVec3 positions[8];
    for (int i = 0; i < 8; ++i) {
        positions[i] = (pvtVec3){i & 1 ? 2 : 1, i & 2 ? 2 : 1, i & 4 ? 2 : 1};
    }
    uint32_t indices[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    const pvtMesh mesh = {positions, indices, 8, 12};
    pvtSlicer slicer;
    pvtStatus status = pvtCreateStencilSlicer(context, gl, &frame, &mesh, &slicer);
    if (status == PVT_OK) {
        uint64_t rows[3] = {0};
        pvtBitmap slice = {rows, 3, 3, 1};
        const pvtPlane plane = {PVT_AXIS_Y, 0, 0, (INT64_C(3) << PVT_PLANE_BITS) / 2};
        status = slicer.slice(context, slicer.user, &plane, 1, &slice);
        assert_true(rows[0] == 0 && rows[2] == 0 && rows[1] == (status == PVT_OK ? 2 : 0));
    }
    pvtReleaseStencilSlicer(context, &slicer);
    return status;
}

static void a_refused_allocation_leaks_nothing(void** state)
{
    (void)state;
    PoorHeap heap = {.failAt = INT_MAX, .failsOnce = true};
    pvtContext* context = CreatePoorContext(&heap);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    const size_t held = pvtContext_GetHeldBytes(context);
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int refused = 0; status != PVT_OK; ++refused) {
        atomic_store(&heap.requests, 0);
        heap.failAt = refused;
        status = SliceOneVoxel(context, gl);
        heap.failAt = INT_MAX;
        assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
        assert_true(refused < 20 && (refused > 0 || status == PVT_OUT_OF_MEMORY));
        assert_int_equal(pvtContext_GetHeldBytes(context), held);
    }
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

static void a_cancelled_slicer_stops(void** state)
{
    (void)state;
    CancelCounter counter = {0};
    pvtContext* context = CreateCancelledContext(&counter, 1);
    pvtGl* gl = NULL;
    CHECK_OK(context, pvtOpenGl(context, PVT_GL_AUTO, &gl));
    // When the slicer is made, and when it slices.
    for (int later = 0; later < 2; ++later) {
        atomic_store(&counter.left, later);
        assert_int_equal(SliceOneVoxel(context, gl), PVT_CANCELLED);
    }
    atomic_store(&counter.left, 2);
    CHECK_OK(context, SliceOneVoxel(context, gl));
    pvtCloseGl(context, gl);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_slice_holds_the_cells_whose_centres_are_inside),
        cmocka_unit_test(three_slicers_agree),
        cmocka_unit_test(a_plane_past_the_grid_slices_nothing),
        cmocka_unit_test(a_mesh_that_is_not_of_the_grid_is_refused),
        cmocka_unit_test(a_refused_allocation_leaks_nothing),
        cmocka_unit_test(a_cancelled_slicer_stops),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
