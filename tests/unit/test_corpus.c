// SPDX-License-Identifier: MIT
// Folders of models from elsewhere, named by PVT_MODELS (good ones) and PVT_NASTY (any): whatever
// is in them is read or refused with a message, what is read is sound, and a glTF can be taken over
// whole.
#include "files.h"

#include <ftw.h>

enum { MOST_FILES = 4000 };

// nftw hands nothing through to what it calls.
static pvtContext* walkContext;
static int fileCount, readCount;
static bool allAreGood;

static void CheckModel(const pvtModel* model)
{
    const pvtMesh* mesh = &model->mesh;
    assert_true(mesh->triangleCount > 0 && model->partCount > 0);
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        assert_true(mesh->indices[i] < mesh->positionCount);
    }
    for (size_t i = 0; i < mesh->positionCount; ++i) {
        const pvtVec3 p = mesh->positions[i];
        assert_true(isfinite(p.x) && isfinite(p.y) && isfinite(p.z));
    }
    size_t next = 0;
    for (size_t i = 0; i < model->partCount; ++i) {
        assert_int_equal(model->parts[i].firstTriangle, next);
        assert_true(model->parts[i].triangleCount > 0);
        assert_true(model->parts[i].name[0] != '\0');
        next += model->parts[i].triangleCount;
    }
    assert_int_equal(next, mesh->triangleCount);
}

// Written out again with a triangle beside it, a glTF gives the same triangles.
static void CheckTakenOver(const char* path, const pvtModel* model)
{
    if (!pvtIsGltf(walkContext, path)) {
        return;
    }
    const TestFolder folder = MakeTestFolder();
    const char* copy = InFolder(&folder, "copy.glb");
    pvtVec3 corners[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t indices[3] = {0, 1, 2};
    const pvtMesh mesh = {corners, indices, 3, 1};
    const pvtSaveItem item = {.name = "beside", .mesh = &mesh};
    const pvtLevelSet set = {.levels = &item, .levelCount = 1, .original = path, .scene = -1};
    CHECK_OK(walkContext, pvtSaveLevels(walkContext, copy, &set));
    pvtModel again;
    CHECK_OK(walkContext, pvtLoadModel(walkContext, NULL, copy, &again));
    const size_t count = model->mesh.triangleCount;
    assert_int_equal(again.partCount, model->partCount + 1);
    assert_int_equal(again.mesh.triangleCount, count + 1);
    assert_memory_equal(again.mesh.indices, model->mesh.indices, 3 * count * sizeof(uint32_t));
    assert_memory_equal(again.mesh.positions, model->mesh.positions,
                        model->mesh.positionCount * sizeof(pvtVec3));
    pvtModel_Free(walkContext, &again);
    assert_int_equal(RemoveTestFolder(&folder), 1);
}

static int VisitFile(const char* path, const struct stat* info, int kind, struct FTW* place)
{
    (void)info;
    (void)place;
    if (kind != FTW_F || fileCount >= MOST_FILES) {
        return 0;
    }
    pvtModel model;
    const pvtStatus status = pvtLoadModel(walkContext, NULL, path, &model);
    const char* message = pvtContext_GetMessage(walkContext);
    if (status == PVT_OK) {
        CheckModel(&model);
        CheckTakenOver(path, &model);
        ++readCount;
    } else if (allAreGood && strstr(path, ".glb") != NULL) {
        fail_msg("%s", message);
    } else {
        if (status != PVT_INVALID_INPUT && status != PVT_UNSUPPORTED && status != PVT_LIMIT) {
            fail_msg("status %d of %s: %s", (int)status, path, message);
        }
        // The file by name, and more than that.
        assert_non_null(strstr(message, path));
        assert_true(strlen(message) > strlen(path) + 10);
        assert_null(model.mesh.positions);
        assert_null(model.parts);
    }
    pvtModel_Free(walkContext, &model);
    assert_int_equal(pvtContext_GetHeldBytes(walkContext), 0);
    ++fileCount;
    return 0;
}

static void WalkFolder(const char* variable, bool good)
{
    const char* folder = getenv(variable);
    if (folder == NULL || folder[0] == '\0') {
        skip();
    }
    Warnings warnings;
    walkContext = CreateWarningContext(&warnings);
    fileCount = readCount = 0;
    allAreGood = good;
    assert_int_equal(nftw(folder, VisitFile, 16, FTW_PHYS), 0);
    print_message("%s: %d files, %d read\n", folder, fileCount, readCount);
    assert_true(fileCount > 0);
    DestroyTestContext(walkContext);
}

static void every_good_model_is_read(void** state)
{
    (void)state;
    WalkFolder("PVT_MODELS", true);
}

static void every_nasty_file_is_read_or_refused_with_a_reason(void** state)
{
    (void)state;
    WalkFolder("PVT_NASTY", false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_good_model_is_read),
        cmocka_unit_test(every_nasty_file_is_read_or_refused_with_a_reason),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
