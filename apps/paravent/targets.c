// SPDX-License-Identifier: MIT
#include "targets.h"

#include "json.h"

#include <errno.h>
#include <paravent/output.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

bool pvtPathEndsIn(const char* path, const char* ending)
{
    const size_t length = strlen(path);
    const size_t endingLength = strlen(ending);
    return length > endingLength && strcasecmp(path + length - endingLength, ending) == 0;
}

const char* pvtGetFileName(const char* path)
{
    const char* slash = strrchr(path, '/');
    return slash != NULL ? slash + 1 : path;
}

void pvtGetStem(const char* path, char* name, size_t size)
{
    const char* file = pvtGetFileName(path);
    const char* dot = strrchr(file, '.');
    const size_t length = dot != NULL && dot != file ? (size_t)(dot - file) : strlen(file);
    size_t used = 0;
    for (size_t i = 0; i < length;) {
        bool isHarmless;
        const size_t step = pvtMeasureCharacter(file + i, &isHarmless);
        if (used + step + 1 > size) {
            break;
        }
        if (isHarmless) {
            memcpy(name + used, file + i, step);
            used += step;
        } else {
            name[used++] = '_';
        }
        i += step;
    }
    if (used == 0) {
        name[used++] = '_';
    }
    name[used] = '\0';
}

// The folder that the path names a file in; the caller frees it.
static char* CopyFolder(const char* path)
{
    const char* file = pvtGetFileName(path);
    if (file == path) {
        return strdup(".");
    }
    const size_t length = (size_t)(file - path) > 1 ? (size_t)(file - path) - 1 : 1;
    return strndup(path, length);
}

// The same file, also when it is not there yet: the same name in the same folder. Things like
// /dev/null may be named more than once.
static bool IsSameFile(const char* a, const char* b)
{
    struct stat infoA;
    struct stat infoB;
    const bool hasA = stat(a, &infoA) == 0;
    const bool hasB = stat(b, &infoB) == 0;
    if (hasA && hasB) {
        return S_ISREG(infoA.st_mode) && infoA.st_dev == infoB.st_dev &&
               infoA.st_ino == infoB.st_ino;
    }
    if (hasA != hasB || strcmp(pvtGetFileName(a), pvtGetFileName(b)) != 0) {
        return false;
    }
    char* folderA = CopyFolder(a);
    char* folderB = CopyFolder(b);
    const bool isSame = folderA != NULL && folderB != NULL && stat(folderA, &infoA) == 0 &&
                        stat(folderB, &infoB) == 0 && infoA.st_dev == infoB.st_dev &&
                        infoA.st_ino == infoB.st_ino;
    free(folderA);
    free(folderB);
    return isSame;
}

static bool IsStdout(const pvtTarget* target)
{
    return target->option != NULL && strcmp(target->path, "-") == 0;
}

static pvtStatus CheckPair(pvtRun* run, const pvtTarget* first, const pvtTarget* second)
{
    if (IsStdout(first) && IsStdout(second)) {
        return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                           "%s and %s both go to the standard output; give one of them a file name",
                           first->option, second->option);
    }
    const bool areInputs = first->option == NULL && second->option == NULL;
    if (areInputs || IsStdout(first) || IsStdout(second) ||
        !IsSameFile(first->path, second->path)) {
        return PVT_OK;
    }
    return pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                       "%s %s is the same file as %s; give it another name", second->option,
                       second->path, first->option != NULL ? first->option : "the input");
}

static pvtStatus CheckFolder(pvtRun* run, const pvtTarget* target)
{
    char* folder = CopyFolder(target->path);
    if (folder == NULL) {
        return pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory");
    }
    struct stat info;
    pvtStatus status = PVT_OK;
    if (stat(folder, &info) != 0) {
        const char* remedy = errno == ENOENT ? "; make it first (mkdir -p)" : "";
        status = pvtRun_Fail(run, PVT_OUTPUT_FAILED, "%s %s: folder %s: %s%s", target->option,
                             target->path, folder, strerror(errno), remedy);
    } else if (!S_ISDIR(info.st_mode)) {
        status = pvtRun_Fail(run, PVT_OUTPUT_FAILED, "%s %s: %s is not a folder", target->option,
                             target->path, folder);
    }
    free(folder);
    return status;
}

// Opens the output as it will be opened later, and takes it back. Pipes and devices are left
// alone: opening one is already seen on the other side.
static pvtStatus TryTarget(pvtRun* run, const pvtTarget* target)
{
    struct stat info;
    if (stat(target->path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode)) {
        return PVT_OK;
    }
    pvtOutput* output = NULL;
    const pvtStatus status = pvtOpenOutput(run->context, target->path, &output);
    pvtDiscardOutput(output);
    if (status == PVT_OUTPUT_FAILED) {
        return pvtRun_Fail(run, status, "%s %s; choose another place", target->option,
                           pvtContext_GetMessage(run->context));
    }
    return status;
}

static pvtStatus CheckTarget(pvtRun* run, const pvtTarget* target)
{
    if (IsStdout(target)) {
        return target->canBeStdout
                   ? PVT_OK
                   : pvtRun_Fail(run, PVT_INVALID_ARGUMENT,
                                 "%s cannot go to the standard output; give it a file name",
                                 target->option);
    }
    const pvtStatus status = CheckFolder(run, target);
    return status == PVT_OK ? TryTarget(run, target) : status;
}

pvtStatus pvtCheckTargets(pvtRun* run, const pvtTarget* targets, size_t count)
{
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        for (size_t j = 0; j < i && targets[i].path != NULL && status == PVT_OK; ++j) {
            if (targets[j].path != NULL) {
                status = CheckPair(run, &targets[j], &targets[i]);
            }
        }
    }
    for (size_t i = 0; i < count && status == PVT_OK; ++i) {
        if (targets[i].path != NULL && targets[i].option != NULL) {
            status = CheckTarget(run, &targets[i]);
        }
    }
    return status;
}

pvtStatus pvtCheckPicture(pvtRun* run, const char* option, const char* path)
{
    if (path == NULL || pvtPathEndsIn(path, ".png")) {
        return PVT_OK;
    }
    return pvtRun_Fail(run, PVT_UNSUPPORTED,
                       "%s %s: pictures are written as .png; give the name that ending", option,
                       path);
}
