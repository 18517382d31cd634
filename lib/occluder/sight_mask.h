// SPDX-License-Identifier: MIT
// What triangles cover of a sight, and what they lack of its goal.
#ifndef PVT_OCCLUDER_SIGHT_MASK_H
#define PVT_OCCLUDER_SIGHT_MASK_H

#include "sights.h"
#include "triangle_set.h"

enum {
    PVT_MOST_SIGHT_CORNERS = 9 * 512 + 64, ///< of a set
    PVT_SIGHT_ENDS = PVT_SIGHT_CELLS + 1,  ///< of cells along a side
    PVT_SIGHT_STRIDE = 72,                 ///< of tables of cells
};

/// [px] where the corners are seen.
void pvtProjectCorners(const pvtSight* sight, const pvtTriangleSet* set, float (*places)[2]);

/// Adds a triangle, short of its open edges by `inset` [px], and tells the rows that it may cover.
pvtSightRows pvtDrawSightTriangle(const pvtTriangleSet* set, float (*places)[2], int triangle,
                                  float inset, pvtSightMask* mask);

/// sums[y][x]: pixels in the cells left of x and below y (PVT_SIGHT_ENDS of each).
void pvtSumMissing(const pvtSightMask* missing, uint16_t (*restrict sums)[PVT_SIGHT_STRIDE]);

/// The same of the pixels that are not set.
void pvtSumOpen(const pvtSightMask* mask, uint16_t (*restrict sums)[PVT_SIGHT_STRIDE]);

static inline unsigned pvtCountMissing(uint16_t (*sums)[PVT_SIGHT_STRIDE], const pvtSightQuad* quad)
{
    return (unsigned)(sums[quad->y1][quad->x1] - sums[quad->y0][quad->x1] -
                      sums[quad->y1][quad->x0] + sums[quad->y0][quad->x0]);
}

/// Of a rectangle, as pvtPullOptions tells.
static inline float pvtGetWorth(unsigned missing, float softness)
{
    return softness / (softness + (float)missing);
}

/// Of all rectangles of a sight.
double pvtSumWorths(const pvtSightSet* sights, const pvtSight* sight, const pvtSightMask* missing,
                    float softness);

/// Pixels of the goal that are not covered.
static inline void pvtFindMissing(const pvtSightMask* goal, const pvtSightMask* covered,
                                  pvtSightMask* missing)
{
    for (int half = 0; half < PVT_SIGHT_WORDS; ++half) {
        for (int y = 0; y < PVT_SIGHT_SIZE; ++y) {
            missing->words[half][y] = goal->words[half][y] & ~covered->words[half][y];
        }
    }
}

#endif
