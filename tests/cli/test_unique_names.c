// SPDX-License-Identifier: MIT
// Names that are given once each, and no more changed than it takes.
#include "check.h"

#include "unique_names.h"

#include <string.h>

static void Check(const char* const* names, const char* const* expected, size_t count)
{
    char** unique = pvtMakeUniqueNames(names, count);
    assert_non_null(unique);
    for (size_t i = 0; i < count; ++i) {
        assert_string_equal(unique[i], expected[i]);
    }
    pvtFreeUniqueNames(unique, count);
}

static void names_that_differ_stay(void** state)
{
    (void)state;
    const char* const names[] = {"b", "a", "a_2", "\xc3\xa4", "_2"};
    Check(names, names, 5);
    Check(NULL, NULL, 0);
}

static void equal_names_get_numbers_that_nobody_has(void** state)
{
    (void)state;
    const char* const names[] = {"a", "a_2", "a", "a", "a_2", "a_2_2"};
    const char* const expected[] = {"a", "a_2", "a_3", "a_4", "a_2_3", "a_2_2"};
    Check(names, expected, 6);
}

static void missing_names_are_made_up(void** state)
{
    (void)state;
    const char* const names[] = {"", NULL, "node", "node_2"};
    const char* const expected[] = {"node", "node_3", "node_4", "node_2"};
    Check(names, expected, 4);
}

static void many_equal_names_take_no_longer_than_others(void** state)
{
    (void)state;
    enum { COUNT = 200000 };
    const char** names = test_calloc(COUNT, sizeof *names);
    for (int i = 0; i < COUNT; ++i) {
        names[i] = "tree";
    }
    char** unique = pvtMakeUniqueNames(names, COUNT);
    assert_non_null(unique);
    assert_string_equal(unique[0], "tree");
    assert_string_equal(unique[COUNT - 1], "tree_200000");
    pvtFreeUniqueNames(unique, COUNT);
    test_free(names);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_that_differ_stay),
        cmocka_unit_test(equal_names_get_numbers_that_nobody_has),
        cmocka_unit_test(missing_names_are_made_up),
        cmocka_unit_test(many_equal_names_take_no_longer_than_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
