// SPDX-License-Identifier: MIT
// Files for tests of readers and writers: a folder of their own, bytes packed by hand, GLB.
#ifndef PVT_TEST_FILES_H
#define PVT_TEST_FILES_H

#include "failures.h"
#include "warnings.h"

#include <dirent.h>
#include <math.h>
#include <paravent/io.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct TestFolder {
    char path[64];
} TestFolder;

static inline TestFolder MakeTestFolder(void)
{
    TestFolder folder = {"/tmp/pvt-test-XXXXXX"};
    assert_non_null(mkdtemp(folder.path));
    return folder;
}

/// "FOLDER/name", good until the next but three calls.
static inline const char* InFolder(const TestFolder* folder, const char* name)
{
    static char paths[4][512];
    static int next;
    char* path = paths[next++ % 4];
    (void)snprintf(path, sizeof paths[0], "%s/%s", folder->path, name);
    return path;
}

/// Removes the folder and the files in it; returns how many there were.
static inline int RemoveTestFolder(const TestFolder* folder)
{
    int count = 0;
    DIR* listing = opendir(folder->path);
    assert_non_null(listing);
    for (const struct dirent* entry = readdir(listing); entry != NULL; entry = readdir(listing)) {
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) {
            ++count;
            assert_int_equal(unlink(InFolder(folder, entry->d_name)), 0);
        }
    }
    closedir(listing);
    assert_int_equal(rmdir(folder->path), 0);
    return count;
}

static inline void WriteBytes(const char* path, const void* bytes, size_t size)
{
    FILE* file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static inline void WriteText(const char* path, const char* text)
{
    WriteBytes(path, text, strlen(text));
}

/// Fails unless the last message holds `part`.
static inline void CheckMessage(const pvtContext* context, const char* part)
{
    if (strstr(pvtContext_GetMessage(context), part) == NULL) {
        fail_msg("\"%s\" does not hold \"%s\"", pvtContext_GetMessage(context), part);
    }
}

/// Bytes one behind the other, such as a binary chunk.
typedef struct Pack {
    uint8_t bytes[1 << 16];
    size_t size;
} Pack;

static inline void PackBytes(Pack* pack, const void* bytes, size_t size)
{
    assert_true(pack->size + size <= sizeof pack->bytes);
    memcpy(pack->bytes + pack->size, bytes, size);
    pack->size += size;
}

static inline void PackU32(Pack* pack, uint32_t value)
{
    PackBytes(pack, &value, sizeof value);
}

static inline void PackPadding(Pack* pack, uint8_t value)
{
    while (pack->size % 4 != 0) {
        PackBytes(pack, &value, 1);
    }
}

/// `text` with double quotes for single ones, so that JSON can be read in C. Freed by the caller.
static inline char* MakeJson(const char* text)
{
    char* json = strdup(text);
    assert_non_null(json);
    for (char* c = json; *c != '\0'; ++c) {
        *c = *c == '\'' ? '"' : *c;
    }
    return json;
}

/// A GLB of this JSON and, if it is not null, this binary chunk.
static inline void PackGlb(Pack* glb, const char* json, const Pack* binary)
{
    const size_t jsonSize = (strlen(json) + 3) / 4 * 4;
    const size_t binarySize = binary != NULL ? (binary->size + 3) / 4 * 4 : 0;
    glb->size = 0;
    PackBytes(glb, "glTF", 4);
    PackU32(glb, 2);
    PackU32(glb, (uint32_t)(20 + jsonSize + (binary != NULL ? 8 + binarySize : 0)));
    PackU32(glb, (uint32_t)jsonSize);
    PackBytes(glb, "JSON", 4);
    PackBytes(glb, json, strlen(json));
    PackPadding(glb, ' ');
    if (binary != NULL) {
        PackU32(glb, (uint32_t)binarySize);
        PackBytes(glb, "BIN\0", 4);
        PackBytes(glb, binary->bytes, binary->size);
        PackPadding(glb, 0);
    }
}

static inline void WriteGlb(const char* path, const char* json, const Pack* binary)
{
    Pack* glb = calloc(1, sizeof *glb);
    assert_non_null(glb);
    char* text = MakeJson(json);
    PackGlb(glb, text, binary);
    WriteBytes(path, glb->bytes, glb->size);
    free(text);
    free(glb);
}

/// A cube from 0 to 1, wound outwards.
static const float kCubePositions[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                           {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
static const uint16_t kCubeIndices[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                          2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

/// Six times the signed volume around the origin, over 6: positive when wound outwards.
static inline double GetSignedVolume(const pvtMesh* mesh)
{
    double sum = 0.0;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const pvtVec3 a = mesh->positions[mesh->indices[3 * t]];
        const pvtVec3 b = mesh->positions[mesh->indices[3 * t + 1]];
        const pvtVec3 c = mesh->positions[mesh->indices[3 * t + 2]];
        sum += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) +
               a.z * (b.x * c.y - b.y * c.x);
    }
    return sum / 6.0;
}

static inline void CheckBounds(const pvtMesh* mesh, pvtVec3 lower, pvtVec3 upper, double error)
{
    pvtVec3 least = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, most = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        const pvtVec3 p = mesh->positions[mesh->indices[i]];
        least = (pvtVec3){fmin(least.x, p.x), fmin(least.y, p.y), fmin(least.z, p.z)};
        most = (pvtVec3){fmax(most.x, p.x), fmax(most.y, p.y), fmax(most.z, p.z)};
    }
    CHECK_NEAR(least.x, lower.x, error);
    CHECK_NEAR(least.y, lower.y, error);
    CHECK_NEAR(least.z, lower.z, error);
    CHECK_NEAR(most.x, upper.x, error);
    CHECK_NEAR(most.y, upper.y, error);
    CHECK_NEAR(most.z, upper.z, error);
}

#endif
