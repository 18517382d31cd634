// SPDX-License-Identifier: MIT
// A trail of hashes: one line for each stage of each model.
#ifndef PVT_TEST_TRAIL_H
#define PVT_TEST_TRAIL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { TRAIL_MAX_LINES = 64, TRAIL_NAME_SIZE = 48 };

typedef struct TrailLine {
    char name[TRAIL_NAME_SIZE]; // "boulder voxelize"
    uint64_t hash;
} TrailLine;

typedef struct Trail {
    const char* model; // of the lines to come
    TrailLine lines[TRAIL_MAX_LINES];
    int count;
} Trail;

/// FNV-1a, 64 bits. Start with HASH_START.
#define HASH_START UINT64_C(0xcbf29ce484222325)
uint64_t HashBytes(uint64_t hash, const void* bytes, size_t count);
uint64_t HashNumber(uint64_t hash, uint64_t number);
/// By its bits, with −0 counted as 0.
uint64_t HashDouble(uint64_t hash, double number);
uint64_t HashDoubles(uint64_t hash, const double* numbers, size_t count);

/// Adds the line "MODEL STAGE".
void Trail_Add(Trail* trail, const char* stage, uint64_t hash);
/// False, with the reason on the standard error, when the file cannot be read or written.
bool Trail_Read(Trail* trail, const char* path);
bool Trail_Write(const Trail* trail, const char* path);
/// Prints what differs, the earliest stage first; returns the number of differences.
int Trail_Compare(const Trail* expected, const Trail* found, const char* what);

#endif
