// SPDX-License-Identifier: MIT
// The subcommands: one file each.
#ifndef PVT_APP_COMMAND_H
#define PVT_APP_COMMAND_H

#include "options.h"

/// `count` words follow the subcommand's name. Returns the exit code.
typedef int pvtCommandFcn(int count, char* const* words);

typedef struct pvtCommand {
    const pvtSyntax* syntax;
    pvtCommandFcn* run;
} pvtCommand;

extern const pvtCommand pvtGenerateCommand;
extern const pvtCommand pvtEvaluateCommand;
extern const pvtCommand pvtLadderCommand;

#endif
