// SPDX-License-Identifier: MIT
// Landscapes: what lies below the lowest surface of each column is inside.
#include "outside.h"

#include "bit_grid.h"

// Columns along x lie within a row.
static void FillRows(const pvtBitGrid* surface, int bottom, pvtBitGrid* inside)
{
    for (int z = 0; z < surface->frame.size[2]; ++z) {
        for (int y = 0; y < surface->frame.size[1]; ++y) {
            const uint64_t* row = pvtBitGrid_GetRow(surface, y, z);
            size_t word = 0;
            while (word < surface->wordsPerRow && row[word] == 0) {
                ++word;
            }
            if (word < surface->wordsPerRow) {
                const size_t lowest = word * 64 + (size_t)__builtin_ctzll(row[word]);
                pvtSetBitRange(pvtBitGrid_GetRow(inside, y, z), (size_t)bottom, lowest);
            }
        }
    }
}

// Columns along y or z, 64 at a time: `step` words lead from one voxel of a column to the next.
static void FillColumns(const pvtBitGrid* surface, size_t first, size_t step, const int range[2],
                        pvtBitGrid* inside)
{
    uint64_t below = 0;
    for (int i = range[0]; i < range[1]; ++i) {
        below |= surface->words[first + (size_t)i * step];
    }
    for (int i = range[0]; i < range[1] && below != 0; ++i) {
        below &= ~surface->words[first + (size_t)i * step];
        inside->words[first + (size_t)i * step] |= below;
    }
}

void pvtFillBelowTerrain(const pvtBitGrid* surface, pvtAxis up, pvtBitGrid* inside)
{
    pvtGridBox box;
    if (!pvtBitGrid_FindBounds(surface, &box)) {
        return;
    }
    const int range[2] = {box.lower[up], box.upper[up]};
    if (up == PVT_AXIS_X) {
        FillRows(surface, range[0], inside);
        return;
    }
    const size_t slab = surface->wordsPerRow * (size_t)surface->frame.size[1];
    const size_t across =
        up == PVT_AXIS_Y ? (size_t)surface->frame.size[2] : (size_t)surface->frame.size[1];
    for (size_t i = 0; i < across; ++i) {
        for (size_t word = 0; word < surface->wordsPerRow; ++word) {
            if (up == PVT_AXIS_Y) {
                FillColumns(surface, i * slab + word, surface->wordsPerRow, range, inside);
            } else {
                FillColumns(surface, i * surface->wordsPerRow + word, slab, range, inside);
            }
        }
    }
}
