// SPDX-License-Identifier: MIT
// The refinement of occluders within a volume: all corners climb at once.
#ifndef PVT_OCCLUDER_ASCENT_H
#define PVT_OCCLUDER_ASCENT_H

#include "enough.h"
#include "inside.h"
#include "sheets.h"

typedef struct pvtAscentOptions {
    const pvtViewOptions* views;  ///< how they are spread, or a list
    const pvtBitGrid* goal;       ///< what there is to hide; borrowed; may be null
    const pvtCellGrid* goalCells; ///< parts of other voxels; borrowed; may be null
    bool mindsBeyond; ///< whether the inside reaches far beyond the goal, and triangles should not
    double mostWrong; ///< 0 to 1: the part of what triangles hide that the mesh need not; above 0
                      ///< what there is to hide is what the mesh hides, and no goal is needed
    double stray;     ///< [wu] that triangles may do from the touched voxels then
    const pvtInsideTest* inside;
    const pvtMesh* mesh;       ///< what the goal is of, another start; borrowed; may be null
                               ///< unless it is the goal
    const pvtMesh* flat;       ///< an occluder for this budget, another; borrowed; may be null
    const pvtSheetSet* sheets; ///< polygons on these stay where they are; borrowed; may be null
    int budget;                ///< triangles, at most PVT_MOST_ASCENT
    uint64_t seed;
    const size_t* startEnds; ///< of the occluder's polygons, where those of each start end
    int startCount;          ///< 1 or more: there is a climb from each
    int iterations;          ///< steps of all corners in each
    int cycles; ///< times that triangles are added to it and the least useful taken away again
    int sights; ///< views to learn from
    int batch;  ///< of these that a step looks at, 1 to 64
    int polish; ///< steps that follow the exact test, at last
    pvtEnough enough; ///< ends the steps
} pvtAscentOptions;

enum { PVT_MOST_ASCENT = 512 };

/// Triangles that the ascent of a budget likes to start from: it takes the least useful away.
int pvtGetAscentStart(int budget);

/// From the starts that the occluder's polygons are, moves the corners of all triangles so that
/// they hide more, and triangles to where they are worth more. Triangles leave the planes of their
/// polygons, and end inside. `planes` and `loops` keep those polygons of which a triangle is left.
/// The mesh has at most `budget` triangles afterwards.
pvtStatus pvtAscendOccluder(pvtContext* context, const pvtAscentOptions* options,
                            pvtOccluder* occluder);

#endif
