// SPDX-License-Identifier: MIT
// What the evaluator's tests look at.
#ifndef PVT_TEST_EVALUATE_SHAPES_H
#define PVT_TEST_EVALUATE_SHAPES_H

#include "check.h"

#include <math.h>
#include <paravent/evaluate.h>
#include <stdlib.h>
#include <string.h>

// A rectangle in the plane z, facing +z.
typedef struct Sheet {
    pvtVec3 positions[4];
    uint32_t indices[6];
} Sheet;

static inline Sheet MakeSheet(double x0, double y0, double x1, double y1, double z)
{
    return (Sheet){{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}, {0, 1, 2, 0, 2, 3}};
}

static inline pvtMesh GetMesh(Sheet* sheet)
{
    return (pvtMesh){sheet->positions, sheet->indices, 4, 2};
}

// A ball with bumps, of 2 × segments × segments triangles; its poles are on the y axis.
static inline pvtMesh CreateBall(int segments, double radius, pvtVec3 center)
{
    const size_t count = (size_t)segments * (size_t)(segments + 1);
    pvtMesh mesh = {malloc(count * sizeof(pvtVec3)),
                    malloc((size_t)segments * (size_t)segments * 6 * sizeof(uint32_t)), count, 0};
    for (int j = 0; j <= segments; ++j) {
        for (int i = 0; i < segments; ++i) {
            const double a = 2 * M_PI * i / segments, b = M_PI * j / segments;
            const double r = radius * (1.0 + 0.2 * sin(3 * a) * sin(2 * b));
            mesh.positions[j * segments + i] =
                (pvtVec3){center.x + r * sin(b) * cos(a), center.y + r * cos(b),
                          center.z + r * sin(b) * sin(a)};
        }
    }
    for (int j = 0; j < segments; ++j) {
        for (int i = 0; i < segments; ++i) {
            const uint32_t next = (uint32_t)((i + 1) % segments), here = (uint32_t)i;
            const uint32_t row = (uint32_t)(j * segments), above = row + (uint32_t)segments;
            uint32_t* to = mesh.indices + 3 * mesh.triangleCount;
            memcpy(to,
                   (uint32_t[6]){row + here, row + next, above + here, above + here, row + next,
                                 above + next},
                   6 * sizeof *to);
            mesh.triangleCount += 2;
        }
    }
    return mesh;
}

static inline void FreeBall(pvtMesh* mesh)
{
    free(mesh->positions);
    free(mesh->indices);
}

static inline pvtEvaluateOptions MakeOptions(int views, int quads, int pixels)
{
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = views;
    options.quads = quads;
    options.pixels = pixels;
    return options;
}

static inline void AssertScore(const pvtQuadScore* score, double precision, double recall)
{
    assert_true(score->precision == precision);
    assert_true(score->recall == recall);
}

#endif
