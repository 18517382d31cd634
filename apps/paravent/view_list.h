// SPDX-License-Identifier: MIT
// View directions from a text file.
#ifndef PVT_APP_VIEW_LIST_H
#define PVT_APP_VIEW_LIST_H

#include "run.h"

/// What --views FILE held. Made by malloc, as the context is not yet there when files are checked.
typedef struct pvtViewList {
    pvtWeightedDirection* directions;
    size_t count;
} pvtViewList;

/// Four numbers a line: the direction to look along, and its weight. Empty lines count for nothing,
/// nor does what follows a '#'. PVT_INVALID_INPUT names file, line and reason.
pvtStatus pvtReadViewList(pvtRun* run, const char* path, pvtViewList* list);
void pvtViewList_Free(pvtViewList* list);

#endif
