// SPDX-License-Identifier: MIT
#include "check.h"

#include "json.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static char buffer[4096];

static pvtJson MakeLine(pvtJsonText* text)
{
    *text = (pvtJsonText){buffer, sizeof buffer, 0};
    return pvtMakeJsonLine(text);
}

static void nested_values_are_separated_by_commas(void** state)
{
    (void)state;
    pvtJsonText text;
    pvtJson json = MakeLine(&text);
    pvtJson_BeginObject(&json, NULL);
    pvtJson_Integer(&json, "a", INT64_MIN);
    pvtJson_BeginArray(&json, "b");
    pvtJson_Bool(&json, NULL, true);
    pvtJson_BeginObject(&json, NULL);
    pvtJson_EndObject(&json);
    pvtJson_Number(&json, NULL, 0.25);
    pvtJson_EndArray(&json);
    pvtJson_String(&json, "c", NULL);
    pvtJson_EndObject(&json);
    assert_string_equal(buffer, "{\"a\":-9223372036854775808,\"b\":[true,{},0.25],\"c\":null}\n");
}

static void strings_are_escaped_and_always_utf8(void** state)
{
    (void)state;
    pvtJsonText text;
    pvtJson json = MakeLine(&text);
    pvtJson_BeginArray(&json, NULL);
    pvtJson_String(&json, NULL, "\"\\\n\t\x01\x7F");
    pvtJson_String(&json, NULL, "h\xC3\xA4user\xF0\x9F\x8F\xA0");
    // A lone continuation, an overlong slash, a surrogate, a cut sequence, past the last character.
    pvtJson_String(&json, NULL, "\x80|\xC0\xAF|\xED\xA0\x80|\xE2\x82|\xF4\x90\x80\x80");
    pvtJson_EndArray(&json);
    assert_non_null(strstr(buffer, "\"\\\"\\\\\\n\\u0009\\u0001\\u007f\""));
    assert_non_null(strstr(buffer, "\"h\xC3\xA4user\xF0\x9F\x8F\xA0\""));
    for (const char* place = buffer; *place != '\0';) {
        const size_t length = pvtGetUtf8Length(place);
        assert_int_not_equal(length, 0);
        place += length;
    }
}

static void no_number_is_ever_nan_or_infinite(void** state)
{
    (void)state;
    pvtJsonText text;
    pvtJson json = MakeLine(&text);
    pvtJson_BeginArray(&json, NULL);
    pvtJson_Number(&json, NULL, NAN);
    pvtJson_Number(&json, NULL, -INFINITY);
    pvtJson_EndArray(&json);
    assert_string_equal(buffer, "[null,null]\n");
}

// A German locale, whose numbers have a comma, in a folder of its own: few machines have one
// installed, but glibc's localedef makes one where the sources are (package locales).
static bool SetCommaLocale(void)
{
    char folder[] = "/tmp/pvt-test-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char command[256];
    (void)snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s/comma >/dev/null 2>&1",
                   folder);
    (void)!system(command);
    assert_int_equal(setenv("LOCPATH", folder, 1), 0);
    const bool isSet = setlocale(LC_NUMERIC, "comma") != NULL;
    assert_int_equal(unsetenv("LOCPATH"), 0);
    (void)snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
    return isSet;
}

static void numbers_have_a_point_in_any_locale(void** state)
{
    (void)state;
    if (!SetCommaLocale()) {
        skip();
    }
    assert_string_equal(localeconv()->decimal_point, ",");
    pvtJsonText text;
    pvtJson json = MakeLine(&text);
    pvtJson_BeginArray(&json, NULL);
    pvtJson_Number(&json, NULL, 0.1);
    pvtJson_Number(&json, NULL, 1.0 / 3.0);
    pvtJson_EndArray(&json);
    setlocale(LC_NUMERIC, "C");
    assert_string_equal(buffer, "[0.1,0.3333333333333333]\n");
}

static void a_line_that_does_not_fit_stays_terminated(void** state)
{
    (void)state;
    char small[8];
    pvtJsonText text = {small, sizeof small, 0};
    pvtJson json = pvtMakeJsonLine(&text);
    pvtJson_BeginArray(&json, NULL);
    pvtJson_String(&json, NULL, "much longer than eight bytes");
    pvtJson_EndArray(&json);
    assert_int_equal(strlen(small), 7);
}

static void control_characters_are_not_harmless(void** state)
{
    (void)state;
    static const struct {
        const char* text;
        size_t length;
        bool isHarmless;
    } cases[] = {{"a", 1, true},        {"\xc3\xa4", 2, true},
                 {"\xc2\xa0", 2, true}, {"\xf0\x9f\x8f\xa0", 4, true},
                 {"\x1b[2J", 1, false}, {"\n", 1, false},
                 {"\x7f", 1, false},    {"\xc2\x9b", 2, false},
                 {"\xff", 1, false},    {"\xc3", 1, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        bool isHarmless = !cases[i].isHarmless;
        assert_int_equal(pvtMeasureCharacter(cases[i].text, &isHarmless), cases[i].length);
        assert_int_equal(isHarmless, cases[i].isHarmless);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nested_values_are_separated_by_commas),
        cmocka_unit_test(strings_are_escaped_and_always_utf8),
        cmocka_unit_test(no_number_is_ever_nan_or_infinite),
        cmocka_unit_test(numbers_have_a_point_in_any_locale),
        cmocka_unit_test(a_line_that_does_not_fit_stays_terminated),
        cmocka_unit_test(control_characters_are_not_harmless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
