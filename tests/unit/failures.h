// SPDX-License-Identifier: MIT
// Contexts whose memory runs out, or that are told to stop.
#ifndef PVT_TEST_FAILURES_H
#define PVT_TEST_FAILURES_H

#include "check.h"

#include <stdatomic.h>
#include <stdlib.h>

/// Memory that refuses the request with number `failAt`, counted from 0, and all that come after
/// it, or that one alone. Request 0 is the context's own.
typedef struct PoorHeap {
    atomic_int requests;
    int failAt;
    bool failsOnce;
} PoorHeap;

static inline void* AllocateFromPoorHeap(void* user, size_t size)
{
    PoorHeap* heap = user;
    const int request = atomic_fetch_add(&heap->requests, 1);
    const bool isRefused = heap->failsOnce ? request == heap->failAt : request >= heap->failAt;
    return isRefused ? NULL : malloc(size);
}

static inline void ReleaseToPoorHeap(void* user, void* memory)
{
    (void)user;
    free(memory);
}

static inline bool PoorHeap_HasRefused(const PoorHeap* heap)
{
    return atomic_load(&heap->requests) > heap->failAt;
}

static inline pvtContext* CreatePoorContext(PoorHeap* heap)
{
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = 1;
    def.allocator = (pvtAllocator){AllocateFromPoorHeap, ReleaseToPoorHeap, heap};
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    return context;
}

/// How many more questions whether to stop are answered with no.
typedef struct CancelCounter {
    atomic_long left;
} CancelCounter;

static inline bool IsCancelledAfter(void* user)
{
    CancelCounter* counter = user;
    return atomic_fetch_sub(&counter->left, 1) <= 0;
}

static inline pvtContext* CreateCancelledContext(CancelCounter* counter, int threadCount)
{
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = threadCount;
    def.isCancelled = IsCancelledAfter;
    def.user = counter;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    return context;
}

/// A stage as the checks below run it: it frees what it made.
typedef pvtStatus StageFcn(pvtContext* context, const void* input);

/// Lets the first, second, third … request of a stage and all after it fail, until it succeeds: it
/// must ask for memory at all, say when it gets none, and hold nothing afterwards.
static inline void CheckEveryAllocation(StageFcn* stage, const void* input)
{
    pvtStatus status = PVT_OUT_OF_MEMORY;
    for (int failAt = 1; status != PVT_OK; ++failAt) {
        PoorHeap heap = {.failAt = failAt};
        pvtContext* context = CreatePoorContext(&heap);
        status = stage(context, input);
        assert_true(status == PVT_OK || status == PVT_OUT_OF_MEMORY);
        assert_true((status == PVT_OK) == !PoorHeap_HasRefused(&heap));
        assert_true(failAt > 1 || status == PVT_OUT_OF_MEMORY);
        assert_true(failAt < 10000);
        DestroyTestContext(context);
    }
}

/// Cancels at the first, second, fourth, eighth … question, until the stage runs through: it must
/// ask at least once, and hold nothing after it was cancelled.
static inline void CheckEveryCancel(StageFcn* stage, const void* input)
{
    pvtStatus status = PVT_CANCELLED;
    for (long count = 0; status != PVT_OK; count = 2 * count + 1) {
        CancelCounter counter = {count};
        pvtContext* context = CreateCancelledContext(&counter, 2);
        status = stage(context, input);
        assert_true(status == PVT_CANCELLED || (status == PVT_OK && count > 0));
        DestroyTestContext(context);
    }
}

#endif
