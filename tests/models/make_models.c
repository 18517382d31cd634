// SPDX-License-Identifier: MIT
// Writes the project's own models: make_models FOLDER.
#include "recipes.h"

#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv)
{
    if (argc != 2) {
        (void)fprintf(stderr, "usage: make_models FOLDER\n");
        return 1;
    }
    Model* model = malloc(sizeof *model);
    int failed = model == NULL;
    for (int i = 0; i < RECIPE_COUNT && !failed; ++i) {
        char path[4096];
        model->shapeCount = 0;
        model->nodeCount = 0;
        RECIPES[i].make(model);
        (void)snprintf(path, sizeof path, "%s/%s.glb", argv[1], RECIPES[i].name);
        if (!WriteGlb(model, path)) {
            (void)fprintf(stderr, "make_models: cannot write %s\n", path);
            failed = 1;
        }
    }
    free(model);
    return failed;
}
