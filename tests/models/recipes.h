// SPDX-License-Identifier: MIT
// The project's own models by name.
#ifndef PVT_TEST_RECIPES_H
#define PVT_TEST_RECIPES_H

#include "shape.h"

typedef struct Recipe {
    const char* name;
    void (*make)(Model* model); // adds shapes to an empty model
} Recipe;

enum { RECIPE_COUNT = 9 };
extern const Recipe RECIPES[RECIPE_COUNT];

/// Null when there is none.
const Recipe* FindRecipe(const char* name);

#endif
