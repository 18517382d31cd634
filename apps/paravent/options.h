// SPDX-License-Identifier: MIT
// Command lines: a table of options makes the parser, the checks and the help.
#ifndef PVT_APP_OPTIONS_H
#define PVT_APP_OPTIONS_H

#include <paravent/occluder.h>
#include <stddef.h>
#include <stdint.h>

/// What a value looks like, and the type of the field that takes it.
typedef enum pvtOptionKind {
    PVT_OPTION_FLAG,   ///< bool; no value
    PVT_OPTION_INT,    ///< int
    PVT_OPTION_COUNT,  ///< uint64_t, up to 2^53 - 1 so that JSON keeps it
    PVT_OPTION_DOUBLE, ///< double
    PVT_OPTION_LENGTH, ///< pvtLength: "0.5" in world units, "2vx" in voxels
    PVT_OPTION_SIZE,   ///< uint64_t [bytes]: "512M", "1.5G", "2GiB"; "GB" is 10^9
    PVT_OPTION_CHOICE, ///< int: the place of the word among `choices`
    PVT_OPTION_TEXT,   ///< const char*, never empty; points into the command line
} pvtOptionKind;

typedef struct pvtOption {
    const char* name; ///< without dashes
    char letter;      ///< 'o' for -o; 0: none
    bool isRequired;
    bool isLeastExcluded;
    pvtOptionKind kind;
    size_t offset;              ///< of the field in the command's options struct
    const char* placeholder;    ///< "N"; unused by flags and choices
    const char* const* choices; ///< null behind the last
    double least, most;         ///< both allowed, checked when least < most
    const char* defaultText;    ///< in the help; null: the field's own default; "": none is shown
    const char* help;
} pvtOption;

typedef struct pvtOptionGroup {
    const char* title;
    const pvtOption* options;
    size_t count;
} pvtOptionGroup;

/// One subcommand's line, as a table.
typedef struct pvtSyntax {
    const char* program;  ///< null: "paravent"
    const char* name;     ///< "generate"
    const char* summary;  ///< one line
    const char* operands; ///< "INPUT -o OUTPUT", for the usage line
    int leastOperands, mostOperands;
    const char* operandHelp; ///< what the operands are
    const pvtOptionGroup* groups;
    size_t groupCount;
    const char* notes; ///< printed behind the options; may be null
} pvtSyntax;

enum { PVT_MAX_OPTIONS = 64, PVT_USAGE_TEXT_SIZE = 1024 };

/// What a command line said, besides the fields it filled.
typedef struct pvtParsedLine {
    const char**
        operands; ///< in their order; room for mostOperands or all words, whichever is less
    int operandCount;
    uint64_t given;                    ///< bit i: option i, counted through all groups
    char message[PVT_USAGE_TEXT_SIZE]; ///< what is wrong
} pvtParsedLine;

/// What the texts call the program.
const char* pvtSyntax_GetProgram(const pvtSyntax* syntax);

/// Reads `count` words into the fields of `values`, which hold the defaults. `operands` of the line
/// is the caller's. An option given twice: the last one holds. False with a
/// message that names option, value and remedy.
bool pvtParseLine(const pvtSyntax* syntax, int count, char* const* words, void* values,
                  pvtParsedLine* line);

/// Whether the option was on the line.
bool pvtIsOptionGiven(const pvtSyntax* syntax, const pvtParsedLine* line, const char* name);

/// The word of `candidates` (null behind the last) that `word` was probably meant to be, or null.
const char* pvtFindSimilarWord(const char* word, const char* const* candidates);

#endif
