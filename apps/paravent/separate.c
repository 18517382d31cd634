// SPDX-License-Identifier: MIT
#include "separate.h"

#include "stages.h"
#include "unique_names.h"
#include "values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static pvtStatus FailNoMemory(pvtRun* run)
{
    (void)pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory while the nodes are listed");
    return PVT_OUT_OF_MEMORY;
}

// The occluder of a node, or null.
static const pvtSeparateOccluder* FindOccluder(const pvtGenerated* generated, size_t node)
{
    const pvtSeparation* separation = &generated->separation;
    const ptrdiff_t index = separation->ofInstance[node];
    const pvtSeparateOccluder* occluder =
        index == PVT_NO_OCCLUDER ? NULL : &separation->occluders[index];
    return occluder != NULL && occluder->result == PVT_SEPARATE_MADE ? occluder : NULL;
}

static size_t CountNodes(const pvtGenerated* generated)
{
    size_t count = 0;
    for (size_t i = 0; i < generated->separation.instanceCount; ++i) {
        count += FindOccluder(generated, i) != NULL ? 1 : 0;
    }
    return count;
}

// Stages of meshes that are worked on side by side take more together than passes on the clock:
// each gets its share of that.
static void FitSeconds(pvtBuildStats* sum, double passed)
{
    const double factor = sum->seconds.total > passed ? passed / sum->seconds.total : 1.0;
    pvtScaleSeconds(sum, factor);
}

// Of the whole: the largest lengths, the sums of what can be summed, and a mean over the nodes.
static void SumUp(pvtGenerated* generated, double passed)
{
    pvtBuildStats* sum = &generated->stats;
    double nodes = 0.0;
    *sum = (pvtBuildStats){0};
    for (size_t i = 0; i < generated->separation.count; ++i) {
        const pvtSeparateOccluder* occluder = &generated->separation.occluders[i];
        const pvtBuildStats* stats = &occluder->stats;
        if (occluder->result == PVT_SEPARATE_HOLLOW) {
            continue;
        }
        const double instances = (double)occluder->instanceCount;
        sum->measureOfSolid += stats->measureOfSolid;
        sum->insideFraction += instances * stats->insideFraction;
        nodes += instances;
        if (occluder->result != PVT_SEPARATE_MADE) {
            continue;
        }
        sum->resolution = sum->resolution < stats->resolution ? stats->resolution : sum->resolution;
        sum->voxelSize = fmax(sum->voxelSize, stats->voxelSize);
        sum->tolerance = fmax(sum->tolerance, stats->tolerance);
        sum->smallestHole = fmax(sum->smallestHole, stats->smallestHole);
        sum->errorBound = fmax(sum->errorBound, stats->errorBound);
        sum->deviation = fmax(sum->deviation, stats->deviation);
        sum->surfacePanels += (int)occluder->instanceCount * stats->surfacePanels;
        sum->measure += stats->measure;
        sum->outside += stats->outside;
        sum->candidateCount += stats->candidateCount;
        generated->polygonCount += occluder->instanceCount * occluder->polygonCount;
        pvtAddSeconds(sum, stats);
    }
    sum->insideFraction /= nodes > 0.0 ? nodes : 1.0;
    FitSeconds(sum, passed);
}

static pvtStatus JoinOccluders(pvtRun* run, pvtGenerated* generated)
{
    const size_t count = generated->model.partCount;
    pvtPlacedMesh* placed = calloc(count + 1, sizeof *placed);
    if (placed == NULL) {
        return FailNoMemory(run);
    }
    size_t used = 0;
    for (size_t i = 0; i < count; ++i) {
        const pvtSeparateOccluder* occluder = FindOccluder(generated, i);
        if (occluder != NULL) {
            placed[used++] = (pvtPlacedMesh){&occluder->mesh, generated->model.parts[i].transform};
        }
    }
    const pvtStatus status = pvtPlaceMeshes(run->context, placed, used, &generated->occluder.mesh);
    free(placed);
    return status;
}

static void WarnOfFlatNodes(pvtRun* run, const pvtGenerated* generated)
{
    size_t flat = 0;
    for (size_t i = 0; i < generated->separation.instanceCount; ++i) {
        flat += generated->separation.ofInstance[i] == PVT_NO_OCCLUDER ? 1 : 0;
    }
    if (flat > 0) {
        pvtReport_Warn(&run->report, "%zu node%s flattened by the transform, and %s no occluder",
                       flat, flat == 1 ? " is" : "s are", flat == 1 ? "has" : "have");
    }
}

pvtStatus pvtBuildSeparately(pvtRun* run, const pvtBuildOptions* build, pvtGenerated* generated)
{
    const pvtModel* model = &generated->model;
    pvtInstance* instances = calloc(model->partCount + 1, sizeof *instances);
    if (instances == NULL) {
        return FailNoMemory(run);
    }
    for (size_t i = 0; i < model->partCount; ++i) {
        const pvtModelPart* part = &model->parts[i];
        instances[i] = (pvtInstance){part->meshIndex, part->transform, part->name};
    }
    const pvtInstanceSet set = {model->meshes, model->meshCount, instances, model->partCount};
    const double began = pvtGetClock();
    pvtStatus status = pvtBuildSeparateOccluders(run->context, build, &set, &generated->separation);
    free(instances);
    if (status == PVT_OK) {
        WarnOfFlatNodes(run, generated);
        SumUp(generated, pvtGetClock() - began);
        status = JoinOccluders(run, generated);
    }
    return status;
}

// What a file is made of, one entry a node that has an occluder.
typedef struct Items {
    pvtRun* run;
    size_t count;
    char** unique; // one a node of the input
    char** names;
    pvtMesh* moved;
    pvtExtra (*extras)[PVT_OCCLUDER_EXTRA_COUNT];
    pvtSaveItem* items;
} Items;

static void FreeItems(Items* items, size_t nodeCount)
{
    pvtFreeUniqueNames(items->unique, nodeCount);
    for (size_t i = 0; i < items->count; ++i) {
        free(items->names != NULL ? items->names[i] : NULL);
        if (items->moved != NULL) {
            pvtMesh_Free(items->run->context, &items->moved[i]);
        }
    }
    free(items->names);
    free(items->moved);
    free(items->extras);
    free(items->items);
}

static bool AllocateItems(const pvtGenerated* generated, Items* items)
{
    const size_t nodes = generated->model.partCount;
    const char** names = calloc(nodes + 1, sizeof *names);
    for (size_t i = 0; names != NULL && i < nodes; ++i) {
        names[i] = generated->model.parts[i].name;
    }
    items->unique = names != NULL ? pvtMakeUniqueNames(names, nodes) : NULL;
    free(names);
    items->names = calloc(nodes + 1, sizeof *items->names);
    items->moved = calloc(nodes + 1, sizeof *items->moved);
    items->extras = calloc(nodes + 1, sizeof *items->extras);
    items->items = calloc(nodes + 1, sizeof *items->items);
    return items->unique != NULL && items->names != NULL && items->moved != NULL &&
           items->extras != NULL && items->items != NULL;
}

// Godot's rule is that occluders have no transform; elsewhere instances share one mesh.
static pvtStatus AddItem(const pvtGenerateOptions* options, const pvtGenerated* generated,
                         size_t node, Items* items)
{
    const pvtSeparateOccluder* occluder = FindOccluder(generated, node);
    const double* transform = generated->model.parts[node].transform;
    const size_t index = items->count++;
    const size_t size = strlen(items->unique[node]) + 32;
    items->names[index] = malloc(size);
    if (items->names[index] == NULL) {
        return FailNoMemory(items->run);
    }
    pvtMakeNodeName(items->unique[node], options->convention, items->names[index], size);
    pvtListExtras(options, &occluder->stats, occluder->budget, items->extras[index]);
    pvtSaveItem* item = &items->items[index];
    *item = (pvtSaveItem){.name = items->names[index],
                          .mesh = &occluder->mesh,
                          .extras = items->extras[index],
                          .extraCount = PVT_OCCLUDER_EXTRA_COUNT,
                          .transform = transform};
    if (options->convention != PVT_CONVENTION_GODOT) {
        return PVT_OK;
    }
    const pvtPlacedMesh placed = {&occluder->mesh, transform};
    item->mesh = &items->moved[index];
    item->transform = NULL;
    return pvtPlaceMeshes(items->run->context, &placed, 1, &items->moved[index]);
}

pvtStatus pvtSaveSeparately(pvtRun* run, const pvtGenerateOptions* options,
                            const pvtGenerated* generated)
{
    Items items = {.run = run};
    pvtStatus status = PVT_OK;
    if (!AllocateItems(generated, &items)) {
        FreeItems(&items, generated->model.partCount);
        return FailNoMemory(run);
    }
    for (size_t i = 0; i < generated->model.partCount && status == PVT_OK; ++i) {
        if (FindOccluder(generated, i) != NULL) {
            status = AddItem(options, generated, i, &items);
        }
    }
    if (status == PVT_OK) {
        status = pvtSaveModel(run->context, options->output, items.items, items.count);
    }
    FreeItems(&items, generated->model.partCount);
    return status;
}

static void WriteOccluder(pvtJson* json, const pvtGenerated* generated,
                          const pvtSeparateOccluder* occluder)
{
    static const char* const results[] = {"made", "hollow", "no share"};
    const pvtBuildStats* stats = &occluder->stats;
    pvtJson_BeginObject(json, NULL);
    pvtJson_String(json, "node", generated->model.parts[occluder->firstInstance].name);
    pvtJson_Integer(json, "nodes", (int64_t)occluder->instanceCount);
    pvtJson_Integer(json, "mesh", (int64_t)occluder->source);
    pvtJson_Integer(json, "triangles_in",
                    (int64_t)generated->model.meshes[occluder->source].triangleCount);
    pvtJson_String(json, "result", results[occluder->result]);
    pvtJson_String(json, "reason", occluder->reason);
    pvtJson_Integer(json, "budget", occluder->budget);
    pvtJson_Integer(json, "triangles", (int64_t)occluder->mesh.triangleCount);
    pvtJson_Integer(json, "polygons", (int64_t)occluder->polygonCount);
    pvtJson_Number(json, "scale", occluder->scale);
    pvtJson_Integer(json, "resolution", stats->resolution);
    pvtJson_Number(json, "voxel_size", stats->voxelSize);
    pvtJson_Number(json, "error_bound", stats->errorBound);
    pvtJson_Number(json, "inside_fraction", stats->insideFraction);
    pvtJson_Number(json, "measure", stats->measure);
    pvtJson_Number(json, "measure_of_solid", stats->measureOfSolid);
    pvtJson_Integer(json, "outside", (int64_t)stats->outside);
    pvtWriteStage(json, "seconds", stats->seconds.total);
    pvtJson_EndObject(json);
}

void pvtWriteSeparate(pvtJson* json, const pvtGenerated* generated)
{
    const pvtSeparation* separation = &generated->separation;
    const size_t with = CountNodes(generated);
    pvtJson_Integer(json, "nodes", (int64_t)separation->instanceCount);
    pvtJson_Integer(json, "nodes_without", (int64_t)(separation->instanceCount - with));
    pvtJson_BeginArray(json, "occluders");
    for (size_t i = 0; i < separation->count; ++i) {
        WriteOccluder(json, generated, &separation->occluders[i]);
    }
    pvtJson_EndArray(json);
}

void pvtPrintSeparate(pvtRun* run, const pvtGenerateOptions* options, const pvtGenerated* generated)
{
    size_t made = 0;
    for (size_t i = 0; i < generated->separation.count; ++i) {
        made += generated->separation.occluders[i].result == PVT_SEPARATE_MADE ? 1 : 0;
    }
    char in[32];
    char out[32];
    pvtReport_Say(&run->report,
                  "%s: %zu occluder%s for %zu of %zu nodes, %s triangles as drawn, made from %s",
                  options->output, made, made == 1 ? "" : "s", CountNodes(generated),
                  generated->separation.instanceCount,
                  pvtFormatCount(generated->occluder.mesh.triangleCount, out),
                  pvtFormatCount(generated->model.mesh.triangleCount, in));
}
