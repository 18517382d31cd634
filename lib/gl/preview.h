// SPDX-License-Identifier: MIT
// What the parts of the preview hand each other.
#ifndef PVT_GL_PREVIEW_H
#define PVT_GL_PREVIEW_H

#include "gl/gl_context.h"

/// Positions moved and scaled into the cube of side 2 around the origin, the original's and the
/// occluder's alike. Axes: x to the right, y up, z to the front.
typedef struct pvtPreviewSpace {
    pvtVec3 center; // half of it, since the sum of two bounds may overflow
    double scale;   // of half a position less `center`
    pvtAxis up;
} pvtPreviewSpace;

typedef struct pvtPreviewPoint {
    float x, y, z;
} pvtPreviewPoint;

/// A corner of a triangle of the occluder.
typedef struct pvtPreviewVertex {
    pvtPreviewPoint at;
    uint8_t color[4]; // sRGB
} pvtPreviewVertex;

/// An edge of a polygon.
typedef struct pvtPreviewEdge {
    pvtPreviewPoint begin, end;
    uint8_t color[4]; // sRGB; the last is the width, 255 for the widest
} pvtPreviewEdge;

pvtPreviewSpace pvtMakePreviewSpace(pvtAxis up, const pvtMesh* original, const pvtMesh* occluder);
pvtPreviewPoint pvtPreviewSpace_Map(const pvtPreviewSpace* space, pvtVec3 position);

/// The occluder in colours: a colour for each run of triangles on one plane, and the edges of those
/// runs: wide ones around a run, then thin ones within. An occluder of very many triangles has
/// none.
typedef struct pvtPreviewPaint {
    pvtPreviewVertex* vertices; // 3 × triangleCount
    pvtPreviewEdge* edges;
    size_t vertexCount, edgeCount;
    size_t outlineCount; // the first of the edges
} pvtPreviewPaint;

pvtStatus pvtPaintOccluder(pvtContext* context, const pvtPreviewSpace* space,
                           const pvtMesh* occluder, pvtPreviewPaint* paint);
void pvtPreviewPaint_Free(pvtContext* context, pvtPreviewPaint* paint);

enum { PVT_PREVIEW_VIEWS = 6 };

/// A camera for one tile. Matrices column after column.
typedef struct pvtPreviewCamera {
    float view[16], projection[16];
    float nearest, farthest; // the near and the far plane's distances
    float reach[2];          // half of the image: in view space, or at distance 1 in perspective
    float up[3];             // of the world, in view space
    bool perspective;
} pvtPreviewCamera;

/// Triangle corners to frame: points[indices[i]], or points[i] where indices is null.
typedef struct pvtPreviewCloud {
    const pvtPreviewPoint* points;
    const uint32_t* indices;
    size_t count, stride; // stride: in bytes
} pvtPreviewCloud;

/// View 0 to 5, framed tightly around the clouds.
pvtPreviewCamera pvtMakePreviewCamera(int view, const pvtPreviewCloud* clouds, size_t cloudCount);

#endif
