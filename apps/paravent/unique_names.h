// SPDX-License-Identifier: MIT
// Names for files whose readers tell nodes apart by them.
#ifndef PVT_APP_UNIQUE_NAMES_H
#define PVT_APP_UNIQUE_NAMES_H

#include <stddef.h>

/// The names of `count` nodes, each once: of those that are equal the first keeps its name, the
/// others get _2, _3 and so on, but never the name of a node that there is. Empty ones become
/// "node". Freed, all at once, by pvtFreeUniqueNames; null when out of memory.
char** pvtMakeUniqueNames(const char* const* names, size_t count);
void pvtFreeUniqueNames(char** names, size_t count);

#endif
