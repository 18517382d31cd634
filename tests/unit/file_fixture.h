// SPDX-License-Identifier: MIT
// A context, a folder and a model, made and freed around each test of readers and writers.
#ifndef PVT_TEST_FILE_FIXTURE_H
#define PVT_TEST_FILE_FIXTURE_H

#include "files.h"

typedef struct Fixture {
    pvtContext* context;
    Warnings warnings;
    TestFolder folder;
    pvtLoadOptions options;
    pvtModel model;
} Fixture;

static inline int SetUp(void** state)
{
    Fixture* fixture = calloc(1, sizeof *fixture);
    assert_non_null(fixture);
    fixture->context = CreateWarningContext(&fixture->warnings);
    fixture->folder = MakeTestFolder();
    fixture->options = pvtDefaultLoadOptions();
    *state = fixture;
    return 0;
}

static inline int TearDown(void** state)
{
    Fixture* fixture = *state;
    pvtModel_Free(fixture->context, &fixture->model);
    (void)RemoveTestFolder(&fixture->folder);
    DestroyTestContext(fixture->context);
    free(fixture);
    return 0;
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, SetUp, TearDown)

#endif
