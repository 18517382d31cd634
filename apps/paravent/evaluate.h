// SPDX-License-Identifier: MIT
// The line of `paravent evaluate`.
#ifndef PVT_APP_EVALUATE_H
#define PVT_APP_EVALUATE_H

#include "run.h"

enum { PVT_MOST_OCCLUDERS = 64 };

typedef struct pvtEvaluateLine {
    pvtCommonOptions common;
    int views, quads, pixels;
    int masked; ///< a pvtMasked
    uint64_t seed;
    const char *json, *csv, *silhouettes, *plot, *report; ///< null: not asked for
} pvtEvaluateLine;

pvtEvaluateLine pvtDefaultEvaluateLine(void);
extern const pvtSyntax pvtEvaluateSyntax;

#endif
