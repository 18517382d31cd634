// SPDX-License-Identifier: MIT
#include "moves.h"

#include "base/vector.h"
#include "section/cover.h"

#include <math.h>
#include <string.h>

enum { BISECTIONS = 4, MAX_COORDINATE = 1 << 22 };

typedef struct Maker {
    pvtContext* context;
    const pvtArrangement* arrangement;
    const pvtMoveOptions* options;
    pvtMoveScratch* scratch;
    pvtRandom* random;
    pvtChange* change;
    pvtStatus status;
} Maker;

static int PickSlot(const Maker* maker, int except)
{
    // Reservoir of one over the slots in use.
    int picked = -1;
    uint32_t seen = 0;
    for (int slot = 0; slot < maker->arrangement->capacity; ++slot) {
        if (maker->arrangement->panels[slot].panel.count > 0 && slot != except) {
            ++seen;
            picked = pvtRandom_Below(maker->random, seen) == 0 ? slot : picked;
        }
    }
    return picked;
}

static int FindFreeSlot(const Maker* maker)
{
    for (int slot = 0; slot < maker->arrangement->capacity; ++slot) {
        if (maker->arrangement->panels[slot].panel.count == 0) {
            return slot;
        }
    }
    return -1;
}

static pvtPanel* AddPart(Maker* maker, int slot)
{
    pvtChange* change = maker->change;
    change->slots[change->count] = slot;
    change->panels[change->count] = maker->arrangement->panels[slot].panel;
    return &change->panels[change->count++];
}

// Many small steps, a few large ones: reach × 2^−k, k from 0 to 7.
static double RollReach(Maker* maker)
{
    const uint32_t halvings = pvtRandom_Below(maker->random, 8);
    return maker->options->reach * (1 << PVT_POINT_BITS) / (double)(1u << halvings);
}

static double RollSigned(Maker* maker)
{
    return 2.0 * pvtRandom_Unit(maker->random) - 1.0;
}

static pvtPoint2 OffsetPoint(pvtPoint2 point, double dx, double dy, double scale)
{
    double x = point.x + dx * scale;
    double y = point.y + dy * scale;
    x = x < 0.0 ? 0.0 : x > MAX_COORDINATE ? MAX_COORDINATE : x;
    y = y < 0.0 ? 0.0 : y > MAX_COORDINATE ? MAX_COORDINATE : y;
    return (pvtPoint2){(int32_t)lrint(x), (int32_t)lrint(y)};
}

static bool FitsPointAt(const Maker* maker, const pvtBitmap* cells, pvtPanel* panel, int index,
                        pvtPoint2 there)
{
    const size_t count = (size_t)panel->count;
    const pvtPoint2 here = panel->points[index];
    const pvtPoint2 before = panel->points[(index + panel->count - 1) % panel->count];
    const pvtPoint2 after = panel->points[(index + 1) % panel->count];
    // What a move adds lies in these two triangles.
    const pvtPoint2 swept[2][3] = {{before, here, there}, {here, after, there}};
    const int32_t unit = (1 << PVT_POINT_BITS) / maker->arrangement->cellsPerVoxel;
    panel->points[index] = there;
    const bool fits = pvtIsPointSimple(panel->points, count, (size_t)index) &&
                      pvtIsTriangleCovered(cells, unit, swept[0]) &&
                      pvtIsTriangleCovered(cells, unit, swept[1]);
    panel->points[index] = here;
    return fits;
}

// Moves a point as far along (dx, dy) as it fits; false when it cannot move at all.
static bool PushPoint(const Maker* maker, const pvtBitmap* cells, pvtPanel* panel, int index,
                      const double step[2])
{
    const pvtPoint2 here = panel->points[index];
    pvtPoint2 best = here;
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i <= BISECTIONS; ++i) {
        const double at = i == 0 ? 1.0 : 0.5 * (low + high);
        const pvtPoint2 there = OffsetPoint(here, step[0], step[1], at);
        if (FitsPointAt(maker, cells, panel, index, there)) {
            best = there;
            low = at;
            if (i == 0) {
                break;
            }
        } else {
            high = at;
        }
    }
    panel->points[index] = best;
    return best.x != here.x || best.y != here.y;
}

// Moves a point by (dx, dy) and, where that does not fit, back towards the middle of its neighbours
// until it does: so that it can slide along the border of what is allowed.
static bool SlidePoint(const Maker* maker, const pvtBitmap* cells, pvtPanel* panel, int index,
                       const double step[2])
{
    const pvtPoint2 here = panel->points[index];
    const pvtPoint2 before = panel->points[(index + panel->count - 1) % panel->count];
    const pvtPoint2 after = panel->points[(index + 1) % panel->count];
    const pvtPoint2 there = OffsetPoint(here, step[0], step[1], 1.0);
    const double dx = 0.5 * ((double)before.x + after.x) - there.x;
    const double dy = 0.5 * ((double)before.y + after.y) - there.y;
    pvtPoint2 best = here;
    double low = 0.0;
    double high = 1.0;
    for (int i = 0; i <= BISECTIONS; ++i) {
        const double at = i == 0 ? 0.0 : 0.5 * (low + high);
        const pvtPoint2 place = OffsetPoint(there, dx, dy, at);
        if (FitsPointAt(maker, cells, panel, index, place)) {
            best = place;
            high = at;
            if (i == 0) {
                break;
            }
        } else {
            low = at;
        }
    }
    panel->points[index] = best;
    return best.x != here.x || best.y != here.y;
}

static bool MovePoint(Maker* maker)
{
    const int slot = PickSlot(maker, -1);
    if (slot < 0) {
        return false;
    }
    const pvtBitmap* cells = &maker->arrangement->panels[slot].cells;
    pvtPanel* panel = AddPart(maker, slot);
    const int index = (int)pvtRandom_Below(maker->random, (uint32_t)panel->count);
    const double reach = RollReach(maker);
    const double step[2] = {RollSigned(maker) * reach, RollSigned(maker) * reach};
    const uint32_t way = pvtRandom_Below(maker->random, 4);
    if (way == 0) {
        return PushPoint(maker, cells, panel, index, step);
    }
    if (way == 1) {
        // Both ends of an edge.
        const bool first = SlidePoint(maker, cells, panel, index, step);
        const bool second = SlidePoint(maker, cells, panel, (index + 1) % panel->count, step);
        return first || second;
    }
    return SlidePoint(maker, cells, panel, index, step);
}

static bool InsertPoint(Maker* maker, pvtPanel* panel, const pvtBitmap* cells)
{
    if (panel->count >= PVT_MAX_FIT_POINTS) {
        return false;
    }
    const int edge = (int)pvtRandom_Below(maker->random, (uint32_t)panel->count);
    const pvtPoint2 a = panel->points[edge];
    const pvtPoint2 b = panel->points[(edge + 1) % panel->count];
    const double along = 0.2 + 0.6 * pvtRandom_Unit(maker->random);
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const pvtPoint2 middle = OffsetPoint(a, dx, dy, along);
    memmove(&panel->points[edge + 2], &panel->points[edge + 1],
            (size_t)(panel->count - edge - 1) * sizeof *panel->points);
    panel->points[edge + 1] = middle;
    ++panel->count;
    // Outwards is to the right of a counter-clockwise edge.
    const double length = sqrt(dx * dx + dy * dy);
    const double reach = (0.1 + 0.6 * pvtRandom_Unit(maker->random)) * length;
    const double step[2] = {dy / length * reach, -dx / length * reach};
    return length > 0.0 && PushPoint(maker, cells, panel, edge + 1, step);
}

// Takes a point away; a triangle goes as a whole.
static bool RemovePoint(Maker* maker, pvtPanel* panel, const pvtBitmap* cells)
{
    if (panel->count <= 3) {
        panel->count = 0;
        return true;
    }
    const int index = (int)pvtRandom_Below(maker->random, (uint32_t)panel->count);
    const int last = panel->count - 1;
    const pvtPoint2 cut[3] = {panel->points[(index + last) % panel->count], panel->points[index],
                              panel->points[(index + 1) % panel->count]};
    memmove(&panel->points[index], &panel->points[index + 1],
            (size_t)(last - index) * sizeof *panel->points);
    panel->count = last;
    return pvtIsPolygonSimple(panel->points, (size_t)last) &&
           pvtIsTriangleCovered(cells, (1 << PVT_POINT_BITS) / maker->arrangement->cellsPerVoxel,
                                cut);
}

// A triangle goes from one panel to another, or is spent when the budget has one left.
static bool TransferTriangle(Maker* maker)
{
    const pvtArrangement* arrangement = maker->arrangement;
    const int to = PickSlot(maker, -1);
    if (to < 0 || !InsertPoint(maker, AddPart(maker, to), &arrangement->panels[to].cells)) {
        return false;
    }
    if (arrangement->triangles < maker->options->budget) {
        return true;
    }
    const int from = PickSlot(maker, to);
    return from >= 0 && RemovePoint(maker, AddPart(maker, from), &arrangement->panels[from].cells);
}

static void GetCenter(const pvtPanel* panel, double center[2])
{
    center[0] = center[1] = 0.0;
    for (int i = 0; i < panel->count; ++i) {
        center[0] += panel->points[i].x;
        center[1] += panel->points[i].y;
    }
    center[0] /= panel->count;
    center[1] /= panel->count;
}

// Shrinks the panel about its centre until it fits, then lets each point grow back.
static bool Refit(Maker* maker, pvtPanel* panel, const pvtBitmap* cells)
{
    static const double shrinks[] = {1.0, 0.97, 0.9, 0.78, 0.6};
    const pvtPanel before = *panel;
    double center[2];
    GetCenter(&before, center);
    const int scale = maker->arrangement->cellsPerVoxel;
    bool fits = false;
    for (size_t s = 0; s < sizeof shrinks / sizeof *shrinks && !fits; ++s) {
        for (int i = 0; i < panel->count; ++i) {
            const pvtPoint2 p = before.points[i];
            panel->points[i] = OffsetPoint(p, center[0] - p.x, center[1] - p.y, 1.0 - shrinks[s]);
        }
        fits = pvtIsPolygonSimple(panel->points, (size_t)panel->count) &&
               pvtIsPolygonWithin(cells, scale, panel->points, (size_t)panel->count);
    }
    for (int i = 0; fits && i < panel->count; ++i) {
        const pvtPoint2 p = before.points[i];
        const double target[2] = {p.x + 0.06 * (p.x - center[0]), p.y + 0.06 * (p.y - center[1])};
        const double step[2] = {target[0] - panel->points[i].x, target[1] - panel->points[i].y};
        PushPoint(maker, cells, panel, i, step);
    }
    return fits;
}

static double ToPlaneUnits(double value)
{
    return value * (1 << PVT_PLANE_BITS);
}

// A plane through the old one's point (u, v) in point units, or shifted from it, with other slopes.
static bool MakePlaneThrough(const pvtPlane* from, const double point[2], const double change[3],
                             pvtPlane* plane)
{
    const double one = ToPlaneUnits(1.0);
    const double slopeU = from->slopeU / one + change[0];
    const double slopeV = from->slopeV / one + change[1];
    if (fabs(slopeU) > 1.0 || fabs(slopeV) > 1.0) {
        return false;
    }
    const double unit = 1 << PVT_POINT_BITS;
    const double u = point[0] / unit;
    const double v = point[1] / unit;
    plane->axis = from->axis;
    plane->slopeU = (int32_t)lrint(ToPlaneUnits(slopeU) / 16.0) * 16;
    plane->slopeV = (int32_t)lrint(ToPlaneUnits(slopeV) / 16.0) * 16;
    const double height =
        (double)from->offset + from->slopeU * u + from->slopeV * v + ToPlaneUnits(change[2]);
    plane->offset = (int64_t)llrint(height - plane->slopeU * u - plane->slopeV * v) | 1;
    return true;
}

// Where a panel may lie after Refit.
static pvtSliceWindow FindWindow(const pvtPanel* panel)
{
    int32_t low[2] = {INT32_MAX, INT32_MAX};
    int32_t high[2] = {0, 0};
    for (int i = 0; i < panel->count; ++i) {
        const int32_t at[2] = {panel->points[i].x, panel->points[i].y};
        for (int axis = 0; axis < 2; ++axis) {
            low[axis] = at[axis] < low[axis] ? at[axis] : low[axis];
            high[axis] = at[axis] > high[axis] ? at[axis] : high[axis];
        }
    }
    pvtSliceWindow window;
    for (int axis = 0; axis < 2; ++axis) {
        const int32_t margin = (high[axis] - low[axis]) / 16 + (2 << PVT_POINT_BITS);
        window.lower[axis] = (low[axis] - margin) >> PVT_POINT_BITS;
        window.upper[axis] = (high[axis] + margin) >> PVT_POINT_BITS;
    }
    return window;
}

static bool TiltPanel(Maker* maker)
{
    const int slot = PickSlot(maker, -1);
    if (slot < 0) {
        return false;
    }
    // A sheet's neighbours are no sheets: its panels stay on their plane.
    if (maker->arrangement->sheets != NULL &&
        pvtSheetSet_Find(maker->arrangement->sheets,
                         &maker->arrangement->panels[slot].panel.plane) != NULL) {
        return MovePoint(maker);
    }
    pvtPanel* panel = AddPart(maker, slot);
    const pvtPlane before = panel->plane;
    const double reach = RollReach(maker) / (1 << PVT_POINT_BITS);
    // Half of the moves shift the plane; the others turn it about the panel's middle, its ends
    // moving about as far.
    double change[3] = {0.0, 0.0, 0.0};
    double pivot[2];
    GetCenter(panel, pivot);
    if (pvtRandom_Below(maker->random, 2) == 0) {
        change[2] = RollSigned(maker) * reach;
    } else {
        const double radius = sqrt((double)pvtGetLoopArea2(panel->points, (size_t)panel->count)) /
                                  (2 << PVT_POINT_BITS) +
                              1.0;
        change[0] = RollSigned(maker) * reach / radius;
        change[1] = RollSigned(maker) * reach / radius;
    }
    if (!MakePlaneThrough(&before, pivot, change, &panel->plane)) {
        return false;
    }
    const pvtSliceWindow window = FindWindow(panel);
    maker->status = pvtSliceAllowed(maker->context, maker->arrangement, &panel->plane, &window,
                                    &maker->scratch->cells);
    return maker->status == PVT_OK && Refit(maker, panel, &maker->scratch->cells);
}

static size_t PickCandidate(Maker* maker)
{
    const double* sums = maker->options->candidateSums;
    const size_t count = maker->options->candidates->chains.count;
    const double at = pvtRandom_Unit(maker->random) * sums[count - 1];
    size_t low = 0;
    size_t high = count - 1;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (sums[middle] > at) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

static bool TakeCandidate(Maker* maker, int triangles, pvtPanel* panel)
{
    const pvtChainSet* chains = &maker->options->candidates->chains;
    const size_t candidate = PickCandidate(maker);
    const int most = maker->options->candidates->triangles[candidate];
    triangles = triangles < most ? triangles : most;
    if (triangles + 2 > PVT_MAX_FIT_POINTS) {
        triangles = PVT_MAX_FIT_POINTS - 2;
    }
    panel->plane = maker->options->candidates->planes[candidate];
    panel->count = (int)pvtChainSet_GetLink(chains, candidate, triangles, panel->points);
    return pvtIsPolygonSimple(panel->points, (size_t)panel->count);
}

// One panel gives way to a candidate, or to two, or two give way to one.
static bool ExchangePanels(Maker* maker)
{
    const int slot = PickSlot(maker, -1);
    if (slot < 0) {
        return false;
    }
    pvtPanel* first = AddPart(maker, slot);
    const int triangles = first->count - 2;
    const int spare = maker->options->budget - maker->arrangement->triangles;
    const uint32_t way = pvtRandom_Below(maker->random, 3);
    if (way == 0 && triangles >= 2) {
        const int other = FindFreeSlot(maker);
        if (other < 0) {
            return false;
        }
        const int part = 1 + (int)pvtRandom_Below(maker->random, (uint32_t)triangles - 1);
        pvtPanel* second = AddPart(maker, other);
        return TakeCandidate(maker, part, first) &&
               TakeCandidate(maker, triangles + spare - part, second);
    }
    if (way == 1) {
        const int other = PickSlot(maker, slot);
        if (other < 0) {
            return false;
        }
        pvtPanel* second = AddPart(maker, other);
        const int both = triangles + second->count - 2;
        second->count = 0;
        return TakeCandidate(maker, both + spare, first);
    }
    return TakeCandidate(maker, triangles + spare, first);
}

bool pvtMakeMove(pvtContext* context, const pvtArrangement* arrangement,
                 const pvtMoveOptions* options, pvtMoveScratch* scratch, pvtRandom* random,
                 pvtChange* change, pvtStatus* status)
{
    Maker maker = {context, arrangement, options, scratch, random, change, PVT_OK};
    change->count = 0;
    bool made = false;
    if (pvtRandom_Unit(random) < options->structure) {
        const uint32_t kind = pvtRandom_Below(random, 4);
        made = kind == 0   ? ExchangePanels(&maker)
               : kind == 1 ? TransferTriangle(&maker)
                           : TiltPanel(&maker);
    } else {
        made = MovePoint(&maker);
    }
    *status = maker.status;
    return made;
}
