// SPDX-License-Identifier: MIT
#include "crew.h"

#include "base/context.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { NAME_SIZE = 128, MAX_NOTES = 8, MAX_TOLD = 12 };

// What became of a piece.
typedef struct Piece {
    pvtStatus status;
    char* message; // of a failure
    char* notes[MAX_NOTES];
    int noteCount;
} Piece;

typedef struct Crew {
    pvtContext* parent;
    const pvtCrewWork* work;
    Piece* pieces;
    bool isParallel;
    atomic_size_t next, done;
    atomic_bool hasFailed;
} Crew;

// The hooks of a piece's own context.
typedef struct Worker {
    Crew* crew;
    Piece* piece;
    bool reports;             // on the thread that called the whole
    _Atomic pvtStatus denied; // why the parent's memory was refused
    atomic_bool hasLost;      // a warning, for lack of memory
} Worker;

static void* Allocate(void* user, size_t size)
{
    Worker* worker = user;
    void* memory = pvtAllocateUnset(worker->crew->parent, 1, size);
    if (memory == NULL) {
        atomic_store(&worker->denied, pvtContext_GetStatus(worker->crew->parent));
    }
    return memory;
}

static void Release(void* user, void* memory)
{
    const Worker* worker = user;
    pvtRelease(worker->crew->parent, memory);
}

static bool IsCancelled(void* user)
{
    const Worker* worker = user;
    return atomic_load(&worker->crew->hasFailed) || pvtIsCancelled(worker->crew->parent);
}

static void ShareThreads(pvtTaskFcn* task, size_t count, size_t minRange, void* taskData,
                         void* user)
{
    const Worker* worker = user;
    pvtParallelFor(worker->crew->parent, task, count, minRange, taskData);
}

static char* CopyText(pvtContext* context, const char* text)
{
    const size_t size = strlen(text) + 1;
    char* copy = pvtAllocate(context, size, 1);
    if (copy != NULL) {
        memcpy(copy, text, size);
    }
    return copy;
}

static void TakeLog(pvtLogLevel level, const char* text, void* user)
{
    Worker* worker = user;
    Piece* piece = worker->piece;
    if (level != PVT_LOG_WARNING || !worker->crew->work->keepsWarnings ||
        piece->noteCount == MAX_NOTES) {
        return;
    }
    char* note = CopyText(worker->crew->parent, text);
    if (note == NULL) {
        atomic_store(&worker->hasLost, true);
        return;
    }
    piece->notes[piece->noteCount++] = note;
}

// How far a build is when a stage of it begins and ends: about the time that they take.
static double GetBuildFraction(const char* stage, double fraction)
{
    static const struct {
        const char* stage;
        double begin, end;
    } stages[] = {{"sections", 0.05, 0.15},
                  {"chains", 0.15, 0.25},
                  {"select", 0.25, 0.4},
                  {"refine", 0.4, 0.95},
                  {"check", 0.95, 1.0}};
    for (size_t i = 0; i < sizeof stages / sizeof *stages; ++i) {
        if (strcmp(stage, stages[i].stage) == 0) {
            return stages[i].begin + (stages[i].end - stages[i].begin) * fraction;
        }
    }
    return 0.0;
}

static void TakeProgress(const char* stage, double fraction, void* user)
{
    const Worker* worker = user;
    const Crew* crew = worker->crew;
    if (worker->reports) {
        const double done = (double)atomic_load(&crew->done) + GetBuildFraction(stage, fraction);
        pvtReportProgress(crew->parent, done / (double)crew->work->count);
    }
}

static pvtStatus CreatePieceContext(Worker* worker, pvtContext** context)
{
    const Crew* crew = worker->crew;
    const size_t free = pvtGetFreeBytes(crew->parent);
    pvtContextDef def = pvtDefaultContextDef();
    def.allocator = (pvtAllocator){Allocate, Release, worker};
    def.memoryLimit = free == SIZE_MAX ? 0 : free > 0 ? free : 1;
    def.threadCount = crew->isParallel ? 1 : pvtContext_GetThreadCount(crew->parent);
    def.parallelFor = crew->isParallel ? NULL : ShareThreads;
    def.log = TakeLog;
    def.progress = TakeProgress;
    def.isCancelled = IsCancelled;
    def.user = worker;
    return pvtCreateContext(&def, context);
}

static void FreePiece(pvtContext* parent, Piece* piece)
{
    pvtRelease(parent, piece->message);
    for (int i = 0; i < piece->noteCount; ++i) {
        pvtRelease(parent, piece->notes[i]);
    }
    *piece = (Piece){0};
}

static void RunPiece(Crew* crew, size_t index, bool reports)
{
    Piece* piece = &crew->pieces[index];
    Worker worker = {.crew = crew, .piece = piece, .reports = reports};
    atomic_init(&worker.denied, PVT_OK);
    atomic_init(&worker.hasLost, false);
    pvtContext* context = NULL;
    FreePiece(crew->parent, piece);
    pvtStatus status = CreatePieceContext(&worker, &context);
    if (status == PVT_OK) {
        status = crew->work->run(context, index, crew->work->user);
    }
    if (status == PVT_OK && atomic_load(&worker.hasLost)) {
        status = pvtContext_GetStatus(crew->parent);
    }
    if (status != PVT_OK) {
        const pvtStatus denied = atomic_load(&worker.denied);
        const bool isDenied = status == PVT_OUT_OF_MEMORY && denied != PVT_OK;
        const bool isParents =
            isDenied || context == NULL || pvtContext_GetMessage(context)[0] == '\0';
        piece->message =
            CopyText(crew->parent, pvtContext_GetMessage(isParents ? crew->parent : context));
        status = isDenied ? denied : status;
    }
    piece->status = status;
    pvtDestroyContext(context);
}

// Whether the piece may do better when no other one holds memory.
static bool IsWorthAnotherTry(const Crew* crew, const Piece* piece)
{
    return crew->isParallel && piece->status == PVT_LIMIT;
}

static void FetchPieces(size_t begin, size_t end, int worker, void* taskData)
{
    Crew* crew = taskData;
    (void)begin;
    (void)end;
    for (;;) {
        const size_t index = atomic_fetch_add(&crew->next, 1);
        if (index >= crew->work->count || atomic_load(&crew->hasFailed)) {
            return;
        }
        RunPiece(crew, index, worker == 0);
        const Piece* piece = &crew->pieces[index];
        if (piece->status != PVT_OK && !IsWorthAnotherTry(crew, piece)) {
            atomic_store(&crew->hasFailed, true);
        }
        const size_t done = atomic_fetch_add(&crew->done, 1) + 1;
        if (worker == 0) {
            pvtReportProgress(crew->parent, (double)done / (double)crew->work->count);
        }
    }
}

static void RetryPieces(Crew* crew)
{
    crew->isParallel = false;
    for (size_t i = 0; i < crew->work->count && !atomic_load(&crew->hasFailed); ++i) {
        if (crew->pieces[i].status == PVT_LIMIT) {
            RunPiece(crew, i, true);
            atomic_store(&crew->hasFailed, crew->pieces[i].status != PVT_OK);
        }
    }
}

// The first failure that is not the stop which another one asked for.
static pvtStatus FindFailure(Crew* crew)
{
    const pvtCrewWork* work = crew->work;
    for (size_t i = 0; i < work->count; ++i) {
        const Piece* piece = &crew->pieces[i];
        if (piece->status == PVT_OK || piece->status == PVT_CANCELLED) {
            continue;
        }
        char name[NAME_SIZE];
        work->name(i, name, sizeof name, work->user);
        return pvtFail(crew->parent, piece->status, "%s: %s", name,
                       piece->message != NULL ? piece->message : pvtGetStatusName(piece->status));
    }
    return atomic_load(&crew->hasFailed) || pvtIsCancelled(crew->parent)
               ? pvtFailCancelled(crew->parent)
               : PVT_OK;
}

static void PassNotesOn(const Crew* crew)
{
    const pvtCrewWork* work = crew->work;
    size_t told = 0;
    size_t untold = 0;
    for (size_t i = 0; i < work->count; ++i) {
        for (int note = 0; note < crew->pieces[i].noteCount; ++note) {
            char name[NAME_SIZE];
            if (told == MAX_TOLD) {
                ++untold;
                continue;
            }
            work->name(i, name, sizeof name, work->user);
            pvtLog(crew->parent, PVT_LOG_WARNING, "%s: %s", name, crew->pieces[i].notes[note]);
            ++told;
        }
    }
    if (untold > 0) {
        pvtLog(crew->parent, PVT_LOG_WARNING, "and %zu more warnings like these", untold);
    }
}

int pvtGetCrewSize(const pvtContext* context, size_t count, bool isAlone)
{
    const int threads = pvtContext_GetThreadCount(context);
    // With fewer, threads would idle at the end for longer than they save.
    return !isAlone && count >= 2 * (size_t)threads ? threads : 1;
}

pvtStatus pvtRunCrew(pvtContext* context, const pvtCrewWork* work)
{
    Crew crew = {.parent = context, .work = work};
    crew.pieces = pvtAllocate(context, work->count, sizeof *crew.pieces);
    if (crew.pieces == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtBeginStage(context, work->stage);
    const int size = pvtGetCrewSize(context, work->count, work->isAlone);
    crew.isParallel = size > 1;
    if (crew.isParallel) {
        pvtParallelFor(context, FetchPieces, (size_t)size, 1, &crew);
    } else {
        FetchPieces(0, 1, 0, &crew);
    }
    if (crew.isParallel) {
        RetryPieces(&crew);
    }
    const pvtStatus status = FindFailure(&crew);
    if (status == PVT_OK) {
        pvtReportProgress(context, 1.0);
        PassNotesOn(&crew);
    }
    for (size_t i = 0; i < work->count; ++i) {
        FreePiece(context, &crew.pieces[i]);
    }
    pvtRelease(context, crew.pieces);
    return status;
}
