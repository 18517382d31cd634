// SPDX-License-Identifier: MIT
// What people and scripts read on stderr. Warnings are kept, since they are part of the result.
#ifndef PVT_APP_REPORT_H
#define PVT_APP_REPORT_H

#include <paravent/base.h>
#include <pthread.h>
#include <stdio.h>

/// How progress and messages look.
typedef enum pvtReportStyle {
    PVT_REPORT_BAR,   ///< a terminal: a bar that is drawn over
    PVT_REPORT_PLAIN, ///< text without escape codes, a line a stage
    PVT_REPORT_JSON,  ///< every line is a JSON object, messages too
    PVT_REPORT_NONE,  ///< messages only
} pvtReportStyle;

typedef enum pvtReportLevel {
    PVT_REPORT_ERRORS, ///< --quiet
    PVT_REPORT_NORMAL,
    PVT_REPORT_DETAILS, ///< --verbose
} pvtReportLevel;

typedef struct pvtReport {
    FILE* stream;
    pvtReportStyle style;
    pvtReportLevel level;
    pthread_mutex_t lock; ///< the library may log from any thread
    bool isBarShown;
    char** warnings; ///< the first PVT_MAX_WARNINGS of them, each once
    size_t warningCount;
} pvtReport;

enum { PVT_MAX_WARNINGS = 200 };

void pvtBeginReport(pvtReport* report, FILE* stream, pvtReportStyle style, pvtReportLevel level);
void pvtEndReport(pvtReport* report);

/// Printed unless quiet, and kept in any case. A text that was given already is dropped.
void pvtReport_Warn(pvtReport* report, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
/// Always printed. `exitCode` is told in JSON.
void pvtReport_Error(pvtReport* report, int exitCode, const char* format, ...)
    __attribute__((format(printf, 3, 4)));
/// Printed unless quiet.
void pvtReport_Say(pvtReport* report, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
/// Printed when verbose.
void pvtReport_Detail(pvtReport* report, const char* format, ...)
    __attribute__((format(printf, 2, 3)));

/// A line of progress in the report's style; `seconds` since the start.
void pvtReport_ShowProgress(pvtReport* report, const char* stage, double fraction, double seconds);
/// Takes the bar off the terminal.
void pvtReport_ClearBar(pvtReport* report);

/// "871,414"
const char* pvtFormatCount(uint64_t count, char text[32]);

#endif
