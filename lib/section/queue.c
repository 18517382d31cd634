// SPDX-License-Identifier: MIT
// A binary heap that knows where each step is, so that it never holds one twice.
#include "queue.h"

#include "base/context.h"

static const uint32_t NOWHERE = UINT32_MAX;

pvtStatus pvtCreateQueue(pvtContext* context, size_t stepCount, size_t pointCount, pvtQueue* queue)
{
    *queue = (pvtQueue){
        .heap = pvtAllocate(context, stepCount, sizeof *queue->heap),
        .places = pvtAllocate(context, stepCount, sizeof *queue->places),
        .waiting = pvtAllocate(context, pointCount, sizeof *queue->waiting),
    };
    if (queue->heap == NULL || queue->places == NULL || queue->waiting == NULL) {
        pvtQueue_Free(context, queue);
        return pvtContext_GetStatus(context);
    }
    pvtQueue_Reset(queue, stepCount, pointCount);
    return PVT_OK;
}

void pvtQueue_Free(pvtContext* context, pvtQueue* queue)
{
    pvtRelease(context, queue->heap);
    pvtRelease(context, queue->places);
    pvtRelease(context, queue->waiting);
    *queue = (pvtQueue){0};
}

void pvtQueue_Reset(pvtQueue* queue, size_t stepCount, size_t pointCount)
{
    for (size_t i = 0; i < stepCount; ++i) {
        queue->places[i] = (pvtQueuePlace){.heap = NOWHERE, .waitsOn = NOWHERE};
    }
    for (size_t i = 0; i < pointCount; ++i) {
        queue->waiting[i] = NOWHERE;
    }
    queue->count = 0;
}

static bool IsBefore(pvtQueueEntry a, pvtQueueEntry b)
{
    return a.cost < b.cost || (a.cost == b.cost && a.step < b.step);
}

static void Put(pvtQueue* queue, uint32_t index, pvtQueueEntry entry)
{
    queue->heap[index] = entry;
    queue->places[entry.step].heap = index;
}

// Moves what is at `index` up or down to where it belongs.
static void Settle(pvtQueue* queue, uint32_t index)
{
    const pvtQueueEntry entry = queue->heap[index];
    while (index > 0 && IsBefore(entry, queue->heap[(index - 1) / 2])) {
        Put(queue, index, queue->heap[(index - 1) / 2]);
        index = (index - 1) / 2;
    }
    for (uint32_t child; (child = 2 * index + 1) < queue->count; index = child) {
        if (child + 1 < queue->count && IsBefore(queue->heap[child + 1], queue->heap[child])) {
            ++child;
        }
        if (!IsBefore(queue->heap[child], entry)) {
            break;
        }
        Put(queue, index, queue->heap[child]);
    }
    Put(queue, index, entry);
}

static void RemoveFromHeap(pvtQueue* queue, uint32_t index)
{
    queue->places[queue->heap[index].step].heap = NOWHERE;
    const pvtQueueEntry last = queue->heap[--queue->count];
    if (index < queue->count) {
        Put(queue, index, last);
        Settle(queue, index);
    }
}

static void StopWaiting(pvtQueue* queue, uint32_t step)
{
    pvtQueuePlace* place = &queue->places[step];
    if (place->waitsOn == NOWHERE) {
        return;
    }
    uint32_t* first = &queue->waiting[place->waitsOn];
    queue->places[place->before].after = place->after;
    queue->places[place->after].before = place->before;
    if (*first == step) {
        *first = place->after == step ? NOWHERE : place->after;
    }
    place->waitsOn = NOWHERE;
}

void pvtQueue_Push(pvtQueue* queue, uint32_t step, int64_t cost)
{
    StopWaiting(queue, step);
    pvtQueuePlace* place = &queue->places[step];
    if (place->heap == NOWHERE) {
        place->heap = queue->count++;
    }
    place->cost = cost;
    queue->heap[place->heap] = (pvtQueueEntry){cost, step};
    Settle(queue, place->heap);
}

void pvtQueue_Drop(pvtQueue* queue, uint32_t step)
{
    StopWaiting(queue, step);
    if (queue->places[step].heap != NOWHERE) {
        RemoveFromHeap(queue, queue->places[step].heap);
    }
}

bool pvtQueue_Pop(pvtQueue* queue, uint32_t* step)
{
    if (queue->count == 0) {
        return false;
    }
    *step = queue->heap[0].step;
    RemoveFromHeap(queue, 0);
    return true;
}

void pvtQueue_Wait(pvtQueue* queue, uint32_t step, uint32_t point)
{
    pvtQueuePlace* place = &queue->places[step];
    const uint32_t first = queue->waiting[point];
    place->waitsOn = point;
    if (first == NOWHERE) {
        place->before = place->after = step;
        queue->waiting[point] = step;
        return;
    }
    place->after = first;
    place->before = queue->places[first].before;
    queue->places[place->before].after = step;
    queue->places[first].before = step;
}

void pvtQueue_Wake(pvtQueue* queue, uint32_t point)
{
    while (queue->waiting[point] != NOWHERE) {
        const uint32_t step = queue->waiting[point];
        pvtQueue_Push(queue, step, queue->places[step].cost);
    }
}
