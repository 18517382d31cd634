// SPDX-License-Identifier: MIT
// Names out of files: cleaned before anybody prints or writes them.
#ifndef PVT_IO_TEXT_H
#define PVT_IO_TEXT_H

#include <paravent/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Enough for any name in a message.
enum { PVT_NAME_SIZE = 80 };

/// A copy that is valid UTF-8 without control characters: each byte that cannot stay becomes '?'.
/// Freed by pvtRelease; null when out of memory.
char* pvtCopyCleanText(pvtContext* context, const char* text);
/// The same into a buffer of `size` bytes, at least 4, cut with "..." where it is too long, for
/// messages. Returns `buffer`.
const char* pvtCleanText(const char* text, char* buffer, size_t size);
const char* pvtCleanName(const char* text, char buffer[PVT_NAME_SIZE]);
/// Whether `path` ends in `ending` (with its dot), in capitals or not.
bool pvtHasEnding(const char* path, const char* ending);

#ifdef __cplusplus
}
#endif
#endif
