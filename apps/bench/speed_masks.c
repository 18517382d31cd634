// SPDX-License-Identifier: MIT
// The distance transform, with the sum over the distances that the measure takes.
#include "speed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PIXELS = 256 };

typedef struct MaskJob {
    uint64_t rows[MOST_PIXELS * MOST_PIXELS / 64];
    uint32_t* table;
    int size;
    uint64_t sum;
} MaskJob;

// A star with rounded rays, of about half the mask's area.
static void DrawBlob(MaskJob* job)
{
    const int size = job->size;
    memset(job->rows, 0, sizeof job->rows);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double u = (x + 0.5) / size - 0.5, v = (y + 0.5) / size - 0.5;
            const size_t bit = (size_t)y * (size_t)size + (size_t)x;
            if (hypot(u, v) < 0.4 * (1 + 0.2 * sin(5 * atan2(v, u)))) {
                job->rows[bit / 64] |= UINT64_C(1) << (bit % 64);
            }
        }
    }
}

static pvtStatus SumMask(void* passData)
{
    MaskJob* job = passData;
    job->sum += pvtSumDistances(job->rows, job->size, job->table);
    return PVT_OK;
}

static pvtStatus PrintMask(pvtRun* run, const pvtSpeedLine* line, MaskJob* job, const char* name)
{
    double seconds = 0;
    const pvtStatus status = pvtMeasurePass(run, line, SumMask, job, &seconds);
    if (status == PVT_OK) {
        char title[64];
        (void)snprintf(title, sizeof title, "distances of %d x %d pixels, %s", job->size, job->size,
                       name);
        pvtReport_ClearBar(&run->report);
        printf("%-40s %9.0f million pixels a second\n", title,
               (double)job->size * job->size / seconds * 1e-6);
        fflush(stdout);
    }
    return status;
}

static pvtStatus PrintMasks(pvtRun* run, const pvtSpeedLine* line, MaskJob* job)
{
    pvtStatus status = PVT_OK;
    for (job->size = 64; job->size <= MOST_PIXELS && status == PVT_OK; job->size *= 2) {
        pvtFillDistanceTable(job->size, 1, job->table);
        DrawBlob(job);
        status = PrintMask(run, line, job, "a blob");
        if (status == PVT_OK) {
            memset(job->rows, 0xFF, sizeof job->rows);
            status = PrintMask(run, line, job, "full");
        }
    }
    return status;
}

pvtStatus pvtPrintMaskSpeeds(pvtRun* run, const pvtSpeedLine* line)
{
    MaskJob job = {.table = calloc(pvtGetDistanceTableCount(MOST_PIXELS), sizeof *job.table)};
    if (job.table == NULL) {
        return pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory");
    }
    const pvtStatus status = PrintMasks(run, line, &job);
    free(job.table);
    return status;
}
