// SPDX-License-Identifier: MIT
// Bitmaps of a grid on a plane, 64 cells at a time. See also
// Silvennoinen, Saransaari, Laine, Lehtinen: Occluder Simplification Using Planar Sections, 2014,
// section 4.2, which slices with the stencil buffer of a GPU instead.
//
// Along a row the position of a slanted plane rises by less than a voxel a column, so 64 columns
// look at 65 positions at most. Each of these positions holds one word, of which a run of
// neighbouring bits is wanted, and the runs of all positions make up the word that comes out. Where
// the runs begin depends on the slope, which the whole slice shares, and on the fraction with which
// the word's first column starts, and even that in 65 ways only: a column's position is one
// higher exactly when its own fraction and the first column's add up to one or more, so what counts
// is how many of the columns' fractions do. The masks for each of the ways are made when they are
// first met.
#include "base/bits.h"
#include "base/vectors.h"
#include "voxel/cell_grid.h"

#include <assert.h>
#include <paravent/section.h>
#include <string.h>

enum {
    COLUMNS = 64,
    ONE = 1 << PVT_PLANE_BITS,
    BUCKETS = 256,
    BUCKET_BITS = PVT_PLANE_BITS - 8,
    // 64 columns' positions, one more for the carry, and what reading in fours may take beyond.
    MAX_MASKS = COLUMNS + 4,
    MAX_SAMPLES = 4,
};

// What 64 neighbouring columns do under one slope.
typedef struct SlopeTable {
    int lowest;                        // position of the lowest column, from the first column's
    int maskCount;                     // positions looked at
    uint64_t steps[MAX_MASKS + 1];     // [n + 1]: the columns at lowest + n, without carry
    uint32_t fractions[COLUMNS + 1];   // of the columns' positions, rising; a sentinel at the end
    uint64_t carries[COLUMNS + 1];     // [n]: the columns whose fraction is fractions[n] or more
    uint8_t bucketStarts[BUCKETS + 1]; // first of the fractions in each 1/256
    bool made[COLUMNS + 1];
    uint64_t masks[COLUMNS + 1][MAX_MASKS];
} SlopeTable;

static void SortFractions(SlopeTable* table, const uint32_t fractions[COLUMNS])
{
    uint8_t counts[BUCKETS + 1] = {0};
    for (int i = 0; i < COLUMNS; ++i) {
        ++counts[fractions[i] >> BUCKET_BITS];
    }
    uint8_t next[BUCKETS];
    uint8_t sum = 0;
    for (int i = 0; i < BUCKETS; ++i) {
        table->bucketStarts[i] = next[i] = sum;
        sum = (uint8_t)(sum + counts[i]);
    }
    table->bucketStarts[BUCKETS] = sum;
    for (int i = 0; i < COLUMNS; ++i) {
        // Within its bucket a fraction sinks to its place past the larger ones.
        const int bucket = (int)(fractions[i] >> BUCKET_BITS);
        int place = next[bucket]++;
        for (; place > table->bucketStarts[bucket] && table->fractions[place - 1] > fractions[i];
             --place) {
            table->fractions[place] = table->fractions[place - 1];
            table->carries[place] = table->carries[place - 1];
        }
        table->fractions[place] = fractions[i];
        table->carries[place] = UINT64_C(1) << i;
    }
    table->fractions[COLUMNS] = UINT32_MAX;
    table->carries[COLUMNS] = 0;
    for (int i = COLUMNS - 1; i >= 0; --i) {
        table->carries[i] |= table->carries[i + 1];
    }
}

static void MakeSlopeTable(int32_t slope, SlopeTable* table)
{
    uint32_t fractions[COLUMNS];
    const int last = (slope * (COLUMNS - 1)) >> PVT_PLANE_BITS;
    table->lowest = last < 0 ? last : 0;
    table->maskCount = (last < 0 ? -last : last) + 2;
    memset(table->steps, 0, sizeof table->steps);
    memset(table->made, 0, sizeof table->made);
    for (int i = 0; i < COLUMNS; ++i) {
        const int rise = slope * i;
        table->steps[(rise >> PVT_PLANE_BITS) - table->lowest + 1] |= UINT64_C(1) << i;
        fractions[i] = (uint32_t)rise & (ONE - 1);
    }
    SortFractions(table, fractions);
}

static const uint64_t* MakeMasks(SlopeTable* table, int carry)
{
    uint64_t* masks = table->masks[carry];
    const uint64_t carried = table->carries[carry];
    for (int i = 0; i < MAX_MASKS; ++i) {
        masks[i] = (table->steps[i + 1] & ~carried) | (table->steps[i] & carried);
    }
    table->made[carry] = true;
    return masks;
}

// `least` is the smallest fraction, 1 to ONE, whose column carries.
static inline const uint64_t* FindMasks(SlopeTable* table, uint32_t least)
{
    int carry = table->bucketStarts[least >> BUCKET_BITS];
    while (table->fractions[carry] < least) {
        ++carry;
    }
    return table->made[carry] ? table->masks[carry] : MakeMasks(table, carry);
}

// Bits of words[n] chosen by masks[n], for n below count. Both may be read, and do not matter, up
// to the next multiple of four.
static inline uint64_t CollectBits(const uint64_t* words, const uint64_t* masks, int64_t count)
{
    uint64_t a = 0, b = 0, c = 0, d = 0;
    for (int64_t n = 0; n < count; n += 4) {
        a |= words[n] & masks[n];
        b |= words[n + 1] & masks[n + 1];
        c |= words[n + 2] & masks[n + 2];
        d |= words[n + 3] & masks[n + 3];
    }
    return a | b | c | d;
}

// A height is a position along the axis in units of 2^-bits voxel.
typedef struct Slicing {
    const pvtSliceColumns* columns;
    SlopeTable* table;
    int bits;
    int sampleCount;
    int64_t samples[MAX_SAMPLES]; // heights at cell (0, 0) whose voxels must be set
    int64_t stepU, stepV;         // from cell to cell
    int cellsPerVoxel;
} Slicing;

// The bits at the heights that start with `height` in the column's first row.
static inline uint64_t SliceColumn(const Slicing* slicing, size_t column, int64_t height)
{
    SlopeTable* table = slicing->table;
    const int64_t first = (height >> slicing->bits) + table->lowest;
    const int32_t* range = slicing->columns->ranges[column];
    const int64_t begin = first > range[0] ? first : range[0];
    const int64_t stop = first + table->maskCount;
    const int64_t end = stop < range[1] ? stop : range[1];
    if (begin >= end) {
        return 0;
    }
    // A column carries when its fraction, brought to `bits`, and this one reach one voxel.
    const int64_t one = INT64_C(1) << slicing->bits;
    const int64_t missing = one - (height & (one - 1));
    const int extra = slicing->bits - PVT_PLANE_BITS;
    const uint32_t least = (uint32_t)((missing + (INT64_C(1) << extra) - 1) >> extra);
    const uint64_t* masks = FindMasks(table, least) + (begin - first);
    const uint64_t* words = slicing->columns->words + column * slicing->columns->stride + begin;
    return CollectBits(words, masks, end - begin);
}

// Bit n goes to bit n × cellsPerVoxel.
static inline uint64_t SpreadBits(uint64_t bits, int cellsPerVoxel)
{
    if (cellsPerVoxel == 2) {
        bits = (bits | bits << 16) & UINT64_C(0x0000FFFF0000FFFF);
        bits = (bits | bits << 8) & UINT64_C(0x00FF00FF00FF00FF);
        bits = (bits | bits << 4) & UINT64_C(0x0F0F0F0F0F0F0F0F);
        bits = (bits | bits << 2) & UINT64_C(0x3333333333333333);
        return (bits | bits << 1) & UINT64_C(0x5555555555555555);
    }
    bits = (bits | bits << 24) & UINT64_C(0x000000FF000000FF);
    bits = (bits | bits << 12) & UINT64_C(0x000F000F000F000F);
    bits = (bits | bits << 6) & UINT64_C(0x0303030303030303);
    return (bits | bits << 3) & UINT64_C(0x1111111111111111);
}

// Phase p holds the cells p, p + cellsPerVoxel, ... of word w's columns. Inline, so that a constant
// cellsPerVoxel unrolls it.
static inline void StorePhases(const uint64_t* phases, int cellsPerVoxel, size_t w,
                               size_t wordsPerRow, uint64_t* row)
{
    const int width = COLUMNS / cellsPerVoxel;
    for (int part = 0; part < cellsPerVoxel; ++part) {
        const size_t place = w * (size_t)cellsPerVoxel + (size_t)part;
        if (place >= wordsPerRow) {
            return;
        }
        uint64_t word = 0;
        for (int phase = 0; phase < cellsPerVoxel; ++phase) {
            const uint64_t bits = phases[phase] >> (part * width);
            const uint64_t low = bits & ((UINT64_C(1) << width) - 1);
            word |= SpreadBits(low, cellsPerVoxel) << phase;
        }
        row[place] = word;
    }
}

static inline uint64_t SlicePhase(const Slicing* slicing, size_t column, int64_t rise)
{
    uint64_t word = SliceColumn(slicing, column, slicing->samples[0] + rise);
    for (int i = 1; i < slicing->sampleCount && word != 0; ++i) {
        word &= SliceColumn(slicing, column, slicing->samples[i] + rise);
    }
    return word;
}

static void SliceRow(const Slicing* slicing, int j, size_t wordsPerRow, uint64_t* row)
{
    const int cells = slicing->cellsPerVoxel;
    const size_t columnCount = slicing->columns->wordsPerRow;
    const size_t column = (size_t)(j / cells) * columnCount;
    int64_t rise = slicing->stepV * j;
    for (size_t w = 0; w < columnCount; ++w) {
        if (cells == 1) {
            row[w] = SlicePhase(slicing, column + w, rise);
        } else {
            uint64_t phases[4] = {0};
            for (int phase = 0; phase < cells; ++phase) {
                phases[phase] = SlicePhase(slicing, column + w, rise + slicing->stepU * phase);
            }
            if (cells == 2) {
                StorePhases(phases, 2, w, wordsPerRow, row);
            } else {
                StorePhases(phases, 4, w, wordsPerRow, row);
            }
        }
        rise += slicing->stepU * cells * COLUMNS;
    }
}

// The patch over a cell spans the heights from its lowest corner to its highest. The least
// fraction below the lowest still touches the voxel below when that corner lies on a face. Between
// the two, samples no more than a voxel apart miss no voxel.
static void PlaceSamples(const pvtPlane* plane, pvtSliceRule rule, Slicing* slicing)
{
    const int64_t middle =
        plane->offset * 2 * slicing->cellsPerVoxel + plane->slopeU + plane->slopeV;
    slicing->samples[0] = middle;
    slicing->sampleCount = 1;
    if (rule == PVT_SLICE_COVERED) {
        const int64_t one = INT64_C(1) << slicing->bits;
        const int64_t u = plane->slopeU < 0 ? -plane->slopeU : plane->slopeU;
        const int64_t v = plane->slopeV < 0 ? -plane->slopeV : plane->slopeV;
        const int64_t span = 2 * (u + v) + 1;
        const int gaps = (int)((span + one - 1) / one);
        for (int i = 0; i <= gaps; ++i) {
            slicing->samples[i] = middle - u - v - 1 + span * i / gaps;
        }
        slicing->sampleCount = gaps + 1;
    }
}

void pvtSliceGrid(const pvtSliceVolume* volume, const pvtPlane* plane, pvtSliceRule rule,
                  int cellsPerVoxel, pvtBitmap* slice)
{
    assert(cellsPerVoxel == 1 || cellsPerVoxel == 2 || cellsPerVoxel == 4);
    assert(plane->slopeU >= -ONE && plane->slopeU <= ONE);
    assert(plane->slopeV >= -ONE && plane->slopeV <= ONE);
    assert(slice->width == volume->grid->frame.size[pvtPlane_GetU(plane)] * cellsPerVoxel);
    assert(slice->height == volume->grid->frame.size[pvtPlane_GetV(plane)] * cellsPerVoxel);
    SlopeTable table;
    MakeSlopeTable(plane->slopeU, &table);
    Slicing slicing = {
        .columns = &volume->axes[plane->axis],
        .table = &table,
        .bits = PVT_PLANE_BITS + 1 + cellsPerVoxel / 2, // of 2 × cellsPerVoxel
        .stepU = 2 * (int64_t)plane->slopeU,
        .stepV = 2 * (int64_t)plane->slopeV,
        .cellsPerVoxel = cellsPerVoxel,
    };
    PlaceSamples(plane, rule, &slicing);
    for (int j = 0; j < slice->height; ++j) {
        SliceRow(&slicing, j, slice->wordsPerRow, slice->words + (size_t)j * slice->wordsPerRow);
    }
}

enum {
    HEIGHT_BITS = PVT_PLANE_BITS + 3,
    CELL_HEIGHT_BITS = HEIGHT_BITS - 2,
    PATCHES = 16,
    // A patch over a voxel rises by two at most.
    MAX_VOXELS = 4
};

// A plane over a volume with cells. Heights count in units of 2^-23 voxel, as for slices of four
// cells a voxel.
typedef struct CellSlicing {
    const pvtSliceVolume* volume;
    pvtAxis axis;
    int64_t first;      // height below which the patch over cell (0, 0) does not reach
    int span;           // from a patch's lowest to its highest
    int64_t least;      // height of the lowest of 16 patches, from the first
    int reach;          // from there to the highest
    int rises[PATCHES]; // of the patches' lowest, from the lowest of all
    int64_t stepU, stepV;
    Slicing whole, partly; // of the voxels, one cell each
} CellSlicing;

// Cells in the order x, y, z are digits of base four. This changes the places of the lower two,
static inline uint64_t SwapLowDigits(uint64_t cells)
{
    uint64_t swap = (cells ^ cells >> 3) & UINT64_C(0x0A0A0A0A0A0A0A0A);
    cells ^= swap ^ swap << 3;
    swap = (cells ^ cells >> 6) & UINT64_C(0x00CC00CC00CC00CC);
    return cells ^ swap ^ swap << 6;
}

// and this those of the upper two.
static inline uint64_t SwapHighDigits(uint64_t cells)
{
    uint64_t swap = (cells ^ cells >> 12) & UINT64_C(0x0000F0F00000F0F0);
    cells ^= swap ^ swap << 12;
    swap = (cells ^ cells >> 24) & UINT64_C(0x00000000FF00FF00);
    return cells ^ swap ^ swap << 24;
}

// Cell n of (u, v) as bit u + 4 v + 16 n.
static inline uint64_t TurnCells(uint64_t cells, pvtAxis axis)
{
    switch (axis) {
    case PVT_AXIS_X:
        return SwapHighDigits(SwapLowDigits(cells));
    case PVT_AXIS_Y:
        return SwapHighDigits(cells);
    case PVT_AXIS_Z:
        break;
    }
    return cells;
}

// All cells of a voxel of the column (u, v), at position n along the axis.
static uint64_t GetColumnCells(const CellSlicing* slicing, int u, int v, int64_t n)
{
    const pvtSliceVolume* volume = slicing->volume;
    const pvtSliceColumns* whole = &volume->axes[slicing->axis];
    const int* size = volume->grid->frame.size;
    if (n < 0 || n >= size[slicing->axis]) {
        return 0;
    }
    const size_t column = (size_t)v * whole->wordsPerRow + (size_t)u / 64;
    const size_t word = column * whole->stride + (size_t)n;
    if ((whole->words[word] >> (u % 64) & 1) != 0) {
        return ~UINT64_C(0);
    }
    if ((volume->partly[slicing->axis].words[word] >> (u % 64) & 1) == 0) {
        return 0;
    }
    const int at = (int)n;
    const int x = slicing->axis == PVT_AXIS_X ? at : u;
    const int y = slicing->axis == PVT_AXIS_X ? u : slicing->axis == PVT_AXIS_Y ? at : v;
    const int z = slicing->axis == PVT_AXIS_Z ? at : v;
    const uint64_t cells = volume->cells->cells[pvtCellGrid_Rank(volume->cells, x, y, z)];
    return TurnCells(cells, slicing->axis);
}

// The voxels of a column that the patches over it reach into.
typedef struct Reached {
    int64_t voxel; // the lowest
    int start;     // height in it of the lowest patch
    int last;      // how many voxels above it the highest ends
} Reached;

static inline Reached FindReached(const CellSlicing* slicing, int u, int v)
{
    const int64_t lowest =
        slicing->first + PVT_CELLS * (slicing->stepU * u + slicing->stepV * v) + slicing->least;
    const int64_t voxel = lowest >> HEIGHT_BITS;
    const int start = (int)(lowest - voxel * (INT64_C(1) << HEIGHT_BITS));
    return (Reached){voxel, start, (start + slicing->reach) >> HEIGHT_BITS};
}

// Which of the 16 patches over a voxel's column (u, v) touch set cells only: bit i + 4 j.
static inline uint64_t JudgePatches(const CellSlicing* slicing, int u, int v)
{
    const Reached reached = FindReached(slicing, u, v);
    const int start = reached.start;
    uint64_t cells[MAX_VOXELS] = {0};
    uint64_t any = 0;
    for (int n = 0; n <= reached.last; ++n) {
        cells[n] = GetColumnCells(slicing, u, v, reached.voxel + n);
        any |= cells[n];
    }
    if (any == 0) {
        return 0;
    }
    int low[PATCHES], high[PATCHES], clear[PATCHES] = {0};
    for (int i = 0; i < PATCHES; ++i) {
        low[i] = (start + slicing->rises[i]) >> CELL_HEIGHT_BITS;
        high[i] = (start + slicing->rises[i] + slicing->span) >> CELL_HEIGHT_BITS;
    }
    const int top = (start + slicing->reach) >> CELL_HEIGHT_BITS;
    for (int level = start >> CELL_HEIGHT_BITS; level <= top; ++level) {
        const int row = (int)(~cells[level / PVT_CELLS] >> (PATCHES * (level % PVT_CELLS)) &
                              ((1 << PATCHES) - 1));
        for (int i = 0; i < PATCHES; ++i) {
            clear[i] |= low[i] <= level && level <= high[i] ? row & 1 << i : 0;
        }
    }
    int all = (1 << PATCHES) - 1;
    for (int i = 0; i < PATCHES; ++i) {
        all &= ~clear[i];
    }
    return (uint64_t)all;
}

// The cells that all patches over a voxel's column touch together, from the level that the lowest
// begins in. They depend on where in its cell that is, and change when one of the patches' lowest
// or highest heights enters the next cell: so there are few, and each is made when it is first met.
typedef struct TouchTable {
    int32_t changes[2 * PATCHES]; // heights in a cell, in no order
    bool made[2 * PATCHES + 1];
    uint64_t cells[2 * PATCHES + 1][MAX_VOXELS]; // [n]: when n of the changes have come
} TouchTable;

static void StartTouchTable(const CellSlicing* slicing, TouchTable* table)
{
    const int cell = 1 << CELL_HEIGHT_BITS;
    for (int i = 0; i < PATCHES; ++i) {
        table->changes[2 * i] = -slicing->rises[i] & (cell - 1);
        table->changes[2 * i + 1] = -(slicing->rises[i] + slicing->span) & (cell - 1);
    }
    memset(table->made, 0, sizeof table->made);
}

static void MakeTouched(const CellSlicing* slicing, int start, uint64_t cells[MAX_VOXELS])
{
    memset(cells, 0, MAX_VOXELS * sizeof *cells);
    for (int i = 0; i < PATCHES; ++i) {
        const int lowest = start + slicing->rises[i];
        const int top = (lowest + slicing->span) >> CELL_HEIGHT_BITS;
        for (int level = lowest >> CELL_HEIGHT_BITS; level <= top; ++level) {
            cells[level / PVT_CELLS] |= UINT64_C(1) << (PATCHES * (level % PVT_CELLS) + i);
        }
    }
}

static inline const uint64_t* FindTouched(const CellSlicing* slicing, TouchTable* table, int start)
{
    int count = 0;
    for (int i = 0; i < 2 * PATCHES; ++i) {
        count += table->changes[i] <= start ? 1 : 0;
    }
    if (!table->made[count]) {
        table->made[count] = true;
        MakeTouched(slicing, start, table->cells[count]);
    }
    return table->cells[count];
}

// Whether all patches over a voxel's column (u, v) touch set cells only: what JudgePatches asks of
// each.
static inline bool IsVoxelCovered(const CellSlicing* slicing, TouchTable* table, int u, int v)
{
    const Reached reached = FindReached(slicing, u, v);
    const int level = reached.start >> CELL_HEIGHT_BITS;
    const uint64_t* touched =
        FindTouched(slicing, table, reached.start & ((1 << CELL_HEIGHT_BITS) - 1));
    uint64_t below = 0;
    for (int n = 0; n <= reached.last; ++n) {
        const uint64_t cells = touched[n] << (PATCHES * level) | below;
        below = level == 0 ? 0 : touched[n] >> (64 - PATCHES * level);
        if (cells != 0 && (cells & ~GetColumnCells(slicing, u, v, reached.voxel + n)) != 0) {
            return false;
        }
    }
    return true;
}

static CellSlicing StartCells(const pvtSliceVolume* volume, const pvtPlane* plane,
                              SlopeTable* table)
{
    const int64_t u = plane->slopeU < 0 ? -plane->slopeU : plane->slopeU;
    const int64_t v = plane->slopeV < 0 ? -plane->slopeV : plane->slopeV;
    const int64_t middle = plane->offset * 2 * PVT_CELLS + plane->slopeU + plane->slopeV;
    CellSlicing slicing = {.volume = volume,
                           .axis = plane->axis,
                           .first = middle - u - v - 1,
                           .span = (int)(2 * (u + v) + 1),
                           .stepU = 2 * (int64_t)plane->slopeU,
                           .stepV = 2 * (int64_t)plane->slopeV,
                           .whole = {.columns = &volume->axes[plane->axis],
                                     .table = table,
                                     .bits = PVT_PLANE_BITS + 1,
                                     .stepU = 2 * (int64_t)plane->slopeU,
                                     .stepV = 2 * (int64_t)plane->slopeV,
                                     .cellsPerVoxel = 1}};
    const int64_t farU = 3 * slicing.stepU, farV = 3 * slicing.stepV;
    slicing.least = (farU < 0 ? farU : 0) + (farV < 0 ? farV : 0);
    slicing.reach = (int)(6 * (u + v)) + slicing.span;
    for (int i = 0; i < PATCHES; ++i) {
        slicing.rises[i] = (int)(slicing.stepU * (i % 4) + slicing.stepV * (i / 4) - slicing.least);
    }
    PlaceSamples(plane, PVT_SLICE_COVERED, &slicing.whole);
    slicing.partly = slicing.whole;
    slicing.partly.columns = &volume->partly[plane->axis];
    return slicing;
}

// The columns of word w in row v of voxels that whole voxels cover, and those that partly set ones
// may cover instead.
static void FindColumns(const CellSlicing* slicing, int v, size_t w, uint64_t* covered,
                        uint64_t* others)
{
    const Slicing* whole = &slicing->whole;
    const Slicing* partly = &slicing->partly;
    const int64_t rise = whole->stepV * v + whole->stepU * COLUMNS * (int64_t)w;
    const size_t column = (size_t)v * whole->columns->wordsPerRow + w;
    *covered = SlicePhase(whole, column, rise);
    *others = 0;
    for (int i = 0; i < partly->sampleCount; ++i) {
        *others |= SliceColumn(partly, column, partly->samples[i] + rise);
    }
    *others &= ~*covered;
}

PVT_VECTOR_CLONES static void SliceCellWord(const CellSlicing* slicing, int v, size_t w,
                                            pvtBitmap* slice)
{
    const size_t perRow = slice->wordsPerRow;
    uint64_t* rows = slice->words + (size_t)v * PVT_CELLS * perRow;
    uint64_t covered, others;
    FindColumns(slicing, v, w, &covered, &others);
    for (size_t part = 0; part < PVT_CELLS && w * PVT_CELLS + part < perRow; ++part) {
        const uint64_t word = SpreadBits(covered >> (16 * part) & 0xFFFF, PVT_CELLS) * 0xF;
        for (size_t row = 0; row < PVT_CELLS; ++row) {
            rows[row * perRow + w * PVT_CELLS + part] = word;
        }
    }
    for (; others != 0; others &= others - 1) {
        const int u = (int)(w * COLUMNS) + __builtin_ctzll(others);
        const uint64_t patches = JudgePatches(slicing, u, v);
        for (size_t row = 0; row < PVT_CELLS; ++row) {
            rows[row * perRow + (size_t)u / 16] |= (patches >> (4 * row) & 0xF) << (4 * (u % 16));
        }
    }
}

// At one cell a voxel all patches over it must be covered: so no voxel that they touch may be
// clear.
PVT_VECTOR_CLONES static void SliceVoxelWord(const CellSlicing* slicing, TouchTable* table, int v,
                                             size_t w, pvtBitmap* slice)
{
    const Slicing* whole = &slicing->whole;
    const Slicing* partly = &slicing->partly;
    const int64_t rise = whole->stepV * v + whole->stepU * COLUMNS * (int64_t)w;
    const size_t column = (size_t)v * whole->columns->wordsPerRow + w;
    uint64_t covered = ~UINT64_C(0), possible = ~UINT64_C(0);
    for (int i = 0; i < whole->sampleCount && possible != 0; ++i) {
        const uint64_t set = SliceColumn(whole, column, whole->samples[i] + rise);
        covered &= set;
        if (set != ~UINT64_C(0)) {
            possible &= set | SliceColumn(partly, column, partly->samples[i] + rise);
        }
    }
    covered &= possible;
    for (uint64_t others = possible & ~covered; others != 0; others &= others - 1) {
        const int bit = __builtin_ctzll(others);
        const bool isCovered = IsVoxelCovered(slicing, table, (int)(w * COLUMNS) + bit, v);
        covered |= (uint64_t)isCovered << bit;
    }
    slice->words[(size_t)v * slice->wordsPerRow + w] = covered;
}

static int ClampInto(int value, int most)
{
    return value < 0 ? 0 : value > most ? most : value;
}

void pvtSliceCells(const pvtSliceVolume* volume, const pvtPlane* plane, int cellsPerVoxel,
                   const pvtSliceWindow* window, pvtBitmap* slice)
{
    assert(cellsPerVoxel == 1 || cellsPerVoxel == PVT_CELLS);
    const int width = volume->grid->frame.size[pvtPlane_GetU(plane)];
    const int height = volume->grid->frame.size[pvtPlane_GetV(plane)];
    assert(slice->width == width * cellsPerVoxel && slice->height == height * cellsPerVoxel);
    SlopeTable table;
    MakeSlopeTable(plane->slopeU, &table);
    const CellSlicing slicing = StartCells(volume, plane, &table);
    TouchTable touched;
    StartTouchTable(&slicing, &touched);
    const pvtSliceWindow all = {.upper = {width, height}};
    const pvtSliceWindow* part = window != NULL ? window : &all;
    const size_t first = (size_t)ClampInto(part->lower[0], width) / COLUMNS;
    const size_t end = pvtGetWordCount((size_t)ClampInto(part->upper[0], width));
    if (window != NULL) {
        memset(slice->words, 0, slice->wordsPerRow * (size_t)slice->height * sizeof(uint64_t));
    }
    for (int v = ClampInto(part->lower[1], height); v < ClampInto(part->upper[1], height); ++v) {
        for (size_t w = first; w < end; ++w) {
            if (cellsPerVoxel == 1) {
                SliceVoxelWord(&slicing, &touched, v, w, slice);
            } else {
                SliceCellWord(&slicing, v, w, slice);
            }
        }
    }
}

double pvtMeasureSlice(const pvtBitmap* slice, const pvtPlane* plane, int cellsPerVoxel)
{
    return (double)pvtBitmap_Count(slice) * pvtPlane_GetAreaScale(plane) /
           ((double)cellsPerVoxel * cellsPerVoxel);
}
