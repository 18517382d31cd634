// SPDX-License-Identifier: MIT
// Ladders of real models, seen by a camera: those of the project, and the bunny of the folder that
// PVT_MODELS names, with all defaults.
#include "perspective.h"

#include <paravent/io.h>
#include <stdlib.h>
#include <string.h>

static void CheckModel(const pvtLadderOptions* options, const char* folder, const char* name)
{
    pvtContext* context = CreateTestContext(0);
    char path[4096];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    pvtModel model;
    CHECK_OK(context, pvtLoadModel(context, NULL, path, &model));
    CheckLadderPictures(context, options, &model.mesh);
    pvtModel_Free(context, &model);
    DestroyTestContext(context);
}

static void models_of_the_project_show_no_error_at_their_levels_distances(void** state)
{
    (void)state;
    pvtLadderOptions options = pvtDefaultLadderOptions();
    options.build.resolution = 48;
    options.build.views.count = 4;
    options.build.effort = PVT_EFFORT_FAST;
    options.levelCount = 2;
    CheckModel(&options, PVT_TEST_MODELS, "boulder.glb");
    CheckModel(&options, PVT_TEST_MODELS, "building_kaykit_a.glb");
    options.build.smallestHole = (pvtLength){3.0, true};
    CheckModel(&options, PVT_TEST_MODELS, "tree.glb");
}

static void the_bunny_shows_no_error_at_its_levels_distances(void** state)
{
    (void)state;
    const char* folder = getenv("PVT_MODELS");
    if (folder == NULL) {
        skip();
    }
    const pvtLadderOptions options = pvtDefaultLadderOptions();
    CheckModel(&options, folder, "bunny_npm_3674.glb");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_of_the_project_show_no_error_at_their_levels_distances),
        cmocka_unit_test(the_bunny_shows_no_error_at_its_levels_distances),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
