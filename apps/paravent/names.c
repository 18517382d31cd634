// SPDX-License-Identifier: MIT
#include "judgement.h"

#include <string.h>

int pvtCountTextColumns(const char* text)
{
    int columns = 0;
    for (; *text != '\0'; ++text) {
        columns += ((unsigned char)*text & 0xC0) != 0x80;
    }
    return columns;
}

void pvtShortenName(const char* name, int columns, char* text, size_t size)
{
    size_t used = 0;
    int skipped = pvtCountTextColumns(name) - columns;
    if (skipped > 0) {
        used = (size_t)snprintf(text, size, "…");
        ++skipped;
    }
    while (*name != '\0' && used + 5 < size) {
        bool isHarmless;
        const size_t length = pvtMeasureCharacter(name, &isHarmless);
        if (skipped-- <= 0) {
            memcpy(text + used, isHarmless ? name : "?", isHarmless ? length : 1);
            used += isHarmless ? length : 1;
        }
        name += length;
    }
    text[used] = '\0';
}
