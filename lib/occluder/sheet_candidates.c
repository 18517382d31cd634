// SPDX-License-Identifier: MIT
// What sheets add to the candidates and to the ceiling. Their cells are slices as any others, made
// by a slicer of their own.
#include "sheets.h"

#include "base/bits.h"
#include "base/context.h"

#include <math.h>
#include <string.h>

// Voxels from the lowest to the highest place of the plane over a voxel column.
static void MarkColumn(const pvtPlane* plane, int u, int v, pvtBitGrid* grid)
{
    const double one = 1 << PVT_PLANE_BITS;
    const double du = plane->slopeU / one;
    const double dv = plane->slopeV / one;
    const double height = (double)plane->offset / one + du * u + dv * v;
    int voxel[3];
    voxel[pvtPlane_GetU(plane)] = u;
    voxel[pvtPlane_GetV(plane)] = v;
    const int first = (int)floor(height + fmin(du, 0.0) + fmin(dv, 0.0));
    const int last = (int)floor(height + fmax(du, 0.0) + fmax(dv, 0.0));
    for (int at = first; at <= last; ++at) {
        voxel[plane->axis] = at;
        if (at >= 0 && at < grid->frame.size[plane->axis]) {
            const size_t row = (size_t)voxel[2] * (size_t)grid->frame.size[1] + (size_t)voxel[1];
            pvtSetBit(grid->words + row * grid->wordsPerRow, (size_t)voxel[0]);
        }
    }
}

// Whether all cells of a voxel's column are the sheet's.
static bool IsColumnWhole(const pvtSheet* sheet, int cells, int u, int v)
{
    for (int y = v * cells; y < (v + 1) * cells; ++y) {
        for (int x = u * cells; x < (u + 1) * cells; ++x) {
            if (!pvtBitmap_Get(&sheet->cells, x - sheet->corner[0], y - sheet->corner[1])) {
                return false;
            }
        }
    }
    return true;
}

pvtStatus pvtMarkSheets(pvtContext* context, const pvtSheetSet* set, const pvtBitGrid* grid,
                        pvtBitGrid* marked)
{
    *marked = *grid;
    marked->words = pvtAllocate(context, grid->wordCount, sizeof *grid->words);
    if (marked->words == NULL) {
        *marked = (pvtBitGrid){0};
        return pvtContext_GetStatus(context);
    }
    memcpy(marked->words, grid->words, grid->wordCount * sizeof *grid->words);
    const int cells = set->cellsPerVoxel;
    for (size_t s = 0; s < set->count; ++s) {
        const pvtSheet* sheet = &set->sheets[s];
        const int right = (sheet->corner[0] + sheet->cells.width) / cells;
        const int top = (sheet->corner[1] + sheet->cells.height) / cells;
        for (int v = sheet->corner[1] / cells; v < top; ++v) {
            for (int u = sheet->corner[0] / cells; u < right; ++u) {
                if (IsColumnWhole(sheet, cells, u, v)) {
                    MarkColumn(&sheet->plane, u, v, marked);
                }
            }
        }
    }
    return PVT_OK;
}

static pvtStatus SliceSheet(pvtContext* context, void* user, const pvtPlane* plane,
                            int cellsPerVoxel, pvtBitmap* slice)
{
    (void)context;
    memset(slice->words, 0, slice->wordsPerRow * (size_t)slice->height * sizeof *slice->words);
    pvtAddSheetCells(user, plane, cellsPerVoxel, slice);
    return PVT_OK;
}

static void* Grow(pvtContext* context, void* memory, size_t count, size_t size, bool* failed)
{
    void* grown = pvtReallocate(context, memory, count, size);
    *failed = *failed || grown == NULL;
    return grown != NULL ? grown : memory;
}

// Appends all of `from`; on failure `to` holds what it held.
static pvtStatus AppendCandidates(pvtContext* context, const pvtCandidateSet* from,
                                  pvtCandidateSet* to)
{
    pvtChainSet* chains = &to->chains;
    const pvtChainSet* more = &from->chains;
    const size_t points = chains->pointCount + more->pointCount;
    const size_t count = chains->count + more->count;
    bool failed = false;
    chains->points = Grow(context, chains->points, points, sizeof *chains->points, &failed);
    chains->ranks = Grow(context, chains->ranks, points, sizeof *chains->ranks, &failed);
    chains->limits = Grow(context, chains->limits, points, sizeof *chains->limits, &failed);
    chains->starts = Grow(context, chains->starts, count + 1, sizeof *chains->starts, &failed);
    to->planes = Grow(context, to->planes, count, sizeof *to->planes, &failed);
    to->triangles = Grow(context, to->triangles, count, sizeof *to->triangles, &failed);
    if (failed) {
        return pvtContext_GetStatus(context);
    }
    if (more->count == 0) {
        return PVT_OK;
    }
    const size_t p = chains->pointCount;
    memcpy(chains->points + p, more->points, more->pointCount * sizeof *more->points);
    memcpy(chains->ranks + p, more->ranks, more->pointCount * sizeof *more->ranks);
    memcpy(chains->limits + p, more->limits, more->pointCount * sizeof *more->limits);
    memcpy(to->planes + chains->count, from->planes, more->count * sizeof *from->planes);
    memcpy(to->triangles + chains->count, from->triangles, more->count * sizeof *from->triangles);
    for (size_t c = 0; c <= more->count; ++c) {
        chains->starts[chains->count + c] = p + more->starts[c];
    }
    chains->pointCount = points;
    chains->count = count;
    return PVT_OK;
}

pvtStatus pvtAddSheetCandidates(pvtContext* context, const pvtCandidateOptions* options,
                                const pvtSliceVolume* volume, const pvtSheetSet* sheets,
                                pvtCandidateSet* candidates)
{
    if (sheets->count == 0) {
        return PVT_OK;
    }
    pvtSectionSet sections = {.count = sheets->count, .cellsPerVoxel = sheets->cellsPerVoxel};
    sections.sections = pvtAllocate(context, sections.count, sizeof *sections.sections);
    if (sections.sections == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t i = 0; i < sections.count; ++i) {
        sections.sections[i] = (pvtSection){sheets->sheets[i].plane, sheets->sheets[i].area};
    }
    const pvtSlicer slicer = {.slice = SliceSheet, .user = (void*)sheets};
    pvtCandidateOptions own = *options;
    own.cellsPerVoxel = sheets->cellsPerVoxel;
    own.slicer = &slicer;
    pvtCandidateSet more;
    pvtStatus status = pvtBuildCandidates(context, &own, volume, &sections, &more);
    if (status == PVT_OK) {
        status = AppendCandidates(context, &more, candidates);
        pvtCandidateSet_Free(context, &more);
    }
    pvtRelease(context, sections.sections);
    return status;
}
