// SPDX-License-Identifier: MIT
// Everything that needs nothing but the C library. gl.h and io.h belong to their own targets.
#ifndef PARAVENT_PARAVENT_H
#define PARAVENT_PARAVENT_H

#include <paravent/base.h>
#include <paravent/evaluate.h>
#include <paravent/image.h>
#include <paravent/ladder.h>
#include <paravent/mesh.h>
#include <paravent/occluder.h>
#include <paravent/occlusion.h>
#include <paravent/output.h>
#include <paravent/section.h>
#include <paravent/separate.h>
#include <paravent/voxel.h>

#endif
