// SPDX-License-Identifier: MIT
#include "child_process.h"

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

enum {
    POLL_MILLISECONDS = 20,
    GRACE_MILLISECONDS = 1000, // to end in, for a child that has closed its pipe
    FIRST_FREE = 10, // descriptors from here up are out of the way of those that the child gets
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

static bool OpenPipes(const pvtChildDef* def, Pipes* pipes)
{
    int ends[2] = {-1, -1};
    *pipes = (Pipes){-1, -1, -1, -1};
    if (pipe2(ends, O_CLOEXEC) != 0) {
        return false;
    }
    pipes->alive = MoveUp(ends[0]);
    pipes->childAlive = MoveUp(ends[1]);
    pipes->output = MoveUp(memfd_create(def->program, MFD_CLOEXEC));
    pipes->input = fcntl(def->input, F_DUPFD_CLOEXEC, FIRST_FREE);
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
                       : posix_spawn_file_actions_adddup2(actions, pipes->input, PVT_CHILD_INPUT);
    error = error != 0 ? error
                       : posix_spawn_file_actions_adddup2(actions, pipes->output, PVT_CHILD_OUTPUT);
    error = error != 0
                ? error
                : posix_spawn_file_actions_adddup2(actions, pipes->childAlive, PVT_CHILD_ALIVE);
    return error != 0 ? error
                      : posix_spawn_file_actions_addclosefrom_np(actions, PVT_CHILD_ALIVE + 1);
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

// 0, or an errno.
static int Spawn(const pvtChildDef* def, const char* program, const Pipes* pipes, pid_t* child)
{
    char name[64], argument[32], memory[32], seconds[32];
    (void)snprintf(name, sizeof name, "%s", def->program);
    (void)snprintf(argument, sizeof argument, "%s", def->argument);
    (void)snprintf(memory, sizeof memory, "%zu", def->memory);
    (void)snprintf(seconds, sizeof seconds, "%zu", def->seconds);
    char* const arguments[] = {name, argument, memory, seconds, NULL};

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

// Takes the status of a child whose pipe is closed, by its end as a rule: one that lives on is
// killed. True when that was since the caller cancelled.
static bool Reap(const pvtLoadJob* job, pid_t child, int* exitStatus)
{
    pid_t ended = 0;
    bool cancelled = false;
    *exitStatus = 0;
    for (int waited = 0; waited < GRACE_MILLISECONDS && !cancelled; ++waited) {
        ended = waitpid(child, exitStatus, WNOHANG);
        if (ended != 0) {
            break;
        }
        (void)poll(NULL, 0, 1);
        cancelled = pvtIsCancelled(job->context);
    }
    // Where the program ignores SIGCHLD there is no status to be had, and that of a child that had
    // to be killed says nothing: the result has to speak.
    if (ended == 0) {
        (void)kill(child, SIGKILL);
        while (waitpid(child, exitStatus, 0) < 0 && errno == EINTR) {
        }
        *exitStatus = 0;
    }
    return cancelled;
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
    return Reap(job, child, exitStatus) || cancelled;
}

static pvtStatus MapOutput(const pvtLoadJob* job, int file, pvtChildResult* result)
{
    struct stat info;
    if (fstat(file, &info) != 0 || info.st_size <= 0) {
        return PVT_OK;
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
    result->bytes = bytes;
    result->size = (size_t)info.st_size;
    return PVT_OK;
}

static pvtStatus RunProgram(const pvtLoadJob* job, const pvtChildDef* def, const char* program,
                            pvtChildResult* result)
{
    Pipes pipes;
    pid_t child = 0;
    int error = OpenPipes(def, &pipes) ? 0 : errno;
    error = error != 0 ? error : Spawn(def, program, &pipes, &child);
    CloseIfOpen(&pipes.childAlive);
    pvtStatus status = PVT_OK;
    if (error != 0) {
        status = pvtFail(job->context, PVT_UNSUPPORTED, "%s: %s cannot be run: %s", job->path,
                         program, strerror(error));
    } else {
        int exitStatus = 0;
        if (WaitForEnd(job, &pipes, child, &exitStatus)) {
            status = pvtFailCancelled(job->context);
        } else {
            result->signal = WIFSIGNALED(exitStatus) ? WTERMSIG(exitStatus) : 0;
            result->exitCode = WIFEXITED(exitStatus) ? WEXITSTATUS(exitStatus) : 0;
            status = MapOutput(job, pipes.output, result);
        }
    }
    ClosePipes(&pipes);
    return status;
}

pvtStatus pvtRunChild(const pvtLoadJob* job, const pvtChildDef* def, pvtChildResult* result)
{
    *result = (pvtChildResult){0};
    if (pvtIsCancelled(job->context)) {
        return pvtFailCancelled(job->context);
    }
    pvtCompanionSearch search = {.file = def->program};
    while (pvtFindCompanion(&search)) {
        if (access(search.path, X_OK) == 0) {
            return RunProgram(job, def, search.path, result);
        }
    }
    return pvtFail(job->context, PVT_UNSUPPORTED,
                   "%s: %s needs the program %s, which is not installed; %s", job->path,
                   def->purpose, def->program, def->remedy);
}

void pvtChildResult_Free(pvtChildResult* result)
{
    if (result->bytes != NULL) {
        munmap((void*)result->bytes, result->size);
    }
    *result = (pvtChildResult){0};
}

pvtStatus pvtFailOfSignal(const pvtLoadJob* job, int number, const char* place, const char* reader,
                          const char* remedy)
{
    if (number == SIGXCPU) {
        return pvtFail(job->context, PVT_INVALID_INPUT,
                       "%s: %sreading it by %s took longer than such data should; it is damaged: "
                       "%s",
                       job->path, place, reader, remedy);
    }
    if (number == SIGKILL) {
        return pvtFail(job->context, PVT_LIMIT,
                       "%s: %sreading it by %s took more memory than there is", job->path, place,
                       reader);
    }
    return pvtFail(job->context, PVT_INVALID_INPUT,
                   "%s: %s%s crashed over it (%s); it is damaged: "
                   "%s",
                   job->path, place, reader, strsignal(number), remedy);
}
