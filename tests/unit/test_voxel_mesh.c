// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include <stdlib.h>

typedef struct Edge {
    uint32_t from, to, triangle;
} Edge;

static int CompareEdges(const void* left, const void* right)
{
    const Edge* a = left;
    const Edge* b = right;
    if (a->from != b->from) {
        return a->from < b->from ? -1 : 1;
    }
    return a->to < b->to ? -1 : a->to > b->to;
}

static Edge* FindEdge(Edge* edges, size_t count, uint32_t from, uint32_t to)
{
    const Edge key = {from, to, 0};
    return bsearch(&key, edges, count, sizeof *edges, CompareEdges);
}

static Edge* MakeSortedEdges(const pvtMesh* mesh)
{
    Edge* edges = malloc((3 * mesh->triangleCount + 1) * sizeof *edges);
    assert_non_null(edges);
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        const size_t next = i % 3 == 2 ? i - 2 : i + 1;
        edges[i] = (Edge){mesh->indices[i], mesh->indices[next], (uint32_t)(i / 3)};
    }
    qsort(edges, 3 * mesh->triangleCount, sizeof *edges, CompareEdges);
    return edges;
}

// Every directed edge occurs once and so does its reverse; walking from triangle to triangle
// around a vertex passes all of its triangles, so that they form one disc.
static void CheckManifold(const pvtMesh* mesh)
{
    const size_t count = 3 * mesh->triangleCount;
    Edge* edges = MakeSortedEdges(mesh);
    uint32_t* degree = calloc(mesh->positionCount + 1, sizeof *degree);
    assert_non_null(degree);
    for (size_t i = 0; i < count; ++i) {
        assert_true(edges[i].from != edges[i].to);
        assert_true(i == 0 || CompareEdges(&edges[i - 1], &edges[i]) != 0);
        assert_non_null(FindEdge(edges, count, edges[i].to, edges[i].from));
        ++degree[edges[i].from];
    }
    for (size_t i = 0; i < count; i += i + 1 < count ? degree[edges[i].from] : 1) {
        const uint32_t vertex = edges[i].from;
        const Edge* edge = &edges[i];
        uint32_t steps = 0;
        do {
            const uint32_t* corner = &mesh->indices[3 * (size_t)edge->triangle];
            const int at = corner[0] == vertex ? 0 : corner[1] == vertex ? 1 : 2;
            edge = FindEdge(edges, count, vertex, corner[(at + 2) % 3]);
            ++steps;
        } while (edge != &edges[i] && steps <= degree[vertex]);
        assert_int_equal(steps, degree[vertex]);
    }
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        assert_true(degree[i] > 0);
    }
    free(degree);
    free(edges);
}

static double GetSixfoldVolume(const pvtMesh* mesh)
{
    double volume = 0.0;
    for (size_t i = 0; i < mesh->triangleCount; ++i) {
        const pvtVec3 a = mesh->positions[mesh->indices[3 * i]];
        const pvtVec3 b = mesh->positions[mesh->indices[3 * i + 1]];
        const pvtVec3 c = mesh->positions[mesh->indices[3 * i + 2]];
        volume += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
                  a.z * (b.x * c.y - b.y * c.x);
    }
    return volume;
}

static void CheckVoxelMesh(pvtContext* context, const pvtBitGrid* grid)
{
    pvtMesh mesh;
    CHECK_OK(context, pvtBuildVoxelMesh(context, grid, &mesh));
    CheckManifold(&mesh);
    assert_true(GetSixfoldVolume(&mesh) == 6.0 * (double)pvtBitGrid_Count(grid));
    pvtMesh_Free(context, &mesh);
}

// All patterns side by side in one grid, with free voxels between them.
static void every_block_of_2_by_2_by_3_voxels_becomes_a_manifold(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    for (int turn = 0; turn < 3; ++turn) {
        const int size[3] = {turn == 0 ? 3 : 2, turn == 1 ? 3 : 2, turn == 2 ? 3 : 2};
        pvtBitGrid grid;
        MakeEmptyGrid(context, 16 * 4, 16 * 4, 16 * 4, &grid);
        for (int i = 0; i < 4096 * 12; ++i) {
            const int pattern = i / 12;
            const int voxel = i % 12;
            if ((pattern >> voxel & 1) != 0) {
                SetVoxel(&grid, pattern % 16 * 4 + voxel % size[0],
                         pattern / 16 % 16 * 4 + voxel / size[0] % size[1],
                         pattern / 256 * 4 + voxel / (size[0] * size[1]));
            }
        }
        CheckVoxelMesh(context, &grid);
        pvtBitGrid_Free(context, &grid);
    }
    DestroyTestContext(context);
}

static void random_grids_become_manifolds_of_the_right_volume(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    pvtRandom random = pvtMakeRandom(1, 0);
    for (uint32_t percent = 5; percent < 100; percent += 10) {
        pvtBitGrid grid;
        MakeEmptyGrid(context, 66, 7, 9, &grid);
        FillRandomly(&grid, &random, percent);
        CheckVoxelMesh(context, &grid);
        pvtBitGrid_Free(context, &grid);
    }
    DestroyTestContext(context);
}

static long GetEulerCount(pvtContext* context, const pvtBitGrid* grid)
{
    pvtMesh mesh;
    CHECK_OK(context, pvtBuildVoxelMesh(context, grid, &mesh));
    CheckManifold(&mesh);
    const long euler =
        (long)mesh.positionCount - (long)(3 * mesh.triangleCount / 2) + (long)mesh.triangleCount;
    pvtMesh_Free(context, &mesh);
    return euler;
}

static void euler_counts_tell_boxes_from_tori(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, 70, 6, 6, &grid);
    assert_int_equal(GetEulerCount(context, &grid), 0);
    for (int i = 0; i < 70 * 4 * 4; ++i) {
        SetVoxel(&grid, i % 70, 1 + i / 70 % 4, 1 + i / 280);
    }
    assert_int_equal(GetEulerCount(context, &grid), 2);
    pvtBitGrid_Free(context, &grid);

    // A ring of 3 × 3 voxels without the middle; then two boxes that touch in an edge.
    MakeEmptyGrid(context, 3, 3, 1, &grid);
    for (int i = 0; i < 9; ++i) {
        if (i != 4) {
            SetVoxel(&grid, i % 3, i / 3, 0);
        }
    }
    assert_int_equal(GetEulerCount(context, &grid), 0);
    pvtBitGrid_Free(context, &grid);
    MakeEmptyGrid(context, 2, 2, 1, &grid);
    SetVoxel(&grid, 0, 0, 0);
    SetVoxel(&grid, 1, 1, 0);
    assert_int_equal(GetEulerCount(context, &grid), 4);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

static void vertices_are_shared_and_lie_on_the_lattice(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtBitGrid grid;
    MakeEmptyGrid(context, 3, 3, 3, &grid);
    grid.frame.origin = (pvtVec3){10.0, 20.0, 30.0};
    grid.frame.voxelSize = 0.5;
    SetVoxel(&grid, 1, 0, 2);
    pvtMesh mesh;
    CHECK_OK(context, pvtBuildVoxelMesh(context, &grid, &mesh));
    assert_int_equal(mesh.positionCount, 8);
    assert_int_equal(mesh.triangleCount, 12);
    const pvtBox3 box = pvtMesh_GetBounds(&mesh);
    assert_true(box.lower.x == 10.5 && box.lower.y == 20.0 && box.lower.z == 31.0);
    assert_true(box.upper.x == 11.0 && box.upper.y == 20.5 && box.upper.z == 31.5);
    pvtMesh_Free(context, &mesh);
    pvtBitGrid_Free(context, &grid);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_block_of_2_by_2_by_3_voxels_becomes_a_manifold),
        cmocka_unit_test(random_grids_become_manifolds_of_the_right_volume),
        cmocka_unit_test(euler_counts_tell_boxes_from_tori),
        cmocka_unit_test(vertices_are_shared_and_lie_on_the_lattice),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
