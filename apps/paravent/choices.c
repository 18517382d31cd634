// SPDX-License-Identifier: MIT
#include "choices.h"

#include "convention.h"

#include <paravent/io.h>
#include <paravent/occluder.h>
#include <stddef.h>

const char* const pvtAxisChoices[] = {
    [PVT_AXIS_X] = "x", [PVT_AXIS_Y] = "y", [PVT_AXIS_Z] = "z", NULL};
const char* const pvtMethodChoices[] = {
    [PVT_METHOD_PLANAR] = "planar", [PVT_METHOD_PAPER] = "paper", NULL};
const char* const pvtEffortChoices[] = {
    [PVT_EFFORT_FAST] = "fast", [PVT_EFFORT_DEFAULT] = "default", [PVT_EFFORT_BEST] = "best", NULL};
const char* const pvtMaskedChoices[] = {
    [PVT_MASKED_AUTO] = "auto", [PVT_MASKED_OPAQUE] = "opaque", [PVT_MASKED_SKIP] = "skip", NULL};
const char* const pvtConventionChoices[] = {
    [PVT_CONVENTION_PLAIN] = "plain", [PVT_CONVENTION_GODOT] = "godot", NULL};
