// SPDX-License-Identifier: MIT
// Files of the project's own that lie beside the program: what is too heavy, or too dangerous, to
// be linked into it.
#ifndef PVT_IO_COMPANION_H
#define PVT_IO_COMPANION_H

#include <paravent/base.h>

enum { PVT_COMPANION_PATH_SIZE = 4096 };

/// Where the search stands; zero to begin with.
typedef struct pvtCompanionSearch {
    const char* file;
    size_t next;
    char path[PVT_COMPANION_PATH_SIZE];
} pvtCompanionSearch;

/// The next place where `file` is: in the folders of PARAVENT_MODULE_PATH, then beside the program
/// or library that this code is part of, then where it was to be installed. Passes over a file that
/// somebody else than root or the user could have put there. False when there is no further one;
/// else its name is in `path`.
bool pvtFindCompanion(pvtCompanionSearch* search);

typedef enum pvtModuleState {
    PVT_MODULE_OPEN,
    PVT_MODULE_MISSING, ///< nowhere to be found
    PVT_MODULE_BROKEN,  ///< found, but what it needs itself is missing: `reason` says what
} pvtModuleState;

/// Opens a shared object. What is open stays open: the handle is never to be closed, since the
/// libraries behind it do not survive that.
pvtModuleState pvtOpenModule(const char* file, void** handle, char* reason, size_t reasonSize);

#endif
