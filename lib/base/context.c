// SPDX-License-Identifier: MIT
// The context: the last error, accounted memory, log, progress and cancelling.
#include "context.h"

#include "tasks.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { MESSAGE_SIZE = 2048, ALIGNMENT = 64, SCOPE_SIZE = 24, STAGE_SIZE = 64, MOST_TOLD = 16 };

struct pvtContext {
    pvtContextDef def;
    pvtTaskPool* pool; // made when it is first needed
    pthread_mutex_t messageLock;
    char message[MESSAGE_SIZE];
    _Atomic pvtStatus status;
    char scope[SCOPE_SIZE];      // what the stages belong to; "" for nothing
    const char* told[MOST_TOLD]; // warnings in the scopes since there was none
    int toldCount;
    char stage[STAGE_SIZE];
    double reported;
    atomic_size_t held, peak;
};

// In front of each block: what the allocator returned, and how much of it counts.
typedef struct BlockHeader {
    void* raw;
    size_t size;
} BlockHeader;

static void* AllocateFromHeap(void* user, size_t size)
{
    (void)user;
    return malloc(size);
}

static void ReleaseToHeap(void* user, void* memory)
{
    (void)user;
    free(memory);
}

pvtContextDef pvtDefaultContextDef(void)
{
    return (pvtContextDef){.allocator = {AllocateFromHeap, ReleaseToHeap, NULL}};
}

pvtStatus pvtCreateContext(const pvtContextDef* def, pvtContext** context)
{
    *context = NULL;
    pvtContextDef full = def != NULL ? *def : pvtDefaultContextDef();
    if (full.allocator.allocate == NULL || full.allocator.release == NULL) {
        full.allocator = pvtDefaultContextDef().allocator;
    }
    if (full.threadCount < 0 || full.threadCount > PVT_MAX_THREADS) {
        return PVT_INVALID_ARGUMENT;
    }
    if (full.threadCount == 0) {
        full.threadCount = pvtGetCoreCount();
    }
    pvtContext* made = full.allocator.allocate(full.allocator.user, sizeof(pvtContext));
    if (made == NULL) {
        return PVT_OUT_OF_MEMORY;
    }
    memset(made, 0, sizeof *made);
    made->def = full;
    pthread_mutex_init(&made->messageLock, NULL);
    *context = made;
    return PVT_OK;
}

void pvtDestroyContext(pvtContext* context)
{
    if (context == NULL) {
        return;
    }
    pvtDestroyTaskPool(context->pool);
    pthread_mutex_destroy(&context->messageLock);
    context->def.allocator.release(context->def.allocator.user, context);
}

const char* pvtContext_GetMessage(const pvtContext* context)
{
    return context->message;
}

pvtStatus pvtContext_GetStatus(const pvtContext* context)
{
    return atomic_load(&context->status);
}

size_t pvtContext_GetHeldBytes(const pvtContext* context)
{
    return atomic_load(&context->held);
}

size_t pvtContext_GetPeakBytes(const pvtContext* context)
{
    return atomic_load(&context->peak);
}

int pvtContext_GetThreadCount(const pvtContext* context)
{
    return context->def.threadCount;
}

const char* pvtGetVersion(void)
{
    return PVT_VERSION_TEXT;
}

const char* pvtGetStatusName(pvtStatus status)
{
    switch (status) {
    case PVT_OK:
        return "done";
    case PVT_INVALID_ARGUMENT:
        return "invalid argument";
    case PVT_INVALID_INPUT:
        return "invalid input";
    case PVT_UNSUPPORTED:
        return "unsupported";
    case PVT_OUTPUT_FAILED:
        return "output failed";
    case PVT_NOTHING_INSIDE:
        return "nothing inside";
    case PVT_LIMIT:
        return "limit reached";
    case PVT_OUT_OF_MEMORY:
        return "out of memory";
    case PVT_CANCELLED:
        return "cancelled";
    }
    return "unknown status";
}

pvtStatus pvtFail(pvtContext* context, pvtStatus status, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    pthread_mutex_lock(&context->messageLock);
    (void)vsnprintf(context->message, MESSAGE_SIZE, format, arguments);
    atomic_store(&context->status, status);
    pthread_mutex_unlock(&context->messageLock);
    va_end(arguments);
    return status;
}

static void LogText(pvtContext* context, pvtLogLevel level, const char* format, va_list arguments)
{
    if (context->def.log == NULL) {
        return;
    }
    char text[MESSAGE_SIZE];
    const bool isScoped = context->scope[0] != '\0';
    const int used = snprintf(text, sizeof text, "%s%s", context->scope, isScoped ? ": " : "");
    (void)vsnprintf(text + used, sizeof text - (size_t)used, format, arguments);
    context->def.log(level, text, context->def.user);
}

void pvtLog(pvtContext* context, pvtLogLevel level, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    LogText(context, level, format, arguments);
    va_end(arguments);
}

// Texts are known by where they lie. Without a scope nothing is kept.
static bool IsToldBefore(pvtContext* context, const char* format)
{
    for (int i = 0; i < context->toldCount; ++i) {
        if (context->told[i] == format) {
            return true;
        }
    }
    if (context->scope[0] != '\0' && context->toldCount < MOST_TOLD) {
        context->told[context->toldCount++] = format;
    }
    return false;
}

void pvtWarnOnce(pvtContext* context, const char* format, ...)
{
    const pvtLogLevel level = IsToldBefore(context, format) ? PVT_LOG_INFO : PVT_LOG_WARNING;
    va_list arguments;
    va_start(arguments, format);
    LogText(context, level, format, arguments);
    va_end(arguments);
}

// Reserves `size` bytes of the limit; false when they do not fit.
static bool ReserveBytes(pvtContext* context, size_t size)
{
    const size_t before = atomic_fetch_add(&context->held, size);
    const size_t limit = context->def.memoryLimit;
    if (limit != 0 && (size > limit || before > limit - size)) {
        atomic_fetch_sub(&context->held, size);
        return false;
    }
    size_t peak = atomic_load(&context->peak);
    while (peak < before + size &&
           !atomic_compare_exchange_weak(&context->peak, &peak, before + size)) {
    }
    return true;
}

size_t pvtGetFreeBytes(const pvtContext* context)
{
    const size_t limit = context->def.memoryLimit;
    const size_t held = atomic_load(&context->held);
    return limit == 0 ? SIZE_MAX : held < limit ? limit - held : 0;
}

pvtStatus pvtCheckMemory(pvtContext* context, size_t bytes, const char* purpose)
{
    const size_t left = pvtGetFreeBytes(context);
    if (bytes <= left) {
        return PVT_OK;
    }
    return pvtFail(
        context, PVT_LIMIT,
        "%s needs %.1f MB, but only %.1f MB of the memory limit are left; raise the limit or "
        "lower the resolution",
        purpose, (double)bytes / 1e6, (double)left / 1e6);
}

void* pvtAllocateUnset(pvtContext* context, size_t count, size_t size)
{
    const size_t most = SIZE_MAX - sizeof(BlockHeader) - ALIGNMENT;
    if (size != 0 && count > most / size) {
        pvtFail(context, PVT_LIMIT, "%zu elements of %zu bytes are more than memory can address",
                count, size);
        return NULL;
    }
    const size_t bytes = count * size;
    const size_t whole = bytes + sizeof(BlockHeader) + ALIGNMENT;
    if (pvtCheckMemory(context, whole, "the next step") != PVT_OK) {
        return NULL;
    }
    if (!ReserveBytes(context, whole)) {
        pvtFail(context, PVT_LIMIT, "the memory limit is reached");
        return NULL;
    }
    void* raw = context->def.allocator.allocate(context->def.allocator.user, whole);
    if (raw == NULL) {
        atomic_fetch_sub(&context->held, whole);
        pvtFail(context, PVT_OUT_OF_MEMORY, "the allocator refused %zu bytes", whole);
        return NULL;
    }
    const uintptr_t first = (uintptr_t)raw + sizeof(BlockHeader);
    const uintptr_t aligned = (first + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    BlockHeader* header = (BlockHeader*)aligned - 1;
    *header = (BlockHeader){raw, whole};
    return (void*)aligned;
}

void* pvtAllocate(pvtContext* context, size_t count, size_t size)
{
    void* memory = pvtAllocateUnset(context, count, size);
    if (memory != NULL) {
        memset(memory, 0, count * size);
    }
    return memory;
}

void* pvtReallocate(pvtContext* context, void* memory, size_t count, size_t size)
{
    if (memory == NULL) {
        return pvtAllocate(context, count, size);
    }
    char* grown = pvtAllocateUnset(context, count, size);
    if (grown == NULL) {
        return NULL;
    }
    const BlockHeader* header = (const BlockHeader*)memory - 1;
    const size_t old = header->size - sizeof(BlockHeader) - ALIGNMENT;
    const size_t whole = count * size;
    const size_t kept = old < whole ? old : whole;
    memcpy(grown, memory, kept);
    memset(grown + kept, 0, whole - kept);
    pvtRelease(context, memory);
    return grown;
}

void pvtRelease(pvtContext* context, void* memory)
{
    if (memory == NULL) {
        return;
    }
    const BlockHeader header = ((const BlockHeader*)memory)[-1];
    atomic_fetch_sub(&context->held, header.size);
    context->def.allocator.release(context->def.allocator.user, header.raw);
}

void pvtSetStageScope(pvtContext* context, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(context->scope, SCOPE_SIZE, format, arguments);
    va_end(arguments);
    if (context->scope[0] == '\0') {
        context->toldCount = 0;
    }
}

void pvtBeginStage(pvtContext* context, const char* name)
{
    const bool isScoped = context->scope[0] != '\0';
    (void)snprintf(context->stage, STAGE_SIZE, "%s%s%s", context->scope, isScoped ? ": " : "",
                   name);
    context->reported = -1.0;
    pvtReportProgress(context, 0.0);
}

void pvtReportProgress(pvtContext* context, double fraction)
{
    // A hundred reports a stage are enough for any bar, and one that it is done.
    const bool isDone = fraction >= 1.0 && context->reported < 1.0;
    if (context->def.progress != NULL && (isDone || fraction >= context->reported + 0.01)) {
        context->reported = fraction;
        context->def.progress(context->stage, fraction, context->def.user);
    }
}

bool pvtIsCancelled(pvtContext* context)
{
    return context->def.isCancelled != NULL && context->def.isCancelled(context->def.user);
}

pvtStatus pvtFailCancelled(pvtContext* context)
{
    return pvtFail(context, PVT_CANCELLED, "cancelled");
}

void pvtParallelFor(pvtContext* context, pvtTaskFcn* task, size_t count, size_t minRange,
                    void* taskData)
{
    if (count == 0) {
        return;
    }
    if (context->def.parallelFor != NULL) {
        context->def.parallelFor(task, count, minRange, taskData, context->def.user);
        return;
    }
    if (context->def.threadCount > 1 && count > minRange && context->pool == NULL) {
        context->pool = pvtCreateTaskPool(context->def.threadCount);
    }
    if (context->pool == NULL) {
        task(0, count, 0, taskData);
        return;
    }
    pvtTaskPool_Run(context->pool, task, count, minRange, taskData);
}

double pvtGetSeconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}
