// SPDX-License-Identifier: MIT
// Outside voxels that are nearly enclosed: from which few of the 26 directions escape.
//
// A direction escapes from a voxel when the next voxel along it is free and escapes too, or lies
// beyond the border. So a sweep against the direction finds it for all voxels, 64 at a time, from
// the slab or the row before. Counts are kept as bit planes and added up with carries.
#include "outside.h"

#include "bit_grid.h"

#include "base/context.h"

#include <string.h>

// Nine directions leave each slab towards either side, eight stay within. The first sweep counts
// the nine towards lower z and the four towards lower y or x, the second sweep the others.
enum { DIRECTIONS_A_SWEEP = 13, ACROSS_SLABS = 9, COUNT_BITS = 4, TOTAL_BITS = 5 };

typedef struct Sweep {
    const pvtBitGrid* inside;
    uint64_t tailMask;
    size_t slabWords;
    uint64_t* escapes[2]; // of the slab before and of this one, ACROSS_SLABS slabs each
    uint64_t* within;     // one slab, for the directions that stay within
    uint64_t* counts;     // COUNT_BITS words for each word of a slab
    uint64_t* openRow;    // all bits set: beyond the border
} Sweep;

// The directions of one sweep; those of the other are the opposites.
static const int directions[DIRECTIONS_A_SWEEP][3] = {
    {-1, -1, -1}, {0, -1, -1}, {1, -1, -1}, {-1, 0, -1}, {0, 0, -1}, {1, 0, -1}, {-1, 1, -1},
    {0, 1, -1},   {1, 1, -1},  {-1, -1, 0}, {0, -1, 0},  {1, -1, 0}, {-1, 0, 0}};

// Adds a bit to each of 64 counters.
static void AddBits(uint64_t* counts, uint64_t bits)
{
    for (int i = 0; i < COUNT_BITS; ++i) {
        const uint64_t carry = counts[i] & bits;
        counts[i] ^= bits;
        bits = carry;
    }
}

// escapes[x] = next[x + dx], where bits beyond either end of `next` are set, for free voxels only.
static void PullRow(const Sweep* sweep, const uint64_t* next, const uint64_t* inside, int dx,
                    uint64_t* escapes)
{
    const size_t count = sweep->inside->wordsPerRow;
    const uint64_t beyond = ~sweep->tailMask;
    for (size_t i = 0; i < count; ++i) {
        const uint64_t here = i + 1 == count ? next[i] | beyond : next[i];
        uint64_t pulled = here;
        if (dx > 0) {
            const uint64_t after = i + 1 == count ? 1 : next[i + 1];
            pulled = here >> 1 | after << 63;
        } else if (dx < 0) {
            pulled = here << 1 | (i == 0 ? 1 : next[i - 1] >> 63);
        }
        escapes[i] = pulled & ~inside[i];
    }
    escapes[count - 1] &= sweep->tailMask;
}

// Within a row each voxel needs its neighbour's answer first: towards lower x, everything below
// the lowest inside voxel escapes; towards higher x, everything above the highest.
static void SweepRow(const Sweep* sweep, const uint64_t* inside, int dx, uint64_t* escapes)
{
    const size_t count = sweep->inside->wordsPerRow;
    bool isOpen = true;
    for (size_t i = 0; i < count; ++i) {
        const size_t word = dx < 0 ? i : count - 1 - i;
        const uint64_t blocked = inside[word];
        uint64_t open = isOpen ? ~UINT64_C(0) : 0;
        if (isOpen && blocked != 0) {
            open = dx < 0 ? pvtMakeMask(0, (unsigned)__builtin_ctzll(blocked))
                          : pvtMakeMask(64 - (unsigned)__builtin_clzll(blocked), 64);
            isOpen = false;
        }
        escapes[word] = open;
    }
    escapes[count - 1] &= sweep->tailMask;
}

static void CountRow(const Sweep* sweep, const uint64_t* escapes, int y)
{
    const size_t count = sweep->inside->wordsPerRow;
    uint64_t* counts = sweep->counts + (size_t)y * count * COUNT_BITS;
    for (size_t i = 0; i < count; ++i) {
        AddBits(counts + i * COUNT_BITS, escapes[i]);
    }
}

// One direction over one slab. `side` is 1 for the sweep's own directions and −1 for opposites.
static void SweepDirection(const Sweep* sweep, int index, int side, int z)
{
    const int height = sweep->inside->frame.size[1];
    const size_t count = sweep->inside->wordsPerRow;
    const int dx = side * directions[index][0];
    const int dy = side * directions[index][1];
    const bool isAcross = index < ACROSS_SLABS;
    const size_t offset = isAcross ? (size_t)index * sweep->slabWords : 0;
    uint64_t* here = isAcross ? sweep->escapes[1] + offset : sweep->within;
    const uint64_t* before = isAcross ? sweep->escapes[0] + offset : sweep->within;
    for (int step = 0; step < height; ++step) {
        const int y = dy <= 0 ? step : height - 1 - step;
        uint64_t* escapes = here + (size_t)y * count;
        const uint64_t* inside = pvtBitGrid_GetRow(sweep->inside, y, z);
        if (!isAcross && dy == 0) {
            SweepRow(sweep, inside, dx, escapes);
        } else {
            const bool isBeyond = y + dy < 0 || y + dy >= height;
            PullRow(sweep, isBeyond ? sweep->openRow : before + (size_t)(y + dy) * count, inside,
                    dx, escapes);
        }
        CountRow(sweep, escapes, y);
    }
}

static void SweepSlab(Sweep* sweep, int side, int z)
{
    memset(sweep->counts, 0, sweep->slabWords * COUNT_BITS * sizeof *sweep->counts);
    for (int index = 0; index < DIRECTIONS_A_SWEEP; ++index) {
        SweepDirection(sweep, index, side, z);
    }
    uint64_t* swapped = sweep->escapes[0];
    sweep->escapes[0] = sweep->escapes[1];
    sweep->escapes[1] = swapped;
}

// 64 counters that hold at most `most`: the sums of two counts, compared from the top bit down.
static uint64_t FindAtMost(const uint64_t* a, const uint64_t* b, int most)
{
    uint64_t sum[TOTAL_BITS];
    uint64_t carry = 0;
    for (int i = 0; i < COUNT_BITS; ++i) {
        sum[i] = a[i] ^ b[i] ^ carry;
        carry = (a[i] & b[i]) | (carry & (a[i] ^ b[i]));
    }
    sum[COUNT_BITS] = carry;
    uint64_t less = 0;
    uint64_t equal = ~UINT64_C(0);
    for (int i = TOTAL_BITS; i-- > 0;) {
        if ((most >> i & 1) != 0) {
            less |= equal & ~sum[i];
            equal &= sum[i];
        } else {
            equal &= ~sum[i];
        }
    }
    return less | equal;
}

static void BeginSweep(Sweep* sweep)
{
    // Beyond the first slab everything escapes.
    memset(sweep->escapes[0], 0xFF, ACROSS_SLABS * sweep->slabWords * sizeof *sweep->openRow);
}

static pvtStatus CountFirst(pvtContext* context, Sweep* sweep, uint64_t* counts)
{
    BeginSweep(sweep);
    const size_t step = sweep->slabWords * COUNT_BITS;
    for (int z = 0; z < sweep->inside->frame.size[2]; ++z) {
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        SweepSlab(sweep, 1, z);
        memcpy(counts + (size_t)z * step, sweep->counts, step * sizeof *counts);
    }
    return PVT_OK;
}

// Leaves in `counts` the words to add to the grid, one in COUNT_BITS, since the sweep still needs
// the grid as it was.
static pvtStatus CountSecond(pvtContext* context, Sweep* sweep, int most, uint64_t* counts)
{
    BeginSweep(sweep);
    const size_t step = sweep->slabWords * COUNT_BITS;
    for (int z = sweep->inside->frame.size[2]; z-- > 0;) {
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        SweepSlab(sweep, -1, z);
        for (size_t i = 0; i < step; i += COUNT_BITS) {
            uint64_t* first = counts + (size_t)z * step + i;
            first[0] = FindAtMost(first, sweep->counts + i, most);
        }
    }
    return PVT_OK;
}

static pvtStatus AllocateSweep(pvtContext* context, const pvtBitGrid* inside, Sweep* sweep)
{
    sweep->inside = inside;
    sweep->tailMask = pvtBitGrid_GetTailMask(inside);
    sweep->slabWords = inside->wordsPerRow * (size_t)inside->frame.size[1];
    const size_t words =
        sweep->slabWords * (2 * ACROSS_SLABS + 1 + COUNT_BITS) + inside->wordsPerRow;
    uint64_t* memory = pvtAllocate(context, words, sizeof *memory);
    if (memory == NULL) {
        return pvtContext_GetStatus(context);
    }
    sweep->escapes[0] = memory;
    sweep->escapes[1] = memory + ACROSS_SLABS * sweep->slabWords;
    sweep->within = memory + 2 * ACROSS_SLABS * sweep->slabWords;
    sweep->counts = sweep->within + sweep->slabWords;
    sweep->openRow = sweep->counts + COUNT_BITS * sweep->slabWords;
    memset(sweep->openRow, 0xFF, inside->wordsPerRow * sizeof *memory);
    return PVT_OK;
}

static void AddFound(const uint64_t* found, pvtBitGrid* inside)
{
    const uint64_t tailMask = pvtBitGrid_GetTailMask(inside);
    for (size_t i = 0; i < inside->wordCount; ++i) {
        const bool isTail = (i + 1) % inside->wordsPerRow == 0;
        inside->words[i] |= found[i * COUNT_BITS] & (isTail ? tailMask : ~UINT64_C(0));
    }
}

pvtStatus pvtFillEnclosed(pvtContext* context, int most, pvtBitGrid* inside)
{
    pvtStatus status =
        pvtCheckGridMemory(context, inside, COUNT_BITS, "looking for enclosed voxels");
    if (status != PVT_OK) {
        return status;
    }
    Sweep sweep = {0};
    uint64_t* memory = NULL;
    status = AllocateSweep(context, inside, &sweep);
    if (status == PVT_OK) {
        memory = sweep.escapes[0];
        uint64_t* counts = pvtAllocate(context, inside->wordCount * COUNT_BITS, sizeof *counts);
        status =
            counts == NULL ? pvtContext_GetStatus(context) : CountFirst(context, &sweep, counts);
        if (status == PVT_OK) {
            status = CountSecond(context, &sweep, most, counts);
        }
        if (status == PVT_OK) {
            AddFound(counts, inside);
        }
        pvtRelease(context, counts);
    }
    pvtRelease(context, memory);
    return status;
}
