// SPDX-License-Identifier: MIT
// Cuts triangles with an alpha mask to the pieces that block the view.
#ifndef PVT_IO_MASK_CUT_H
#define PVT_IO_MASK_CUT_H

#include "alpha.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pvtMaskedCorner {
    pvtVec3 position; ///< finite
    double texel[2];  ///< texture coordinates × size of the image; may be anything
} pvtMaskedCorner;

typedef struct pvtMaskedTriangle {
    pvtMaskedCorner corners[3];
    int threshold; ///< the least alpha that is opaque, 0 to 256; 256: none is
} pvtMaskedTriangle;

/// How closely to look. The pieces never hold anything that is not opaque; coarser rules only make
/// them fewer and smaller.
typedef struct pvtCutRules {
    double cell;      ///< cells of the texture are taken together up to this length; 0: none are
    int extraLevels;  ///< and so many times twice that
    size_t maxPieces; ///< of one triangle
} pvtCutRules;

typedef struct pvtPiecePoint {
    pvtVec3 position;
    int corner; ///< of the triangle, 0 to 2; −1 for a point between them
} pvtPiecePoint;

/// A convex polygon, wound as its triangle. Wherever a corner of another piece lies on one of its
/// edges there is a point, so that no crack opens between them when they are drawn; a fan around
/// its first point keeps it so.
typedef struct pvtPiece {
    size_t first; ///< among the set's points
    size_t count;
} pvtPiece;

/// Opaque cells of one row side by side, or of several rows that are alike.
typedef struct pvtAlphaRun {
    int64_t begin, end;            ///< columns
    int64_t row;                   ///< the first
    size_t firstBreak, breakCount; ///< where runs of the row before it begin and end along it
} pvtAlphaRun;

/// What came of one triangle, with the room for it. Zero to begin with; to be used again.
typedef struct pvtPieceSet {
    pvtPiece* pieces;
    pvtPiecePoint* points;
    size_t count, pointCount;
    bool isWhole;   ///< opaque throughout; there are no pieces then
    bool isTooMany; ///< more than the rules allow: look less closely
    size_t pieceRoom, pointRoom;
    pvtAlphaRun* runs[2];
    int64_t* breaks;
    size_t runRoom, breakCount, breakRoom;
    size_t cellCount; ///< cells that were looked at, over all triangles
} pvtPieceSet;

pvtStatus pvtCutMaskedTriangle(pvtContext* context, const pvtAlphaMap* map,
                               const pvtCutRules* rules, const pvtMaskedTriangle* triangle,
                               pvtPieceSet* set);
void pvtPieceSet_Free(pvtContext* context, pvtPieceSet* set);

#ifdef __cplusplus
}
#endif
#endif
