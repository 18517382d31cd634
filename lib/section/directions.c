// SPDX-License-Identifier: MIT
// Which directions to slice across. A few special ones matter most: those of walls and roofs,
// and the grid's own. The others fill the space between them: they start on a golden spiral (Vogel,
// A better way to construct the sunflower head, 1979) and push each other away, like charges on a
// sphere that come in opposite pairs, with the special ones held fast.
#include "directions.h"

#include "base/context.h"
#include "base/vector.h"

#include <stdlib.h>

// Cosines of 2° and 0.5°, written out so that no library's rounding matters.
#define NEAR_COSINE 0.99939082701909573
#define SAME_COSINE 0.99996192306417129

enum {
    PUSH_ROUNDS = 40,
    // Pairs of charges pushed in all, which takes some 50 ms. So many directions that one round
    // would take more stay on the spiral, which is even enough by then.
    PUSH_PAIRS = 1 << 21,
};

static bool IsNear(const pvtPlanLine* lines, size_t count, pvtVec3 direction, double cosine)
{
    for (size_t i = 0; i < count; ++i) {
        if (fabs(pvtDot(lines[i].direction, direction)) > cosine) {
            return true;
        }
    }
    return false;
}

// A slope whose whole rise across the grid is under half a voxel becomes 0, since a plane that
// stays in one layer is covered where a slanted one would need two.
static pvtVec3 SnapToAxes(const pvtGridFrame* frame, pvtVec3 direction)
{
    const pvtPlane plane = pvtMakePlane(frame, direction, frame->origin);
    const int u = (int)pvtPlane_GetU(&plane), v = (int)pvtPlane_GetV(&plane);
    const int64_t half = INT64_C(1) << (PVT_PLANE_BITS - 1);
    if (llabs((int64_t)plane.slopeU * frame->size[u]) < half) {
        pvtSetAxis(&direction, u, 0.0);
    }
    if (llabs((int64_t)plane.slopeV * frame->size[v]) < half) {
        pvtSetAxis(&direction, v, 0.0);
    }
    return pvtNormalize(direction);
}

static size_t AddFaces(const pvtPlanOptions* options, const pvtGridFrame* frame, pvtPlanLine* lines)
{
    size_t count = 0;
    for (size_t i = 0; options->faces != NULL && i < options->faces->count; ++i) {
        const pvtVec3 direction = SnapToAxes(frame, options->faces->directions[i].direction);
        if (!IsNear(lines, count, direction, NEAR_COSINE)) {
            lines[count++] = (pvtPlanLine){.direction = direction, .strong = true};
        }
    }
    return count;
}

// An axis stays even beside a face direction that is a little off: the mean of a cluster of faces
// need not be that of any of them, and only planes along the grid's layers lose nothing to steps.
static size_t AddAxes(pvtPlanLine* lines, size_t count)
{
    static const pvtVec3 axes[] = {{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0}, {1, -1, 0},
                                   {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};
    for (int i = 0; i < 9; ++i) {
        const pvtVec3 direction = pvtNormalize(axes[i]);
        if (!IsNear(lines, count, direction, i < 3 ? SAME_COSINE : NEAR_COSINE)) {
            lines[count++] = (pvtPlanLine){.direction = direction, .strong = i < 3};
        }
    }
    return count;
}

// Each point turns by the golden angle from the one before, by a rotation rather than by sine and
// cosine, which differ between libraries.
static void StartSpiral(pvtPlanLine* lines, size_t count)
{
    const double turnX = -0.73736887807831990, turnY = 0.67549029426152362;
    double x = 1.0, y = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const double height = ((double)i + 0.5) / (double)count;
        const double radius = sqrt(1.0 - height * height);
        lines[i].direction = (pvtVec3){radius * x, radius * y, height};
        const double length = sqrt(x * x + y * y);
        const double nextX = (x * turnX - y * turnY) / length;
        y = (x * turnY + y * turnX) / length;
        x = nextX;
    }
}

// What a charge at `other`, or the opposite one, adds to the force on `at`.
static pvtVec3 GetForce(pvtVec3 at, pvtVec3 other)
{
    const pvtVec3 away = pvtSub(at, other);
    const double distance2 = pvtDot(away, away) + 1e-9;
    return pvtScale(away, 1.0 / (distance2 * sqrt(distance2)));
}

static void PushApart(pvtPlanLine* lines, size_t fixedCount, size_t count)
{
    // Of this many pairs of opposite charges each has about 2π / count of the hemisphere.
    const double spacing = sqrt(6.283185307179586 / (double)count);
    const double step = 0.1 * spacing * spacing * spacing;
    for (size_t i = fixedCount; i < count; ++i) {
        const pvtVec3 at = lines[i].direction;
        pvtVec3 force = {0};
        for (size_t k = 0; k < count; ++k) {
            if (k != i) {
                force = pvtAdd(force, GetForce(at, lines[k].direction));
                force = pvtAdd(force, GetForce(at, pvtScale(lines[k].direction, -1.0)));
            }
        }
        force = pvtSub(force, pvtScale(at, pvtDot(force, at)));
        // No charge jumps over its neighbours, however close it started to one.
        const double length = pvtLength3(force) * step;
        const double most = 0.25 * spacing;
        lines[i].direction =
            pvtNormalize(pvtAdd(at, pvtScale(force, length > most ? step * most / length : step)));
    }
}

static size_t AddSpread(const pvtPlanOptions* options, pvtPlanLine* lines, size_t count)
{
    const size_t all = count + (size_t)options->directions;
    StartSpiral(lines + count, (size_t)options->directions);
    const size_t pairs = (size_t)options->directions * all;
    for (size_t round = 1; round <= PUSH_ROUNDS && round * pairs <= PUSH_PAIRS; ++round) {
        PushApart(lines, count, all);
    }
    size_t kept = count;
    for (size_t i = count; i < all; ++i) {
        if (!IsNear(lines, count, lines[i].direction, NEAR_COSINE)) {
            lines[kept++] = lines[i];
        }
    }
    return kept;
}

pvtStatus pvtCollectDirections(pvtContext* context, const pvtPlanOptions* options,
                               const pvtGridFrame* frame, pvtPlanLine** lines, size_t* count)
{
    const size_t faceCount = options->faces != NULL ? options->faces->count : 0;
    const size_t most = faceCount + 9 + (size_t)options->directions;
    *count = 0;
    *lines = pvtAllocate(context, most, sizeof **lines);
    if (*lines == NULL) {
        return pvtContext_GetStatus(context);
    }
    *count = AddFaces(options, frame, *lines);
    if (options->axes) {
        *count = AddAxes(*lines, *count);
    }
    *count = AddSpread(options, *lines, *count);
    for (size_t i = 0; i < *count; ++i) {
        (*lines)[i].shape = pvtMakePlane(frame, (*lines)[i].direction, frame->origin);
    }
    return PVT_OK;
}
