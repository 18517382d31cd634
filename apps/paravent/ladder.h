// SPDX-License-Identifier: MIT
// What the files of `paravent ladder` share.
#ifndef PVT_APP_LADDER_H
#define PVT_APP_LADDER_H

#include "generate.h"

#include <paravent/ladder.h>

enum { PVT_NAMING_MSFT, PVT_NAMING_SUFFIX };

/// The line, as it was read.
typedef struct pvtLadderLine {
    pvtGenerateOptions generate; ///< of which budget, error and deadline have no option here; a
                                 ///< tolerance below 0: none was given
    int levels;
    const char *errors, *budgets; ///< lists, or null
    double pixelError, fieldOfView;
    int screenHeight, screenWidth;
    bool withOriginal;
    int naming;
} pvtLadderLine;

extern const pvtSyntax pvtLadderSyntax;

pvtLadderLine pvtDefaultLadderLine(void);
/// What the line says about levels, with its lists read and checked against each other; their
/// number goes into the line too. PVT_INVALID_ARGUMENT names the option. `ladder->build` is left
/// alone.
pvtStatus pvtReadLevels(pvtRun* run, pvtLadderLine* options, const pvtParsedLine* line,
                        pvtLadderOptions* ladder);

/// Everything that a run of ladder has made.
typedef struct pvtLadderResult {
    const char* input;
    pvtModel model;
    pvtLadder ladder;
    double began, prepared, loaded, built, previewed, saved; ///< [s] on the clock
} pvtLadderResult;

/// The model's parts as nodes of their own.
typedef struct pvtOriginalParts {
    pvtMesh* meshes;
    pvtSaveItem* items; ///< names are the model's
    size_t count;
} pvtOriginalParts;
pvtStatus pvtCutOriginal(pvtRun* run, const pvtModel* model, pvtOriginalParts* parts);
void pvtOriginalParts_Free(pvtRun* run, pvtOriginalParts* parts);

/// A picture a level, with captions.
pvtStatus pvtDrawLadder(pvtRun* run, pvtGl* gl, const pvtLadderLine* options,
                        const pvtLadderResult* result, pvtImage* sheet);
/// The file with all levels, and the original beside them when it is asked for.
pvtStatus pvtSaveLadder(pvtRun* run, const pvtLadderLine* options, const pvtLadderResult* result);
pvtStatus pvtSaveLadderStats(pvtRun* run, const pvtLadderLine* options,
                             const pvtLadderResult* result);
/// A table for people.
void pvtPrintLadder(pvtRun* run, const pvtLadderLine* options, const pvtLadderResult* result);

#endif
