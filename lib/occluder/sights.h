// SPDX-License-Identifier: MIT
// Many views of what could be hidden, each with rectangles drawn at random: what the ascent learns
// from, a few at a time.
#ifndef PVT_OCCLUDER_SIGHTS_H
#define PVT_OCCLUDER_SIGHTS_H

#include "base/random.h"
#include "field.h"

#include <paravent/occlusion.h>

enum {
    PVT_SIGHT_SIZE = 128, ///< [px] of the masks along each side
    PVT_SIGHT_WORDS = 2,  ///< of 64 pixels a row
    PVT_SIGHT_CELLS = 64, ///< of 2 × 2 pixels along each side
};

/// Pixels: bit x & 63 of words[x / 64][y]. Halves lie apart so that loops over rows become vectors.
typedef struct pvtSightMask {
    uint64_t words[PVT_SIGHT_WORDS][PVT_SIGHT_SIZE];
} pvtSightMask;

/// Rows of a mask, from the first to before the end.
typedef struct pvtSightRows {
    uint8_t first, end;
} pvtSightRows;

/// Cells from x0 to x1 − 1 and from y0 to y1 − 1.
typedef struct pvtSightQuad {
    uint8_t x0, y0, x1, y1;
} pvtSightQuad;

/// A rectangle that is not within the goal of its sight. It would be hidden wrongly.
typedef struct pvtWrongQuad {
    pvtSightQuad quad;
    float weight; ///< of what it has beyond the goal; one within the goal counts 1
} pvtWrongQuad;

/// An orthographic view: a point of the grid lies at pixel (dot(p, right) + x, dot(p, up) + y).
typedef struct pvtSight {
    float right[3], up[3]; ///< [px/vx]
    float x, y;            ///< [px]
    float pixelSize;       ///< [vx]
    float weight;          ///< that each of its rectangles has
    pvtSightMask goal;     ///< pixels that what could be hidden covers
    size_t firstQuad, quadCount;
    size_t firstWrong, wrongCount;
} pvtSight;

typedef struct pvtSightSet {
    pvtSight* sights; ///< in an order in which any few of them look from all sides
    size_t count;
    pvtSightQuad* quads; ///< each within the goal of its sight, drawn in proportion to its area
    size_t quadCount;
    pvtWrongQuad*
        wrongs; ///< those that reach beyond it, but not far; only where sights show a mesh
    size_t wrongCount;
    double share; ///< 0 to 1: of the sights that were asked for; fewer where there is much border
} pvtSightSet;

typedef struct pvtSightOptions {
    const pvtViewOptions* views; ///< how to spread them, or the list; `count` is not used
    int count;                   ///< of the sights, at most
    double stray;                ///< [vx] that rectangles beyond a goal of a mesh reach from it
    int quads;                   ///< that are drawn of each goal, whether they fit into it or not
    uint64_t seed;
} pvtSightOptions;

/// Of what is inside a field: its goals are larger than that by up to a pixel.
pvtStatus pvtCreateSights(pvtContext* context, const pvtSightOptions* options,
                          const pvtField* field, pvtSightSet* set);
/// Of a mesh: its goals are as large as that. They are seen from points of the frame's grid.
pvtStatus pvtCreateMeshSights(pvtContext* context, const pvtSightOptions* options,
                              const pvtGridFrame* frame, const pvtMesh* mesh, pvtSightSet* set);
void pvtSightSet_Free(pvtContext* context, pvtSightSet* set);

/// Cells of which all four pixels are set: one that is covered in part only could never be hidden
/// as a whole.
void pvtFindWholeCells(const pvtSightMask* mask, uint64_t cells[PVT_SIGHT_CELLS]);

/// Draws rectangles in proportion to their area, and keeps those within the cells that are set in
/// `rows`: at most `draws`, which `quads` has room for. Returns how many. `weight` tells what each
/// counts, such that sums over screens of any shape are those of pvtEvaluateOccluders.
size_t pvtDrawSightQuads(const uint64_t rows[PVT_SIGHT_CELLS], int draws, pvtRandom* random,
                         pvtSightQuad* quads, double* weight);

/// The same of those within `ring` cells of the goal that are not within its whole cells: `wrongs`
/// has room for `draws`. As by pvtEvaluateOccluders, each counts by its pixels beyond the goal.
size_t pvtDrawWrongQuads(const pvtSightMask* goal, int ring, int draws, pvtRandom* random,
                         pvtWrongQuad* wrongs);

#endif
