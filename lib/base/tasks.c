// SPDX-License-Identifier: MIT
// A small pool: one loop at a time, cut into pieces that the workers fetch from a counter. Loops
// often follow each other within microseconds, so that who has to wait looks for a while whether it
// still has to before it sleeps: to be woken takes longer than most loops.
#include "tasks.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { LOOKS = 4000 }; // before sleep: a tenth of a millisecond or so

struct pvtTaskPool {
    pthread_t threads[PVT_MAX_THREADS];
    int workerCount; // the caller included
    int looks;       // 0 when there are more workers than cores
    pthread_mutex_t lock;
    pthread_cond_t started, finished;
    atomic_uint_fast64_t generation; // counts loops, so that a worker knows a new one; and the end
    atomic_int busy;                 // workers that have not finished this generation
    bool stopping;                   // as of this generation
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

static void Pause(void)
{
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

// Returns the next generation.
static uint64_t AwaitStart(pvtTaskPool* pool, uint64_t seen)
{
    for (int i = 0; i < pool->looks && atomic_load(&pool->generation) == seen; ++i) {
        Pause();
    }
    if (atomic_load(&pool->generation) == seen) {
        pthread_mutex_lock(&pool->lock);
        while (atomic_load(&pool->generation) == seen) {
            pthread_cond_wait(&pool->started, &pool->lock);
        }
        pthread_mutex_unlock(&pool->lock);
    }
    return seen + 1;
}

static void AwaitFinish(pvtTaskPool* pool)
{
    for (int i = 0; i < pool->looks && atomic_load(&pool->busy) > 0; ++i) {
        Pause();
    }
    if (atomic_load(&pool->busy) > 0) {
        pthread_mutex_lock(&pool->lock);
        while (atomic_load(&pool->busy) > 0) {
            pthread_cond_wait(&pool->finished, &pool->lock);
        }
        pthread_mutex_unlock(&pool->lock);
    }
}

// Who sleeps holds the lock until it does, and so hears of it.
static void StartGeneration(pvtTaskPool* pool)
{
    pthread_mutex_lock(&pool->lock);
    atomic_fetch_add(&pool->generation, 1);
    pthread_cond_broadcast(&pool->started);
    pthread_mutex_unlock(&pool->lock);
}

static void* WorkerMain(void* argument)
{
    WorkerStart* start = argument;
    pvtTaskPool* pool = start->pool;
    const int worker = start->worker;
    free(start);
    for (uint64_t seen = AwaitStart(pool, 0); !pool->stopping; seen = AwaitStart(pool, seen)) {
        RunPieces(pool, worker);
        if (atomic_fetch_sub(&pool->busy, 1) == 1) {
            pthread_mutex_lock(&pool->lock);
            pthread_cond_signal(&pool->finished);
            pthread_mutex_unlock(&pool->lock);
        }
    }
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
    pool->looks = threadCount <= pvtGetCoreCount() ? LOOKS : 0;
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
    pool->stopping = true;
    StartGeneration(pool);
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
    pool->task = task;
    pool->taskData = taskData;
    pool->count = count;
    pool->piece = even > minRange ? even : minRange > 0 ? minRange : 1;
    atomic_store(&pool->next, 0);
    atomic_store(&pool->busy, pool->workerCount - 1);
    StartGeneration(pool);
    RunPieces(pool, 0);
    AwaitFinish(pool);
}
