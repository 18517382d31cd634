// SPDX-License-Identifier: MIT
// Rows of bits in 64-bit words, lowest bit first.
#ifndef PVT_BASE_BITS_H
#define PVT_BASE_BITS_H

#include <assert.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline size_t pvtGetWordCount(size_t bits)
{
    return (bits + 63) / 64;
}

static inline bool pvtGetBit(const uint64_t* row, size_t bit)
{
    return (row[bit >> 6] >> (bit & 63)) & 1;
}

static inline void pvtSetBit(uint64_t* row, size_t bit)
{
    row[bit >> 6] |= UINT64_C(1) << (bit & 63);
}

static inline void pvtClearBit(uint64_t* row, size_t bit)
{
    row[bit >> 6] &= ~(UINT64_C(1) << (bit & 63));
}

/// The bits from `begin` to `end` − 1 of one word, 0 ≤ begin ≤ end ≤ 64.
static inline uint64_t pvtMakeMask(unsigned begin, unsigned end)
{
    assert(begin <= end && end <= 64);
    const uint64_t below = end == 64 ? ~UINT64_C(0) : (UINT64_C(1) << end) - 1;
    return begin == 64 ? 0 : below & (~UINT64_C(0) << begin);
}

static inline int pvtCountBits(uint64_t word)
{
#ifdef __POPCNT__
    return __builtin_popcountll(word);
#else
    // Sums of ever wider fields (Warren, Hacker's Delight, 2nd edition 2012, section 5-1): without
    // the instruction, compilers would call a function.
    word -= word >> 1 & UINT64_C(0x5555555555555555);
    word = (word & UINT64_C(0x3333333333333333)) + (word >> 2 & UINT64_C(0x3333333333333333));
    word = (word + (word >> 4)) & UINT64_C(0x0F0F0F0F0F0F0F0F);
    return (int)(word * UINT64_C(0x0101010101010101) >> 56);
#endif
}

/// Eight bits to eight bytes of 0 or 1, lowest first.
static inline uint64_t pvtSpreadBits(uint64_t bits)
{
    const uint64_t ones = UINT64_C(0x0101010101010101);
    const uint64_t picked = (bits * ones) & UINT64_C(0x8040201008040201);
    // A byte that is not 0 carries into its top bit.
    const uint64_t top =
        ((picked & UINT64_C(0x7f7f7f7f7f7f7f7f)) + UINT64_C(0x7f7f7f7f7f7f7f7f)) | picked;
    return (top >> 7) & ones;
}

/// Eight bytes of 0 or 1 to eight bits, lowest first.
static inline uint64_t pvtPackBytes(uint64_t bytes)
{
    // Each byte's own multiple brings it to its place in the highest byte, and no two meet.
    return (bytes * UINT64_C(0x0102040810204080)) >> 56;
}

/// The bits of 64 bytes of 0 or 1, lowest first.
static inline uint64_t pvtPackWord(const uint8_t bytes[64])
{
    uint64_t word = 0;
    for (unsigned i = 0; i < 8; ++i) {
        uint64_t eight;
        memcpy(&eight, bytes + 8 * (size_t)i, sizeof eight);
        word |= pvtPackBytes(eight) << (8 * i);
    }
    return word;
}

/// Sets the bits from `begin` to `end` − 1 of a row; none when end ≤ begin.
static inline void pvtSetBitRange(uint64_t* row, size_t begin, size_t end)
{
    while (begin < end) {
        const size_t word = begin >> 6;
        const size_t stop = (word + 1) * 64 < end ? (word + 1) * 64 : end;
        row[word] |= pvtMakeMask((unsigned)(begin & 63), (unsigned)(stop - word * 64));
        begin = stop;
    }
}

/// True when all bits from `begin` to `end` − 1 are set.
static inline bool pvtIsBitRangeSet(const uint64_t* row, size_t begin, size_t end)
{
    while (begin < end) {
        const size_t word = begin >> 6;
        const size_t stop = (word + 1) * 64 < end ? (word + 1) * 64 : end;
        const uint64_t mask = pvtMakeMask((unsigned)(begin & 63), (unsigned)(stop - word * 64));
        if ((row[word] & mask) != mask) {
            return false;
        }
        begin = stop;
    }
    return true;
}

#endif
