// SPDX-License-Identifier: MIT
// The three ways to slice against each other on real models: those of the project, and those of the
// folder that PVT_MODELS names.
#include "check.h"

#include "base/random.h"
#include "stencil_check.h"

#include <dirent.h>
#include <paravent/gl.h>
#include <paravent/io.h>
#include <string.h>

enum { RESOLUTION = 56, PLANES = 12 };

typedef struct Slicers {
    pvtContext* context;
    pvtGl* gls[2];
    pvtSlicer stencils[2];
    pvtRandom random;
    uint64_t cells, set, mismatches;
} Slicers;

static void ComparePlane(Slicers* slicers, const pvtSliceVolume* volume, const pvtPlane* plane,
                         const char* name)
{
    pvtContext* context = slicers->context;
    const int* size = volume->grid->frame.size;
    const int width = size[pvtPlane_GetU(plane)], height = size[pvtPlane_GetV(plane)];
    pvtBitmap sampled, counted;
    CHECK_OK(context, pvtCreateBitmap(context, width, height, &sampled));
    CHECK_OK(context, pvtCreateBitmap(context, width, height, &counted));
    pvtSliceGrid(volume, plane, PVT_SLICE_CENTER, 1, &sampled);
    slicers->set += pvtBitmap_Count(&sampled);
    for (int b = 0; b < 2; ++b) {
        const pvtSlicer* stencil = &slicers->stencils[b];
        CHECK_OK(context, stencil->slice(context, stencil->user, plane, 1, &counted));
        for (int cell = 0; cell < width * height; ++cell) {
            const int x = cell % width, y = cell / width;
            if (pvtBitmap_Get(&sampled, x, y) != pvtBitmap_Get(&counted, x, y)) {
                ++slicers->mismatches;
                if (!IsNextToFace(plane, 1, x, y)) {
                    fail_msg("%s: %s differs at (%d, %d), away from any face", name,
                             pvtGl_GetName(slicers->gls[b]), x, y);
                }
            }
        }
        slicers->cells += (uint64_t)width * (uint64_t)height;
    }
    pvtBitmap_Free(context, &sampled);
    pvtBitmap_Free(context, &counted);
}

static void CompareSolid(Slicers* slicers, const pvtBitGrid* grid, const char* name)
{
    pvtContext* context = slicers->context;
    const pvtGridFrame* frame = &grid->frame;
    pvtSliceVolume volume;
    pvtMesh mesh;
    CHECK_OK(context, pvtCreateSliceVolume(context, grid, &volume));
    CHECK_OK(context, pvtBuildVoxelMesh(context, grid, &mesh));
    for (int b = 0; b < 2; ++b) {
        CHECK_OK(context, pvtCreateStencilSlicer(context, slicers->gls[b], frame, &mesh,
                                                 &slicers->stencils[b]));
    }
    for (int i = 0; i < PLANES; ++i) {
        double at[6];
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = pvtRandom_Unit(&slicers->random) - 0.5;
            at[3 + axis] = (0.3 + 0.4 * pvtRandom_Unit(&slicers->random)) * frame->size[axis] *
                           frame->voxelSize;
        }
        const pvtVec3 point = {frame->origin.x + at[3], frame->origin.y + at[4],
                               frame->origin.z + at[5]};
        const pvtPlane plane = pvtMakePlane(frame, (pvtVec3){at[0], at[1], at[2]}, point);
        ComparePlane(slicers, &volume, &plane, name);
    }
    pvtReleaseStencilSlicer(context, &slicers->stencils[0]);
    pvtReleaseStencilSlicer(context, &slicers->stencils[1]);
    pvtMesh_Free(context, &mesh);
    pvtSliceVolume_Free(context, &volume);
}

static void CompareModel(Slicers* slicers, const char* path)
{
    pvtContext* context = slicers->context;
    pvtModel model;
    pvtBitGrid surface;
    pvtSolid solid;
    const pvtLoadOptions loadOptions = pvtDefaultLoadOptions();
    const pvtSolidOptions solidOptions = pvtDefaultSolidOptions();
    pvtVoxelizeOptions voxelizeOptions = pvtDefaultVoxelizeOptions();
    voxelizeOptions.resolution = RESOLUTION;
    CHECK_OK(context, pvtLoadModel(context, &loadOptions, path, &model));
    CHECK_OK(context, pvtVoxelizeMesh(context, &voxelizeOptions, &model.mesh, &surface));
    CHECK_OK(context, pvtFillSolid(context, &solidOptions, &surface, &solid));
    CompareSolid(slicers, &solid.inside, path);
    pvtSolid_Free(context, &solid);
    pvtBitGrid_Free(context, &surface);
    pvtModel_Free(context, &model);
}

// Returns the number of models in the folder.
static int CompareFolder(Slicers* slicers, const char* folder)
{
    int count = 0;
    DIR* directory = opendir(folder);
    assert_non_null(directory);
    for (const struct dirent* entry; (entry = readdir(directory)) != NULL;) {
        const size_t length = strlen(entry->d_name);
        if (length > 4 && strcmp(entry->d_name + length - 4, ".glb") == 0) {
            char path[4096];
            (void)snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
            CompareModel(slicers, path);
            ++count;
        }
    }
    closedir(directory);
    return count;
}

static void CheckFolder(const char* folder)
{
    const pvtGlBackend backends[2] = {PVT_GL_EGL, PVT_GL_OSMESA};
    Slicers slicers = {.context = CreateTestContext(1), .random = pvtMakeRandom(3, 0)};
    for (int b = 0; b < 2; ++b) {
        CHECK_OK(slicers.context, pvtOpenGl(slicers.context, backends[b], &slicers.gls[b]));
    }
    assert_true(CompareFolder(&slicers, folder) > 0);
    print_message("%llu of %llu cells differ\n", (unsigned long long)slicers.mismatches,
                  (unsigned long long)slicers.cells);
    assert_true(slicers.set > slicers.cells / 100);
    assert_true(slicers.mismatches <= slicers.cells / 10000);
    for (int b = 0; b < 2; ++b) {
        pvtCloseGl(slicers.context, slicers.gls[b]);
    }
    DestroyTestContext(slicers.context);
}

static void three_slicers_agree_on_the_projects_models(void** state)
{
    (void)state;
    CheckFolder(PVT_TEST_MODELS);
}

static void three_slicers_agree_on_more_models(void** state)
{
    (void)state;
    const char* folder = getenv("PVT_MODELS");
    if (folder == NULL) {
        skip();
    }
    CheckFolder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_slicers_agree_on_the_projects_models),
        cmocka_unit_test(three_slicers_agree_on_more_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
