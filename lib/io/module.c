// SPDX-License-Identifier: MIT
#include "module.h"

#include <dlfcn.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH_SIZE = 4096 };

// Relative to the folder of the program, or of the library: a build tree's, then an installation's.
static const char* const kFolders[] = {"/paravent/", "/../../lib/paravent/",
                                       "/../" PVT_INSTALL_LIBDIR "/paravent/", "/../lib/paravent/"};

typedef struct Search {
    const char* file;
    void* handle;
    char* reason;
    size_t reasonSize;
    bool broken;
} Search;

static bool IsTrusted(const char* path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode) && (info.st_mode & S_IWOTH) == 0 &&
           (info.st_uid == 0 || info.st_uid == geteuid());
}

// Tries FOLDER SEPARATOR file. True once the module is open.
static bool TryFolder(Search* search, const char* folder, size_t length, const char* separator)
{
    char path[PATH_SIZE];
    const int needed =
        snprintf(path, sizeof path, "%.*s%s%s", (int)length, folder, separator, search->file);
    if (needed < 0 || needed >= PATH_SIZE || !IsTrusted(path)) {
        return false;
    }
    search->handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (search->handle == NULL) {
        const char* error = dlerror();
        (void)snprintf(search->reason, search->reasonSize, "%s", error != NULL ? error : path);
        search->broken = true;
    }
    return search->handle != NULL;
}

static bool TryEnvironment(Search* search)
{
    const char* folders = secure_getenv("PARAVENT_MODULE_PATH");
    while (folders != NULL && *folders != '\0') {
        const size_t length = strcspn(folders, ":");
        if (length > 0 && TryFolder(search, folders, length, "/")) {
            return true;
        }
        folders += length + (folders[length] == ':' ? 1 : 0);
    }
    return false;
}

// The folder of the file that holds this code: the program, or the shared library.
static bool FindOwnFolder(char folder[PATH_SIZE])
{
    static const char anchor = 0;
    Dl_info info;
    struct link_map* map = NULL;
    if (dladdr1(&anchor, &info, (void**)&map, RTLD_DL_LINKMAP) == 0 || map == NULL) {
        return false;
    }
    // The program itself has no name there: it may have been called by a relative one.
    const char* name = map->l_name[0] != '\0' ? map->l_name : "/proc/self/exe";
    char* resolved = realpath(name, NULL);
    char* slash = resolved != NULL ? strrchr(resolved, '/') : NULL;
    const bool found = slash != NULL && slash - resolved < PATH_SIZE;
    if (found) {
        *slash = '\0';
        memcpy(folder, resolved, strlen(resolved) + 1);
    }
    free(resolved);
    return found;
}

static bool TryNeighbours(Search* search)
{
    char folder[PATH_SIZE];
    if (!FindOwnFolder(folder)) {
        return false;
    }
    for (size_t i = 0; i < sizeof kFolders / sizeof kFolders[0]; ++i) {
        if (TryFolder(search, folder, strlen(folder), kFolders[i])) {
            return true;
        }
    }
    return false;
}

pvtModuleState pvtOpenModule(const char* file, void** handle, char* reason, size_t reasonSize)
{
    Search search = {.file = file, .reason = reason, .reasonSize = reasonSize};
    *handle = NULL;
    const bool found =
        TryEnvironment(&search) || TryNeighbours(&search) ||
        TryFolder(&search, PVT_INSTALL_FULL_LIBDIR, strlen(PVT_INSTALL_FULL_LIBDIR), "/paravent/");
    *handle = search.handle;
    return found ? PVT_MODULE_OPEN : search.broken ? PVT_MODULE_BROKEN : PVT_MODULE_MISSING;
}
