// SPDX-License-Identifier: MIT
// Slices of a solid: on the CPU by both rules, and by the stencil of each backend.
#include "speed.h"

#include <math.h>
#include <paravent/gl.h>
#include <paravent/io.h>
#include <string.h>

enum { DIRECTIONS = 32, DEPTHS = 3, PLANES = DIRECTIONS * DEPTHS };

typedef struct SliceJob {
    pvtRun* run;
    const pvtSpeedLine* line;
    const pvtMesh* mesh;
    int resolution;
    pvtBitGrid grid;
    pvtSliceVolume volume;
    pvtPlane planes[PLANES];
    int planeCount;
    pvtBitmap slices[3]; // one an axis
    pvtSliceRule rule;
    pvtSlicer slicer; // of the stencil
} SliceJob;

// A point of the sphere around the origin, of radius 1.
static pvtVec3 GetBallPoint(int ring, int rings, int place, int places)
{
    const double halfTurn = 3.14159265358979323846;
    const double fall = halfTurn * ring / rings;
    const double turn = 2 * halfTurn * (place % places) / places;
    return (pvtVec3){sin(fall) * cos(turn), cos(fall), sin(fall) * sin(turn)};
}

static pvtStatus MakeBall(pvtRun* run, pvtMesh* mesh)
{
    enum { RINGS = 32, PLACES = 64, CORNERS = RINGS * PLACES * 6 };
    static const int corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    pvtVec3 points[CORNERS];
    for (int i = 0; i < CORNERS; ++i) {
        const int* corner = corners[i % 6];
        points[i] =
            GetBallPoint(i / 6 / PLACES + corner[0], RINGS, i / 6 % PLACES + corner[1], PLACES);
    }
    return pvtCreateMesh(run->context, points, CORNERS, NULL, CORNERS / 3, mesh);
}

// Directions spread evenly are of each axis and of many slopes; the depths are all within.
static pvtStatus MakePlanes(SliceJob* job)
{
    pvtViewOptions options = pvtDefaultViewOptions();
    options.count = DIRECTIONS;
    pvtViewSet views;
    const pvtStatus status = pvtMakeViews(job->run->context, &options, &views);
    if (status != PVT_OK) {
        return status;
    }
    const pvtGridFrame* frame = &job->grid.frame;
    job->planeCount = 0;
    for (int i = 0; i < DIRECTIONS * DEPTHS && i < (int)views.count * DEPTHS; ++i) {
        const pvtVec3 direction = views.views[i / DEPTHS].direction;
        const int depth = i % DEPTHS - DEPTHS / 2;
        const double shift = 0.25 * depth;
        const pvtVec3 point = {
            frame->origin.x + frame->voxelSize * frame->size[0] * (0.5 + shift * direction.x),
            frame->origin.y + frame->voxelSize * frame->size[1] * (0.5 + shift * direction.y),
            frame->origin.z + frame->voxelSize * frame->size[2] * (0.5 + shift * direction.z)};
        job->planes[job->planeCount++] = pvtMakePlane(frame, direction, point);
    }
    pvtViewSet_Free(job->run->context, &views);
    return PVT_OK;
}

static pvtStatus CreateSlices(SliceJob* job)
{
    pvtStatus status = PVT_OK;
    for (int axis = 0; axis < 3 && status == PVT_OK; ++axis) {
        const pvtPlane plane = {.axis = (pvtAxis)axis};
        status = pvtCreateBitmap(job->run->context, job->grid.frame.size[pvtPlane_GetU(&plane)],
                                 job->grid.frame.size[pvtPlane_GetV(&plane)], &job->slices[axis]);
    }
    return status;
}

static void ReleaseJob(SliceJob* job)
{
    pvtContext* context = job->run->context;
    for (int axis = 0; axis < 3; ++axis) {
        pvtBitmap_Free(context, &job->slices[axis]);
    }
    pvtSliceVolume_Free(context, &job->volume);
    pvtBitGrid_Free(context, &job->grid);
}

static pvtStatus SliceHere(void* passData)
{
    SliceJob* job = passData;
    for (int i = 0; i < job->planeCount; ++i) {
        const pvtPlane* plane = &job->planes[i];
        pvtSliceGrid(&job->volume, plane, job->rule, 1, &job->slices[plane->axis]);
    }
    return PVT_OK;
}

static pvtStatus SliceByStencil(void* passData)
{
    SliceJob* job = passData;
    pvtStatus status = PVT_OK;
    for (int i = 0; i < job->planeCount && status == PVT_OK; ++i) {
        const pvtPlane* plane = &job->planes[i];
        status = job->slicer.slice(job->run->context, job->slicer.user, plane, 1,
                                   &job->slices[plane->axis]);
    }
    return status;
}

static pvtStatus PrintSlices(SliceJob* job, pvtPassFcn* pass, const char* what, const char* note)
{
    double seconds = 0;
    const pvtStatus status = pvtMeasurePass(job->run, job->line, pass, job, &seconds);
    if (status == PVT_OK) {
        char title[64];
        (void)snprintf(title, sizeof title, "%s, N = %d", what, job->resolution);
        pvtReport_ClearBar(&job->run->report);
        printf("%-40s %9.4f ms a slice%s%s\n", title, seconds / job->planeCount * 1e3,
               note[0] != '\0' ? "; " : "", note);
        fflush(stdout);
    }
    return status;
}

static pvtStatus PrintBackend(SliceJob* job, const pvtMesh* voxelMesh, pvtGlBackend backend)
{
    const char* what = backend == PVT_GL_EGL ? "stencil slices, EGL" : "stencil slices, OSMesa";
    pvtContext* context = job->run->context;
    pvtGl* gl = NULL;
    pvtStatus status = pvtOpenGl(context, backend, &gl);
    if (status == PVT_UNSUPPORTED) {
        printf("%s, N = %-*d not here\n", what, (int)(40 - strlen(what) - 6), job->resolution);
        return PVT_OK;
    }
    if (status != PVT_OK) {
        return status;
    }
    status = pvtCreateStencilSlicer(context, gl, &job->grid.frame, voxelMesh, &job->slicer);
    if (status == PVT_OK) {
        status = PrintSlices(job, SliceByStencil, what, pvtGl_GetName(gl));
        pvtReleaseStencilSlicer(context, &job->slicer);
    }
    pvtCloseGl(context, gl);
    return status;
}

static pvtStatus PrintBackends(SliceJob* job)
{
    pvtMesh voxelMesh;
    pvtStatus status = pvtBuildVoxelMesh(job->run->context, &job->grid, &voxelMesh);
    if (status == PVT_OK) {
        status = PrintBackend(job, &voxelMesh, PVT_GL_EGL);
        if (status == PVT_OK) {
            status = PrintBackend(job, &voxelMesh, PVT_GL_OSMESA);
        }
        pvtMesh_Free(job->run->context, &voxelMesh);
    }
    return status;
}

static pvtStatus PrepareJob(SliceJob* job)
{
    pvtStatus status =
        pvtMakeBenchGrid(job->run, &job->line->bench, job->resolution, job->mesh, &job->grid);
    if (status == PVT_OK && pvtBitGrid_Count(&job->grid) == 0) {
        pvtReport_Warn(&job->run->report, "nothing is inside at %d voxels: the slices are empty",
                       job->resolution);
    }
    if (status == PVT_OK) {
        status = pvtCreateSliceVolume(job->run->context, &job->grid, &job->volume);
    }
    if (status == PVT_OK) {
        status = MakePlanes(job);
    }
    return status == PVT_OK ? CreateSlices(job) : status;
}

static pvtStatus PrintResolution(pvtRun* run, const pvtSpeedLine* line, const pvtMesh* mesh,
                                 int resolution, bool hasBackends)
{
    SliceJob job = {.run = run, .line = line, .mesh = mesh, .resolution = resolution};
    pvtStatus status = PrepareJob(&job);
    if (status == PVT_OK) {
        job.rule = PVT_SLICE_CENTER;
        status = PrintSlices(&job, SliceHere, "centre slices", "");
    }
    if (status == PVT_OK) {
        job.rule = PVT_SLICE_COVERED;
        status = PrintSlices(&job, SliceHere, "covered slices", "");
    }
    if (status == PVT_OK && hasBackends) {
        status = PrintBackends(&job);
    }
    ReleaseJob(&job);
    return status;
}

static pvtStatus PrintMesh(pvtRun* run, const pvtSpeedLine* line, const pvtMesh* mesh)
{
    const pvtStatus status = PrintResolution(run, line, mesh, 256, false);
    return status == PVT_OK ? PrintResolution(run, line, mesh, 64, true) : status;
}

pvtStatus pvtPrintSliceSpeeds(pvtRun* run, const pvtSpeedLine* line, const char* path)
{
    pvtStatus status = PVT_OK;
    if (path == NULL) {
        pvtMesh ball;
        status = MakeBall(run, &ball);
        if (status == PVT_OK) {
            status = PrintMesh(run, line, &ball);
            pvtMesh_Free(run->context, &ball);
        }
        return status;
    }
    const pvtLoadOptions options = pvtDefaultLoadOptions();
    pvtModel model;
    status = pvtLoadModel(run->context, &options, path, &model);
    if (status == PVT_OK) {
        status = PrintMesh(run, line, &model.mesh);
        pvtModel_Free(run->context, &model);
    }
    return status;
}
