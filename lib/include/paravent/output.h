// SPDX-License-Identifier: MIT
// Files that are there whole, or not at all.
#ifndef PARAVENT_OUTPUT_H
#define PARAVENT_OUTPUT_H

#include <paravent/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A file being written: a temporary one beside its target until it is committed.
typedef struct pvtOutput pvtOutput;

/// "-" is the standard output. PVT_OUTPUT_FAILED names path and reason.
PVT_API pvtStatus pvtOpenOutput(pvtContext* context, const char* path, pvtOutput** output);
/// A failure is kept, and told by pvtCommitOutput.
PVT_API void pvtOutput_Write(pvtOutput* output, const void* bytes, size_t count);
PVT_API void pvtOutput_Print(pvtOutput* output, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
/// Flushes to the disk and renames over the target; frees `output` in any case. On failure nothing
/// is left, and an older file at the target stays as it was.
PVT_API pvtStatus pvtCommitOutput(pvtOutput* output);
/// Removes the temporary file. Null is fine.
PVT_API void pvtDiscardOutput(pvtOutput* output);

#ifdef __cplusplus
}
#endif
#endif
