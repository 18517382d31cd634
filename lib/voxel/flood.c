// SPDX-License-Identifier: MIT
// A flood fill over rows of bits.
//
// Scanline fills (Smith, "Tint fill", 1979) keep a stack of spans. Here a row of voxels is the
// unit: a row takes over what its four neighbours have reached and spreads it along x, 64 voxels
// a step, by letting a carry run through the free bits. Rows whose neighbours changed are noted
// in a bit map, which is swept forwards and backwards in turn, so that open space is done in two
// sweeps and a maze costs its changed rows only.
#include "flood.h"

#include "bit_grid.h"

#include "base/context.h"

enum { CANCEL_INTERVAL = 16 };

typedef struct Flood {
    const pvtBitGrid* blocked;
    pvtBitGrid* reached;
    uint64_t tailMask;
    uint64_t* pending;   // one bit a row, each z begins a new word
    size_t wordsPerSlab; // of `pending`
} Flood;

// Where a row lies; a border row's missing neighbour is the row itself.
typedef struct RowView {
    uint64_t* reached;
    const uint64_t* blocked;
    const uint64_t* near[4];
} RowView;

static void MarkPending(Flood* flood, int y, int z)
{
    const int* size = flood->blocked->frame.size;
    if (y >= 0 && z >= 0 && y < size[1] && z < size[2]) {
        pvtSetBit(flood->pending + (size_t)z * flood->wordsPerSlab, (size_t)y);
    }
}

static RowView ViewRow(const Flood* flood, int y, int z)
{
    const int* size = flood->blocked->frame.size;
    pvtBitGrid* reached = flood->reached;
    return (RowView){.reached = pvtBitGrid_GetRow(reached, y, z),
                     .blocked = pvtBitGrid_GetRow(flood->blocked, y, z),
                     .near = {pvtBitGrid_GetRow(reached, y > 0 ? y - 1 : y, z),
                              pvtBitGrid_GetRow(reached, y < size[1] - 1 ? y + 1 : y, z),
                              pvtBitGrid_GetRow(reached, y, z > 0 ? z - 1 : z),
                              pvtBitGrid_GetRow(reached, y, z < size[2] - 1 ? z + 1 : z)}};
}

// Spreads towards lower bits, by doubling steps within the word.
static uint64_t SpreadDown(uint64_t seeds, uint64_t free)
{
    for (int step = 1; step < 64; step *= 2) {
        seeds |= free & (seeds >> step);
        free &= free >> step;
    }
    return seeds;
}

// Takes over the neighbours' bits and lets them run towards higher x. Adding the seeds to the
// free bits sends a carry from each seed to the end of its run; the bits it cleared are reached.
static uint64_t GatherAndSpreadUp(const RowView* row, size_t count, uint64_t tailMask)
{
    uint64_t changes = 0;
    uint64_t carry = 0;
    for (size_t i = 0; i < count; ++i) {
        const uint64_t free = ~row->blocked[i] & (i + 1 == count ? tailMask : ~UINT64_C(0));
        const uint64_t near = row->near[0][i] | row->near[1][i] | row->near[2][i] | row->near[3][i];
        const uint64_t seeds = (row->reached[i] | near) & free;
        const uint64_t once = free + seeds;
        const uint64_t twice = once + carry;
        carry = (once < free) | (twice < once);
        const uint64_t spread = seeds | (free & ~twice);
        changes |= spread ^ row->reached[i];
        row->reached[i] = spread;
    }
    return changes;
}

static uint64_t SpreadRowDown(const RowView* row, size_t count, uint64_t tailMask)
{
    uint64_t changes = 0;
    uint64_t carry = 0;
    for (size_t i = count; i-- > 0;) {
        const uint64_t free = ~row->blocked[i] & (i + 1 == count ? tailMask : ~UINT64_C(0));
        const uint64_t seeds = row->reached[i] | (carry << 63 & free);
        if (seeds != 0 && seeds != free) {
            const uint64_t spread = SpreadDown(seeds, free);
            changes |= spread ^ row->reached[i];
            row->reached[i] = spread;
        } else {
            changes |= seeds ^ row->reached[i];
            row->reached[i] = seeds;
        }
        carry = row->reached[i] & 1;
    }
    return changes;
}

static void UpdateRow(Flood* flood, int y, int z)
{
    const size_t count = flood->blocked->wordsPerRow;
    const RowView row = ViewRow(flood, y, z);
    const uint64_t changes = GatherAndSpreadUp(&row, count, flood->tailMask);
    if ((changes | SpreadRowDown(&row, count, flood->tailMask)) != 0) {
        MarkPending(flood, y - 1, z);
        MarkPending(flood, y + 1, z);
        MarkPending(flood, y, z - 1);
        MarkPending(flood, y, z + 1);
    }
}

// Updates the pending rows of a slab with rising y. Rows noted behind wait for the way back.
static bool SweepSlabUp(Flood* flood, int z)
{
    uint64_t* pending = flood->pending + (size_t)z * flood->wordsPerSlab;
    bool any = false;
    for (size_t i = 0; i < flood->wordsPerSlab; ++i) {
        uint64_t ahead = ~UINT64_C(0);
        while ((pending[i] & ahead) != 0) {
            const unsigned bit = (unsigned)__builtin_ctzll(pending[i] & ahead);
            pending[i] &= ~(UINT64_C(1) << bit);
            UpdateRow(flood, (int)(i * 64 + bit), z);
            ahead = pvtMakeMask(bit + 1, 64);
            any = true;
        }
    }
    return any;
}

static bool SweepSlabDown(Flood* flood, int z)
{
    uint64_t* pending = flood->pending + (size_t)z * flood->wordsPerSlab;
    bool any = false;
    for (size_t i = flood->wordsPerSlab; i-- > 0;) {
        uint64_t ahead = ~UINT64_C(0);
        while ((pending[i] & ahead) != 0) {
            const unsigned bit = 63 - (unsigned)__builtin_clzll(pending[i] & ahead);
            pending[i] &= ~(UINT64_C(1) << bit);
            UpdateRow(flood, (int)(i * 64 + bit), z);
            ahead = pvtMakeMask(0, bit);
            any = true;
        }
    }
    return any;
}

static pvtStatus SweepToTheEnd(pvtContext* context, Flood* flood)
{
    const int depth = flood->blocked->frame.size[2];
    for (bool any = true; any;) {
        any = false;
        for (int step = 0; step < 2 * depth; ++step) {
            if (step % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
                return pvtFailCancelled(context);
            }
            any |= step < depth ? SweepSlabUp(flood, step)
                                : SweepSlabDown(flood, 2 * depth - 1 - step);
        }
    }
    return PVT_OK;
}

// Free voxels of the border are reached, and every row has yet to be looked at.
static pvtStatus Seed(pvtContext* context, Flood* flood)
{
    const int* size = flood->blocked->frame.size;
    const size_t count = flood->blocked->wordsPerRow;
    const size_t lastBit = (size_t)size[0] - 1;
    for (int z = 0; z < size[2]; ++z) {
        if (z % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        for (int y = 0; y < size[1]; ++y) {
            const uint64_t* blocked = pvtBitGrid_GetRow(flood->blocked, y, z);
            uint64_t* reached = pvtBitGrid_GetRow(flood->reached, y, z);
            if (y == 0 || z == 0 || y == size[1] - 1 || z == size[2] - 1) {
                for (size_t i = 0; i < count; ++i) {
                    reached[i] = ~blocked[i];
                }
                reached[count - 1] &= flood->tailMask;
            } else {
                reached[0] |= ~blocked[0] & 1;
                reached[count - 1] |= ~blocked[count - 1] & (UINT64_C(1) << (lastBit & 63));
            }
            MarkPending(flood, y, z);
        }
    }
    return PVT_OK;
}

pvtStatus pvtFloodFromBorder(pvtContext* context, const pvtBitGrid* blocked, pvtBitGrid* reached)
{
    Flood flood = {.blocked = blocked, .reached = reached};
    flood.tailMask = pvtBitGrid_GetTailMask(blocked);
    flood.wordsPerSlab = pvtGetWordCount((size_t)blocked->frame.size[1]);
    flood.pending = pvtAllocate(context, flood.wordsPerSlab * (size_t)blocked->frame.size[2],
                                sizeof *flood.pending);
    if (flood.pending == NULL) {
        return pvtContext_GetStatus(context);
    }
    pvtStatus status = Seed(context, &flood);
    if (status == PVT_OK) {
        status = SweepToTheEnd(context, &flood);
    }
    pvtRelease(context, flood.pending);
    return status;
}
