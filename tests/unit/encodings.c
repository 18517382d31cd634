// SPDX-License-Identifier: MIT
#include "encodings.h"

#include <meshoptimizer.h>
#ifdef PVT_TEST_DRACO
#include "draco_encoder.h"
#endif

// A file with one mesh of one primitive under construction.
typedef struct Writer {
    Pack pack;
    char views[1024], accessors[1024];
    int viewCount;
    size_t fallbackSize;    // of the second buffer, which only compressed views pretend to lie in
    const char* extensions; // a list of those required
    char primitive[512];    // behind its attributes and indices
    const char* attributes; // instead of accessor 0 for the positions and 1 for the indices
    char node[256];         // behind its mesh
} Writer;

static Writer* CreateWriter(void)
{
    Writer* writer = calloc(1, sizeof *writer);
    assert_non_null(writer);
    writer->extensions = "";
    writer->attributes = "'attributes':{'POSITION':0},'indices':1";
    return writer;
}

__attribute__((format(printf, 2, 3))) static void AddText(char text[1024], const char* format, ...)
{
    const size_t used = strlen(text);
    va_list arguments;
    va_start(arguments, format);
    const int added = vsnprintf(text + used, 1024 - used, format, arguments);
    va_end(arguments);
    assert_true(added >= 0 && used + (size_t)added < 1024);
}

static int AddView(Writer* writer, const void* bytes, size_t size, int stride)
{
    PackPadding(&writer->pack, 0);
    AddText(writer->views, "%s{'buffer':0,'byteOffset':%zu,'byteLength':%zu",
            writer->viewCount > 0 ? "," : "", writer->pack.size, size);
    if (stride > 0) {
        AddText(writer->views, ",'byteStride':%d", stride);
    }
    AddText(writer->views, "}");
    PackBytes(&writer->pack, bytes, size);
    return writer->viewCount++;
}

// Bytes that meshoptimizer packed, which stand for count × stride bytes.
static void AddPackedView(Writer* writer, const void* bytes, size_t size, size_t count,
                          size_t stride, const char* mode)
{
    PackPadding(&writer->pack, 0);
    AddText(writer->views,
            "%s{'buffer':1,'byteOffset':%zu,'byteLength':%zu,'extensions':{"
            "'EXT_meshopt_compression':{'buffer':0,'byteOffset':%zu,'byteLength':%zu,"
            "'byteStride':%zu,'count':%zu,%s}}}",
            writer->viewCount > 0 ? "," : "", writer->fallbackSize, count * stride,
            writer->pack.size, size, stride, count, mode);
    writer->fallbackSize += (count * stride + 3) / 4 * 4;
    PackBytes(&writer->pack, bytes, size);
    ++writer->viewCount;
}

static void AddPositionAccessor(Writer* writer, const Plain* plain, const char* data)
{
    AddText(writer->accessors,
            "%s{%s'componentType':5126,'count':%zu,'type':'VEC3','min':[%.9g,%.9g,%.9g],"
            "'max':[%.9g,%.9g,%.9g]}",
            writer->accessors[0] != '\0' ? "," : "", data, plain->pointCount,
            (double)plain->lower[0], (double)plain->lower[1], (double)plain->lower[2],
            (double)plain->upper[0], (double)plain->upper[1], (double)plain->upper[2]);
}

static void AddIndexAccessor(Writer* writer, const Plain* plain, const char* data, int type)
{
    AddText(writer->accessors, "%s{%s'componentType':%d,'count':%zu,'type':'SCALAR'}",
            writer->accessors[0] != '\0' ? "," : "", data, type, 3 * plain->triangleCount);
}

static void AddPlainPositions(Writer* writer, const Plain* plain)
{
    AddView(writer, plain->positions, plain->pointCount * sizeof *plain->positions, 0);
    AddPositionAccessor(writer, plain, "'bufferView':0,");
}

static void AddPlainIndices(Writer* writer, const Plain* plain)
{
    char data[32];
    const size_t size = 3 * plain->triangleCount * sizeof *plain->indices;
    (void)snprintf(data, sizeof data, "'bufferView':%d,", AddView(writer, plain->indices, size, 0));
    AddIndexAccessor(writer, plain, data, 5125);
}

static void WriteFile(Writer* writer, const char* path)
{
    enum { SIZE = 8192 };
    char* json = calloc(1, SIZE);
    assert_non_null(json);
    int used = snprintf(json, SIZE,
                        "{'asset':{'version':'2.0'},'extensionsRequired':[%s],'buffers':["
                        "{'byteLength':%zu}",
                        writer->extensions, writer->pack.size);
    if (writer->fallbackSize > 0) {
        used +=
            snprintf(json + used, SIZE - (size_t)used, ",{'byteLength':%zu}", writer->fallbackSize);
    }
    used += snprintf(json + used, SIZE - (size_t)used,
                     "],'bufferViews':[%s],'accessors':[%s],'meshes':[{'primitives':[{%s%s}]}],"
                     "'nodes':[{'mesh':0%s}],'scenes':[{'nodes':[0]}],'scene':0}",
                     writer->views, writer->accessors, writer->attributes, writer->primitive,
                     writer->node);
    assert_true(used < SIZE);
    WriteGlb(path, json, &writer->pack);
    free(json);
    free(writer);
}

static double WritePlain(const Plain* plain, const char* path)
{
    Writer* writer = CreateWriter();
    AddPlainPositions(writer, plain);
    AddPlainIndices(writer, plain);
    WriteFile(writer, path);
    return 0.0;
}

// Points and triangles in another order, triangles begun at another corner.
static double WriteShuffled(const Plain* plain, const char* path)
{
    const size_t points = plain->pointCount, triangles = plain->triangleCount;
    Plain copy = *plain;
    copy.positions = malloc(points * sizeof *copy.positions);
    copy.indices = malloc(3 * triangles * sizeof *copy.indices);
    assert_true(copy.positions != NULL && copy.indices != NULL);
    // Steps that share no factor with the counts visit everything once.
    assert_true(points % 31 != 0 && triangles % 37 != 0);
    for (size_t i = 0; i < points; ++i) {
        memcpy(copy.positions[i * 31 % points], plain->positions[i], sizeof *copy.positions);
    }
    for (size_t t = 0; t < triangles; ++t) {
        for (size_t k = 0; k < 3; ++k) {
            copy.indices[3 * (t * 37 % triangles) + (k + t) % 3] =
                (uint32_t)(plain->indices[3 * t + k] * 31u % points);
        }
    }
    const double loss = WritePlain(&copy, path);
    free(copy.positions);
    free(copy.indices);
    return loss;
}

// A plain accessor of zeroes, and every value written over them.
static double WriteSparse(const Plain* plain, const char* path)
{
    Writer* writer = CreateWriter();
    uint16_t* places = malloc(plain->pointCount * sizeof *places);
    assert_non_null(places);
    for (size_t i = 0; i < plain->pointCount; ++i) {
        places[i] = (uint16_t)i;
    }
    AddView(writer, places, plain->pointCount * sizeof *places, 0);
    AddView(writer, plain->positions, plain->pointCount * sizeof *plain->positions, 0);
    char data[256];
    (void)snprintf(data, sizeof data,
                   "'sparse':{'count':%zu,'indices':{'bufferView':0,'componentType':5123},"
                   "'values':{'bufferView':1}},",
                   plain->pointCount);
    AddPositionAccessor(writer, plain, data);
    AddPlainIndices(writer, plain);
    WriteFile(writer, path);
    free(places);
    return 0.0;
}

static double WriteInstanced(const Plain* plain, const char* path)
{
    Writer* writer = CreateWriter();
    AddPlainPositions(writer, plain);
    AddPlainIndices(writer, plain);
    static const float scale[3] = {1, 1, 1}, zero[4] = {0, 0, 0, 1};
    AddView(writer, scale, sizeof scale, 0);
    AddView(writer, zero, sizeof zero, 0);
    AddText(writer->accessors, ",{'bufferView':2,'componentType':5126,'count':1,'type':'VEC3'},"
                               "{'bufferView':3,'componentType':5126,'count':1,'type':'VEC4'}");
    writer->extensions = "'EXT_mesh_gpu_instancing'";
    (void)snprintf(writer->node, sizeof writer->node,
                   ",'extensions':{'EXT_mesh_gpu_instancing':{'attributes':{'SCALE':2,"
                   "'ROTATION':3}}}");
    WriteFile(writer, path);
    return 0.0;
}

static double GetExtent(const Plain* plain)
{
    double extent = 0.0;
    for (int k = 0; k < 3; ++k) {
        extent = fmax(extent, (double)plain->upper[k] - (double)plain->lower[k]);
    }
    return extent;
}

// Unsigned 16-bit integers, from the least corner on; the node takes them back. `most` is what the
// extent becomes, and divides 1 when they are fractions.
static double WriteQuantized(const Plain* plain, const char* path, bool isNormalized, double most)
{
    Writer* writer = CreateWriter();
    const double step = GetExtent(plain) / most;
    uint16_t(*cells)[4] = calloc(plain->pointCount, sizeof *cells);
    assert_non_null(cells);
    for (size_t i = 0; i < plain->pointCount; ++i) {
        for (int k = 0; k < 3; ++k) {
            const double from = (double)plain->positions[i][k] - (double)plain->lower[k];
            cells[i][k] = (uint16_t)rint(from / step);
        }
    }
    AddView(writer, cells, plain->pointCount * sizeof *cells, sizeof *cells);
    free(cells);
    AddText(writer->accessors,
            "{'bufferView':0,'componentType':5123,'normalized':%s,'count':%zu,'type':'VEC3',"
            "'min':[0,0,0],'max':[%.0f,%.0f,%.0f]}",
            isNormalized ? "true" : "false", plain->pointCount, most, most, most);
    AddPlainIndices(writer, plain);
    const double scale = isNormalized ? step * 65535.0 : step;
    (void)snprintf(writer->node, sizeof writer->node,
                   ",'translation':[%.17g,%.17g,%.17g],'scale':[%.17g,%.17g,%.17g]",
                   (double)plain->lower[0], (double)plain->lower[1], (double)plain->lower[2], scale,
                   scale, scale);
    writer->extensions = "'KHR_mesh_quantization'";
    WriteFile(writer, path);
    return 0.5 * step;
}

static double WriteIntegers(const Plain* plain, const char* path)
{
    return WriteQuantized(plain, path, false, 1023.0);
}

static double WriteFractions(const Plain* plain, const char* path)
{
    return WriteQuantized(plain, path, true, 65535.0);
}

static void AddPackedPositions(Writer* writer, const Plain* plain, const void* values,
                               const char* mode)
{
    const size_t room = meshopt_encodeVertexBufferBound(plain->pointCount, 12);
    uint8_t* packed = malloc(room);
    assert_non_null(packed);
    const size_t size = meshopt_encodeVertexBuffer(packed, room, values, plain->pointCount, 12);
    assert_true(size > 0);
    AddPackedView(writer, packed, size, plain->pointCount, 12, mode);
    AddPositionAccessor(writer, plain, "'bufferView':0,");
    free(packed);
}

static void AddPackedIndices(Writer* writer, const Plain* plain, bool isSequence)
{
    const size_t count = 3 * plain->triangleCount;
    const size_t room = meshopt_encodeIndexSequenceBound(count, plain->pointCount) +
                        meshopt_encodeIndexBufferBound(count, plain->pointCount);
    uint8_t* packed = malloc(room);
    assert_non_null(packed);
    const size_t size = isSequence
                            ? meshopt_encodeIndexSequence(packed, room, plain->indices, count)
                            : meshopt_encodeIndexBuffer(packed, room, plain->indices, count);
    assert_true(size > 0);
    AddPackedView(writer, packed, size, count, 4,
                  isSequence ? "'mode':'INDICES'" : "'mode':'TRIANGLES'");
    AddIndexAccessor(writer, plain, "'bufferView':1,", 5125);
    free(packed);
    writer->extensions = "'EXT_meshopt_compression'";
}

static double WriteMeshopt(const Plain* plain, const char* path)
{
    Writer* writer = CreateWriter();
    AddPackedPositions(writer, plain, plain->positions, "'mode':'ATTRIBUTES'");
    AddPackedIndices(writer, plain, false);
    WriteFile(writer, path);
    return 0.0;
}

// Floats of few digits, and the indices as a plain sequence.
static double WriteMeshoptFilter(const Plain* plain, const char* path)
{
    enum { BITS = 12 };
    Writer* writer = CreateWriter();
    uint32_t* filtered = malloc(plain->pointCount * 12);
    assert_non_null(filtered);
    meshopt_encodeFilterExp(filtered, plain->pointCount, 12, BITS, &plain->positions[0][0]);
    AddPackedPositions(writer, plain, filtered, "'mode':'ATTRIBUTES','filter':'EXPONENTIAL'");
    free(filtered);
    AddPackedIndices(writer, plain, true);
    WriteFile(writer, path);
    double largest = 0.0;
    for (int k = 0; k < 3; ++k) {
        largest = fmax(largest, fmax(fabs((double)plain->lower[k]), fabs((double)plain->upper[k])));
    }
    // Coordinates of a point share an exponent, and one bit of them is the sign.
    return largest * exp2(2 - BITS);
}

#ifdef PVT_TEST_DRACO
size_t PackDraco(const Plain* plain, bool isSequential, int bits, Pack* pack, size_t* pointCount)
{
    const DracoSource source = {.positions = &plain->positions[0][0],
                                .pointCount = plain->pointCount,
                                .indices = plain->indices,
                                .triangleCount = plain->triangleCount,
                                .isSequential = isSequential,
                                .bits = bits};
    const size_t size =
        EncodeDraco(&source, pack->bytes + pack->size, sizeof pack->bytes - pack->size, pointCount);
    assert_true(size > 0);
    pack->size += size;
    return size;
}

static double WriteDraco(const Plain* plain, const char* path, bool isSequential, int bits)
{
    Writer* writer = CreateWriter();
    Plain counts = *plain;
    const size_t size = PackDraco(plain, isSequential, bits, &writer->pack, &counts.pointCount);
    AddText(writer->views, "{'buffer':0,'byteLength':%zu}", size);
    AddPositionAccessor(writer, &counts, "");
    AddIndexAccessor(writer, &counts, "", 5123);
    (void)snprintf(writer->primitive, sizeof writer->primitive,
                   ",'extensions':{'KHR_draco_mesh_compression':{'bufferView':0,"
                   "'attributes':{'POSITION':%d}}}",
                   DRACO_POSITION_ID);
    writer->extensions = "'KHR_draco_mesh_compression'";
    WriteFile(writer, path);
    return bits == 0 ? 0.0 : 0.5 * GetExtent(plain) / (exp2(bits) - 1.0);
}

static double WriteDracoSequence(const Plain* plain, const char* path)
{
    return WriteDraco(plain, path, true, 0);
}

static double WriteDracoEdges(const Plain* plain, const char* path)
{
    return WriteDraco(plain, path, false, 0);
}

static double WriteDracoEdges10(const Plain* plain, const char* path)
{
    return WriteDraco(plain, path, false, 10);
}

static double WriteDracoSequence14(const Plain* plain, const char* path)
{
    return WriteDraco(plain, path, true, 14);
}
#endif

const Encoding* GetEncoding(size_t index)
{
    static const Encoding encodings[] = {
        {"plain", WritePlain},
        {"shuffled", WriteShuffled},
        {"sparse", WriteSparse},
        {"instanced", WriteInstanced},
        {"integers of 10 bits", WriteIntegers},
        {"fractions of 16 bits", WriteFractions},
        {"meshopt", WriteMeshopt},
        {"meshopt with a filter", WriteMeshoptFilter},
#ifdef PVT_TEST_DRACO
        {"draco, in sequence", WriteDracoSequence},
        {"draco, by edges", WriteDracoEdges},
        {"draco, by edges, 10 bits", WriteDracoEdges10},
        {"draco, in sequence, 14 bits", WriteDracoSequence14},
#endif
    };
    return index < sizeof encodings / sizeof encodings[0] ? &encodings[index] : NULL;
}

Plain MakePlain(const pvtMesh* mesh)
{
    Plain plain = {
        .positions = malloc(mesh->positionCount * sizeof *plain.positions),
        .indices = malloc(3 * mesh->triangleCount * sizeof *plain.indices),
        .pointCount = mesh->positionCount,
        .triangleCount = mesh->triangleCount,
        .lower = {INFINITY, INFINITY, INFINITY},
        .upper = {-INFINITY, -INFINITY, -INFINITY},
    };
    assert_true(plain.positions != NULL && plain.indices != NULL);
    memcpy(plain.indices, mesh->indices, 3 * mesh->triangleCount * sizeof *plain.indices);
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        const pvtVec3 p = mesh->positions[i];
        const float values[3] = {(float)p.x, (float)p.y, (float)p.z};
        for (int k = 0; k < 3; ++k) {
            plain.positions[i][k] = values[k];
            plain.lower[k] = fminf(plain.lower[k], values[k]);
            plain.upper[k] = fmaxf(plain.upper[k], values[k]);
        }
    }
    return plain;
}

void Plain_Free(Plain* plain)
{
    free(plain->positions);
    free(plain->indices);
    *plain = (Plain){0};
}
