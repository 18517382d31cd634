// SPDX-License-Identifier: MIT
// Models with alpha masks.
#ifndef PVT_TEST_MASKED_RECIPES_H
#define PVT_TEST_MASKED_RECIPES_H

#include "shape.h"

/// A box of 1.5 m behind a chain-link fence of 4 m by 2 m: two cards, 6 cm apart,
/// in a frame.
void MakeFence(Model* model);
/// A solid trunk of 3 m, and a crown of leaf cards: a cube of 2.4 m, closed but for its texture,
/// and crosses within.
void MakeLeafyTree(Model* model);

#endif
