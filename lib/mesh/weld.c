// SPDX-License-Identifier: MIT
// Merges equal positions with a hash table of open addressing.
#include "allocate.h"

#include "base/context.h"

#include <string.h>

enum { CANCEL_INTERVAL = 65536 };

// Slots hold 1 + the index of a position of the welded mesh; 0 is free.
typedef struct Table {
    uint32_t* slots;
    size_t mask; // slot count − 1, a power of two with at least half of it free
} Table;

static uint64_t Mix(uint64_t hash, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * UINT64_C(0x9E3779B97F4A7C15);
    return hash ^ (hash >> 29);
}

// Adding 0 turns −0 into 0, so that equal numbers have equal bits.
static uint64_t HashPosition(pvtVec3 p)
{
    const uint64_t hash = Mix(Mix(Mix(0, p.x + 0.0), p.y + 0.0), p.z + 0.0);
    return hash ^ (hash >> 32);
}

static bool IsEqual(pvtVec3 a, pvtVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static uint32_t FindOrAdd(Table* table, pvtMesh* welded, pvtVec3 p)
{
    size_t slot = (size_t)HashPosition(p) & table->mask;
    while (table->slots[slot] != 0) {
        const uint32_t found = table->slots[slot] - 1;
        if (IsEqual(welded->positions[found], p)) {
            return found;
        }
        slot = (slot + 1) & table->mask;
    }
    const uint32_t added = (uint32_t)welded->positionCount++;
    welded->positions[added] = p;
    table->slots[slot] = added + 1;
    return added;
}

static pvtStatus WeldIndices(pvtContext* context, const pvtMesh* mesh, Table* table,
                             pvtMesh* welded)
{
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        if (i % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        welded->indices[i] = FindOrAdd(table, welded, mesh->positions[mesh->indices[i]]);
    }
    welded->triangleCount = mesh->triangleCount;
    return PVT_OK;
}

// Gives back what was reserved for positions that turned out equal.
static pvtStatus ShrinkPositions(pvtContext* context, pvtMesh* welded)
{
    pvtVec3* shrunk =
        pvtReallocate(context, welded->positions, welded->positionCount, sizeof *welded->positions);
    if (shrunk == NULL) {
        return pvtContext_GetStatus(context);
    }
    welded->positions = shrunk;
    return PVT_OK;
}

pvtStatus pvtWeldMesh(pvtContext* context, const pvtMesh* mesh, pvtMesh* welded)
{
    *welded = (pvtMesh){0};
    const size_t corners = 3 * mesh->triangleCount;
    const size_t most = mesh->positionCount < corners ? mesh->positionCount : corners;
    Table table = {NULL, 15};
    while (table.mask + 1 < 2 * most) {
        table.mask = 2 * table.mask + 1;
    }
    table.slots = pvtAllocate(context, table.mask + 1, sizeof *table.slots);
    pvtStatus status = table.slots == NULL
                           ? pvtContext_GetStatus(context)
                           : pvtReserveMesh(context, most, mesh->triangleCount, welded);
    if (status == PVT_OK) {
        status = WeldIndices(context, mesh, &table, welded);
    }
    pvtRelease(context, table.slots);
    if (status == PVT_OK) {
        status = ShrinkPositions(context, welded);
    }
    if (status != PVT_OK) {
        pvtMesh_Free(context, welded);
    }
    return status;
}
