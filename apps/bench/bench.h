// SPDX-License-Identifier: MIT
// paravent-bench: what the developers measure with.
#ifndef PVT_BENCH_BENCH_H
#define PVT_BENCH_BENCH_H

#include "command.h"
#include "generate.h"
#include "run.h"
#include "targets.h"

#include <paravent/evaluate.h>
#include <paravent/occluder.h>

enum { PVT_MOST_MODELS = 64 };

/// What makes an occluder, for every subcommand: the first member of its options struct. Fields
/// that no option here fills keep their defaults.
typedef pvtGenerateOptions pvtBenchLine;

/// --budget, --resolution and --tolerance; pvtSolidOptionTable has the others.
extern const pvtOption pvtBenchOptionTable[];
enum { PVT_BENCH_OPTION_COUNT = 3 };

pvtBuildOptions pvtGetBenchBuildOptions(const pvtBenchLine* line, pvtMethod method);

/// Where an occluder of the mesh may lie, at a resolution that need not be the line's.
pvtStatus pvtMakeBenchGrid(pvtRun* run, const pvtBenchLine* line, int resolution,
                           const pvtMesh* mesh, pvtBitGrid* allowed);

typedef struct pvtQualityLine {
    pvtBenchLine bench;
    int views, quads, pixels;
    uint64_t seed;
} pvtQualityLine;

/// A way to an occluder of at most line->budget triangles. PVT_NOTHING_INSIDE is a result too.
typedef struct pvtBenchMethod {
    const char* name;
    pvtStatus (*make)(pvtRun* run, const pvtBenchLine* line, const pvtMesh* model,
                      pvtMesh* occluder);
} pvtBenchMethod;

enum { PVT_BENCH_METHOD_COUNT = 5 };
extern const pvtBenchMethod pvtBenchMethods[PVT_BENCH_METHOD_COUNT];

extern const pvtCommand pvtQualityCommand;
extern const pvtCommand pvtSpeedCommand;

#endif
