// SPDX-License-Identifier: MIT
// For tests of what is told.
#ifndef PVT_TEST_WARNINGS_H
#define PVT_TEST_WARNINGS_H

#include "check.h"

#include <string.h>

/// A context that keeps its warnings, one a line.
typedef struct Warnings {
    char text[8192];
} Warnings;

static inline void KeepWarning(pvtLogLevel level, const char* text, void* user)
{
    Warnings* warnings = user;
    if (level == PVT_LOG_WARNING) {
        const size_t used = strlen(warnings->text);
        (void)snprintf(warnings->text + used, sizeof warnings->text - used, "%s\n", text);
    }
}

static inline pvtContext* CreateWarningContext(Warnings* warnings)
{
    warnings->text[0] = '\0';
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = 1;
    def.memoryLimit = (size_t)1 << 30;
    def.log = KeepWarning;
    def.user = warnings;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    return context;
}

#endif
