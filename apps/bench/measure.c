// SPDX-License-Identifier: MIT
// Medians, since other processes only ever make things slower, and some of the time.
#include "speed.h"

#include <math.h>
#include <stdlib.h>

// More than this many samples only make the median's place finer; further passes go into each.
enum { MOST_SAMPLES = 25 };

static int CompareSeconds(const void* left, const void* right)
{
    const double a = *(const double*)left;
    const double b = *(const double*)right;
    return (a > b) - (a < b);
}

static pvtStatus TimePasses(pvtPassFcn* pass, void* passData, long count, double* seconds)
{
    const double began = pvtGetClock();
    pvtStatus status = PVT_OK;
    for (long i = 0; i < count && status == PVT_OK; ++i) {
        status = pass(passData);
    }
    *seconds = (pvtGetClock() - began) / (double)count;
    return status;
}

pvtStatus pvtMeasurePass(pvtRun* run, const pvtSpeedLine* line, pvtPassFcn* pass, void* passData,
                         double* seconds)
{
    // The first pass fills caches, and tells how many passes there is time for.
    double first = 0;
    pvtStatus status = TimePasses(pass, passData, 1, &first);
    if (status != PVT_OK) {
        return status;
    }
    const double passes = line->seconds / fmax(first, 1e-7);
    const double wanted = fmax(fmin(floor(passes), MOST_SAMPLES), line->repeats);
    const size_t samples = (size_t)wanted;
    const long each = (long)fmax(floor(passes / wanted), 1.0);
    double* all = calloc(samples, sizeof *all);
    if (all == NULL) {
        return pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory");
    }
    for (size_t i = 0; i < samples && status == PVT_OK; ++i) {
        status = TimePasses(pass, passData, each, &all[i]);
        if (status == PVT_OK) {
            status = pvtRun_CheckCancelled(run);
        }
    }
    qsort(all, samples, sizeof *all, CompareSeconds);
    *seconds = (all[samples / 2] + all[(samples - 1) / 2]) / 2;
    free(all);
    return status;
}
