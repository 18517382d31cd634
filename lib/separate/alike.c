// SPDX-License-Identifier: MIT
// Meshes that are the same: exporters write one for each node that has it.
#include "groups.h"

#include "base/context.h"

#include <stdlib.h>
#include <string.h>

typedef struct Print {
    uint64_t hash;
    size_t mesh;
} Print;

// Glenn Fowler, Landon Curt Noll, Kiem-Phong Vo: FNV-1a, eight bytes at a time.
static uint64_t Mix(uint64_t hash, const void* bytes, size_t size)
{
    const uint8_t* at = bytes;
    for (size_t i = 0; i + 8 <= size; i += 8) {
        uint64_t word;
        memcpy(&word, at + i, sizeof word);
        hash = (hash ^ word) * UINT64_C(0x100000001B3);
        hash ^= hash >> 29;
    }
    for (size_t i = size / 8 * 8; i < size; ++i) {
        hash = (hash ^ at[i]) * UINT64_C(0x100000001B3);
    }
    return hash;
}

static size_t GetPositionBytes(const pvtMesh* mesh)
{
    return mesh->positionCount * sizeof *mesh->positions;
}

static size_t GetIndexBytes(const pvtMesh* mesh)
{
    return 3 * mesh->triangleCount * sizeof *mesh->indices;
}

static bool IsAlike(const pvtMesh* a, const pvtMesh* b)
{
    return a->positionCount == b->positionCount && a->triangleCount == b->triangleCount &&
           (a->triangleCount == 0 ||
            (memcmp(a->positions, b->positions, GetPositionBytes(a)) == 0 &&
             memcmp(a->indices, b->indices, GetIndexBytes(a)) == 0));
}

static int ComparePrints(const void* left, const void* right)
{
    const Print* a = left;
    const Print* b = right;
    if (a->hash != b->hash) {
        return a->hash < b->hash ? -1 : 1;
    }
    return a->mesh < b->mesh ? -1 : a->mesh > b->mesh ? 1 : 0;
}

pvtStatus pvtFindAlikeMeshes(pvtContext* context, const pvtInstanceSet* set, const bool* isUsed,
                             size_t* canonical)
{
    Print* prints = pvtAllocate(context, set->meshCount, sizeof *prints);
    if (prints == NULL) {
        return pvtContext_GetStatus(context);
    }
    size_t count = 0;
    for (size_t i = 0; i < set->meshCount; ++i) {
        canonical[i] = i;
        if (isUsed[i]) {
            const pvtMesh* mesh = &set->meshes[i];
            const uint64_t hash = Mix(mesh->triangleCount, mesh->positions, GetPositionBytes(mesh));
            prints[count++] = (Print){Mix(hash, mesh->indices, GetIndexBytes(mesh)), i};
        }
        if (pvtIsCancelled(context)) {
            pvtRelease(context, prints);
            return pvtFailCancelled(context);
        }
    }
    if (count > 0) {
        qsort(prints, count, sizeof *prints, ComparePrints);
    }
    for (size_t i = 1; i < count; ++i) {
        const size_t before = canonical[prints[i - 1].mesh];
        const size_t mesh = prints[i].mesh;
        if (prints[i].hash == prints[i - 1].hash &&
            IsAlike(&set->meshes[before], &set->meshes[mesh])) {
            canonical[mesh] = before;
        }
    }
    pvtRelease(context, prints);
    return PVT_OK;
}
