// SPDX-License-Identifier: MIT
#include "import_process.h"

#include "companion.h"

#include "base/context.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static const char kProgram[] = "paravent-import";

enum {
    POLL_MILLISECONDS = 20,
    FIRST_FREE = 10, // descriptors from here up are out of the way of those that the child gets
    MIN_MEMORY = 512 << 20, // what a process with assimp takes in any case, with room for a model
    MEMORY_PER_BYTE = 64,   // of the file: no format that assimp reads here needs more
    SECONDS_AT_LEAST = 10,
};

// The parent's ends of what it shares with the child. −1: closed.
typedef struct Pipes {
    int input, output, alive, childAlive;
} Pipes;

static void CloseIfOpen(int* file)
{
    if (*file >= 0) {
        close(*file);
    }
    *file = -1;
}

static void ClosePipes(Pipes* pipes)
{
    CloseIfOpen(&pipes->input);
    CloseIfOpen(&pipes->output);
    CloseIfOpen(&pipes->alive);
    CloseIfOpen(&pipes->childAlive);
}

// Moves a descriptor out of the range that the child's numbers lie in; −1 stays −1.
static int MoveUp(int file)
{
    const int moved = file >= 0 ? fcntl(file, F_DUPFD_CLOEXEC, FIRST_FREE) : -1;
    if (file >= 0) {
        close(file);
    }
    return moved;
}

static bool OpenPipes(const pvtLoadJob* job, Pipes* pipes)
{
    int ends[2] = {-1, -1};
    *pipes = (Pipes){-1, -1, -1, -1};
    if (pipe2(ends, O_CLOEXEC) != 0) {
        return false;
    }
    pipes->alive = MoveUp(ends[0]);
    pipes->childAlive = MoveUp(ends[1]);
    pipes->output = MoveUp(memfd_create("paravent-import", MFD_CLOEXEC));
    pipes->input = fcntl(job->file, F_DUPFD_CLOEXEC, FIRST_FREE);
    return pipes->alive >= 0 && pipes->childAlive >= 0 && pipes->output >= 0 && pipes->input >= 0;
}

// Nothing but the three descriptors reaches the child.
static int PrepareFiles(const Pipes* pipes, posix_spawn_file_actions_t* actions)
{
    int error = posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
    error =
        error != 0 ? error : posix_spawn_file_actions_addopen(actions, 1, "/dev/null", O_WRONLY, 0);
    error = error != 0 ? error : posix_spawn_file_actions_adddup2(actions, 1, 2);
    error = error != 0 ? error
                       : posix_spawn_file_actions_adddup2(actions, pipes->input, PVT_IMPORT_INPUT);
    error = error != 0
                ? error
                : posix_spawn_file_actions_adddup2(actions, pipes->output, PVT_IMPORT_OUTPUT);
    error = error != 0
                ? error
                : posix_spawn_file_actions_adddup2(actions, pipes->childAlive, PVT_IMPORT_ALIVE);
    return error != 0 ? error
                      : posix_spawn_file_actions_addclosefrom_np(actions, PVT_IMPORT_ALIVE + 1);
}

// The signals that this process ignores or blocks are not the child's business.
static int PrepareSignals(posix_spawnattr_t* attributes)
{
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    int error =
        posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    error = error != 0 ? error : posix_spawnattr_setsigdefault(attributes, &all);
    return error != 0 ? error : posix_spawnattr_setsigmask(attributes, &none);
}

static size_t GetMemoryBudget(const pvtLoadJob* job)
{
    const size_t wanted = MIN_MEMORY + (size_t)MEMORY_PER_BYTE * job->size;
    const size_t left = pvtGetFreeBytes(job->context);
    return left < SIZE_MAX - MIN_MEMORY && wanted > left + MIN_MEMORY ? left + MIN_MEMORY : wanted;
}

// 0, or an errno.
static int Spawn(const pvtLoadJob* job, const char* program, const Pipes* pipes, pid_t* child)
{
    char memory[32], seconds[32];
    (void)snprintf(memory, sizeof memory, "%zu", GetMemoryBudget(job));
    (void)snprintf(seconds, sizeof seconds, "%zu", SECONDS_AT_LEAST + 2 * (job->size >> 20));
    char name[] = "paravent-import";
    char ending[8];
    const char* dot = strrchr(job->path, '.');
    (void)snprintf(ending, sizeof ending, "%s", dot != NULL ? dot + 1 : "");
    char* const arguments[] = {name, ending, memory, seconds, NULL};

    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    int error = posix_spawn_file_actions_init(&actions);
    if (error != 0) {
        return error;
    }
    error = posix_spawnattr_init(&attributes);
    if (error == 0) {
        error = PrepareFiles(pipes, &actions);
        error = error != 0 ? error : PrepareSignals(&attributes);
        error = error != 0 ? error
                           : posix_spawn(child, program, &actions, &attributes, arguments, environ);
        posix_spawnattr_destroy(&attributes);
    }
    posix_spawn_file_actions_destroy(&actions);
    return error;
}

// Waits until the child has ended; true when it was killed since the caller cancelled.
static bool WaitForEnd(const pvtLoadJob* job, const Pipes* pipes, pid_t child, int* exitStatus)
{
    bool cancelled = false;
    struct pollfd alive = {.fd = pipes->alive, .events = POLLIN};
    while (poll(&alive, 1, POLL_MILLISECONDS) == 0 || (alive.revents & POLLHUP) == 0) {
        if (pvtIsCancelled(job->context)) {
            (void)kill(child, SIGKILL);
            cancelled = true;
            break;
        }
    }
    // Where the program ignores SIGCHLD there is no status to be had: the result has to speak.
    *exitStatus = 0;
    while (waitpid(child, exitStatus, 0) < 0 && errno == EINTR) {
    }
    return cancelled;
}

static pvtStatus FailOfSignal(const pvtLoadJob* job, int number)
{
    if (number == SIGXCPU) {
        return pvtFail(job->context, PVT_INVALID_INPUT,
                       "%s: reading it took longer than such a file should; it is damaged, or "
                       "has to be converted to GLB",
                       job->path);
    }
    if (number == SIGKILL) {
        return pvtFail(job->context, PVT_LIMIT, "%s: reading it took more memory than there is",
                       job->path);
    }
    return pvtFail(
        job->context, PVT_INVALID_INPUT,
        "%s: assimp crashed over it (%s); it is damaged: repair it, or convert it to GLB",
        job->path, strsignal(number));
}

static pvtStatus MapResult(const pvtLoadJob* job, int file, int exitStatus, pvtImportResult* result)
{
    if (WIFSIGNALED(exitStatus)) {
        return FailOfSignal(job, WTERMSIG(exitStatus));
    }
    struct stat info;
    pvtImportHeader header;
    if (fstat(file, &info) != 0 || (size_t)info.st_size < sizeof header ||
        pread(file, &header, sizeof header, 0) != (ssize_t)sizeof header ||
        memcmp(header.magic, PVT_IMPORT_MAGIC, sizeof header.magic) != 0 ||
        header.version != PVT_IMPORT_VERSION) {
        return pvtFail(job->context, PVT_INVALID_INPUT,
                       "%s: the importer ended early (status %d); the file is damaged: repair it, "
                       "or convert it to GLB",
                       job->path, WEXITSTATUS(exitStatus));
    }
    char purpose[1024];
    (void)snprintf(purpose, sizeof purpose, "%s: its geometry", job->path);
    const pvtStatus status = pvtCheckMemory(job->context, (size_t)info.st_size, purpose);
    if (status != PVT_OK) {
        return status;
    }
    void* bytes = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_PRIVATE, file, 0);
    if (bytes == MAP_FAILED) {
        return pvtFail(job->context, PVT_OUT_OF_MEMORY, "%s: %s", job->path, strerror(errno));
    }
    *result = (pvtImportResult){bytes, (size_t)info.st_size};
    return PVT_OK;
}

static pvtStatus RunProgram(const pvtLoadJob* job, const char* program, pvtImportResult* result)
{
    Pipes pipes;
    pid_t child = 0;
    int error = OpenPipes(job, &pipes) ? 0 : errno;
    error = error != 0 ? error : Spawn(job, program, &pipes, &child);
    CloseIfOpen(&pipes.childAlive);
    pvtStatus status = PVT_OK;
    if (error != 0) {
        status = pvtFail(job->context, PVT_UNSUPPORTED, "%s: %s cannot be run: %s", job->path,
                         program, strerror(error));
    } else {
        int exitStatus = 0;
        status = WaitForEnd(job, &pipes, child, &exitStatus)
                     ? pvtFailCancelled(job->context)
                     : MapResult(job, pipes.output, exitStatus, result);
    }
    ClosePipes(&pipes);
    return status;
}

pvtStatus pvtRunImporter(const pvtLoadJob* job, pvtImportResult* result)
{
    *result = (pvtImportResult){0};
    if (pvtIsCancelled(job->context)) {
        return pvtFailCancelled(job->context);
    }
    pvtCompanionSearch search = {.file = kProgram};
    while (pvtFindCompanion(&search)) {
        if (access(search.path, X_OK) == 0) {
            return RunProgram(job, search.path, result);
        }
    }
    return pvtFail(job->context, PVT_UNSUPPORTED,
                   "%s: this format needs the program %s, which is not installed; build paravent "
                   "with libassimp-dev, name its folder in PARAVENT_MODULE_PATH, or convert the "
                   "model to GLB",
                   job->path, kProgram);
}

void pvtImportResult_Free(pvtImportResult* result)
{
    if (result->bytes != NULL) {
        munmap((void*)result->bytes, result->size);
    }
    *result = (pvtImportResult){0};
}
