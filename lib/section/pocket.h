// SPDX-License-Identifier: MIT
// What lies between a stretch of a loop and the chord that would take its place.
#ifndef PVT_SECTION_POCKET_H
#define PVT_SECTION_POCKET_H

#include "predicates.h"

/// Points `first` to `last` of a loop of `count` points; numbers from count on go around again.
/// The pocket is bounded by them and the way straight back.
typedef struct pvtPocket {
    const pvtPoint2* loop;
    size_t count;
    size_t first, last;
} pvtPocket;

typedef struct pvtPocketCrossing {
    int32_t row, column; ///< the first cell whose centre lies right of the crossing
    int32_t turn;        ///< 1 for an edge that goes up, −1 for one that goes down
} pvtPocketCrossing;

/// Work space, used again for each pocket.
typedef struct pvtPocketScratch {
    pvtPocketCrossing* crossings;
    size_t count, capacity;
} pvtPocketScratch;

static inline pvtPoint2 pvtPocket_GetPoint(const pvtPocket* pocket, size_t number)
{
    return pocket->loop[number < pocket->count ? number : number - pocket->count];
}

/// True when every cell whose centre the pocket's border winds around is set in `cells`, which are
/// `unit` point units wide.
pvtStatus pvtPocket_IsCovered(pvtContext* context, const pvtPocket* pocket, const pvtBitmap* cells,
                              int32_t unit, pvtPocketScratch* scratch, bool* isCovered);

/// True when the pocket's border winds around the point or runs through it.
bool pvtPocket_Holds(const pvtPocket* pocket, pvtPoint2 point);

#endif
