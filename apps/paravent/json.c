// SPDX-License-Identifier: MIT
#include "json.h"

#include "values.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static void WriteToOutput(void* user, const char* bytes, size_t count)
{
    pvtOutput_Write(user, bytes, count);
}

static void WriteToText(void* user, const char* bytes, size_t count)
{
    pvtJsonText* text = user;
    const size_t room = text->size - 1 - text->used;
    const size_t taken = count < room ? count : room;
    memcpy(text->text + text->used, bytes, taken);
    text->used += taken;
    text->text[text->used] = '\0';
}

pvtJson pvtMakeJson(pvtOutput* output)
{
    return (pvtJson){.write = WriteToOutput, .user = output};
}

pvtJson pvtMakeJsonLine(pvtJsonText* text)
{
    text->used = 0;
    text->text[0] = '\0';
    return (pvtJson){.write = WriteToText, .user = text, .isCompact = true};
}

static void Put(pvtJson* json, const char* text)
{
    json->write(json->user, text, strlen(text));
}

size_t pvtGetUtf8Length(const char* text)
{
    const unsigned char* bytes = (const unsigned char*)text;
    if (bytes[0] == 0 || (bytes[0] >= 0x80 && bytes[0] < 0xC2) || bytes[0] > 0xF4) {
        return 0;
    }
    const size_t length = bytes[0] < 0x80 ? 1 : bytes[0] < 0xE0 ? 2 : bytes[0] < 0xF0 ? 3 : 4;
    for (size_t i = 1; i < length; ++i) {
        if ((bytes[i] & 0xC0) != 0x80) {
            return 0;
        }
    }
    // Overlong forms, surrogates, and what lies past U+10FFFF.
    const bool isBad =
        (bytes[0] == 0xE0 && bytes[1] < 0xA0) || (bytes[0] == 0xED && bytes[1] > 0x9F) ||
        (bytes[0] == 0xF0 && bytes[1] < 0x90) || (bytes[0] == 0xF4 && bytes[1] > 0x8F);
    return isBad ? 0 : length;
}

size_t pvtMeasureCharacter(const char* text, bool* isHarmless)
{
    const unsigned char* bytes = (const unsigned char*)text;
    const bool isControl =
        bytes[0] < 0x20 || bytes[0] == 0x7F || (bytes[0] == 0xC2 && bytes[1] < 0xA0);
    const size_t length = pvtGetUtf8Length(text);
    *isHarmless = length > 0 && !isControl;
    return length > 0 ? length : 1;
}

static void PutEscaped(pvtJson* json, const char* text)
{
    Put(json, "\"");
    while (*text != '\0') {
        const size_t length = pvtGetUtf8Length(text);
        char escape[8];
        if (length == 0) {
            Put(json, "\xEF\xBF\xBD");
            ++text;
            continue;
        }
        if (*text == '"' || *text == '\\') {
            (void)snprintf(escape, sizeof escape, "\\%c", *text);
            Put(json, escape);
        } else if (*text == '\n') {
            Put(json, "\\n");
        } else if ((unsigned char)*text < 0x20 || *text == 0x7F) {
            (void)snprintf(escape, sizeof escape, "\\u%04x", (unsigned)*text);
            Put(json, escape);
        } else {
            json->write(json->user, text, length);
        }
        text += length;
    }
    Put(json, "\"");
}

static void BreakLine(pvtJson* json)
{
    if (json->isCompact) {
        return;
    }
    Put(json, "\n");
    for (int i = 0; i < json->depth; ++i) {
        Put(json, "  ");
    }
}

// What stands before a value: the comma behind the one before it, the place, the key.
static void BeginValue(pvtJson* json, const char* key)
{
    if (json->depth == 0) {
        assert(key == NULL);
        return;
    }
    const int level = json->depth - 1;
    assert((key == NULL) == json->isArray[level]);
    if (!json->isEmpty[level]) {
        Put(json, ",");
    }
    json->isEmpty[level] = false;
    BreakLine(json);
    if (key != NULL) {
        PutEscaped(json, key);
        Put(json, json->isCompact ? ":" : ": ");
    }
}

static void BeginNest(pvtJson* json, const char* key, bool isArray)
{
    BeginValue(json, key);
    assert(json->depth < PVT_JSON_MAX_DEPTH);
    json->isArray[json->depth] = isArray;
    json->isEmpty[json->depth] = true;
    ++json->depth;
    Put(json, isArray ? "[" : "{");
}

static void EndNest(pvtJson* json, bool isArray)
{
    assert(json->depth > 0 && json->isArray[json->depth - 1] == isArray);
    --json->depth;
    if (!json->isEmpty[json->depth]) {
        BreakLine(json);
    }
    Put(json, isArray ? "]" : "}");
    if (json->depth == 0) {
        Put(json, "\n");
    }
}

void pvtJson_BeginObject(pvtJson* json, const char* key)
{
    BeginNest(json, key, false);
}

void pvtJson_EndObject(pvtJson* json)
{
    EndNest(json, false);
}

void pvtJson_BeginArray(pvtJson* json, const char* key)
{
    BeginNest(json, key, true);
}

void pvtJson_EndArray(pvtJson* json)
{
    EndNest(json, true);
}

void pvtJson_Number(pvtJson* json, const char* key, double number)
{
    BeginValue(json, key);
    if (!isfinite(number)) {
        Put(json, "null");
        return;
    }
    char text[32];
    pvtPrintNumber(number, text);
    Put(json, text);
}

void pvtJson_Integer(pvtJson* json, const char* key, int64_t number)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%lld", (long long)number);
    BeginValue(json, key);
    Put(json, text);
}

void pvtJson_Bool(pvtJson* json, const char* key, bool value)
{
    BeginValue(json, key);
    Put(json, value ? "true" : "false");
}

void pvtJson_String(pvtJson* json, const char* key, const char* text)
{
    BeginValue(json, key);
    if (text == NULL) {
        Put(json, "null");
        return;
    }
    PutEscaped(json, text);
}
