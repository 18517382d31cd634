// SPDX-License-Identifier: MIT
// A picture of an occluder within its original: six views, each drawn in three passes (the
// original's normals, the occluder's colours, then light and averaging) with several samples a
// pixel.
#include "gl/preview.h"

#include "base/context.h"
#include "base/vector.h"

#include <string.h>

enum {
    COLUMNS = 3,
    SMALLEST_TILE = 64,
    LARGEST_TILE = 2048,
    // Pixels that are lit at a time, a few milliseconds without a graphics card.
    BAND_PIXELS = 1 << 15,
};

// Of the widest edges, in pixels of the picture, at the default tile size.
#define EDGE_WIDTH 1.7

typedef struct Buffer {
    GLuint vertexArray, vertices, indices;
} Buffer;

typedef struct Preview {
    pvtContext* context;
    pvtGl* gl;
    int tileSize;
    int side; // samples a pixel along x and along y
    pvtPreviewSpace space;
    const pvtMesh* original;
    pvtPreviewPoint* points; // of the original
    pvtPreviewPaint paint;
    Buffer originalBuffer, occluderBuffer, edgeBuffer;
    pvtGlTarget originalTarget, occluderTarget, tileTarget;
    GLuint surfaceProgram, occluderProgram, edgeProgram, resolveProgram;
    uint8_t* tile; // the pixels of one
} Preview;

pvtPreviewOptions pvtDefaultPreviewOptions(void)
{
    return (pvtPreviewOptions){.tileSize = 480, .up = PVT_AXIS_Y};
}

static void Include(pvtBox3* box, pvtBox3 other)
{
    for (int axis = 0; axis < 3; ++axis) {
        pvtSetAxis(&box->lower, axis,
                   fmin(pvtGetAxis(box->lower, axis), pvtGetAxis(other.lower, axis)));
        pvtSetAxis(&box->upper, axis,
                   fmax(pvtGetAxis(box->upper, axis), pvtGetAxis(other.upper, axis)));
    }
}

pvtPreviewSpace pvtMakePreviewSpace(pvtAxis up, const pvtMesh* original, const pvtMesh* occluder)
{
    pvtBox3 box = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    if (original->triangleCount > 0) {
        Include(&box, pvtMesh_GetBounds(original));
    }
    if (occluder->triangleCount > 0) {
        Include(&box, pvtMesh_GetBounds(occluder));
    }
    pvtPreviewSpace space = {.scale = 1.0, .up = up};
    if (box.lower.x > box.upper.x) {
        return space; // nothing to see
    }
    double longest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double lower = 0.5 * pvtGetAxis(box.lower, axis);
        const double upper = 0.5 * pvtGetAxis(box.upper, axis);
        pvtSetAxis(&space.center, axis, 0.5 * lower + 0.5 * upper);
        longest = fmax(longest, 0.5 * upper - 0.5 * lower);
    }
    if (longest > 0.0 && isfinite(1.0 / longest)) {
        space.scale = 1.0 / longest;
    }
    return space;
}

pvtPreviewPoint pvtPreviewSpace_Map(const pvtPreviewSpace* space, pvtVec3 position)
{
    const pvtVec3 p = pvtScale(pvtSub(pvtScale(position, 0.5), space->center), space->scale);
    const float x = (float)p.x, y = (float)p.y, z = (float)p.z;
    switch (space->up) {
    case PVT_AXIS_X:
        return (pvtPreviewPoint){y, x, -z};
    case PVT_AXIS_Y:
        return (pvtPreviewPoint){x, y, z};
    case PVT_AXIS_Z:
        return (pvtPreviewPoint){x, z, -y};
    }
    return (pvtPreviewPoint){x, y, z};
}

static void UploadOriginal(Preview* preview)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    const pvtMesh* mesh = preview->original;
    Buffer* buffer = &preview->originalBuffer;
    f->GenVertexArrays(1, &buffer->vertexArray);
    f->BindVertexArray(buffer->vertexArray);
    f->GenBuffers(1, &buffer->vertices);
    f->BindBuffer(GL_ARRAY_BUFFER, buffer->vertices);
    f->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(mesh->positionCount * sizeof *preview->points),
                  preview->points, GL_STATIC_DRAW);
    f->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, NULL);
    f->EnableVertexAttribArray(0);
    f->GenBuffers(1, &buffer->indices);
    f->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer->indices);
    f->BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  (GLsizeiptr)(3 * mesh->triangleCount * sizeof *mesh->indices), mesh->indices,
                  GL_STATIC_DRAW);
}

static void UploadOccluder(Preview* preview)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    const pvtPreviewPaint* paint = &preview->paint;
    Buffer* buffer = &preview->occluderBuffer;
    f->GenVertexArrays(1, &buffer->vertexArray);
    f->BindVertexArray(buffer->vertexArray);
    f->GenBuffers(1, &buffer->vertices);
    f->BindBuffer(GL_ARRAY_BUFFER, buffer->vertices);
    f->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(paint->vertexCount * sizeof(pvtPreviewVertex)),
                  paint->vertices, GL_STATIC_DRAW);
    f->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(pvtPreviewVertex), NULL);
    f->VertexAttribPointer(1, 3, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(pvtPreviewVertex),
                           (const void*)offsetof(pvtPreviewVertex, color));
    f->EnableVertexAttribArray(0);
    f->EnableVertexAttribArray(1);
}

static void UploadEdges(Preview* preview)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    const pvtPreviewPaint* paint = &preview->paint;
    Buffer* buffer = &preview->edgeBuffer;
    f->GenVertexArrays(1, &buffer->vertexArray);
    f->BindVertexArray(buffer->vertexArray);
    f->GenBuffers(1, &buffer->vertices);
    f->BindBuffer(GL_ARRAY_BUFFER, buffer->vertices);
    f->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(paint->edgeCount * sizeof(pvtPreviewEdge)),
                  paint->edges, GL_STATIC_DRAW);
    f->VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(pvtPreviewEdge), NULL);
    f->VertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(pvtPreviewEdge),
                           (const void*)offsetof(pvtPreviewEdge, end));
    f->VertexAttribPointer(2, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(pvtPreviewEdge),
                           (const void*)offsetof(pvtPreviewEdge, color));
    for (GLuint i = 0; i < 3; ++i) {
        f->EnableVertexAttribArray(i);
        f->VertexAttribDivisor(i, 1);
    }
}

static void FreeBuffer(const pvtGlFunctions* f, Buffer* buffer)
{
    f->DeleteVertexArrays(1, &buffer->vertexArray);
    f->DeleteBuffers(1, &buffer->vertices);
    f->DeleteBuffers(1, &buffer->indices);
}

static pvtStatus GetPrograms(Preview* preview)
{
    const struct {
        pvtGlProgram which;
        GLuint* program;
    } wanted[] = {
        {PVT_PROGRAM_SURFACE, &preview->surfaceProgram},
        {PVT_PROGRAM_OCCLUDER, &preview->occluderProgram},
        {PVT_PROGRAM_EDGE, &preview->edgeProgram},
        {PVT_PROGRAM_RESOLVE, &preview->resolveProgram},
    };
    pvtStatus status = PVT_OK;
    for (size_t i = 0; status == PVT_OK && i < sizeof wanted / sizeof wanted[0]; ++i) {
        status = pvtGetGlProgram(preview->context, preview->gl, wanted[i].which, wanted[i].program);
    }
    return status;
}

static pvtStatus CreateTargets(Preview* preview)
{
    const int size = preview->tileSize * preview->side;
    const pvtGlTargetDef samples = {size, size, GL_RGBA8, GL_DEPTH_COMPONENT32F};
    const pvtGlTargetDef pixels = {preview->tileSize, preview->tileSize, GL_RGBA8, 0};
    pvtStatus status =
        pvtCreateGlTarget(preview->context, preview->gl, &samples, &preview->originalTarget);
    if (status == PVT_OK) {
        status =
            pvtCreateGlTarget(preview->context, preview->gl, &samples, &preview->occluderTarget);
    }
    if (status == PVT_OK) {
        status = pvtCreateGlTarget(preview->context, preview->gl, &pixels, &preview->tileTarget);
    }
    return status;
}

static void BindTarget(const pvtGlFunctions* f, const pvtGlTarget* target)
{
    f->BindFramebuffer(GL_FRAMEBUFFER, target->framebuffer);
    f->Viewport(0, 0, target->width, target->height);
    f->ClearColor(0.0F, 0.0F, 0.0F, 0.0F);
    f->Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

static void UseProgram(const pvtGlFunctions* f, GLuint program, const pvtPreviewCamera* camera)
{
    f->UseProgram(program);
    f->UniformMatrix4fv(f->GetUniformLocation(program, "view"), 1, GL_FALSE, camera->view);
    f->UniformMatrix4fv(f->GetUniformLocation(program, "projection"), 1, GL_FALSE,
                        camera->projection);
}

static pvtStatus DrawOriginal(const Preview* preview, const pvtPreviewCamera* camera)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    BindTarget(f, &preview->originalTarget);
    UseProgram(f, preview->surfaceProgram, camera);
    f->BindVertexArray(preview->originalBuffer.vertexArray);
    return pvtDrawGlTriangles(preview->context, preview->gl, preview->original->triangleCount);
}

static pvtStatus DrawOccluder(const Preview* preview, const pvtPreviewCamera* camera)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    BindTarget(f, &preview->occluderTarget);
    UseProgram(f, preview->occluderProgram, camera);
    f->BindVertexArray(preview->occluderBuffer.vertexArray);
    const size_t count = preview->paint.vertexCount, most = 3 * (size_t)PVT_GL_DRAW_TRIANGLES;
    for (size_t first = 0; first < count; first += most) {
        if (pvtIsCancelled(preview->context)) {
            return pvtFailCancelled(preview->context);
        }
        const size_t left = count - first;
        f->DrawArrays(GL_TRIANGLES, (GLint)first, (GLsizei)(left < most ? left : most));
    }
    return PVT_OK;
}

// Outlines behind other polygons shine through them faintly; edges in front are drawn over.
static void DrawEdges(const Preview* preview, const pvtPreviewCamera* camera)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    const GLuint program = preview->edgeProgram;
    const float size = (float)(preview->tileSize * preview->side);
    const float scale = fmaxf(1.0F, (float)preview->tileSize / 480.0F);
    UseProgram(f, program, camera);
    f->Uniform2f(f->GetUniformLocation(program, "pixel"), 2.0F / size, 2.0F / size);
    f->Uniform1f(f->GetUniformLocation(program, "width"),
                 (float)(EDGE_WIDTH * preview->side) * scale);
    f->BindVertexArray(preview->edgeBuffer.vertexArray);
    f->DepthMask(GL_FALSE);
    f->Enable(GL_BLEND);
    f->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    f->DepthFunc(GL_GREATER);
    f->Uniform1f(f->GetUniformLocation(program, "opacity"), 0.3F);
    f->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)preview->paint.outlineCount);
    f->Disable(GL_BLEND);
    f->DepthMask(GL_TRUE);
    f->DepthFunc(GL_LEQUAL);
    f->Uniform1f(f->GetUniformLocation(program, "opacity"), 0.9F);
    f->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)preview->paint.edgeCount);
    f->DepthFunc(GL_LESS);
}

static void BindTexture(const pvtGlFunctions* f, GLuint program, int unit, const char* name,
                        GLuint texture)
{
    f->ActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    f->BindTexture(GL_TEXTURE_2D, texture);
    f->Uniform1i(f->GetUniformLocation(program, name), unit);
}

static void PrepareResolve(const Preview* preview, const pvtPreviewCamera* camera)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    const GLuint program = preview->resolveProgram;
    BindTarget(f, &preview->tileTarget);
    f->Disable(GL_DEPTH_TEST);
    f->UseProgram(program);
    BindTexture(f, program, 0, "normals", preview->originalTarget.color);
    BindTexture(f, program, 1, "depths", preview->originalTarget.depth);
    BindTexture(f, program, 2, "occluder", preview->occluderTarget.color);
    BindTexture(f, program, 3, "occluderDepths", preview->occluderTarget.depth);
    f->Uniform1i(f->GetUniformLocation(program, "side"), preview->side);
    f->Uniform3f(f->GetUniformLocation(program, "range"), camera->nearest, camera->farthest,
                 camera->perspective ? 1.0F : 0.0F);
    f->Uniform2f(f->GetUniformLocation(program, "reach"), camera->reach[0], camera->reach[1]);
    f->Uniform3f(f->GetUniformLocation(program, "up"), camera->up[0], camera->up[1], camera->up[2]);
    f->BindVertexArray(preview->originalBuffer.vertexArray);
}

// Band by band, each read back at once: a driver would else take the whole tile before it noticed
// that we are cancelled.
static pvtStatus ResolveTile(const Preview* preview, const pvtPreviewCamera* camera)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    const int size = preview->tileSize, most = BAND_PIXELS / size;
    PrepareResolve(preview, camera);
    f->Enable(GL_SCISSOR_TEST);
    for (int y = 0; y < size; y += most) {
        if (pvtIsCancelled(preview->context)) {
            return pvtFailCancelled(preview->context);
        }
        const int rows = size - y < most ? size - y : most;
        f->Scissor(0, y, size, rows);
        f->DrawArrays(GL_TRIANGLES, 0, 3);
        f->ReadPixels(0, y, size, rows, GL_RGBA, GL_UNSIGNED_BYTE,
                      preview->tile + 4 * (size_t)y * (size_t)size);
    }
    f->Disable(GL_SCISSOR_TEST);
    return pvtCheckGl(preview->context, preview->gl, "draw a preview");
}

// Copies the tile into its place, the top row first, with a line where it meets its neighbours.
static void PlaceTile(const Preview* preview, int view, pvtImage* image)
{
    const int size = preview->tileSize;
    const int left = view % COLUMNS * size, top = view / COLUMNS * size;
    for (int y = 0; y < size; ++y) {
        uint8_t* row =
            image->pixels + 4 * ((size_t)(top + y) * (size_t)image->width + (size_t)left);
        memcpy(row, preview->tile + 4 * (size_t)(size - 1 - y) * (size_t)size, 4 * (size_t)size);
        for (int x = 0; x < size; ++x) {
            if ((x == 0 && left > 0) || (y == 0 && top > 0)) {
                memcpy(row + 4 * x, (const uint8_t[]){255, 255, 255, 255}, 4);
            }
        }
    }
}

static pvtStatus RenderTile(const Preview* preview, int view, pvtImage* image)
{
    const pvtGlFunctions* f = &preview->gl->functions;
    const pvtPreviewCloud clouds[2] = {
        {preview->points, preview->original->indices, 3 * preview->original->triangleCount,
         sizeof(pvtPreviewPoint)},
        {&preview->paint.vertices->at, NULL, preview->paint.vertexCount, sizeof(pvtPreviewVertex)},
    };
    const pvtPreviewCamera camera = pvtMakePreviewCamera(view, clouds, 2);
    f->Enable(GL_DEPTH_TEST);
    pvtStatus status = DrawOriginal(preview, &camera);
    if (status == PVT_OK) {
        status = DrawOccluder(preview, &camera);
    }
    if (status != PVT_OK) {
        return status;
    }
    DrawEdges(preview, &camera);
    status = ResolveTile(preview, &camera);
    if (status == PVT_OK) {
        PlaceTile(preview, view, image);
    }
    return status;
}

static pvtStatus RenderTiles(Preview* preview, pvtImage* image)
{
    pvtStatus status = GetPrograms(preview);
    if (status == PVT_OK) {
        UploadOriginal(preview);
        UploadOccluder(preview);
        UploadEdges(preview);
        status = pvtCheckGl(preview->context, preview->gl, "upload a mesh");
    }
    if (status == PVT_OK) {
        status = CreateTargets(preview);
    }
    for (int view = 0; status == PVT_OK && view < PVT_PREVIEW_VIEWS; ++view) {
        status = RenderTile(preview, view, image);
        pvtReportProgress(preview->context, (view + 1.0) / PVT_PREVIEW_VIEWS);
    }
    const pvtGlFunctions* f = &preview->gl->functions;
    FreeBuffer(f, &preview->originalBuffer);
    FreeBuffer(f, &preview->occluderBuffer);
    FreeBuffer(f, &preview->edgeBuffer);
    pvtGlTarget_Free(preview->gl, &preview->originalTarget);
    pvtGlTarget_Free(preview->gl, &preview->occluderTarget);
    pvtGlTarget_Free(preview->gl, &preview->tileTarget);
    return status;
}

static pvtStatus PrepareMeshes(Preview* preview, const pvtMesh* occluder)
{
    pvtContext* context = preview->context;
    const pvtMesh* original = preview->original;
    const size_t pixels = (size_t)preview->tileSize * (size_t)preview->tileSize;
    preview->tile = pvtAllocate(context, pixels, 4);
    preview->points = pvtAllocate(context, original->positionCount, sizeof *preview->points);
    if (preview->tile == NULL || preview->points == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (size_t i = 0; i < original->positionCount; ++i) {
        preview->points[i] = pvtPreviewSpace_Map(&preview->space, original->positions[i]);
    }
    return pvtPaintOccluder(context, &preview->space, occluder, &preview->paint);
}

static pvtStatus RenderPreview(Preview* preview, const pvtMesh* occluder, pvtImage* image)
{
    pvtStatus status = PrepareMeshes(preview, occluder);
    if (status == PVT_OK) {
        status = pvtCreateImage(preview->context, COLUMNS * preview->tileSize,
                                PVT_PREVIEW_VIEWS / COLUMNS * preview->tileSize, image);
    }
    if (status == PVT_OK) {
        status = pvtEnterGl(preview->context, preview->gl);
    }
    if (status == PVT_OK) {
        status = RenderTiles(preview, image);
        pvtLeaveGl(preview->gl);
    }
    if (status != PVT_OK) {
        pvtImage_Free(preview->context, image);
    }
    return status;
}

pvtStatus pvtRenderPreview(pvtContext* context, pvtGl* gl, const pvtPreviewOptions* options,
                           const pvtMesh* original, const pvtMesh* occluder, pvtImage* image)
{
    *image = (pvtImage){0};
    const int tileSize = options->tileSize;
    if (tileSize < SMALLEST_TILE || tileSize > LARGEST_TILE) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "tiles of %d pixels; their size must be %d to %d", tileSize, SMALLEST_TILE,
                       LARGEST_TILE);
    }
    pvtBeginStage(context, "preview");
    Preview preview = {.context = context, .gl = gl, .tileSize = tileSize, .original = original};
    preview.side = tileSize <= 1024 ? 3 : 2;
    preview.space = pvtMakePreviewSpace(options->up, original, occluder);
    const pvtStatus status = RenderPreview(&preview, occluder, image);
    pvtPreviewPaint_Free(context, &preview.paint);
    pvtRelease(context, preview.points);
    pvtRelease(context, preview.tile);
    return status;
}
