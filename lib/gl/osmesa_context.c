// SPDX-License-Identifier: MIT
// Contexts of OSMesa: Mesa's software rasterizer, drawing into memory.
#include "gl/gl_context.h"

#include "base/context.h"

#include <string.h>

// The part of GL/osmesa.h that is used here: the header comes with a package that nothing else
// would need, and the library itself is only known at run time.
enum {
    OSMESA_FORMAT = 0x22,
    OSMESA_DEPTH_BITS = 0x30,
    OSMESA_STENCIL_BITS = 0x31,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37,
};

typedef struct osmesa_context* OSMesaContext;
typedef OSMesaContext CreateContextAttribsFcn(const int* attributes, OSMesaContext shared);
typedef void DestroyContextFcn(OSMesaContext native);
typedef GLboolean MakeCurrentFcn(OSMesaContext native, void* buffer, GLenum type, GLsizei width,
                                 GLsizei height);
typedef pvtGlProc GetProcAddressFcn(const char* name);

typedef struct OsMesa {
    CreateContextAttribsFcn* createContextAttribs;
    DestroyContextFcn* destroyContext;
    MakeCurrentFcn* makeCurrent;
    GetProcAddressFcn* getProcAddress;
    OSMesaContext native;
    uint32_t pixel; // the window's only one; all drawing goes to framebuffer objects
} OsMesa;

static bool FindFunctions(void* library, OsMesa* osMesa)
{
    osMesa->createContextAttribs =
        (CreateContextAttribsFcn*)pvtFindGlSymbol(library, "OSMesaCreateContextAttribs");
    osMesa->destroyContext = (DestroyContextFcn*)pvtFindGlSymbol(library, "OSMesaDestroyContext");
    osMesa->makeCurrent = (MakeCurrentFcn*)pvtFindGlSymbol(library, "OSMesaMakeCurrent");
    osMesa->getProcAddress = (GetProcAddressFcn*)pvtFindGlSymbol(library, "OSMesaGetProcAddress");
    return osMesa->createContextAttribs != NULL && osMesa->destroyContext != NULL &&
           osMesa->makeCurrent != NULL && osMesa->getProcAddress != NULL;
}

static pvtStatus CreateNative(pvtContext* context, const char* library, OsMesa* osMesa)
{
    char reason[256];
    void* opened = pvtOpenGlLibrary(library, reason, sizeof reason);
    if (opened == NULL) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "OSMesa is not on this machine (%s); install libosmesa6", reason);
    }
    const int attributes[] = {OSMESA_FORMAT,
                              GL_RGBA,
                              OSMESA_DEPTH_BITS,
                              0,
                              OSMESA_STENCIL_BITS,
                              0,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    if (FindFunctions(opened, osMesa)) {
        osMesa->native = osMesa->createContextAttribs(attributes, NULL);
    }
    if (osMesa->native == NULL) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "%s gives no OpenGL 3.3 core context; install a newer libosmesa6", library);
    }
    return PVT_OK;
}

static pvtStatus OpenOsMesa(pvtContext* context, const char* library, pvtGl* gl)
{
    OsMesa* osMesa = pvtAllocate(context, 1, sizeof(OsMesa));
    if (osMesa == NULL) {
        return pvtContext_GetStatus(context);
    }
    const pvtStatus status = CreateNative(context, library, osMesa);
    if (status != PVT_OK) {
        pvtRelease(context, osMesa);
        return status;
    }
    gl->native = osMesa;
    gl->place = "OSMesa";
    return PVT_OK;
}

static void CloseOsMesa(pvtContext* context, pvtGl* gl)
{
    OsMesa* osMesa = gl->native;
    osMesa->destroyContext(osMesa->native);
    pvtRelease(context, osMesa);
}

static bool MakeCurrent(pvtGl* gl)
{
    OsMesa* osMesa = gl->native;
    return osMesa->makeCurrent(osMesa->native, &osMesa->pixel, GL_UNSIGNED_BYTE, 1, 1);
}

static void ClearCurrent(pvtGl* gl)
{
    const OsMesa* osMesa = gl->native;
    osMesa->makeCurrent(NULL, NULL, GL_UNSIGNED_BYTE, 0, 0);
}

static pvtGlProc GetProcAddress(pvtGl* gl, const char* name)
{
    const OsMesa* osMesa = gl->native;
    return osMesa->getProcAddress(name);
}

const pvtGlPlatform pvtOsMesaPlatform = {
    PVT_GL_OSMESA, OpenOsMesa, CloseOsMesa, MakeCurrent, ClearCurrent, GetProcAddress,
};
