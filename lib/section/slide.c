// SPDX-License-Identifier: MIT
// Points that slide along what the polygon was.
//
// Taking out one point after the other leaves those that stay where they were, at uneven distances.
// So after each step the points nearby may move to places that were points once, or towards them:
// along a smooth boundary they spread, and the polygon comes near the largest that its number of
// points allows.
#include "links.h"

static const uint32_t NONE = UINT32_MAX;

// Points tried on each side of one that might slide, and places on the way to each. More of either
// gain little and cost as much again.
enum { TARGETS = 2, STOPS = 3 };

// before → node → after is to become before → target → after.
typedef struct SlideWay {
    uint32_t before, node, after;
    pvtPoint2 target;
    uint32_t behind; // the node that the target follows in the order of links
    bool isForward;  // the target came between node and after, not between before and node
} SlideWay;

// Of the nodes between two neighbours in the order of links, the one that would make the most area
// as a point between `before` and `after`, but less than `*area2`.
static bool SearchGap(const pvtLinks* links, int64_t least, SlideWay* way, int64_t* area2)
{
    const pvtRingNode* nodes = links->ring.nodes;
    const pvtPoint2 before = nodes[way->before].point, after = nodes[way->after].point;
    const uint32_t begin = way->isForward ? way->node : way->before;
    const uint32_t end = way->isForward ? way->after : way->node;
    const int64_t below = *area2;
    *area2 = least;
    for (uint32_t at = begin;;) {
        at = links->nodes[at].behind == NONE ? links->first : links->nodes[at].behind;
        if (at == end) {
            return *area2 > least;
        }
        const int64_t made = pvtOrient(before, nodes[at].point, after);
        if (made > *area2 && made < below) {
            *area2 = made;
            way->behind = at;
            way->target = nodes[at].point;
        }
    }
}

// A triangle that is taken away when its corners run counter-clockwise, else added. Nothing of the
// boundary may be in it; `runs` are those of its corners whose own edges might run into it, and
// `other` is the point of the way that is no corner.
static bool MayChange(const pvtLinks* links, const SlideWay* way, const pvtPoint2 corners[3],
                      const uint32_t runs[2], uint32_t other)
{
    const bool isAdded = pvtOrient(corners[0], corners[1], corners[2]) < 0;
    const pvtPoint2 turned[3] = {corners[isAdded ? 2 : 0], corners[1], corners[isAdded ? 0 : 2]};
    const uint32_t ends[4] = {way->before, way->node, way->after, way->after};
    return pvtLinks_FindPoint(links, turned, ends, (uint32_t[2]){other, other}) == NONE &&
           !pvtLinks_RunsIn(links, turned, runs[0]) && !pvtLinks_RunsIn(links, turned, runs[1]) &&
           (!isAdded || pvtLinks_IsCovered(links, corners[0], corners[1], corners[2]));
}

// The target goes in on its side of the node first, and then the node goes: each must leave the
// polygon weakly simple. An edge that crosses one of the two triangles crosses node → target.
static bool MaySlide(const pvtLinks* links, const SlideWay* way)
{
    const pvtRingNode* nodes = links->ring.nodes;
    // Backwards all is mirrored.
    const uint32_t far = way->isForward ? way->before : way->after;
    const uint32_t near = way->isForward ? way->after : way->before;
    const pvtPoint2 farPoint = nodes[far].point, nearPoint = nodes[near].point;
    const pvtPoint2 at = nodes[way->node].point, target = way->target;
    const pvtPoint2 in[3] = {way->isForward ? nearPoint : at, target,
                             way->isForward ? at : nearPoint};
    const pvtPoint2 out[3] = {way->isForward ? farPoint : target, at,
                              way->isForward ? target : farPoint};
    if (pvtOrient(at, target, nearPoint) == 0 && !pvtIsOnSegment(target, at, nearPoint)) {
        return false;
    }
    return MayChange(links, way, in, (uint32_t[2]){way->node, near}, far) &&
           MayChange(links, way, out, (uint32_t[2]){far, far}, near) &&
           pvtRing_FindEdge(&links->ring, at, target,
                            (uint32_t[3]){way->before, way->node, way->node}) == NONE;
}

static pvtPoint2 GetMiddle(pvtPoint2 a, pvtPoint2 b)
{
    return (pvtPoint2){a.x + (b.x - a.x) / 2, a.y + (b.y - a.y) / 2};
}

// Tries the target, and places half and a quarter of the way there as long as those are worth it.
static bool FindStop(const pvtLinks* links, SlideWay* way, int64_t least)
{
    const pvtRingNode* nodes = links->ring.nodes;
    const int64_t worth = least + (least < 0 ? -least : least) / 32;
    for (int i = 0; i < STOPS; ++i) {
        if (MaySlide(links, way)) {
            return true;
        }
        way->target = GetMiddle(nodes[way->node].point, way->target);
        const int64_t area2 =
            pvtOrient(nodes[way->before].point, way->target, nodes[way->after].point);
        if (area2 <= worth) {
            return false;
        }
    }
    return false;
}

uint32_t pvtLinks_Slide(pvtLinks* links, uint32_t node)
{
    const pvtRingNode* nodes = links->ring.nodes;
    SlideWay way = {.before = nodes[node].before, .node = node, .after = nodes[node].after};
    const int64_t least =
        pvtOrient(nodes[way.before].point, nodes[node].point, nodes[way.after].point);
    int64_t below[2] = {INT64_MAX, INT64_MAX};
    for (int i = 0; i < 2 * TARGETS; ++i) {
        way.isForward = i % 2 == 0;
        if (SearchGap(links, least, &way, &below[i % 2]) && FindStop(links, &way, least)) {
            // Links of the size at hand have the new point, longer ones the old one.
            const uint32_t size = links->ring.count;
            pvtLinks_TakeOut(links, node, size + 1);
            return pvtLinks_PutIn(links, way.before, way.target, size, way.behind);
        }
    }
    return NONE;
}
