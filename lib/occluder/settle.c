// SPDX-License-Identifier: MIT
// From nearly inside to inside. The field knows the border to a fraction of a voxel; what the exact
// test objects to keeps a greater distance from it, round after round. Then corners follow the pull
// once more, each as far as the exact test lets the triangles around it go.
#include "ascent_state.h"

#include "base/context.h"
#include "base/vector.h"

#include <string.h>

enum { MOST_ROUNDS = 64, RETREATS = 8, ATTEMPTS = 3 };

static const float LEAST_PUSH = 0.06F, PUSH_GROWTH = 0.01F; // [vx], and more with every round
static const float POLISH_REACH = 0.25F;                    // [vx]

// As it will be read: rounded to world units.
static void GetCorners(const pvtAscent* ascent, int triangle, pvtVec3 corners[3])
{
    for (int k = 0; k < 3; ++k) {
        const float* corner = ascent->set.corners[ascent->set.triangles[triangle][k]];
        corners[k] = pvtScale(pvtSub(pvtAscent_GetPlace(ascent, corner), ascent->frame.origin),
                              1.0 / ascent->frame.voxelSize);
    }
}

static bool IsInside(const pvtAscent* ascent, int triangle)
{
    pvtVec3 corners[3];
    GetCorners(ascent, triangle, corners);
    return pvtInsideTest_HasTriangle(ascent->options->inside, corners);
}

// What is looked at again: triangles of which a corner moved since they were found inside.
typedef struct Settling {
    pvtAscent* ascent;
    bool* isSettled;
    pvtContact* contacts; // one a triangle
    bool* isOutside;
} Settling;

// Shares of the corners in a point of the triangle (Ericson, Real-Time Collision Detection, 2004,
// section 3.4).
static void FindShares(const pvtVec3 corners[3], pvtVec3 point, float shares[3])
{
    const pvtVec3 a = pvtSub(corners[1], corners[0]), b = pvtSub(corners[2], corners[0]);
    const pvtVec3 p = pvtSub(point, corners[0]);
    const double aa = pvtDot(a, a), ab = pvtDot(a, b), bb = pvtDot(b, b);
    const double pa = pvtDot(p, a), pb = pvtDot(p, b);
    const double scale = aa * bb - ab * ab;
    const double u = scale > 0.0 ? (bb * pa - ab * pb) / scale : 0.0;
    const double v = scale > 0.0 ? (aa * pb - ab * pa) / scale : 0.0;
    shares[0] = (float)(1.0 - u - v);
    shares[1] = (float)u;
    shares[2] = (float)v;
}

static void TestTriangles(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Settling* settling = taskData;
    const pvtAscent* ascent = settling->ascent;
    for (int t = (int)begin; t < (int)end; ++t) {
        settling->isOutside[t] = false;
        if (settling->isSettled[t]) {
            continue;
        }
        pvtVec3 corners[3], outside;
        GetCorners(ascent, t, corners);
        settling->isSettled[t] =
            pvtInsideTest_FindOutside(ascent->options->inside, corners, &outside);
        if (!settling->isSettled[t]) {
            pvtContact* contact = &settling->contacts[t];
            contact->triangle = t;
            FindShares(corners, outside, contact->shares);
            const float point[3] = {(float)outside.x, (float)outside.y, (float)outside.z};
            contact->depth = pvtField_GetDepthAndInward(&ascent->field, point, contact->inward);
            settling->isOutside[t] = true;
        }
    }
}

static void Unsettle(const Settling* settling, const uint32_t moved[3])
{
    const pvtTriangleSet* set = &settling->ascent->set;
    for (int t = 0; t < set->triangleCount; ++t) {
        for (int k = 0; k < 9; ++k) {
            if (set->triangles[t][k / 3] == moved[k % 3]) {
                settling->isSettled[t] = false;
            }
        }
    }
}

static int TestAll(pvtContext* context, Settling* settling)
{
    const int count = settling->ascent->set.triangleCount;
    int outside = 0;
    pvtParallelFor(context, TestTriangles, (size_t)count, 1, settling);
    for (int t = 0; t < count; ++t) {
        outside += settling->isOutside[t] ? 1 : 0;
    }
    return outside;
}

// Each triangle goes inwards where the test says that it is not inside.
static void PushOutside(Settling* settling, int round)
{
    pvtAscent* ascent = settling->ascent;
    const float least = LEAST_PUSH + PUSH_GROWTH * (float)round;
    for (int t = 0; t < ascent->set.triangleCount; ++t) {
        if (settling->isOutside[t]) {
            const float lack = least - settling->contacts[t].depth;
            pvtMoveContact(&settling->contacts[t], &ascent->set, lack > least ? lack : least);
            Unsettle(settling, ascent->set.triangles[t]);
        }
    }
}

// What is still outside goes back towards where it was inside, in the end all the way.
static void RetreatOutside(Settling* settling, int retreat)
{
    pvtTriangleSet* set = &settling->ascent->set;
    const float part = 1.0F / (float)(RETREATS - retreat);
    for (int t = 0; t < set->triangleCount; ++t) {
        if (settling->isOutside[t]) {
            for (int k = 0; k < 3; ++k) {
                float* corner = set->corners[set->triangles[t][k]];
                const float* anchor = set->anchors[set->triangles[t][k]];
                for (int axis = 0; axis < 3; ++axis) {
                    corner[axis] = part < 1.0F ? corner[axis] + part * (anchor[axis] - corner[axis])
                                               : anchor[axis];
                }
            }
            Unsettle(settling, set->triangles[t]);
        }
    }
}

static void TakeOutside(Settling* settling)
{
    for (int t = settling->ascent->set.triangleCount - 1; t >= 0; --t) {
        if (settling->isOutside[t]) {
            pvtTriangleSet_Remove(&settling->ascent->set, t);
        }
    }
    pvtTriangleSet_FindEdges(&settling->ascent->set);
}

static pvtStatus BringInside(pvtContext* context, Settling* settling)
{
    const pvtTriangleSet* set = &settling->ascent->set;
    for (int t = 0; t < set->triangleCount; ++t) {
        settling->isSettled[t] = pvtTriangleSet_IsFixed(set, t);
    }
    int outside = TestAll(context, settling);
    for (int round = 0; round < MOST_ROUNDS && outside > 0; ++round) {
        PushOutside(settling, round);
        outside = TestAll(context, settling);
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
    }
    // Each retreat to the anchors may unsettle neighbours, which then retreat as well.
    for (int retreat = 0; outside > 0 && retreat < RETREATS + set->triangleCount; ++retreat) {
        RetreatOutside(settling, retreat < RETREATS ? retreat : RETREATS - 1);
        outside = TestAll(context, settling);
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
    }
    // Rounding to float may have moved an anchor by a hair.
    if (outside > 0) {
        TakeOutside(settling);
    }
    return PVT_OK;
}

static bool AreTrianglesAroundInside(const pvtAscent* ascent, uint32_t corner)
{
    const pvtTriangleSet* set = &ascent->set;
    for (int t = 0; t < set->triangleCount; ++t) {
        const uint32_t* corners = set->triangles[t];
        if ((corners[0] == corner || corners[1] == corner || corners[2] == corner) &&
            !IsInside(ascent, t)) {
            return false;
        }
    }
    return true;
}

// Corners on the way to where a step would take them, a group at a time.
typedef struct Polishing {
    pvtAscent* ascent;
    float (*steps)[3];
    bool* isLeft;    // of each corner: it has yet to be moved
    bool* isTaken;   // of each triangle: a corner of the group is one of its
    uint32_t* group; // no two corners of a triangle
    size_t groupSize;
} Polishing;

// Halved until it fits; the corner stays where it is when it never does.
static void MoveCorner(pvtAscent* ascent, uint32_t corner, const float step[3])
{
    float* place = ascent->set.corners[corner];
    float before[3];
    memcpy(before, place, sizeof before);
    float scale = 1.0F;
    for (int attempt = 0; attempt < ATTEMPTS; ++attempt, scale *= 0.5F) {
        for (int axis = 0; axis < 3; ++axis) {
            place[axis] = before[axis] + scale * step[axis];
        }
        if (AreTrianglesAroundInside(ascent, corner)) {
            return;
        }
    }
    memcpy(place, before, sizeof before);
}

static void MoveCorners(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Polishing* polishing = taskData;
    for (size_t i = begin; i < end; ++i) {
        const uint32_t corner = polishing->group[i];
        MoveCorner(polishing->ascent, corner, polishing->steps[corner]);
    }
}

// Of the triangles around a corner, marks all; false when one of them is taken already.
static bool TakeTriangles(Polishing* polishing, uint32_t corner)
{
    const pvtTriangleSet* set = &polishing->ascent->set;
    for (int pass = 0; pass < 2; ++pass) {
        for (int t = 0; t < set->triangleCount; ++t) {
            const uint32_t* corners = set->triangles[t];
            if (corners[0] != corner && corners[1] != corner && corners[2] != corner) {
                continue;
            }
            if (pass == 0 && polishing->isTaken[t]) {
                return false;
            }
            polishing->isTaken[t] = pass == 1;
        }
    }
    return true;
}

static void ChooseGroup(Polishing* polishing)
{
    const pvtTriangleSet* set = &polishing->ascent->set;
    memset(polishing->isTaken, 0, (size_t)set->triangleCount * sizeof *polishing->isTaken);
    polishing->groupSize = 0;
    for (uint32_t c = 0; c < (uint32_t)set->cornerCount; ++c) {
        if (polishing->isLeft[c] && TakeTriangles(polishing, c)) {
            polishing->group[polishing->groupSize++] = c;
            polishing->isLeft[c] = false;
        }
    }
}

// A step of the ascent that never leaves the inside.
static void PolishOnce(pvtContext* context, Polishing* polishing)
{
    pvtTriangleSet* set = &polishing->ascent->set;
    const size_t bytes = (size_t)set->cornerCount * sizeof *set->corners;
    memcpy(polishing->steps, set->corners, bytes);
    pvtAscent_Step(context, polishing->ascent, false);
    for (int c = 0; c < set->cornerCount; ++c) {
        float* step = polishing->steps[c];
        polishing->isLeft[c] = false;
        for (int axis = 0; axis < 3; ++axis) {
            const float before = step[axis];
            step[axis] = set->corners[c][axis] - before;
            set->corners[c][axis] = before;
            polishing->isLeft[c] = polishing->isLeft[c] || (step[axis] != 0.0F && !set->isFixed[c]);
        }
    }
    for (ChooseGroup(polishing); polishing->groupSize > 0; ChooseGroup(polishing)) {
        pvtParallelFor(context, MoveCorners, polishing->groupSize, 1, polishing);
    }
}

static pvtStatus Polish(pvtContext* context, pvtAscent* ascent)
{
    const size_t corners = (size_t)ascent->set.cornerCount;
    Polishing polishing = {.ascent = ascent};
    polishing.steps = pvtAllocate(context, corners, sizeof *polishing.steps);
    polishing.isLeft = pvtAllocate(context, corners, sizeof *polishing.isLeft);
    polishing.group = pvtAllocate(context, corners, sizeof *polishing.group);
    polishing.isTaken = pvtAllocate(context, (size_t)ascent->set.triangleCount, sizeof(bool));
    pvtStatus status = polishing.steps == NULL || polishing.isLeft == NULL ||
                               polishing.group == NULL || polishing.isTaken == NULL
                           ? pvtContext_GetStatus(context)
                           : PVT_OK;
    for (int i = 0; i < ascent->options->polish && status == PVT_OK; ++i) {
        ascent->reach = POLISH_REACH;
        PolishOnce(context, &polishing);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
    }
    pvtRelease(context, polishing.steps);
    pvtRelease(context, polishing.isLeft);
    pvtRelease(context, polishing.group);
    pvtRelease(context, polishing.isTaken);
    return status;
}

pvtStatus pvtAscent_Settle(pvtContext* context, pvtAscent* ascent)
{
    const size_t count = (size_t)ascent->set.triangleCount;
    Settling settling = {.ascent = ascent};
    settling.isSettled = pvtAllocate(context, count, sizeof *settling.isSettled);
    settling.isOutside = pvtAllocate(context, count, sizeof *settling.isOutside);
    settling.contacts = pvtAllocate(context, count, sizeof *settling.contacts);
    pvtStatus status =
        settling.isSettled == NULL || settling.isOutside == NULL || settling.contacts == NULL
            ? pvtContext_GetStatus(context)
            : BringInside(context, &settling);
    pvtRelease(context, settling.isSettled);
    pvtRelease(context, settling.isOutside);
    pvtRelease(context, settling.contacts);
    return status == PVT_OK ? Polish(context, ascent) : status;
}
