// SPDX-License-Identifier: MIT
// Corners of a mesh that is inside, on their way to somewhere else: each goes as far as the exact
// test lets the triangles around it. Corners that have no triangle in common go side by side.
#include "ascent_state.h"

#include "base/context.h"

#include <math.h>
#include <string.h>

enum { ATTEMPTS = 3, RETURNS = 6 };

static const float POLISH_REACH = 0.1F;  // [vx]
static const float LEAST_RETURN = 0.03F; // [vx]

static bool IsInside(const pvtAscent* ascent, int triangle)
{
    pvtVec3 corners[3];
    pvtAscent_GetTriangle(ascent, triangle, corners);
    return pvtInsideTest_HasTriangle(ascent->options->inside, corners);
}

static bool AreTrianglesAroundInside(const pvtAscent* ascent, uint32_t corner)
{
    const pvtTriangleSet* set = &ascent->set;
    for (int t = 0; t < set->triangleCount; ++t) {
        if (pvtHasCorner(set->triangles[t], corner) && !IsInside(ascent, t)) {
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
            if (!pvtHasCorner(set->triangles[t], corner)) {
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

// False when none moves.
static bool MoveAll(pvtContext* context, Polishing* polishing)
{
    bool moves = false;
    for (ChooseGroup(polishing); polishing->groupSize > 0; ChooseGroup(polishing)) {
        pvtParallelFor(context, MoveCorners, polishing->groupSize, 1, polishing);
        moves = true;
    }
    return moves;
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
    MoveAll(context, polishing);
}

static bool ReturnOnce(pvtContext* context, const float (*goals)[3], Polishing* polishing)
{
    const pvtTriangleSet* set = &polishing->ascent->set;
    for (int c = 0; c < set->cornerCount; ++c) {
        float square = 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
            polishing->steps[c][axis] = goals[c][axis] - set->corners[c][axis];
            square += polishing->steps[c][axis] * polishing->steps[c][axis];
        }
        polishing->isLeft[c] = !set->isFixed[c] && square > LEAST_RETURN * LEAST_RETURN;
    }
    return MoveAll(context, polishing);
}

static void FreePolishing(pvtContext* context, const Polishing* polishing)
{
    pvtRelease(context, polishing->steps);
    pvtRelease(context, polishing->isLeft);
    pvtRelease(context, polishing->group);
    pvtRelease(context, polishing->isTaken);
}

static pvtStatus MakePolishing(pvtContext* context, pvtAscent* ascent, Polishing* polishing)
{
    const size_t corners = (size_t)ascent->set.cornerCount;
    *polishing = (Polishing){.ascent = ascent};
    polishing->steps = pvtAllocate(context, corners, sizeof *polishing->steps);
    polishing->isLeft = pvtAllocate(context, corners, sizeof *polishing->isLeft);
    polishing->group = pvtAllocate(context, corners, sizeof *polishing->group);
    polishing->isTaken = pvtAllocate(context, (size_t)ascent->set.triangleCount, sizeof(bool));
    return polishing->steps == NULL || polishing->isLeft == NULL || polishing->group == NULL ||
                   polishing->isTaken == NULL
               ? pvtContext_GetStatus(context)
               : PVT_OK;
}

pvtStatus pvtAscent_Return(pvtContext* context, pvtAscent* ascent, const float (*goals)[3])
{
    Polishing polishing;
    pvtStatus status = MakePolishing(context, ascent, &polishing);
    bool moves = true;
    for (int i = 0; i < RETURNS && moves && status == PVT_OK; ++i) {
        moves = ReturnOnce(context, goals, &polishing);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
    }
    FreePolishing(context, &polishing);
    return status;
}

pvtStatus pvtAscent_Polish(pvtContext* context, pvtAscent* ascent)
{
    Polishing polishing;
    pvtStatus status = MakePolishing(context, ascent, &polishing);
    for (int i = 0; i < ascent->options->polish && status == PVT_OK; ++i) {
        ascent->reach = POLISH_REACH;
        PolishOnce(context, &polishing);
        status = pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
    }
    FreePolishing(context, &polishing);
    return status;
}
