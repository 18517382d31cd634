// SPDX-License-Identifier: MIT
// Two triangles by the line that their planes share (Möller, A Fast Triangle-Triangle Intersection
// Test, 1997); cells along a line by stepping to the nearest side (Amanatides and Woo, A Fast Voxel
// Traversal Algorithm for Ray Tracing, 1987).
#include "crossing.h"

#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

static const double TOUCH = 1e-7; // [vx] no more than touching

// Signed distances of b's corners from a's plane; false when all lie on one side, or on it.
static bool FindSides(const pvtVec3 a[3], const pvtVec3 b[3], double sides[3])
{
    const pvtVec3 n = pvtNormalize(pvtCross(pvtSub(a[1], a[0]), pvtSub(a[2], a[0])));
    bool isAbove = false, isBelow = false;
    for (int k = 0; k < 3; ++k) {
        sides[k] = pvtDot(n, pvtSub(b[k], a[0]));
        isAbove = isAbove || sides[k] > TOUCH;
        isBelow = isBelow || sides[k] < -TOUCH;
    }
    return isAbove && isBelow;
}

// Where a triangle's edges meet the plane that its corners have these distances from.
static int CutEdges(const pvtVec3 corners[3], const double sides[3], pvtVec3 points[3])
{
    int count = 0;
    for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        if ((sides[k] < 0.0) != (sides[next] < 0.0)) {
            const double at = sides[k] / (sides[k] - sides[next]);
            points[count++] = pvtAdd(corners[k], pvtScale(pvtSub(corners[next], corners[k]), at));
        }
    }
    return count;
}

bool pvtFindCrossing(const pvtVec3 a[3], const pvtVec3 b[3], pvtVec3 ends[2])
{
    double sidesOfA[3], sidesOfB[3];
    if (!FindSides(b, a, sidesOfA) || !FindSides(a, b, sidesOfB)) {
        return false;
    }
    pvtVec3 onA[3], onB[3];
    if (CutEdges(a, sidesOfA, onA) != 2 || CutEdges(b, sidesOfB, onB) != 2) {
        return false;
    }
    // Both are parts of one line: what they share of it.
    const pvtVec3 way = pvtNormalize(pvtSub(onA[1], onA[0]));
    const double length = pvtDot(way, pvtSub(onA[1], onA[0]));
    const double from = pvtDot(way, pvtSub(onB[0], onA[0]));
    const double to = pvtDot(way, pvtSub(onB[1], onA[0]));
    const double low = fmax(0.0, fmin(from, to)), high = fmin(length, fmax(from, to));
    ends[0] = pvtAdd(onA[0], pvtScale(way, low));
    ends[1] = pvtAdd(onA[0], pvtScale(way, high));
    return high - low > TOUCH;
}

static bool IsBorder(const pvtCellGrid* cells, const int cell[3])
{
    // Rounds down for what lies below 0, too.
    const int x = cell[0] >> 2, y = cell[1] >> 2, z = cell[2] >> 2;
    const int bit = (cell[0] & 3) + PVT_CELLS * ((cell[1] & 3) + PVT_CELLS * (cell[2] & 3));
    return (pvtCellGrid_GetBorder(cells, x, y, z) >> bit & 1) != 0;
}

bool pvtPassesBorder(const pvtCellGrid* cells, const pvtVec3 ends[2], pvtVec3* place)
{
    int cell[3], last[3], step[3];
    double next[3], stride[3];
    int steps = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double from = PVT_CELLS * pvtGetAxis(ends[0], axis);
        const double way = PVT_CELLS * pvtGetAxis(ends[1], axis) - from;
        cell[axis] = (int)floor(from);
        last[axis] = (int)floor(from + way);
        step[axis] = way < 0.0 ? -1 : 1;
        steps += abs(last[axis] - cell[axis]);
        stride[axis] = way != 0.0 ? 1.0 / fabs(way) : HUGE_VAL;
        const double side = way < 0.0 ? from - cell[axis] : cell[axis] + 1 - from;
        next[axis] = way != 0.0 ? side * stride[axis] : HUGE_VAL;
    }
    double at = 0.0;
    for (int i = 0; i <= steps; ++i) {
        if (IsBorder(cells, cell)) {
            *place = pvtAdd(ends[0], pvtScale(pvtSub(ends[1], ends[0]), at < 1.0 ? at : 1.0));
            return true;
        }
        const int axis =
            next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
        cell[axis] += step[axis];
        at = next[axis];
        next[axis] += stride[axis];
    }
    return false;
}
