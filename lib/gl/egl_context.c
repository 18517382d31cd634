// SPDX-License-Identifier: MIT
// Contexts of EGL, without a window: on a graphics card where there is one, else in software.
#include "gl/gl_context.h"

#include "base/context.h"

#include <string.h>

// Types only: no prototype that could be linked, and none of X11's headers.
#define EGL_EGL_PROTOTYPES 0
#define EGL_NO_PLATFORM_SPECIFIC_TYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>

enum { MAX_DEVICES = 32, MAX_PLACES = MAX_DEVICES + 2 };

// X(TYPE, Name) as in gl_functions.h. Every libEGL.so.1 exports these.
#define EGL_FUNCTIONS(X)                                                                           \
    X(BINDAPI, BindAPI)                                                                            \
    X(CHOOSECONFIG, ChooseConfig)                                                                  \
    X(CREATECONTEXT, CreateContext)                                                                \
    X(CREATEPBUFFERSURFACE, CreatePbufferSurface)                                                  \
    X(DESTROYCONTEXT, DestroyContext)                                                              \
    X(DESTROYSURFACE, DestroySurface)                                                              \
    X(GETDISPLAY, GetDisplay)                                                                      \
    X(GETPROCADDRESS, GetProcAddress)                                                              \
    X(INITIALIZE, Initialize)                                                                      \
    X(MAKECURRENT, MakeCurrent)                                                                    \
    X(QUERYAPI, QueryAPI)                                                                          \
    X(QUERYSTRING, QueryString)

typedef struct EglFunctions {
#define EGL_MEMBER(TYPE, Name) PFNEGL##TYPE##PROC Name;
    EGL_FUNCTIONS(EGL_MEMBER)
#undef EGL_MEMBER
    // Null where the extension is missing.
    PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplay;
    PFNEGLQUERYDEVICESEXTPROC QueryDevices;
    PFNEGLQUERYDEVICESTRINGEXTPROC QueryDeviceString;
} EglFunctions;

typedef struct Egl {
    EglFunctions functions;
    EGLDisplay display;
    EGLContext native;
    EGLSurface surface; // EGL_NO_SURFACE where a context can do without
} Egl;

// Somewhere to get a display from.
typedef struct Place {
    const char* name;
    EGLenum platform; // 0: the default display
    void* device;
} Place;

// True when a list of words holds this one whole.
static bool HasWord(const char* list, const char* word)
{
    const size_t length = strlen(word);
    for (const char* at = list; at != NULL && (at = strstr(at, word)) != NULL; at += length) {
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == '\0')) {
            return true;
        }
    }
    return false;
}

static bool LoadEgl(void* library, EglFunctions* egl)
{
#define EGL_LOAD(TYPE, Name)                                                                       \
    egl->Name = (PFNEGL##TYPE##PROC)pvtFindGlSymbol(library, "egl" #Name);                         \
    if (egl->Name == NULL) {                                                                       \
        return false;                                                                              \
    }
    EGL_FUNCTIONS(EGL_LOAD)
#undef EGL_LOAD
    const char* client = egl->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (HasWord(client, "EGL_EXT_platform_base")) {
        egl->GetPlatformDisplay =
            (PFNEGLGETPLATFORMDISPLAYEXTPROC)egl->GetProcAddress("eglGetPlatformDisplayEXT");
    }
    if (HasWord(client, "EGL_EXT_device_base") || HasWord(client, "EGL_EXT_device_enumeration")) {
        egl->QueryDevices = (PFNEGLQUERYDEVICESEXTPROC)egl->GetProcAddress("eglQueryDevicesEXT");
        egl->QueryDeviceString =
            (PFNEGLQUERYDEVICESTRINGEXTPROC)egl->GetProcAddress("eglQueryDeviceStringEXT");
    }
    return true;
}

// Appends the devices that are hardware, or those that are not; returns the new count.
static int ListDevices(const EglFunctions* egl, bool hardware, int count, Place* places)
{
    if (egl->QueryDevices == NULL || egl->QueryDeviceString == NULL ||
        egl->GetPlatformDisplay == NULL) {
        return count;
    }
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint deviceCount = 0;
    if (!egl->QueryDevices(MAX_DEVICES, devices, &deviceCount)) {
        return count;
    }
    for (EGLint i = 0; i < deviceCount && count < MAX_PLACES; ++i) {
        const char* words = egl->QueryDeviceString(devices[i], EGL_EXTENSIONS);
        if (HasWord(words, "EGL_MESA_device_software") != hardware) {
            places[count++] = (Place){hardware ? "EGL (device)" : "EGL (software device)",
                                      EGL_PLATFORM_DEVICE_EXT, devices[i]};
        }
    }
    return count;
}

static int ListPlaces(const EglFunctions* egl, Place* places)
{
    int count = ListDevices(egl, true, 0, places);
    if (count < MAX_PLACES && egl->GetPlatformDisplay != NULL &&
        HasWord(egl->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS),
                "EGL_MESA_platform_surfaceless")) {
        places[count++] = (Place){"EGL (surfaceless)", EGL_PLATFORM_SURFACELESS_MESA, NULL};
    }
    count = ListDevices(egl, false, count, places);
    if (count < MAX_PLACES) {
        places[count++] = (Place){"EGL (default display)", 0, NULL};
    }
    return count;
}

// EGL_NO_DISPLAY when there is none, or it does not start. A display belongs to the whole process
// and is never terminated.
static EGLDisplay StartDisplay(const EglFunctions* egl, const Place* place)
{
    EGLDisplay display =
        place->platform == 0
            ? egl->GetDisplay(EGL_DEFAULT_DISPLAY)
            : egl->GetPlatformDisplay(place->platform,
                                      place->device != NULL ? place->device : EGL_DEFAULT_DISPLAY,
                                      NULL);
    if (display == EGL_NO_DISPLAY || !egl->Initialize(display, NULL, NULL)) {
        return EGL_NO_DISPLAY;
    }
    return HasWord(egl->QueryString(display, EGL_CLIENT_APIS), "OpenGL") ? display : EGL_NO_DISPLAY;
}

static bool CreateOn(Egl* egl, EGLDisplay display)
{
    const EglFunctions* f = &egl->functions;
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                             EGL_NONE};
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              3,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    const EGLint onePixel[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
    EGLConfig config = NULL;
    EGLint count = 0;
    if (!f->ChooseConfig(display, wanted, &config, 1, &count) || count < 1) {
        return false;
    }
    egl->display = display;
    egl->native = f->CreateContext(display, config, EGL_NO_CONTEXT, version);
    if (egl->native == EGL_NO_CONTEXT) {
        return false;
    }
    if (HasWord(f->QueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
        return true;
    }
    egl->surface = f->CreatePbufferSurface(display, config, onePixel);
    if (egl->surface == EGL_NO_SURFACE) {
        f->DestroyContext(display, egl->native);
        return false;
    }
    return true;
}

// The first place that gives a context; null when none does.
static const char* CreateAnywhere(Egl* egl)
{
    const EglFunctions* f = &egl->functions;
    Place places[MAX_PLACES];
    const int count = ListPlaces(f, places);
    // The API bound is the thread's: whoever calls us may have another one bound.
    const EGLenum before = f->QueryAPI();
    f->BindAPI(EGL_OPENGL_API);
    const char* found = NULL;
    for (int i = 0; i < count && found == NULL; ++i) {
        EGLDisplay display = StartDisplay(f, &places[i]);
        if (display != EGL_NO_DISPLAY && CreateOn(egl, display)) {
            found = places[i].name;
        }
    }
    f->BindAPI(before);
    return found;
}

static pvtStatus CreateNative(pvtContext* context, const char* library, Egl* egl,
                              const char** place)
{
    char reason[256];
    void* opened = pvtOpenGlLibrary(library, reason, sizeof reason);
    if (opened == NULL) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "EGL is not on this machine (%s); install libegl1 and libgl1-mesa-dri",
                       reason);
    }
    if (!LoadEgl(opened, &egl->functions)) {
        return pvtFail(context, PVT_UNSUPPORTED, "%s is not an EGL library; install libegl1",
                       library);
    }
    *place = CreateAnywhere(egl);
    if (*place == NULL) {
        return pvtFail(context, PVT_UNSUPPORTED,
                       "EGL offers no OpenGL 3.3 core context on this machine; install a graphics "
                       "driver, or libgl1-mesa-dri for software rendering");
    }
    return PVT_OK;
}

static pvtStatus OpenEgl(pvtContext* context, const char* library, pvtGl* gl)
{
    Egl* egl = pvtAllocate(context, 1, sizeof(Egl));
    if (egl == NULL) {
        return pvtContext_GetStatus(context);
    }
    const pvtStatus status = CreateNative(context, library, egl, &gl->place);
    if (status != PVT_OK) {
        pvtRelease(context, egl);
        return status;
    }
    gl->native = egl;
    return PVT_OK;
}

static void CloseEgl(pvtContext* context, pvtGl* gl)
{
    Egl* egl = gl->native;
    if (egl->surface != EGL_NO_SURFACE) {
        egl->functions.DestroySurface(egl->display, egl->surface);
    }
    egl->functions.DestroyContext(egl->display, egl->native);
    pvtRelease(context, egl);
}

static bool MakeCurrent(pvtGl* gl)
{
    const Egl* egl = gl->native;
    return egl->functions.MakeCurrent(egl->display, egl->surface, egl->surface, egl->native);
}

static void ClearCurrent(pvtGl* gl)
{
    const Egl* egl = gl->native;
    egl->functions.MakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

static pvtGlProc GetProcAddress(pvtGl* gl, const char* name)
{
    const Egl* egl = gl->native;
    return (pvtGlProc)egl->functions.GetProcAddress(name);
}

const pvtGlPlatform pvtEglPlatform = {
    PVT_GL_EGL, OpenEgl, CloseEgl, MakeCurrent, ClearCurrent, GetProcAddress,
};

// Mesa names its software drivers "swrast" and "kms_swrast"; a display card without a 3-D engine
// ends up with the latter. Other makers' EGL has hardware behind all its devices.
static bool IsDrivenBySoftware(const EglFunctions* egl, EGLDisplay display)
{
    if (!HasWord(egl->QueryString(display, EGL_EXTENSIONS), "EGL_MESA_query_driver")) {
        return false;
    }
    const PFNEGLGETDISPLAYDRIVERNAMEPROC getName =
        (PFNEGLGETDISPLAYDRIVERNAMEPROC)egl->GetProcAddress("eglGetDisplayDriverName");
    const char* name = getName != NULL ? getName(display) : NULL;
    return name != NULL && strstr(name, "swrast") != NULL;
}

bool pvtHasGlHardwareIn(const char* eglLibrary)
{
    char reason[256];
    EglFunctions egl = {0};
    void* opened = pvtOpenGlLibrary(eglLibrary, reason, sizeof reason);
    if (opened == NULL || !LoadEgl(opened, &egl)) {
        return false;
    }
    Place places[MAX_PLACES];
    const int count = ListDevices(&egl, true, 0, places);
    for (int i = 0; i < count; ++i) {
        EGLDisplay display = StartDisplay(&egl, &places[i]);
        if (display != EGL_NO_DISPLAY && !IsDrivenBySoftware(&egl, display)) {
            return true;
        }
    }
    return false;
}
