// SPDX-License-Identifier: MIT
// How nodes are called, so that engines know occluders when they see them.
#ifndef PVT_APP_CONVENTION_H
#define PVT_APP_CONVENTION_H

#include <stddef.h>

enum { PVT_CONVENTION_PLAIN, PVT_CONVENTION_GODOT };

/// "house" becomes "house_occluder", or "house-occonly" for Godot. `size` is at least 16; a longer
/// name is cut, its ending is not.
void pvtMakeNodeName(const char* base, int convention, char* name, size_t size);

/// Godot's import acts on "$noimp" and its like wherever they stand in a name: "$" becomes "_".
void pvtMakeNameHarmless(char* name);

#endif
