// SPDX-License-Identifier: MIT
#include "masked_recipes.h"

#include "base/random.h"

#include <math.h>

#define PI 3.14159265358979323846

static void AddBlock(Shape* shape, Point lower, Point upper)
{
    const double x[2] = {lower.x, upper.x}, y[2] = {lower.y, upper.y}, z[2] = {lower.z, upper.z};
    static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int i = 0; i < 6; ++i) {
        Point p[4];
        for (int k = 0; k < 4; ++k) {
            const int corner = faces[i][k];
            p[k] = (Point){x[corner & 1], y[corner >> 1 & 1], z[corner >> 2]};
        }
        AddPanel(shape, p[0], p[1], p[2], p[3]);
    }
}

static Shape* AddMaskedShape(Model* model, const char* name)
{
    Shape* shape = AddShape(model, name, (Point){0, 0, 0});
    shape->isMasked = true;
    return shape;
}

// Two diagonal wires across each tile.
static void DrawMesh(Mask* mask)
{
    enum { WIRE = 10 };
    for (int y = 0; y < MASK_SIZE; ++y) {
        for (int x = 0; x < MASK_SIZE; ++x) {
            const int up = (x + y + WIRE / 2) % MASK_SIZE;
            const int down = (x - y + WIRE / 2 + MASK_SIZE) % MASK_SIZE;
            mask->isOpaque[y][x] = up < WIRE || down < WIRE;
        }
    }
}

// Steel strips all around, without which the space between the cards would be open anyhow.
static void AddFrame(Shape* shape, double half, double height, double depth)
{
    const Point rim[4] = {{-half, 0, 0}, {half, 0, 0}, {half, height, 0}, {-half, height, 0}};
    for (int i = 0; i < 4; ++i) {
        const Point a = rim[i], b = rim[(i + 1) % 4];
        AddPanel(shape, (Point){a.x, a.y, -depth}, (Point){b.x, b.y, -depth},
                 (Point){b.x, b.y, depth}, (Point){a.x, a.y, depth});
    }
}

void MakeFence(Model* model)
{
    const double half = 2.0, height = 2.0, depth = 0.03;
    AddBlock(AddShape(model, "box", (Point){0, 0, 0}), (Point){-0.75, 0, -3}, (Point){0.75, 1, -2});
    AddFrame(AddShape(model, "frame", (Point){0, 0, 0}), half, height, depth);
    Shape* fence = AddMaskedShape(model, "fence");
    DrawMesh(&fence->mask);
    for (int side = -1; side <= 1; side += 2) {
        const Point corners[4] = {{-half * side, 0, depth * side},
                                  {half * side, 0, depth * side},
                                  {half * side, height, depth * side},
                                  {-half * side, height, depth * side}};
        AddCard(fence, corners, 16, 8);
    }
}

// Ellipses that point in any direction; no sines, which are not the same on every machine.
static void DrawLeaves(Mask* mask)
{
    enum { LEAVES = 34 };
    pvtRandom random = pvtMakeRandom(3, 1);
    for (int leaf = 0; leaf < LEAVES; ++leaf) {
        const double centerX = MASK_SIZE * pvtRandom_Unit(&random);
        const double centerY = MASK_SIZE * pvtRandom_Unit(&random);
        const double p = pvtRandom_Unit(&random) - 0.5, q = pvtRandom_Unit(&random) - 0.5;
        const double c = p / sqrt(p * p + q * q), s = q / sqrt(p * p + q * q);
        for (int y = 0; y < MASK_SIZE; ++y) {
            for (int x = 0; x < MASK_SIZE; ++x) {
                const double dx = x - centerX, dy = y - centerY;
                const double along = (c * dx + s * dy) / 8.0, across = (c * dy - s * dx) / 3.0;
                mask->isOpaque[y][x] =
                    mask->isOpaque[y][x] || along * along + across * across < 1.0;
            }
        }
    }
}

static void AddTrunk(Shape* shape, double radius, double height)
{
    enum { SIDES = 12 };
    const uint32_t bottom = AddPoint(shape, (Point){0, 0, 0});
    const uint32_t top = AddPoint(shape, (Point){0, height, 0});
    for (int i = 0; i < SIDES; ++i) {
        const double angle = 2.0 * PI * i / SIDES;
        const double x = radius * cos(angle), z = radius * sin(angle);
        AddPoint(shape, (Point){x, 0, z});
        AddPoint(shape, (Point){x, height, z});
    }
    for (uint32_t i = 0; i < SIDES; ++i) {
        const uint32_t a = top + 1 + 2 * i, b = top + 1 + 2 * ((i + 1) % SIDES);
        AddQuad(shape, a, a + 1, b + 1, b);
        AddTriangle(shape, bottom, a, b);
        AddTriangle(shape, top, b + 1, a + 1);
    }
}

void MakeLeafyTree(Model* model)
{
    AddTrunk(AddShape(model, "trunk", (Point){0, 0, 0}), 0.3, 3.0);
    Shape* leaves = AddMaskedShape(model, "leaves");
    for (int y = 0; y < MASK_SIZE; ++y) {
        for (int x = 0; x < MASK_SIZE; ++x) {
            leaves->mask.isOpaque[y][x] = false;
        }
    }
    DrawLeaves(&leaves->mask);
    const double middle = 3.8, half = 1.2;
    // Three pairs of faces and, at half their distance, three crosses.
    for (int axis = 0; axis < 3; ++axis) {
        for (int step = -2; step <= 2; ++step) {
            if (step == 0) {
                continue;
            }
            Point corners[4];
            for (int k = 0; k < 4; ++k) {
                const double u = k == 1 || k == 2 ? half : -half, v = k >= 2 ? half : -half;
                const double at = 0.5 * step * half;
                const double p[3] = {at, u, v};
                corners[k] =
                    (Point){p[(3 - axis) % 3], middle + p[(4 - axis) % 3], p[(5 - axis) % 3]};
            }
            AddCard(leaves, corners, 3, 3);
        }
    }
}
