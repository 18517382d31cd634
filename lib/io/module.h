// SPDX-License-Identifier: MIT
// Shared objects of the project's own that are opened when they are first needed.
#ifndef PVT_IO_MODULE_H
#define PVT_IO_MODULE_H

#include <paravent/base.h>

/// A place where a module was looked for.
typedef enum pvtModuleState {
    PVT_MODULE_OPEN,
    PVT_MODULE_MISSING, ///< nowhere to be found
    PVT_MODULE_BROKEN,  ///< found, but what it needs itself is missing: `reason` says what
} pvtModuleState;

/// Opens `file` from the folders in PARAVENT_MODULE_PATH, then from beside the program or library
/// that this code is part of, then from where it was to be installed. A file that somebody else
/// than root or the user could have put there is passed over. What is open stays open: the handle
/// is never to be closed, since libraries behind it do not survive that.
pvtModuleState pvtOpenModule(const char* file, void** handle, char* reason, size_t reasonSize);

#endif
