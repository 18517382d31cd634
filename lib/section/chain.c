// SPDX-License-Identifier: MIT
// Chains of links from polygons.
//
// After Silvennoinen et al., "Occluder Simplification Using Planar Sections", 2014, section 4.4:
// from each polygon down to one triangle. lattice.c takes a raw contour down to a few hundred
// points, links.c from there to three; this file is the way in and out.
#include "base/context.h"
#include "lattice.h"
#include "links.h"
#include "loops.h"

#include <math.h>

// Below this many points steps are chosen with care rather than for speed.
enum { FEW_POINTS = 96 };

typedef struct Builder {
    const pvtChainOptions* options;
    const pvtLoopSet* polygons;
    pvtLattice lattice;
    pvtLinks links;
    pvtPoint2* reduced;
} Builder;

pvtChainOptions pvtDefaultChainOptions(void)
{
    return (pvtChainOptions){.maxTriangles = 64, .minArea = 1.0, .cellsPerVoxel = 1};
}

void pvtChainSet_Free(pvtContext* context, pvtChainSet* chains)
{
    pvtRelease(context, chains->points);
    pvtRelease(context, chains->ranks);
    pvtRelease(context, chains->limits);
    pvtRelease(context, chains->starts);
    *chains = (pvtChainSet){0};
}

size_t pvtChainSet_GetLink(const pvtChainSet* chains, size_t chain, int triangles,
                           pvtPoint2* points)
{
    const uint32_t size = (uint32_t)triangles + 2;
    size_t count = 0;
    for (size_t i = chains->starts[chain]; i < chains->starts[chain + 1]; ++i) {
        if (chains->ranks[i] <= size && size <= chains->limits[i]) {
            points[count++] = chains->points[i];
        }
    }
    return count;
}

// Points of the longest link, and the number at which careful steps begin.
static uint32_t GetLongest(const pvtChainOptions* options)
{
    return (uint32_t)options->maxTriangles + 2;
}

static uint32_t GetCarefulCount(const pvtChainOptions* options)
{
    const uint32_t longest = GetLongest(options);
    return longest > FEW_POINTS / 2 ? 2 * longest : FEW_POINTS;
}

static pvtStatus CheckOptions(pvtContext* context, const pvtChainOptions* options)
{
    const int cells = options->cellsPerVoxel;
    if (options->maxTriangles < 1 || options->maxTriangles > INT32_MAX / 8) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "maxTriangles is %d; it must be 1 or more",
                       options->maxTriangles);
    }
    if (options->allowed != NULL && cells != 1 && cells != 2 && cells != 4) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "cellsPerVoxel is %d; it must be 1, 2 or 4",
                       cells);
    }
    return PVT_OK;
}

// Points that links.c may be given at once.
static size_t GetLinksCapacity(const pvtLoopSet* polygons, uint32_t careful)
{
    size_t most = 0;
    for (size_t l = 0; l < polygons->loopCount; ++l) {
        const size_t count = pvtLoopSet_GetSize(polygons, l);
        const bool isReduced =
            count > careful &&
            pvtFindLatticeUnit(polygons->points + polygons->starts[l], count) != 0;
        const size_t given = isReduced ? careful : count;
        most = given > most ? given : most;
    }
    return most;
}

// Points of the longest link and of shorter ones.
static size_t GetChainCapacity(const pvtLoopSet* polygons, size_t loop, uint32_t longest)
{
    const size_t count = pvtLoopSet_GetSize(polygons, loop);
    return pvtGetLinkNodeLimit(count < longest ? count : longest);
}

static pvtStatus CreateChains(pvtContext* context, const Builder* builder, pvtChainSet* chains)
{
    const pvtLoopSet* polygons = builder->polygons;
    size_t points = 0;
    for (size_t l = 0; l < polygons->loopCount; ++l) {
        points += GetChainCapacity(polygons, l, builder->links.longest);
    }
    *chains = (pvtChainSet){
        .points = pvtAllocate(context, points, sizeof *chains->points),
        .ranks = pvtAllocate(context, points, sizeof *chains->ranks),
        .limits = pvtAllocate(context, points, sizeof *chains->limits),
        .starts = pvtAllocate(context, polygons->loopCount + 1, sizeof *chains->starts),
    };
    if (chains->points == NULL || chains->ranks == NULL || chains->limits == NULL ||
        chains->starts == NULL) {
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

static pvtStatus CreateBuilder(pvtContext* context, Builder* builder)
{
    const uint32_t careful = GetCarefulCount(builder->options);
    const size_t capacity = GetLinksCapacity(builder->polygons, careful);
    const pvtChainOptions* options = builder->options;
    pvtStatus status = pvtCreateLattice(context, builder->polygons, careful, &builder->lattice);
    if (status != PVT_OK) {
        return status;
    }
    status = pvtCreateLinks(context, capacity, GetLongest(options), &builder->links);
    if (status != PVT_OK) {
        return status;
    }
    builder->reduced =
        pvtAllocate(context, builder->polygons->pointCount, sizeof *builder->reduced);
    if (builder->reduced == NULL) {
        return pvtContext_GetStatus(context);
    }
    if (options->allowed != NULL) {
        const int32_t unit = (1 << PVT_POINT_BITS) / options->cellsPerVoxel;
        builder->lattice.cells = builder->links.cells = options->allowed;
        builder->lattice.cellUnit = builder->links.cellUnit = unit;
    }
    return PVT_OK;
}

static void FreeBuilder(pvtContext* context, Builder* builder)
{
    pvtLattice_Free(context, &builder->lattice);
    pvtLinks_Free(context, &builder->links);
    pvtRelease(context, builder->reduced);
}

static void AddChain(const pvtLinks* links, pvtChainSet* chains)
{
    for (uint32_t node = links->first; node != UINT32_MAX; node = links->nodes[node].behind) {
        const pvtLinkNode* at = &links->nodes[node];
        if (at->rank <= at->limit) { // not when it slid on at once
            chains->points[chains->pointCount] = links->ring.nodes[node].point;
            chains->ranks[chains->pointCount] = at->rank;
            chains->limits[chains->pointCount++] = at->limit;
        }
    }
    chains->starts[++chains->count] = chains->pointCount;
}

static pvtStatus BuildChain(pvtContext* context, Builder* builder, size_t loop, pvtChainSet* chains)
{
    const pvtPoint2* points = builder->polygons->points + builder->polygons->starts[loop];
    size_t count = pvtLoopSet_GetSize(builder->polygons, loop);
    const double voxel = 1 << PVT_POINT_BITS;
    const double least = fmax(builder->options->minArea * (2.0 * voxel * voxel), 1.0);
    if (count < 3 || (double)pvtGetLoopArea2(points, count) < least) {
        return PVT_OK;
    }
    if (count > builder->lattice.target && pvtFindLatticeUnit(points, count) != 0) {
        const pvtStatus status =
            pvtLattice_Reduce(context, &builder->lattice, points, count, builder->reduced);
        if (status != PVT_OK || builder->lattice.count > builder->lattice.target) {
            return status;
        }
        points = builder->reduced;
        count = builder->lattice.count;
    }
    const pvtStatus status = pvtLinks_Build(context, &builder->links, points, count);
    if (status == PVT_OK && builder->links.ring.count == 3) {
        AddChain(&builder->links, chains);
    }
    return status;
}

static pvtStatus BuildAll(pvtContext* context, Builder* builder, pvtChainSet* chains)
{
    for (size_t loop = 0; loop < builder->polygons->loopCount; ++loop) {
        if (loop % 64 == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        const pvtStatus status = BuildChain(context, builder, loop, chains);
        if (status != PVT_OK) {
            return status;
        }
    }
    return PVT_OK;
}

pvtStatus pvtBuildChains(pvtContext* context, const pvtChainOptions* options,
                         const pvtLoopSet* polygons, pvtChainSet* chains)
{
    *chains = (pvtChainSet){0};
    pvtStatus status = CheckOptions(context, options);
    if (status != PVT_OK) {
        return status;
    }
    Builder builder = {.options = options, .polygons = polygons};
    status = CreateBuilder(context, &builder);
    if (status == PVT_OK) {
        status = CreateChains(context, &builder, chains);
    }
    if (status == PVT_OK) {
        status = BuildAll(context, &builder, chains);
    }
    FreeBuilder(context, &builder);
    if (status != PVT_OK) {
        pvtChainSet_Free(context, chains);
    }
    return status;
}
