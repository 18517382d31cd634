// SPDX-License-Identifier: MIT
// Help texts, made from the same tables that the parser reads.
#ifndef PVT_APP_HELP_H
#define PVT_APP_HELP_H

#include "options.h"

#include <stdio.h>

/// `defaults` is the command's options struct as it is before the line is read.
void pvtPrintHelp(FILE* file, const pvtSyntax* syntax, const void* defaults);

/// Prints `text` broken at blanks to lines of 80 columns, each behind `indent` blanks. The cursor
/// stands at column `column`. Ends with a line feed.
void pvtPrintWrapped(FILE* file, const char* text, int indent, int column);

#endif
