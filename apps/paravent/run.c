// SPDX-License-Identifier: MIT
#include "run.h"

#include "cancel.h"
#include "help.h"

#include <assert.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char* const progressChoices[] = {"auto", "json", "none", NULL};

const pvtOption pvtCommonOptionTable[] = {
    {.name = "threads",
     .kind = PVT_OPTION_INT,
     .offset = offsetof(pvtCommonOptions, threads),
     .placeholder = "N",
     .least = 1,
     .most = 64,
     .defaultText = "one a core",
     .help = "threads to work on; the result never depends on it"},
    {.name = "memory-limit",
     .kind = PVT_OPTION_SIZE,
     .offset = offsetof(pvtCommonOptions, memoryLimit),
     .placeholder = "SIZE",
     .least = 1 << 20,
     .most = 0x1p50,
     .defaultText = "half of the machine's memory",
     .help = "stop rather than hold more; M is 2^20 bytes, MB is 10^6"},
    {.name = "progress",
     .kind = PVT_OPTION_CHOICE,
     .offset = offsetof(pvtCommonOptions, progress),
     .choices = progressChoices,
     .help =
         "auto: a bar on a terminal, now and then a line of text elsewhere; json: all of stderr "
         "is one JSON object a line"},
    {.name = "quiet",
     .letter = 'q',
     .kind = PVT_OPTION_FLAG,
     .offset = offsetof(pvtCommonOptions, quiet),
     .help = "say nothing but errors"},
    {.name = "verbose",
     .letter = 'v',
     .kind = PVT_OPTION_FLAG,
     .offset = offsetof(pvtCommonOptions, verbose),
     .help = "tell more about each step"},
};

_Static_assert(sizeof pvtCommonOptionTable / sizeof *pvtCommonOptionTable ==
                   PVT_COMMON_OPTION_COUNT,
               "the count in run.h follows the table");

int pvtGetExitCode(pvtStatus status)
{
    switch (status) {
    case PVT_OK:
        return PVT_EXIT_DONE;
    case PVT_INVALID_ARGUMENT:
        return PVT_EXIT_USAGE;
    case PVT_INVALID_INPUT:
        return PVT_EXIT_INPUT;
    case PVT_UNSUPPORTED:
        return PVT_EXIT_UNSUPPORTED;
    case PVT_OUTPUT_FAILED:
        return PVT_EXIT_OUTPUT;
    case PVT_NOTHING_INSIDE:
        return PVT_EXIT_NOTHING_INSIDE;
    case PVT_LIMIT:
    case PVT_OUT_OF_MEMORY:
        return PVT_EXIT_LIMIT;
    case PVT_CANCELLED:
        return PVT_EXIT_CANCELLED;
    }
    return PVT_EXIT_USAGE;
}

bool pvtReadCommandLine(const pvtSyntax* syntax, int count, char* const* words, void* values,
                        pvtParsedLine* line, int* exitCode)
{
    // The help tells the defaults, which the words before --help must not change.
    for (int i = 0; i < count && strcmp(words[i], "--") != 0; ++i) {
        if (strcmp(words[i], "--help") == 0 || strcmp(words[i], "-h") == 0) {
            pvtPrintHelp(stdout, syntax, values);
            *exitCode = fflush(stdout) == 0 ? PVT_EXIT_DONE : PVT_EXIT_OUTPUT;
            return false;
        }
    }
    if (!pvtParseLine(syntax, count, words, values, line)) {
        fprintf(stderr, "%s %s: %s\n", pvtSyntax_GetProgram(syntax), syntax->name, line->message);
        *exitCode = PVT_EXIT_USAGE;
        return false;
    }
    return true;
}

int pvtRunCommandLine(const pvtSyntax* syntax, int count, char* const* words, void* values,
                      pvtLineFcn* run)
{
    const char** operands = calloc((size_t)count + 1, sizeof *operands);
    if (operands == NULL) {
        fprintf(stderr, "%s %s: out of memory\n", pvtSyntax_GetProgram(syntax), syntax->name);
        return PVT_EXIT_LIMIT;
    }
    pvtParsedLine line = {.operands = operands};
    int exitCode = PVT_EXIT_DONE;
    if (pvtReadCommandLine(syntax, count, words, values, &line, &exitCode)) {
        exitCode = run(values, &line);
    }
    free(operands);
    return exitCode;
}

static void TakeLog(pvtLogLevel level, const char* text, void* user)
{
    pvtRun* run = user;
    if (level == PVT_LOG_WARNING) {
        pvtReport_Warn(&run->report, "%s", text);
    } else {
        pvtReport_Detail(&run->report, "%s", text);
    }
}

static void TakeProgress(const char* stage, double fraction, void* user)
{
    pvtRun* run = user;
    pvtProgress_Update(&run->progress, stage, fraction);
}

static bool IsCancelled(void* user)
{
    (void)user;
    return pvtIsStopRequested();
}

static pvtReportStyle ChooseStyle(const pvtCommonOptions* options)
{
    if (options->progress == 1) {
        return PVT_REPORT_JSON;
    }
    if (options->progress == 2 || options->quiet) {
        return PVT_REPORT_NONE;
    }
    const char* terminal = getenv("TERM");
    const bool canDraw =
        isatty(STDERR_FILENO) != 0 && terminal != NULL && strcmp(terminal, "dumb") != 0;
    return canDraw ? PVT_REPORT_BAR : PVT_REPORT_PLAIN;
}

pvtStatus pvtBeginRun(pvtCommonOptions* options, pvtRun* run)
{
    *run = (pvtRun){0};
    const pvtReportLevel level = options->verbose ? PVT_REPORT_DETAILS
                                 : options->quiet ? PVT_REPORT_ERRORS
                                                  : PVT_REPORT_NORMAL;
    pvtBeginReport(&run->report, stderr, ChooseStyle(options), level);
    run->progress = pvtBeginProgress(&run->report);
    pvtWatchSignals();
    if (options->memoryLimit == 0) {
        options->memoryLimit = pvtGetDefaultMemoryLimit();
    }
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = options->threads;
    def.memoryLimit = options->memoryLimit;
    def.log = TakeLog;
    def.progress = TakeProgress;
    def.isCancelled = IsCancelled;
    def.user = run;
    const pvtStatus status = pvtCreateContext(&def, &run->context);
    if (status != PVT_OK) {
        return pvtRun_Fail(run, status, "the run cannot begin: %s", pvtGetStatusName(status));
    }
    options->threads = pvtContext_GetThreadCount(run->context);
    return PVT_OK;
}

int pvtEndRun(pvtRun* run, pvtStatus status)
{
    const int exitCode = pvtGetExitCode(status);
    if (status != PVT_OK) {
        const char* text = run->message;
        if (text[0] == '\0' && run->context != NULL) {
            text = pvtContext_GetMessage(run->context);
        }
        if (text[0] == '\0') {
            text = pvtGetStatusName(status);
        }
        pvtReport_Error(&run->report, exitCode, "%s", text);
    }
    pvtDestroyContext(run->context);
    run->context = NULL;
    pvtEndReport(&run->report);
    return exitCode;
}

pvtStatus pvtRun_Fail(pvtRun* run, pvtStatus status, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(run->message, sizeof run->message, format, arguments);
    va_end(arguments);
    return status;
}

void pvtRun_AddToMessage(pvtRun* run, const char* format, ...)
{
    if (run->message[0] == '\0') {
        (void)snprintf(run->message, sizeof run->message, "%s",
                       pvtContext_GetMessage(run->context));
    }
    const size_t used = strlen(run->message);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(run->message + used, sizeof run->message - used, format, arguments);
    va_end(arguments);
}

pvtStatus pvtRun_CheckCancelled(pvtRun* run)
{
    return pvtIsStopRequested() ? pvtRun_Fail(run, PVT_CANCELLED, "cancelled") : PVT_OK;
}

// The first number of a small file, such as a limit that the kernel tells; 0 without one.
static uint64_t ReadNumberFile(const char* path, const char* lineStart)
{
    FILE* file = fopen(path, "r");
    if (file == NULL) {
        return 0;
    }
    char line[256];
    uint64_t number = 0;
    const size_t length = strlen(lineStart);
    while (number == 0 && fgets(line, sizeof line, file) != NULL) {
        if (strncmp(line, lineStart, length) == 0) {
            number = strtoull(line + length, NULL, 10);
        }
    }
    fclose(file);
    return number;
}

uint64_t pvtGetDefaultMemoryLimit(void)
{
    const long pages = sysconf(_SC_PHYS_PAGES);
    const long pageSize = sysconf(_SC_PAGE_SIZE);
    uint64_t bytes =
        pages > 0 && pageSize > 0 ? (uint64_t)pages * (uint64_t)pageSize : UINT64_C(4) << 30;
    const uint64_t group = ReadNumberFile("/sys/fs/cgroup/memory.max", "");
    if (group != 0 && group < bytes) {
        bytes = group;
    }
    return bytes / 2;
}

uint64_t pvtRun_GetPeakBytes(const pvtRun* run)
{
    // Unlike getrusage, this does not count what the process was before it became this program.
    const uint64_t kilobytes = ReadNumberFile("/proc/self/status", "VmHWM:");
    return kilobytes != 0 ? kilobytes * 1024 : pvtContext_GetPeakBytes(run->context);
}
