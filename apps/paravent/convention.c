// SPDX-License-Identifier: MIT
#include "convention.h"

#include "json.h"

#include <assert.h>
#include <string.h>

void pvtMakeNameHarmless(char* name)
{
    for (; *name != '\0'; ++name) {
        *name = *name == '$' ? '_' : *name;
    }
}

void pvtMakeNodeName(const char* base, int convention, char* name, size_t size)
{
    const bool isGodot = convention == PVT_CONVENTION_GODOT;
    const char* ending = isGodot ? "-occonly" : "_occluder";
    const size_t endingSize = strlen(ending) + 1;
    assert(size > endingSize);
    size_t used = 0;
    while (base[used] != '\0') {
        const size_t step = pvtGetUtf8Length(base + used);
        const size_t length = step > 0 ? step : 1;
        if (used + length + endingSize > size) {
            break;
        }
        memcpy(name + used, base + used, length);
        used += length;
    }
    memcpy(name + used, ending, endingSize);
    if (isGodot) {
        pvtMakeNameHarmless(name);
    }
}
