// SPDX-License-Identifier: MIT
// How far a point lies inside what is allowed: coarse, quick to make and quick to ask.
#ifndef PVT_OCCLUDER_FIELD_H
#define PVT_OCCLUDER_FIELD_H

#include <paravent/voxel.h>

/// Signed distances at the centres of cubic nodes, in eighths of a node: above 0 inside. Exact to
/// about a tenth of a node next to the border; clamped at PVT_FIELD_BAND nodes from it.
typedef struct pvtField {
    int size[3];  ///< nodes along each axis
    int nodeSize; ///< [vx] along a node's side, 1, 2, 4, ...
    int8_t* depths;
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

/// The eight nodes around a point, and where between them it is.
typedef struct pvtFieldPlace {
    const int8_t* nodes;
    size_t row, layer; ///< from a node to the next along y and z
    float part[3];
} pvtFieldPlace;

static inline pvtFieldPlace pvtField_FindPlace(const pvtField* field, const float point[3])
{
    pvtFieldPlace place;
    size_t at[3];
    const float scale = 1.0F / (float)field->nodeSize;
    for (int axis = 0; axis < 3; ++axis) {
        const float most = (float)field->size[axis] - 1.001F;
        float value = point[axis] * scale - 0.5F;
        value = value > 0.0F ? value : 0.0F;
        value = value < most ? value : most;
        const int whole = (int)value;
        at[axis] = (size_t)whole;
        place.part[axis] = value - (float)whole;
    }
    place.row = (size_t)field->size[0];
    place.layer = place.row * (size_t)field->size[1];
    place.nodes = field->depths + at[2] * place.layer + at[1] * place.row + at[0];
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
        const int8_t* nodes = place->nodes + (i & 1) * place->row + (i >> 1) * place->layer;
        mixed[i] = pvtMix(nodes[0], nodes[1], place->part[0]);
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

#endif
