// SPDX-License-Identifier: MIT
// Clusters triangles by the direction they face, weighted by area.
//
// Normals are collected in the cells of half a cube map, opposite ones together. A cluster grows
// around the heaviest cell left and takes every cell within the angle. Its direction is not the
// mean of all that: a wall's own normal counts more than the mouldings around it, so each cell
// keeps the normal that most of its area shares (weighted majority vote; Boyer and Moore, "MJRTY",
// 1991), and only curved surfaces, where there is none, fall back to the mean.
//
// The order of triangles and corners does not matter, so that a mesh which a compression has put in
// another order gives the same directions to the last bit: sums are integers, a triangle's cross
// product begins at its least corner, and the winner of the vote is counted anew.
#include <paravent/mesh.h>

#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

enum { MIN_SIDE = 17, MAX_SIDE = 129, CANCEL_INTERVAL = 16384, SPARE_CLUSTERS = 16 };

// Normals closer than this [rad] count as one plane's.
static const double sameNormal = 1e-3;

// A sum of area vectors (normals times twice the area), in whole units.
typedef struct Sum {
    int64_t x, y, z;
    int64_t length; // of the vectors' lengths
} Sum;

typedef struct Cell {
    Sum all;
    Sum winner;        // of the triangles whose normal is the candidate
    pvtVec3 candidate; // of the vote, of unit length
    double voteWeight;
} Cell;

typedef struct CellMap {
    Cell* cells; // 3 × side²
    int side;    // odd, so that an axis lies in the middle of a cell
    int64_t length;
    double scale; // of the mesh, so that its diagonal is 1
    double unit;  // units of a sum in 1
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

static bool IsLess(pvtVec3 a, pvtVec3 b)
{
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Twice the area times the normal. Scaled, so that tiny models do not underflow; from the least
// corner on, so that rounding is the same whichever corner the file begins with.
static pvtVec3 GetAreaVector(const pvtMesh* mesh, size_t triangle, double scale)
{
    const uint32_t* corner = &mesh->indices[3 * triangle];
    const pvtVec3 p[3] = {mesh->positions[corner[0]], mesh->positions[corner[1]],
                          mesh->positions[corner[2]]};
    const int second = IsLess(p[1], p[0]) ? 1 : 0;
    const int first = IsLess(p[2], p[second]) ? 2 : second;
    const pvtVec3 u = pvtScale(pvtSub(p[(first + 1) % 3], p[first]), scale);
    const pvtVec3 v = pvtScale(pvtSub(p[(first + 2) % 3], p[first]), scale);
    return pvtCross(u, v);
}

static void AddToSum(Sum* sum, pvtVec3 vector, double length, double unit)
{
    sum->x += (int64_t)rint(vector.x * unit);
    sum->y += (int64_t)rint(vector.y * unit);
    sum->z += (int64_t)rint(vector.z * unit);
    sum->length += (int64_t)rint(length * unit);
}

static pvtVec3 GetDirection(const Sum* sum)
{
    const pvtVec3 v = {(double)sum->x, (double)sum->y, (double)sum->z};
    const double length = pvtLength3(v);
    // Divided, so that what lies along an axis comes out as the axis.
    return length > 0.0 ? (pvtVec3){v.x / length, v.y / length, v.z / length} : v;
}

static bool IsSameNormal(pvtVec3 a, pvtVec3 b)
{
    return pvtLength3(pvtSub(a, b)) < sameNormal;
}

static void Vote(Cell* cell, pvtVec3 normal, double weight)
{
    const bool agrees = IsSameNormal(normal, cell->candidate);
    cell->voteWeight += agrees ? weight : -weight;
    if (cell->voteWeight < 0.0) {
        cell->candidate = normal;
        cell->voteWeight = -cell->voteWeight;
    }
}

static void CountVote(Cell* cell, pvtVec3 normal, pvtVec3 vector, double length, double unit)
{
    if (IsSameNormal(normal, cell->candidate)) {
        AddToSum(&cell->winner, vector, length, unit);
    }
}

// A walk over all triangles: the first one votes, the second one counts who voted for the winner.
static pvtStatus CollectNormals(pvtContext* context, const pvtMesh* mesh, bool isCount,
                                CellMap* map)
{
    for (size_t i = 0; i < mesh->triangleCount; ++i) {
        if (i % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        pvtVec3 vector = GetAreaVector(mesh, i, map->scale);
        const double length = pvtLength3(vector);
        if (!(length > 0.0 && length < 1.5)) { // corners that are not finite, too
            continue;
        }
        const int axis = OrientToCell(&vector);
        Cell* cell = FindCell(map, vector, axis);
        const pvtVec3 normal = pvtScale(vector, 1.0 / length);
        if (isCount) {
            CountVote(cell, normal, vector, length, map->unit);
        } else {
            Vote(cell, normal, length);
            AddToSum(&cell->all, vector, length, map->unit);
            map->length += (int64_t)rint(length * map->unit);
        }
    }
    return PVT_OK;
}

static Cell* FindHeaviestCell(const CellMap* map, size_t count)
{
    Cell* heaviest = NULL;
    for (size_t i = 0; i < count; ++i) {
        Cell* cell = &map->cells[i];
        if (cell->all.length > 0 && (heaviest == NULL || cell->all.length > heaviest->all.length)) {
            heaviest = cell;
        }
    }
    return heaviest;
}

// Takes every cell within the angle of the seed's direction out of the map.
static pvtFaceDirection TakeCluster(const CellMap* map, size_t count, const Cell* seed,
                                    double cosine)
{
    // The winner needs five eighths, a majority that no order of the votes can miss.
    const bool isFlat = seed->winner.length > seed->all.length / 8 * 5;
    const pvtVec3 center = GetDirection(isFlat ? &seed->winner : &seed->all);
    Sum sum = {0};
    for (size_t i = 0; i < count; ++i) {
        Cell* cell = &map->cells[i];
        const double dot = pvtDot(GetDirection(&cell->all), center);
        if (cell->all.length > 0 && (fabs(dot) >= cosine || cell == seed)) {
            const int64_t sign = dot < 0.0 ? -1 : 1;
            sum.x += sign * cell->all.x;
            sum.y += sign * cell->all.y;
            sum.z += sign * cell->all.z;
            sum.length += cell->all.length;
            cell->all.length = 0;
        }
    }
    pvtVec3 direction = isFlat ? center : GetDirection(&sum);
    const double first = direction.x != 0.0   ? direction.x
                         : direction.y != 0.0 ? direction.y
                                              : direction.z;
    if (first < 0.0) {
        direction = pvtScale(direction, -1.0);
    }
    // No coordinate is −0: outputs are compared byte by byte.
    direction = pvtAdd(direction, (pvtVec3){0.0, 0.0, 0.0});
    return (pvtFaceDirection){direction, (double)sum.length};
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

static void TakeClusters(const pvtFaceDirectionOptions* options, const CellMap* map,
                         pvtFaceDirectionSet* set)
{
    const size_t count = 3 * (size_t)map->side * (size_t)map->side;
    const double areaOfUnit = 0.5 / map->unit / map->scale / map->scale;
    const size_t most = 2 * (size_t)options->maxCount + SPARE_CLUSTERS;
    size_t taken = 0;
    const Cell* seed = FindHeaviestCell(map, count);
    while (seed != NULL && taken < most) {
        set->directions[taken++] = TakeCluster(map, count, seed, cos(options->angle));
        seed = FindHeaviestCell(map, count);
    }
    qsort(set->directions, taken, sizeof *set->directions, CompareByArea);
    while (set->count < taken && set->count < (size_t)options->maxCount &&
           set->directions[set->count].area >= options->minFraction * (double)map->length) {
        set->directions[set->count++].area *= areaOfUnit;
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
    const bool isSized = mesh->triangleCount > 0 && size > 0.0 && isfinite(size);
    // About six cells across the angle.
    const double fine = 2.0 * 3.0 / options->angle;
    // No cross product is longer than the diagonal's square, which is 1, so that no sum overflows.
    CellMap map = {.side = fine > MAX_SIDE   ? MAX_SIDE
                           : fine < MIN_SIDE ? MIN_SIDE
                                             : (int)fine | 1,
                   .scale = isSized ? 1.0 / size : 1.0,
                   .unit = 0x1p62 / (double)(mesh->triangleCount + 2)};
    map.cells = pvtAllocate(context, 3 * (size_t)map.side * (size_t)map.side, sizeof *map.cells);
    set->directions = map.cells == NULL
                          ? NULL
                          : pvtAllocate(context, 2 * (size_t)options->maxCount + SPARE_CLUSTERS,
                                        sizeof *set->directions);
    status = set->directions == NULL ? pvtContext_GetStatus(context)
                                     : CollectNormals(context, mesh, false, &map);
    if (status == PVT_OK) {
        status = CollectNormals(context, mesh, true, &map);
    }
    if (status == PVT_OK) {
        TakeClusters(options, &map, set);
    } else {
        pvtFaceDirectionSet_Free(context, set);
    }
    pvtRelease(context, map.cells);
    return status;
}
