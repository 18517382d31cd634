// SPDX-License-Identifier: MIT
#include "shape.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

Shape* AddShape(Model* model, const char* name, Point translation)
{
    assert(model->shapeCount < MODEL_MAX_SHAPES);
    Shape* shape = &model->shapes[model->shapeCount++];
    shape->name = name;
    shape->translation = translation;
    shape->pointCount = 0;
    shape->triangleCount = 0;
    shape->isMasked = false;
    return shape;
}

void AddNode(Model* model, const Node* node)
{
    assert(model->nodeCount < MODEL_MAX_NODES);
    model->nodes[model->nodeCount++] = *node;
}

int GetNodeCount(const Model* model)
{
    return model->nodeCount > 0 ? model->nodeCount : model->shapeCount;
}

Node GetNode(const Model* model, int i)
{
    if (model->nodeCount > 0) {
        return model->nodes[i];
    }
    const Shape* shape = &model->shapes[i];
    return (Node){shape->name, i, {1.0, 1.0, 1.0}, 0, shape->translation};
}

static float Snap(double value)
{
    return (float)(floor(value * 4096.0 + 0.5) / 4096.0);
}

uint32_t AddPoint(Shape* shape, Point point)
{
    assert(shape->pointCount < SHAPE_MAX_POINTS);
    float* position = shape->positions[shape->pointCount];
    position[0] = Snap(point.x);
    position[1] = Snap(point.y);
    position[2] = Snap(point.z);
    return shape->pointCount++;
}

void AddTriangle(Shape* shape, uint32_t a, uint32_t b, uint32_t c)
{
    assert(shape->triangleCount < SHAPE_MAX_TRIANGLES);
    uint16_t* triangle = shape->indices[shape->triangleCount++];
    triangle[0] = (uint16_t)a;
    triangle[1] = (uint16_t)b;
    triangle[2] = (uint16_t)c;
}

void AddQuad(Shape* shape, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    AddTriangle(shape, a, b, c);
    AddTriangle(shape, a, c, d);
}

void AddPanel(Shape* shape, Point a, Point b, Point c, Point d)
{
    const uint32_t first = AddPoint(shape, a);
    AddPoint(shape, b);
    AddPoint(shape, c);
    AddPoint(shape, d);
    AddQuad(shape, first, first + 1, first + 2, first + 3);
}

void AddCard(Shape* shape, const Point corners[4], double repeatU, double repeatV)
{
    assert(shape->isMasked);
    const uint32_t first = shape->pointCount;
    AddPanel(shape, corners[0], corners[1], corners[2], corners[3]);
    for (uint32_t i = 0; i < 4; ++i) {
        shape->texCoords[first + i][0] = Snap(i == 1 || i == 2 ? repeatU : 0.0);
        shape->texCoords[first + i][1] = Snap(i >= 2 ? repeatV : 0.0);
    }
}

enum { TEXT_SIZE = 16384 };

typedef struct Text {
    char bytes[TEXT_SIZE];
    size_t length;
} Text;

__attribute__((format(printf, 2, 3))) static void Print(Text* text, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int added =
        vsnprintf(text->bytes + text->length, TEXT_SIZE - text->length, format, arguments);
    va_end(arguments);
    assert(added >= 0 && text->length + (size_t)added < TEXT_SIZE);
    text->length += (size_t)added;
}

static size_t GetPositionBytes(const Shape* shape)
{
    return shape->pointCount * sizeof shape->positions[0];
}

// Padded to four bytes, as the next view's alignment asks for.
static size_t GetIndexBytes(const Shape* shape)
{
    return (shape->triangleCount * sizeof shape->indices[0] + 3) / 4 * 4;
}

static void PrintNode(Text* json, const Node* node)
{
    static const double s = 0.70710678118654752;
    static const double turns[4][2] = {{0.0, 1.0}, {s, s}, {1.0, 0.0}, {s, -s}};
    const Point t = node->translation;
    const Point k = node->scale;
    Print(json, "{\"mesh\":%d", node->shape);
    if (node->name[0] != '\0') {
        Print(json, ",\"name\":\"%s\"", node->name);
    }
    if (t.x != 0.0 || t.y != 0.0 || t.z != 0.0) {
        Print(json, ",\"translation\":[%.9g,%.9g,%.9g]", t.x, t.y, t.z);
    }
    if (node->quarters != 0) {
        const double* turn = turns[node->quarters];
        Print(json, ",\"rotation\":[0,%.17g,0,%.17g]", turn[0], turn[1]);
    }
    if (k.x != 1.0 || k.y != 1.0 || k.z != 1.0) {
        Print(json, ",\"scale\":[%.9g,%.9g,%.9g]", k.x, k.y, k.z);
    }
    Print(json, "}");
}

static size_t GetTexCoordBytes(const Shape* shape)
{
    return shape->pointCount * sizeof shape->texCoords[0];
}

static int CountMasked(const Model* model, int shapeCount)
{
    int count = 0;
    for (int i = 0; i < shapeCount; ++i) {
        count += model->shapes[i].isMasked ? 1 : 0;
    }
    return count;
}

// What belongs to masks stands behind what every shape has: two views and two accessors each.
static void PrintMaterials(Text* json, const Model* model)
{
    const int count = CountMasked(model, model->shapeCount);
    if (count == 0) {
        return;
    }
    Print(json, ",\"materials\":[");
    for (int i = 0; i < count; ++i) {
        Print(json,
              "%s{\"alphaMode\":\"MASK\",\"doubleSided\":true,\"pbrMetallicRoughness\":{"
              "\"baseColorTexture\":{\"index\":%d}}}",
              i > 0 ? "," : "", i);
    }
    Print(json, "],\"textures\":[");
    for (int i = 0; i < count; ++i) {
        Print(json, "%s{\"source\":%d}", i > 0 ? "," : "", i);
    }
    Print(json, "],\"images\":[");
    for (int i = 0; i < count; ++i) {
        Print(json, "%s{\"mimeType\":\"image/png\",\"bufferView\":%d}", i > 0 ? "," : "",
              2 * model->shapeCount + 2 * i + 1);
    }
    Print(json, "]");
}

static void PrintNodes(Text* json, const Model* model)
{
    Print(json, "\"nodes\":[");
    for (int i = 0; i < GetNodeCount(model); ++i) {
        const Node node = GetNode(model, i);
        Print(json, "%s", i > 0 ? "," : "");
        PrintNode(json, &node);
    }
    Print(json, "],\"meshes\":[");
    for (int i = 0; i < model->shapeCount; ++i) {
        Print(json, "%s{\"name\":\"%s\",\"primitives\":[{\"attributes\":{\"POSITION\":%d",
              i > 0 ? "," : "", model->shapes[i].name, 2 * i);
        const int masked = CountMasked(model, i);
        if (model->shapes[i].isMasked) {
            Print(json, ",\"TEXCOORD_0\":%d},\"material\":%d", 2 * model->shapeCount + masked,
                  masked);
        } else {
            Print(json, "}");
        }
        Print(json, ",\"indices\":%d}]}", 2 * i + 1);
    }
    Print(json, "]");
}

static void PrintAccessors(Text* json, const Model* model)
{
    Print(json, ",\"accessors\":[");
    for (int i = 0; i < model->shapeCount; ++i) {
        const Shape* shape = &model->shapes[i];
        float lower[3], upper[3];
        memcpy(lower, shape->positions[0], sizeof lower);
        memcpy(upper, shape->positions[0], sizeof upper);
        for (uint32_t p = 1; p < shape->pointCount; ++p) {
            for (int axis = 0; axis < 3; ++axis) {
                lower[axis] = fminf(lower[axis], shape->positions[p][axis]);
                upper[axis] = fmaxf(upper[axis], shape->positions[p][axis]);
            }
        }
        Print(json,
              "%s{\"bufferView\":%d,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\","
              "\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]},",
              i > 0 ? "," : "", 2 * i, shape->pointCount, (double)lower[0], (double)lower[1],
              (double)lower[2], (double)upper[0], (double)upper[1], (double)upper[2]);
        Print(json, "{\"bufferView\":%d,\"componentType\":5123,\"count\":%u,\"type\":\"SCALAR\"}",
              2 * i + 1, 3 * shape->triangleCount);
    }
    for (int i = 0, masked = 0; i < model->shapeCount; ++i) {
        if (model->shapes[i].isMasked) {
            Print(json,
                  ",{\"bufferView\":%d,\"componentType\":5126,\"count\":%u,\"type\":\"VEC2\"}",
                  2 * model->shapeCount + 2 * masked++, model->shapes[i].pointCount);
        }
    }
    Print(json, "]");
}

// Returns the length of the binary part.
static size_t PrintBufferViews(Text* json, const Model* model)
{
    size_t offset = 0;
    Print(json, ",\"bufferViews\":[");
    for (int i = 0; i < model->shapeCount; ++i) {
        const Shape* shape = &model->shapes[i];
        const size_t positions = GetPositionBytes(shape);
        Print(json,
              "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":34962},"
              "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":34963}",
              i > 0 ? "," : "", offset, positions, offset + positions,
              shape->triangleCount * sizeof shape->indices[0]);
        offset += positions + GetIndexBytes(shape);
    }
    for (int i = 0; i < model->shapeCount; ++i) {
        const Shape* shape = &model->shapes[i];
        if (shape->isMasked) {
            uint8_t png[MASK_PNG_ROOM];
            const size_t texCoords = GetTexCoordBytes(shape), image = EncodeMask(&shape->mask, png);
            Print(json,
                  ",{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu,\"target\":34962},"
                  "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu}",
                  offset, texCoords, offset + texCoords, image);
            offset += texCoords + (image + 3) / 4 * 4;
        }
    }
    Print(json, "],\"buffers\":[{\"byteLength\":%zu}]", offset);
    return offset;
}

static bool WriteWords(FILE* file, const uint32_t* words, size_t count)
{
    return fwrite(words, sizeof *words, count, file) == count;
}

static bool WriteBinary(FILE* file, const Model* model)
{
    static const uint8_t zeros[4] = {0};
    bool good = true;
    for (int i = 0; i < model->shapeCount; ++i) {
        const Shape* shape = &model->shapes[i];
        const size_t indices = shape->triangleCount * sizeof shape->indices[0];
        const size_t padding = GetIndexBytes(shape) - indices;
        good = good && fwrite(shape->positions, GetPositionBytes(shape), 1, file) == 1 &&
               fwrite(shape->indices, indices, 1, file) == 1 &&
               fwrite(zeros, 1, padding, file) == padding;
    }
    for (int i = 0; i < model->shapeCount; ++i) {
        const Shape* shape = &model->shapes[i];
        if (shape->isMasked) {
            uint8_t png[MASK_PNG_ROOM + 4] = {0};
            const size_t image = (EncodeMask(&shape->mask, png) + 3) / 4 * 4;
            good = good && fwrite(shape->texCoords, GetTexCoordBytes(shape), 1, file) == 1 &&
                   fwrite(png, image, 1, file) == 1;
        }
    }
    return good;
}

bool WriteGlb(const Model* model, const char* path)
{
    Text json = {.length = 0};
    Print(&json, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"paravent make_models\"},"
                 "\"scene\":0,\"scenes\":[{\"nodes\":[");
    for (int i = 0; i < GetNodeCount(model); ++i) {
        Print(&json, "%s%d", i > 0 ? "," : "", i);
    }
    Print(&json, "]}],");
    PrintNodes(&json, model);
    PrintMaterials(&json, model);
    PrintAccessors(&json, model);
    const size_t binary = PrintBufferViews(&json, model);
    Print(&json, "}");
    while (json.length % 4 != 0) {
        Print(&json, " ");
    }

    FILE* file = fopen(path, "wb");
    if (file == NULL) {
        return false;
    }
    const size_t whole = 12 + 8 + json.length + 8 + binary;
    const uint32_t head[] = {0x46546C67, 2, (uint32_t)whole, (uint32_t)json.length, 0x4E4F534A};
    const uint32_t binaryHead[] = {(uint32_t)binary, 0x004E4942};
    const bool good = WriteWords(file, head, 5) && fwrite(json.bytes, json.length, 1, file) == 1 &&
                      WriteWords(file, binaryHead, 2) && WriteBinary(file, model);
    return fclose(file) == 0 && good;
}
