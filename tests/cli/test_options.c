// SPDX-License-Identifier: MIT
#include "check.h"

#include "help.h"
#include "options.h"
#include "values.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Values {
    bool ground;
    int budget;
    uint64_t seed, limit;
    double error;
    pvtLength hole;
    int method;
    const char* output;
} Values;

static const char* const methods[] = {"planar", "paper", NULL};

#define FIELD(kindName, field) .kind = (kindName), .offset = offsetof(Values, field)

static const pvtOption table[] = {
    {.name = "ground", FIELD(PVT_OPTION_FLAG, ground), .help = "closed below"},
    {.name = "budget",
     FIELD(PVT_OPTION_INT, budget),
     .placeholder = "N",
     .least = 1,
     .most = 65535,
     .help = "most triangles"},
    {.name = "seed", FIELD(PVT_OPTION_COUNT, seed), .placeholder = "S", .help = "seed"},
    {.name = "limit", FIELD(PVT_OPTION_SIZE, limit), .placeholder = "SIZE", .help = "memory"},
    {.name = "error",
     FIELD(PVT_OPTION_DOUBLE, error),
     .placeholder = "E",
     .most = INFINITY,
     .isLeastExcluded = true,
     .defaultText = "",
     .help = "largest error"},
    {.name = "hole",
     FIELD(PVT_OPTION_LENGTH, hole),
     .placeholder = "D",
     .most = INFINITY,
     .help = "smallest hole"},
    {.name = "method", FIELD(PVT_OPTION_CHOICE, method), .choices = methods, .help = "how"},
    {.name = "output",
     .letter = 'o',
     FIELD(PVT_OPTION_TEXT, output),
     .placeholder = "FILE",
     .isRequired = true,
     .defaultText = "",
     .help = "where to"},
};

static const pvtOptionGroup groups[] = {{"Some", table, 3}, {"More", table + 3, 5}};

static const pvtSyntax syntax = {.name = "try",
                                 .summary = "for tests",
                                 .operands = "INPUT -o FILE",
                                 .leastOperands = 1,
                                 .mostOperands = 1,
                                 .operandHelp = "INPUT is a file.",
                                 .groups = groups,
                                 .groupCount = 2};

// Splits at blanks. `storage` is what the words point into.
static bool Parse(const char* text, Values* values, pvtParsedLine* line)
{
    static char storage[512];
    static char* words[32];
    static const char* operands[32];
    (void)snprintf(storage, sizeof storage, "%s", text);
    int count = 0;
    for (char* word = strtok(storage, " "); word != NULL; word = strtok(NULL, " ")) {
        words[count++] = word;
    }
    *values = (Values){.budget = 64, .seed = 1};
    line->operands = operands;
    return pvtParseLine(&syntax, count, words, values, line);
}

static void every_kind_of_value_is_read(void** state)
{
    (void)state;
    Values values;
    pvtParsedLine line;
    assert_true(Parse("in.glb -o out.glb --budget 53 --seed=9007199254740991 --limit 512M "
                      "--error 1.5e-3 --hole 6vx --method paper --ground",
                      &values, &line));
    assert_int_equal(line.operandCount, 1);
    assert_string_equal(line.operands[0], "in.glb");
    assert_string_equal(values.output, "out.glb");
    assert_int_equal(values.budget, 53);
    assert_true(values.seed == UINT64_C(9007199254740991));
    assert_true(values.limit == UINT64_C(512) << 20);
    assert_true(values.error == 1.5e-3);
    assert_true(values.hole.value == 6.0 && values.hole.inVoxels);
    assert_int_equal(values.method, 1);
    assert_true(values.ground);
    assert_true(pvtIsOptionGiven(&syntax, &line, "error"));
}

static void options_not_given_keep_their_defaults(void** state)
{
    (void)state;
    Values values;
    pvtParsedLine line;
    assert_true(Parse("--output=o.ply in.obj", &values, &line));
    assert_int_equal(values.budget, 64);
    assert_false(values.ground);
    assert_false(pvtIsOptionGiven(&syntax, &line, "budget"));
    assert_true(pvtIsOptionGiven(&syntax, &line, "output"));
}

static void of_an_option_given_twice_the_last_holds(void** state)
{
    (void)state;
    Values values;
    pvtParsedLine line;
    assert_true(Parse("a -o b --budget 5 --budget=7", &values, &line));
    assert_int_equal(values.budget, 7);
}

static void behind_two_dashes_all_are_operands(void** state)
{
    (void)state;
    Values values;
    pvtParsedLine line;
    assert_true(Parse("-o b -- --budget", &values, &line));
    assert_string_equal(line.operands[0], "--budget");
}

static void wrong_lines_say_what_is_wrong_and_what_would_be_right(void** state)
{
    (void)state;
    static const struct {
        const char *line, *has, *hasToo;
    } cases[] = {
        {"a -o b --budgte 5", "--budgte", "did you mean --budget?"},
        {"a -o b --bud 5", "--bud", "did you mean --budget?"},
        {"a -o b -budget 5", "-budget", "did you mean --budget?"},
        {"a -o b --zzz", "unknown option --zzz", "paravent try --help"},
        {"a -o b -x", "unknown option -x", "--help"},
        {"a -o b --budget", "--budget needs a value", "1 to 65535"},
        {"a -o b --budget=", "--budget needs a value", "1 to 65535"},
        {"a -o --ground", "--output needs a value", "FILE"},
        {"a -o b --budget 0", "--budget 0", "1 to 65535"},
        {"a -o b --budget -5", "--budget -5", "1 to 65535"},
        {"a -o b --budget 65536", "--budget 65536", "1 to 65535"},
        {"a -o b --budget 1.5", "--budget 1.5", "whole number"},
        {"a -o b --budget 5x", "--budget 5x", "whole number"},
        {"a -o b --seed -1", "--seed -1", "whole number"},
        {"a -o b --seed 9007199254740992", "--seed", "whole number"},
        {"a -o b --error 0", "--error 0", "above 0"},
        {"a -o b --error nan", "--error nan", "a number"},
        {"a -o b --error inf", "--error inf", "a number"},
        {"a -o b --error 0x10", "--error 0x10", "a number"},
        {"a -o b --error 1e999", "--error 1e999", "a number"},
        {"a -o b --hole 3px", "--hole 3px", "suffix vx"},
        {"a -o b --hole -1", "--hole -1", "0 or more"},
        {"a -o b --limit 5X", "--limit 5X", "512M"},
        {"a -o b --method papre", "did you mean paper?", "planar or paper"},
        {"a -o b --method best", "--method best", "planar or paper"},
        {"a -o b --ground=yes", "--ground takes no value", "'=yes'"},
        {"a b -o c", "'b' is one argument too many", "usage: paravent try INPUT -o FILE"},
        {"-o c", "the input file is missing", "usage: paravent try"},
        {"a", "-o FILE is missing", "usage: paravent try"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        Values values;
        pvtParsedLine line;
        if (Parse(cases[i].line, &values, &line)) {
            fail_msg("accepted: %s", cases[i].line);
        }
        if (strstr(line.message, cases[i].has) == NULL ||
            strstr(line.message, cases[i].hasToo) == NULL) {
            fail_msg("%s: %s", cases[i].line, line.message);
        }
    }
}

static void sizes_know_binary_and_decimal_units(void** state)
{
    (void)state;
    static const struct {
        const char* text;
        double bytes;
    } cases[] = {
        {"1000000", 1e6},
        {"1B", 1.0},
        {"2K", 2048.0},
        {"2k", 2048.0},
        {"1MiB", 1048576.0},
        {"3MB", 3e6},
        {"1.5G", 1.5 * 1073741824.0},
        {"1GB", 1e9},
        {"2T", 2.0 * 1099511627776.0},
        {"1e3K", 1024000.0},
    };
    const pvtOption option = {.name = "limit", .kind = PVT_OPTION_SIZE};
    char message[256];
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        uint64_t bytes = 0;
        assert_true(pvtReadValue(&option, cases[i].text, &bytes, message, sizeof message));
        assert_true((double)bytes == cases[i].bytes);
    }
}

static void printed_numbers_read_back_as_the_same_double(void** state)
{
    (void)state;
    static const double numbers[] = {0.0,
                                     -0.0,
                                     0.1,
                                     1.0 / 3.0,
                                     1e300,
                                     5e-324,
                                     -2.5,
                                     64.0,
                                     1e22,
                                     123456789.0,
                                     0.3,
                                     2.2250738585072014e-308,
                                     1.7976931348623157e308};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; ++i) {
        char text[32];
        pvtPrintNumber(numbers[i], text);
        double back = 1.0;
        assert_true(pvtReadNumber(text, &back));
        assert_true(memcmp(&back, &numbers[i], sizeof back) == 0);
    }
    char text[32];
    pvtPrintNumber(0.1, text);
    assert_string_equal(text, "0.1");
}

// Makes one blank of each run of blanks and line feeds.
static void JoinLines(char* text)
{
    char* to = text;
    for (const char* from = text; *from != '\0'; ++from) {
        const char letter = *from == '\n' ? ' ' : *from;
        if (letter != ' ' || to == text || to[-1] != ' ') {
            *to++ = letter;
        }
    }
    *to = '\0';
}

static void help_tells_each_option_with_its_range_and_default(void** state)
{
    (void)state;
    char text[8192] = {0};
    FILE* file = fmemopen(text, sizeof text - 1, "w");
    assert_non_null(file);
    const Values defaults = {.budget = 64, .seed = 1, .hole = {2.0, true}};
    pvtPrintHelp(file, &syntax, &defaults);
    fclose(file);
    for (const char* line = text; *line != '\0'; line += strcspn(line, "\n") + 1) {
        assert_in_range(strcspn(line, "\n"), 0, 80);
    }
    JoinLines(text);
    for (size_t i = 0; i < sizeof table / sizeof *table; ++i) {
        char name[64];
        (void)snprintf(name, sizeof name, " --%s ", table[i].name);
        assert_non_null(strstr(text, name));
    }
    assert_non_null(strstr(text, "1 to 65535; default 64"));
    assert_non_null(strstr(text, "default 2vx"));
    assert_non_null(strstr(text, "--method planar|paper"));
    assert_non_null(strstr(text, "default planar"));
    assert_non_null(strstr(text, "-o, --output FILE"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_value_is_read),
        cmocka_unit_test(options_not_given_keep_their_defaults),
        cmocka_unit_test(of_an_option_given_twice_the_last_holds),
        cmocka_unit_test(behind_two_dashes_all_are_operands),
        cmocka_unit_test(wrong_lines_say_what_is_wrong_and_what_would_be_right),
        cmocka_unit_test(sizes_know_binary_and_decimal_units),
        cmocka_unit_test(printed_numbers_read_back_as_the_same_double),
        cmocka_unit_test(help_tells_each_option_with_its_range_and_default),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
