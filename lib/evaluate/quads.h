// SPDX-License-Identifier: MIT
// Random quads over a screen, and what a mesh and its occluder hide of them.
#ifndef PVT_EVALUATE_QUADS_H
#define PVT_EVALUATE_QUADS_H

#include "raster.h"

#include "base/random.h"

#include <paravent/evaluate.h>

/// Covered pixels left of and below each pixel's corner: entry (x, y) of (width + 1) × (height + 1)
/// is the number of covered pixels (i, j) with i < x and j < y.
typedef struct pvtCoverTable {
    uint32_t* sums;
    int width, height;
    size_t capacity;
} pvtCoverTable;

/// Pixels x0 to x1 and y0 to y1, both inclusive.
typedef struct pvtQuad {
    int x0, y0, x1, y1;
} pvtQuad;

typedef enum pvtQuadFamily {
    PVT_QUADS_UNIFORM, ///< two corners, each uniform over the pixels
    PVT_QUADS_SMALL, ///< sides uniform from 1 to an eighth of the screen's, place uniform within it
} pvtQuadFamily;

/// Pixels of quads by the paper's classes, and the sums of their squares, for sampling errors.
typedef struct pvtQuadTally {
    uint64_t hidden; ///< Nt: of quads that both hide
    uint64_t lost;   ///< Pf: of quads that only the original hides
    uint64_t wrong;  ///< Nf: of quads that only the occluder hides, pixels off the original
    double hidden2, lost2, wrong2;
} pvtQuadTally;

/// Tables the part of `raster` that starts at pixel (x, y): width × height pixels, x a multiple of
/// 64.
pvtStatus pvtCoverTable_Build(pvtContext* context, pvtCoverTable* table, const pvtRaster* raster,
                              const pvtQuad* part);
void pvtCoverTable_Free(pvtContext* context, pvtCoverTable* table);
/// Covered pixels within the quad.
uint32_t pvtCoverTable_Count(const pvtCoverTable* table, const pvtQuad* quad);

/// The next quad of a family over width × height pixels.
pvtQuad pvtDrawQuad(pvtRandom* random, pvtQuadFamily family, int width, int height);

/// Adds a quad's pixels to the tally.
void pvtTallyQuad(const pvtCoverTable* original, const pvtCoverTable* occluder, const pvtQuad* quad,
                  pvtQuadTally* tally);

/// Sum over two tallies.
pvtQuadTally pvtAddTallies(const pvtQuadTally* a, const pvtQuadTally* b);

/// Precision, recall and their sampling errors as far as the quads cause them.
pvtQuadScore pvtScoreTally(const pvtQuadTally* tally);

#endif
