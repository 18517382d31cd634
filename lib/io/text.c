// SPDX-License-Identifier: MIT
#include "text.h"

#include "base/context.h"

#include <string.h>
#include <strings.h>

// How many bytes the well-formed UTF-8 character at `text` has; 0 when there is none. Overlong
// forms, surrogates and everything past U+10FFFF are not well-formed (Unicode, table 3-7).
static size_t MeasureCharacter(const unsigned char* text)
{
    const unsigned char first = text[0];
    if (first < 0x80) {
        return 1;
    }
    const size_t length = first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    if (first < 0xc2 || first > 0xf4) {
        return 0;
    }
    const unsigned char low = first == 0xe0 ? 0xa0 : first == 0xf0 ? 0x90 : 0x80;
    const unsigned char high = first == 0xed ? 0x9f : first == 0xf4 ? 0x8f : 0xbf;
    if (text[1] < low || text[1] > high) {
        return 0;
    }
    // A byte that continues nothing ends the loop, the terminating zero as well.
    for (size_t i = 2; i < length; ++i) {
        if ((text[i] & 0xc0) != 0x80) {
            return 0;
        }
    }
    return length;
}

// C0, DEL and C1: what a terminal could take for a command.
static bool IsControl(const unsigned char* text, size_t length)
{
    return (length == 1 && (text[0] < 0x20 || text[0] == 0x7f)) ||
           (length == 2 && text[0] == 0xc2 && text[1] < 0xa0);
}

// Copies as many whole characters as `room` bytes take, and a zero behind them; returns how much of
// `text` was used.
static size_t CleanInto(const char* text, char* out, size_t room)
{
    const unsigned char* in = (const unsigned char*)text;
    size_t used = 0, written = 0;
    while (in[used] != 0) {
        const size_t length = MeasureCharacter(in + used);
        const bool kept = length > 0 && !IsControl(in + used, length);
        const size_t size = kept ? length : 1;
        if (written + size > room) {
            break;
        }
        memcpy(out + written, kept ? text + used : "?", size);
        written += size;
        used += length > 0 ? length : 1;
    }
    out[written] = '\0';
    return used;
}

char* pvtCopyCleanText(pvtContext* context, const char* text)
{
    const size_t length = strlen(text);
    char* copy = pvtAllocate(context, length + 1, 1);
    if (copy != NULL) {
        (void)CleanInto(text, copy, length);
    }
    return copy;
}

const char* pvtCleanText(const char* text, char* buffer, size_t size)
{
    static const char dots[] = "...";
    const size_t room = size - sizeof dots;
    if (text[CleanInto(text, buffer, room)] != '\0') {
        memcpy(buffer + strlen(buffer), dots, sizeof dots);
    }
    return buffer;
}

const char* pvtCleanName(const char* text, char buffer[PVT_NAME_SIZE])
{
    return pvtCleanText(text, buffer, PVT_NAME_SIZE);
}

bool pvtHasEnding(const char* path, const char* ending)
{
    const size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}
