// SPDX-License-Identifier: MIT
#include "judgement.h"

static void AddView(pvtSheetViews* chosen, size_t view)
{
    for (size_t i = 0; i < chosen->count; ++i) {
        if (chosen->views[i] == view) {
            return;
        }
    }
    if (chosen->count < PVT_SHEET_VIEWS) {
        chosen->views[chosen->count++] = view;
    }
}

static double GetRecall(const pvtOccluderScore* score, size_t view)
{
    return score->views[view].uniform.recall;
}

// By the recall of the first occluder; ties: by number. Views are few, and a selection sort of the
// dozen that is shown needs no order of all.
static void SortViews(const pvtOccluderScore* score, pvtSheetViews* chosen)
{
    for (size_t i = 0; i < chosen->count; ++i) {
        size_t least = i;
        for (size_t k = i + 1; k < chosen->count; ++k) {
            const double a = GetRecall(score, chosen->views[k]);
            const double b = GetRecall(score, chosen->views[least]);
            if (a < b || (a == b && chosen->views[k] < chosen->views[least])) {
                least = k;
            }
        }
        const size_t view = chosen->views[least];
        chosen->views[least] = chosen->views[i];
        chosen->views[i] = view;
    }
}

pvtSheetViews pvtChooseSheetViews(const pvtEvaluation* evaluation)
{
    pvtSheetViews chosen = {0};
    const size_t all = evaluation->occluders[0].viewCount;
    for (size_t i = 0; i < evaluation->count; ++i) {
        AddView(&chosen, evaluation->occluders[i].worstView);
    }
    for (size_t k = 0; k < PVT_SHEET_VIEWS; ++k) {
        AddView(&chosen, k * all / PVT_SHEET_VIEWS);
    }
    for (size_t v = 0; v < all && v < 2 * PVT_SHEET_VIEWS; ++v) {
        AddView(&chosen, v);
    }
    SortViews(&evaluation->occluders[0], &chosen);
    for (size_t i = 0; i < chosen.count; ++i) {
        chosen.directions[i] = evaluation->occluders[0].views[chosen.views[i]].direction;
    }
    return chosen;
}

pvtStatus pvtDrawSheetViews(pvtContext* context, const pvtSheetViews* chosen,
                            const pvtMesh* const meshes[2], int size, pvtImage* images)
{
    pvtSilhouetteOptions options = pvtDefaultSilhouetteOptions();
    options.directions = chosen->directions;
    options.count = chosen->count;
    options.width = options.height = size;
    return pvtDrawSilhouettes(context, &options, meshes[0], meshes[1], images);
}
