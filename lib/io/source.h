// SPDX-License-Identifier: MIT
// Files read whole into memory, by rules that a hostile file or link cannot bend.
#ifndef PVT_IO_SOURCE_H
#define PVT_IO_SOURCE_H

#include <paravent/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Zero bytes behind each source, for parsers that look a little too far.
enum { PVT_SOURCE_PADDING = 64 };

/// `size` bytes and PVT_SOURCE_PADDING zeroes behind them.
typedef struct pvtSource {
    uint8_t* bytes;
    size_t size;
} pvtSource;

/// Opens a regular file: a pipe, a device or a folder is PVT_INVALID_INPUT at once, whatever it
/// would deliver. PVT_LIMIT above maxBytes. To be closed by the caller.
pvtStatus pvtOpenSource(pvtContext* context, const char* path, size_t maxBytes, int* file,
                        size_t* size);
/// Reads an open file of this size from its begin; `label` is its name for messages.
pvtStatus pvtReadOpenSource(pvtContext* context, int file, size_t size, const char* label,
                            pvtSource* source);
/// Both together.
pvtStatus pvtReadSource(pvtContext* context, const char* path, size_t maxBytes, pvtSource* source);

/// Reads `name`, a relative path, from the folder that `modelPath` lies in. Nothing outside of that
/// folder can be reached, by "..", by an absolute path, or by a symbolic link.
pvtStatus pvtReadSourceBeside(pvtContext* context, const char* modelPath, const char* name,
                              size_t maxBytes, pvtSource* source);

void pvtSource_Free(pvtContext* context, pvtSource* source);

/// Opens `name` beneath `folder` for reading; −1 and errno on failure, EXDEV when it would leave
/// the folder. pvtOpenBeneath asks the kernel (openat2) and walks the parts itself where the kernel
/// does not know how, which allows neither ".." nor symbolic links.
int pvtOpenBeneath(int folder, const char* name);
int pvtOpenBeneathByParts(int folder, const char* name);

#ifdef __cplusplus
}
#endif
#endif
