// SPDX-License-Identifier: MIT
// Graphics contexts opened at run time, the stencil slicer (paper, section 4.2) and the renderer.
#ifndef PARAVENT_GL_H
#define PARAVENT_GL_H

#include <paravent/image.h>
#include <paravent/occlusion.h>
#include <paravent/section.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum pvtGlBackend {
    PVT_GL_AUTO, ///< EGL hardware device, EGL surfaceless, EGL software device, EGL default, OSMesa
    PVT_GL_EGL,
    PVT_GL_OSMESA,
} pvtGlBackend;

/// An OpenGL 3.3 core context without a window. One thread at a time may use it; no call leaves it
/// current, so that several of them, of either backend, can live in one process and on one thread.
/// What a driver allocates is not counted by the pvtContext.
typedef struct pvtGl pvtGl;

/// PVT_UNSUPPORTED says what to install. Links no GL library: libEGL and libOSMesa are opened here,
/// and stay open.
PVT_API pvtStatus pvtOpenGl(pvtContext* context, pvtGlBackend backend, pvtGl** gl);
/// True when EGL offers real graphics hardware; quick, and opens no context.
PVT_API bool pvtHasGlHardware(void);
PVT_API void pvtCloseGl(pvtContext* context, pvtGl* gl);
/// "EGL (surfaceless), llvmpipe (LLVM 15.0.6, 256 bits)".
PVT_API const char* pvtGl_GetName(const pvtGl* gl);
/// The backend in use: PVT_GL_EGL or PVT_GL_OSMESA.
PVT_API pvtGlBackend pvtGl_GetBackend(const pvtGl* gl);

/// Slices `voxelMesh` (of a grid with this frame, wound outwards) by the near plane: the stencil
/// counts back faces up and front faces down beyond the plane. Equal to pvtSliceGrid with
/// PVT_SLICE_CENTER but where the plane meets a voxel's face within 1/512 cell of the cell's
/// centre, along u and along v: graphics cards and llvmpipe place vertices on a grid of 1/256
/// pixel. PVT_INVALID_ARGUMENT when a position is not a voxel's corner. Slices of more cells a side
/// than the context has pixels are PVT_LIMIT. Release the slicer before its context.
PVT_API pvtStatus pvtCreateStencilSlicer(pvtContext* context, pvtGl* gl, const pvtGridFrame* frame,
                                         const pvtMesh* voxelMesh, pvtSlicer* slicer);
PVT_API void pvtReleaseStencilSlicer(pvtContext* context, pvtSlicer* slicer);

/// The mesh's silhouette in a view: pixel (i, j) of the bitmap has its centre at
/// lower + (i + ½, j + ½) × pixelSize along view->right and view->up; row 0 is the lowest. The
/// caller creates the bitmap. Triangles count whichever way they are wound.
PVT_API pvtStatus pvtRenderSilhouette(pvtContext* context, pvtGl* gl, const pvtMesh* mesh,
                                      const pvtView* view, const double lower[2], double pixelSize,
                                      pvtBitmap* bitmap);

typedef struct pvtPreviewOptions {
    int tileSize; ///< [px] 64 to 2048, each of the six views; default 480
    pvtAxis up;   ///< default y; the front looks along −z (up y), +y (up z) or +z (up x)
} pvtPreviewOptions;

PVT_API pvtPreviewOptions pvtDefaultPreviewOptions(void);

/// Six views in two rows of three, tileSize pixels each: from the front, right and above; front;
/// right; from behind, left and above; top; from the front, left and below. The original is shaded,
/// the occluder's polygons lie over it in translucent colours, one a plane, with their edges; what
/// sticks out of the original is solid. Each view is framed around what it shows.
PVT_API pvtStatus pvtRenderPreview(pvtContext* context, pvtGl* gl, const pvtPreviewOptions* options,
                                   const pvtMesh* original, const pvtMesh* occluder,
                                   pvtImage* image);

#ifdef __cplusplus
}
#endif
#endif
