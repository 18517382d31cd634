// SPDX-License-Identifier: MIT
// What every subcommand needs while it works: options that all share, the library's context with
// its hooks, messages, and the exit code at the end.
#ifndef PVT_APP_RUN_H
#define PVT_APP_RUN_H

#include "options.h"
#include "progress.h"
#include "report.h"

typedef enum pvtExitCode {
    PVT_EXIT_DONE = 0,
    PVT_EXIT_USAGE = 1,
    PVT_EXIT_INPUT = 2,
    PVT_EXIT_UNSUPPORTED = 3,
    PVT_EXIT_OUTPUT = 4,
    PVT_EXIT_NOTHING_INSIDE = 5,
    PVT_EXIT_LIMIT = 6,
    PVT_EXIT_CANCELLED = 130,
} pvtExitCode;

int pvtGetExitCode(pvtStatus status);

/// The first member of each command's options struct, so that the table below fits all of them.
typedef struct pvtCommonOptions {
    int threads;          ///< 0: one a core
    uint64_t memoryLimit; ///< [bytes] 0: half of the machine's
    int progress;         ///< 0 auto, 1 json, 2 none
    bool quiet, verbose;
} pvtCommonOptions;

/// --threads, --memory-limit, --progress, -q and -v.
extern const pvtOption pvtCommonOptionTable[];
enum { PVT_COMMON_OPTION_COUNT = 5 };

enum { PVT_RUN_MESSAGE_SIZE = 2048 };

typedef struct pvtRun {
    pvtContext* context;
    pvtReport report;
    pvtProgress progress;
    char message[PVT_RUN_MESSAGE_SIZE]; ///< of pvtRun_Fail; else the context's message holds
} pvtRun;

/// Reads the line into `values` (a command's options struct that holds the defaults). True: go on.
/// False: *exitCode is what to return, after the help or the message has been printed.
bool pvtReadCommandLine(const pvtSyntax* syntax, int count, char* const* words, void* values,
                        pvtParsedLine* line, int* exitCode);

/// What a command does with a line that was read; returns the exit code.
typedef int pvtLineFcn(void* values, const pvtParsedLine* line);

/// For commands that take any number of operands: reads the line and runs the command on it.
int pvtRunCommandLine(const pvtSyntax* syntax, int count, char* const* words, void* values,
                      pvtLineFcn* run);

/// Watches the signals and makes the context; what the options leave open is filled in. `run` must
/// stay where it is until pvtEndRun, which is due also on failure.
pvtStatus pvtBeginRun(pvtCommonOptions* options, pvtRun* run);
/// Prints the message of a status that is not PVT_OK, frees, and returns the exit code.
int pvtEndRun(pvtRun* run, pvtStatus status);

/// A failure that the command found itself: `return pvtRun_Fail(run, PVT_INVALID_INPUT, …);`
pvtStatus pvtRun_Fail(pvtRun* run, pvtStatus status, const char* format, ...)
    __attribute__((format(printf, 3, 4)));
/// Adds to the message of a failure, the library's or the command's own: a remedy, a consequence.
void pvtRun_AddToMessage(pvtRun* run, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
/// PVT_CANCELLED when the user has asked to stop; to be asked between steps.
pvtStatus pvtRun_CheckCancelled(pvtRun* run);

/// [bytes] Half of the machine's memory, or of the control group's when that is less.
uint64_t pvtGetDefaultMemoryLimit(void);
/// [bytes] The most memory that the process has had so far; what the context counted when the
/// system does not tell.
uint64_t pvtRun_GetPeakBytes(const pvtRun* run);

#endif
