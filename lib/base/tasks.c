// SPDX-License-Identifier: MIT
// A small pool: one loop at a time, cut into pieces that the workers fetch from a counter.
#include "tasks.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

struct pvtTaskPool {
    pthread_t threads[PVT_MAX_THREADS];
    int workerCount; // the caller included
    pthread_mutex_t lock;
    pthread_cond_t started, finished;
    uint64_t generation; // counts loops, so that a worker knows a new one
    int busy;            // workers that have not finished this generation
    bool stopping;
    pvtTaskFcn* task;
    void* taskData;
    size_t count, piece;
    atomic_size_t next;
};

typedef struct WorkerStart {
    pvtTaskPool* pool;
    int worker;
} WorkerStart;

int pvtGetCoreCount(void)
{
    cpu_set_t set;
    CPU_ZERO(&set);
    if (sched_getaffinity(0, sizeof set, &set) != 0) {
        return 1;
    }
    const int count = CPU_COUNT(&set);
    return count < 1 ? 1 : count > PVT_MAX_THREADS ? PVT_MAX_THREADS : count;
}

static void RunPieces(pvtTaskPool* pool, int worker)
{
    for (;;) {
        const size_t begin = atomic_fetch_add(&pool->next, pool->piece);
        if (begin >= pool->count) {
            return;
        }
        const size_t end = pool->count - begin < pool->piece ? pool->count : begin + pool->piece;
        pool->task(begin, end, worker, pool->taskData);
    }
}

static void* WorkerMain(void* argument)
{
    WorkerStart* start = argument;
    pvtTaskPool* pool = start->pool;
    const int worker = start->worker;
    free(start);
    uint64_t seen = 0;
    pthread_mutex_lock(&pool->lock);
    for (;;) {
        while (!pool->stopping && pool->generation == seen) {
            pthread_cond_wait(&pool->started, &pool->lock);
        }
        if (pool->stopping) {
            break;
        }
        seen = pool->generation;
        pthread_mutex_unlock(&pool->lock);
        RunPieces(pool, worker);
        pthread_mutex_lock(&pool->lock);
        if (--pool->busy == 0) {
            pthread_cond_signal(&pool->finished);
        }
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

static bool StartWorker(pvtTaskPool* pool, int worker)
{
    WorkerStart* start = malloc(sizeof *start);
    if (start == NULL) {
        return false;
    }
    *start = (WorkerStart){pool, worker};
    if (pthread_create(&pool->threads[worker], NULL, WorkerMain, start) != 0) {
        free(start);
        return false;
    }
    return true;
}

pvtTaskPool* pvtCreateTaskPool(int threadCount)
{
    pvtTaskPool* pool = calloc(1, sizeof *pool);
    if (pool == NULL) {
        return NULL;
    }
    pthread_mutex_init(&pool->lock, NULL);
    pthread_cond_init(&pool->started, NULL);
    pthread_cond_init(&pool->finished, NULL);
    pool->workerCount = 1;
    while (pool->workerCount < threadCount && StartWorker(pool, pool->workerCount)) {
        ++pool->workerCount;
    }
    return pool;
}

void pvtDestroyTaskPool(pvtTaskPool* pool)
{
    if (pool == NULL) {
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->stopping = true;
    pthread_cond_broadcast(&pool->started);
    pthread_mutex_unlock(&pool->lock);
    for (int worker = 1; worker < pool->workerCount; ++worker) {
        pthread_join(pool->threads[worker], NULL);
    }
    pthread_cond_destroy(&pool->finished);
    pthread_cond_destroy(&pool->started);
    pthread_mutex_destroy(&pool->lock);
    free(pool);
}

void pvtTaskPool_Run(pvtTaskPool* pool, pvtTaskFcn* task, size_t count, size_t minRange,
                     void* taskData)
{
    // Eight pieces a worker even out uneven work; fewer when they would fall below minRange.
    const size_t even = count / ((size_t)pool->workerCount * 8) + 1;
    pthread_mutex_lock(&pool->lock);
    pool->task = task;
    pool->taskData = taskData;
    pool->count = count;
    pool->piece = even > minRange ? even : minRange > 0 ? minRange : 1;
    atomic_store(&pool->next, 0);
    pool->busy = pool->workerCount - 1;
    ++pool->generation;
    pthread_cond_broadcast(&pool->started);
    pthread_mutex_unlock(&pool->lock);

    RunPieces(pool, 0);

    pthread_mutex_lock(&pool->lock);
    while (pool->busy > 0) {
        pthread_cond_wait(&pool->finished, &pool->lock);
    }
    pthread_mutex_unlock(&pool->lock);
}
