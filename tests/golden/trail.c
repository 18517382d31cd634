// SPDX-License-Identifier: MIT
#include "trail.h"

#include <assert.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

uint64_t HashBytes(uint64_t hash, const void* bytes, size_t count)
{
    const uint8_t* byte = bytes;
    for (size_t i = 0; i < count; ++i) {
        hash = (hash ^ byte[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

uint64_t HashNumber(uint64_t hash, uint64_t number)
{
    return HashBytes(hash, &number, sizeof number);
}

uint64_t HashDouble(uint64_t hash, double number)
{
    const double plain = number == 0.0 ? 0.0 : number;
    return HashBytes(hash, &plain, sizeof plain);
}

uint64_t HashDoubles(uint64_t hash, const double* numbers, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        hash = HashDouble(hash, numbers[i]);
    }
    return hash;
}

void Trail_Add(Trail* trail, const char* stage, uint64_t hash)
{
    assert(trail->count < TRAIL_MAX_LINES);
    TrailLine* line = &trail->lines[trail->count++];
    (void)snprintf(line->name, sizeof line->name, "%s %s", trail->model, stage);
    line->hash = hash;
}

bool Trail_Read(Trail* trail, const char* path)
{
    trail->count = 0;
    FILE* file = fopen(path, "r");
    if (file == NULL) {
        perror(path);
        return false;
    }
    char model[24], stage[24];
    uint64_t hash;
    while (trail->count < TRAIL_MAX_LINES &&
           fscanf(file, "%23s %23s %" SCNx64, model, stage, &hash) == 3) {
        trail->model = model;
        Trail_Add(trail, stage, hash);
    }
    trail->model = NULL;
    return fclose(file) == 0;
}

bool Trail_Write(const Trail* trail, const char* path)
{
    FILE* file = fopen(path, "w");
    if (file == NULL) {
        perror(path);
        return false;
    }
    for (int i = 0; i < trail->count; ++i) {
        (void)fprintf(file, "%s %016" PRIx64 "\n", trail->lines[i].name, trail->lines[i].hash);
    }
    return fclose(file) == 0;
}

static const TrailLine* FindLine(const Trail* trail, const char* name)
{
    for (int i = 0; i < trail->count; ++i) {
        if (strcmp(trail->lines[i].name, name) == 0) {
            return &trail->lines[i];
        }
    }
    return NULL;
}

int Trail_Compare(const Trail* expected, const Trail* found, const char* what)
{
    int differences = 0;
    for (int i = 0; i < found->count; ++i) {
        const TrailLine* line = &found->lines[i];
        const TrailLine* other = FindLine(expected, line->name);
        if (other == NULL || other->hash != line->hash) {
            (void)fprintf(stderr, "%s: %s is %016" PRIx64 ", expected %016" PRIx64 "\n", what,
                          line->name, line->hash, other != NULL ? other->hash : 0);
            ++differences;
        }
    }
    for (int i = 0; i < expected->count; ++i) {
        if (FindLine(found, expected->lines[i].name) == NULL) {
            (void)fprintf(stderr, "%s: %s is missing\n", what, expected->lines[i].name);
            ++differences;
        }
    }
    return differences;
}
