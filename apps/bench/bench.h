// SPDX-License-Identifier: MIT
// paravent-bench: what the developers measure with.
#ifndef PVT_BENCH_BENCH_H
#define PVT_BENCH_BENCH_H

#include "command.h"
#include "run.h"

#include <paravent/evaluate.h>
#include <paravent/occluder.h>

enum { PVT_MOST_MODELS = 64 };

typedef struct pvtQualityLine {
    pvtCommonOptions common;
    int budget, resolution;
    pvtLength tolerance, smallestHole;
    int views, quads, pixels;
    uint64_t seed;
} pvtQualityLine;

/// A way to an occluder of at most line->budget triangles. PVT_NOTHING_INSIDE is a result too.
typedef struct pvtBenchMethod {
    const char* name;
    pvtStatus (*make)(pvtRun* run, const pvtQualityLine* line, const pvtMesh* model,
                      pvtMesh* occluder);
} pvtBenchMethod;

enum { PVT_BENCH_METHOD_COUNT = 5 };
extern const pvtBenchMethod pvtBenchMethods[PVT_BENCH_METHOD_COUNT];

extern const pvtCommand pvtQualityCommand;

#endif
