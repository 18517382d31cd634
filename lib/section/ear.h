// SPDX-License-Identifier: MIT
// When a point may be taken out of a weakly simple polygon, by a rule that is exact also where the
// boundary touches itself: at bridges, at cells that meet diagonally, at points that lie on edges.
//
// Taking out point v between its neighbours a and b replaces the way a → v → b by a → b. The
// polygon stays weakly simple when no other part of the boundary reaches into the open triangle,
// and when the triangle lies on the side that it seems to lie on. Other edges never cross a → v →
// b, so that one which reaches in has an end in the closed triangle: it is enough to look at the
// points there.
#ifndef PVT_SECTION_EAR_H
#define PVT_SECTION_EAR_H

#include "predicates.h"

/// The triangle of a point to be taken out.
typedef struct pvtEar {
    pvtPoint2 corners[3]; ///< counter-clockwise; corners[1] is the point, 2 → 0 the new edge
    bool isReflex;        ///< the triangle is added to the polygon, not taken from it
    bool allowsPinch;     ///< the new edge may run through other points
} pvtEar;

/// The three points must not lie on one line.
static inline pvtEar pvtMakeEar(pvtPoint2 before, pvtPoint2 at, pvtPoint2 after, bool allowsPinch)
{
    const bool isReflex = pvtOrient(before, at, after) < 0;
    const pvtPoint2 first = isReflex ? after : before;
    const pvtPoint2 last = isReflex ? before : after;
    return (pvtEar){{first, at, last}, isReflex, allowsPinch};
}

// The corner's angle, halved: a place strictly inside it.
static inline pvtPoint2 pvtEar_GetPlaceInside(const pvtEar* ear)
{
    const pvtPoint2 a = ear->corners[0], v = ear->corners[1], b = ear->corners[2];
    return (pvtPoint2){a.x + b.x - v.x, a.y + b.y - v.y};
}

/// True when the boundary that passes here keeps the point from being taken out. Not to be asked of
/// the ear's own point; its neighbours may be asked.
static inline bool pvtEar_IsBlocked(const pvtEar* ear, const pvtPass* pass)
{
    bool comesIn = true, goesIn = true;
    int onLines = 0;
    for (int i = 0; i < 3; ++i) {
        const pvtPoint2 p = ear->corners[i], q = ear->corners[i == 2 ? 0 : i + 1];
        const int64_t side = pvtOrient(p, q, pass->at);
        if (side < 0) {
            return false;
        }
        if (side == 0) {
            onLines |= 1 << i;
            comesIn = comesIn && pvtOrient(p, q, pass->before) > 0;
            goesIn = goesIn && pvtOrient(p, q, pass->after) > 0;
        }
    }
    if (comesIn || goesIn) {
        return true; // also when the point lies strictly inside
    }
    if (onLines == 1 << 2) {
        return !ear->allowsPinch; // on the new edge, between its ends
    }
    // The boundary may touch a reflex point from outside: what it bounds must not be added again.
    const bool isAtPoint = onLines == ((1 << 0) | (1 << 1));
    return isAtPoint && ear->isReflex && pvtPass_IsInside(pass, pvtEar_GetPlaceInside(ear));
}

#endif
