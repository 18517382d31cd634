// SPDX-License-Identifier: MIT
// Triangles with common corners, what each hides from every view, and what a change would gain.
#ifndef PVT_OCCLUDER_FACETS_H
#define PVT_OCCLUDER_FACETS_H

#include "occlusion/mask.h"

enum {
    PVT_MAX_FACETS = 512,
    PVT_FACET_LAYERS = 4,
    PVT_FACET_ROWS = 64,         ///< of a mask, a word each
    PVT_MAX_CHANGED_FACETS = 24, ///< triangles around a corner that moves
    PVT_MAX_CHANGED_CORNERS = 2,
};

typedef uint32_t pvtFacetCorners[3];

/// The first `screenCount` views decide whether a change is worth a look, all of them whether it is
/// made: what gains only by falling between the pixels of a few views would not gain in pictures.
typedef struct pvtFacets {
    pvtMesh mesh; ///< positions are floats
    size_t viewCount, screenCount;
    pvtMaskFrame* frames;   ///< one a view
    double* factors;        ///< one a view: what a unit of pvtSumRectangles is worth
    uint64_t* masks;        ///< triangle × view × row
    uint8_t (*spans)[2];    ///< triangle × view: rows from the first to before the second
    uint64_t* layers;       ///< view × layer × row: covered at least once, twice, ...
    double* values;         ///< one a view
    double screened, total; ///< sums of values over the first views and over all
} pvtFacets;

/// Other corners, or other places, for some triangles.
typedef struct pvtFacetChange {
    int count;
    size_t triangles[PVT_MAX_CHANGED_FACETS];
    pvtFacetCorners corners[PVT_MAX_CHANGED_FACETS];
    int movedCount;
    uint32_t moved[PVT_MAX_CHANGED_CORNERS];
    pvtVec3 places[PVT_MAX_CHANGED_CORNERS];
    double screened, total; ///< what the facets would be worth
} pvtFacetChange;

typedef struct pvtFacetOptions {
    const pvtViewSet* screen; ///< borrowed
    const pvtViewSet* more;   ///< borrowed; may be empty
    pvtBox3 bounds;           ///< [wu] what the masks span
} pvtFacetOptions;

/// Copies a mesh of at most PVT_MAX_FACETS triangles. There are three positions a triangle: those
/// behind the mesh's own are spare.
pvtStatus pvtCreateFacets(pvtContext* context, const pvtFacetOptions* options, const pvtMesh* mesh,
                          pvtFacets* facets);
void pvtFacets_Free(pvtContext* context, pvtFacets* facets);
/// Bytes that pvtCreateFacets takes.
double pvtGetFacetBytes(size_t triangleCount, size_t viewCount);

/// Where a corner is after the change.
pvtVec3 pvtGetChangedPlace(const pvtFacets* facets, const pvtFacetChange* change, uint32_t corner);

/// Whether a change seems to gain in the first views; ends early when it clearly does not. Safe on
/// any thread, as the next is, as long as nothing is applied meanwhile.
bool pvtScreenFacetChange(const pvtFacets* facets, const pvtFacetChange* change);
/// Sets both values of the change, exactly those that the facets have after it.
void pvtEvaluateFacetChange(const pvtFacets* facets, pvtFacetChange* change);
void pvtApplyFacetChange(pvtContext* context, pvtFacets* facets, const pvtFacetChange* change);

#endif
