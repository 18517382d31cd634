// SPDX-License-Identifier: MIT
#include "stages.h"

#include <math.h>
#include <stdio.h>

typedef struct Stage {
    const char* name;
    size_t offset; // of its seconds in pvtBuildStats
} Stage;

#define STAGE(field)                                                                               \
    {                                                                                              \
#field, offsetof(pvtBuildStats, seconds.field)                                             \
    }

// In the order in which they pass, the total behind them.
static const Stage stages[] = {
    STAGE(voxelize), STAGE(solid),  STAGE(sections), STAGE(chains),
    STAGE(select),   STAGE(refine), STAGE(check),    STAGE(total),
};

_Static_assert(sizeof stages / sizeof *stages == PVT_STAGE_COUNT + 1,
               "the count in stages.h follows the table");
_Static_assert(sizeof((pvtBuildStats*)NULL)->seconds == (PVT_STAGE_COUNT + 1) * sizeof(double),
               "every stage of a build is in the table");

static double GetSeconds(const pvtBuildStats* stats, int stage)
{
    return *(const double*)((const char*)stats + stages[stage].offset);
}

static void SetSeconds(pvtBuildStats* stats, int stage, double seconds)
{
    *(double*)((char*)stats + stages[stage].offset) = seconds;
}

void pvtWriteStage(pvtJson* json, const char* stage, double seconds)
{
    pvtJson_Number(json, stage, round(seconds * 1e6) / 1e6);
}

void pvtWriteStages(pvtJson* json, const pvtBuildStats* stats)
{
    for (int i = 0; i < PVT_STAGE_COUNT; ++i) {
        pvtWriteStage(json, stages[i].name, GetSeconds(stats, i));
    }
}

void pvtPrintStages(const pvtBuildStats* stats, char text[PVT_STAGES_TEXT_SIZE])
{
    size_t used = 0;
    for (int i = 0; i < PVT_STAGE_COUNT && used < PVT_STAGES_TEXT_SIZE; ++i) {
        used += (size_t)snprintf(text + used, PVT_STAGES_TEXT_SIZE - used, "%s%s %.3f",
                                 i == 0 ? "" : ", ", stages[i].name, GetSeconds(stats, i));
    }
}

void pvtAddSeconds(pvtBuildStats* sum, const pvtBuildStats* stats)
{
    for (int i = 0; i <= PVT_STAGE_COUNT; ++i) {
        SetSeconds(sum, i, GetSeconds(sum, i) + GetSeconds(stats, i));
    }
}

void pvtScaleSeconds(pvtBuildStats* stats, double factor)
{
    for (int i = 0; i <= PVT_STAGE_COUNT; ++i) {
        SetSeconds(stats, i, GetSeconds(stats, i) * factor);
    }
}
