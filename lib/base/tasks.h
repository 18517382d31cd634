// SPDX-License-Identifier: MIT
// The default pool behind pvtParallelFor.
#ifndef PVT_BASE_TASKS_H
#define PVT_BASE_TASKS_H

#include <paravent/base.h>
#include <pthread.h>

enum { PVT_MAX_THREADS = 64 };

typedef struct pvtTaskPool pvtTaskPool;

/// The cores that this process may run on, 1 to PVT_MAX_THREADS.
int pvtGetCoreCount(void);
/// Starts threadCount − 1 threads; the caller of pvtTaskPool_Run is the first worker. Null when
/// threads cannot be had: then run the loop on the calling thread. The pool is outside the
/// context's accounted memory.
pvtTaskPool* pvtCreateTaskPool(int threadCount);
void pvtDestroyTaskPool(pvtTaskPool* pool);
void pvtTaskPool_Run(pvtTaskPool* pool, pvtTaskFcn* task, size_t count, size_t minRange,
                     void* taskData);

#endif
