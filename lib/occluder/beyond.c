// SPDX-License-Identifier: MIT
#include "beyond.h"

#include "base/bits.h"

enum { SIZE = PVT_SIGHT_SIZE, CELLS = PVT_SIGHT_CELLS, HALVES = PVT_SIGHT_WORDS };

static const uint64_t EVEN = UINT64_C(0x5555555555555555);
// A rectangle reaches into many pixels: that most of a narrow strip beyond the goal is covered
// spoils many times as many of them as its area would.
static const double COST = 20.0;   // if as much is covered there as the goal has
static const float PENALTY = 0.5F; // of a pixel, as a part of what the goal's are worth on average

// The goal's pixels in the two rows of cells from y on, and those around them.
static void FindCellsAround(const pvtSightMask* goal, int y, uint64_t near[HALVES])
{
    near[0] = near[1] = 0;
    for (int row = y > 0 ? y - 1 : 0; row < y + 3 && row < SIZE; ++row) {
        const uint64_t low = goal->words[0][row], high = goal->words[1][row];
        near[0] |= low | low << 1 | low >> 1 | high << 63;
        near[1] |= high | high << 1 | high >> 1 | low >> 63;
    }
}

void pvtFindBeyond(const pvtSightMask* goal, pvtSightMask* beyond)
{
    for (int y = 0; y < SIZE; y += 2) {
        uint64_t near[HALVES];
        FindCellsAround(goal, y, near);
        for (int half = 0; half < HALVES; ++half) {
            const uint64_t cells = ~(near[half] | near[half] >> 1) & EVEN;
            beyond->words[half][y] = beyond->words[half][y + 1] = cells | cells << 1;
        }
    }
}

double pvtGetCostBeyond(const pvtSightMask* goal, const pvtSightMask* beyond,
                        const pvtSightMask* covered)
{
    int all = 0, out = 0;
    for (int half = 0; half < HALVES; ++half) {
        for (int y = 0; y < SIZE; ++y) {
            all += pvtCountBits(goal->words[half][y]);
            out += pvtCountBits(beyond->words[half][y] & covered->words[half][y]);
        }
    }
    return all > 0 ? COST * out / all : 0.0;
}

void pvtPunishBeyond(const pvtSightMask* beyond, float (*values)[PVT_SIGHT_STRIDE])
{
    double sum = 0.0;
    int count = 0;
    for (int y = 1; y <= CELLS; ++y) {
        for (int x = 1; x <= CELLS; ++x) {
            const float value = values[y][x];
            sum += value > 0.0F ? (double)value : 0.0;
            count += value > 0.0F;
        }
    }
    const float loss = count > 0 ? PENALTY * (float)(sum / count) : 0.0F;
    for (int y = 0; y < CELLS; ++y) {
        for (int x = 0; x < CELLS; ++x) {
            if (pvtGetBit(&beyond->words[x / 32][2 * y], 2 * (size_t)x % 64)) {
                values[y + 1][x + 1] = -loss;
            }
        }
    }
}
