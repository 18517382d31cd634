// SPDX-License-Identifier: MIT
// Opening a context: which backend, its function table, and taking turns on a thread.
#include "gl/gl_context.h"

#include "base/context.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

void* pvtOpenGlLibrary(const char* library, char* error, size_t errorSize)
{
    void* opened = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (opened == NULL) {
        const char* reason = dlerror();
        (void)snprintf(error, errorSize, "%s", reason != NULL ? reason : library);
    }
    return opened;
}

pvtGlProc pvtFindGlSymbol(void* library, const char* name)
{
    // ISO C has no cast from a data pointer to a function pointer; POSIX promises the same bits.
    void* symbol = dlsym(library, name);
    pvtGlProc proc = NULL;
    memcpy(&proc, &symbol, sizeof proc);
    return proc;
}

static pvtStatus LoadFunctions(pvtContext* context, pvtGl* gl)
{
#define PVT_GL_LOAD(TYPE, Name)                                                                    \
    gl->functions.Name = (PFNGL##TYPE##PROC)gl->platform->getProcAddress(gl, "gl" #Name);          \
    if (gl->functions.Name == NULL) {                                                              \
        return pvtFail(context, PVT_UNSUPPORTED, "%s has no gl" #Name, gl->place);                 \
    }
    PVT_GL_FUNCTIONS(PVT_GL_LOAD)
#undef PVT_GL_LOAD
    return PVT_OK;
}

// Names the context and checks that it is what was asked for.
static pvtStatus DescribeContext(pvtContext* context, pvtGl* gl)
{
    const pvtGlFunctions* f = &gl->functions;
    const GLubyte* renderer = f->GetString(GL_RENDERER);
    GLint major = 0, minor = 0, texture = 0, viewport[2] = {0};
    f->GetIntegerv(GL_MAJOR_VERSION, &major);
    f->GetIntegerv(GL_MINOR_VERSION, &minor);
    f->GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    f->GetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    if (renderer == NULL || major * 10 + minor < 33) {
        return pvtFail(context, PVT_UNSUPPORTED, "%s gives OpenGL %d.%d; 3.3 is needed", gl->place,
                       (int)major, (int)minor);
    }
    gl->maxSize = 1;
    while (gl->maxSize <= texture / 2 && gl->maxSize <= viewport[0] / 2 &&
           gl->maxSize <= viewport[1] / 2) {
        gl->maxSize *= 2;
    }
    (void)snprintf(gl->name, sizeof gl->name, "%s, %s", gl->place, (const char*)renderer);
    return PVT_OK;
}

static pvtStatus FillContext(pvtContext* context, pvtGl* gl)
{
    if (!gl->platform->makeCurrent(gl)) {
        return pvtFail(context, PVT_UNSUPPORTED, "%s: the context cannot be made current",
                       gl->place);
    }
    pvtStatus status = LoadFunctions(context, gl);
    if (status == PVT_OK) {
        status = DescribeContext(context, gl);
    }
    gl->platform->clearCurrent(gl);
    return status;
}

static pvtStatus OpenPlatform(pvtContext* context, const pvtGlPlatform* platform,
                              const char* library, pvtGl** gl)
{
    pvtGl* made = pvtAllocate(context, 1, sizeof(pvtGl));
    if (made == NULL) {
        return pvtContext_GetStatus(context);
    }
    made->platform = platform;
    pvtStatus status = platform->open(context, library, made);
    if (status == PVT_OK) {
        status = FillContext(context, made);
        if (status != PVT_OK) {
            platform->close(context, made);
        }
    }
    if (status != PVT_OK) {
        pvtRelease(context, made);
        return status;
    }
    *gl = made;
    return PVT_OK;
}

// EGL first; the message of a failure tells what both lack.
static pvtStatus OpenAny(pvtContext* context, const pvtGlLibraries* libraries, pvtGl** gl)
{
    pvtStatus status = OpenPlatform(context, &pvtEglPlatform, libraries->egl, gl);
    if (status != PVT_UNSUPPORTED) {
        return status;
    }
    char eglMessage[1000];
    (void)snprintf(eglMessage, sizeof eglMessage, "%s", pvtContext_GetMessage(context));
    status = OpenPlatform(context, &pvtOsMesaPlatform, libraries->osMesa, gl);
    if (status != PVT_UNSUPPORTED) {
        return status;
    }
    char osMesaMessage[1000];
    (void)snprintf(osMesaMessage, sizeof osMesaMessage, "%s", pvtContext_GetMessage(context));
    return pvtFail(context, PVT_UNSUPPORTED, "%s; or else: %s", eglMessage, osMesaMessage);
}

pvtStatus pvtOpenGlFrom(pvtContext* context, pvtGlBackend backend, const pvtGlLibraries* libraries,
                        pvtGl** gl)
{
    *gl = NULL;
    switch (backend) {
    case PVT_GL_AUTO:
        return OpenAny(context, libraries, gl);
    case PVT_GL_EGL:
        return OpenPlatform(context, &pvtEglPlatform, libraries->egl, gl);
    case PVT_GL_OSMESA:
        return OpenPlatform(context, &pvtOsMesaPlatform, libraries->osMesa, gl);
    }
    return pvtFail(context, PVT_INVALID_ARGUMENT, "there is no GL backend %d", (int)backend);
}

pvtStatus pvtOpenGl(pvtContext* context, pvtGlBackend backend, pvtGl** gl)
{
    const pvtGlLibraries libraries = {"libEGL.so.1", "libOSMesa.so.8"};
    return pvtOpenGlFrom(context, backend, &libraries, gl);
}

bool pvtHasGlHardware(void)
{
    return pvtHasGlHardwareIn("libEGL.so.1");
}

void pvtCloseGl(pvtContext* context, pvtGl* gl)
{
    if (gl == NULL) {
        return;
    }
    gl->platform->close(context, gl);
    pvtRelease(context, gl);
}

const char* pvtGl_GetName(const pvtGl* gl)
{
    return gl->name;
}

pvtGlBackend pvtGl_GetBackend(const pvtGl* gl)
{
    return gl->platform->backend;
}

pvtStatus pvtEnterGl(pvtContext* context, pvtGl* gl)
{
    if (!gl->platform->makeCurrent(gl)) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "%s: the context cannot be made current; is it in use on another thread?",
                       gl->name);
    }
    const pvtGlFunctions* f = &gl->functions;
    const GLenum switches[] = {GL_BLEND,  GL_CULL_FACE,    GL_DEPTH_TEST,
                               GL_DITHER, GL_SCISSOR_TEST, GL_STENCIL_TEST};
    for (size_t i = 0; i < sizeof switches / sizeof switches[0]; ++i) {
        f->Disable(switches[i]);
    }
    f->FrontFace(GL_CCW);
    f->DepthFunc(GL_LESS);
    f->DepthMask(GL_TRUE);
    f->PixelStorei(GL_PACK_ALIGNMENT, 1);
    return PVT_OK;
}

void pvtLeaveGl(pvtGl* gl)
{
    const pvtGlFunctions* f = &gl->functions;
    f->BindFramebuffer(GL_FRAMEBUFFER, 0);
    f->BindVertexArray(0);
    f->UseProgram(0);
    gl->platform->clearCurrent(gl);
}

pvtStatus pvtCheckGl(pvtContext* context, pvtGl* gl, const char* task)
{
    const GLenum error = gl->functions.GetError();
    if (error == GL_NO_ERROR) {
        return PVT_OK;
    }
    if (error == GL_OUT_OF_MEMORY) {
        return pvtFail(context, PVT_OUT_OF_MEMORY, "%s: no memory to %s", gl->name, task);
    }
    return pvtFail(context, PVT_UNSUPPORTED, "%s: cannot %s (GL error 0x%04x)", gl->name, task,
                   (unsigned)error);
}

pvtStatus pvtDrawGlTriangles(pvtContext* context, const pvtGl* gl, size_t count)
{
    for (size_t first = 0; first < count; first += PVT_GL_DRAW_TRIANGLES) {
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        const size_t left = count - first;
        const size_t some = left < PVT_GL_DRAW_TRIANGLES ? left : PVT_GL_DRAW_TRIANGLES;
        gl->functions.DrawElements(GL_TRIANGLES, (GLsizei)(3 * some), GL_UNSIGNED_INT,
                                   (const void*)(3 * first * sizeof(uint32_t)));
    }
    return PVT_OK;
}
