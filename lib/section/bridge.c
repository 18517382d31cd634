// SPDX-License-Identifier: MIT
// Holes joined to the loops around them.
//
// After Eberly, "Triangulation by Ear Clipping", 2002, section 5, which takes holes from one side
// to the other, so that each sees something that is joined already. Here the bridge is the shortest
// of all between a point of the hole and a point that is joined; and at a point where the boundary
// passes several times, the pass that the bridge leaves from is found by its angle.
#include "base/context.h"
#include "loops.h"
#include "predicates.h"
#include "segments.h"

#include <assert.h>
#include <stdlib.h>

static const uint32_t NONE = UINT32_MAX;

typedef struct BridgeNode {
    pvtPoint2 point;
    uint32_t before, after;
    uint32_t loop;
    uint32_t copy; // another node at this point, made for a bridge
} BridgeNode;

typedef struct Hole {
    pvtPoint2 leftmost;
    uint32_t loop;
} Hole;

typedef struct Bridge {
    uint32_t from, to; // of the hole; of what is joined
    int64_t length2;
} Bridge;

// Nodes of a hole, one behind the other, in one square of the grid.
typedef struct NodeRun {
    uint32_t first, end;
    int32_t column, row;
    pvtPoint2 low, high; // their box
} NodeRun;

typedef struct Bridger {
    const pvtLoopSet* contours;
    pvtSegmentGrid grid;
    BridgeNode* nodes; // those of the contours' points come first
    size_t nodeCount;
    bool* isJoined; // one a loop
    Hole* holes;
    size_t holeCount;
} Bridger;

// The ends of a segment that is looked along.
typedef struct Sight {
    const pvtSegmentGrid* grid;
    pvtPoint2 from, to;
} Sight;

static int CompareHoles(const void* left, const void* right)
{
    const Hole *a = left, *b = right;
    if (a->leftmost.x != b->leftmost.x) {
        return a->leftmost.x < b->leftmost.x ? -1 : 1;
    }
    if (a->leftmost.y != b->leftmost.y) {
        return a->leftmost.y < b->leftmost.y ? -1 : 1;
    }
    return a->loop < b->loop ? -1 : 1;
}

static pvtPoint2 FindLeftmost(const pvtLoopSet* contours, size_t loop)
{
    pvtPoint2 best = contours->points[contours->starts[loop]];
    for (size_t i = contours->starts[loop]; i < contours->starts[loop + 1]; ++i) {
        const pvtPoint2 at = contours->points[i];
        best = at.x < best.x || (at.x == best.x && at.y < best.y) ? at : best;
    }
    return best;
}

static void LoadLoop(Bridger* bridger, size_t loop)
{
    const pvtLoopSet* contours = bridger->contours;
    const uint32_t begin = (uint32_t)contours->starts[loop];
    const uint32_t end = (uint32_t)contours->starts[loop + 1];
    for (uint32_t i = begin; i < end; ++i) {
        bridger->nodes[i] = (BridgeNode){contours->points[i], i == begin ? end - 1 : i - 1,
                                         i + 1 == end ? begin : i + 1, (uint32_t)loop, NONE};
    }
    if (contours->parents[loop] < 0) {
        bridger->isJoined[loop] = true;
    } else if (begin < end) {
        bridger->holes[bridger->holeCount++] = (Hole){FindLeftmost(contours, loop), (uint32_t)loop};
    }
}

static pvtStatus CreateBridger(pvtContext* context, Bridger* bridger)
{
    const pvtLoopSet* contours = bridger->contours;
    size_t holeCount = 0;
    for (size_t l = 0; l < contours->loopCount; ++l) {
        holeCount += contours->parents[l] >= 0;
    }
    const size_t nodeCount = contours->pointCount + 2 * holeCount;
    if (nodeCount >= NONE) {
        return pvtFail(context, PVT_LIMIT, "%zu points in one slice", nodeCount);
    }
    bridger->nodes = pvtAllocate(context, nodeCount, sizeof *bridger->nodes);
    bridger->isJoined = pvtAllocate(context, contours->loopCount, sizeof *bridger->isJoined);
    bridger->holes = pvtAllocate(context, holeCount, sizeof *bridger->holes);
    if (bridger->nodes == NULL || bridger->isJoined == NULL || bridger->holes == NULL) {
        return pvtContext_GetStatus(context);
    }
    bridger->nodeCount = contours->pointCount;
    for (size_t l = 0; l < contours->loopCount; ++l) {
        LoadLoop(bridger, l);
    }
    qsort(bridger->holes, bridger->holeCount, sizeof *bridger->holes, CompareHoles);
    return bridger->holeCount == 0
               ? PVT_OK
               : pvtCreateSegmentGrid(context, contours, holeCount, &bridger->grid);
}

static void FreeBridger(pvtContext* context, Bridger* bridger)
{
    pvtSegmentGrid_Free(context, &bridger->grid);
    pvtRelease(context, bridger->nodes);
    pvtRelease(context, bridger->isJoined);
    pvtRelease(context, bridger->holes);
}

static pvtPass GetPass(const Bridger* bridger, uint32_t node)
{
    const BridgeNode* at = &bridger->nodes[node];
    return (pvtPass){bridger->nodes[at->before].point, at->point, bridger->nodes[at->after].point};
}

// A segment may only touch the line of sight at its ends, without running along it.
static bool IsInSight(void* user, uint32_t number)
{
    const Sight* sight = user;
    const pvtSegment segment = sight->grid->segments[number];
    return pvtSegmentsCross(sight->from, sight->to, segment.from, segment.to);
}

// Of the passes at the node's point, the one within whose angle the target lies; NONE when that is
// none of those made of this node.
static uint32_t FindPass(const Bridger* bridger, uint32_t node, pvtPoint2 target)
{
    for (; node != NONE; node = bridger->nodes[node].copy) {
        const pvtPass pass = GetPass(bridger, node);
        if (pvtPass_IsInside(&pass, target)) {
            return node;
        }
    }
    return NONE;
}

// The bridge between a node of a hole and a joined one, if there may be one; its `to` is a pass.
static bool TryBridge(const Bridger* bridger, uint32_t from, uint32_t to, Bridge* bridge)
{
    const pvtPoint2 start = bridger->nodes[from].point, end = bridger->nodes[to].point;
    if (pvtIsSamePoint(start, end)) {
        // The hole touches: its own edges lie within the angle.
        const pvtPass hole = GetPass(bridger, from);
        uint32_t pass = FindPass(bridger, to, hole.after);
        pass = pass == NONE ? FindPass(bridger, to, hole.before) : pass;
        *bridge = (Bridge){from, pass, 0};
        return pass != NONE;
    }
    const pvtPass hole = GetPass(bridger, from);
    const uint32_t pass = FindPass(bridger, to, start);
    Sight sight = {&bridger->grid, start, end};
    if (pass == NONE || !pvtPass_IsInside(&hole, end) ||
        pvtSegmentGrid_Visit(&bridger->grid, (pvtSegment){start, end}, IsInSight, &sight)) {
        return false;
    }
    *bridge = (Bridge){from, pass, pvtGetDistance2(start, end)};
    return true;
}

static bool IsTarget(const Bridger* bridger, uint32_t node, uint32_t from)
{
    const int32_t* parents = bridger->contours->parents;
    const uint32_t loop = bridger->nodes[node].loop;
    const int32_t family = parents[bridger->nodes[from].loop];
    return bridger->isJoined[loop] &&
           ((int32_t)loop == family || (parents[loop] == family && family >= 0));
}

// Looks through the nodes of one square for a bridge shorter than the best.
static void SearchSquare(const Bridger* bridger, const NodeRun* run, uint32_t entry, Bridge* best)
{
    const pvtSegmentGrid* grid = &bridger->grid;
    for (; entry != NONE; entry = grid->entries[entry].next) {
        const uint32_t node = grid->entries[entry].segment;
        if (node >= bridger->contours->pointCount || !IsTarget(bridger, node, run->first)) {
            continue;
        }
        for (uint32_t from = run->first; from < run->end; ++from) {
            const int64_t length2 =
                pvtGetDistance2(bridger->nodes[from].point, bridger->nodes[node].point);
            Bridge bridge;
            if (length2 < best->length2 && TryBridge(bridger, from, node, &bridge)) {
                *best = bridge;
            }
        }
    }
}

// From the run's box to the nearest point of a square.
static int64_t GetGap2(const pvtSegmentGrid* grid, const NodeRun* run, int32_t column, int32_t row)
{
    const int64_t left = grid->origin.x + ((int64_t)column << grid->shift);
    const int64_t bottom = grid->origin.y + ((int64_t)row << grid->shift);
    const int64_t width = (int64_t)1 << grid->shift;
    const int64_t x = pvtMaxInt64(0, pvtMaxInt64(left - run->high.x, run->low.x - left - width));
    const int64_t y =
        pvtMaxInt64(0, pvtMaxInt64(bottom - run->high.y, run->low.y - bottom - width));
    return x * x + y * y;
}

// The part of a frame of squares that lies in one row.
static void SearchRow(const Bridger* bridger, const NodeRun* run, int32_t reach, int32_t row,
                      Bridge* best)
{
    const pvtSegmentGrid* grid = &bridger->grid;
    const bool isWhole = row == run->row - reach || row == run->row + reach;
    const int32_t step = isWhole || reach == 0 ? 1 : 2 * reach;
    for (int32_t column = run->column - reach; column <= run->column + reach; column += step) {
        if (column < 0 || column >= grid->columns) {
            continue;
        }
        const uint32_t entry = pvtSegmentGrid_GetHead(grid, column, row);
        if (entry != NONE && GetGap2(grid, run, column, row) < best->length2) {
            SearchSquare(bridger, run, entry, best);
        }
    }
}

static int32_t Clamp(int32_t value, int32_t count)
{
    return value < 0 ? 0 : value >= count ? count - 1 : value;
}

// Squares in growing frames around a run, until what is farther out must be longer than the best.
static void SearchFrom(const Bridger* bridger, const NodeRun* run, Bridge* best)
{
    const pvtSegmentGrid* grid = &bridger->grid;
    const int32_t most = grid->columns > grid->rows ? grid->columns : grid->rows;
    for (int32_t reach = 0; reach < most; ++reach) {
        const int64_t nearest = reach == 0 ? 0 : ((int64_t)(reach - 1) << grid->shift);
        if (nearest * nearest > best->length2) {
            return;
        }
        const int32_t top = Clamp(run->row + reach, grid->rows);
        for (int32_t row = Clamp(run->row - reach, grid->rows); row <= top; ++row) {
            SearchRow(bridger, run, reach, row, best);
        }
    }
}

// The nodes from `first` on that lie in the same square.
static NodeRun FindRun(const Bridger* bridger, uint32_t first, uint32_t end)
{
    const pvtSegmentGrid* grid = &bridger->grid;
    const pvtPoint2 start = bridger->nodes[first].point;
    NodeRun run = {.first = first,
                   .end = first,
                   .column = pvtSegmentGrid_GetColumn(grid, start.x),
                   .row = pvtSegmentGrid_GetRow(grid, start.y),
                   .low = start,
                   .high = start};
    for (; run.end < end; ++run.end) {
        const pvtPoint2 at = bridger->nodes[run.end].point;
        if (pvtSegmentGrid_GetColumn(grid, at.x) != run.column ||
            pvtSegmentGrid_GetRow(grid, at.y) != run.row) {
            break;
        }
        run.low.x = at.x < run.low.x ? at.x : run.low.x;
        run.low.y = at.y < run.low.y ? at.y : run.low.y;
        run.high.x = at.x > run.high.x ? at.x : run.high.x;
        run.high.y = at.y > run.high.y ? at.y : run.high.y;
    }
    return run;
}

static uint32_t AddCopy(Bridger* bridger, uint32_t node)
{
    const uint32_t made = (uint32_t)bridger->nodeCount++;
    bridger->nodes[made] = bridger->nodes[node];
    bridger->nodes[node].copy = made;
    return made;
}

static void LinkNodes(Bridger* bridger, uint32_t from, uint32_t to)
{
    bridger->nodes[from].after = to;
    bridger->nodes[to].before = from;
}

// to → the hole from its bridge's end once around → back to the joined loop.
static void Join(Bridger* bridger, const Bridge* bridge)
{
    const uint32_t onward = bridger->nodes[bridge->to].after;
    const uint32_t around = bridger->nodes[bridge->from].after;
    if (bridge->length2 == 0) {
        LinkNodes(bridger, bridge->to, around);
        LinkNodes(bridger, bridge->from, onward);
        return;
    }
    const uint32_t back = AddCopy(bridger, bridge->to);
    const uint32_t last = AddCopy(bridger, bridge->from);
    LinkNodes(bridger, bridger->nodes[bridge->from].before, last);
    LinkNodes(bridger, last, back);
    LinkNodes(bridger, back, onward);
    LinkNodes(bridger, bridge->to, bridge->from);
}

static pvtStatus JoinHole(pvtContext* context, Bridger* bridger, uint32_t loop)
{
    const pvtLoopSet* contours = bridger->contours;
    Bridge best = {NONE, NONE, INT64_MAX};
    const uint32_t end = (uint32_t)contours->starts[loop + 1];
    for (uint32_t first = (uint32_t)contours->starts[loop]; first < end;) {
        const NodeRun run = FindRun(bridger, first, end);
        SearchFrom(bridger, &run, &best);
        first = run.end;
    }
    if (best.from == NONE) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "hole %u cannot be joined to the loop around it", loop);
    }
    bridger->isJoined[loop] = true;
    const pvtSegment segment = {bridger->nodes[best.from].point, bridger->nodes[best.to].point};
    Join(bridger, &best);
    return best.length2 == 0 ? PVT_OK : pvtSegmentGrid_Add(context, &bridger->grid, segment);
}

static pvtStatus Collect(pvtContext* context, const Bridger* bridger, pvtLoopSet* polygons)
{
    const pvtLoopSet* contours = bridger->contours;
    const size_t outerCount = contours->loopCount - bridger->holeCount;
    const pvtStatus status = pvtCreateLoopSet(context, bridger->nodeCount, outerCount, polygons);
    if (status != PVT_OK) {
        return status;
    }
    for (size_t l = 0; l < contours->loopCount; ++l) {
        const uint32_t first = (uint32_t)contours->starts[l];
        if (contours->parents[l] >= 0 || first == contours->starts[l + 1]) {
            continue;
        }
        uint32_t node = first;
        do {
            polygons->points[polygons->pointCount++] = bridger->nodes[node].point;
            node = bridger->nodes[node].after;
        } while (node != first);
        pvtLoopSet_EndLoop(polygons, -1);
    }
    return PVT_OK;
}

pvtStatus pvtBridgeHoles(pvtContext* context, const pvtLoopSet* contours, pvtLoopSet* polygons)
{
    *polygons = (pvtLoopSet){0};
    Bridger bridger = {.contours = contours};
    pvtStatus status = CreateBridger(context, &bridger);
    for (size_t i = 0; i < bridger.holeCount && status == PVT_OK; ++i) {
        status = i % 16 == 0 && pvtIsCancelled(context)
                     ? pvtFailCancelled(context)
                     : JoinHole(context, &bridger, bridger.holes[i].loop);
    }
    if (status == PVT_OK) {
        status = Collect(context, &bridger, polygons);
    }
    FreeBridger(context, &bridger);
    return status;
}
