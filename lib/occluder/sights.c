// SPDX-License-Identifier: MIT
// Goals are splatted from the border nodes of the field, which lie closer to each other than
// pixels. Rectangles have both corners uniform over the screen that the goal spans, as those of
// pvtEvaluateOccluders; only those that could be hidden are kept, so that a view counts by how much
// there is to hide.
#include "sights.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/random.h"
#include "base/vector.h"
#include "occlusion/stride.h"

#include <string.h>

enum { SIZE = PVT_SIGHT_SIZE, MARGIN = 2, STREAM = 0x51675 };

typedef struct Splatter {
    pvtContext* context;
    const pvtSightOptions* options;
    float (*points)[3]; // [vx] border nodes
    size_t pointCount;
    float nodeSize;        // [vx]
    float low[3], high[3]; // [vx] around the points
    const pvtViewSet* views;
    pvtSightSet* set;
    pvtSightQuad* drawn; // options->quads a sight
} Splatter;

void pvtSightSet_Free(pvtContext* context, pvtSightSet* set)
{
    pvtRelease(context, set->sights);
    pvtRelease(context, set->quads);
    *set = (pvtSightSet){0};
}

// Inside, and not far from what is not.
static bool IsBorder(int8_t depth)
{
    return depth > -PVT_FIELD_STEPS / 2 && depth <= PVT_FIELD_STEPS;
}

static void AddPoint(Splatter* splatter, const pvtField* field, const int node[3])
{
    if (splatter->points != NULL) {
        for (int axis = 0; axis < 3; ++axis) {
            const float at = ((float)node[axis] + 0.5F) * (float)field->nodeSize;
            const float half = 0.5F * (float)field->nodeSize;
            splatter->points[splatter->pointCount][axis] = at;
            splatter->low[axis] = at - half < splatter->low[axis] ? at - half : splatter->low[axis];
            splatter->high[axis] =
                at + half > splatter->high[axis] ? at + half : splatter->high[axis];
        }
    }
    ++splatter->pointCount;
}

static void ListBorder(Splatter* splatter, const pvtField* field)
{
    const int8_t* depth = field->depths;
    splatter->pointCount = 0;
    for (int z = 0; z < field->size[2]; ++z) {
        for (int y = 0; y < field->size[1]; ++y) {
            for (int x = 0; x < field->size[0]; ++x) {
                if (IsBorder(*depth++)) {
                    AddPoint(splatter, field, (int[3]){x, y, z});
                }
            }
        }
    }
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

// The box around the points fills the screen up to a margin, shifted by part of a pixel: so no two
// views have their pixels in the same places.
static void AimSight(const Splatter* splatter, const pvtView* view, pvtRandom* random,
                     pvtSight* sight)
{
    float center[3], span = 0.0F;
    float right[3], up[3];
    ToFloats(view->right, 1.0, right);
    ToFloats(view->up, 1.0, up);
    float halves[2] = {0};
    for (int axis = 0; axis < 3; ++axis) {
        center[axis] = 0.5F * (splatter->low[axis] + splatter->high[axis]);
        const float half = 0.5F * (splatter->high[axis] - splatter->low[axis]);
        halves[0] += (right[axis] < 0.0F ? -right[axis] : right[axis]) * half;
        halves[1] += (up[axis] < 0.0F ? -up[axis] : up[axis]) * half;
    }
    span = 2.0F * (halves[0] > halves[1] ? halves[0] : halves[1]);
    sight->pixelSize = span / (SIZE - MARGIN);
    ToFloats(view->right, 1.0 / sight->pixelSize, sight->right);
    ToFloats(view->up, 1.0 / sight->pixelSize, sight->up);
    const float shiftX = (float)pvtRandom_Unit(random) - 0.5F;
    const float shiftY = (float)pvtRandom_Unit(random) - 0.5F;
    sight->x = 0.5F * SIZE + shiftX - Dot(center, sight->right);
    sight->y = 0.5F * SIZE + shiftY - Dot(center, sight->up);
}

// Bits 0, 2, 4, ... of a word, next to each other.
static uint64_t PackEven(uint64_t bits)
{
    bits &= UINT64_C(0x5555555555555555);
    bits = (bits | bits >> 1) & UINT64_C(0x3333333333333333);
    bits = (bits | bits >> 2) & UINT64_C(0x0F0F0F0F0F0F0F0F);
    bits = (bits | bits >> 4) & UINT64_C(0x00FF00FF00FF00FF);
    bits = (bits | bits >> 8) & UINT64_C(0x0000FFFF0000FFFF);
    return (bits | bits >> 16) & UINT64_C(0x00000000FFFFFFFF);
}

// Sets the half pixels that a node covers, seen as a square; a small one sets that of its middle.
static void SplatNode(uint64_t (*halves)[2], float x, float y, float reach)
{
    const int left = (int)(x - reach + 0.5F), right = (int)(x + reach + 0.5F);
    const int low = (int)(y - reach + 0.5F), high = (int)(y + reach + 0.5F);
    if (x < 0.0F || y < 0.0F || x >= 2 * SIZE || y >= 2 * SIZE) {
        return;
    }
    pvtSetBit(halves[(int)y], (size_t)x);
    for (int row = low > 0 ? low : 0; row < high && row < 2 * SIZE && left < right; ++row) {
        pvtSetBitRange(halves[row], left > 0 ? (size_t)left : 0,
                       right < 2 * SIZE ? (size_t)right : 2 * SIZE);
    }
}

// On pixels of half the size, four of which have to be set: a pixel that is covered in part only
// could never be hidden as a whole.
static void SplatGoal(const Splatter* splatter, pvtSight* sight)
{
    uint64_t halves[2 * SIZE][2];
    memset(halves, 0, sizeof halves);
    const float reach = splatter->nodeSize / sight->pixelSize;
    for (size_t i = 0; i < splatter->pointCount; ++i) {
        const float* point = splatter->points[i];
        SplatNode(halves, 2.0F * (Dot(point, sight->right) + sight->x),
                  2.0F * (Dot(point, sight->up) + sight->y), reach);
    }
    for (size_t y = 0; y < SIZE; ++y) {
        uint64_t row = 0;
        for (size_t word = 0; word < 2; ++word) {
            const uint64_t both = halves[2 * y][word] & halves[2 * y + 1][word];
            row |= PackEven(both & both >> 1) << (32 * word);
        }
        sight->goal[y] = row;
    }
}

static bool IsWithin(const uint64_t goal[SIZE], const pvtSightQuad* quad)
{
    const uint64_t mask = pvtMakeMask(quad->x0, quad->x1);
    for (int y = quad->y0; y < quad->y1; ++y) {
        if ((goal[y] & mask) != mask) {
            return false;
        }
    }
    return true;
}

// Both ends of a side, in order, from low to high − 1.
static void DrawSide(pvtRandom* random, int low, int high, uint8_t* begin, uint8_t* end)
{
    const int a = low + (int)pvtRandom_Below(random, (uint32_t)(high - low));
    const int b = low + (int)pvtRandom_Below(random, (uint32_t)(high - low));
    *begin = (uint8_t)(a < b ? a : b);
    *end = (uint8_t)((a < b ? b : a) + 1);
}

static void DrawQuads(const Splatter* splatter, pvtRandom* random, pvtSight* sight,
                      pvtSightQuad* quads)
{
    uint64_t columns = 0;
    int low = SIZE, high = 0;
    for (int y = 0; y < SIZE; ++y) {
        columns |= sight->goal[y];
        low = sight->goal[y] != 0 && low == SIZE ? y : low;
        high = sight->goal[y] != 0 ? y + 1 : high;
    }
    if (columns == 0) {
        return;
    }
    const int left = __builtin_ctzll(columns), right = 64 - __builtin_clzll(columns);
    for (int i = 0; i < splatter->options->quads; ++i) {
        pvtSightQuad* quad = &quads[sight->quadCount];
        DrawSide(random, left, right, &quad->x0, &quad->x1);
        DrawSide(random, low, high, &quad->y0, &quad->y1);
        sight->quadCount += IsWithin(sight->goal, quad) ? 1 : 0;
    }
}

static void MakeSightRange(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Splatter* splatter = taskData;
    const pvtViewSet* views = splatter->views;
    const size_t stride = pvtGetViewStride(splatter->set->count);
    for (size_t s = begin; s < end && !pvtIsCancelled(splatter->context); ++s) {
        pvtSight* sight = &splatter->set->sights[s];
        pvtRandom random = pvtMakeRandom(splatter->options->seed, STREAM + s);
        const pvtView* view = &views->views[s * stride % splatter->set->count % views->count];
        sight->weight = (float)(view->weight * (double)views->count);
        AimSight(splatter, view, &random, sight);
        SplatGoal(splatter, sight);
        DrawQuads(splatter, &random, sight, splatter->drawn + s * (size_t)splatter->options->quads);
    }
}

// The quads of all sights, one behind the other.
static pvtStatus PackQuads(pvtContext* context, const Splatter* splatter)
{
    pvtSightSet* set = splatter->set;
    for (size_t s = 0; s < set->count; ++s) {
        set->sights[s].firstQuad = set->quadCount;
        set->quadCount += set->sights[s].quadCount;
    }
    set->quads = pvtAllocate(context, set->quadCount, sizeof *set->quads);
    if (set->quads == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t s = 0; s < set->count; ++s) {
        memcpy(set->quads + set->sights[s].firstQuad,
               splatter->drawn + s * (size_t)splatter->options->quads,
               set->sights[s].quadCount * sizeof *set->quads);
    }
    return PVT_OK;
}

static pvtStatus FillSights(pvtContext* context, Splatter* splatter, const pvtField* field)
{
    splatter->nodeSize = (float)field->nodeSize;
    ListBorder(splatter, field);
    splatter->points = pvtAllocate(context, splatter->pointCount, sizeof *splatter->points);
    splatter->drawn = pvtAllocate(context, splatter->set->count * (size_t)splatter->options->quads,
                                  sizeof *splatter->drawn);
    splatter->set->sights =
        pvtAllocate(context, splatter->set->count, sizeof *splatter->set->sights);
    if (splatter->points == NULL || splatter->drawn == NULL || splatter->set->sights == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (int axis = 0; axis < 3; ++axis) {
        splatter->low[axis] = (float)(field->size[axis] * field->nodeSize);
        splatter->high[axis] = 0.0F;
    }
    ListBorder(splatter, field);
    pvtParallelFor(context, MakeSightRange, splatter->set->count, 1, splatter);
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PackQuads(context, splatter);
}

pvtStatus pvtCreateSights(pvtContext* context, const pvtSightOptions* options,
                          const pvtField* field, pvtSightSet* set)
{
    *set = (pvtSightSet){.count = (size_t)options->count};
    pvtViewOptions spread = *options->views;
    spread.count = options->count;
    pvtViewSet views;
    pvtStatus status = pvtMakeViews(context, &spread, &views);
    Splatter splatter = {.context = context, .options = options, .views = &views, .set = set};
    if (status == PVT_OK) {
        status = FillSights(context, &splatter, field);
    }
    pvtRelease(context, splatter.points);
    pvtRelease(context, splatter.drawn);
    pvtViewSet_Free(context, &views);
    if (status != PVT_OK) {
        pvtSightSet_Free(context, set);
    }
    return status;
}
