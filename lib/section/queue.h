// SPDX-License-Identifier: MIT
// Steps that may be taken on a polygon, cheapest first. A step that something stands in the way of
// waits on that point until it is gone.
#ifndef PVT_SECTION_QUEUE_H
#define PVT_SECTION_QUEUE_H

#include <paravent/section.h>

typedef struct pvtQueueEntry {
    int64_t cost;
    uint32_t step;
} pvtQueueEntry;

/// Of one step: its place in the heap, or in the ring of those that wait on one point.
typedef struct pvtQueuePlace {
    uint32_t heap; ///< UINT32_MAX: not in the heap
    uint32_t before, after;
    uint32_t waitsOn; ///< UINT32_MAX: it does not wait
    int64_t cost;
} pvtQueuePlace;

typedef struct pvtQueue {
    pvtQueueEntry* heap;
    pvtQueuePlace* places; ///< one a step
    uint32_t* waiting;     ///< one a point: the first step that waits on it, or UINT32_MAX
    uint32_t count;
} pvtQueue;

pvtStatus pvtCreateQueue(pvtContext* context, size_t stepCount, size_t pointCount, pvtQueue* queue);
void pvtQueue_Free(pvtContext* context, pvtQueue* queue);
/// Empties a queue for the steps and points below these counts.
void pvtQueue_Reset(pvtQueue* queue, size_t stepCount, size_t pointCount);
/// Adds a step, or gives it another cost; it no longer waits.
void pvtQueue_Push(pvtQueue* queue, uint32_t step, int64_t cost);
/// Takes a step out, wherever it is.
void pvtQueue_Drop(pvtQueue* queue, uint32_t step);
/// The step of least cost, lowest number first; false when there is none.
bool pvtQueue_Pop(pvtQueue* queue, uint32_t* step);
/// Lays a step that is not in the heap by until pvtQueue_Wake(point); it keeps its cost.
void pvtQueue_Wait(pvtQueue* queue, uint32_t step, uint32_t point);
void pvtQueue_Wake(pvtQueue* queue, uint32_t point);

#endif
