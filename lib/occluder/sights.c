// SPDX-License-Identifier: MIT
// Goals are splatted from the border nodes of the field, which lie closer to each other than
// pixels. pvtEvaluateOccluders draws rectangles with both corners uniform over the screen that the
// object spans, and counts their pixels: here they are drawn in proportion to their area, and count
// alike within a view. Only those that could be hidden are drawn, and a view counts by how much
// there is to hide.
#include "sights.h"
#include "points.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/random.h"
#include "base/vector.h"
#include "occlusion/stride.h"
#include "voxel/bit_grid.h"

#include <string.h>

enum {
    SIZE = PVT_SIGHT_SIZE,
    CELLS = PVT_SIGHT_CELLS,
    MARGIN = 4, // [px]
    STREAM = 0x51675,
    EXPOSURES = 64, // sets of sides of a node
    LEAST_SIGHTS = 64,
};

// Points at the border of an object as many nodes long: a cube has 6, and what is full of holes
// more.
static const double MANY_POINTS = 8.5;
static const float WIDENING = 1.2F; // of nodes, which are seen as squares: cubes cover more

typedef struct Splatter {
    pvtContext* context;
    const pvtSightOptions* options;
    float* points[3]; // [vx] nodes beside some that are not inside, along each axis
    size_t pointCount;
    size_t starts[EXPOSURES + 1]; // in the points, by the sides that they are exposed on
    float nodeSize;               // [vx]
    float low[3], high[3];        // [vx] around the points
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

static bool IsInGrid(const pvtField* field, const int node[3])
{
    const int* size = field->size;
    return node[0] >= 0 && node[1] >= 0 && node[2] >= 0 && node[0] < size[0] && node[1] < size[1] &&
           node[2] < size[2];
}

// The middle of such a node is inside, or less than half a node away from it.
static bool IsDepthIn(int8_t depth)
{
    return depth > -PVT_FIELD_STEPS / 2;
}

static bool IsIn(const pvtField* field, const int node[3])
{
    return IsInGrid(field, node) && IsDepthIn(pvtField_GetNode(field, node[0], node[1], node[2]));
}

// Bit 2a: beside it towards lower coordinates along axis a is a node that is not inside; bit 2a + 1
// the same towards higher ones.
static unsigned FindExposure(const pvtField* field, const int node[3])
{
    const int8_t depth = pvtField_GetNode(field, node[0], node[1], node[2]);
    if (!IsDepthIn(depth)) {
        return 0;
    }
    const bool isDeep = depth > PVT_FIELD_STEPS;
    unsigned exposure = 0;
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            int beside[3] = {node[0], node[1], node[2]};
            beside[axis] += side == 0 ? -1 : 1;
            // What is a node or more inside has none but those beyond the grid.
            if (isDeep ? !IsInGrid(field, beside) : !IsIn(field, beside)) {
                exposure |= 1U << (2 * axis + side);
            }
        }
    }
    return exposure;
}

typedef struct BorderTask {
    const pvtField* field;
    uint8_t* exposures; // of the nodes, x first
} BorderTask;

static void FindExposures(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const BorderTask* task = taskData;
    const int* size = task->field->size;
    uint8_t* next = task->exposures + begin * (size_t)size[0] * (size_t)size[1];
    for (int z = (int)begin; z < (int)end; ++z) {
        for (int y = 0; y < size[1]; ++y) {
            for (int x = 0; x < size[0]; ++x) {
                *next++ = (uint8_t)FindExposure(task->field, (int[3]){x, y, z});
            }
        }
    }
}

static void AddPoint(Splatter* splatter, size_t place, const size_t node[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const float at = ((float)node[axis] + 0.5F) * splatter->nodeSize;
        const float half = 0.5F * splatter->nodeSize;
        splatter->points[axis][place] = at;
        splatter->low[axis] = at - half < splatter->low[axis] ? at - half : splatter->low[axis];
        splatter->high[axis] = at + half > splatter->high[axis] ? at + half : splatter->high[axis];
    }
}

static pvtStatus SortPoints(pvtContext* context, const pvtField* field, const uint8_t* exposures,
                            Splatter* splatter)
{
    const size_t width = (size_t)field->size[0], height = (size_t)field->size[1];
    const size_t count = width * height * (size_t)field->size[2];
    size_t next[EXPOSURES] = {0};
    for (size_t i = 0; i < count; ++i) {
        ++next[exposures[i]];
    }
    next[0] = 0; // no points
    for (size_t e = 0; e < EXPOSURES; ++e) {
        splatter->starts[e] = splatter->pointCount;
        splatter->pointCount += next[e];
        next[e] = splatter->starts[e];
    }
    splatter->starts[EXPOSURES] = splatter->pointCount;
    for (int axis = 0; axis < 3; ++axis) {
        splatter->points[axis] =
            pvtAllocate(context, splatter->pointCount, sizeof *splatter->points[axis]);
        splatter->low[axis] = (float)field->size[axis] * splatter->nodeSize;
        if (splatter->points[axis] == NULL) {
            return pvtContext_GetStatus(context);
        }
    }
    for (size_t i = 0; i < count; ++i) {
        if (exposures[i] != 0) {
            const size_t node[3] = {i % width, i / width % height, i / width / height};
            AddPoint(splatter, next[exposures[i]]++, node);
        }
    }
    return PVT_OK;
}

static pvtStatus ListBorder(pvtContext* context, const pvtField* field, Splatter* splatter)
{
    const size_t count = (size_t)field->size[0] * (size_t)field->size[1] * (size_t)field->size[2];
    BorderTask task = {field, pvtAllocateUnset(context, count, 1)};
    splatter->nodeSize = (float)field->nodeSize;
    if (task.exposures == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtParallelFor(context, FindExposures, (size_t)field->size[2], 4, &task);
    const pvtStatus status = SortPoints(context, field, task.exposures, splatter);
    pvtRelease(context, task.exposures);
    return status;
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

// The box around the points fills the screen up to a margin, shifted by part of a cell: so no two
// views have their cells in the same places.
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
    const float cell = (float)SIZE / CELLS;
    const float shiftX = cell * ((float)pvtRandom_Unit(random) - 0.5F);
    const float shiftY = cell * ((float)pvtRandom_Unit(random) - 0.5F);
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

// Sets the pixels that a node covers, seen as a square.
static void SplatNode(pvtSightMask* mask, float x, float y, float reach)
{
    const int left = (int)(x - reach + 0.5F), right = (int)(x + reach + 0.5F);
    const int low = (int)(y - reach + 0.5F), high = (int)(y + reach + 0.5F);
    for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
        const int first = left > 64 * half ? left - 64 * half : 0;
        const int end = right < 64 * (half + 1) ? right - 64 * half : 64;
        if (first >= end) {
            continue;
        }
        const uint64_t bits = pvtMakeMask((unsigned)first, (unsigned)end);
        for (int row = low > 0 ? low : 0; row < high && row < SIZE; ++row) {
            mask->words[half][row] |= bits;
        }
    }
}

static pvtPointProjection MakeProjection(const pvtSight* sight)
{
    pvtPointProjection projection = {.offset = {sight->x, sight->y}};
    for (int axis = 0; axis < 3; ++axis) {
        projection.right[axis] = sight->right[axis];
        projection.up[axis] = sight->up[axis];
    }
    return projection;
}

static float GetReach(const Splatter* splatter, const pvtSight* sight)
{
    return 0.5F * WIDENING * splatter->nodeSize / sight->pixelSize;
}

static void SplatNodes(const Splatter* splatter, pvtSight* sight, size_t begin, size_t end)
{
    const pvtPointProjection projection = MakeProjection(sight);
    const float reach = GetReach(splatter, sight);
    float places[2][PVT_POINT_GROUP];
    for (size_t first = begin; first < end; first += PVT_POINT_GROUP) {
        const size_t count = end - first < PVT_POINT_GROUP ? end - first : PVT_POINT_GROUP;
        pvtProjectPoints(&projection, splatter->points, first, count, places);
        for (size_t i = 0; i < count; ++i) {
            const float x = places[0][i], y = places[1][i];
            if (x >= 0.0F && y >= 0.0F && x < SIZE && y < SIZE) {
                SplatNode(&sight->goal, x, y, reach);
            }
        }
    }
}

// The pixels that the middles of nodes lie in, a byte each.
static void MarkMiddles(const Splatter* splatter, const pvtSight* sight, size_t begin, size_t end,
                        uint8_t pixels[SIZE * SIZE + 1])
{
    const pvtPointProjection projection = MakeProjection(sight);
    int32_t places[PVT_POINT_GROUP];
    for (size_t first = begin; first < end; first += PVT_POINT_GROUP) {
        const size_t count = end - first < PVT_POINT_GROUP ? end - first : PVT_POINT_GROUP;
        pvtFindPixels(&projection, splatter->points, first, count, SIZE, places);
        for (size_t i = 0; i < count; ++i) {
            pixels[places[i]] = 1;
        }
    }
}

static void SplatLargeNodes(const Splatter* splatter, unsigned facing, pvtSight* sight)
{
    memset(&sight->goal, 0, sizeof sight->goal);
    for (unsigned e = 1; e < EXPOSURES; ++e) {
        if ((e & facing) != 0) {
            SplatNodes(splatter, sight, splatter->starts[e], splatter->starts[e + 1]);
        }
    }
}

// Nodes that are small set the pixel of their middle each. It is a byte, since with bits each would
// wait for the one before, which sets one of the same word.
static void SplatSmallNodes(const Splatter* splatter, unsigned facing, pvtSight* sight)
{
    uint8_t pixels[SIZE * SIZE + 1] = {0}; // the last one: beside the mask
    for (unsigned e = 1; e < EXPOSURES; ++e) {
        if ((e & facing) != 0) {
            MarkMiddles(splatter, sight, splatter->starts[e], splatter->starts[e + 1], pixels);
        }
    }
    for (size_t y = 0; y < SIZE; ++y) {
        for (size_t half = 0; half < PVT_SIGHT_WORDS; ++half) {
            sight->goal.words[half][y] = pvtPackWord(pixels + SIZE * y + 64 * half);
        }
    }
}

// Nodes are as far from each other as pixels are: one between two that are set is set, too.
static void FillGaps(pvtSightMask* mask)
{
    uint64_t before[2] = {0};
    for (int y = 0; y < SIZE; ++y) {
        const uint64_t low = mask->words[0][y], high = mask->words[1][y];
        const uint64_t sides[2] = {(low << 1) & (low >> 1 | high << 63),
                                   (high << 1 | low >> 63) & high >> 1};
        for (int half = 0; half < 2; ++half) {
            const uint64_t after = y + 1 < SIZE ? mask->words[half][y + 1] : 0;
            const uint64_t here = mask->words[half][y];
            mask->words[half][y] |= sides[half] | (before[half] & after);
            before[half] = here;
        }
    }
}

// Whatever is seen is entered through a side that faces the viewer, so that nodes that are exposed
// on other sides only are left out.
static void SplatGoal(const Splatter* splatter, pvtVec3 direction, pvtSight* sight)
{
    unsigned facing = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double along = pvtGetAxis(direction, axis);
        facing |= (along < 0.0 ? 1U : along > 0.0 ? 2U : 0U) << (2 * axis);
    }
    if (GetReach(splatter, sight) <= 0.5F * WIDENING) {
        SplatSmallNodes(splatter, facing, sight);
    } else {
        SplatLargeNodes(splatter, facing, sight);
    }
    FillGaps(&sight->goal);
}

// Cells of which all four pixels are set: one that is covered in part only could never be hidden as
// a whole.
static void FindWholeCells(const pvtSightMask* goal, uint64_t cells[CELLS])
{
    for (int y = 0; y < CELLS; ++y) {
        cells[y] = 0;
        for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
            const uint64_t both = goal->words[half][2 * y] & goal->words[half][2 * y + 1];
            cells[y] |= PackEven(both & both >> 1) << (32 * half);
        }
    }
}

static void DrawQuads(const Splatter* splatter, pvtRandom* random, pvtSight* sight,
                      pvtSightQuad* quads)
{
    uint64_t cells[CELLS];
    double weight = 0.0;
    FindWholeCells(&sight->goal, cells);
    sight->quadCount = pvtDrawSightQuads(cells, splatter->options->quads, random, quads, &weight);
    sight->weight *= (float)weight;
}

static void MakeSightRange(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Splatter* splatter = taskData;
    const pvtViewSet* views = splatter->views;
    // A list may have more views than there are sights.
    const size_t count = splatter->set->count;
    const size_t places = count > views->count ? count : views->count;
    const size_t stride = pvtGetViewStride(places);
    for (size_t s = begin; s < end && !pvtIsCancelled(splatter->context); ++s) {
        pvtSight* sight = &splatter->set->sights[s];
        pvtRandom random = pvtMakeRandom(splatter->options->seed, STREAM + s);
        const pvtView* view = &views->views[s * stride % places % views->count];
        sight->weight = (float)(view->weight * (double)views->count);
        AimSight(splatter, view, &random, sight);
        SplatGoal(splatter, view->direction, sight);
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

// What is full of holes has several times the border of any other solid, and no triangles that many
// steps would help: its sights are fewer, so that time stays bounded.
static void CountSights(const pvtSightOptions* options, const pvtField* field, size_t points,
                        pvtSightSet* set)
{
    const size_t asked = (size_t)options->count;
    const double side = pvtGetLongestSide(field->size);
    const double many = MANY_POINTS * side * side;
    set->count = (double)points > many ? (size_t)((double)asked * many / (double)points) : asked;
    set->count = set->count < LEAST_SIGHTS ? LEAST_SIGHTS : set->count;
    set->count = set->count > asked ? asked : set->count;
    set->share = (double)set->count / (double)asked;
}

static pvtStatus FillSights(pvtContext* context, Splatter* splatter)
{
    splatter->drawn = pvtAllocate(context, splatter->set->count * (size_t)splatter->options->quads,
                                  sizeof *splatter->drawn);
    splatter->set->sights =
        pvtAllocate(context, splatter->set->count, sizeof *splatter->set->sights);
    if (splatter->drawn == NULL || splatter->set->sights == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtParallelFor(context, MakeSightRange, splatter->set->count, 1, splatter);
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PackQuads(context, splatter);
}

pvtStatus pvtCreateSights(pvtContext* context, const pvtSightOptions* options,
                          const pvtField* field, pvtSightSet* set)
{
    *set = (pvtSightSet){0};
    pvtViewOptions spread = *options->views;
    pvtViewSet views = {0};
    Splatter splatter = {.context = context, .options = options, .views = &views, .set = set};
    pvtStatus status = ListBorder(context, field, &splatter);
    if (status == PVT_OK) {
        CountSights(options, field, splatter.pointCount, set);
        spread.count = (int)set->count;
        status = pvtMakeViews(context, &spread, &views);
    }
    if (status == PVT_OK) {
        status = FillSights(context, &splatter);
    }
    for (int axis = 0; axis < 3; ++axis) {
        pvtRelease(context, splatter.points[axis]);
    }
    pvtRelease(context, splatter.drawn);
    pvtViewSet_Free(context, &views);
    if (status != PVT_OK) {
        pvtSightSet_Free(context, set);
    }
    return status;
}
