// SPDX-License-Identifier: MIT
// From nearly inside to inside. The field knows the border to a fraction of a voxel; what the exact
// test objects to keeps a greater distance from it, round after round. Between two walls a triangle
// may go to and fro like that. Then what was asked of it is kept, and met all at once; and as more
// was asked than had to be, corners go back from there towards where the ascent had left them, as
// far as they can (polish.c). Where that finds no place, either, triangles go back to where they
// were inside the last time, and on from there in the same way.
#include "ascent_state.h"

#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

enum {
    MOST_ROUNDS = 64,
    DEMANDING_ROUNDS = 24,
    FREE_ROUNDS = 16,  // after which many triangles outside are a sign of walls on both sides
    MOST_DEMANDS = 24, // of a triangle: the last ones
    SWEEPS = 20,
    RETREATS = 8
};

static const float PUSH_GROWTH = 0.01F; // [vx] a round
static const float NEAR_ENOUGH = 1e-4F; // [vx]

// Points of a triangle that were found outside, and how deep they have to be since then.
typedef struct Demands {
    pvtContact points[MOST_DEMANDS];
    int count; // made so far; the last ones are kept
} Demands;

// What is looked at again: triangles of which a corner moved since they were found inside.
typedef struct Settling {
    pvtAscent* ascent;
    bool* isSettled;
    pvtContact* contacts; // one a triangle
    Demands* demands;     // one a triangle
    uint32_t* moves;      // of each corner: the last move for a demand, counted from 1
    uint32_t moveCount;
    bool* isOutside;
    float (*goals)[3]; // of each corner: where the ascent left it, if it retreated, or where it is
} Settling;

// Of triangles without much area shares may be anything.
static double Limit(double share)
{
    return share > -2.0 ? (share < 2.0 ? share : 2.0) : -2.0;
}

// Shares of the corners in a point at the triangle, none below 0 (Ericson, Real-Time Collision
// Detection, 2004, section 3.4).
static void FindShares(const pvtVec3 corners[3], pvtVec3 point, float shares[3])
{
    const pvtVec3 a = pvtSub(corners[1], corners[0]), b = pvtSub(corners[2], corners[0]);
    const pvtVec3 p = pvtSub(point, corners[0]);
    const double aa = pvtDot(a, a), ab = pvtDot(a, b), bb = pvtDot(b, b);
    const double pa = pvtDot(p, a), pb = pvtDot(p, b);
    const double scale = aa * bb - ab * ab;
    const double u = scale > 0.0 ? Limit((bb * pa - ab * pb) / scale) : 0.0;
    const double v = scale > 0.0 ? Limit((aa * pb - ab * pa) / scale) : 0.0;
    float sum = 0.0F;
    shares[0] = (float)(1.0 - u - v);
    shares[1] = (float)u;
    shares[2] = (float)v;
    for (int k = 0; k < 3; ++k) {
        shares[k] = shares[k] > 0.0F ? shares[k] : 0.0F;
        sum += shares[k];
    }
    for (int k = 0; k < 3; ++k) {
        shares[k] /= sum;
    }
}

static pvtVec3 GetPlace(const pvtVec3 corners[3], const float shares[3])
{
    return pvtAdd(
        pvtScale(corners[0], (double)shares[0]),
        pvtAdd(pvtScale(corners[1], (double)shares[1]), pvtScale(corners[2], (double)shares[2])));
}

// Looks first at the point that was outside the last time.
static bool FindOutside(const Settling* settling, int triangle, pvtVec3* outside)
{
    const pvtInsideTest* inside = settling->ascent->options->inside;
    pvtContact* contact = &settling->contacts[triangle];
    pvtVec3 corners[3];
    pvtAscent_GetTriangle(settling->ascent, triangle, corners);
    if (settling->isOutside[triangle]) {
        *outside = GetPlace(corners, contact->shares);
        if (!pvtInsideTest_HasPoint(inside, *outside)) {
            return true;
        }
    }
    if (pvtInsideTest_FindOutside(inside, corners, outside)) {
        return false;
    }
    contact->triangle = triangle;
    FindShares(corners, *outside, contact->shares);
    return true;
}

static void TestTriangles(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const Settling* settling = taskData;
    for (int t = (int)begin; t < (int)end; ++t) {
        pvtVec3 outside;
        settling->isOutside[t] = !settling->isSettled[t] && FindOutside(settling, t, &outside);
        settling->isSettled[t] = !settling->isOutside[t];
        if (settling->isOutside[t]) {
            pvtContact* contact = &settling->contacts[t];
            const float point[3] = {(float)outside.x, (float)outside.y, (float)outside.z};
            contact->depth =
                pvtField_GetDepthAndInward(&settling->ascent->field, point, contact->inward);
        }
    }
}

static void Unsettle(const Settling* settling, const uint32_t moved[3])
{
    const pvtTriangleSet* set = &settling->ascent->set;
    for (int t = 0; t < set->triangleCount; ++t) {
        for (int k = 0; k < 3; ++k) {
            if (pvtHasCorner(set->triangles[t], moved[k])) {
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
    const float least = PUSH_GROWTH * (float)round;
    for (int t = 0; t < ascent->set.triangleCount; ++t) {
        if (settling->isOutside[t]) {
            const float lack = least - settling->contacts[t].depth;
            pvtMoveContact(&settling->contacts[t], &ascent->set, lack > least ? lack : least);
            Unsettle(settling, ascent->set.triangles[t]);
        }
    }
}

// Where the test says that a triangle is not inside, it has to be deeper from now on.
static void AddDemands(Settling* settling, int round)
{
    const float least = PUSH_GROWTH * (float)(round + 1);
    for (int t = 0; t < settling->ascent->set.triangleCount; ++t) {
        if (settling->isOutside[t]) {
            Demands* demands = &settling->demands[t];
            pvtContact* point = &demands->points[demands->count++ % MOST_DEMANDS];
            *point = settling->contacts[t];
            point->depth = fmaxf(least, point->depth + least);
            point->looked = 0;
        }
    }
}

// The last move of a triangle's corners.
static uint32_t GetLastMove(const Settling* settling, int triangle)
{
    const uint32_t* corners = settling->ascent->set.triangles[triangle];
    uint32_t last = 0;
    for (int k = 0; k < 3; ++k) {
        last = settling->moves[corners[k]] > last ? settling->moves[corners[k]] : last;
    }
    return last;
}

// Moves the triangle inwards if a point of it is less deep than it has to be.
static void MeetDemand(Settling* settling, pvtContact* point)
{
    pvtAscent* ascent = settling->ascent;
    float place[3];
    pvtGetContactPlace(point, &ascent->set, place);
    const float depth = pvtField_GetDepthAndInward(&ascent->field, place, point->inward);
    if (depth < point->depth - NEAR_ENOUGH) {
        pvtMoveContact(point, &ascent->set, point->depth - depth);
        ++settling->moveCount;
        for (int k = 0; k < 3; ++k) {
            settling->moves[ascent->set.triangles[point->triangle][k]] = settling->moveCount;
        }
    }
    point->looked = settling->moveCount;
}

static void MeetDemandsOnce(Settling* settling)
{
    for (int t = 0; t < settling->ascent->set.triangleCount; ++t) {
        Demands* demands = &settling->demands[t];
        const int count = demands->count < MOST_DEMANDS ? demands->count : MOST_DEMANDS;
        for (int i = 0; i < count; ++i) {
            pvtContact* point = &demands->points[i];
            if (point->looked == 0 || GetLastMove(settling, t) > point->looked) {
                MeetDemand(settling, point);
            }
        }
    }
}

static void MeetDemands(Settling* settling)
{
    const uint32_t before = settling->moveCount;
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        const uint32_t last = settling->moveCount;
        MeetDemandsOnce(settling);
        if (settling->moveCount == last) {
            break;
        }
    }
    for (int t = 0; t < settling->ascent->set.triangleCount; ++t) {
        settling->isSettled[t] = settling->isSettled[t] && GetLastMove(settling, t) <= before;
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

// Corners that went back, to where the ascent had left them; the others stay.
static void ChooseGoals(Settling* settling, const float (*pushed)[3])
{
    const pvtTriangleSet* set = &settling->ascent->set;
    for (int c = 0; c < set->cornerCount; ++c) {
        const float* corner = set->corners[c];
        if (corner[0] == pushed[c][0] && corner[1] == pushed[c][1] && corner[2] == pushed[c][2]) {
            memcpy(settling->goals[c], pushed[c], sizeof *settling->goals);
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

// How many triangles are outside where the ascent left them.
static int BeginAnew(pvtContext* context, Settling* settling)
{
    pvtTriangleSet* set = &settling->ascent->set;
    memcpy(set->corners, settling->goals, (size_t)set->cornerCount * sizeof *set->corners);
    for (int t = 0; t < set->triangleCount; ++t) {
        settling->isSettled[t] = pvtTriangleSet_IsFixed(set, t);
    }
    return TestAll(context, settling);
}

static bool AreMost(const Settling* settling, int outside)
{
    return 2 * outside > settling->ascent->set.triangleCount;
}

// Goes on with rounds from `begin` to `end` − 1, as long as anything is outside.
static pvtStatus PushInside(pvtContext* context, Settling* settling, int begin, int end,
                            int* outside)
{
    for (int round = begin; round < end && (*outside) > 0; ++round) {
        PushOutside(settling, round);
        *outside = TestAll(context, settling);
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
    }
    return PVT_OK;
}

static pvtStatus DemandInside(pvtContext* context, Settling* settling, int* outside)
{
    *outside = BeginAnew(context, settling);
    settling->moveCount = 1; // 0 stands for a point that has not been looked at
    for (int round = 0; round < DEMANDING_ROUNDS && (*outside) > 0; ++round) {
        AddDemands(settling, round);
        MeetDemands(settling);
        *outside = TestAll(context, settling);
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
    }
    return PVT_OK;
}

static pvtStatus Retreat(pvtContext* context, Settling* settling, int outside)
{
    const pvtTriangleSet* set = &settling->ascent->set;
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

static pvtStatus GoBack(pvtContext* context, Settling* settling, int outside)
{
    const pvtTriangleSet* set = &settling->ascent->set;
    float(*pushed)[3] = pvtAllocate(context, (size_t)set->cornerCount, sizeof *pushed);
    if (pushed == NULL) {
        return pvtContext_GetStatus(context);
    }
    memcpy(pushed, set->corners, (size_t)set->cornerCount * sizeof *set->corners);
    const pvtStatus status = Retreat(context, settling, outside);
    ChooseGoals(settling, (const float(*)[3])pushed);
    pvtRelease(context, pushed);
    return status;
}

// When nothing is outside in the end, corners have gone back as far as they can.
static pvtStatus TryDemands(pvtContext* context, Settling* settling, int* outside)
{
    pvtStatus status = DemandInside(context, settling, outside);
    if (status == PVT_OK && *outside == 0) {
        return pvtAscent_Return(context, settling->ascent, (const float(*)[3])settling->goals);
    }
    if (status == PVT_OK) {
        *outside = BeginAnew(context, settling);
        status = PushInside(context, settling, 0, FREE_ROUNDS, outside);
    }
    return status;
}

static pvtStatus BringInside(pvtContext* context, Settling* settling)
{
    const pvtTriangleSet* set = &settling->ascent->set;
    memcpy(settling->goals, set->corners, (size_t)set->cornerCount * sizeof *set->corners);
    int outside = BeginAnew(context, settling);
    pvtStatus status = PushInside(context, settling, 0, FREE_ROUNDS, &outside);
    if (status == PVT_OK && AreMost(settling, outside)) {
        settling->ascent->isShell = true;
        status = TryDemands(context, settling, &outside);
    }
    if (status == PVT_OK) {
        status = PushInside(context, settling, FREE_ROUNDS, MOST_ROUNDS, &outside);
    }
    if (status == PVT_OK && outside > 0) {
        status = GoBack(context, settling, outside);
        if (status == PVT_OK) {
            status =
                pvtAscent_Return(context, settling->ascent, (const float(*)[3])settling->goals);
        }
    }
    return status;
}

pvtStatus pvtAscent_Settle(pvtContext* context, pvtAscent* ascent)
{
    const size_t count = (size_t)ascent->set.triangleCount;
    Settling settling = {.ascent = ascent};
    settling.isSettled = pvtAllocate(context, count, sizeof *settling.isSettled);
    settling.isOutside = pvtAllocate(context, count, sizeof *settling.isOutside);
    settling.contacts = pvtAllocate(context, count, sizeof *settling.contacts);
    settling.demands = pvtAllocate(context, count, sizeof *settling.demands);
    settling.moves = pvtAllocate(context, (size_t)ascent->set.cornerCount, sizeof *settling.moves);
    settling.goals = pvtAllocate(context, (size_t)ascent->set.cornerCount, sizeof *settling.goals);
    pvtStatus status = settling.isSettled == NULL || settling.isOutside == NULL ||
                               settling.contacts == NULL || settling.demands == NULL ||
                               settling.moves == NULL || settling.goals == NULL
                           ? pvtContext_GetStatus(context)
                           : BringInside(context, &settling);
    pvtRelease(context, settling.isSettled);
    pvtRelease(context, settling.isOutside);
    pvtRelease(context, settling.contacts);
    pvtRelease(context, settling.demands);
    pvtRelease(context, settling.moves);
    pvtRelease(context, settling.goals);
    if (status == PVT_OK) {
        memcpy(ascent->set.anchors, ascent->set.corners,
               (size_t)ascent->set.cornerCount * sizeof *ascent->set.anchors);
    }
    return status;
}
