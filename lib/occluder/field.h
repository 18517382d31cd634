// SPDX-License-Identifier: MIT
// How far a point lies inside what is allowed: coarse, quick to make and quick to ask.
#ifndef PVT_OCCLUDER_FIELD_H
#define PVT_OCCLUDER_FIELD_H

#include <paravent/voxel.h>

/// Signed distances at the centres of cubic nodes, in eighths of a node: above 0 inside. Exact to
/// about a tenth of a node next to the border; clamped at PVT_FIELD_BAND nodes from it. Nodes are
/// kept in cubes of 4 × 4 × 4, a cache line each: points are looked up in no order.
typedef struct pvtField {
    int size[3];  ///< nodes along each axis
    int nodeSize; ///< [vx] along a node's side, 1, 2, 4, ...
    float scale;  ///< 1 ÷ nodeSize
    int8_t* depths;
    uint32_t* places[3]; ///< of a node in `depths`: the sum of one for each of its coordinates
} pvtField;

enum { PVT_FIELD_STEPS = 8, PVT_FIELD_BAND = 13 };

/// A field of at most `resolution` nodes along the longest side of the grid, unless voxels are
/// larger. `cells` may be null.
pvtStatus pvtCreateField(pvtContext* context, const pvtBitGrid* allowed, const pvtCellGrid* cells,
                         int resolution, pvtField* field);
void pvtField_Free(pvtContext* context, pvtField* field);

/// Depth [vx] at a point, as pvtField_GetDepth, with the unit direction in which it grows fastest;
/// 0 where there is none.
float pvtField_GetDepthAndInward(const pvtField* field, const float point[3], float inward[3]);

static inline int8_t pvtField_GetNode(const pvtField* field, int x, int y, int z)
{
    return field->depths[field->places[0][x] + field->places[1][y] + field->places[2][z]];
}

/// The eight nodes around a point, x first, and where between them it is.
typedef struct pvtFieldPlace {
    float nodes[8];
    float part[3];
} pvtFieldPlace;

static inline pvtFieldPlace pvtField_FindPlace(const pvtField* field, const float point[3])
{
    pvtFieldPlace place;
    const uint32_t* at[3];
    for (int axis = 0; axis < 3; ++axis) {
        const float most = (float)field->size[axis] - 1.001F;
        float value = point[axis] * field->scale - 0.5F;
        value = value > 0.0F ? value : 0.0F;
        value = value < most ? value : most;
        const int whole = (int)value;
        at[axis] = field->places[axis] + whole;
        place.part[axis] = value - (float)whole;
    }
    for (size_t i = 0; i < 4; ++i) {
        const int8_t* row = field->depths + at[1][i & 1] + at[2][i >> 1];
        place.nodes[2 * i] = row[at[0][0]];
        place.nodes[2 * i + 1] = row[at[0][1]];
    }
    return place;
}

static inline float pvtMix(float a, float b, float part)
{
    return a + (b - a) * part;
}

/// Between the nodes of each of the four pairs along x.
static inline void pvtMixAlongX(const pvtFieldPlace* place, float mixed[4])
{
    for (size_t i = 0; i < 4; ++i) {
        mixed[i] = pvtMix(place->nodes[2 * i], place->nodes[2 * i + 1], place->part[0]);
    }
}

/// [vx] at a point in grid coordinates, linear between nodes; outside of the grid as at its border.
static inline float pvtField_GetDepth(const pvtField* field, const float point[3])
{
    const pvtFieldPlace place = pvtField_FindPlace(field, point);
    float x[4];
    pvtMixAlongX(&place, x);
    const float front = pvtMix(x[0], x[1], place.part[1]), back = pvtMix(x[2], x[3], place.part[1]);
    return pvtMix(front, back, place.part[2]) * (float)field->nodeSize / PVT_FIELD_STEPS;
}

/// At least as much below pvtField_GetDepth as linear interpolation could be below the node that
/// the point lies in: a look at one node instead of eight.
static inline float pvtField_GetLeastDepth(const pvtField* field, const float point[3])
{
    uint32_t at = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float most = (float)(field->size[axis] - 1);
        float value = point[axis] * field->scale;
        value = value > 0.0F ? value : 0.0F;
        value = value < most ? value : most;
        at += field->places[axis][(int)value];
    }
    // Half a node along each axis: of the corners of that cube three each are one and √2 nodes
    // away, and one is √3.
    const float lower = 1.125F * PVT_FIELD_STEPS;
    return ((float)field->depths[at] - lower) * (float)field->nodeSize / PVT_FIELD_STEPS;
}

#endif
