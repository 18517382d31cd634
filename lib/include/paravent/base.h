// SPDX-License-Identifier: MIT
// Status, context, allocation, progress and tasks: what every stage is handed.
#ifndef PARAVENT_BASE_H
#define PARAVENT_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define PVT_API
#else
#define PVT_API __attribute__((visibility("default")))
#endif

/// What a call came to. Anything but PVT_OK leaves a text for pvtContext_GetMessage, and leaves
/// the call's output empty, which is safe to free.
typedef enum pvtStatus {
    PVT_OK = 0,
    PVT_INVALID_ARGUMENT, ///< an option is out of its range
    PVT_INVALID_INPUT,    ///< a file cannot be read, or what it says is not valid
    PVT_UNSUPPORTED,      ///< a backend, a format or a feature is missing here
    PVT_OUTPUT_FAILED,    ///< a file cannot be written
    PVT_NOTHING_INSIDE,   ///< the mesh has no inside at this resolution
    PVT_LIMIT,            ///< the memory limit, or a size limit of the format
    PVT_OUT_OF_MEMORY,    ///< the allocator returned null
    PVT_CANCELLED,        ///< the caller asked to stop
} pvtStatus;

/// Three doubles: a point [wu] or a direction. World units unless the field says otherwise.
typedef struct pvtVec3 {
    double x, y, z;
} pvtVec3;

/// An axis-aligned box [wu]. Empty when lower.x > upper.x.
typedef struct pvtBox3 {
    pvtVec3 lower, upper;
} pvtBox3;

/// Memory hooks. `allocate` returns null when it cannot serve the request. Both may be called
/// from several threads at once.
typedef struct pvtAllocator {
    void* (*allocate)(void* user, size_t size);
    void (*release)(void* user, void* memory);
    void* user;
} pvtAllocator;

/// A piece of a loop: indices begin to end − 1. `worker` lies in 0 to threadCount − 1 and no two
/// pieces run at once with the same worker.
typedef void pvtTaskFcn(size_t begin, size_t end, int worker, void* taskData);

/// Runs `task` over 0 to count − 1 in pieces of at least minRange, and returns when all are done.
typedef void pvtParallelForFcn(pvtTaskFcn* task, size_t count, size_t minRange, void* taskData,
                               void* user);

typedef enum pvtLogLevel { PVT_LOG_WARNING, PVT_LOG_INFO, PVT_LOG_DEBUG } pvtLogLevel;

/// A line for people, without a line feed. Warnings are part of the result: keep them.
typedef void pvtLogFcn(pvtLogLevel level, const char* text, void* user);

/// `fraction` runs from 0 to 1 within the stage named. Called on the thread that called the stage.
typedef void pvtProgressFcn(const char* stage, double fraction, void* user);

/// Asked often, from any thread; return true to stop within 100 ms.
typedef bool pvtCancelFcn(void* user);

/// Everything a context can be given. Use pvtDefaultContextDef, then change fields.
typedef struct pvtContextDef {
    pvtAllocator allocator;         ///< null functions: malloc and free
    size_t memoryLimit;             ///< [bytes] most that may be held at once; 0: no limit
    int threadCount;                ///< 1 to 64; 0: one a core. Results never depend on it
    pvtParallelForFcn* parallelFor; ///< null: a pool of the context's own
    pvtLogFcn* log;                 ///< null: nothing is logged
    pvtProgressFcn* progress;       ///< null: not reported
    pvtCancelFcn* isCancelled;      ///< null: never
    void* user;                     ///< handed to parallelFor, log, progress and isCancelled
} pvtContextDef;

/// Holds the hooks, the pool and the last error's text. Not shared between threads: a context
/// serves one call at a time.
typedef struct pvtContext pvtContext;

PVT_API pvtContextDef pvtDefaultContextDef(void);

/// Null `def` means the defaults. *context is null on failure (PVT_INVALID_ARGUMENT or
/// PVT_OUT_OF_MEMORY).
PVT_API pvtStatus pvtCreateContext(const pvtContextDef* def, pvtContext** context);
PVT_API void pvtDestroyContext(pvtContext* context);

/// The text of the last failure: what, where, why and the remedy. Never null.
PVT_API const char* pvtContext_GetMessage(const pvtContext* context);

/// Bytes held now and at most so far through this context.
PVT_API size_t pvtContext_GetHeldBytes(const pvtContext* context);
PVT_API size_t pvtContext_GetPeakBytes(const pvtContext* context);
PVT_API int pvtContext_GetThreadCount(const pvtContext* context);

/// The library's version, "MAJOR.MINOR.PATCH".
PVT_API const char* pvtGetVersion(void);

/// A status in words, for logs: "out of memory".
PVT_API const char* pvtGetStatusName(pvtStatus status);

#ifdef __cplusplus
}
#endif
#endif
