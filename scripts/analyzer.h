// SPDX-License-Identifier: MIT
// What clang's analyzer has to be told, as it sees one file at a time: a failure never has the
// status PVT_OK. scripts/tidy.sh puts this in front of every file but the one that defines them.
#include "base/context.h"

#define pvtFail(context, status, ...) ((void)pvtFail(context, status, __VA_ARGS__), (status))
#define pvtFailCancelled(context) ((void)pvtFailCancelled(context), PVT_CANCELLED)
#define pvtContext_GetStatus(context) ((void)pvtContext_GetStatus(context), PVT_OUT_OF_MEMORY)
