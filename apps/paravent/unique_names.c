// SPDX-License-Identifier: MIT
#include "unique_names.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Entry {
    const char* name;
    size_t index;
} Entry;

static int CompareEntries(const void* left, const void* right)
{
    const Entry* a = left;
    const Entry* b = right;
    const int order = strcmp(a->name, b->name);
    return order != 0 ? order : a->index < b->index ? -1 : a->index > b->index ? 1 : 0;
}

static int CompareWithName(const void* key, const void* element)
{
    return strcmp(key, ((const Entry*)element)->name);
}

static bool IsTaken(const Entry* entries, size_t count, const char* name)
{
    return bsearch(name, entries, count, sizeof *entries, CompareWithName) != NULL;
}

// Equal names lie together, in the order of their nodes. A number behind an underscore belongs to
// one name only, so that what is made up for one never meets what is made up for another.
static bool NameAll(const Entry* entries, size_t count, char** unique)
{
    unsigned long long number = 1;
    for (size_t i = 0; i < count; ++i) {
        const Entry* entry = &entries[i];
        const size_t size = strlen(entry->name) + 24;
        char* name = malloc(size);
        if (name == NULL) {
            return false;
        }
        unique[entry->index] = name;
        if (i == 0 || strcmp(entry->name, entries[i - 1].name) != 0) {
            number = 1;
            (void)snprintf(name, size, "%s", entry->name);
            continue;
        }
        do {
            (void)snprintf(name, size, "%s_%llu", entry->name, ++number);
        } while (IsTaken(entries, count, name));
    }
    return true;
}

char** pvtMakeUniqueNames(const char* const* names, size_t count)
{
    Entry* entries = calloc(count + 1, sizeof *entries);
    char** unique = calloc(count + 1, sizeof *unique);
    bool isDone = entries != NULL && unique != NULL;
    if (isDone) {
        for (size_t i = 0; i < count; ++i) {
            const bool isEmpty = names[i] == NULL || names[i][0] == '\0';
            entries[i] = (Entry){isEmpty ? "node" : names[i], i};
        }
        qsort(entries, count, sizeof *entries, CompareEntries);
        isDone = NameAll(entries, count, unique);
    }
    free(entries);
    if (!isDone) {
        pvtFreeUniqueNames(unique, count);
        return NULL;
    }
    return unique;
}

void pvtFreeUniqueNames(char** names, size_t count)
{
    for (size_t i = 0; names != NULL && i < count; ++i) {
        free(names[i]);
    }
    free(names);
}
