// SPDX-License-Identifier: MIT
// A JSON writer: valid by construction, the same bytes on every machine.
#ifndef PVT_APP_JSON_H
#define PVT_APP_JSON_H

#include <paravent/output.h>
#include <stdbool.h>
#include <stdint.h>

enum { PVT_JSON_MAX_DEPTH = 32 };

/// Where the bytes go.
typedef void pvtJsonWriteFcn(void* user, const char* bytes, size_t count);

typedef struct pvtJson {
    pvtJsonWriteFcn* write;
    void* user;
    bool isCompact; ///< all on one line
    int depth;
    bool isArray[PVT_JSON_MAX_DEPTH];
    bool isEmpty[PVT_JSON_MAX_DEPTH]; ///< nothing written at this depth yet
} pvtJson;

/// Indented by two blanks, into a file. Begin with an object or array whose key is null; a line
/// feed follows when that one ends.
pvtJson pvtMakeJson(pvtOutput* output);
/// On one line, into a text of at most `size` bytes that stays terminated; what does not fit is cut
/// off, so leave room.
typedef struct pvtJsonText {
    char* text;
    size_t size, used;
} pvtJsonText;
pvtJson pvtMakeJsonLine(pvtJsonText* text);

/// `key` is null within arrays and only there.
void pvtJson_BeginObject(pvtJson* json, const char* key);
void pvtJson_EndObject(pvtJson* json);
void pvtJson_BeginArray(pvtJson* json, const char* key);
void pvtJson_EndArray(pvtJson* json);
/// A number that is not finite becomes null: JSON has no word for it.
void pvtJson_Number(pvtJson* json, const char* key, double number);
void pvtJson_Integer(pvtJson* json, const char* key, int64_t number);
void pvtJson_Bool(pvtJson* json, const char* key, bool value);
/// A null string becomes null. Bytes that are not UTF-8 become U+FFFD.
void pvtJson_String(pvtJson* json, const char* key, const char* text);

/// Bytes of the UTF-8 sequence that `text` begins with, 1 to 4; 0 when it is not valid or ended.
size_t pvtGetUtf8Length(const char* text);
/// Bytes of the character that `text` begins with, at least 1. It is harmless when it is UTF-8 and
/// cannot steer a terminal as the control characters do, of ASCII and of Unicode (U+0080 to
/// U+009F).
size_t pvtMeasureCharacter(const char* text, bool* isHarmless);

#endif
