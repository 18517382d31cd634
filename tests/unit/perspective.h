// SPDX-License-Identifier: MIT
// What a camera sees: meshes drawn in perspective with many points a pixel, and how far an
// occluder's wrong points lie from the original's.
#ifndef PVT_TEST_PERSPECTIVE_H
#define PVT_TEST_PERSPECTIVE_H

#include "check.h"

#include "base/vector.h"
#include "evaluate/excess.h"

#include <paravent/ladder.h>

/// A camera that looks at `center` along `direction` from `distance`; `reach` bounds what there is
/// to see around the center. A pixel is `fineness` points wide and high.
typedef struct Camera {
    pvtVec3 center, direction;
    double distance, reach;
    int fineness;
} Camera;

// Where a position lies on a picture of `side` points, in 1/256 point.
static inline pvtScreenPoint ProjectPosition(const Camera* camera, const pvtScreen* axes,
                                             const double focalAndSide[2], pvtVec3 position)
{
    const pvtVec3 p = pvtSub(position, camera->center);
    const double depth = camera->distance + pvtDot(p, axes->direction);
    assert_true(depth > 0.0);
    const double x = focalAndSide[0] * pvtDot(p, axes->right) / depth + 0.5 * focalAndSide[1];
    const double y = focalAndSide[0] * pvtDot(p, axes->up) / depth + 0.5 * focalAndSide[1];
    return (pvtScreenPoint){(int32_t)lrint(256.0 * x), (int32_t)lrint(256.0 * y)};
}

static inline void DrawPerspective(pvtContext* context, const Camera* camera, double focal,
                                   const pvtMesh* mesh, pvtRaster* raster)
{
    const pvtScreen axes = pvtMakeScreen(camera->direction);
    const double sine = camera->reach / camera->distance;
    const int side = 2 * (int)ceil(focal * sine / sqrt(1.0 - sine * sine)) + 4;
    CHECK_OK(context, pvtRaster_Resize(context, raster, side, side));
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        pvtScreenPoint p[3];
        for (size_t c = 0; c < 3; ++c) {
            p[c] = ProjectPosition(camera, &axes, (double[2]){focal, side},
                                   mesh->positions[mesh->indices[3 * t + c]]);
        }
        pvtRaster_FillTriangle(raster, p[0], p[1], p[2]);
    }
}

/// [px] The largest distance from a point that only the occluder covers to the nearest that the
/// original covers.
static inline double MeasureThickness(pvtContext* context, const Camera* camera,
                                      const pvtScreenOptions* screen, const pvtMesh* original,
                                      const pvtMesh* occluder)
{
    const double focal =
        camera->fineness * 0.5 * screen->height / tan(screen->fieldOfView * (M_PI / 360.0));
    pvtRaster rasters[2] = {{0}, {0}};
    DrawPerspective(context, camera, focal, original, &rasters[0]);
    DrawPerspective(context, camera, focal, occluder, &rasters[1]);
    const pvtRasterPair pair = {&rasters[0], &rasters[1], 0, 0};
    pvtExcessScratch scratch = {0};
    pvtExcess excess;
    CHECK_OK(context, pvtMeasureExcess(context, &pair, &scratch, &excess));
    pvtExcessScratch_Free(context, &scratch);
    pvtRaster_Free(context, &rasters[0]);
    pvtRaster_Free(context, &rasters[1]);
    return sqrt((double)excess.distance2) / camera->fineness;
}

// The farthest corner of a mesh from the center.
static inline double GetCornerDistance(pvtVec3 center, const pvtMesh* mesh)
{
    double most = 0.0;
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        most = fmax(most, pvtLength3(pvtSub(mesh->positions[mesh->indices[i]], center)));
    }
    return most;
}

enum { PICTURE_DIRECTIONS = 42, PICTURE_FINENESS = 10 };

/// [px] The same at some distance, from many directions; the worst.
static inline double MeasureLevel(pvtContext* context, const pvtLadder* ladder, size_t index,
                                  const pvtScreenOptions* screen, const pvtMesh* original,
                                  double distance, int fineness)
{
    const pvtMesh* occluder = &ladder->levels[index].occluder.mesh;
    Camera camera = {.center = ladder->center, .distance = distance, .fineness = fineness};
    camera.reach = fmax(GetCornerDistance(camera.center, original),
                        GetCornerDistance(camera.center, occluder));
    double worst = 0.0;
    for (int i = 0; i < PICTURE_DIRECTIONS; ++i) {
        // A spiral over the sphere, then the axes, along which gaps between boxes are seen.
        const int axis = i - (PICTURE_DIRECTIONS - 6);
        const double z = 1.0 - (2.0 * i + 1.0) / (PICTURE_DIRECTIONS - 6);
        const double angle = 2.399963229728653 * i, ring = sqrt(fmax(0.0, 1.0 - z * z));
        camera.direction = (pvtVec3){ring * cos(angle), ring * sin(angle), z};
        if (axis >= 0) {
            const double sign = axis < 3 ? 1.0 : -1.0;
            camera.direction = (pvtVec3){axis % 3 == 0 ? sign : 0.0, axis % 3 == 1 ? sign : 0.0,
                                         axis % 3 == 2 ? sign : 0.0};
        }
        worst = fmax(worst, MeasureThickness(context, &camera, screen, original, occluder));
    }
    return worst;
}

/// Builds a ladder and looks at every level from its distance: nothing that it hides wrongly may be
/// thicker than the pixel error. From an eighth of the distance some level has to show more, or
/// there was nothing to be seen.
static inline void CheckLadderPictures(pvtContext* context, const pvtLadderOptions* options,
                                       const pvtMesh* mesh)
{
    pvtLadder ladder;
    CHECK_OK(context, pvtBuildLadder(context, options, mesh, &ladder));
    const double pixelError = options->screen.pixelError;
    double nearest = 0.0;
    for (size_t i = 0; i < ladder.count; ++i) {
        const double distance = ladder.levels[i].distance;
        const double worst =
            MeasureLevel(context, &ladder, i, &options->screen, mesh, distance, PICTURE_FINENESS);
        // What lies between the points of two pictures goes unseen.
        if (worst > pixelError + 2.0 / PICTURE_FINENESS) {
            fail_msg("LOD%zu shows an error of %g pixels at its distance", i, worst);
        }
        if (i + 1 == ladder.count) {
            nearest = MeasureLevel(context, &ladder, i, &options->screen, mesh, distance / 8.0, 2);
        }
    }
    if (nearest <= 1.5 * pixelError) {
        fail_msg("no level shows more than %g pixels from near by", nearest);
    }
    pvtLadder_Free(context, &ladder);
}

#endif
