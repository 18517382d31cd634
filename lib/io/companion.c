// SPDX-License-Identifier: MIT
#include "companion.h"

#include <dlfcn.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// Behind the folder of the program, or of the library: a build tree's, then an installation's.
static const char* const kFolders[] = {
    "/paravent/",
    "/../../lib/paravent/",
    "/../" PVT_INSTALL_LIBDIR "/paravent/",
    "/../lib/paravent/",
};

enum { FOLDER_COUNT = sizeof kFolders / sizeof kFolders[0] };

static bool IsTrusted(const char* path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode) && (info.st_mode & S_IWOTH) == 0 &&
           (info.st_uid == 0 || info.st_uid == geteuid());
}

// The folder with this number in PARAVENT_MODULE_PATH. Null past the last.
static const char* GetListedFolder(size_t number, size_t* length)
{
    const char* folders = secure_getenv("PARAVENT_MODULE_PATH");
    while (folders != NULL) {
        *length = strcspn(folders, ":");
        if (number == 0) {
            return folders;
        }
        --number;
        folders = folders[*length] == ':' ? folders + *length + 1 : NULL;
    }
    return NULL;
}

static size_t CountListedFolders(void)
{
    size_t count = 0, length = 0;
    while (GetListedFolder(count, &length) != NULL) {
        ++count;
    }
    return count;
}

// The folder of the file that holds this code: the program, or the shared library.
static bool FindOwnFolder(char folder[PVT_COMPANION_PATH_SIZE])
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
    const bool found = slash != NULL && slash - resolved < PVT_COMPANION_PATH_SIZE;
    if (found) {
        *slash = '\0';
        memcpy(folder, resolved, strlen(resolved) + 1);
    }
    free(resolved);
    return found;
}

// Joins what place `number` stands for; false where there is no such folder.
static bool JoinPath(pvtCompanionSearch* search, size_t number, size_t listedCount)
{
    char own[PVT_COMPANION_PATH_SIZE] = "";
    size_t length = 0;
    const char* folder = own;
    const char* separator = "/";
    if (number < listedCount) {
        folder = GetListedFolder(number, &length);
    } else if (number < listedCount + FOLDER_COUNT) {
        separator = kFolders[number - listedCount];
        length = FindOwnFolder(own) ? strlen(own) : 0;
    } else {
        folder = PVT_INSTALL_FULL_LIBDIR "/paravent";
        length = strlen(folder);
    }
    if (folder == NULL || length == 0) {
        return false;
    }
    const int needed = snprintf(search->path, sizeof search->path, "%.*s%s%s", (int)length, folder,
                                separator, search->file);
    return needed > 0 && needed < PVT_COMPANION_PATH_SIZE;
}

bool pvtFindCompanion(pvtCompanionSearch* search)
{
    const size_t listedCount = CountListedFolders();
    while (search->next < listedCount + FOLDER_COUNT + 1) {
        if (JoinPath(search, search->next++, listedCount) && IsTrusted(search->path)) {
            return true;
        }
    }
    return false;
}

pvtModuleState pvtOpenModule(const char* file, void** handle, char* reason, size_t reasonSize)
{
    pvtCompanionSearch search = {.file = file};
    pvtModuleState state = PVT_MODULE_MISSING;
    *handle = NULL;
    while (*handle == NULL && pvtFindCompanion(&search)) {
        *handle = dlopen(search.path, RTLD_NOW | RTLD_LOCAL);
        if (*handle == NULL) {
            const char* error = dlerror();
            (void)snprintf(reason, reasonSize, "%s", error != NULL ? error : search.path);
            state = PVT_MODULE_BROKEN;
        }
    }
    return *handle != NULL ? PVT_MODULE_OPEN : state;
}
