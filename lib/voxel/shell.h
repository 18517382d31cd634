// SPDX-License-Identifier: MIT
// What the waves through touched voxels and the judgement of their cells share: voxels are looked
// at in rows, with the eight rows around theirs, and their cells are found by rank, so that nobody
// keeps a list of who lies beside whom. All of that is part of the clones that use it: machines
// with wide vectors count bits, which ranks are made of, by an instruction.
#ifndef PVT_VOXEL_SHELL_H
#define PVT_VOXEL_SHELL_H

#include "bit_grid.h"
#include "cell_grid.h"

#include "base/context.h"
#include "base/vectors.h"

// What a voxel is when it is not touched; otherwise it is its place among the touched ones.
#define PVT_OUTSIDE UINT32_MAX
#define PVT_INSIDE (UINT32_MAX - 1)

// Of a voxel: below and above along x, y and z.
enum { PVT_SIDES = 6 };

// Cells of a touched voxel that the waves have taken.
typedef struct pvtWaves {
    uint64_t outside, inside;
} pvtWaves;

typedef struct pvtShell {
    pvtContext* context;
    const pvtCellGrid* touched;
    const pvtBitGrid* inside; // voxels, touched or not
    pvtWaves* waves;          // of each touched voxel
} pvtShell;

// A row of voxels; null words for one beyond the grid.
typedef struct pvtShellRow {
    const uint64_t *touched, *inside;
    const uint32_t* ranks;
    int size;
} pvtShellRow;

// A voxel's own row is the middle one of nine: (y, z) with y first.
enum { PVT_OWN_ROW = 4, PVT_SHELL_ROWS = 9 };

// Which of them a side is in, and how far along it.
typedef struct pvtShellSide {
    uint8_t row;
    int8_t step;
} pvtShellSide;

static const pvtShellSide pvtShellSides[PVT_SIDES] = {{4, -1}, {4, 1}, {3, 0},
                                                      {5, 0},  {1, 0}, {7, 0}};

PVT_IN_CLONES pvtShellRow pvtShell_GetRowInGrid(const pvtShell* shell, int y, int z)
{
    const pvtBitGrid* voxels = &shell->touched->voxels;
    const size_t first = pvtGetRowIndex(voxels, y, z) * voxels->wordsPerRow;
    return (pvtShellRow){voxels->words + first, shell->inside->words + first,
                         shell->touched->ranks + first, voxels->frame.size[0]};
}

PVT_IN_CLONES pvtShellRow pvtShell_GetRow(const pvtShell* shell, int y, int z)
{
    const int* size = shell->touched->voxels.frame.size;
    const bool isInGrid = y >= 0 && z >= 0 && y < size[1] && z < size[2];
    return isInGrid ? pvtShell_GetRowInGrid(shell, y, z) : (pvtShellRow){0};
}

PVT_IN_CLONES void pvtShell_GetRows(const pvtShell* shell, int y, int z,
                                    pvtShellRow rows[PVT_SHELL_ROWS])
{
    PVT_UNROLL
    for (int n = 0; n < PVT_SHELL_ROWS; ++n) {
        rows[n] = pvtShell_GetRow(shell, y + n % 3 - 1, z + n / 3 - 1);
    }
}

PVT_IN_CLONES bool pvtShellRow_IsTouched(const pvtShellRow* row, int x)
{
    return x >= 0 && x < row->size && pvtGetBit(row->touched, (size_t)x);
}

PVT_IN_CLONES uint32_t pvtShellRow_Find(const pvtShellRow* row, int x)
{
    if (x < 0 || x >= row->size) {
        return PVT_OUTSIDE;
    }
    return pvtGetBit(row->touched, (size_t)x)  ? (uint32_t)pvtRankInRow(row->touched, row->ranks, x)
           : pvtGetBit(row->inside, (size_t)x) ? PVT_INSIDE
                                               : PVT_OUTSIDE;
}

PVT_IN_CLONES uint32_t pvtFindBeside(const pvtShellRow rows[PVT_SHELL_ROWS], int x, int side)
{
    return pvtShellRow_Find(&rows[pvtShellSides[side].row], x + pvtShellSides[side].step);
}

// A touched voxel and its place among the touched ones.
typedef void pvtVisitFcn(void* task, const pvtShellRow rows[PVT_SHELL_ROWS], int x, size_t place);

PVT_IN_CLONES void pvtShell_VisitRow(const pvtShell* shell, int y, int z, void* task,
                                     pvtVisitFcn* visit)
{
    const size_t words = shell->touched->voxels.wordsPerRow;
    const pvtShellRow here = pvtShell_GetRowInGrid(shell, y, z);
    size_t first = 0;
    while (first < words && here.touched[first] == 0) {
        ++first;
    }
    if (first == words) {
        return;
    }
    pvtShellRow rows[PVT_SHELL_ROWS];
    pvtShell_GetRows(shell, y, z, rows);
    for (size_t w = first; w < words; ++w) {
        size_t place = here.ranks[w];
        for (uint64_t bits = here.touched[w]; bits != 0; bits &= bits - 1, ++place) {
            visit(task, rows, (int)(w * 64) + __builtin_ctzll(bits), place);
        }
    }
}

// Visits the touched voxels of some layers, row after row. Inlined, so that the visit is, too.
PVT_IN_CLONES void pvtShell_VisitLayers(const pvtShell* shell, size_t begin, size_t end, void* task,
                                        pvtVisitFcn* visit)
{
    const size_t height = (size_t)shell->touched->voxels.frame.size[1];
    for (size_t i = begin * height; i < end * height && !pvtIsCancelled(shell->context); ++i) {
        pvtShell_VisitRow(shell, (int)(i % height), (int)(i / height), task, visit);
    }
}

#define PVT_FIRST_CELLS_X UINT64_C(0x1111111111111111)
#define PVT_FIRST_CELLS_Y UINT64_C(0x000F000F000F000F)

// The cells of a voxel that have one of these as a neighbour, across its side.
PVT_IN_CLONES uint64_t pvtSpreadAcross(uint64_t cells, int side)
{
    switch (side) {
    case 0:
        return cells >> 3 & PVT_FIRST_CELLS_X;
    case 1:
        return (cells & PVT_FIRST_CELLS_X) << 3;
    case 2:
        return cells >> 12 & PVT_FIRST_CELLS_Y;
    case 3:
        return (cells & PVT_FIRST_CELLS_Y) << 12;
    case 4:
        return cells >> 48;
    default:
        return cells << 48;
    }
}

// Cells moved by one, away from a side, as far as they stay in the voxel.
PVT_IN_CLONES uint64_t pvtMoveCells(uint64_t cells, int side)
{
    switch (side) {
    case 0:
        return (cells & ~(PVT_FIRST_CELLS_X << 3)) << 1;
    case 1:
        return (cells & ~PVT_FIRST_CELLS_X) >> 1;
    case 2:
        return (cells & ~(PVT_FIRST_CELLS_Y << 12)) << 4;
    case 3:
        return (cells & ~PVT_FIRST_CELLS_Y) >> 4;
    case 4:
        return cells << 16;
    default:
        return cells >> 16;
    }
}

// Cells that have one of these as a neighbour within the voxel.
PVT_IN_CLONES uint64_t pvtSpreadCells(uint64_t cells)
{
    uint64_t near = 0;
    for (int side = 0; side < PVT_SIDES; ++side) {
        near |= pvtMoveCells(cells, side);
    }
    return near;
}

PVT_IN_CLONES pvtWaves pvtShell_GetWaves(const pvtShell* shell, uint32_t place)
{
    return place < PVT_INSIDE ? shell->waves[place]
                              : (pvtWaves){.outside = place == PVT_OUTSIDE ? ~UINT64_C(0) : 0,
                                           .inside = place == PVT_INSIDE ? ~UINT64_C(0) : 0};
}

/// Fills `waves`, one for each touched voxel, from what is outside and what is inside.
pvtStatus pvtRunWaves(pvtShell* shell);

#endif
