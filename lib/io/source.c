// SPDX-License-Identifier: MIT
// Reading files: what they are is asked of the open descriptor, so that nothing can be exchanged
// between the question and the answer.
#include "source.h"

#include "base/context.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

// Between two questions whether to stop: some 10 ms of work for a slow disk.
enum { READ_PIECE = 4 << 20 };

// O_NONBLOCK: the open itself must not wait for a pipe's writer.
static const int kOpenFlags = O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY;

static const char* DescribeKind(mode_t mode)
{
    if (S_ISDIR(mode)) {
        return "is a folder";
    }
    if (S_ISFIFO(mode)) {
        return "is a pipe";
    }
    if (S_ISSOCK(mode)) {
        return "is a socket";
    }
    return "is a device";
}

static pvtStatus CheckKind(pvtContext* context, int file, const char* label, size_t maxBytes,
                           size_t* size)
{
    struct stat info;
    if (fstat(file, &info) != 0) {
        return pvtFail(context, PVT_INVALID_INPUT, "%s cannot be read: %s", label, strerror(errno));
    }
    if (!S_ISREG(info.st_mode)) {
        return pvtFail(context, PVT_INVALID_INPUT, "%s %s; give a regular file", label,
                       DescribeKind(info.st_mode));
    }
    *size = (size_t)info.st_size;
    if (*size > maxBytes) {
        return pvtFail(context, PVT_LIMIT, "%s has %zu bytes; files of at most %zu bytes are read",
                       label, *size, maxBytes);
    }
    return PVT_OK;
}

static pvtStatus ReadBytes(pvtContext* context, int file, const char* label, pvtSource* source)
{
    size_t done = 0;
    while (done < source->size) {
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        const size_t left = source->size - done;
        const ssize_t got = pread(file, source->bytes + done,
                                  left < READ_PIECE ? left : (size_t)READ_PIECE, (off_t)done);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            return pvtFail(context, PVT_INVALID_INPUT, "%s cannot be read: %s", label,
                           strerror(errno));
        }
        if (got == 0) {
            return pvtFail(context, PVT_INVALID_INPUT,
                           "%s became shorter while it was read: %zu of %zu bytes came", label,
                           done, source->size);
        }
        done += (size_t)got;
    }
    return PVT_OK;
}

pvtStatus pvtReadOpenSource(pvtContext* context, int file, size_t size, const char* label,
                            pvtSource* source)
{
    *source = (pvtSource){0};
    pvtSource read = {.size = size};
    read.bytes = pvtAllocate(context, size + PVT_SOURCE_PADDING, 1);
    if (read.bytes == NULL) {
        return pvtContext_GetStatus(context);
    }
    const pvtStatus status = ReadBytes(context, file, label, &read);
    if (status != PVT_OK) {
        pvtSource_Free(context, &read);
        return status;
    }
    *source = read;
    return PVT_OK;
}

pvtStatus pvtOpenSource(pvtContext* context, const char* path, size_t maxBytes, int* file,
                        size_t* size)
{
    *file = open(path, kOpenFlags);
    if (*file < 0) {
        // A socket, or a device without a driver, cannot even be opened.
        return pvtFail(context, PVT_INVALID_INPUT, "%s cannot be read: %s", path,
                       errno == ENXIO ? "it is not a regular file" : strerror(errno));
    }
    const pvtStatus status = CheckKind(context, *file, path, maxBytes, size);
    if (status != PVT_OK) {
        close(*file);
        *file = -1;
    }
    return status;
}

pvtStatus pvtReadSource(pvtContext* context, const char* path, size_t maxBytes, pvtSource* source)
{
    *source = (pvtSource){0};
    int file = -1;
    size_t size = 0;
    pvtStatus status = pvtOpenSource(context, path, maxBytes, &file, &size);
    if (status == PVT_OK) {
        status = pvtReadOpenSource(context, file, size, path, source);
        close(file);
    }
    return status;
}

int pvtOpenBeneathByParts(int folder, const char* name)
{
    if (name[0] == '/') {
        errno = EXDEV;
        return -1;
    }
    char part[256];
    int at = dup(folder);
    while (at >= 0) {
        name += strspn(name, "/");
        const size_t length = strcspn(name, "/");
        if (length == 0 || length >= sizeof part) {
            errno = length == 0 ? EISDIR : ENAMETOOLONG;
            break;
        }
        memcpy(part, name, length);
        part[length] = '\0';
        name += length;
        if (strcmp(part, "..") == 0) {
            errno = EXDEV;
            break;
        }
        const bool last = name[strspn(name, "/")] == '\0';
        const int flags = last ? kOpenFlags : O_PATH | O_DIRECTORY | O_CLOEXEC;
        const int next = openat(at, part, flags | O_NOFOLLOW);
        const int error = errno;
        close(at);
        errno = error == ELOOP ? EXDEV : error;
        if (last || next < 0) {
            return next;
        }
        at = next;
    }
    const int error = errno;
    if (at >= 0) {
        close(at);
    }
    errno = error;
    return -1;
}

int pvtOpenBeneath(int folder, const char* name)
{
    const struct open_how how = {
        .flags = (uint64_t)kOpenFlags,
        .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS,
    };
    long file = -1;
    // EAGAIN: something was renamed meanwhile, and the kernel cannot tell whether it mattered.
    for (int attempt = 0; attempt == 0 || (file < 0 && errno == EAGAIN && attempt < 16);
         ++attempt) {
        file = syscall(SYS_openat2, folder, name, &how, sizeof how);
    }
    // Linux before 5.6 does not know the call, and some sandboxes forbid what they do not know.
    if (file < 0 && (errno == ENOSYS || errno == EPERM || errno == EINVAL)) {
        return pvtOpenBeneathByParts(folder, name);
    }
    return (int)file;
}

// The folder part of `path`, or "." without one; freed by pvtRelease.
static char* CopyFolder(pvtContext* context, const char* path)
{
    const char* slash = strrchr(path, '/');
    const size_t length = slash == NULL ? 0 : slash == path ? 1 : (size_t)(slash - path);
    char* folder = pvtAllocate(context, length + 2, 1);
    if (folder != NULL && length == 0) {
        folder[0] = '.';
    } else if (folder != NULL) {
        memcpy(folder, path, length);
    }
    return folder;
}

static const char* DescribeOpenError(int error)
{
    if (error == EXDEV || error == ELOOP) {
        return "it leaves the model's folder; copy it beside the model";
    }
    if (error == ENOENT || error == ENOTDIR) {
        return "there is no such file beside the model";
    }
    return error == ENXIO ? "it is not a regular file" : strerror(error);
}

pvtStatus pvtReadSourceBeside(pvtContext* context, const char* modelPath, const char* name,
                              size_t maxBytes, pvtSource* source)
{
    *source = (pvtSource){0};
    char* folderPath = CopyFolder(context, modelPath);
    if (folderPath == NULL) {
        return pvtContext_GetStatus(context);
    }
    const int folder = open(folderPath, O_PATH | O_DIRECTORY | O_CLOEXEC);
    const int file = folder >= 0 ? pvtOpenBeneath(folder, name) : -1;
    const int error = errno;
    pvtRelease(context, folderPath);
    if (folder >= 0) {
        close(folder);
    }
    if (file < 0) {
        return pvtFail(context, PVT_INVALID_INPUT, "\"%s\" cannot be read: %s", name,
                       DescribeOpenError(error));
    }
    size_t size = 0;
    pvtStatus status = CheckKind(context, file, name, maxBytes, &size);
    if (status == PVT_OK) {
        status = pvtReadOpenSource(context, file, size, name, source);
    }
    close(file);
    return status;
}

void pvtSource_Free(pvtContext* context, pvtSource* source)
{
    pvtRelease(context, source->bytes);
    *source = (pvtSource){0};
}
