// SPDX-License-Identifier: MIT
// A context as the files of this room see it, and what a backend has to fill in.
#ifndef PVT_GL_CONTEXT_H
#define PVT_GL_CONTEXT_H

#include "gl/gl_functions.h"

#include <paravent/gl.h>

/// The pairs of shaders that a context compiles when it first needs them.
typedef enum pvtGlProgram {
    PVT_PROGRAM_SLICE,
    PVT_PROGRAM_SILHOUETTE,
    PVT_PROGRAM_SURFACE,
    PVT_PROGRAM_OCCLUDER,
    PVT_PROGRAM_EDGE,
    PVT_PROGRAM_RESOLVE,
    PVT_PROGRAM_COUNT,
} pvtGlProgram;

enum { PVT_GL_LOG_SIZE = 1024 };

typedef void (*pvtGlProc)(void);

/// A backend: one file each, one table each.
typedef struct pvtGlPlatform {
    pvtGlBackend backend;
    /// Opens `library` and makes a context, not current on return. Sets gl->native, and gl->place
    /// for the name. PVT_UNSUPPORTED says what is missing and what to install.
    pvtStatus (*open)(pvtContext* context, const char* library, pvtGl* gl);
    void (*close)(pvtContext* context, pvtGl* gl);
    bool (*makeCurrent)(pvtGl* gl);
    void (*clearCurrent)(pvtGl* gl);
    pvtGlProc (*getProcAddress)(pvtGl* gl, const char* name);
} pvtGlPlatform;

struct pvtGl {
    const pvtGlPlatform* platform;
    void* native;      // the backend's own
    const char* place; // "EGL (surfaceless)"
    pvtGlFunctions functions;
    GLuint programs[PVT_PROGRAM_COUNT]; // 0: not made yet
    int maxSize;                        // [px] a side of textures and viewports; a power of two
    char name[256];
};

extern const pvtGlPlatform pvtEglPlatform;
extern const pvtGlPlatform pvtOsMesaPlatform;

/// The shared libraries to look for: a test asks for one that is not there.
typedef struct pvtGlLibraries {
    const char *egl, *osMesa;
} pvtGlLibraries;

pvtStatus pvtOpenGlFrom(pvtContext* context, pvtGlBackend backend, const pvtGlLibraries* libraries,
                        pvtGl** gl);
bool pvtHasGlHardwareIn(const char* eglLibrary);

/// Opens a shared library for good, its symbols kept to itself; null with the reason in `error`.
/// GL libraries are never closed: their threads and exit handlers outlive any context.
void* pvtOpenGlLibrary(const char* library, char* error, size_t errorSize);
/// A function of the library; null when it has none of that name.
pvtGlProc pvtFindGlSymbol(void* library, const char* name);

/// Makes the context current with everything switched off and nothing bound. Each public call
/// enters and leaves, so that several contexts can take turns on one thread.
pvtStatus pvtEnterGl(pvtContext* context, pvtGl* gl);
void pvtLeaveGl(pvtGl* gl);
/// PVT_OUT_OF_MEMORY or PVT_UNSUPPORTED when GL has met an error since the last time.
pvtStatus pvtCheckGl(pvtContext* context, pvtGl* gl, const char* task);

/// Triangles a draw call: few enough to stop soon when cancelled.
enum { PVT_GL_DRAW_TRIANGLES = 1 << 16 };

/// Draws triangles of the vertex array that is bound, by its 32-bit indices.
pvtStatus pvtDrawGlTriangles(pvtContext* context, const pvtGl* gl, size_t count);

/// Compiles it at the first call.
pvtStatus pvtGetGlProgram(pvtContext* context, pvtGl* gl, pvtGlProgram which, GLuint* program);

typedef struct pvtGlTargetDef {
    int width, height;               // [px]
    GLenum colorFormat, depthFormat; // sized internal formats; 0 leaves that texture out
} pvtGlTargetDef;

/// Textures to draw into.
typedef struct pvtGlTarget {
    GLuint framebuffer, color, depth; // depth: with the stencil, where the format has one
    int width, height;                // [px]
} pvtGlTarget;

/// PVT_LIMIT when a side is longer than the context can do. Bound on success.
pvtStatus pvtCreateGlTarget(pvtContext* context, pvtGl* gl, const pvtGlTargetDef* def,
                            pvtGlTarget* target);
void pvtGlTarget_Free(pvtGl* gl, pvtGlTarget* target);

/// Sets the bits whose bytes are `value`; rows are bitmap->width bytes, the lowest first.
void pvtPackBitmap(const uint8_t* bytes, uint8_t value, pvtBitmap* bitmap);

#endif
