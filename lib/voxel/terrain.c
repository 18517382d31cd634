// SPDX-License-Identifier: MIT
// Landscapes: what lies below the lowest surface of each column is inside, down to the lowest of
// all or farther.
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

// Columns along y or z lie 64 side by side in a word.
typedef struct ColumnLayout {
    size_t step;   // words from one voxel of a column to the next
    size_t across; // rows of columns
    size_t stride; // words from one row of columns to the next
} ColumnLayout;

static ColumnLayout GetColumnLayout(const pvtBitGrid* grid, pvtAxis up)
{
    const size_t slab = grid->wordsPerRow * (size_t)grid->frame.size[1];
    return up == PVT_AXIS_Y ? (ColumnLayout){grid->wordsPerRow, (size_t)grid->frame.size[2], slab}
                            : (ColumnLayout){slab, (size_t)grid->frame.size[1], grid->wordsPerRow};
}

// The first word of the columns with the index i, of across × wordsPerRow.
static size_t GetColumnStart(const ColumnLayout* layout, const pvtBitGrid* grid, size_t i)
{
    return i / grid->wordsPerRow * layout->stride + i % grid->wordsPerRow;
}

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

void pvtFillBelowTerrain(const pvtSolidOptions* options, const pvtBitGrid* surface,
                         pvtBitGrid* inside)
{
    pvtGridBox box;
    if (!pvtBitGrid_FindBounds(surface, &box)) {
        return;
    }
    const int bottom = box.lower[options->up] - options->below;
    const int range[2] = {bottom > 0 ? bottom : 0, box.upper[options->up]};
    if (options->up == PVT_AXIS_X) {
        FillRows(surface, range[0], inside);
        return;
    }
    const ColumnLayout layout = GetColumnLayout(surface, options->up);
    for (size_t i = 0; i < layout.across * surface->wordsPerRow; ++i) {
        FillColumns(surface, GetColumnStart(&layout, surface, i), layout.step, range, inside);
    }
}

static void AddColumn(pvtColumnStats* stats, int runs, int voxels, int most)
{
    stats->touched += runs > 0;
    stats->runs += (uint64_t)runs;
    stats->tall += voxels > most;
}

static void CountRows(const pvtBitGrid* surface, int most, pvtColumnStats* stats)
{
    for (size_t begin = 0; begin < surface->wordCount; begin += surface->wordsPerRow) {
        uint64_t before = 0;
        int runs = 0;
        int voxels = 0;
        for (size_t i = begin; i < begin + surface->wordsPerRow; ++i) {
            const uint64_t word = surface->words[i];
            runs += pvtCountBits(word & ~(word << 1 | before >> 63));
            voxels += pvtCountBits(word);
            before = word;
        }
        AddColumn(stats, runs, voxels, most);
    }
}

// 64 columns at a time, from the word `first` on.
static void CountColumns(const uint64_t* first, size_t step, int height, int most,
                         pvtColumnStats* stats)
{
    int runs[64] = {0};
    int voxels[64] = {0};
    uint64_t before = 0;
    for (int j = 0; j < height; ++j) {
        const uint64_t word = first[(size_t)j * step];
        for (uint64_t bits = word; bits != 0; bits &= bits - 1) {
            const int bit = __builtin_ctzll(bits);
            ++voxels[bit];
            runs[bit] += (before >> bit & 1) == 0;
        }
        before = word;
    }
    for (int bit = 0; bit < 64; ++bit) {
        AddColumn(stats, runs[bit], voxels[bit], most);
    }
}

pvtColumnStats pvtCountColumns(const pvtBitGrid* surface, pvtAxis up, int most)
{
    pvtColumnStats stats = {0, 0, 0};
    if (up == PVT_AXIS_X) {
        CountRows(surface, most, &stats);
        return stats;
    }
    const ColumnLayout layout = GetColumnLayout(surface, up);
    for (size_t i = 0; i < layout.across * surface->wordsPerRow; ++i) {
        CountColumns(surface->words + GetColumnStart(&layout, surface, i), layout.step,
                     surface->frame.size[up], most, &stats);
    }
    return stats;
}
