// SPDX-License-Identifier: MIT
// How good is an occluder: precision, recall, coverage, over-occlusion (paper, section 6.1). The
// definitions stand in lib/PIPELINE.md, so that another program can reproduce the numbers.
#ifndef PARAVENT_EVALUATE_H
#define PARAVENT_EVALUATE_H

#include <paravent/image.h>
#include <paravent/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pvtEvaluateOptions {
    int views;     ///< 1 to 65536 random directions; default 256
    int quads;     ///< 1 to 10,000,000 quads a view of each family; default 32000
    int pixels;    ///< 16 to 4096 along the longer side of the original's screen box; default 512
    uint64_t seed; ///< default 1
    const pvtVec3* directions; ///< null: random; else `views` directions to look along, of any
                               ///< length > 0; borrowed; default null
} pvtEvaluateOptions;

/// Fractions of 1. Precision is 1 when the occluder hides no quad, recall is 1 when the original
/// hides none. The errors are standard errors of the sampling: over views and quads, or over the
/// quads alone where the views are given or there is only one.
typedef struct pvtQuadScore {
    double precision, recall;
    double precisionError, recallError;
    uint64_t hidden; ///< [px] Nt: of quads that both hide
    uint64_t lost;   ///< [px] Pf: of quads that only the original hides
    uint64_t wrong;  ///< [px] Nf: of quads that only the occluder hides, what the original leaves
} pvtQuadScore;

typedef struct pvtViewScore {
    pvtVec3 direction;
    pvtQuadScore uniform, small;
    double coverage;      ///< of the original's pixels; 1 when it has none
    double overArea;      ///< [wu²] covered by the occluder alone
    double overThickness; ///< [wu] largest distance of such a pixel from the original's silhouette
} pvtViewScore;

typedef struct pvtOccluderScore {
    size_t triangleCount;
    pvtQuadScore uniform, small; ///< counts summed over all views
    double coverage, overArea;   ///< mean over the views
    double coverageError;        ///< standard error over the views; 0 where they are given
    double overThickness;        ///< [wu] the largest of all views
    size_t worstView;            ///< the lowest uniform recall; ties: the first
    pvtViewScore* views;         ///< viewCount
    size_t viewCount;
} pvtOccluderScore;

typedef struct pvtEvaluation {
    pvtEvaluateOptions options; ///< directions is null here: see the views
    size_t originalTriangleCount;
    pvtOccluderScore* occluders; ///< one for each mesh handed in, same views, same quads
    size_t count;
} pvtEvaluation;

PVT_API pvtEvaluateOptions pvtDefaultEvaluateOptions(void);

/// Judges `occluders` against `original`; neither has to be made by this library. An occluder may
/// be empty. PVT_INVALID_INPUT for an original without triangles, and for a triangle that uses a
/// position that is not there, not finite, or beyond ±10¹⁰⁰.
PVT_API pvtStatus pvtEvaluateOccluders(pvtContext* context, const pvtEvaluateOptions* options,
                                       const pvtMesh* original, const pvtMesh* occluders,
                                       size_t count, pvtEvaluation* evaluation);
PVT_API void pvtEvaluation_Free(pvtContext* context, pvtEvaluation* evaluation);

typedef struct pvtSilhouetteOptions {
    const pvtVec3* directions; ///< to look along, of any length > 0, as the evaluation does
    size_t count;
    int width, height; ///< [px] of each picture, 16 to 4096; default 512
    int margin;        ///< [px] left free at each side, less than a quarter; default 8
} pvtSilhouetteOptions;

PVT_API pvtSilhouetteOptions pvtDefaultSilhouetteOptions(void);

/// A picture a direction, in the colours of the paper's figure 7: original black, where the
/// occluder covers it yellow, the occluder alone blue, on white. Both fit into each picture, edges
/// are smoothed. Fills `images`, of which there are options->count.
PVT_API pvtStatus pvtDrawSilhouettes(pvtContext* context, const pvtSilhouetteOptions* options,
                                     const pvtMesh* original, const pvtMesh* occluder,
                                     pvtImage* images);

#ifdef __cplusplus
}
#endif
#endif
