// SPDX-License-Identifier: MIT
// PCG32 (O'Neill, 2014): small, seedable, the same numbers on every machine.
#ifndef PVT_BASE_RANDOM_H
#define PVT_BASE_RANDOM_H

#include <stdint.h>

typedef struct pvtRandom {
    uint64_t state, increment;
} pvtRandom;

static inline uint32_t pvtRandom_Next(pvtRandom* random)
{
    const uint64_t old = random->state;
    random->state = old * UINT64_C(6364136223846793005) + random->increment;
    const uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27);
    const uint32_t turn = (uint32_t)(old >> 59);
    return (shifted >> turn) | (shifted << ((32 - turn) & 31));
}

/// Streams of one seed are independent of each other.
static inline pvtRandom pvtMakeRandom(uint64_t seed, uint64_t stream)
{
    pvtRandom random = {0, (stream << 1) | 1};
    pvtRandom_Next(&random);
    random.state += seed;
    pvtRandom_Next(&random);
    return random;
}

/// 0 to bound − 1, evenly enough for sampling: the bias is below bound / 2³².
static inline uint32_t pvtRandom_Below(pvtRandom* random, uint32_t bound)
{
    return (uint32_t)(((uint64_t)pvtRandom_Next(random) * bound) >> 32);
}

/// In [0, 1).
static inline double pvtRandom_Unit(pvtRandom* random)
{
    return (double)pvtRandom_Next(random) * 0x1p-32;
}

#endif
