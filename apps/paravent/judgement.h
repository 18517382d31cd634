// SPDX-License-Identifier: MIT
// What `paravent evaluate` has found, and the ways to tell it: one file each.
#ifndef PVT_APP_JUDGEMENT_H
#define PVT_APP_JUDGEMENT_H

#include "json.h"

#include <paravent/evaluate.h>
#include <paravent/output.h>
#include <stdio.h>

/// An evaluation with the names of its files. Everything is borrowed.
typedef struct pvtJudgement {
    const pvtEvaluation* evaluation;
    const char* original;         ///< the path as given
    const char* const* occluders; ///< the paths as given
    const char* originalName;
    const char* const* names; ///< the occluders', short and different from each other, for people
    double* recalls;          ///< room for a number a view
} pvtJudgement;

/// Characters, of which each takes a column.
int pvtCountTextColumns(const char* text);
/// A name of at most so many characters: the end of a long one, which tells more than its
/// beginning. What is no UTF-8, or would steer a terminal, shows as '?'. `text` has room for 4 ×
/// columns + 8.
void pvtShortenName(const char* name, int columns, char* text, size_t size);

/// The table for people.
void pvtPrintScores(FILE* file, const pvtJudgement* judgement);

/// The object that `paravent evaluate --json` promises.
void pvtWriteScores(pvtJson* json, const pvtJudgement* judgement);
void pvtWriteScoresJson(pvtOutput* output, const pvtJudgement* judgement);
/// A line a view and occluder, RFC 4180.
void pvtWriteScoresCsv(pvtOutput* output, const pvtJudgement* judgement);
/// Recall over the views, sorted, a curve an occluder: SVG.
void pvtPlotRecall(pvtOutput* output, const pvtJudgement* judgement);

enum { PVT_SHEET_VIEWS = 12 };

/// Views by their numbers, and where they look: the same for all occluders.
typedef struct pvtSheetViews {
    size_t views[PVT_SHEET_VIEWS];
    pvtVec3 directions[PVT_SHEET_VIEWS];
    size_t count;
} pvtSheetViews;

/// The views to show: the worst of each occluder as far as there is room, then some at even steps
/// of their numbers, which are a fair sample since directions are random. In the order of the first
/// occluder's recall.
pvtSheetViews pvtChooseSheetViews(const pvtEvaluation* evaluation);

/// A picture a view, with sides of `size` pixels, of the original and an occluder.
pvtStatus pvtDrawSheetViews(pvtContext* context, const pvtSheetViews* chosen,
                            const pvtMesh* const meshes[2], int size, pvtImage* images);

enum { PVT_MOST_IN_SHEET = 27 };

/// A contact sheet: a block an occluder, the same views in each. `meshes` holds the original, then
/// the occluders, at most PVT_MOST_IN_SHEET: pictures have at most 32,768 pixels a side.
pvtStatus pvtMakeContactSheet(pvtContext* context, const pvtJudgement* judgement,
                              const pvtMesh* meshes, pvtImage* sheet);

#endif
