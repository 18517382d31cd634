// SPDX-License-Identifier: MIT
// Which planes to slice (Silvennoinen et al., Occluder Simplification Using Planar Sections, 2014,
// section 4.2). Where the paper draws planes at random, here each bin of direction and depth is
// sampled evenly, and the directions of faces and axes, where panels of buildings lie, are sampled
// at every voxel.
#include "base/context.h"
#include "directions.h"

#include <paravent/section.h>
#include <stdlib.h>

#define VOXEL (INT64_C(1) << PVT_PLANE_BITS)

enum { MAX_SAMPLES = 64 };

pvtPlanOptions pvtDefaultPlanOptions(void)
{
    return (pvtPlanOptions){
        .directions = 32, .axes = true, .depths = 24, .samplesPerBin = 8, .outermost = 1.0};
}

void pvtSectionPlan_Free(pvtContext* context, pvtSectionPlan* plan)
{
    pvtRelease(context, plan->planes);
    pvtRelease(context, plan->binStarts);
    *plan = (pvtSectionPlan){0};
}

static pvtStatus CheckOptions(pvtContext* context, const pvtPlanOptions* options)
{
    if (options->directions < 0 || options->directions > 4096) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%d directions; it must be 0 to 4096",
                       options->directions);
    }
    if (options->depths < 1 || options->depths > 256) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%d depths; it must be 1 to 256",
                       options->depths);
    }
    if (options->samplesPerBin < 1 || options->samplesPerBin > MAX_SAMPLES) {
        return pvtFail(context, PVT_INVALID_ARGUMENT, "%d samples a bin; it must be 1 to %d",
                       options->samplesPerBin, MAX_SAMPLES);
    }
    // Also refuses what is not a number.
    if (!(options->outermost > 0.0 && options->outermost < 1e6)) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "outermost is %g; it must be above 0 and below a million",
                       options->outermost);
    }
    return PVT_OK;
}

// The plan is gone through twice: without arrays to count, then to fill them.
static void AddPlane(pvtSectionPlan* plan, const pvtPlane* shape, int64_t offset)
{
    if (plan->planes != NULL) {
        plan->planes[plan->planeCount] = *shape;
        plan->planes[plan->planeCount].offset = offset | 1;
    }
    ++plan->planeCount;
}

static void EndBin(pvtSectionPlan* plan)
{
    ++plan->binCount;
    if (plan->binStarts != NULL) {
        plan->binStarts[plan->binCount] = plan->planeCount;
    }
}

static void AddDepthBins(const pvtPlanOptions* options, const pvtPlanLine* line,
                         pvtSectionPlan* plan)
{
    const int64_t extent = line->range.upper - line->range.lower;
    const int64_t voxels = (extent + VOXEL - 1) / VOXEL;
    const int64_t bins = voxels < options->depths ? voxels : options->depths;
    const int64_t layers = (voxels + bins - 1) / bins;
    const int64_t most = line->strong ? MAX_SAMPLES : options->samplesPerBin;
    const int64_t samples = layers < most ? layers : most;
    for (int64_t bin = 0; bin < bins; ++bin) {
        for (int64_t sample = 0; sample < samples; ++sample) {
            const int64_t place = 2 * (bin * samples + sample) + 1;
            AddPlane(plan, &line->shape, line->range.lower + extent * place / (2 * bins * samples));
        }
        EndBin(plan);
    }
}

// Set voxels that fill a half-space end in steps across its face. A slanted plane is free of the
// gaps between those steps at a depth that depends on how the steps fall, and of all gaps below
// 1 + |slopeU| + |slopeV| voxels: a few depths up to there are tried. Across an axis there are no
// steps, and the middle of the outermost layer is all there is to try.
static void AddEndBins(const pvtPlanOptions* options, const pvtPlanLine* line, pvtSectionPlan* plan)
{
    const double step = 0.5 * options->outermost * (double)VOXEL;
    const int64_t slopes = labs(line->shape.slopeU) + labs(line->shape.slopeV);
    const int samples = slopes == 0 ? 1 : 2 + (int)((2 * slopes + VOXEL - 1) / VOXEL);
    for (int end = 0; end < 2; ++end) {
        for (int sample = 1; sample <= samples; ++sample) {
            const int64_t depth = (int64_t)(step * sample);
            AddPlane(plan, &line->shape,
                     end == 0 ? line->range.lower + depth : line->range.upper - depth);
        }
        EndBin(plan);
    }
}

static void AddLines(const pvtPlanOptions* options, const pvtPlanLine* lines, size_t count,
                     pvtSectionPlan* plan)
{
    for (size_t i = 0; i < count; ++i) {
        if (lines[i].range.lower < lines[i].range.upper) {
            AddDepthBins(options, &lines[i], plan);
            if (lines[i].strong) {
                AddEndBins(options, &lines[i], plan);
            }
        }
    }
}

static pvtStatus FillPlan(pvtContext* context, const pvtPlanOptions* options,
                          const pvtPlanLine* lines, size_t count, pvtSectionPlan* plan)
{
    pvtSectionPlan counted = {0};
    AddLines(options, lines, count, &counted);
    plan->planes = pvtAllocate(context, counted.planeCount, sizeof *plan->planes);
    plan->binStarts = plan->planes == NULL
                          ? NULL
                          : pvtAllocate(context, counted.binCount + 1, sizeof *plan->binStarts);
    if (plan->binStarts == NULL) {
        pvtSectionPlan_Free(context, plan);
        return pvtContext_GetStatus(context);
    }
    AddLines(options, lines, count, plan);
    return PVT_OK;
}

pvtStatus pvtPlanSections(pvtContext* context, const pvtPlanOptions* options,
                          const pvtBitGrid* grid, pvtSectionPlan* plan)
{
    *plan = (pvtSectionPlan){0};
    pvtPlanLine* lines = NULL;
    size_t count = 0;
    pvtStatus status = CheckOptions(context, options);
    if (status == PVT_OK) {
        status = pvtCollectDirections(context, options, &grid->frame, &lines, &count);
    }
    if (status == PVT_OK) {
        status = pvtMeasureExtents(context, grid, lines, count);
    }
    if (status == PVT_OK) {
        status = FillPlan(context, options, lines, count, plan);
    }
    pvtRelease(context, lines);
    return status;
}
