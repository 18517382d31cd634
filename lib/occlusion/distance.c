// SPDX-License-Identifier: MIT
// Exact Euclidean distance transform of small bit masks.
//
// Separable, after Saito and Toriwaki, New Algorithms for Euclidean Distance Transformation of an
// n-Dimensional Digitized Picture, 1994. The first pass counts along columns, all columns of a row
// at once. The second takes min over dx of column(x ± dx)² + dx², also for a whole block of pixels
// at once, and ends when dx² reaches the largest value left. Everything is an integer, so that any
// vector width gives the same result. The paper floods on the GPU instead (Rong and Tan, 2006).
#include "distance.h"

#include "base/bits.h"
#include "base/vectors.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    BLOCK = 32, // pixels relaxed together
};

size_t pvtGetDistanceTableCount(int size)
{
    return (size_t)(size / 2) * (size_t)(size / 2) + 1;
}

void pvtFillDistanceTable(int size, int exponent, uint32_t* table)
{
    assert(exponent >= 1 && exponent <= 3);
    const size_t count = pvtGetDistanceTableCount(size);
    for (size_t squared = 0; squared < count; ++squared) {
        // Roots and products only: they are the same on every machine, unlike pow.
        const double distance = sqrt((double)squared);
        const double worth = exponent == 1   ? distance
                             : exponent == 2 ? (double)squared
                                             : distance * (double)squared;
        table[squared] = (uint32_t)lrint(256.0 * worth);
    }
}

PVT_VECTOR_CLONES
static void CountDown(uint8_t* restrict row, const uint8_t* restrict above, int size)
{
    for (int x = 0; x < size; ++x) {
        // 255 stands for more: the other border is nearer then.
        const int next = above[x] + (above[x] < 255 ? 1 : 0);
        row[x] = (uint8_t)(next & row[x]);
    }
}

PVT_VECTOR_CLONES
static void CountUp(uint8_t* restrict row, const uint8_t* restrict below, int size)
{
    for (int x = 0; x < size; ++x) {
        const uint8_t next = (uint8_t)(below[x] + 1);
        row[x] = next < row[x] ? next : row[x];
    }
}

void pvtTransformMaskColumns(const uint64_t* rows, int size, uint8_t* columns)
{
    assert(size == 64 || size == 128 || size == 256);
    const uint8_t clear[PVT_MAX_MASK_SIZE] = {0};
    const size_t words = (size_t)size / 64;
    const uint8_t* above = clear;
    for (int y = 0; y < size; ++y) {
        uint8_t* row = columns + (size_t)y * (size_t)size;
        for (size_t byte = 0; byte < words * 8; ++byte) {
            const uint64_t word = rows[(size_t)y * words + byte / 8];
            const uint64_t spread = 255 * pvtSpreadBits((word >> (byte % 8 * 8)) & 255);
            memcpy(row + byte * 8, &spread, 8);
        }
        CountDown(row, above, size);
        above = row;
    }
    const uint8_t* below = clear;
    for (int y = size - 1; y >= 0; --y) {
        uint8_t* row = columns + (size_t)y * (size_t)size;
        CountUp(row, below, size);
        below = row;
    }
}

PVT_VECTOR_CLONES
static void RelaxBlock(const int16_t* squares, int16_t* restrict block)
{
    int limit = 0;
    for (int i = 0; i < BLOCK; ++i) {
        block[i] = squares[i];
        limit = block[i] > limit ? block[i] : limit;
    }
    for (int dx = 1; dx * dx < limit; ++dx) {
        const int16_t added = (int16_t)(dx * dx);
        const int16_t* left = squares - dx;
        const int16_t* right = squares + dx;
        for (int i = 0; i < BLOCK; ++i) {
            const int16_t least = left[i] < right[i] ? left[i] : right[i];
            const int16_t there = (int16_t)(least + added);
            block[i] = there < block[i] ? there : block[i];
        }
        if ((dx & 3) == 0) {
            int16_t most = 0;
            for (int i = 0; i < BLOCK; ++i) {
                most = block[i] > most ? block[i] : most;
            }
            limit = most;
        }
    }
}

PVT_VECTOR_CLONES
static void SquareRow(const uint8_t* restrict columnRow, int size, int16_t* restrict squares)
{
    for (int x = 0; x < size; ++x) {
        squares[x] = (int16_t)(columnRow[x] * columnRow[x]);
    }
}

// Squared distances of a row. The squares lie between free space as wide as the farthest clear
// pixel, so that x ± dx needs no test: outside is clear, hence 0.
static void TransformRow(const uint8_t* columnRow, int size, int16_t* distances)
{
    int16_t squares[2 * PVT_MAX_MASK_SIZE];
    const int pad = size / 2;
    memset(squares, 0, (size_t)pad * sizeof *squares);
    memset(squares + pad + size, 0, (size_t)pad * sizeof *squares);
    SquareRow(columnRow, size, squares + pad);
    for (int x = 0; x < size; x += BLOCK) {
        RelaxBlock(squares + pad + x, distances + x);
    }
}

// Four at a time, read as one word: they were stored as vectors just before.
static uint64_t SumTable(const int16_t* distances, int count, const uint32_t* table)
{
    uint64_t sums[4] = {0};
    for (int x = 0; x < count; x += 4) {
        uint64_t four;
        memcpy(&four, distances + x, sizeof four);
        sums[0] += table[four & 0xFFFF];
        sums[1] += table[four >> 16 & 0xFFFF];
        sums[2] += table[four >> 32 & 0xFFFF];
        sums[3] += table[four >> 48];
    }
    return sums[0] + sums[1] + sums[2] + sums[3];
}

void pvtSumMaskRow(const uint8_t* columnRow, int size, const uint32_t* table, uint64_t sums[2])
{
    int16_t distances[PVT_MAX_MASK_SIZE];
    TransformRow(columnRow, size, distances);
    sums[0] = SumTable(distances, size / 2, table);
    sums[1] = SumTable(distances + size / 2, size / 2, table);
}

uint64_t pvtSumDistances(const uint64_t* rows, int size, const uint32_t* table)
{
    uint8_t columns[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE];
    pvtTransformMaskColumns(rows, size, columns);
    const size_t words = (size_t)size / 64;
    uint64_t sum = 0;
    for (int y = 0; y < size; ++y) {
        uint64_t any = 0;
        for (size_t word = 0; word < words; ++word) {
            any |= rows[(size_t)y * words + word];
        }
        if (any != 0) {
            uint64_t halves[2];
            pvtSumMaskRow(columns + (size_t)y * (size_t)size, size, table, halves);
            sum += halves[0] + halves[1];
        }
    }
    return sum;
}

void pvtTransformDistance(const uint64_t* rows, int size, uint16_t* distances)
{
    uint8_t columns[PVT_MAX_MASK_SIZE * PVT_MAX_MASK_SIZE];
    pvtTransformMaskColumns(rows, size, columns);
    for (int y = 0; y < size; ++y) {
        int16_t row[PVT_MAX_MASK_SIZE];
        TransformRow(columns + (size_t)y * (size_t)size, size, row);
        for (int x = 0; x < size; ++x) {
            distances[(size_t)y * (size_t)size + (size_t)x] = (uint16_t)row[x];
        }
    }
}
