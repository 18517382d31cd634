// SPDX-License-Identifier: MIT
// The six views of a preview: from where they look, and how they frame what they see.
#include "gl/preview.h"

#include "base/vector.h"

#include <string.h>

// Free space around the model, as a fraction of the half image.
#define MARGIN 0.10
// Tangent of half the field of view: about 30° in all, gentle enough not to distort.
#define HALF_FIELD 0.27
// No view shows less than this of the unit cube, however thin the model is.
#define SMALLEST_HALF 0.02
// Kept free in front of the nearest and behind the farthest point.
#define DEPTH_MARGIN 0.05

typedef struct ViewDef {
    pvtVec3 from; // where the viewer stands
    pvtVec3 up;   // of the image
    bool perspective;
} ViewDef;

// Corners look solid in perspective; fronts and sides are measured by eye, so they have none.
static const ViewDef viewDefs[PVT_PREVIEW_VIEWS] = {
    {{0.80, 0.55, 1.00}, {0, 1, 0}, true},  // front, right, above
    {{0, 0, 1}, {0, 1, 0}, false},          // front
    {{1, 0, 0}, {0, 1, 0}, false},          // right
    {{-0.80, 0.55, -1.0}, {0, 1, 0}, true}, // back, left, above
    {{0, 1, 0}, {0, 0, -1}, false},         // top
    {{-0.80, -0.55, 1.0}, {0, 1, 0}, true}, // front, left, below
};

// Unlike fmax a single instruction: this runs for every corner of every triangle.
static double Max(double a, double b)
{
    return a > b ? a : b;
}

// A point in the axes of a view.
static pvtVec3 GetPoint(const pvtPreviewCloud* cloud, size_t i, const pvtVec3 axes[3])
{
    const size_t index = cloud->indices != NULL ? cloud->indices[i] : i;
    pvtPreviewPoint point;
    memcpy(&point, (const char*)cloud->points + index * cloud->stride, sizeof point);
    const pvtVec3 at = {point.x, point.y, point.z};
    return (pvtVec3){pvtDot(at, axes[0]), pvtDot(at, axes[1]), pvtDot(at, axes[2])};
}

// The largest of x, −x, y, −y, z and −z, the first four after `field` times z was added to them: a
// point stays within the image of a camera at (x, y, z) when
// p.x + field × p.z ≤ x + field × z and alike for −x, y and −y, so that of all points only the
// largest left sides matter. An orthographic view has a field of 0.
typedef struct Extent {
    double most[6];
} Extent;

static Extent MeasureExtent(const pvtVec3 axes[3], double field, const pvtPreviewCloud* clouds,
                            size_t cloudCount)
{
    Extent extent;
    for (int i = 0; i < 6; ++i) {
        extent.most[i] = -HUGE_VAL;
    }
    for (size_t c = 0; c < cloudCount; ++c) {
        for (size_t i = 0; i < clouds[c].count; ++i) {
            const pvtVec3 at = GetPoint(&clouds[c], i, axes);
            const double wider = field * at.z;
            const double values[6] = {wider + at.x, wider - at.x, wider + at.y,
                                      wider - at.y, at.z,         -at.z};
            for (int v = 0; v < 6; ++v) {
                extent.most[v] = Max(extent.most[v], values[v]);
            }
        }
    }
    if (extent.most[4] < -extent.most[5]) {
        extent = (Extent){{1, 1, 1, 1, 1, 1}}; // nothing to see
    }
    return extent;
}

// Moves an eye sideways so that what it sees in perspective has as much room on one side as on the
// other.
static void CenterEye(double eye[3], const pvtVec3 axes[3], const pvtPreviewCloud* clouds,
                      size_t cloudCount)
{
    double most[4] = {0.0, 0.0, 0.0, 0.0};
    for (size_t c = 0; c < cloudCount; ++c) {
        for (size_t i = 0; i < clouds[c].count; ++i) {
            const pvtVec3 at = GetPoint(&clouds[c], i, axes);
            const double x = (at.x - eye[0]) / (eye[2] - at.z);
            const double y = (at.y - eye[1]) / (eye[2] - at.z);
            most[0] = Max(most[0], x);
            most[1] = Max(most[1], -x);
            most[2] = Max(most[2], y);
            most[3] = Max(most[3], -y);
        }
    }
    eye[0] += 0.5 * (most[0] - most[1]) * eye[2];
    eye[1] += 0.5 * (most[2] - most[3]) * eye[2];
}

static void SetView(pvtPreviewCamera* camera, const pvtVec3 axes[3], const double eye[3])
{
    memset(camera->view, 0, sizeof camera->view);
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            camera->view[4 * column + row] = (float)pvtGetAxis(axes[row], column);
        }
        camera->view[12 + row] = (float)-eye[row];
        camera->up[row] = (float)axes[row].y;
    }
    camera->view[15] = 1.0F;
}

static void SetProjection(pvtPreviewCamera* camera)
{
    const float n = camera->nearest, f = camera->farthest;
    float* m = camera->projection;
    memset(m, 0, sizeof camera->projection);
    m[0] = 1.0F / camera->reach[0];
    m[5] = 1.0F / camera->reach[1];
    if (camera->perspective) {
        m[10] = -(f + n) / (f - n);
        m[11] = -1.0F;
        m[14] = -2.0F * f * n / (f - n);
    } else {
        m[10] = -2.0F / (f - n);
        m[14] = -(f + n) / (f - n);
        m[15] = 1.0F;
    }
}

pvtPreviewCamera pvtMakePreviewCamera(int view, const pvtPreviewCloud* clouds, size_t cloudCount)
{
    const ViewDef* def = &viewDefs[view];
    const pvtVec3 back = pvtNormalize(def->from);
    const pvtVec3 right = pvtNormalize(pvtCross(def->up, back));
    const pvtVec3 axes[3] = {right, pvtCross(back, right), back};
    const double field = def->perspective ? HALF_FIELD * (1.0 - MARGIN) : 0.0;
    const Extent extent = MeasureExtent(axes, field, clouds, cloudCount);
    const double* most = extent.most;
    const double half = fmax(SMALLEST_HALF, 0.5 * fmax(most[0] + most[1], most[2] + most[3]));

    pvtPreviewCamera camera = {.perspective = def->perspective};
    double eye[3] = {0.5 * (most[0] - most[1]), 0.5 * (most[2] - most[3]), most[4] + 1.0};
    double reach = half / (1.0 - MARGIN);
    if (def->perspective) {
        eye[2] = half / field;
        // Something tiny on the axis would be closer than the near plane.
        eye[2] = fmax(eye[2], most[4] + 2.0 * DEPTH_MARGIN);
        reach = HALF_FIELD;
        CenterEye(eye, axes, clouds, cloudCount);
    }
    camera.nearest = (float)(eye[2] - most[4] - DEPTH_MARGIN);
    camera.farthest = (float)(eye[2] + most[5] + DEPTH_MARGIN);
    camera.reach[0] = camera.reach[1] = (float)reach;
    SetView(&camera, axes, eye);
    SetProjection(&camera);
    return camera;
}
