// SPDX-License-Identifier: MIT
// Triangles under construction, and a GLB writer that shares nothing with the library it tests.
#ifndef PVT_TEST_SHAPE_H
#define PVT_TEST_SHAPE_H

#include "mask.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct Point {
    double x, y, z; // [m], y up
} Point;

enum {
    SHAPE_MAX_POINTS = 8192,
    SHAPE_MAX_TRIANGLES = 8192,
    MODEL_MAX_SHAPES = 4,
    MODEL_MAX_NODES = 8
};

/// One mesh, with one node unless the model has nodes of its own. Counter-clockwise from outside.
typedef struct Shape {
    const char* name;
    Point translation; // of the node; the mesh is relative to it
    float positions[SHAPE_MAX_POINTS][3];
    uint16_t indices[SHAPE_MAX_TRIANGLES][3];
    uint32_t pointCount, triangleCount;
    bool isMasked;                        // its material has `mask` as an alpha mask
    float texCoords[SHAPE_MAX_POINTS][2]; // when it is masked
    Mask mask;
} Shape;

/// An instance of a shape: scaled, then turned around y by quarters from z to x, then moved.
typedef struct Node {
    const char* name; // "" has none in the file
    int shape;
    Point scale;
    int quarters;
    Point translation;
} Node;

typedef struct Model {
    Shape shapes[MODEL_MAX_SHAPES];
    int shapeCount;
    Node nodes[MODEL_MAX_NODES];
    int nodeCount; // 0: one for each shape
} Model;

Shape* AddShape(Model* model, const char* name, Point translation);
void AddNode(Model* model, const Node* node);
/// Node i of the model, or the one that shape i has.
Node GetNode(const Model* model, int i);
int GetNodeCount(const Model* model);
/// Rounds to 1/4096 m, so that no machine's sine can change a file. Returns the point's index.
uint32_t AddPoint(Shape* shape, Point point);
void AddTriangle(Shape* shape, uint32_t a, uint32_t b, uint32_t c);
void AddQuad(Shape* shape, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
/// Four points of its own.
void AddPanel(Shape* shape, Point a, Point b, Point c, Point d);
/// The same with texture coordinates: (0, 0) at the first, (repeatU, 0) at the second corner, and
/// so on. Only for masked shapes, all of whose points come from here.
void AddCard(Shape* shape, const Point corners[4], double repeatU, double repeatV);
/// False when the file cannot be written.
bool WriteGlb(const Model* model, const char* path);

#endif
