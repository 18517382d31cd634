// SPDX-License-Identifier: MIT
// The links of a chain.
//
// After Silvennoinen et al., "Occluder Simplification Using Planar Sections", 2014, section 4.4,
// which takes out the point that costs least area. Two things differ. A reflex point whose triangle
// may be covered goes first: the polygon gains by it. And a whole edge may go instead of a point,
// its neighbours meeting where their lines do, as in Sander et al., "Silhouette Clipping", 2000,
// section 3 (progressive hulls): along a bay or a hole no point can go without leaving the polygon,
// but edges can.
#include "links.h"

#include "base/context.h"
#include "cover.h"

#include <assert.h>
#include <math.h>

static const uint32_t NONE = UINT32_MAX;

// Removes what has no area before anything else.
static const int64_t FREE_COST = INT64_MIN;

// Coordinates above this [point units] would not fit the exact predicates.
#define FARTHEST 0x1p27

// An edge and its neighbours: before → from → to → after.
typedef struct EdgeWay {
    pvtPoint2 before, from, to, after;
} EdgeWay;

pvtStatus pvtCreateLinks(pvtContext* context, size_t capacity, uint32_t longest, pvtLinks* links)
{
    *links = (pvtLinks){.longest = longest};
    const size_t nodes = pvtGetLinkNodeLimit(capacity);
    pvtStatus status = pvtCreateRing(context, capacity, nodes, &links->ring);
    if (status == PVT_OK) {
        status = pvtCreateQueue(context, 2 * nodes, nodes, &links->queue);
    }
    if (status == PVT_OK) {
        links->nodes = pvtAllocate(context, nodes, sizeof *links->nodes);
        links->meetings = pvtAllocate(context, nodes, sizeof *links->meetings);
        if (links->nodes == NULL || links->meetings == NULL) {
            status = pvtContext_GetStatus(context);
        }
    }
    if (status != PVT_OK) {
        pvtLinks_Free(context, links);
    }
    return status;
}

void pvtLinks_Free(pvtContext* context, pvtLinks* links)
{
    pvtRing_Free(context, &links->ring);
    pvtQueue_Free(context, &links->queue);
    pvtRelease(context, links->nodes);
    pvtRelease(context, links->meetings);
    *links = (pvtLinks){0};
}

bool pvtLinks_IsCovered(const pvtLinks* links, pvtPoint2 a, pvtPoint2 b, pvtPoint2 c)
{
    const pvtPoint2 corners[3] = {a, b, c};
    // Once edges may run through points it is no longer known what lies on their right.
    return links->cells != NULL && !links->allowsPinch &&
           pvtIsTriangleCovered(links->cells, links->cellUnit, corners);
}

// The area that goes when the point goes; what a reflex point adds counts as gained.
static void ScorePoint(pvtLinks* links, uint32_t node)
{
    const pvtPass pass = pvtRing_GetPass(&links->ring, node);
    const int64_t area2 = pvtOrient(pass.before, pass.at, pass.after);
    if (area2 < 0 && !pvtLinks_IsCovered(links, pass.before, pass.at, pass.after)) {
        pvtQueue_Drop(&links->queue, 2 * node);
        return;
    }
    pvtQueue_Push(&links->queue, 2 * node, area2 == 0 ? FREE_COST : area2);
}

static EdgeWay GetWay(const pvtLinks* links, uint32_t node)
{
    const pvtRingNode* nodes = links->ring.nodes;
    const uint32_t to = nodes[node].after;
    return (EdgeWay){nodes[nodes[node].before].point, nodes[node].point, nodes[to].point,
                     nodes[nodes[to].after].point};
}

// Twice the area between the way and before → meeting → after. The meeting must not lie right of
// the neighbours' lines: then what the two of them cut off belongs to the polygon.
static bool GetMeetingCost(const EdgeWay* way, pvtPoint2 meeting, int64_t* cost)
{
    const int64_t first = pvtOrient(way->before, way->from, meeting);
    const int64_t last = pvtOrient(way->to, way->after, meeting);
    *cost = first + last + pvtOrient(way->from, way->to, meeting);
    return first >= 0 && last >= 0;
}

// Of the places around the exact meeting, the one that costs least.
static bool RoundMeeting(const EdgeWay* way, double x, double y, pvtPoint2* meeting)
{
    int64_t best = INT64_MAX;
    // Sharp meetings may have no place among the nearest four.
    for (int reach = 0; reach <= 1 && best == INT64_MAX; ++reach) {
        for (int i = -reach; i <= 1 + reach; ++i) {
            for (int j = -reach; j <= 1 + reach; ++j) {
                const pvtPoint2 place = {(int32_t)floor(x) + i, (int32_t)floor(y) + j};
                int64_t cost;
                if (GetMeetingCost(way, place, &cost) && cost < best) {
                    best = cost;
                    *meeting = place;
                }
            }
        }
    }
    return best != INT64_MAX;
}

// Where the lines before → from and after → to meet, when that is beyond one of the edge's ends.
static bool FindMeeting(const EdgeWay* way, pvtPoint2* meeting)
{
    const double turn = (double)pvtCrossEdges(way->before, way->from, way->after, way->to);
    if (turn == 0.0) {
        return false;
    }
    const double s = (double)pvtCrossEdges(way->before, way->after, way->after, way->to) / turn;
    const double t = (double)pvtCrossEdges(way->before, way->after, way->before, way->from) / turn;
    if (!(s > 0.0 && t > 0.0 && (s > 1.0 || t > 1.0))) {
        return false;
    }
    const double x = way->before.x + s * (way->from.x - way->before.x);
    const double y = way->before.y + s * (way->from.y - way->before.y);
    // Lines that are all but parallel meet too far off to be of use.
    return fabs(x) < FARTHEST && fabs(y) < FARTHEST && RoundMeeting(way, x, y, meeting);
}

static void ScoreEdge(pvtLinks* links, uint32_t node)
{
    const uint32_t step = 2 * node + 1;
    const EdgeWay way = GetWay(links, node);
    pvtPoint2* meeting = &links->meetings[node];
    if (links->ring.count < 4 || !FindMeeting(&way, meeting)) {
        pvtQueue_Drop(&links->queue, step);
        return;
    }
    const int64_t side = pvtOrient(way.from, way.to, *meeting);
    int64_t cost;
    GetMeetingCost(&way, *meeting, &cost);
    const bool isAtEnd =
        pvtIsSamePoint(*meeting, way.before) || pvtIsSamePoint(*meeting, way.after);
    if (isAtEnd || side == 0 ||
        (side < 0 && !pvtLinks_IsCovered(links, way.from, *meeting, way.to))) {
        pvtQueue_Drop(&links->queue, step);
        return;
    }
    pvtQueue_Push(&links->queue, step, cost);
}

static void ScoreAll(pvtLinks* links)
{
    for (uint32_t lane = 0; lane < links->ring.count; ++lane) {
        ScorePoint(links, links->ring.owners[lane]);
        ScoreEdge(links, links->ring.owners[lane]);
    }
}

// A point on a straight way where the boundary touches itself stays as long as it does, so that
// points touch points only, never edges. Returns the other point.
static uint32_t FindContact(const pvtLinks* links, uint32_t node, const pvtPass* pass)
{
    if (links->allowsPinch || pvtDotEdges(pass->at, pass->before, pass->at, pass->after) >= 0) {
        return NONE;
    }
    const pvtPoint2 corners[3] = {pass->at, pass->at, pass->at};
    const uint32_t except[4] = {node, node, node, node};
    return pvtRing_FindPoint(&links->ring, corners, except);
}

static uint32_t FindPointBlocker(const pvtLinks* links, uint32_t node)
{
    const pvtPass pass = pvtRing_GetPass(&links->ring, node);
    if (pvtOrient(pass.before, pass.at, pass.after) == 0) {
        return FindContact(links, node, &pass);
    }
    const pvtEar ear = pvtMakeEar(pass.before, pass.at, pass.after, links->allowsPinch);
    return pvtRing_FindBlocker(&links->ring, &ear, node);
}

static bool IsInside(const pvtPoint2 corners[3], pvtPoint2 point)
{
    return pvtOrient(corners[0], corners[1], point) >= 0 &&
           pvtOrient(corners[1], corners[2], point) >= 0 &&
           pvtOrient(corners[2], corners[0], point) >= 0;
}

uint32_t pvtLinks_FindPoint(const pvtLinks* links, const pvtPoint2 corners[3],
                            const uint32_t way[4], const uint32_t others[2])
{
    if (pvtOrient(corners[0], corners[1], corners[2]) == 0) {
        return NONE;
    }
    for (int i = 0; i < 2; ++i) {
        if (IsInside(corners, links->ring.nodes[others[i]].point)) {
            return others[i];
        }
    }
    return pvtRing_FindPoint(&links->ring, corners, way);
}

bool pvtLinks_RunsIn(const pvtLinks* links, const pvtPoint2 corners[3], uint32_t end)
{
    if (pvtOrient(corners[0], corners[1], corners[2]) == 0) {
        return false;
    }
    const pvtEar ear = {{corners[0], corners[1], corners[2]}, false, true};
    const pvtPass pass = pvtRing_GetPass(&links->ring, end);
    return pvtEar_IsBlocked(&ear, &pass);
}

// A point of the boundary that lies in what the meeting cuts off or adds. The way's own points are
// corners of some of the three triangles, and must not lie in the others.
static uint32_t FindPointInCuts(const pvtLinks* links, const uint32_t way[4],
                                const pvtPoint2 cuts[3][3])
{
    const uint32_t others[3][2] = {{way[2], way[3]}, {way[0], way[3]}, {way[0], way[1]}};
    for (int i = 0; i < 3; ++i) {
        const uint32_t blocker = pvtLinks_FindPoint(links, cuts[i], way, others[i]);
        if (blocker != NONE) {
            return blocker;
        }
    }
    return NONE;
}

// All that may stand in the way of an edge's going; points that touch the way do so too. With no
// point in the three triangles, an edge through one of them crosses from → meeting.
static uint32_t FindEdgeBlocker(const pvtLinks* links, uint32_t node)
{
    const pvtRingNode* nodes = links->ring.nodes;
    const uint32_t to = nodes[node].after;
    const uint32_t way[4] = {nodes[node].before, node, to, nodes[to].after};
    const EdgeWay at = GetWay(links, node);
    const pvtPoint2 meeting = links->meetings[node];
    const bool isAdded = pvtOrient(at.from, at.to, meeting) < 0;
    const pvtPoint2 cuts[3][3] = {
        {at.before, at.from, meeting},
        {at.from, isAdded ? meeting : at.to, isAdded ? at.to : meeting},
        {meeting, at.to, at.after},
    };
    const uint32_t blocker = FindPointInCuts(links, way, cuts);
    if (blocker != NONE) {
        return blocker;
    }
    if (pvtLinks_RunsIn(links, cuts[0], way[0])) {
        return nodes[way[0]].before;
    }
    if (pvtLinks_RunsIn(links, cuts[2], way[3])) {
        return nodes[way[3]].after;
    }
    return pvtRing_FindEdge(&links->ring, at.from, meeting, way);
}

static bool FindStep(pvtLinks* links, uint32_t* step)
{
    while (pvtQueue_Pop(&links->queue, step)) {
        const uint32_t node = *step / 2;
        const uint32_t blocker =
            *step % 2 == 0 ? FindPointBlocker(links, node) : FindEdgeBlocker(links, node);
        if (blocker == NONE) {
            return true;
        }
        pvtQueue_Wait(&links->queue, *step, blocker);
    }
    return false;
}

// As FindStep, with another look at those that wait: their blockers may have turned away without
// going.
static bool FindStepAnyhow(pvtLinks* links, uint32_t* step)
{
    if (FindStep(links, step)) {
        return true;
    }
    ScoreAll(links);
    if (FindStep(links, step)) {
        return true;
    }
    links->allowsPinch = true;
    ScoreAll(links);
    return FindStep(links, step);
}

// From now on links are kept: the first has every point of the ring.
static void BeginLinks(pvtLinks* links)
{
    const pvtRing* ring = &links->ring;
    links->first = ring->owners[0];
    for (uint32_t lane = 1; lane < ring->count; ++lane) {
        links->first = ring->owners[lane] < links->first ? ring->owners[lane] : links->first;
    }
    uint32_t node = links->first;
    do {
        const uint32_t after = ring->nodes[node].after;
        links->nodes[node] = (pvtLinkNode){3, UINT32_MAX, after == links->first ? NONE : after};
        node = after;
    } while (node != links->first);
}

void pvtLinks_TakeOut(pvtLinks* links, uint32_t node, uint32_t rank)
{
    links->nodes[node].rank = rank;
    pvtRing_Remove(&links->ring, node);
    pvtQueue_Drop(&links->queue, 2 * node);
    pvtQueue_Drop(&links->queue, 2 * node + 1);
    pvtQueue_Wake(&links->queue, node);
}

uint32_t pvtLinks_PutIn(pvtLinks* links, uint32_t node, pvtPoint2 point, uint32_t limit,
                        uint32_t behind)
{
    const uint32_t made = pvtRing_InsertAfter(&links->ring, node, point);
    links->nodes[made] = (pvtLinkNode){3, limit, links->nodes[behind].behind};
    links->nodes[behind].behind = made;
    return made;
}

// Scores all steps that a change at a point, or just behind it, has a part in.
static void ScoreAround(pvtLinks* links, uint32_t node)
{
    const pvtRingNode* nodes = links->ring.nodes;
    const uint32_t before = nodes[node].before, after = nodes[node].after;
    ScorePoint(links, before);
    ScorePoint(links, node);
    ScorePoint(links, after);
    ScoreEdge(links, nodes[before].before);
    ScoreEdge(links, before);
    ScoreEdge(links, node);
    ScoreEdge(links, after);
}

// Returns the node before the gap.
static uint32_t TakeOutPoint(pvtLinks* links, uint32_t node)
{
    const uint32_t before = links->ring.nodes[node].before;
    pvtLinks_TakeOut(links, node, links->ring.count);
    ScoreAround(links, before);
    return before;
}

// Returns the node before the one where the edge's neighbours meet.
static uint32_t TakeOutEdge(pvtLinks* links, uint32_t from)
{
    const pvtPoint2 meeting = links->meetings[from];
    const uint32_t size = links->ring.count;
    const uint32_t before = links->ring.nodes[from].before;
    pvtLinks_TakeOut(links, links->ring.nodes[from].after, size);
    pvtLinks_TakeOut(links, from, size);
    const uint32_t made = pvtLinks_PutIn(links, before, meeting, size - 1, from);
    ScoreAround(links, made);
    return before;
}

// Slides `reach` points from `node` on, and those around each that slid, for as long as that helps.
static void SlidePoints(pvtLinks* links, uint32_t node, uint32_t reach)
{
    for (uint32_t unmoved = 0; unmoved < reach && links->slidesLeft > 0;) {
        const uint32_t moved = pvtLinks_Slide(links, node);
        if (moved == NONE) {
            ++unmoved;
            node = links->ring.nodes[node].after;
        } else {
            --links->slidesLeft;
            ScoreAround(links, moved);
            unmoved = 0;
            reach = 3;
            node = links->ring.nodes[moved].before;
        }
    }
}

static void TakeStep(pvtLinks* links, uint32_t step)
{
    // Links before a step that costs nothing are no better than the link behind it.
    if (links->first == NONE && links->ring.count <= links->longest &&
        links->queue.places[step].cost > 0) {
        BeginLinks(links);
    }
    const bool isPoint = step % 2 == 0;
    const uint32_t node = isPoint ? TakeOutPoint(links, step / 2) : TakeOutEdge(links, step / 2);
    if (links->first != NONE && links->ring.count <= PVT_SLIDE_POINTS) {
        SlidePoints(links, node, isPoint ? 2 : 3);
    }
}

pvtStatus pvtLinks_Build(pvtContext* context, pvtLinks* links, const pvtPoint2* points,
                         size_t count)
{
    assert(count >= 3);
    const size_t nodes = pvtGetLinkNodeLimit(count);
    pvtRing_Reset(&links->ring, points, count);
    pvtQueue_Reset(&links->queue, 2 * nodes, nodes);
    links->first = NONE;
    links->allowsPinch = false;
    links->slidesLeft = nodes - 2 * count;
    ScoreAll(links);
    uint32_t step;
    while (links->ring.count > 3 && FindStepAnyhow(links, &step)) {
        if (links->ring.count % 512 == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        TakeStep(links, step);
    }
    if (links->first == NONE) {
        BeginLinks(links);
    }
    return PVT_OK;
}
