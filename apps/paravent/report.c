// SPDX-License-Identifier: MIT
#include "report.h"

#include "json.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 4096, BAR_WIDTH = 30 };

void pvtBeginReport(pvtReport* report, FILE* stream, pvtReportStyle style, pvtReportLevel level)
{
    *report = (pvtReport){.stream = stream, .style = style, .level = level};
    pthread_mutex_init(&report->lock, NULL);
}

void pvtEndReport(pvtReport* report)
{
    pvtReport_ClearBar(report);
    for (size_t i = 0; i < report->warningCount; ++i) {
        free(report->warnings[i]);
    }
    free(report->warnings);
    pthread_mutex_destroy(&report->lock);
    *report = (pvtReport){0};
}

static void ClearBarLocked(pvtReport* report)
{
    if (report->isBarShown) {
        fputs("\r\033[K", report->stream);
        report->isBarShown = false;
    }
}

void pvtReport_ClearBar(pvtReport* report)
{
    pthread_mutex_lock(&report->lock);
    ClearBarLocked(report);
    fflush(report->stream);
    pthread_mutex_unlock(&report->lock);
}

// A text from a file may hold anything; a terminal must not be steered by it.
static void PrintHarmless(FILE* stream, const char* text)
{
    while (*text != '\0') {
        bool isHarmless;
        const size_t length = pvtMeasureCharacter(text, &isHarmless);
        if (isHarmless || *text == '\n' || *text == '\t') {
            fwrite(text, 1, length, stream);
        } else {
            fputc('?', stream);
        }
        text += length;
    }
}

// One message: a line for people with `prefix` before it, or an object. exitCode < 0: none.
static void PrintMessage(pvtReport* report, const char* level, const char* prefix, int exitCode,
                         const char* text)
{
    if (report->style == PVT_REPORT_JSON) {
        char line[2 * LINE_SIZE];
        pvtJsonText target = {line, sizeof line, 0};
        pvtJson json = pvtMakeJsonLine(&target);
        pvtJson_BeginObject(&json, NULL);
        pvtJson_String(&json, "level", level);
        pvtJson_String(&json, "text", text);
        if (exitCode >= 0) {
            pvtJson_Integer(&json, "exit", exitCode);
        }
        pvtJson_EndObject(&json);
        fputs(line, report->stream);
    } else {
        ClearBarLocked(report);
        fputs(prefix, report->stream);
        PrintHarmless(report->stream, text);
        fputc('\n', report->stream);
    }
    fflush(report->stream);
}

// False when it was there already, or cannot be kept.
static bool KeepWarning(pvtReport* report, const char* text)
{
    for (size_t i = 0; i < report->warningCount; ++i) {
        if (strcmp(report->warnings[i], text) == 0) {
            return false;
        }
    }
    if (report->warningCount == PVT_MAX_WARNINGS) {
        return false;
    }
    if (report->warnings == NULL) {
        report->warnings = calloc(PVT_MAX_WARNINGS, sizeof *report->warnings);
    }
    char* copy = report->warnings != NULL ? strdup(text) : NULL;
    if (copy == NULL) {
        return false;
    }
    report->warnings[report->warningCount++] = copy;
    return true;
}

void pvtReport_Warn(pvtReport* report, const char* format, ...)
{
    char text[LINE_SIZE / 2];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pthread_mutex_lock(&report->lock);
    if (KeepWarning(report, text) && report->level != PVT_REPORT_ERRORS) {
        PrintMessage(report, "warning", "paravent: warning: ", -1, text);
    }
    pthread_mutex_unlock(&report->lock);
}

void pvtReport_Error(pvtReport* report, int exitCode, const char* format, ...)
{
    char text[LINE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    pthread_mutex_lock(&report->lock);
    PrintMessage(report, "error", "paravent: ", exitCode, text);
    pthread_mutex_unlock(&report->lock);
}

static void PrintAtLevel(pvtReport* report, pvtReportLevel least, const char* format,
                         va_list arguments)
{
    if (report->level < least) {
        return;
    }
    char text[LINE_SIZE];
    (void)vsnprintf(text, sizeof text, format, arguments);
    pthread_mutex_lock(&report->lock);
    PrintMessage(report, least == PVT_REPORT_NORMAL ? "info" : "detail", "", -1, text);
    pthread_mutex_unlock(&report->lock);
}

void pvtReport_Say(pvtReport* report, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    PrintAtLevel(report, PVT_REPORT_NORMAL, format, arguments);
    va_end(arguments);
}

void pvtReport_Detail(pvtReport* report, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    PrintAtLevel(report, PVT_REPORT_DETAILS, format, arguments);
    va_end(arguments);
}

static void PrintProgressObject(FILE* stream, const char* stage, double fraction, double seconds)
{
    char line[512];
    pvtJsonText target = {line, sizeof line, 0};
    pvtJson json = pvtMakeJsonLine(&target);
    pvtJson_BeginObject(&json, NULL);
    pvtJson_String(&json, "stage", stage);
    pvtJson_Number(&json, "fraction", round(fraction * 1e4) / 1e4);
    pvtJson_Number(&json, "seconds", round(seconds * 1e3) / 1e3);
    pvtJson_EndObject(&json);
    fputs(line, stream);
}

static void DrawBar(FILE* stream, const char* stage, double fraction)
{
    static const char full[] = "##############################";
    static const char rest[] = "..............................";
    const int filled = (int)(fraction * BAR_WIDTH);
    fprintf(stream, "\r%-12.24s [%.*s%.*s] %3d %%\033[K", stage, filled, full, BAR_WIDTH - filled,
            rest, (int)(fraction * 100.0));
}

void pvtReport_ShowProgress(pvtReport* report, const char* stage, double fraction, double seconds)
{
    fraction = fraction < 0.0 ? 0.0 : fraction > 1.0 ? 1.0 : fraction;
    pthread_mutex_lock(&report->lock);
    switch (report->style) {
    case PVT_REPORT_BAR:
        DrawBar(report->stream, stage, fraction);
        report->isBarShown = true;
        break;
    case PVT_REPORT_PLAIN:
        fprintf(report->stream, "%7.1f s  %s %d %%\n", seconds, stage, (int)(fraction * 100.0));
        break;
    case PVT_REPORT_JSON:
        PrintProgressObject(report->stream, stage, fraction, seconds);
        break;
    case PVT_REPORT_NONE:
        break;
    }
    fflush(report->stream);
    pthread_mutex_unlock(&report->lock);
}

const char* pvtFormatCount(uint64_t count, char text[32])
{
    char digits[32];
    const int length = snprintf(digits, sizeof digits, "%" PRIu64, count);
    int used = 0;
    for (int i = 0; i < length; ++i) {
        if (i > 0 && (length - i) % 3 == 0) {
            text[used++] = ',';
        }
        text[used++] = digits[i];
    }
    text[used] = '\0';
    return text;
}
