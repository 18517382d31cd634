// SPDX-License-Identifier: MIT
// Sights of what is inside a field: its border nodes, which lie closer to each other than pixels,
// are splatted.
#include "points.h"
#include "sight_subject.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"
#include "field.h"
#include "sight_mask.h"
#include "voxel/bit_grid.h"

#include <string.h>

enum {
    SIZE = PVT_SIGHT_SIZE,
    EXPOSURES = 64, // sets of sides of a node
};

// Points at the border of an object as many nodes long: a cube has 6, and what is full of holes
// more.
static const double MANY_POINTS = 8.5;
static const float WIDENING = 1.2F; // of nodes, which are seen as squares: cubes cover more

typedef struct Splatter {
    float* points[3]; // [vx] nodes beside some that are not inside, along each axis
    size_t pointCount;
    size_t starts[EXPOSURES + 1]; // in the points, by the sides that they are exposed on
    float nodeSize;               // [vx]
    float low[3], high[3];        // [vx] around the points
} Splatter;

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
static void SplatGoal(const void* data, const pvtView* view, int worker, pvtSight* sight)
{
    (void)worker;
    const Splatter* splatter = data;
    unsigned facing = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double along = pvtGetAxis(view->direction, axis);
        facing |= (along < 0.0 ? 1U : along > 0.0 ? 2U : 0U) << (2 * axis);
    }
    if (GetReach(splatter, sight) <= 0.5F * WIDENING) {
        SplatSmallNodes(splatter, facing, sight);
    } else {
        SplatLargeNodes(splatter, facing, sight);
    }
    FillGaps(&sight->goal);
}

// What is full of holes has several times the border of any other solid, and no triangles that many
// steps would help: its sights are fewer, so that time stays bounded.
static double GetShare(const pvtField* field, size_t points)
{
    const double side = pvtGetLongestSide(field->size);
    const double many = MANY_POINTS * side * side;
    return (double)points > many ? many / (double)points : 1.0;
}

pvtStatus pvtCreateSights(pvtContext* context, const pvtSightOptions* options,
                          const pvtField* field, pvtSightSet* set)
{
    *set = (pvtSightSet){0};
    Splatter splatter = {0};
    pvtStatus status = ListBorder(context, field, &splatter);
    if (status == PVT_OK) {
        pvtSightSubject subject = {
            .data = &splatter, .share = GetShare(field, splatter.pointCount), .draw = SplatGoal};
        memcpy(subject.low, splatter.low, sizeof subject.low);
        memcpy(subject.high, splatter.high, sizeof subject.high);
        status = pvtMakeSights(context, options, &subject, set);
    }
    for (int axis = 0; axis < 3; ++axis) {
        pvtRelease(context, splatter.points[axis]);
    }
    return status;
}
