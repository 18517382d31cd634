// SPDX-License-Identifier: MIT
// Rectangles within a goal, in proportion to their area. A rectangle holds as many cells as its
// area tells: so when a cell is drawn first, by how many rectangles hold it, and then one of these,
// each comes up as often as it should. Of those that hold a cell only such are drawn as are no
// wider than what is set left and right of it, and no higher than what is set above and below: few
// of them are not within the goal, however thin it is.
#include "sights.h"

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
