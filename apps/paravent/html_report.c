// SPDX-License-Identifier: MIT
// The page is bundled at build time (apps/report); here its data is put between its two halves:
// scores and captions as JSON, meshes as base64, pictures as data URIs, the plot as SVG.
#include "html_report.h"

#include "json.h"
#include "png.h"
#include "report_page.h"
#include "targets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    TILE = 300,                // [px] of a view's picture
    MOST_TRIANGLES = 4000000,  // of all meshes
    MOST_GLTF_BYTES = 1 << 20, // of an occluder file's JSON
    GLB_HEAD = 20,             // bytes before it
    BASE64_BATCH = 3 * 1024,
};

static const double FARTHEST = 1e6; // of a position, where the original's radius is 1

pvtStatus pvtCheckReport(pvtRun* run, const pvtMesh* meshes, size_t count)
{
    if (pvtReportHeadSize == 0) {
        return pvtRun_Fail(run, PVT_UNSUPPORTED,
                           "--report: this program was built without Node, which bundles the page; "
                           "install node and npm and build again, or leave --report away");
    }
    size_t triangles = 0;
    for (size_t i = 0; i < count; ++i) {
        triangles += meshes[i].triangleCount;
    }
    if (triangles > MOST_TRIANGLES) {
        char all[32], most[32];
        return pvtRun_Fail(
            run, PVT_LIMIT,
            "--report: %s triangles are more than a page can hold, at most %s; leave "
            "--report away",
            pvtFormatCount(triangles, all), pvtFormatCount(MOST_TRIANGLES, most));
    }
    return PVT_OK;
}

// Within a page a script's text must not hold "</script" or "<!--".
static void WriteScriptBytes(void* user, const char* bytes, size_t count)
{
    while (count > 0) {
        const char* less = memchr(bytes, '<', count);
        const size_t length = less != NULL ? (size_t)(less - bytes) : count;
        pvtOutput_Write(user, bytes, length);
        if (less == NULL) {
            return;
        }
        pvtOutput_Write(user, "\\u003c", 6);
        bytes += length + 1;
        count -= length + 1;
    }
}

static pvtJson MakeScriptJson(pvtOutput* output)
{
    return (pvtJson){.write = WriteScriptBytes, .user = output, .isCompact = true};
}

// Room for 4 letters for every 3 bytes begun, and the terminator.
static size_t EncodeBase64(const uint8_t* bytes, size_t count, char* text)
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t used = 0;
    for (size_t i = 0; i < count; i += 3) {
        const uint32_t second = i + 1 < count ? bytes[i + 1] : 0;
        const uint32_t third = i + 2 < count ? bytes[i + 2] : 0;
        const uint32_t word = (uint32_t)bytes[i] << 16 | second << 8 | third;
        text[used++] = letters[word >> 18];
        text[used++] = letters[word >> 12 & 63];
        text[used++] = i + 1 < count ? letters[word >> 6 & 63] : '=';
        text[used++] = i + 2 < count ? letters[word & 63] : '=';
    }
    text[used] = '\0';
    return used;
}

// Bytes on their way to base64: batches of a multiple of three but for the last.
typedef struct Base64Stream {
    pvtOutput* output;
    uint8_t bytes[BASE64_BATCH];
    size_t count;
} Base64Stream;

static void FlushBase64(Base64Stream* stream)
{
    char text[BASE64_BATCH / 3 * 4 + 1];
    pvtOutput_Write(stream->output, text, EncodeBase64(stream->bytes, stream->count, text));
    stream->count = 0;
}

// Four bytes, lowest first.
static void PutWord(Base64Stream* stream, uint32_t word)
{
    for (int shift = 0; shift < 32; shift += 8) {
        stream->bytes[stream->count++] = (uint8_t)(word >> shift);
    }
    if (stream->count + 4 > BASE64_BATCH) {
        FlushBase64(stream);
    }
}

static void PutFloat(Base64Stream* stream, double value)
{
    const double finite = isfinite(value) ? fmax(-FARTHEST, fmin(FARTHEST, value)) : 0.0;
    const float number = (float)finite;
    uint32_t word;
    memcpy(&word, &number, sizeof word);
    PutWord(stream, word);
}

// What the page takes as the middle and the radius 1.
typedef struct Frame {
    pvtVec3 middle;
    double radius;
} Frame;

static Frame GetFrame(const pvtMesh* original)
{
    const pvtBox3 box = pvtMesh_GetBounds(original);
    const double x = 0.5 * (box.upper.x - box.lower.x), y = 0.5 * (box.upper.y - box.lower.y),
                 z = 0.5 * (box.upper.z - box.lower.z);
    const double radius = hypot(hypot(x, y), z);
    return (Frame){{box.lower.x + x, box.lower.y + y, box.lower.z + z},
                   radius > 0.0 ? radius : 1.0};
}

static void WriteMesh(pvtOutput* output, size_t index, const pvtMesh* mesh, const Frame* frame)
{
    Base64Stream stream = {.output = output};
    pvtOutput_Print(output, "<script type=\"text/plain\" id=\"mesh-%zu\">", index);
    PutWord(&stream, (uint32_t)mesh->positionCount);
    PutWord(&stream, (uint32_t)mesh->triangleCount);
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        const pvtVec3 p = mesh->positions[i];
        PutFloat(&stream, (p.x - frame->middle.x) / frame->radius);
        PutFloat(&stream, (p.y - frame->middle.y) / frame->radius);
        PutFloat(&stream, (p.z - frame->middle.z) / frame->radius);
    }
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        PutWord(&stream, mesh->indices[i]);
    }
    FlushBase64(&stream);
    pvtOutput_Print(output, "</script>\n");
}

// An image as a data URI; false when memory is short.
static bool WritePicture(pvtJson* json, const pvtImage* image)
{
    static const char head[] = "data:image/png;base64,";
    uint8_t* png = NULL;
    size_t size = 0;
    if (!pvtEncodePng(image, &png, &size)) {
        return false;
    }
    char* text = malloc(sizeof head + (size + 2) / 3 * 4);
    if (text != NULL) {
        memcpy(text, head, sizeof head);
        EncodeBase64(png, size, text + sizeof head - 1);
        pvtJson_String(json, NULL, text);
    }
    free(png);
    free(text);
    return text != NULL;
}

static pvtStatus WritePictures(pvtRun* run, pvtJson* json, const pvtSheetViews* chosen,
                               const pvtMesh* const meshes[2])
{
    pvtImage images[PVT_SHEET_VIEWS];
    pvtStatus status = pvtDrawSheetViews(run->context, chosen, meshes, TILE, images);
    if (status != PVT_OK) {
        return status;
    }
    pvtJson_BeginArray(json, NULL);
    for (size_t i = 0; i < chosen->count; ++i) {
        if (status == PVT_OK && !WritePicture(json, &images[i])) {
            status = pvtRun_Fail(run, PVT_OUT_OF_MEMORY, "out of memory");
        }
        pvtImage_Free(run->context, &images[i]);
    }
    pvtJson_EndArray(json);
    return status;
}

// The JSON of a glTF or GLB file, which tells how an occluder was made; null when it is another
// format, long, or gone. The caller frees it.
static char* ReadGltfText(const char* path)
{
    FILE* file = fopen(path, "rb");
    char* text = file != NULL ? calloc(MOST_GLTF_BYTES + 1, 1) : NULL;
    size_t begin = 0, length = 0;
    if (text != NULL) {
        const size_t size = fread(text, 1, MOST_GLTF_BYTES, file);
        length = size < MOST_GLTF_BYTES && pvtPathEndsIn(path, ".gltf") ? size : 0;
        if (size > GLB_HEAD && memcmp(text, "glTF", 4) == 0) {
            const unsigned char* count = (const unsigned char*)text + 12;
            length = (size_t)count[0] | (size_t)count[1] << 8 | (size_t)count[2] << 16 |
                     (size_t)count[3] << 24;
            begin = GLB_HEAD;
            length = length <= size - begin ? length : 0;
        }
        memmove(text, text + begin, length);
        text[length] = '\0';
    }
    if (file != NULL) {
        fclose(file);
    }
    if (length == 0) {
        free(text);
        text = NULL;
    }
    return text;
}

static void WriteErrors(pvtJson* json, const pvtOccluderScore* score)
{
    pvtJson_BeginArray(json, NULL);
    pvtJson_Number(json, NULL, score->uniform.precisionError);
    pvtJson_Number(json, NULL, score->uniform.recallError);
    pvtJson_Number(json, NULL, score->small.precisionError);
    pvtJson_Number(json, NULL, score->small.recallError);
    pvtJson_Number(json, NULL, score->coverageError);
    pvtJson_EndArray(json);
}

static void WriteNames(pvtJson* json, const pvtJudgement* judgement)
{
    const pvtEvaluation* evaluation = judgement->evaluation;
    pvtJson_String(json, "original", judgement->originalName);
    pvtJson_BeginArray(json, "names");
    for (size_t i = 0; i < evaluation->count; ++i) {
        pvtJson_String(json, NULL, judgement->names[i]);
    }
    pvtJson_EndArray(json);
    pvtJson_BeginArray(json, "errors");
    for (size_t i = 0; i < evaluation->count; ++i) {
        WriteErrors(json, &evaluation->occluders[i]);
    }
    pvtJson_EndArray(json);
    pvtJson_BeginArray(json, "worst");
    for (size_t i = 0; i < evaluation->count; ++i) {
        pvtJson_Integer(json, NULL, (int64_t)evaluation->occluders[i].worstView);
    }
    pvtJson_EndArray(json);
    pvtJson_BeginArray(json, "gltf");
    for (size_t i = 0; i < evaluation->count; ++i) {
        char* text = ReadGltfText(judgement->occluders[i]);
        pvtJson_String(json, NULL, text);
        free(text);
    }
    pvtJson_EndArray(json);
}

// What the scores' JSON does not hold.
static pvtStatus WriteExtra(pvtRun* run, pvtOutput* output, const pvtJudgement* judgement,
                            const pvtMesh* meshes)
{
    const pvtEvaluation* evaluation = judgement->evaluation;
    const pvtSheetViews chosen = pvtChooseSheetViews(evaluation);
    pvtOutput_Print(output, "<script type=\"application/json\" id=\"extra\">");
    pvtJson json = MakeScriptJson(output);
    pvtJson_BeginObject(&json, NULL);
    WriteNames(&json, judgement);
    pvtJson_BeginArray(&json, "views");
    for (size_t k = 0; k < chosen.count; ++k) {
        pvtJson_Integer(&json, NULL, (int64_t)chosen.views[k]);
    }
    pvtJson_EndArray(&json);
    pvtJson_BeginArray(&json, "pictures");
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < evaluation->count && status == PVT_OK; ++i) {
        const pvtMesh* const pair[2] = {&meshes[0], &meshes[1 + i]};
        status = WritePictures(run, &json, &chosen, pair);
    }
    pvtJson_EndArray(&json);
    pvtJson_EndObject(&json);
    pvtOutput_Print(output, "</script>\n");
    return status;
}

static pvtStatus WriteData(pvtRun* run, pvtOutput* output, const pvtJudgement* judgement,
                           const pvtMesh* meshes)
{
    pvtOutput_Print(output, "<script type=\"application/json\" id=\"scores\">");
    pvtJson json = MakeScriptJson(output);
    pvtWriteScores(&json, judgement);
    pvtOutput_Print(output, "</script>\n<template id=\"plot-source\">\n");
    pvtPlotRecall(output, judgement);
    pvtOutput_Print(output, "</template>\n");
    const Frame frame = GetFrame(&meshes[0]);
    for (size_t i = 0; i <= judgement->evaluation->count; ++i) {
        WriteMesh(output, i, &meshes[i], &frame);
    }
    return WriteExtra(run, output, judgement, meshes);
}

pvtStatus pvtWriteReport(pvtRun* run, const char* path, const pvtJudgement* judgement,
                         const pvtMesh* meshes)
{
    pvtOutput* output = NULL;
    pvtStatus status = pvtOpenOutput(run->context, path, &output);
    if (status != PVT_OK) {
        return status;
    }
    pvtOutput_Write(output, pvtReportHead, pvtReportHeadSize);
    status = WriteData(run, output, judgement, meshes);
    if (status == PVT_OK) {
        status = pvtRun_CheckCancelled(run);
    }
    if (status != PVT_OK) {
        pvtDiscardOutput(output);
        return status;
    }
    pvtOutput_Write(output, pvtReportTail, pvtReportTailSize);
    return pvtCommitOutput(output);
}
