// SPDX-License-Identifier: MIT
// The files that a command is to write, checked before the long work.
#ifndef PVT_APP_TARGETS_H
#define PVT_APP_TARGETS_H

#include "run.h"

/// A file that an option names.
typedef struct pvtTarget {
    const char* option; ///< "--stats"; null: an input, named so in messages
    const char* path;   ///< null: not asked for, skipped
    bool canBeStdout;   ///< "-" is allowed
} pvtTarget;

/// Fails when two targets are the same file or one of them an input, when "-" makes no sense or is
/// used twice, when a folder is missing, and when a file cannot be made where a target will be.
pvtStatus pvtCheckTargets(pvtRun* run, const pvtTarget* targets, size_t count);

/// Fails when `path` (null: not asked for) names a picture with another ending than .png.
pvtStatus pvtCheckPicture(pvtRun* run, const char* option, const char* path);

/// Whether the path ends like ".png", in any case of letters.
bool pvtPathEndsIn(const char* path, const char* ending);

/// The path's last part.
const char* pvtGetFileName(const char* path);

/// The file's name without folders and its last ending, as UTF-8: "meshes/old.bunny.glb" gives
/// "old.bunny". Control characters and bytes that are not UTF-8 become '_'. `name` is never empty.
void pvtGetStem(const char* path, char* name, size_t size);

#endif
