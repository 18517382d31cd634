// SPDX-License-Identifier: MIT
// How the faces around a corner of the voxel mesh share its vertices.
//
// On a small sphere around the corner the faces are arcs, and the half-edges are the points where
// arcs meet. Two arcs that meet alone continue each other. Where four meet, the set voxels touch
// along an edge only, and the arcs are paired: either the two of the same set voxel (apart), or
// the two of the same free voxel (joined). Each closed chain of arcs is one vertex.
//
// Apart is the rule. It fails where the two set voxels are connected around both ends of the edge
// by other voxels: then both copies of the edge would run between the same two vertices. Such an
// edge is joined instead, at both its ends. A corner that meets an edge twice has no other edge of
// four faces (the test tries all patterns), so joining one edge never disturbs another.
#include "voxel_mesh_table.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

typedef struct Octant {
    int side[3];
} Octant;

static bool IsSet(int pattern, Octant octant)
{
    return (pattern >> (octant.side[0] + 2 * octant.side[1] + 4 * octant.side[2]) & 1) != 0;
}

static int GetFace(int axis, Octant octant)
{
    return 4 * axis + octant.side[(axis + 1) % 3] + 2 * octant.side[(axis + 2) % 3];
}

// Chains are numbered by their least face while they grow together.
static void JoinFaces(uint8_t* chain, int a, int b)
{
    const uint8_t from = chain[a] > chain[b] ? chain[a] : chain[b];
    const uint8_t to = chain[a] > chain[b] ? chain[b] : chain[a];
    for (int face = 0; face < PVT_CORNER_FACES; ++face) {
        if (chain[face] == from) {
            chain[face] = to;
        }
    }
}

// The octant at `turn` quarters around a half-edge.
static Octant TurnAround(int axis, int side, int turn)
{
    Octant octant = {{0, 0, 0}};
    octant.side[axis] = side;
    octant.side[(axis + 1) % 3] = turn == 1 || turn == 2;
    octant.side[(axis + 2) % 3] = turn >= 2;
    return octant;
}

// The face between the octants at `turn` and `turn` + 1. The first coordinate that turns is the
// one after `axis`.
static int GetFaceAfter(int axis, int side, int turn)
{
    return GetFace((axis + 1 + turn % 2) % 3, TurnAround(axis, side, turn));
}

static bool HasFourFaces(int pattern, int axis, int side)
{
    const bool first = IsSet(pattern, TurnAround(axis, side, 0));
    return IsSet(pattern, TurnAround(axis, side, 1)) != first &&
           IsSet(pattern, TurnAround(axis, side, 2)) == first &&
           IsSet(pattern, TurnAround(axis, side, 3)) != first;
}

// Pairs the faces that meet in a half-edge.
static void JoinAtHalfEdge(uint8_t* chain, int pattern, int halfEdge, bool joined)
{
    const int axis = halfEdge / 2;
    const int side = halfEdge % 2;
    if (HasFourFaces(pattern, axis, side)) {
        // An octant lies between the faces before and after it.
        for (int turn = 0; turn < 4; ++turn) {
            if (IsSet(pattern, TurnAround(axis, side, turn)) != joined) {
                JoinFaces(chain, GetFaceAfter(axis, side, (turn + 3) % 4),
                          GetFaceAfter(axis, side, turn));
            }
        }
        return;
    }
    int last = -1;
    for (int turn = 0; turn < 4; ++turn) {
        const bool here = IsSet(pattern, TurnAround(axis, side, turn));
        const bool next = IsSet(pattern, TurnAround(axis, side, (turn + 1) % 4));
        if (here != next) {
            const int face = GetFaceAfter(axis, side, turn);
            if (last >= 0) {
                JoinFaces(chain, last, face);
            }
            last = face;
        }
    }
}

static bool IsBoundary(int pattern, int face)
{
    const int axis = face / 4;
    Octant octant = {{0, 0, 0}};
    octant.side[(axis + 1) % 3] = face & 1;
    octant.side[(axis + 2) % 3] = face >> 1 & 1;
    Octant other = octant;
    other.side[axis] = 1;
    return IsSet(pattern, octant) != IsSet(pattern, other);
}

static void FillCase(pvtCornerTable* table, int pattern, bool joined)
{
    uint8_t chain[PVT_CORNER_FACES];
    for (int face = 0; face < PVT_CORNER_FACES; ++face) {
        chain[face] = (uint8_t)face;
    }
    for (int halfEdge = 0; halfEdge < 6; ++halfEdge) {
        JoinAtHalfEdge(chain, pattern, halfEdge, joined);
    }
    const int entry = pattern + (joined ? PVT_CORNER_JOINED : 0);
    for (int face = 0; face < PVT_CORNER_FACES; ++face) {
        if (!IsBoundary(pattern, face)) {
            continue;
        }
        table->vertexOfFace[entry][face] = chain[face] == face
                                               ? table->vertexCount[entry]++
                                               : table->vertexOfFace[entry][chain[face]];
    }
}

static uint8_t FindDoubleEdge(const pvtCornerTable* table, int pattern)
{
    uint8_t found = PVT_NO_HALF_EDGE;
    for (int halfEdge = 0; halfEdge < 6; ++halfEdge) {
        const int axis = halfEdge / 2;
        const int side = halfEdge % 2;
        const uint8_t* vertex = table->vertexOfFace[pattern];
        // Opposite faces belong to different pairs, whichever way they are paired.
        if (HasFourFaces(pattern, axis, side) &&
            vertex[GetFaceAfter(axis, side, 0)] == vertex[GetFaceAfter(axis, side, 2)]) {
            assert(found == PVT_NO_HALF_EDGE);
            found = (uint8_t)halfEdge;
        }
    }
    return found;
}

void pvtMakeCornerTable(pvtCornerTable* table)
{
    memset(table, 0, sizeof *table);
    for (int pattern = 0; pattern < PVT_CORNER_PATTERNS; ++pattern) {
        FillCase(table, pattern, false);
        table->doubleEdge[pattern] = FindDoubleEdge(table, pattern);
        if (table->doubleEdge[pattern] != PVT_NO_HALF_EDGE) {
            FillCase(table, pattern, true);
        }
    }
}
