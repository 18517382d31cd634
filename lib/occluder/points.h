// SPDX-License-Identifier: MIT
// Many points on their way to a mask, a group at a time.
#ifndef PVT_OCCLUDER_POINTS_H
#define PVT_OCCLUDER_POINTS_H

#include <stddef.h>
#include <stdint.h>

enum { PVT_POINT_GROUP = 64 };

/// What a view makes of points: pixel = dot(point, right or up) + offset.
typedef struct pvtPointProjection {
    float right[3], up[3], offset[2];
} pvtPointProjection;

/// [px] of points, which have an array an axis, from `first` on: the next `count`, at most a group.
void pvtProjectPoints(const pvtPointProjection* projection, float* const points[3], size_t first,
                      size_t count, float (*places)[PVT_POINT_GROUP]);

/// The pixels that points lie in, of a mask with `size` of them a row: row · size + column, and
/// size² for points beside the mask. At most a group of them.
void pvtFindPixels(const pvtPointProjection* projection, float* const points[3], size_t first,
                   size_t count, int size, int32_t* pixels);

#endif
