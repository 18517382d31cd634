// SPDX-License-Identifier: MIT
// Output files: written beside the target under another name, flushed, then renamed over it.
#include "context.h"

#include <errno.h>
#include <fcntl.h>
#include <paravent/output.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Room for ".PID-ATTEMPT.tmp".
enum { TEMPORARY_SUFFIX = 48 };

struct pvtOutput {
    pvtContext* context;
    FILE* file;
    int error;       // the first errno, or 0
    char* path;      // null: the standard output
    char* temporary; // null: written in place
};

static void FreeOutput(pvtOutput* output)
{
    pvtContext* context = output->context;
    pvtRelease(context, output->path);
    pvtRelease(context, output->temporary);
    pvtRelease(context, output);
}

// Something like /dev/null or a pipe cannot be renamed over: it is written in place.
static bool IsSpecialFile(const char* path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

// Creates a file beside the target that nobody else has. The target's permissions are kept when it
// is there already; else the umask decides.
static bool OpenTemporary(pvtOutput* output)
{
    int descriptor = -1;
    const size_t length = strlen(output->path) + TEMPORARY_SUFFIX;
    for (unsigned attempt = 0; attempt < 10000 && descriptor < 0; ++attempt) {
        (void)snprintf(output->temporary, length, "%s.%ld-%u.tmp", output->path, (long)getpid(),
                       attempt);
        descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor < 0 && errno != EEXIST) {
            break;
        }
    }
    if (descriptor < 0) {
        output->error = errno;
        pvtRelease(output->context, output->temporary);
        output->temporary = NULL;
        return false;
    }
    struct stat target;
    const bool kept = stat(output->path, &target) != 0 || fchmod(descriptor, target.st_mode) == 0;
    output->file = kept ? fdopen(descriptor, "wb") : NULL;
    if (output->file == NULL) {
        output->error = errno;
        close(descriptor);
    }
    return output->file != NULL;
}

// False with an error, or with none when the context has said that memory was short.
static bool OpenFile(pvtOutput* output, const char* path)
{
    struct stat info;
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode)) {
        output->error = EISDIR;
        return false;
    }
    if (IsSpecialFile(path)) {
        output->file = fopen(path, "wb");
        output->error = output->file == NULL ? errno : 0;
        return output->file != NULL;
    }
    // Renaming over it would work, but who made it read-only, as version control does with what is
    // not checked out, does not want it replaced.
    if (access(path, W_OK) != 0 && errno != ENOENT) {
        output->error = errno;
        return false;
    }
    output->temporary = pvtAllocate(output->context, strlen(path) + TEMPORARY_SUFFIX, 1);
    return output->temporary != NULL && OpenTemporary(output);
}

pvtStatus pvtOpenOutput(pvtContext* context, const char* path, pvtOutput** output)
{
    *output = NULL;
    pvtOutput* made = pvtAllocate(context, 1, sizeof *made);
    if (made == NULL) {
        return pvtContext_GetStatus(context);
    }
    made->context = context;
    if (strcmp(path, "-") == 0) {
        made->file = stdout;
        *output = made;
        return PVT_OK;
    }
    const size_t length = strlen(path);
    made->path = pvtAllocate(context, length + 1, 1);
    if (made->path == NULL) {
        pvtDiscardOutput(made);
        return pvtContext_GetStatus(context);
    }
    memcpy(made->path, path, length);
    if (!OpenFile(made, path)) {
        const int error = made->error;
        pvtDiscardOutput(made);
        return error == 0 ? pvtContext_GetStatus(context)
                          : pvtFail(context, PVT_OUTPUT_FAILED, "%s cannot be written: %s", path,
                                    strerror(error));
    }
    *output = made;
    return PVT_OK;
}

void pvtOutput_Write(pvtOutput* output, const void* bytes, size_t count)
{
    if (output->error == 0 && fwrite(bytes, 1, count, output->file) != count) {
        output->error = errno != 0 ? errno : EIO;
    }
}

void pvtOutput_Print(pvtOutput* output, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (output->error == 0 && vfprintf(output->file, format, arguments) < 0) {
        output->error = errno != 0 ? errno : EIO;
    }
    va_end(arguments);
}

static void NoteFailure(pvtOutput* output, bool failed)
{
    if (failed && output->error == 0) {
        output->error = errno != 0 ? errno : EIO;
    }
}

pvtStatus pvtCommitOutput(pvtOutput* output)
{
    pvtContext* context = output->context;
    NoteFailure(output, fflush(output->file) != 0);
    if (output->temporary != NULL) {
        NoteFailure(output, fsync(fileno(output->file)) != 0);
    }
    if (output->path != NULL) {
        NoteFailure(output, fclose(output->file) != 0);
        output->file = NULL;
    }
    if (output->temporary != NULL && output->error == 0) {
        NoteFailure(output, rename(output->temporary, output->path) != 0);
    }
    pvtStatus status = PVT_OK;
    if (output->error != 0) {
        status = pvtFail(context, PVT_OUTPUT_FAILED, "%s cannot be written: %s",
                         output->path != NULL ? output->path : "the standard output",
                         strerror(output->error));
        if (output->temporary != NULL) {
            unlink(output->temporary);
        }
    }
    FreeOutput(output);
    return status;
}

void pvtDiscardOutput(pvtOutput* output)
{
    if (output == NULL) {
        return;
    }
    if (output->path != NULL && output->file != NULL) {
        fclose(output->file);
    }
    if (output->temporary != NULL) {
        unlink(output->temporary);
    }
    FreeOutput(output);
}
