// SPDX-License-Identifier: MIT
// Which triangles the ascent takes away, and where it adds some.
#include "ascent_state.h"

#include "base/context.h"

#include <math.h>
#include <string.h>

enum {
    MOST_TAKEN = 16, // at once, as long as none is another's partner
};

static const float MOST_REACH = 40.0F; // [vx] that a new triangle is thought to grow
static const float NEW_SQUARE = 0.1F;  // of the greatest: what new corners start from

// Moves what is kept of each corner to where it went.
static void DropCorners(pvtAscent* ascent)
{
    pvtTriangleSet_DropCorners(&ascent->set, ascent->moved);
    for (int c = 0; c < ascent->set.cornerCount; ++c) {
        const int32_t from = ascent->moved[c];
        memmove(ascent->speeds[c], ascent->speeds[from], sizeof *ascent->speeds);
        ascent->squares[c] = ascent->squares[from];
    }
}

static bool IsPartnerOfAny(const pvtPuller* puller, const int* taken, int count, int triangle)
{
    for (int i = 0; i < count; ++i) {
        if (pvtArePartners(puller, taken[i], triangle)) {
            return true;
        }
    }
    return false;
}

// The least useful triangles, none of which covers for another; at least one.
static int ChooseTriangles(const pvtAscent* ascent, int most, int taken[MOST_TAKEN])
{
    const pvtPuller* puller = &ascent->puller;
    bool isSeen[3 * PVT_MOST_ASCENT + 16] = {false};
    int count = 0;
    for (int seen = 0; seen < MOST_TAKEN && count < most && count < MOST_TAKEN; ++seen) {
        int least = -1;
        for (int t = 0; t < ascent->set.triangleCount; ++t) {
            if (!isSeen[t] && puller->triangles[t] < HUGE_VAL &&
                (least < 0 || puller->triangles[t] < puller->triangles[least])) {
                least = t;
            }
        }
        if (least < 0) {
            break;
        }
        isSeen[least] = true;
        if (!IsPartnerOfAny(puller, taken, count, least)) {
            taken[count++] = least;
        }
    }
    return count;
}

void pvtAscent_Prune(pvtContext* context, pvtAscent* ascent, int count)
{
    const pvtPullOptions options = {.first = ascent->next,
                                    .count = PVT_MOST_WEIGHED,
                                    .softness = ascent->softness,
                                    .inset = PVT_ASCENT_INSET};
    while (ascent->set.triangleCount > count && !pvtIsCancelled(context)) {
        pvtWeighTriangles(context, &options, &ascent->puller);
        int taken[MOST_TAKEN];
        int left = ChooseTriangles(ascent, ascent->set.triangleCount - count, taken);
        // From the last index down, so that the others stay valid.
        for (; left > 0; --left) {
            int last = 0;
            for (int i = 1; i < left; ++i) {
                last = taken[i] > taken[last] ? i : last;
            }
            pvtTriangleSet_Remove(&ascent->set, taken[last]);
            taken[last] = taken[left - 1];
        }
        DropCorners(ascent);
        pvtTriangleSet_FindEdges(&ascent->set);
        ascent->contactAge = 0;
    }
}

// How far one can go before leaving the inside.
static float GetReach(const pvtField* field, const float from[3], const float way[3])
{
    float reach = 0.0F;
    float point[3];
    for (; reach < MOST_REACH; reach += 1.0F) {
        for (int axis = 0; axis < 3; ++axis) {
            point[axis] = from[axis] + way[axis] * (reach + 1.0F);
        }
        if (pvtField_GetDepth(field, point) < 0.0F) {
            break;
        }
    }
    return reach;
}

// What a triangle on an edge could gain: the pull on its middle times the way that it could go.
// None grows from panels on the surface, since it would not be inside there.
static float JudgeEdge(const pvtAscent* ascent, int edge, float tip[3])
{
    const pvtTriangleSet* set = &ascent->set;
    const float* pull = ascent->puller.edges[edge];
    const float strength = sqrtf(pull[0] * pull[0] + pull[1] * pull[1] + pull[2] * pull[2]);
    const float* a = set->corners[set->edges[edge].ends[0]];
    const float* b = set->corners[set->edges[edge].ends[1]];
    if (!(strength > 0.0F) || set->isFixed[set->edges[edge].ends[0]] ||
        set->isFixed[set->edges[edge].ends[1]]) {
        return 0.0F;
    }
    float middle[3], way[3];
    for (int axis = 0; axis < 3; ++axis) {
        middle[axis] = 0.5F * (a[axis] + b[axis]);
        way[axis] = pull[axis] / strength;
        tip[axis] = middle[axis] + way[axis];
    }
    return strength * GetReach(&ascent->field, middle, way);
}

// The tag of a triangle on the edge.
static int32_t GetTag(const pvtTriangleSet* set, const pvtTriangleEdge* edge)
{
    for (int t = 0; t < set->triangleCount; ++t) {
        if (pvtHasCorner(set->triangles[t], edge->ends[0]) &&
            pvtHasCorner(set->triangles[t], edge->ends[1])) {
            return set->tags[t];
        }
    }
    return 0;
}

void pvtAscent_Grow(pvtAscent* ascent, int count)
{
    pvtTriangleSet* set = &ascent->set;
    float most = 0.0F;
    for (int c = 0; c < set->cornerCount; ++c) {
        most = ascent->squares[c] > most ? ascent->squares[c] : most;
    }
    // Edges by what they could gain, best first; only as many as are wanted are looked for.
    bool isTaken[3 * (3 * PVT_MOST_ASCENT + 16)] = {false};
    const int edges = set->edgeCount;
    for (int added = 0; added < count && set->triangleCount < set->triangleCapacity; ++added) {
        int best = -1;
        float gain = 0.0F, tip[3] = {0};
        for (int e = 0; e < edges; ++e) {
            float here[3];
            const float judged = isTaken[e] ? 0.0F : JudgeEdge(ascent, e, here);
            if (judged > gain) {
                gain = judged;
                best = e;
                memcpy(tip, here, sizeof tip);
            }
        }
        if (best < 0) {
            break;
        }
        isTaken[best] = true;
        const uint32_t corner = pvtTriangleSet_AddCorner(set, tip, false);
        memset(ascent->speeds[corner], 0, sizeof *ascent->speeds);
        ascent->squares[corner] = NEW_SQUARE * most;
        const pvtTriangleEdge* edge = &set->edges[best];
        for (int axis = 0; axis < 3; ++axis) {
            set->anchors[corner][axis] =
                0.5F * (set->anchors[edge->ends[0]][axis] + set->anchors[edge->ends[1]][axis]);
        }
        pvtTriangleSet_AddTriangle(set, (uint32_t[3]){edge->ends[0], edge->ends[1], corner},
                                   GetTag(set, edge));
    }
    pvtTriangleSet_FindEdges(set);
    ascent->contactAge = 0;
}
