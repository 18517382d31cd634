// SPDX-License-Identifier: MIT
// A mesh's silhouette in an orthographic view, one bit a pixel.
#include "gl/gl_context.h"

#include "base/context.h"
#include "base/vector.h"

#include <assert.h>

typedef struct Point {
    float x, y;
} Point;

// Everything beyond this is clipped alike, and the float stays finite.
static float ClampToFloat(double value)
{
    return (float)fmax(-1e30, fmin(1e30, value));
}

// To clip space, of a viewport as large as the bitmap, in double: a float of a position far from
// the origin would not know the pixel any more.
static void ProjectPoints(const pvtMesh* mesh, const pvtView* view, const double lower[2],
                          const double scale[2], Point* points)
{
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        const double right = pvtDot(mesh->positions[i], view->right) - lower[0];
        const double up = pvtDot(mesh->positions[i], view->up) - lower[1];
        points[i] =
            (Point){ClampToFloat(right * scale[0] - 1.0), ClampToFloat(up * scale[1] - 1.0)};
    }
}

static pvtStatus DrawMesh(pvtContext* context, pvtGl* gl, const pvtMesh* mesh, const Point* points)
{
    const pvtGlFunctions* f = &gl->functions;
    GLuint vertexArray = 0, buffers[2] = {0};
    f->GenVertexArrays(1, &vertexArray);
    f->BindVertexArray(vertexArray);
    f->GenBuffers(2, buffers);
    f->BindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    f->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(mesh->positionCount * sizeof *points), points,
                  GL_STREAM_DRAW);
    f->VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, NULL);
    f->EnableVertexAttribArray(0);
    f->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    f->BufferData(GL_ELEMENT_ARRAY_BUFFER,
                  (GLsizeiptr)(mesh->triangleCount * 3 * sizeof *mesh->indices), mesh->indices,
                  GL_STREAM_DRAW);
    pvtStatus status = pvtCheckGl(context, gl, "upload a mesh");
    if (status == PVT_OK) {
        status = pvtDrawGlTriangles(context, gl, mesh->triangleCount);
    }
    f->DeleteVertexArrays(1, &vertexArray);
    f->DeleteBuffers(2, buffers);
    return status;
}

// Draws into a framebuffer of the bitmap's size and reads it back.
static pvtStatus RenderBitmap(pvtContext* context, pvtGl* gl, const pvtMesh* mesh,
                              const Point* points, pvtBitmap* bitmap)
{
    const pvtGlFunctions* f = &gl->functions;
    uint8_t* bytes = pvtAllocate(context, (size_t)bitmap->width * (size_t)bitmap->height, 1);
    if (bytes == NULL) {
        return pvtContext_GetStatus(context);
    }
    GLuint program = 0;
    pvtGlTarget target = {0};
    const pvtGlTargetDef def = {bitmap->width, bitmap->height, GL_R8, 0};
    pvtStatus status = pvtGetGlProgram(context, gl, PVT_PROGRAM_SILHOUETTE, &program);
    if (status == PVT_OK) {
        status = pvtCreateGlTarget(context, gl, &def, &target);
    }
    if (status == PVT_OK) {
        f->Viewport(0, 0, def.width, def.height);
        f->ClearColor(0.0F, 0.0F, 0.0F, 0.0F);
        f->Clear(GL_COLOR_BUFFER_BIT);
        f->UseProgram(program);
        status = DrawMesh(context, gl, mesh, points);
    }
    if (status == PVT_OK) {
        f->ReadPixels(0, 0, def.width, def.height, GL_RED, GL_UNSIGNED_BYTE, bytes);
        status = pvtCheckGl(context, gl, "draw a silhouette");
    }
    if (status == PVT_OK) {
        pvtPackBitmap(bytes, 255, bitmap);
    }
    pvtGlTarget_Free(gl, &target);
    pvtRelease(context, bytes);
    return status;
}

pvtStatus pvtRenderSilhouette(pvtContext* context, pvtGl* gl, const pvtMesh* mesh,
                              const pvtView* view, const double lower[2], double pixelSize,
                              pvtBitmap* bitmap)
{
    assert(pixelSize > 0.0);
    Point* points = pvtAllocate(context, mesh->positionCount, sizeof *points);
    if (points == NULL) {
        return pvtContext_GetStatus(context);
    }
    const double scale[2] = {2.0 / (pixelSize * bitmap->width), 2.0 / (pixelSize * bitmap->height)};
    ProjectPoints(mesh, view, lower, scale, points);
    pvtStatus status = pvtEnterGl(context, gl);
    if (status == PVT_OK) {
        status = RenderBitmap(context, gl, mesh, points, bitmap);
        pvtLeaveGl(gl);
    }
    pvtRelease(context, points);
    return status;
}
