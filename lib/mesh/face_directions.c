// SPDX-License-Identifier: MIT
// Clusters triangles by the direction they face, weighted by area.
//
// Normals are collected in the cells of half a cube map, opposite ones together. A cluster grows
// around the heaviest cell left and takes every cell within the angle. Its direction is not the
// mean of all that: a wall's own normal counts more than the mouldings around it, so each cell
// keeps the normal that most of its area shares (weighted majority vote; Boyer and Moore, "MJRTY",
// 1991), and only curved surfaces, where there is none, fall back to the mean.
#include <paravent/mesh.h>

#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

enum { MIN_SIDE = 17, MAX_SIDE = 129, CANCEL_INTERVAL = 16384, SPARE_CLUSTERS = 16 };

// Normals closer than this [rad] count as one plane's.
static const double sameNormal = 1e-3;

typedef struct Cell {
    pvtVec3 sum; // of normals times area
    double area;
    pvtVec3 vote; // sum over the candidate of the vote, in the same way
    double voteWeight;
} Cell;

typedef struct CellMap {
    Cell* cells; // 3 × side²
    int side;    // odd, so that an axis lies in the middle of a cell
    double area;
} CellMap;

pvtFaceDirectionOptions pvtDefaultFaceDirectionOptions(void)
{
    return (pvtFaceDirectionOptions){.maxCount = 16, .angle = 0.12, .minFraction = 0.005};
}

void pvtFaceDirectionSet_Free(pvtContext* context, pvtFaceDirectionSet* set)
{
    pvtRelease(context, set->directions);
    *set = (pvtFaceDirectionSet){0};
}

static pvtStatus CheckOptions(pvtContext* context, const pvtFaceDirectionOptions* options)
{
    if (options->maxCount < 1 || options->maxCount > 256) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the most face directions are %d; 1 to 256 are possible", options->maxCount);
    }
    if (!(options->angle > 0.0 && options->angle < 1.6)) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the angle between face directions is %g; it must lie in 0 to 1.6 rad",
                       options->angle);
    }
    if (!(options->minFraction >= 0.0 && options->minFraction <= 1.0)) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "the least fraction of a face direction is %g; it must lie in 0 to 1",
                       options->minFraction);
    }
    return PVT_OK;
}

// Of a direction and its opposite, the one whose largest coordinate is positive.
static int OrientToCell(pvtVec3* n)
{
    const pvtVec3 a = {fabs(n->x), fabs(n->y), fabs(n->z)};
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    if (pvtGetAxis(*n, axis) < 0.0) {
        *n = pvtScale(*n, -1.0);
    }
    return axis;
}

static Cell* FindCell(const CellMap* map, pvtVec3 unit, int axis)
{
    const double major = pvtGetAxis(unit, axis);
    const int last = map->side - 1;
    int u = (int)((pvtGetAxis(unit, (axis + 1) % 3) / major + 1.0) * 0.5 * map->side);
    int v = (int)((pvtGetAxis(unit, (axis + 2) % 3) / major + 1.0) * 0.5 * map->side);
    u = u < 0 ? 0 : u > last ? last : u;
    v = v < 0 ? 0 : v > last ? last : v;
    return &map->cells[((size_t)axis * (size_t)map->side + (size_t)v) * (size_t)map->side +
                       (size_t)u];
}

static void AddNormal(Cell* cell, pvtVec3 unit, double area)
{
    const pvtVec3 weighted = pvtScale(unit, area);
    cell->sum = pvtAdd(cell->sum, weighted);
    cell->area += area;
    const pvtVec3 candidate = pvtNormalize(cell->vote);
    if (cell->voteWeight > 0.0 && pvtLength3(pvtSub(unit, candidate)) < sameNormal) {
        cell->vote = pvtAdd(cell->vote, weighted);
        cell->voteWeight += area;
        return;
    }
    cell->voteWeight -= area;
    if (cell->voteWeight < 0.0) {
        cell->vote = weighted;
        cell->voteWeight = -cell->voteWeight;
    }
}

// Twice the area times the normal, in units of `scale`, so that tiny models do not underflow.
static pvtVec3 GetAreaVector(const pvtMesh* mesh, size_t triangle, double scale)
{
    const uint32_t* corner = &mesh->indices[3 * triangle];
    const pvtVec3 a = mesh->positions[corner[0]];
    const pvtVec3 u = pvtScale(pvtSub(mesh->positions[corner[1]], a), scale);
    const pvtVec3 v = pvtScale(pvtSub(mesh->positions[corner[2]], a), scale);
    return pvtCross(u, v);
}

static pvtStatus CollectNormals(pvtContext* context, const pvtMesh* mesh, double scale,
                                CellMap* map)
{
    for (size_t i = 0; i < mesh->triangleCount; ++i) {
        if (i % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        pvtVec3 normal = GetAreaVector(mesh, i, scale);
        const double length = pvtLength3(normal);
        if (length > 0.0 && isfinite(length)) {
            const int axis = OrientToCell(&normal);
            AddNormal(FindCell(map, normal, axis), pvtScale(normal, 1.0 / length), 0.5 * length);
            map->area += 0.5 * length;
        }
    }
    return PVT_OK;
}

static Cell* FindHeaviestCell(const CellMap* map, size_t count)
{
    Cell* heaviest = NULL;
    for (size_t i = 0; i < count; ++i) {
        Cell* cell = &map->cells[i];
        if (cell->area > 0.0 && (heaviest == NULL || cell->area > heaviest->area)) {
            heaviest = cell;
        }
    }
    return heaviest;
}

// Takes every cell within the angle of the seed's direction out of the map.
static pvtFaceDirection TakeCluster(const CellMap* map, size_t count, const Cell* seed,
                                    double cosine)
{
    const bool isFlat = seed->voteWeight > 0.25 * seed->area;
    const pvtVec3 center = pvtNormalize(isFlat ? seed->vote : seed->sum);
    pvtVec3 sum = {0.0, 0.0, 0.0};
    double area = 0.0;
    for (size_t i = 0; i < count; ++i) {
        Cell* cell = &map->cells[i];
        const double dot = pvtDot(pvtNormalize(cell->sum), center);
        if (cell->area > 0.0 && (fabs(dot) >= cosine || cell == seed)) {
            sum = pvtAdd(sum, pvtScale(cell->sum, dot < 0.0 ? -1.0 : 1.0));
            area += cell->area;
            cell->area = 0.0;
        }
    }
    pvtVec3 direction = isFlat ? center : pvtNormalize(sum);
    const double first = direction.x != 0.0   ? direction.x
                         : direction.y != 0.0 ? direction.y
                                              : direction.z;
    if (first < 0.0) {
        direction = pvtScale(direction, -1.0);
    }
    // No coordinate is −0: outputs are compared byte by byte.
    direction = pvtAdd(direction, (pvtVec3){0.0, 0.0, 0.0});
    return (pvtFaceDirection){direction, area};
}

// Falling area; equal areas by direction, so that the order does not hang on qsort.
static int CompareByArea(const void* left, const void* right)
{
    const pvtFaceDirection* a = left;
    const pvtFaceDirection* b = right;
    const double keys[4][2] = {{b->area, a->area},
                               {a->direction.x, b->direction.x},
                               {a->direction.y, b->direction.y},
                               {a->direction.z, b->direction.z}};
    for (int i = 0; i < 4; ++i) {
        if (keys[i][0] != keys[i][1]) {
            return keys[i][0] < keys[i][1] ? -1 : 1;
        }
    }
    return 0;
}

static void TakeClusters(const pvtFaceDirectionOptions* options, CellMap* map, double unitArea,
                         pvtFaceDirectionSet* set)
{
    const size_t count = 3 * (size_t)map->side * (size_t)map->side;
    const size_t most = 2 * (size_t)options->maxCount + SPARE_CLUSTERS;
    size_t taken = 0;
    const Cell* seed = FindHeaviestCell(map, count);
    while (seed != NULL && taken < most) {
        set->directions[taken++] = TakeCluster(map, count, seed, cos(options->angle));
        seed = FindHeaviestCell(map, count);
    }
    qsort(set->directions, taken, sizeof *set->directions, CompareByArea);
    while (set->count < taken && set->count < (size_t)options->maxCount &&
           set->directions[set->count].area >= options->minFraction * map->area) {
        set->directions[set->count++].area *= unitArea;
    }
}

pvtStatus pvtFindFaceDirections(pvtContext* context, const pvtFaceDirectionOptions* options,
                                const pvtMesh* mesh, pvtFaceDirectionSet* set)
{
    *set = (pvtFaceDirectionSet){0};
    pvtStatus status = CheckOptions(context, options);
    if (status != PVT_OK) {
        return status;
    }
    const pvtBox3 box = pvtMesh_GetBounds(mesh);
    const double size = pvtLength3(pvtSub(box.upper, box.lower));
    const double unit = mesh->triangleCount > 0 && size > 0.0 && isfinite(size) ? size : 1.0;
    // About six cells across the angle.
    const double fine = 2.0 * 3.0 / options->angle;
    CellMap map = {.side = fine > MAX_SIDE ? MAX_SIDE : fine < MIN_SIDE ? MIN_SIDE : (int)fine | 1};
    map.cells = pvtAllocate(context, 3 * (size_t)map.side * (size_t)map.side, sizeof *map.cells);
    set->directions = map.cells == NULL
                          ? NULL
                          : pvtAllocate(context, 2 * (size_t)options->maxCount + SPARE_CLUSTERS,
                                        sizeof *set->directions);
    status = set->directions == NULL ? pvtContext_GetStatus(context)
                                     : CollectNormals(context, mesh, 1.0 / unit, &map);
    if (status == PVT_OK) {
        TakeClusters(options, &map, unit * unit, set);
    } else {
        pvtFaceDirectionSet_Free(context, set);
    }
    pvtRelease(context, map.cells);
    return status;
}
