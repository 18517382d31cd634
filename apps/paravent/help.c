// SPDX-License-Identifier: MIT
#include "help.h"

#include "values.h"

#include <string.h>

enum { LINE_WIDTH = 80, TEXT_COLUMN = 30 };

void pvtPrintWrapped(FILE* file, const char* text, int indent, int column)
{
    while (*text != '\0') {
        size_t blanks = strspn(text, " ");
        const size_t length = strcspn(text + blanks, " \n");
        if (column > indent && column + (int)(blanks + length) > LINE_WIDTH) {
            fputc('\n', file);
            column = 0;
            text += blanks;
            blanks = 0;
        }
        if (column < indent) {
            fprintf(file, "%*s", indent - column, "");
            column = indent;
        } else {
            fprintf(file, "%*s", (int)blanks, "");
            column += (int)blanks;
        }
        fwrite(text + blanks, 1, length, file);
        column += (int)length;
        text += blanks + length;
        if (*text == '\n') {
            fputc('\n', file);
            column = 0;
            ++text;
        }
    }
    fputc('\n', file);
}

// "--budget N", "--method planar|paper", "--ground".
static void PrintUse(const pvtOption* option, char* text, size_t size)
{
    size_t used = (size_t)snprintf(text, size, "--%s", option->name);
    if (option->kind == PVT_OPTION_FLAG || used >= size) {
        return;
    }
    if (option->kind != PVT_OPTION_CHOICE) {
        (void)snprintf(text + used, size - used, " %s", option->placeholder);
        return;
    }
    for (size_t i = 0; option->choices[i] != NULL && used < size; ++i) {
        used += (size_t)snprintf(text + used, size - used, "%s%s", i == 0 ? " " : "|",
                                 option->choices[i]);
    }
}

// What is behind the help text: the range or unit of a value, and the default.
static void PrintDetails(const pvtOption* option, const void* defaults, char* text, size_t size)
{
    char range[128] = "";
    char value[64] = "";
    if (option->kind == PVT_OPTION_LENGTH) {
        (void)snprintf(range, sizeof range, "world units, or voxels as in 2vx");
    } else if (option->kind != PVT_OPTION_SIZE) {
        pvtDescribeRange(option, range, sizeof range);
    }
    if (option->defaultText != NULL) {
        (void)snprintf(value, sizeof value, "%s", option->defaultText);
    } else if (option->kind != PVT_OPTION_FLAG) {
        pvtPrintValue(option, (const char*)defaults + option->offset, value, sizeof value);
    }
    const char* between = range[0] != '\0' && value[0] != '\0' ? "; " : "";
    const char* label = value[0] != '\0' ? "default " : "";
    if (range[0] != '\0' || value[0] != '\0') {
        (void)snprintf(text, size, " (%s%s%s%s)", range, between, label, value);
    } else {
        text[0] = '\0';
    }
}

static void PrintOption(FILE* file, const pvtOption* option, const void* defaults)
{
    char use[128];
    char details[384];
    char text[1024];
    PrintUse(option, use, sizeof use);
    PrintDetails(option, defaults, details, sizeof details);
    (void)snprintf(text, sizeof text, "%s%s", option->help, details);
    int column = option->letter != 0 ? fprintf(file, "  -%c, %s", option->letter, use)
                                     : fprintf(file, "      %s", use);
    if (column > TEXT_COLUMN - 2) {
        fputc('\n', file);
        column = 0;
    }
    pvtPrintWrapped(file, text, TEXT_COLUMN, column);
}

void pvtPrintHelp(FILE* file, const pvtSyntax* syntax, const void* defaults)
{
    fprintf(file, "%s %s - %s\n\n", pvtSyntax_GetProgram(syntax), syntax->name, syntax->summary);
    fprintf(file, "Usage: %s %s %s [options]\n\n", pvtSyntax_GetProgram(syntax), syntax->name,
            syntax->operands);
    pvtPrintWrapped(file, syntax->operandHelp, 2, 0);
    for (size_t group = 0; group < syntax->groupCount; ++group) {
        fprintf(file, "\n%s:\n", syntax->groups[group].title);
        for (size_t i = 0; i < syntax->groups[group].count; ++i) {
            PrintOption(file, &syntax->groups[group].options[i], defaults);
        }
    }
    static const pvtOption help = {
        .name = "help", .letter = 'h', .kind = PVT_OPTION_FLAG, .help = "show this and stop"};
    PrintOption(file, &help, defaults);
    if (syntax->notes != NULL) {
        fputc('\n', file);
        pvtPrintWrapped(file, syntax->notes, 0, 0);
    }
}
