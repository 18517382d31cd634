// SPDX-License-Identifier: MIT
// Rectangles within a goal, in proportion to their area. A rectangle holds as many cells as its
// area tells: so when a cell is drawn first, by how many rectangles hold it, and then one of these,
// each comes up as often as it should. Of those that hold a cell only such are drawn as are no
// wider than what is set left and right of it, and no higher than what is set above and below: few
// of them are not within the goal, however thin it is. Those that reach beyond the goal are drawn
// in the same way within a wider one.
#include "sight_mask.h"

#include "base/bits.h"

#include <string.h>

enum { CELLS = PVT_SIGHT_CELLS };

typedef struct Reach {
    uint8_t left, right, below, above; // set cells in a row from here, this one among them
} Reach;

typedef struct Cells {
    uint64_t rows[CELLS];
    Reach reaches[CELLS][CELLS];
    uint64_t sums[CELLS + 1]; // of rectangles that are drawn of each row's cells, before each row
} Cells;

static uint64_t CountRectangles(const Reach* reach)
{
    return (uint64_t)reach->left * reach->right * reach->below * reach->above;
}

static void FindReaches(Cells* cells)
{
    memset(cells->reaches, 0, sizeof cells->reaches);
    for (int y = 0; y < CELLS; ++y) {
        for (int x = 0; x < CELLS; ++x) {
            if ((cells->rows[y] >> x & 1) != 0) {
                Reach* reach = &cells->reaches[y][x];
                reach->left = (uint8_t)(1 + (x > 0 ? cells->reaches[y][x - 1].left : 0));
                reach->below = (uint8_t)(1 + (y > 0 ? cells->reaches[y - 1][x].below : 0));
            }
        }
    }
    for (int y = CELLS - 1; y >= 0; --y) {
        for (int x = CELLS - 1; x >= 0; --x) {
            if ((cells->rows[y] >> x & 1) != 0) {
                Reach* reach = &cells->reaches[y][x];
                reach->right = (uint8_t)(1 + (x + 1 < CELLS ? cells->reaches[y][x + 1].right : 0));
                reach->above = (uint8_t)(1 + (y + 1 < CELLS ? cells->reaches[y + 1][x].above : 0));
            }
        }
    }
}

static void SumRectangles(Cells* cells)
{
    cells->sums[0] = 0;
    for (int y = 0; y < CELLS; ++y) {
        uint64_t sum = cells->sums[y];
        for (int x = 0; x < CELLS && cells->rows[y] != 0; ++x) {
            sum += CountRectangles(&cells->reaches[y][x]);
        }
        cells->sums[y + 1] = sum;
    }
}

static bool IsWithin(const uint64_t rows[CELLS], const pvtSightQuad* quad)
{
    const uint64_t mask = pvtMakeMask(quad->x0, quad->x1);
    for (int y = quad->y0; y < quad->y1; ++y) {
        if ((rows[y] & mask) != mask) {
            return false;
        }
    }
    return true;
}

static pvtSightQuad DrawQuad(const Cells* cells, pvtRandom* random)
{
    uint64_t left = (uint64_t)(pvtRandom_Unit(random) * (double)cells->sums[CELLS]);
    int y = 0, x = 0;
    while (y + 1 < CELLS && left >= cells->sums[y + 1]) {
        ++y;
    }
    left -= cells->sums[y];
    for (uint64_t here = CountRectangles(&cells->reaches[y][0]); x + 1 < CELLS && left >= here;
         here = CountRectangles(&cells->reaches[y][x])) {
        left -= here;
        ++x;
    }
    const Reach* reach = &cells->reaches[y][x];
    return (pvtSightQuad){.x0 = (uint8_t)(x - (int)pvtRandom_Below(random, reach->left)),
                          .x1 = (uint8_t)(x + 1 + (int)pvtRandom_Below(random, reach->right)),
                          .y0 = (uint8_t)(y - (int)pvtRandom_Below(random, reach->below)),
                          .y1 = (uint8_t)(y + 1 + (int)pvtRandom_Below(random, reach->above))};
}

// pvtEvaluateOccluders draws as many rectangles on each screen, and its pixels are such that the
// longer side always has as many: what one of `draws` stands for.
static double GetWeight(const Cells* cells, int draws)
{
    uint64_t columns = 0;
    int low = CELLS, high = 0;
    for (int y = 0; y < CELLS; ++y) {
        columns |= cells->rows[y];
        low = cells->rows[y] != 0 && low == CELLS ? y : low;
        high = cells->rows[y] != 0 ? y + 1 : high;
    }
    const double width = 64 - __builtin_clzll(columns) - __builtin_ctzll(columns);
    const double height = high - low;
    const double longer = width > height ? width : height;
    const double all = width * height * longer;
    return (double)cells->sums[CELLS] / (all * all * draws);
}

size_t pvtDrawSightQuads(const uint64_t rows[CELLS], int draws, pvtRandom* random,
                         pvtSightQuad* quads, double* weight)
{
    Cells cells;
    memcpy(cells.rows, rows, sizeof cells.rows);
    FindReaches(&cells);
    SumRectangles(&cells);
    *weight = 0.0;
    if (cells.sums[CELLS] == 0) {
        return 0;
    }
    *weight = GetWeight(&cells, draws);
    size_t count = 0;
    for (int i = 0; i < draws; ++i) {
        quads[count] = DrawQuad(&cells, random);
        count += IsWithin(rows, &quads[count]) ? 1 : 0;
    }
    return count;
}

// Bits 0, 2, 4, ... of a word, next to each other.
static uint64_t PackEven(uint64_t bits)
{
    bits &= UINT64_C(0x5555555555555555);
    bits = (bits | bits >> 1) & UINT64_C(0x3333333333333333);
    bits = (bits | bits >> 2) & UINT64_C(0x0F0F0F0F0F0F0F0F);
    bits = (bits | bits >> 4) & UINT64_C(0x00FF00FF00FF00FF);
    bits = (bits | bits >> 8) & UINT64_C(0x0000FFFF0000FFFF);
    return (bits | bits >> 16) & UINT64_C(0x00000000FFFFFFFF);
}

void pvtFindWholeCells(const pvtSightMask* mask, uint64_t cells[CELLS])
{
    for (int y = 0; y < CELLS; ++y) {
        cells[y] = 0;
        for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
            const uint64_t both = mask->words[half][2 * y] & mask->words[half][2 * y + 1];
            cells[y] |= PackEven(both & both >> 1) << (32 * half);
        }
    }
}

// Cells that the goal has a pixel of, and `ring` more around them.
static void FindNearCells(const pvtSightMask* goal, int ring, uint64_t cells[CELLS])
{
    for (int y = 0; y < CELLS; ++y) {
        cells[y] = 0;
        for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
            const uint64_t either = goal->words[half][2 * y] | goal->words[half][2 * y + 1];
            cells[y] |= PackEven(either | either >> 1) << (32 * half);
        }
    }
    for (int i = 0; i < ring; ++i) {
        uint64_t below = 0;
        for (int y = 0; y < CELLS; ++y) {
            const uint64_t here = cells[y];
            const uint64_t all = below | here | (y + 1 < CELLS ? cells[y + 1] : 0);
            cells[y] = all | all << 1 | all >> 1;
            below = here;
        }
    }
}

size_t pvtDrawWrongQuads(const pvtSightMask* goal, int ring, int draws, pvtRandom* random,
                         pvtWrongQuad* wrongs)
{
    Cells cells;
    uint64_t whole[CELLS];
    pvtFindWholeCells(goal, whole);
    memcpy(cells.rows, whole, sizeof whole);
    FindReaches(&cells);
    SumRectangles(&cells);
    const double within = (double)cells.sums[CELLS];
    if (within == 0.0) {
        return 0;
    }
    FindNearCells(goal, ring, cells.rows);
    FindReaches(&cells);
    SumRectangles(&cells);
    // What one that is drawn stands for, where of those within the goal as many are.
    const double each = (double)cells.sums[CELLS] / within;
    uint16_t sums[PVT_SIGHT_ENDS][PVT_SIGHT_STRIDE];
    pvtSumOpen(goal, sums);
    size_t count = 0;
    for (int i = 0; i < draws; ++i) {
        const pvtSightQuad quad = DrawQuad(&cells, random);
        if (IsWithin(cells.rows, &quad) && !IsWithin(whole, &quad)) {
            const double pixels = 4.0 * (quad.x1 - quad.x0) * (quad.y1 - quad.y0);
            const double beyond = pvtCountMissing(sums, &quad);
            wrongs[count++] = (pvtWrongQuad){quad, (float)(each * beyond / pixels)};
        }
    }
    return count;
}
