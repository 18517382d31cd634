// SPDX-License-Identifier: MIT
// Rectangles are counted by their first and last row: within the columns that are set in all rows
// between them, every run of n columns holds Σ k (n + 1 − k) = n (n + 1) (n + 2) / 6 columns of
// rectangles. As rows are added the columns change seldom, and a mask of 64 pixels takes about as
// long as its distance transform.
#include "rectangles.h"

#include <stddef.h>

enum { SIZE = 64 };

// Σ k (n + 1 − k) over the runs of a row.
static uint64_t SumRuns(uint64_t columns)
{
    uint64_t sum = 0;
    while (columns != 0) {
        columns >>= __builtin_ctzll(columns);
        const uint64_t clear = ~columns;
        const unsigned run = clear == 0 ? SIZE : (unsigned)__builtin_ctzll(clear);
        const uint64_t n = run;
        sum += n * (n + 1) * (n + 2) / 6;
        columns = run == SIZE ? 0 : columns >> run;
    }
    return sum;
}

uint64_t pvtSumRectangles(const uint64_t rows[64])
{
    uint64_t total = 0;
    for (size_t first = 0; first < SIZE; ++first) {
        uint64_t columns = rows[first];
        uint64_t sum = SumRuns(columns);
        for (size_t last = first; columns != 0;) {
            total += sum * (last + 1 - first);
            if (++last == SIZE) {
                break;
            }
            const uint64_t rest = columns & rows[last];
            if (rest != columns) {
                columns = rest;
                sum = SumRuns(rest);
            }
        }
    }
    return total;
}
