// SPDX-License-Identifier: MIT
#include "check.h"
#include "failures.h"
#include "voxel_shapes.h"

#include "base/bits.h"
#include "base/vector.h"

#include <math.h>
#include <paravent/occluder.h>

// What may be covered of a mesh, by voxels and by cells.
typedef struct Inner {
    pvtSolid solid;
    pvtBitGrid allowed;
    pvtCellGrid cells;
} Inner;

static pvtStatus TryRefine(pvtContext* context, const pvtMesh* mesh, Inner* inner)
{
    *inner = (Inner){0};
    pvtVoxelizeOptions options = pvtDefaultVoxelizeOptions();
    options.resolution = 20;
    const pvtSolidOptions solid = pvtDefaultSolidOptions();
    pvtBitGrid surface;
    pvtStatus status = pvtVoxelizeMesh(context, &options, mesh, &surface);
    if (status == PVT_OK) {
        status = pvtFillSolid(context, &solid, &surface, &inner->solid);
    }
    if (status == PVT_OK) {
        status = pvtMakeAllowedGrid(context, &inner->solid, 0.0, &inner->allowed);
    }
    if (status == PVT_OK) {
        status = pvtRefineAllowedGrid(context, mesh, &inner->solid, &inner->allowed, &inner->cells);
    }
    pvtBitGrid_Free(context, &surface);
    return status;
}

static void FreeInner(pvtContext* context, Inner* inner)
{
    pvtSolid_Free(context, &inner->solid);
    pvtBitGrid_Free(context, &inner->allowed);
    pvtCellGrid_Free(context, &inner->cells);
}

static bool IsCellAllowed(const Inner* inner, int x, int y, int z)
{
    const uint64_t cells = pvtBitGrid_Get(&inner->allowed, x / 4, y / 4, z / 4)
                               ? ~UINT64_C(0)
                               : pvtCellGrid_Get(&inner->cells, x / 4, y / 4, z / 4);
    return (cells >> (x % 4 + 4 * (y % 4) + 16 * (z % 4)) & 1) != 0;
}

// How far a cell's nearest corner is inside the box, and its centre [cells].
static double GetDepth(const pvtGridFrame* frame, const int cell[3], const double lower[3],
                       const double upper[3], double reach)
{
    double depth = HUGE_VAL;
    for (int axis = 0; axis < 3; ++axis) {
        const double size = frame->voxelSize / 4.0;
        const double at = pvtGetAxis(frame->origin, axis) + (cell[axis] + 0.5) * size;
        depth = fmin(depth, fmin(at - lower[axis], upper[axis] - at) / size - reach);
    }
    return depth;
}

// Calls back for each cell of the grid; -1 stands for outside of the grid in no case.
typedef void CellFcn(const Inner* inner, const int cell[3], void* data);

static void ForEachCell(const Inner* inner, CellFcn* look, void* data)
{
    const int* size = inner->allowed.frame.size;
    for (int z = 0; z < 4 * size[2]; ++z) {
        for (int y = 0; y < 4 * size[1]; ++y) {
            for (int x = 0; x < 4 * size[0]; ++x) {
                look(inner, (int[3]){x, y, z}, data);
            }
        }
    }
}

static const double boxLower[3] = {0.13, -0.4, 2.0};
static const double boxUpper[3] = {1.17, 0.31, 2.57};

static void MakeTestBox(pvtContext* context, pvtMesh* mesh)
{
    MakeBoxMesh(context, (pvtVec3){boxLower[0], boxLower[1], boxLower[2]},
                (pvtVec3){boxUpper[0], boxUpper[1], boxUpper[2]}, mesh);
}

static void LookAtBoxCell(const Inner* inner, const int cell[3], void* data)
{
    (void)data;
    const double depth = GetDepth(&inner->allowed.frame, cell, boxLower, boxUpper, 0.5);
    const bool allowed = IsCellAllowed(inner, cell[0], cell[1], cell[2]);
    assert_true(depth > 0.0 || !allowed);
    assert_true(depth < 1e-6 || allowed);
}

static void cells_of_a_box_are_allowed_when_they_lie_within_it(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh mesh;
    MakeTestBox(context, &mesh);
    Inner inner;
    CHECK_OK(context, TryRefine(context, &mesh, &inner));
    assert_true(inner.cells.count > 100);
    ForEachCell(&inner, LookAtBoxCell, NULL);
    assert_true(pvtCellGrid_Get(&inner.cells, -1, 5, 5) == 0);
    assert_true(pvtCellGrid_Get(&inner.cells, 5, 5, inner.allowed.frame.size[2]) == 0);
    FreeInner(context, &inner);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

typedef struct BallLook {
    pvtVec3 center;
    double radius;
    uint64_t allowed;
} BallLook;

static void LookAtBallCell(const Inner* inner, const int cell[3], void* data)
{
    BallLook* look = data;
    const pvtGridFrame* frame = &inner->allowed.frame;
    const double size = frame->voxelSize / 4.0;
    double farthest = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const pvtVec3 step = {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1),
                              cell[2] + (corner >> 2)};
        const pvtVec3 at = pvtAdd(frame->origin, pvtScale(step, size));
        farthest = fmax(farthest, pvtLength3(pvtSub(at, look->center)));
    }
    const bool allowed = IsCellAllowed(inner, cell[0], cell[1], cell[2]);
    look->allowed += allowed ? 1 : 0;
    assert_true(!allowed || farthest < look->radius);
    // The facets are at most 0.6 % of the radius within the sphere.
    assert_true(allowed || farthest > 0.99 * look->radius);
}

// Rings of 64 around the y axis.
static void MakeSphere(pvtContext* context, double radius, pvtMesh* mesh)
{
    enum { RINGS = 32, AROUND = 64 };
    static pvtVec3 points[(RINGS + 1) * AROUND];
    static uint32_t indices[RINGS * AROUND * 6];
    size_t count = 0;
    for (uint32_t r = 0; r <= RINGS; ++r) {
        for (uint32_t a = 0; a < AROUND; ++a) {
            const double polar = 3.14159265358979 * r / RINGS;
            const double turn = 6.28318530717959 * a / AROUND;
            points[r * AROUND + a] = (pvtVec3){radius * sin(polar) * cos(turn), radius * cos(polar),
                                               radius * sin(polar) * sin(turn)};
            const uint32_t next = (a + 1) % AROUND;
            const uint32_t quad[6] = {r * AROUND + a,          r * AROUND + next,
                                      (r + 1) * AROUND + a,    r * AROUND + next,
                                      (r + 1) * AROUND + next, (r + 1) * AROUND + a};
            if (r < RINGS) {
                memcpy(indices + count, quad, sizeof quad);
                count += 6;
            }
        }
    }
    CHECK_OK(context,
             pvtCreateMesh(context, points, (RINGS + 1) * AROUND, indices, count / 3, mesh));
}

static void cells_of_a_ball_lose_less_than_a_cell_at_its_surface(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh mesh;
    MakeSphere(context, 1.0, &mesh);
    Inner inner;
    CHECK_OK(context, TryRefine(context, &mesh, &inner));
    BallLook look = {.radius = 1.0};
    ForEachCell(&inner, LookAtBallCell, &look);
    // 80 cells make a diameter: strict voxels alone would hold a third less.
    const double volume = (double)look.allowed / (80.0 * 80.0 * 80.0) * 6.0 / 3.14159265358979;
    assert_true(volume > 0.86 && volume < 1.0);
    assert_true((double)pvtBitGrid_Count(&inner.allowed) * 64.0 < 0.86 * (double)look.allowed);
    FreeInner(context, &inner);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

// A box of side 1 whose top has a slit across it from x = middle − width / 2 on.
static void MakeSlitBox(pvtContext* context, double width, pvtMesh* mesh)
{
    pvtVec3 p[16];
    for (uint32_t i = 0; i < 8; ++i) {
        p[i] = (pvtVec3){i & 1, i >> 1 & 1, i >> 2};
    }
    const double left = 0.487 - 0.5 * width, right = 0.487 + 0.5 * width;
    p[8] = (pvtVec3){left, 1, 0};
    p[9] = (pvtVec3){left, 1, 1};
    p[10] = (pvtVec3){right, 1, 0};
    p[11] = (pvtVec3){right, 1, 1};
    static const uint32_t indices[] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7,  6,  0, 1,
                                       5, 0, 5, 4, 2, 6, 9, 2, 9, 8, 10, 11, 7, 10,
                                       7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7,  1,  7, 5};
    CHECK_OK(context, pvtCreateMesh(context, p, 12, indices, 14, mesh));
}

typedef struct SlitLook {
    const Inner* closed;
    double slit, reach; // [wu] its middle, and how far from it cells may differ
    size_t differences;
} SlitLook;

static void LookAtSlitCell(const Inner* inner, const int cell[3], void* data)
{
    SlitLook* look = data;
    const bool open = IsCellAllowed(inner, cell[0], cell[1], cell[2]);
    const bool closed = IsCellAllowed(look->closed, cell[0], cell[1], cell[2]);
    if (open != closed) {
        const pvtGridFrame* frame = &inner->allowed.frame;
        const double x = frame->origin.x + (cell[0] + 0.5) * frame->voxelSize / 4.0;
        const double y = frame->origin.y + (cell[1] + 0.5) * frame->voxelSize / 4.0;
        assert_true(fabs(x - look->slit) < look->reach && fabs(y - 1.0) < look->reach);
        ++look->differences;
    }
}

// The wave from outside comes in, but the one from inside is there before it.
static void a_slit_narrower_than_a_voxel_costs_cells_near_it_only(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtMesh closed, open;
    MakeSlitBox(context, 0.0, &closed);
    MakeSlitBox(context, 0.032, &open); // 0.64 voxels, 2.6 cells
    Inner closedInner, openInner;
    CHECK_OK(context, TryRefine(context, &closed, &closedInner));
    CHECK_OK(context, TryRefine(context, &open, &openInner));
    SlitLook look = {.closed = &closedInner, .slit = 0.487, .reach = 0.075};
    ForEachCell(&openInner, LookAtSlitCell, &look);
    assert_true(look.differences > 0);
    FreeInner(context, &closedInner);
    FreeInner(context, &openInner);
    pvtMesh_Free(context, &closed);
    pvtMesh_Free(context, &open);
    DestroyTestContext(context);
}

static void a_wall_inside_is_buried_and_a_sheet_is_not(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    // A wall across the box; the same wall alone.
    const pvtVec3 wall[4] = {
        {0.6, -0.4, 2.0}, {0.6, 0.31, 2.0}, {0.6, -0.4, 2.57}, {0.6, 0.31, 2.57}};
    static const uint32_t wallIndices[] = {0, 1, 2, 2, 1, 3};
    pvtMesh box, sheet;
    MakeTestBox(context, &box);
    CHECK_OK(context, pvtCreateMesh(context, wall, 4, wallIndices, 2, &sheet));
    pvtVec3 positions[12];
    uint32_t indices[42];
    memcpy(positions, box.positions, 8 * sizeof *positions);
    memcpy(positions + 8, wall, sizeof wall);
    memcpy(indices, box.indices, 36 * sizeof *indices);
    for (int i = 0; i < 6; ++i) {
        indices[36 + i] = wallIndices[i] + 8;
    }
    pvtMesh divided;
    CHECK_OK(context, pvtCreateMesh(context, positions, 12, indices, 14, &divided));
    Inner inner;
    CHECK_OK(context, TryRefine(context, &divided, &inner));
    assert_true(pvtBitGrid_Get(&inner.solid.surface, 11, 8, 8));
    ForEachCell(&inner, LookAtBoxCell, NULL);
    FreeInner(context, &inner);
    CHECK_OK(context, TryRefine(context, &sheet, &inner));
    assert_true(inner.solid.surfaceCount > 100);
    assert_true(pvtBitGrid_Count(&inner.allowed) == 0 && inner.cells.count == 0);
    FreeInner(context, &inner);
    pvtMesh_Free(context, &box);
    pvtMesh_Free(context, &sheet);
    pvtMesh_Free(context, &divided);
    DestroyTestContext(context);
}

// The cells of the voxels chosen, and all of the others, in a grid of their own.
static void MakeFineGrid(pvtContext* context, const pvtBitGrid* whole, const pvtCellGrid* cells,
                         pvtBitGrid* fine)
{
    const int* size = whole->frame.size;
    MakeEmptyGrid(context, 4 * size[0], 4 * size[1], 4 * size[2], fine);
    for (int z = 0; z < 4 * size[2]; ++z) {
        for (int y = 0; y < 4 * size[1]; ++y) {
            for (int x = 0; x < 4 * size[0]; ++x) {
                const uint64_t bits = pvtBitGrid_Get(whole, x / 4, y / 4, z / 4)
                                          ? ~UINT64_C(0)
                                          : pvtCellGrid_Get(cells, x / 4, y / 4, z / 4);
                if ((bits >> (x % 4 + 4 * (y % 4) + 16 * (z % 4)) & 1) != 0) {
                    SetVoxel(fine, x, y, z);
                }
            }
        }
    }
}

// Random voxels, of which some are whole, and others have random cells.
static void MakeRandomCells(pvtContext* context, pvtRandom* random, pvtBitGrid* whole,
                            pvtCellGrid* cells)
{
    *cells = (pvtCellGrid){0};
    MakeEmptyGrid(context, 71, 23, 18, whole);
    MakeEmptyGrid(context, 71, 23, 18, &cells->voxels);
    FillRandomly(whole, random, 70);
    FillRandomly(&cells->voxels, random, 60);
    cells->ranks = pvtAllocate(context, whole->wordCount, sizeof *cells->ranks);
    assert_non_null(cells->ranks);
    for (size_t i = 0; i < whole->wordCount; ++i) {
        cells->voxels.words[i] &= ~whole->words[i];
        cells->ranks[i] = (uint32_t)cells->count;
        cells->count += (size_t)pvtCountBits(cells->voxels.words[i]);
    }
    cells->cells = pvtAllocate(context, cells->count, sizeof *cells->cells);
    assert_non_null(cells->cells);
    for (size_t i = 0; i < cells->count; ++i) {
        for (int bit = 0; bit < 64; ++bit) {
            cells->cells[i] |= (uint64_t)(pvtRandom_Below(random, 8) > 0) << bit;
        }
    }
}

static pvtBitmap MakeSlice(pvtContext* context, const pvtBitGrid* fine, const pvtPlane* plane)
{
    pvtBitmap slice;
    CHECK_OK(context, pvtCreateBitmap(context, fine->frame.size[pvtPlane_GetU(plane)],
                                      fine->frame.size[pvtPlane_GetV(plane)], &slice));
    memset(slice.words, 0xA5, slice.wordsPerRow * (size_t)slice.height * sizeof(uint64_t));
    return slice;
}

static pvtPlane MakeRandomPlane(pvtRandom* random, const pvtBitGrid* whole)
{
    const int32_t one = 1 << PVT_PLANE_BITS;
    pvtPlane plane = {.axis = (pvtAxis)pvtRandom_Below(random, 3)};
    const uint32_t kind = pvtRandom_Below(random, 4);
    const double reach = kind == 0 ? 0.0 : kind == 1 ? 0.05 : 1.0;
    plane.slopeU = (int32_t)((2.0 * pvtRandom_Unit(random) - 1.0) * reach * one) / 16 * 16;
    plane.slopeV = (int32_t)((2.0 * pvtRandom_Unit(random) - 1.0) * reach * one) / 16 * 16;
    const int u = whole->frame.size[pvtPlane_GetU(&plane)] / 2;
    const int v = whole->frame.size[pvtPlane_GetV(&plane)] / 2;
    const double height = pvtRandom_Unit(random) * whole->frame.size[plane.axis];
    plane.offset = (int64_t)(height * one) - (int64_t)plane.slopeU * u - (int64_t)plane.slopeV * v;
    plane.offset |= 1;
    return plane;
}

static void cell_slices_are_those_of_a_grid_of_four_times_the_size(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtRandom random = pvtMakeRandom(11, 1);
    pvtBitGrid whole, fine;
    pvtCellGrid cells;
    MakeRandomCells(context, &random, &whole, &cells);
    MakeFineGrid(context, &whole, &cells, &fine);
    pvtSliceVolume volume, fineVolume;
    CHECK_OK(context, pvtCreateSliceVolume(context, &whole, &volume));
    CHECK_OK(context, pvtAddSliceCells(context, &cells, &volume));
    CHECK_OK(context, pvtCreateSliceVolume(context, &fine, &fineVolume));
    uint64_t set = 0;
    for (int round = 0; round < 200; ++round) {
        const pvtPlane plane = MakeRandomPlane(&random, &whole);
        pvtPlane same = plane;
        same.offset *= 4;
        pvtBitmap slice = MakeSlice(context, &fine, &plane);
        pvtBitmap expected = MakeSlice(context, &fine, &plane);
        pvtSliceCells(&volume, &plane, PVT_CELLS, NULL, &slice);
        pvtSliceGrid(&fineVolume, &same, PVT_SLICE_COVERED, 1, &expected);
        const size_t bytes = slice.wordsPerRow * (size_t)slice.height * sizeof(uint64_t);
        assert_memory_equal(slice.words, expected.words, bytes);
        set += pvtBitmap_Count(&slice);
        // A window holds the same, and nothing that is not there.
        const pvtSliceWindow window = {{5, -2}, {9, 7}};
        pvtSliceCells(&volume, &plane, PVT_CELLS, &window, &slice);
        for (int j = 0; j < slice.height; ++j) {
            for (int i = 0; i < slice.width; ++i) {
                const bool isIn = i >= 20 && i < 36 && j < 28;
                assert_true(pvtBitmap_Get(&slice, i, j) == pvtBitmap_Get(&expected, i, j) ||
                            (!isIn && !pvtBitmap_Get(&slice, i, j)));
            }
        }
        // A cell as large as a voxel is set when those that it is made of are.
        pvtBitmap coarse;
        CHECK_OK(context, pvtCreateBitmap(context, slice.width / 4, slice.height / 4, &coarse));
        pvtSliceCells(&volume, &plane, 1, NULL, &coarse);
        for (int j = 0; j < coarse.height; ++j) {
            for (int i = 0; i < coarse.width; ++i) {
                bool all = true;
                for (int part = 0; part < 16; ++part) {
                    all = all && pvtBitmap_Get(&expected, 4 * i + part % 4, 4 * j + part / 4);
                }
                assert_true(pvtBitmap_Get(&coarse, i, j) == all);
            }
        }
        pvtBitmap_Free(context, &coarse);
        pvtBitmap_Free(context, &slice);
        pvtBitmap_Free(context, &expected);
    }
    assert_true(set > 10000);
    pvtSliceVolume_Free(context, &volume);
    pvtSliceVolume_Free(context, &fineVolume);
    pvtBitGrid_Free(context, &whole);
    pvtBitGrid_Free(context, &fine);
    pvtCellGrid_Free(context, &cells);
    DestroyTestContext(context);
}

static void the_check_looks_at_every_cell(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    MakeTestBox(context, &mesh);
    Inner inner;
    CHECK_OK(context, TryRefine(context, &mesh, &inner));
    const double cell = inner.allowed.frame.voxelSize / 4.0;
    // The surface runs through the middle of a cell here.
    for (int longer = 0; longer < 2; ++longer) {
        const double end = boxUpper[0] - (longer != 0 ? 0.4 : 0.6) * cell;
        const pvtVec3 corners[3] = {{0.5, 0.0, 2.3}, {end, 0.0, 2.3}, {0.5, 0.1, 2.35}};
        pvtMesh panel;
        CHECK_OK(context, pvtCreateMesh(context, corners, 3, NULL, 1, &panel));
        uint64_t outside = 0;
        CHECK_OK(context,
                 pvtCheckOccluder(context,
                                  &(pvtInterior){.allowed = &inner.allowed, .cells = &inner.cells},
                                  &panel, &outside));
        assert_true((outside > 0) == (longer != 0));
        // Without the cells both end in voxels that are not allowed.
        CHECK_OK(context, pvtCheckOccluder(context, &(pvtInterior){.allowed = &inner.allowed},
                                           &panel, &outside));
        assert_true(outside > 0);
        pvtMesh_Free(context, &panel);
    }
    FreeInner(context, &inner);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

static pvtStatus RefineAndSlice(pvtContext* context, const void* input)
{
    Inner inner;
    pvtStatus status = TryRefine(context, input, &inner);
    pvtSliceVolume volume = {0};
    if (status == PVT_OK) {
        status = pvtCreateSliceVolume(context, &inner.allowed, &volume);
    }
    if (status == PVT_OK) {
        status = pvtAddSliceCells(context, &inner.cells, &volume);
        assert_true(status == PVT_OK || (volume.cells == NULL && volume.grid != NULL));
    }
    pvtSliceVolume_Free(context, &volume);
    FreeInner(context, &inner);
    return status;
}

static void every_request_and_every_stop_leaves_nothing_behind(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtMesh mesh;
    MakeTestBox(context, &mesh);
    CheckEveryAllocation(RefineAndSlice, &mesh);
    CheckEveryCancel(RefineAndSlice, &mesh);
    pvtMesh_Free(context, &mesh);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_of_a_box_are_allowed_when_they_lie_within_it),
        cmocka_unit_test(cells_of_a_ball_lose_less_than_a_cell_at_its_surface),
        cmocka_unit_test(a_slit_narrower_than_a_voxel_costs_cells_near_it_only),
        cmocka_unit_test(a_wall_inside_is_buried_and_a_sheet_is_not),
        cmocka_unit_test(cell_slices_are_those_of_a_grid_of_four_times_the_size),
        cmocka_unit_test(the_check_looks_at_every_cell),
        cmocka_unit_test(every_request_and_every_stop_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
