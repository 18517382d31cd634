// SPDX-License-Identifier: MIT
// A surface that encloses nothing.
#ifndef PVT_TEST_HILLS_H
#define PVT_TEST_HILLS_H

#include "check.h"

#include <math.h>
#include <paravent/mesh.h>
#include <string.h>

static inline void AddQuad(uint32_t* indices, size_t* count, const uint32_t quad[4])
{
    const uint32_t two[6] = {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]};
    memcpy(indices + *count, two, sizeof two);
    *count += 6;
}

static inline double GetHillHeight(double x, double z)
{
    return 0.5 * sin(1.7 * x + 0.3) * cos(1.3 * z + 0.5);
}

/// Hills over 8 by 8, 24 by 24 quads.
static inline void MakeHills(pvtContext* context, pvtMesh* mesh)
{
    enum { N = 24, CORNERS = (N + 1) * (N + 1) };
    pvtVec3 positions[CORNERS];
    uint32_t indices[6 * N * N];
    size_t count = 0;
    for (uint32_t i = 0; i < CORNERS; ++i) {
        const double x = 8.0 * (i / (N + 1)) / N, z = 8.0 * (i % (N + 1)) / N;
        positions[i] = (pvtVec3){x, GetHillHeight(x, z), z};
    }
    for (uint32_t i = 0; i < N * N; ++i) {
        const uint32_t a = i / N * (N + 1) + i % N;
        AddQuad(indices, &count, (uint32_t[4]){a, a + 1, a + N + 2, a + N + 1});
    }
    CHECK_OK(context, pvtCreateMesh(context, positions, CORNERS, indices, count / 3, mesh));
}

#endif
