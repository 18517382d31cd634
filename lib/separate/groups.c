// SPDX-License-Identifier: MIT
#include "groups.h"

#include "base/context.h"
#include "mesh/transform.h"

#include <assert.h>
#include <float.h>
#include <string.h>

enum { MAX_VIEWS = 64 };

// Thinner than this part of its length, an instance is flat: nothing can be inside.
static const double MIN_VOLUME = 1e-9;

static pvtVec3 GetColumn(const double m[16], int column)
{
    return (pvtVec3){m[4 * column], m[4 * column + 1], m[4 * column + 2]};
}

// The largest singular value: the root of the largest eigenvalue of MᵀM. Oliver K. Smith,
// Eigenvalues of a symmetric 3 × 3 matrix, Communications of the ACM 4, 1961.
static double GetStretch(const double m[16])
{
    double a[3][3];
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            a[i][j] = pvtDot(GetColumn(m, i), GetColumn(m, j));
        }
    }
    const double mean = (a[0][0] + a[1][1] + a[2][2]) / 3.0;
    double spread = 0.0;
    for (int i = 0; i < 3; ++i) {
        a[i][i] -= mean;
        spread += (a[i][0] * a[i][0] + a[i][1] * a[i][1] + a[i][2] * a[i][2]) / 6.0;
    }
    spread = sqrt(spread);
    // A rotation, but for rounding: lengths stay as they are, to the last bit.
    if (fabs(mean - 1.0) < 1e-12 && spread < 1e-12) {
        return 1.0;
    }
    if (!(spread > 1e-15 * mean)) {
        return sqrt(mean);
    }
    const pvtVec3 rows[3] = {{a[0][0] / spread, a[0][1] / spread, a[0][2] / spread},
                             {a[1][0] / spread, a[1][1] / spread, a[1][2] / spread},
                             {a[2][0] / spread, a[2][1] / spread, a[2][2] / spread}};
    const double half = 0.5 * pvtDot(pvtCross(rows[0], rows[1]), rows[2]);
    const double angle = acos(fmax(-1.0, fmin(1.0, half))) / 3.0;
    return sqrt(mean + 2.0 * spread * cos(angle));
}

static bool IsFlat(const double m[16])
{
    const double stretch = GetStretch(m);
    return !(fabs(pvtGetDeterminant(m)) > MIN_VOLUME * stretch * stretch * stretch);
}

// The mesh's axis that the instance points up, of those along `up` in the world the nearest.
static int FindUp(const double m[16], int up)
{
    int nearest = up;
    double best = -1.0;
    for (int i = 0; i < 3; ++i) {
        const int axis = (up + i) % 3; // of equals the one that it already is
        const double height = m[4 * axis + up] / pvtLength3(GetColumn(m, axis));
        if (fabs(height) > best + 1e-9) {
            best = fabs(height);
            nearest = height < 0.0 ? axis + 3 : axis;
        }
    }
    return nearest;
}

static bool IsUpAskedFor(const pvtBuildOptions* options)
{
    return options->ground || options->terrain || options->views.aboveOnly;
}

static pvtStatus CheckInstance(pvtContext* context, const pvtInstanceSet* set, size_t index)
{
    const pvtInstance* instance = &set->instances[index];
    assert(instance->mesh < set->meshCount);
    for (int i = 0; i < 16; ++i) {
        if (!(fabs(instance->transform[i]) <= FLT_MAX)) {
            return pvtFail(context, PVT_INVALID_ARGUMENT,
                           "the transform of instance %zu holds %g; all of it must be finite and "
                           "fit in a float",
                           index, instance->transform[i]);
        }
    }
    return PVT_OK;
}

static void AddInstance(const pvtInstanceSet* set, size_t index, pvtGroup* group)
{
    const double* transform = set->instances[index].transform;
    group->firstInstance = group->instanceCount == 0 ? index : group->firstInstance;
    ++group->instanceCount;
    group->scale = fmax(group->scale, GetStretch(transform));
    group->volume += fabs(pvtGetDeterminant(transform));
}

typedef struct Grouping {
    const pvtBuildOptions* options;
    const pvtInstanceSet* set;
    size_t* canonical;  // meshCount
    bool* isUsed;       // meshCount
    ptrdiff_t* ofSides; // 6 × meshCount: the group of a mesh and its axis that is up
} Grouping;

static pvtStatus AllocateGroups(pvtContext* context, Grouping* grouping, pvtGroupSet* groups)
{
    const pvtInstanceSet* set = grouping->set;
    grouping->canonical = pvtAllocate(context, set->meshCount, sizeof *grouping->canonical);
    grouping->isUsed = pvtAllocate(context, set->meshCount, sizeof *grouping->isUsed);
    grouping->ofSides = pvtAllocate(context, 6 * set->meshCount, sizeof *grouping->ofSides);
    groups->ofInstance = pvtAllocate(context, set->instanceCount, sizeof *groups->ofInstance);
    const size_t most =
        set->instanceCount < 6 * set->meshCount ? set->instanceCount : 6 * set->meshCount;
    groups->groups = pvtAllocate(context, most, sizeof *groups->groups);
    if (grouping->canonical == NULL || grouping->isUsed == NULL || grouping->ofSides == NULL ||
        groups->ofInstance == NULL || groups->groups == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t i = 0; i < 6 * set->meshCount; ++i) {
        grouping->ofSides[i] = PVT_NO_OCCLUDER;
    }
    return PVT_OK;
}

static void FormGroups(Grouping* grouping, pvtGroupSet* groups)
{
    const pvtInstanceSet* set = grouping->set;
    const int worldUp = (int)grouping->options->up;
    for (size_t i = 0; i < set->instanceCount; ++i) {
        const pvtInstance* instance = &set->instances[i];
        groups->ofInstance[i] = PVT_NO_OCCLUDER;
        if (IsFlat(instance->transform)) {
            continue;
        }
        const size_t source = grouping->canonical[instance->mesh];
        const int up =
            IsUpAskedFor(grouping->options) ? FindUp(instance->transform, worldUp) : worldUp;
        ptrdiff_t* group = &grouping->ofSides[6 * source + (size_t)up];
        if (*group == PVT_NO_OCCLUDER) {
            *group = (ptrdiff_t)groups->count;
            groups->groups[groups->count++] = (pvtGroup){.source = source, .up = up};
        }
        groups->ofInstance[i] = *group;
        AddInstance(set, i, &groups->groups[*group]);
    }
}

// A rotation by thirds and halves of a turn, which costs no bit: the axis `up` of the mesh becomes
// the axis that the options call up.
static pvtVec3 Turn(const pvtGroup* group, pvtVec3 p)
{
    const int target = (int)group->options.up;
    const int shift = target + 3 - group->up % 3;
    pvtVec3 turned = p;
    for (int axis = 0; axis < 3; ++axis) {
        const int to = (axis + shift) % 3;
        const bool isNegated = group->up >= 3 && to != (target + 2) % 3;
        pvtSetAxis(&turned, to, isNegated ? -pvtGetAxis(p, axis) : pvtGetAxis(p, axis));
    }
    return turned;
}

static pvtVec3 TurnBack(const pvtGroup* group, pvtVec3 p)
{
    const int target = (int)group->options.up;
    const int shift = target + 3 - group->up % 3;
    pvtVec3 turned = p;
    for (int axis = 0; axis < 3; ++axis) {
        const int from = (axis + shift) % 3;
        const bool isNegated = group->up >= 3 && from != (target + 2) % 3;
        pvtSetAxis(&turned, axis, isNegated ? -pvtGetAxis(p, from) : pvtGetAxis(p, from));
    }
    return turned;
}

static bool IsTurned(const pvtGroup* group)
{
    return group->up != (int)group->options.up;
}

static pvtStatus TurnMesh(pvtContext* context, const pvtMesh* source, pvtGroup* group)
{
    const pvtStatus status = pvtCreateMesh(context, source->positions, source->positionCount,
                                           source->indices, source->triangleCount, &group->mesh);
    for (size_t i = 0; i < group->mesh.positionCount; ++i) {
        group->mesh.positions[i] = Turn(group, group->mesh.positions[i]);
    }
    return status;
}

// What looks along `direction` at an instance looks along this at its mesh: the inverse transform,
// but for its length and its sign, of which views take no notice.
static pvtVec3 ToMesh(const double m[16], pvtVec3 direction)
{
    const pvtVec3 x = GetColumn(m, 0);
    const pvtVec3 y = GetColumn(m, 1);
    const pvtVec3 z = GetColumn(m, 2);
    return (pvtVec3){pvtDot(pvtCross(y, z), direction), pvtDot(pvtCross(z, x), direction),
                     pvtDot(pvtCross(x, y), direction)};
}

// The list as the first instances see it, as many of them as keep to MAX_VIEWS.
static pvtStatus TurnViews(pvtContext* context, const pvtInstanceSet* set,
                           const ptrdiff_t* ofInstance, size_t index, pvtGroup* group)
{
    pvtViewOptions* views = &group->options.views;
    const size_t fitting = views->listCount < MAX_VIEWS ? MAX_VIEWS / views->listCount : 1;
    const size_t instances = group->instanceCount < fitting ? group->instanceCount : fitting;
    group->views = pvtAllocate(context, instances * views->listCount, sizeof *group->views);
    if (group->views == NULL) {
        return pvtContext_GetStatus(context);
    }
    size_t count = 0;
    for (size_t i = group->firstInstance; count < instances * views->listCount; ++i) {
        for (size_t v = 0; ofInstance[i] == (ptrdiff_t)index && v < views->listCount; ++v) {
            const pvtVec3 direction = ToMesh(set->instances[i].transform, views->list[v].direction);
            group->views[count++] =
                (pvtWeightedDirection){Turn(group, pvtNormalize(direction)), views->list[v].weight};
        }
    }
    views->list = group->views;
    views->listCount = count;
    return PVT_OK;
}

static void ScaleLength(double scale, pvtLength* length)
{
    length->value = length->inVoxels ? length->value : length->value / scale;
}

static pvtStatus PrepareGroup(pvtContext* context, const Grouping* grouping, size_t index,
                              pvtGroupSet* groups)
{
    pvtGroup* group = &groups->groups[index];
    group->options = *grouping->options;
    group->options.budget = 1; // each gets its share later; measuring takes any
    group->options.error /= group->scale;
    ScaleLength(group->scale, &group->options.tolerance);
    ScaleLength(group->scale, &group->options.smallestHole);
    pvtStatus status = PVT_OK;
    if (IsTurned(group)) {
        status = TurnMesh(context, &grouping->set->meshes[group->source], group);
    }
    if (status == PVT_OK && group->options.views.list != NULL &&
        group->options.views.listCount > 0) {
        status = TurnViews(context, grouping->set, groups->ofInstance, index, group);
    }
    return status;
}

pvtStatus pvtGroupInstances(pvtContext* context, const pvtBuildOptions* options,
                            const pvtInstanceSet* set, pvtGroupSet* groups)
{
    *groups = (pvtGroupSet){0};
    Grouping grouping = {.options = options, .set = set};
    pvtStatus status = AllocateGroups(context, &grouping, groups);
    for (size_t i = 0; i < set->instanceCount && status == PVT_OK; ++i) {
        status = CheckInstance(context, set, i);
        grouping.isUsed[set->instances[i].mesh] = true;
    }
    if (status == PVT_OK) {
        status = pvtFindAlikeMeshes(context, set, grouping.isUsed, grouping.canonical);
    }
    if (status == PVT_OK) {
        FormGroups(&grouping, groups);
    }
    for (size_t i = 0; i < groups->count && status == PVT_OK; ++i) {
        status = PrepareGroup(context, &grouping, i, groups);
    }
    pvtRelease(context, grouping.canonical);
    pvtRelease(context, grouping.isUsed);
    pvtRelease(context, grouping.ofSides);
    if (status != PVT_OK) {
        pvtGroupSet_Free(context, groups);
    }
    return status;
}

void pvtGroupSet_Free(pvtContext* context, pvtGroupSet* set)
{
    for (size_t i = 0; i < set->count; ++i) {
        pvtMesh_Free(context, &set->groups[i].mesh);
        pvtRelease(context, set->groups[i].views);
    }
    pvtRelease(context, set->groups);
    pvtRelease(context, set->ofInstance);
    *set = (pvtGroupSet){0};
}

const pvtMesh* pvtGroup_GetMesh(const pvtGroup* group, const pvtInstanceSet* set)
{
    return IsTurned(group) ? &group->mesh : &set->meshes[group->source];
}

void pvtGroup_TurnBack(const pvtGroup* group, pvtMesh* mesh)
{
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        mesh->positions[i] = TurnBack(group, mesh->positions[i]);
    }
}
