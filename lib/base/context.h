// SPDX-License-Identifier: MIT
// What the library's own files use of the context.
#ifndef PVT_BASE_CONTEXT_H
#define PVT_BASE_CONTEXT_H

#include <paravent/base.h>

/// Keeps the text for pvtContext_GetMessage and returns `status`, so that a failure is one line:
/// `return pvtFail(context, PVT_INVALID_ARGUMENT, "budget is %d; it must be at least 1", n);`
pvtStatus pvtFail(pvtContext* context, pvtStatus status, const char* format, ...)
    __attribute__((format(printf, 3, 4)));

void pvtLog(pvtContext* context, pvtLogLevel level, const char* format, ...)
    __attribute__((format(printf, 3, 4)));

/// A warning about the mesh, which each level of a ladder would repeat: from one scope to the next
/// the same text is a warning the first time and information after that. On the calling thread of
/// a stage only.
void pvtWarnOnce(pvtContext* context, const char* format, ...)
    __attribute__((format(printf, 2, 3)));

/// Zeroed, aligned to 64 bytes. Null after pvtFail with PVT_LIMIT or PVT_OUT_OF_MEMORY: return
/// pvtContext_GetStatus. count × size may not overflow: that is PVT_LIMIT. A count of 0 gives a
/// block that may be freed. Safe on any thread.
void* pvtAllocate(pvtContext* context, size_t count, size_t size);
/// The same, not zeroed: for what is written as a whole before it is read, by several workers, so
/// that each of them gets its own pages.
void* pvtAllocateUnset(pvtContext* context, size_t count, size_t size);
/// Grows or shrinks a block to count × size bytes; new bytes are zeroed. On failure the old block
/// stays as it was, and null is returned.
void* pvtReallocate(pvtContext* context, void* memory, size_t count, size_t size);
/// Null is fine.
void pvtRelease(pvtContext* context, void* memory);
/// The status given to the last pvtFail.
pvtStatus pvtContext_GetStatus(const pvtContext* context);
/// PVT_LIMIT, by pvtFail, when `bytes` more would not fit in the memory limit; else PVT_OK.
pvtStatus pvtCheckMemory(pvtContext* context, size_t bytes, const char* purpose);
/// Bytes that may still be allocated; SIZE_MAX without a limit.
size_t pvtGetFreeBytes(const pvtContext* context);

/// What the stages to come belong to, such as "LOD2", which goes in front of their names and
/// of what is logged;
/// "" for nothing. Of less than 24 bytes.
void pvtSetStageScope(pvtContext* context, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
/// Names the stage that pvtReportProgress speaks of.
void pvtBeginStage(pvtContext* context, const char* name);
/// On the calling thread of a stage only.
void pvtReportProgress(pvtContext* context, double fraction);
/// Cheap enough for every row of work; safe on any thread.
bool pvtIsCancelled(pvtContext* context);
/// pvtFail with PVT_CANCELLED.
pvtStatus pvtFailCancelled(pvtContext* context);

/// Runs `task` over 0 to count − 1 in pieces of at least minRange, on all threads.
void pvtParallelFor(pvtContext* context, pvtTaskFcn* task, size_t count, size_t minRange,
                    void* taskData);

/// Seconds on a clock that only runs forwards.
double pvtGetSeconds(void);

#endif
