// SPDX-License-Identifier: MIT
// pvtEvaluateOccluders draws rectangles with both corners uniform over the screen that the object
// spans, and counts their pixels: here they are drawn in proportion to their area, and count alike
// within a view. Only those that could be hidden are drawn, and a view counts by how much there is
// to hide.
#include "sight_subject.h"

#include "base/context.h"
#include "base/vector.h"
#include "occlusion/stride.h"

#include <math.h>
#include <string.h>

enum {
    SIZE = PVT_SIGHT_SIZE,
    CELLS = PVT_SIGHT_CELLS,
    MARGIN = 4, // [px]
    STREAM = 0x51675,
    LEAST_SIGHTS = 64,
    MOST_RING = 24, // cells
};

typedef struct Maker {
    pvtContext* context;
    const pvtSightOptions* options;
    const pvtSightSubject* subject;
    const pvtViewSet* views;
    pvtSightSet* set;
    pvtSightQuad* drawn;      // options->quads a sight
    pvtWrongQuad* drawnWrong; // as many; null where none are
} Maker;

void pvtSightSet_Free(pvtContext* context, pvtSightSet* set)
{
    pvtRelease(context, set->sights);
    pvtRelease(context, set->quads);
    pvtRelease(context, set->wrongs);
    *set = (pvtSightSet){0};
}

static void ToFloats(pvtVec3 from, double scale, float to[3])
{
    to[0] = (float)(from.x * scale);
    to[1] = (float)(from.y * scale);
    to[2] = (float)(from.z * scale);
}

static float Dot(const float a[3], const float b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// The box around the subject fills the screen up to a margin, shifted by part of a cell: so no two
// views have their cells in the same places.
static void AimSight(const pvtSightSubject* subject, const pvtView* view, pvtRandom* random,
                     pvtSight* sight)
{
    float center[3], span = 0.0F;
    float right[3], up[3];
    ToFloats(view->right, 1.0, right);
    ToFloats(view->up, 1.0, up);
    float halves[2] = {0};
    for (int axis = 0; axis < 3; ++axis) {
        center[axis] = 0.5F * (subject->low[axis] + subject->high[axis]);
        const float half = 0.5F * (subject->high[axis] - subject->low[axis]);
        halves[0] += (right[axis] < 0.0F ? -right[axis] : right[axis]) * half;
        halves[1] += (up[axis] < 0.0F ? -up[axis] : up[axis]) * half;
    }
    span = 2.0F * (halves[0] > halves[1] ? halves[0] : halves[1]);
    sight->pixelSize = span / (SIZE - MARGIN);
    ToFloats(view->right, 1.0 / sight->pixelSize, sight->right);
    ToFloats(view->up, 1.0 / sight->pixelSize, sight->up);
    const float cell = (float)SIZE / CELLS;
    const float shiftX = cell * ((float)pvtRandom_Unit(random) - 0.5F);
    const float shiftY = cell * ((float)pvtRandom_Unit(random) - 0.5F);
    sight->x = 0.5F * SIZE + shiftX - Dot(center, sight->right);
    sight->y = 0.5F * SIZE + shiftY - Dot(center, sight->up);
}

static void DrawQuads(const Maker* maker, size_t place, pvtRandom* random, pvtSight* sight)
{
    const int draws = maker->options->quads;
    uint64_t cells[CELLS];
    double weight = 0.0;
    pvtFindWholeCells(&sight->goal, cells);
    sight->quadCount =
        pvtDrawSightQuads(cells, draws, random, maker->drawn + place * (size_t)draws, &weight);
    sight->weight *= (float)weight;
    if (maker->drawnWrong != NULL) {
        const double cell = 2.0 * (double)sight->pixelSize;
        const double ring = ceil(maker->options->stray / cell) + 1.0;
        sight->wrongCount =
            pvtDrawWrongQuads(&sight->goal, ring < MOST_RING ? (int)ring : MOST_RING, draws, random,
                              maker->drawnWrong + place * (size_t)draws);
    }
}

static void MakeSightRange(size_t begin, size_t end, int worker, void* taskData)
{
    const Maker* maker = taskData;
    const pvtViewSet* views = maker->views;
    // A list may have more views than there are sights.
    const size_t count = maker->set->count;
    const size_t places = count > views->count ? count : views->count;
    const size_t stride = pvtGetViewStride(places);
    for (size_t s = begin; s < end && !pvtIsCancelled(maker->context); ++s) {
        pvtSight* sight = &maker->set->sights[s];
        pvtRandom random = pvtMakeRandom(maker->options->seed, STREAM + s);
        const pvtView* view = &views->views[s * stride % places % views->count];
        sight->weight = (float)(view->weight * (double)views->count);
        AimSight(maker->subject, view, &random, sight);
        maker->subject->draw(maker->subject->data, view, worker, sight);
        DrawQuads(maker, s, &random, sight);
    }
}

// The quads of all sights, one behind the other.
static pvtStatus PackQuads(pvtContext* context, const Maker* maker)
{
    pvtSightSet* set = maker->set;
    const size_t draws = (size_t)maker->options->quads;
    for (size_t s = 0; s < set->count; ++s) {
        pvtSight* sight = &set->sights[s];
        sight->firstQuad = set->quadCount;
        sight->firstWrong = set->wrongCount;
        set->quadCount += sight->quadCount;
        set->wrongCount += sight->wrongCount;
    }
    set->quads = pvtAllocate(context, set->quadCount, sizeof *set->quads);
    set->wrongs = pvtAllocate(context, set->wrongCount, sizeof *set->wrongs);
    if (set->quads == NULL || set->wrongs == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t s = 0; s < set->count; ++s) {
        const pvtSight* sight = &set->sights[s];
        memcpy(set->quads + sight->firstQuad, maker->drawn + s * draws,
               sight->quadCount * sizeof *set->quads);
        if (sight->wrongCount > 0) {
            memcpy(set->wrongs + sight->firstWrong, maker->drawnWrong + s * draws,
                   sight->wrongCount * sizeof *set->wrongs);
        }
    }
    return PVT_OK;
}

static void CountSights(const Maker* maker)
{
    const size_t asked = (size_t)maker->options->count;
    pvtSightSet* set = maker->set;
    set->count = (size_t)((double)asked * maker->subject->share);
    set->count = set->count < LEAST_SIGHTS ? LEAST_SIGHTS : set->count;
    set->count = set->count > asked ? asked : set->count;
    set->share = (double)set->count / (double)asked;
}

static pvtStatus FillSights(pvtContext* context, Maker* maker)
{
    pvtSightSet* set = maker->set;
    const size_t draws = set->count * (size_t)maker->options->quads;
    set->sights = pvtAllocate(context, set->count, sizeof *set->sights);
    maker->drawn = pvtAllocate(context, draws, sizeof *maker->drawn);
    if (set->sights == NULL || maker->drawn == NULL) {
        return pvtContext_GetStatus(context);
    }
    if (maker->subject->isExact) {
        maker->drawnWrong = pvtAllocate(context, draws, sizeof *maker->drawnWrong);
        if (maker->drawnWrong == NULL) {
            return pvtContext_GetStatus(context);
        }
    }
    pvtParallelFor(context, MakeSightRange, set->count, 1, maker);
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PackQuads(context, maker);
}

pvtStatus pvtMakeSights(pvtContext* context, const pvtSightOptions* options,
                        const pvtSightSubject* subject, pvtSightSet* set)
{
    *set = (pvtSightSet){0};
    pvtViewOptions spread = *options->views;
    pvtViewSet views = {0};
    Maker maker = {
        .context = context, .options = options, .subject = subject, .views = &views, .set = set};
    CountSights(&maker);
    spread.count = (int)set->count;
    pvtStatus status = pvtMakeViews(context, &spread, &views);
    if (status == PVT_OK) {
        status = FillSights(context, &maker);
    }
    pvtRelease(context, maker.drawn);
    pvtRelease(context, maker.drawnWrong);
    pvtViewSet_Free(context, &views);
    if (status != PVT_OK) {
        pvtSightSet_Free(context, set);
    }
    return status;
}
