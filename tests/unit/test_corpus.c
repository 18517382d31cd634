// SPDX-License-Identifier: MIT
// Folders of models from elsewhere, named by PVT_MODELS (good ones) and PVT_NASTY (any): whatever
// is in them is read or refused with a message, and what is read is sound.
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
