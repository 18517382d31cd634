// SPDX-License-Identifier: MIT
// What the files of `paravent-bench speed` share.
#ifndef PVT_BENCH_SPEED_H
#define PVT_BENCH_SPEED_H

#include "bench.h"

typedef struct pvtSpeedLine {
    pvtBenchLine bench;
    int repeats;    ///< least number of a small measurement
    double seconds; ///< [s] that a small measurement should take, after a first pass
    bool againstPaper;
    int paperResolution; ///< [vx] of that comparison
} pvtSpeedLine;

/// One pass of something small.
typedef pvtStatus pvtPassFcn(void* passData);

/// The median of the seconds that a pass takes.
pvtStatus pvtMeasurePass(pvtRun* run, const pvtSpeedLine* line, pvtPassFcn* pass, void* passData,
                         double* seconds);

/// Prints the lines on slices of the solid of `path`, or of a ball when that is null.
pvtStatus pvtPrintSliceSpeeds(pvtRun* run, const pvtSpeedLine* line, const char* path);
/// Prints the lines on the distance transform.
pvtStatus pvtPrintMaskSpeeds(pvtRun* run, const pvtSpeedLine* line);
/// Print the lines on whole builds; return an exit code. Each build is a run of its own, so that
/// its peak of memory is.
int pvtPrintBuildSpeeds(const pvtSpeedLine* line, const char* const* paths, int count);
int pvtPrintPaperSpeeds(const pvtSpeedLine* line, const char* const* paths, int count);

#endif
