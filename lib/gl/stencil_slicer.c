// SPDX-License-Identifier: MIT
// Slices of a voxel mesh by the stencil buffer.
//
// Ari Silvennoinen, Hannu Saransaari, Samuli Laine, Jaakko Lehtinen: Occluder Simplification using
// Planar Sections, 2014, section 4.2. The near plane cuts the closed mesh open; of the faces beyond
// it, back faces count up and front faces count down, and what is left at a pixel is 1 inside and
// 0 outside. Here the view looks along the plane's dominant axis and is sheared, so that the slice
// is the near plane and a pixel is a cell: faces that run along that axis have no area in it and
// are left out.
#include "gl/gl_context.h"

#include "base/context.h"
#include "base/vector.h"

#include <assert.h>
#include <string.h>

typedef struct StencilSlicer {
    pvtGl* gl;
    pvtGridFrame frame;
    GLuint vertexArray, corners;
    GLuint faces[3];      // index buffers: what has area when seen along x, y, z
    size_t indexCount[3]; // of each
    pvtGlTarget target;
    uint8_t* bytes; // target.width × target.height
} StencilSlicer;

// A voxel's corner; the fourth is padding, so that a vertex has eight bytes.
typedef struct Corner {
    uint16_t at[4];
} Corner;

static void GetAxes(pvtAxis axis, int axes[3])
{
    axes[0] = axis == PVT_AXIS_X ? 1 : 0;
    axes[1] = axis == PVT_AXIS_Z ? 1 : 2;
    axes[2] = (int)axis;
}

static bool FindCorner(const pvtGridFrame* frame, pvtVec3 position, Corner* corner)
{
    for (int axis = 0; axis < 3; ++axis) {
        const double grid =
            (pvtGetAxis(position, axis) - pvtGetAxis(frame->origin, axis)) / frame->voxelSize;
        const double nearest = round(grid);
        if (!(fabs(grid - nearest) < 0.01) || nearest < 0.0 || nearest > frame->size[axis]) {
            return false;
        }
        corner->at[axis] = (uint16_t)nearest;
    }
    return true;
}

static pvtStatus FindCorners(pvtContext* context, const pvtGridFrame* frame, const pvtMesh* mesh,
                             Corner* corners)
{
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        if (!FindCorner(frame, mesh->positions[i], &corners[i])) {
            return pvtFail(context, PVT_INVALID_ARGUMENT,
                           "position %zu of the voxel mesh is not a corner of the grid", i);
        }
        if (i % 65536 == 0 && pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
    }
    return PVT_OK;
}

static bool HasArea(const Corner* corners, const uint32_t* triangle, const int axes[3])
{
    const uint16_t *a = corners[triangle[0]].at, *b = corners[triangle[1]].at,
                   *c = corners[triangle[2]].at;
    const int u = axes[0], v = axes[1];
    return (int64_t)(b[u] - a[u]) * (c[v] - a[v]) != (int64_t)(c[u] - a[u]) * (b[v] - a[v]);
}

// Uploads the triangles that have area when seen along `axis`; `indices` has room for all.
static void UploadFaces(StencilSlicer* slicer, const pvtMesh* mesh, const Corner* corners,
                        pvtAxis axis, uint32_t* indices)
{
    const pvtGlFunctions* f = &slicer->gl->functions;
    size_t count = 0;
    int axes[3];
    GetAxes(axis, axes);
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const uint32_t* triangle = mesh->indices + 3 * t;
        if (HasArea(corners, triangle, axes)) {
            memcpy(indices + count, triangle, 3 * sizeof *triangle);
            count += 3;
        }
    }
    f->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, slicer->faces[axis]);
    f->BufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *indices), indices,
                  GL_STATIC_DRAW);
    slicer->indexCount[axis] = count;
}

static pvtStatus UploadMesh(pvtContext* context, StencilSlicer* slicer, const pvtMesh* mesh,
                            Corner* corners, uint32_t* indices)
{
    const pvtStatus status = FindCorners(context, &slicer->frame, mesh, corners);
    if (status != PVT_OK) {
        return status;
    }
    const pvtGlFunctions* f = &slicer->gl->functions;
    f->GenVertexArrays(1, &slicer->vertexArray);
    f->BindVertexArray(slicer->vertexArray);
    f->GenBuffers(1, &slicer->corners);
    f->BindBuffer(GL_ARRAY_BUFFER, slicer->corners);
    f->BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(mesh->positionCount * sizeof *corners), corners,
                  GL_STATIC_DRAW);
    f->VertexAttribIPointer(0, 3, GL_UNSIGNED_SHORT, sizeof(Corner), NULL);
    f->EnableVertexAttribArray(0);
    f->GenBuffers(3, slicer->faces);
    for (int axis = 0; axis < 3; ++axis) {
        UploadFaces(slicer, mesh, corners, (pvtAxis)axis, indices);
    }
    return pvtCheckGl(context, slicer->gl, "upload the voxel mesh");
}

static pvtStatus PrepareMesh(pvtContext* context, StencilSlicer* slicer, const pvtMesh* mesh)
{
    Corner* corners = pvtAllocate(context, mesh->positionCount, sizeof *corners);
    uint32_t* indices = pvtAllocate(context, mesh->triangleCount, 3 * sizeof *indices);
    pvtStatus status = corners != NULL && indices != NULL ? pvtEnterGl(context, slicer->gl)
                                                          : pvtContext_GetStatus(context);
    if (status == PVT_OK) {
        status = UploadMesh(context, slicer, mesh, corners, indices);
        pvtLeaveGl(slicer->gl);
    }
    pvtRelease(context, indices);
    pvtRelease(context, corners);
    return status;
}

static void FreeSlicer(pvtContext* context, StencilSlicer* slicer)
{
    pvtGl* gl = slicer->gl;
    if (pvtEnterGl(context, gl) == PVT_OK) {
        pvtGlTarget_Free(gl, &slicer->target);
        gl->functions.DeleteVertexArrays(1, &slicer->vertexArray);
        gl->functions.DeleteBuffers(1, &slicer->corners);
        gl->functions.DeleteBuffers(3, slicer->faces);
        pvtLeaveGl(gl);
    }
    pvtRelease(context, slicer->bytes);
    pvtRelease(context, slicer);
}

// Grows or shrinks the framebuffer and the bytes that it is read into.
static pvtStatus FitTarget(pvtContext* context, StencilSlicer* slicer, int width, int height)
{
    if (slicer->target.width == width && slicer->target.height == height) {
        slicer->gl->functions.BindFramebuffer(GL_FRAMEBUFFER, slicer->target.framebuffer);
        return PVT_OK;
    }
    pvtGlTarget_Free(slicer->gl, &slicer->target);
    pvtRelease(context, slicer->bytes);
    slicer->bytes = pvtAllocate(context, (size_t)width * (size_t)height, 1);
    if (slicer->bytes == NULL) {
        return pvtContext_GetStatus(context);
    }
    const pvtGlTargetDef def = {width, height, 0, GL_DEPTH24_STENCIL8};
    return pvtCreateGlTarget(context, slicer->gl, &def, &slicer->target);
}

// The largest power of two that keeps the highest corner of the grid within the far plane.
static float GetHeightScale(const pvtGridFrame* frame, const pvtPlane* plane, const int axes[3])
{
    const double lowest = (double)plane->offset +
                          fmin(0.0, (double)plane->slopeU * frame->size[axes[0]]) +
                          fmin(0.0, (double)plane->slopeV * frame->size[axes[1]]);
    const double height = frame->size[axes[2]] - lowest / (1 << PVT_PLANE_BITS);
    int exponent = 0;
    frexp(fmax(height, 1.0), &exponent);
    return (float)ldexp(2.0, -exponent);
}

static void SetUniforms(const StencilSlicer* slicer, GLuint program, const pvtPlane* plane,
                        float pixelScale)
{
    const pvtGlFunctions* f = &slicer->gl->functions;
    int axes[3];
    GetAxes(plane->axis, axes);
    // A plane farther off than any grid is wide misses it all the same, and fits in the integers.
    const int64_t farthest = INT64_C(1) << 40;
    const int64_t offset = plane->offset > farthest    ? farthest
                           : plane->offset < -farthest ? -farthest
                                                       : plane->offset;
    const int64_t values[3] = {offset, plane->slopeU, plane->slopeV};
    int high[3], low[3];
    for (int i = 0; i < 3; ++i) {
        low[i] = (int)(values[i] & 1023);
        high[i] = (int)((values[i] - low[i]) / 1024);
    }
    f->UseProgram(program);
    f->Uniform3i(f->GetUniformLocation(program, "axes"), axes[0], axes[1], axes[2]);
    f->Uniform3i(f->GetUniformLocation(program, "high"), high[0], high[1], high[2]);
    f->Uniform3i(f->GetUniformLocation(program, "low"), low[0], low[1], low[2]);
    f->Uniform1f(f->GetUniformLocation(program, "pixelScale"), pixelScale);
    f->Uniform1f(f->GetUniformLocation(program, "heightScale"),
                 GetHeightScale(&slicer->frame, plane, axes));
}

// The viewport is a power of two, mostly outside the framebuffer: then the way from voxels to
// pixels has no rounding. Returns its side.
static int SetViewport(const pvtGlFunctions* f, int width, int height)
{
    int side = 1;
    while (side < width || side < height) {
        side *= 2;
    }
    f->Viewport(0, 0, side, side);
    return side;
}

static void CountFaces(const StencilSlicer* slicer, pvtAxis axis)
{
    const pvtGlFunctions* f = &slicer->gl->functions;
    f->Clear(GL_STENCIL_BUFFER_BIT);
    f->Enable(GL_STENCIL_TEST);
    f->StencilFunc(GL_ALWAYS, 0, 0xff);
    f->StencilOpSeparate(GL_BACK, GL_KEEP, GL_KEEP, GL_INCR_WRAP);
    f->StencilOpSeparate(GL_FRONT, GL_KEEP, GL_KEEP, GL_DECR_WRAP);
    // We look along the axis with u to the right and v up: where u, v, axis are right-handed that
    // is a mirror image.
    f->FrontFace(axis == PVT_AXIS_Y ? GL_CCW : GL_CW);
    f->BindVertexArray(slicer->vertexArray);
    f->BindBuffer(GL_ELEMENT_ARRAY_BUFFER, slicer->faces[axis]);
    f->DrawElements(GL_TRIANGLES, (GLsizei)slicer->indexCount[axis], GL_UNSIGNED_INT, NULL);
    f->Disable(GL_STENCIL_TEST);
}

static pvtStatus RenderSlice(pvtContext* context, StencilSlicer* slicer, const pvtPlane* plane,
                             int cellsPerVoxel, pvtBitmap* slice)
{
    const pvtGlFunctions* f = &slicer->gl->functions;
    GLuint program = 0;
    pvtStatus status = pvtGetGlProgram(context, slicer->gl, PVT_PROGRAM_SLICE, &program);
    if (status == PVT_OK) {
        status = FitTarget(context, slicer, slice->width, slice->height);
    }
    if (status != PVT_OK) {
        return status;
    }
    const int side = SetViewport(f, slice->width, slice->height);
    SetUniforms(slicer, program, plane, 2.0F * (float)cellsPerVoxel / (float)side);
    CountFaces(slicer, plane->axis);
    f->ReadPixels(0, 0, slice->width, slice->height, GL_STENCIL_INDEX, GL_UNSIGNED_BYTE,
                  slicer->bytes);
    status = pvtCheckGl(context, slicer->gl, "make a slice");
    if (status == PVT_OK) {
        pvtPackBitmap(slicer->bytes, 1, slice);
    }
    return status;
}

static pvtStatus Slice(pvtContext* context, void* user, const pvtPlane* plane, int cellsPerVoxel,
                       pvtBitmap* slice)
{
    StencilSlicer* slicer = user;
    int axes[3];
    GetAxes(plane->axis, axes);
    assert(slice->width == slicer->frame.size[axes[0]] * cellsPerVoxel);
    assert(slice->height == slicer->frame.size[axes[1]] * cellsPerVoxel);
    if (pvtIsCancelled(context)) {
        return pvtFailCancelled(context);
    }
    pvtStatus status = pvtEnterGl(context, slicer->gl);
    if (status == PVT_OK) {
        status = RenderSlice(context, slicer, plane, cellsPerVoxel, slice);
        pvtLeaveGl(slicer->gl);
    }
    return status;
}

pvtStatus pvtCreateStencilSlicer(pvtContext* context, pvtGl* gl, const pvtGridFrame* frame,
                                 const pvtMesh* voxelMesh, pvtSlicer* slicer)
{
    *slicer = (pvtSlicer){0};
    StencilSlicer* made = pvtAllocate(context, 1, sizeof(StencilSlicer));
    if (made == NULL) {
        return pvtContext_GetStatus(context);
    }
    made->gl = gl;
    made->frame = *frame;
    const pvtStatus status = PrepareMesh(context, made, voxelMesh);
    if (status != PVT_OK) {
        FreeSlicer(context, made);
        return status;
    }
    *slicer = (pvtSlicer){Slice, made};
    return PVT_OK;
}

void pvtReleaseStencilSlicer(pvtContext* context, pvtSlicer* slicer)
{
    if (slicer->user != NULL) {
        FreeSlicer(context, slicer->user);
    }
    *slicer = (pvtSlicer){0};
}
