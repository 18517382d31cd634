// SPDX-License-Identifier: MIT
// How good an occluder is, as `evaluate` tells.
#ifndef PVT_TEST_SCORE_H
#define PVT_TEST_SCORE_H

#include "check.h"

#include <paravent/evaluate.h>

/// Of 4,000 uniform quads in each of so many views.
static inline pvtQuadScore ScoreUniform(pvtContext* context, const pvtMesh* mesh,
                                        const pvtMesh* occluder, int views)
{
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = views;
    options.quads = 4000;
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, mesh, occluder, 1, &evaluation));
    const pvtQuadScore score = evaluation.occluders[0].uniform;
    pvtEvaluation_Free(context, &evaluation);
    return score;
}

#endif
