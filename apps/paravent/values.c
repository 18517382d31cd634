// SPDX-License-Identifier: MIT
#include "values.h"

#include <assert.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// The largest integer up to which doubles, and so readers of JSON, hold every one.
#define LARGEST_COUNT 9007199254740991.0

// The locale's decimal point, which strtod and printf go by when a library has set a locale.
static char GetDecimalPoint(void)
{
    return localeconv()->decimal_point[0];
}

bool pvtReadNumber(const char* text, double* number)
{
    char copy[64];
    const size_t length = strlen(text);
    if (length == 0 || length >= sizeof copy || strspn(text, "0123456789+-.eE") != length) {
        return false;
    }
    memcpy(copy, text, length + 1);
    char* point = strchr(copy, '.');
    if (point != NULL) {
        *point = GetDecimalPoint();
    }
    char* end = NULL;
    const double value = strtod(copy, &end);
    if (end != copy + length || !isfinite(value)) {
        return false;
    }
    *number = value;
    return true;
}

void pvtPrintNumber(double number, char text[32])
{
    for (int digits = 15; digits <= 17; ++digits) {
        (void)snprintf(text, 32, "%.*g", digits, number);
        if (strtod(text, NULL) == number) {
            break;
        }
    }
    char* point = strchr(text, GetDecimalPoint());
    if (point != NULL) {
        *point = '.';
    }
}

static bool IsInRange(const pvtOption* option, double value)
{
    if (option->least >= option->most) {
        return true;
    }
    return value <= option->most &&
           (option->isLeastExcluded ? value > option->least : value >= option->least);
}

static bool ReadInteger(const char* text, double* value)
{
    const size_t sign = text[0] == '-' || text[0] == '+' ? 1 : 0;
    const size_t digits = strspn(text + sign, "0123456789");
    return digits > 0 && text[sign + digits] == '\0' && pvtReadNumber(text, value);
}

// Splits "12.5vx" into its number and what is behind it.
static bool SplitNumber(const char* text, double* value, const char** suffix)
{
    char copy[64];
    const size_t length = strspn(text, "0123456789+-.");
    if (length == 0 || length >= sizeof copy) {
        return false;
    }
    // An exponent belongs to the number only when digits follow: 1e3, but not the E of 1EB.
    size_t end = length;
    if ((text[end] == 'e' || text[end] == 'E') && strspn(text + end + 1, "0123456789+-") > 0) {
        end += 1 + strspn(text + end + 1, "0123456789+-");
    }
    if (end >= sizeof copy) {
        return false;
    }
    memcpy(copy, text, end);
    copy[end] = '\0';
    *suffix = text + end;
    return pvtReadNumber(copy, value);
}

static bool ReadLength(const char* text, pvtLength* length)
{
    const char* suffix = NULL;
    double value = 0.0;
    if (!SplitNumber(text, &value, &suffix) || (suffix[0] != '\0' && strcmp(suffix, "vx") != 0)) {
        return false;
    }
    *length = (pvtLength){value, suffix[0] != '\0'};
    return true;
}

static bool ReadSize(const char* text, double* bytes)
{
    static const char prefixes[] = "KMGT";
    const char* suffix = NULL;
    if (!SplitNumber(text, bytes, &suffix)) {
        return false;
    }
    if (suffix[0] == '\0' || strcmp(suffix, "B") == 0) {
        return true;
    }
    const char letter = suffix[0] == 'k' ? 'K' : suffix[0];
    const char* prefix = strchr(prefixes, letter);
    if (prefix == NULL) {
        return false;
    }
    const bool isDecimal = strcmp(suffix + 1, "B") == 0;
    if (!isDecimal && suffix[1] != '\0' && strcmp(suffix + 1, "iB") != 0) {
        return false;
    }
    *bytes *= pow(isDecimal ? 1000.0 : 1024.0, (double)(prefix - prefixes + 1));
    return true;
}

static bool ReadChoice(const pvtOption* option, const char* text, int* choice)
{
    for (int i = 0; option->choices[i] != NULL; ++i) {
        if (strcmp(option->choices[i], text) == 0) {
            *choice = i;
            return true;
        }
    }
    return false;
}

// Numbers of all kinds, checked against the range and stored.
static bool StoreNumber(const pvtOption* option, double value, void* field)
{
    if (!IsInRange(option, value)) {
        return false;
    }
    if (option->kind == PVT_OPTION_INT) {
        *(int*)field = (int)value;
    } else if (option->kind == PVT_OPTION_DOUBLE) {
        *(double*)field = value;
    } else if (value < 0.0 || value > LARGEST_COUNT) {
        return false;
    } else {
        *(uint64_t*)field = (uint64_t)value;
    }
    return true;
}

static bool ReadAnyNumber(const pvtOption* option, const char* text, double* value)
{
    switch (option->kind) {
    case PVT_OPTION_DOUBLE:
        return pvtReadNumber(text, value);
    case PVT_OPTION_SIZE:
        return ReadSize(text, value);
    default:
        return ReadInteger(text, value);
    }
}

static bool ReadField(const pvtOption* option, const char* text, void* field)
{
    double value = 0.0;
    pvtLength length = {0};
    switch (option->kind) {
    case PVT_OPTION_LENGTH:
        if (!ReadLength(text, &length) || !IsInRange(option, length.value)) {
            return false;
        }
        *(pvtLength*)field = length;
        return true;
    case PVT_OPTION_CHOICE:
        return ReadChoice(option, text, field);
    case PVT_OPTION_TEXT:
        *(const char**)field = text;
        return true;
    default:
        return ReadAnyNumber(option, text, &value) && StoreNumber(option, value, field);
    }
}

bool pvtReadValue(const pvtOption* option, const char* text, void* field, char* message,
                  size_t messageSize)
{
    assert(option->kind != PVT_OPTION_FLAG);
    if (ReadField(option, text, field)) {
        return true;
    }
    char wanted[256];
    pvtDescribeValue(option, wanted, sizeof wanted);
    if (option->kind == PVT_OPTION_CHOICE) {
        const char* similar = pvtFindSimilarWord(text, option->choices);
        if (similar != NULL) {
            (void)snprintf(message, messageSize, "--%s %s: did you mean %s? It takes %s",
                           option->name, text, similar, wanted);
            return false;
        }
    }
    (void)snprintf(message, messageSize, "--%s %s: it takes %s", option->name, text, wanted);
    return false;
}

static void PrintBound(const pvtOption* option, double value, char text[32])
{
    if (option->kind == PVT_OPTION_SIZE) {
        const uint64_t bytes = (uint64_t)value;
        pvtPrintValue(option, &bytes, text, 32);
    } else {
        pvtPrintNumber(value, text);
    }
}

void pvtDescribeRange(const pvtOption* option, char* text, size_t size)
{
    text[0] = '\0';
    if (option->least >= option->most) {
        return;
    }
    char least[32];
    char most[32];
    PrintBound(option, option->least, least);
    if (!isfinite(option->most) || option->most >= LARGEST_COUNT) {
        (void)snprintf(text, size, option->isLeastExcluded ? "above %s" : "%s or more", least);
        return;
    }
    PrintBound(option, option->most, most);
    (void)snprintf(text, size, option->isLeastExcluded ? "above %s up to %s" : "%s to %s", least,
                   most);
}

static void DescribeChoices(const pvtOption* option, char* text, size_t size)
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; option->choices[i] != NULL && used < size; ++i) {
        const bool isLast = option->choices[i + 1] == NULL;
        const char* between = i == 0 ? "" : isLast ? " or " : ", ";
        used += (size_t)snprintf(text + used, size - used, "%s%s", between, option->choices[i]);
    }
}

void pvtDescribeValue(const pvtOption* option, char* text, size_t size)
{
    char range[128] = ", ";
    pvtDescribeRange(option, range + 2, sizeof range - 2);
    if (range[2] == '\0') {
        range[0] = '\0';
    }
    switch (option->kind) {
    case PVT_OPTION_FLAG:
        (void)snprintf(text, size, "no value");
        break;
    case PVT_OPTION_INT:
    case PVT_OPTION_COUNT:
        (void)snprintf(text, size, "a whole number%s", range);
        break;
    case PVT_OPTION_DOUBLE:
        (void)snprintf(text, size, "a number%s", range);
        break;
    case PVT_OPTION_LENGTH:
        (void)snprintf(text, size, "a length%s, in world units or, with the suffix vx, in voxels",
                       range);
        break;
    case PVT_OPTION_SIZE:
        (void)snprintf(text, size, "a size such as 512M or 2G%s", range);
        break;
    case PVT_OPTION_CHOICE:
        DescribeChoices(option, text, size);
        break;
    case PVT_OPTION_TEXT:
        (void)snprintf(text, size, "%s", option->placeholder);
        break;
    }
}

static void PrintSize(uint64_t bytes, char* text, size_t size)
{
    static const char prefixes[] = "KMGT";
    int prefix = -1;
    while (bytes >= 1024 && bytes % 1024 == 0 && prefix < 3) {
        bytes /= 1024;
        ++prefix;
    }
    (void)snprintf(text, size, "%llu%.*s", (unsigned long long)bytes, prefix >= 0 ? 1 : 0,
                   prefixes + (prefix >= 0 ? prefix : 0));
}

void pvtPrintValue(const pvtOption* option, const void* field, char* text, size_t size)
{
    char number[32];
    switch (option->kind) {
    case PVT_OPTION_FLAG:
        (void)snprintf(text, size, "%s", *(const bool*)field ? "on" : "off");
        break;
    case PVT_OPTION_INT:
        (void)snprintf(text, size, "%d", *(const int*)field);
        break;
    case PVT_OPTION_COUNT:
        (void)snprintf(text, size, "%llu", (unsigned long long)*(const uint64_t*)field);
        break;
    case PVT_OPTION_DOUBLE:
        pvtPrintNumber(*(const double*)field, number);
        (void)snprintf(text, size, "%s", number);
        break;
    case PVT_OPTION_LENGTH:
        pvtPrintNumber(((const pvtLength*)field)->value, number);
        (void)snprintf(text, size, "%s%s", number, ((const pvtLength*)field)->inVoxels ? "vx" : "");
        break;
    case PVT_OPTION_SIZE:
        PrintSize(*(const uint64_t*)field, text, size);
        break;
    case PVT_OPTION_CHOICE:
        (void)snprintf(text, size, "%s", option->choices[*(const int*)field]);
        break;
    case PVT_OPTION_TEXT: {
        const char* value = *(const char* const*)field;
        (void)snprintf(text, size, "%s", value != NULL ? value : "");
        break;
    }
    }
}
