// SPDX-License-Identifier: MIT
// Surface voxels, what is inside them, and the closed mesh around it (paper, section 4.1).
#ifndef PARAVENT_VOXEL_H
#define PARAVENT_VOXEL_H

#include <paravent/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Where a grid stands: voxel (i, j, k) is the cube [i, i+1] × [j, j+1] × [k, k+1] times voxelSize
/// from origin. Counts along x, y, z.
typedef struct pvtGridFrame {
    pvtVec3 origin;   ///< [wu] the lower corner of voxel (0, 0, 0)
    double voxelSize; ///< [wu]
    int size[3];      ///< [vx]
} pvtGridFrame;

/// One bit a voxel, 64 voxels a word along x, lowest bit first. Row (y, z) starts at word
/// (z × size[1] + y) × wordsPerRow. Bits past size[0] are 0.
typedef struct pvtBitGrid {
    pvtGridFrame frame;
    uint64_t* words;
    size_t wordsPerRow;
    size_t wordCount; ///< wordsPerRow × size[1] × size[2]
} pvtBitGrid;

PVT_API void pvtBitGrid_Free(pvtContext* context, pvtBitGrid* grid);
/// False outside the grid.
PVT_API bool pvtBitGrid_Get(const pvtBitGrid* grid, int x, int y, int z);
PVT_API uint64_t pvtBitGrid_Count(const pvtBitGrid* grid);

typedef struct pvtVoxelizeOptions {
    int resolution;   ///< [vx] along the longest side of the bounds, 8 to 2048; default 256
    double voxelSize; ///< [wu] > 0: instead of resolution; default 0
    double padding;   ///< [wu] free space kept around the bounds, at least two voxels; default 0
} pvtVoxelizeOptions;

PVT_API pvtVoxelizeOptions pvtDefaultVoxelizeOptions(void);

/// Marks every voxel whose closed cube a triangle touches; rounding errors only ever mark more, and
/// none that is farther than 4e-9 voxels from a triangle along any axis. The bounds lie in the
/// middle of the frame, so that their faces fall inside voxels: a side of n whole voxels touches
/// n + 1 and leaves n − 1 untouched between its ends.
/// Degenerate triangles count as segments and points. PVT_LIMIT names the finest resolution that
/// would fit in memory; PVT_INVALID_INPUT for a mesh without triangles or of no extent at all.
PVT_API pvtStatus pvtVoxelizeMesh(pvtContext* context, const pvtVoxelizeOptions* options,
                                  const pvtMesh* mesh, pvtBitGrid* surface);

typedef enum pvtAxis { PVT_AXIS_X, PVT_AXIS_Y, PVT_AXIS_Z } pvtAxis;

typedef struct pvtSolidOptions {
    double smallestHole; ///< [wu] openings narrower than this count as closed; default 0
    bool ground;         ///< the plane below the surface's bounds counts as closed: a mirror, below
                         ///< which everything repeats, and nothing is inside; default false
    bool terrain;        ///< all below the lowest surface of a column is inside; default false
    bool strict;  ///< outside is what a walk of 2 voxels reaches from where a ball comes, too:
                  ///< no fillets stick out of shallow creases; default false
    int below;    ///< [vx] ≥ 0, for terrain: so far below the surface's bounds is inside, too,
                  ///< as far as the grid goes; default 0
    pvtAxis up;   ///< for ground and terrain; default y
    int enclosed; ///< 0 to 25 of the 26 directions: an outside voxel from which at most this
                  ///< many escape counts as inside; −1: off; default −1
} pvtSolidOptions;

/// What would fill a solid that came out hollow; all 0 when it is not, or when nothing would.
typedef struct pvtRemedy {
    double smallestHole; ///< [wu] > 0: this smallestHole closes the openings
    bool ground;         ///< the surface is open below: this option closes it, with or without
                         ///< the hole
    bool terrain;        ///< the surface looks like a landscape
} pvtRemedy;

/// What the surface encloses. `inside` holds the touched voxels too; the strict interior is
/// inside and not surface.
typedef struct pvtSolid {
    pvtBitGrid inside;
    pvtBitGrid surface;
    uint64_t insideCount;  ///< [vx] in `inside`
    uint64_t surfaceCount; ///< [vx]
    uint64_t strictCount;  ///< [vx] inside and not touched
    double insideFraction; ///< strictCount over the voxels of the surface's bounds
    pvtRemedy remedy;      ///< what would fill a hollow solid
} pvtSolid;

PVT_API pvtSolidOptions pvtDefaultSolidOptions(void);

/// Floods from the border through free voxels, 6-connected; what is not reached is inside.
/// With smallestHole D only a ball of diameter D plus half a voxel can pass: openings narrower than
/// D less half a voxel are closed, and nothing wider than D plus 4 voxels is ever covered. Warns,
/// with the option that would help, when a closed-looking mesh comes out hollow, and leaves it in
/// `remedy`. The result does not depend on how the surface was padded.
PVT_API pvtStatus pvtFillSolid(pvtContext* context, const pvtSolidOptions* options,
                               const pvtBitGrid* surface, pvtSolid* solid);
PVT_API void pvtSolid_Free(pvtContext* context, pvtSolid* solid);

/// Where an occluder may lie. tolerance 0: the strict interior. Above 0: the solid with its touched
/// voxels, and every voxel whose centre is within `tolerance` [wu] of the centre of one of those.
PVT_API pvtStatus pvtMakeAllowedGrid(pvtContext* context, const pvtSolid* solid, double tolerance,
                                     pvtBitGrid* allowed);

/// Voxels of a grid that are finer than the others: PVT_CELLS³ cells each.
typedef struct pvtCellGrid {
    pvtBitGrid voxels; ///< which
    uint32_t* ranks;   ///< one a word of `voxels`: how many are set in the words before it
    uint64_t* cells;   ///< one a voxel of these, in order: cell (i, j, k) is bit i + 4 j + 16 k
    uint64_t* border;  ///< the same of cells between inside and outside; null: not known
    size_t count;      ///< of voxels
} pvtCellGrid;

enum { PVT_CELLS = 4 };

/// The cells of a voxel; 0 outside of the grid, and for a voxel that is not one of these.
PVT_API uint64_t pvtCellGrid_Get(const pvtCellGrid* grid, int x, int y, int z);
/// The same of its border cells.
PVT_API uint64_t pvtCellGrid_GetBorder(const pvtCellGrid* grid, int x, int y, int z);
PVT_API void pvtCellGrid_Free(pvtContext* context, pvtCellGrid* grid);

/// Which part of the touched voxels is inside, judged at cells of a quarter of a voxel: what
/// outside and inside voxels reach through cells that no triangle touches, at equal speed, belongs
/// to the one that comes first, so that they meet in an opening narrower than a voxel; what is
/// neither outside nor has an outside cell among its 26 neighbours is inside. So surface that
/// nobody sees, as where the parts of a model overlap, is inside too. Cells that have an outside
/// one among their neighbours but are not outside themselves are the border: the surface passes
/// most of them. Voxels all of whose cells are inside are added to `allowed`, which was made by
/// pvtMakeAllowedGrid at tolerance 0; others with cells inside or on the border are put into
/// `cells`.
PVT_API pvtStatus pvtRefineAllowedGrid(pvtContext* context, const pvtMesh* mesh,
                                       const pvtSolid* solid, pvtBitGrid* allowed,
                                       pvtCellGrid* cells);

/// Which triangles may pass which voxels of a cell grid.
typedef struct pvtTouching {
    const pvtMesh* mesh; ///< borrowed
    uint32_t* starts;    ///< of each of the grid's voxels, and one more
    uint32_t* triangles; ///< of voxel v from starts[v] to before starts[v + 1], in order
} pvtTouching;

/// Every triangle that touches a voxel is listed there, and few others. PVT_LIMIT beyond 2³²
/// entries.
PVT_API pvtStatus pvtListTouching(pvtContext* context, const pvtMesh* mesh,
                                  const pvtCellGrid* cells, pvtTouching* touching);
PVT_API void pvtTouching_Free(pvtContext* context, pvtTouching* touching);

/// Squared distance [vx²] from each voxel's centre to the centre of the nearest marked voxel,
/// exact, one value a voxel in x, y, z order; values above `limit` [vx²] are stored as limit + 1.
/// `distances` has frame.size[0] × [1] × [2] entries.
PVT_API pvtStatus pvtTransformGridDistance(pvtContext* context, const pvtBitGrid* grid,
                                           uint32_t limit, uint32_t* distances);

/// Two triangles for each face between a set and a free voxel, wound towards the free one: closed
/// and 2-manifold, also where two voxels meet in an edge or a corner only.
PVT_API pvtStatus pvtBuildVoxelMesh(pvtContext* context, const pvtBitGrid* grid, pvtMesh* mesh);

#ifdef __cplusplus
}
#endif
#endif
