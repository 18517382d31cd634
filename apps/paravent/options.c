// SPDX-License-Identifier: MIT
#include "options.h"

#include "values.h"

#include <assert.h>
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// Where the parser stands.
typedef struct Parser {
    const pvtSyntax* syntax;
    int count;
    char* const* words;
    int next; // the word to read
    char* values;
    pvtParsedLine* line;
} Parser;

static bool Refuse(Parser* parser, const char* format, ...) __attribute__((format(printf, 2, 3)));

static bool Refuse(Parser* parser, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(parser->line->message, sizeof parser->line->message, format, arguments);
    va_end(arguments);
    return false;
}

// Calls for option i of all groups in order; null behind the last.
static const pvtOption* GetOption(const pvtSyntax* syntax, size_t i)
{
    for (size_t group = 0; group < syntax->groupCount; ++group) {
        if (i < syntax->groups[group].count) {
            return &syntax->groups[group].options[i];
        }
        i -= syntax->groups[group].count;
    }
    return NULL;
}

// By name, or by letter when the name is null; −1 when there is none.
static int FindOption(const pvtSyntax* syntax, const char* name, size_t length, char letter)
{
    const pvtOption* option = NULL;
    for (int i = 0; (option = GetOption(syntax, (size_t)i)) != NULL; ++i) {
        assert(i < PVT_MAX_OPTIONS);
        const bool same =
            name != NULL ? strncmp(option->name, name, length) == 0 && option->name[length] == '\0'
                         : option->letter == letter;
        if (same) {
            return i;
        }
    }
    return -1;
}

static size_t MinimumOf(size_t a, size_t b)
{
    return a < b ? a : b;
}

// Levenshtein's distance; words longer than 31 letters count as far away.
static size_t GetEditDistance(const char* a, const char* b)
{
    const size_t lengthA = strlen(a);
    const size_t lengthB = strlen(b);
    size_t row[32];
    if (lengthA > 31 || lengthB > 31) {
        return 32;
    }
    for (size_t j = 0; j <= lengthB; ++j) {
        row[j] = j;
    }
    for (size_t i = 1; i <= lengthA; ++i) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= lengthB; ++j) {
            const size_t replaced = diagonal + (a[i - 1] != b[j - 1] ? 1 : 0);
            diagonal = row[j];
            row[j] = MinimumOf(replaced, MinimumOf(row[j], row[j - 1]) + 1);
        }
    }
    return row[lengthB];
}

const char* pvtFindSimilarWord(const char* word, const char* const* candidates)
{
    const char* best = NULL;
    size_t bestDistance = 3;
    const size_t length = strlen(word);
    for (size_t i = 0; candidates[i] != NULL; ++i) {
        const bool isPrefix = length >= 3 && strncmp(candidates[i], word, length) == 0;
        const size_t distance = isPrefix ? 1 : GetEditDistance(word, candidates[i]);
        // A short word has few letters to get wrong before it is another one.
        if (distance < bestDistance && distance * 2 < length) {
            bestDistance = distance;
            best = candidates[i];
        }
    }
    return best;
}

static bool RefuseUnknown(Parser* parser, const char* word, size_t length)
{
    const char* names[PVT_MAX_OPTIONS + 2];
    int count = 0;
    const pvtOption* option = NULL;
    while ((option = GetOption(parser->syntax, (size_t)count)) != NULL) {
        names[count++] = option->name;
    }
    names[count++] = "help";
    names[count] = NULL;
    char name[64];
    const size_t dashes = strspn(word, "-");
    (void)snprintf(name, sizeof name, "%.*s", (int)(length - dashes), word + dashes);
    const char* similar = pvtFindSimilarWord(name, names);
    if (similar != NULL) {
        return Refuse(parser, "unknown option %.*s; did you mean --%s?", (int)length, word,
                      similar);
    }
    return Refuse(parser, "unknown option %.*s; '%s %s --help' lists them", (int)length, word,
                  pvtSyntax_GetProgram(parser->syntax), parser->syntax->name);
}

// Whether the word may be taken for a value: not when it looks like the next option.
static bool CanBeValue(const char* word)
{
    return word[0] != '-' || word[1] == '\0' || word[1] == '.' ||
           isdigit((unsigned char)word[1]) != 0;
}

static bool ReadOption(Parser* parser, int index, const char* attached)
{
    const pvtOption* option = GetOption(parser->syntax, (size_t)index);
    parser->line->given |= UINT64_C(1) << index;
    if (option->kind == PVT_OPTION_FLAG) {
        if (attached != NULL) {
            return Refuse(parser, "--%s takes no value; write it without '=%s'", option->name,
                          attached);
        }
        *(bool*)(parser->values + option->offset) = true;
        return true;
    }
    const char* text = attached;
    if (text == NULL && parser->next < parser->count && CanBeValue(parser->words[parser->next])) {
        text = parser->words[parser->next++];
    }
    if (text == NULL || text[0] == '\0') {
        char wanted[256];
        pvtDescribeValue(option, wanted, sizeof wanted);
        return Refuse(parser, "--%s needs a value: %s", option->name, wanted);
    }
    return pvtReadValue(option, text, parser->values + option->offset, parser->line->message,
                        sizeof parser->line->message);
}

static bool ReadDashedWord(Parser* parser, const char* word)
{
    const char* equals = strchr(word, '=');
    const size_t length = equals != NULL ? (size_t)(equals - word) : strlen(word);
    int index = -1;
    if (word[1] == '-') {
        index = FindOption(parser->syntax, word + 2, length - 2, 0);
    } else if (length == 2 && equals == NULL) {
        index = FindOption(parser->syntax, NULL, 0, word[1]);
    }
    if (index < 0) {
        return RefuseUnknown(parser, word, length);
    }
    return ReadOption(parser, index, equals != NULL ? equals + 1 : NULL);
}

static bool AddOperand(Parser* parser, const char* word)
{
    const pvtSyntax* syntax = parser->syntax;
    if (parser->line->operandCount == syntax->mostOperands) {
        return Refuse(parser,
                      "'%s' is one argument too many: there can be %d; usage: %s %s %s [options]",
                      word, syntax->mostOperands, pvtSyntax_GetProgram(syntax), syntax->name,
                      syntax->operands);
    }
    parser->line->operands[parser->line->operandCount++] = word;
    return true;
}

static bool CheckComplete(Parser* parser)
{
    const pvtSyntax* syntax = parser->syntax;
    if (parser->line->operandCount < syntax->leastOperands) {
        return Refuse(parser, "%s is missing; usage: %s %s %s [options]",
                      parser->line->operandCount == 0 ? "the input file" : "a file",
                      pvtSyntax_GetProgram(syntax), syntax->name, syntax->operands);
    }
    const pvtOption* option = NULL;
    for (size_t i = 0; (option = GetOption(syntax, i)) != NULL; ++i) {
        if (option->isRequired && (parser->line->given >> i & 1) == 0) {
            const char letter[] = {option->letter, '\0'};
            const bool hasLetter = option->letter != 0;
            return Refuse(parser, "-%s%s %s is missing; usage: %s %s %s [options]",
                          hasLetter ? "" : "-", hasLetter ? letter : option->name,
                          option->placeholder, pvtSyntax_GetProgram(syntax), syntax->name,
                          syntax->operands);
        }
    }
    return true;
}

const char* pvtSyntax_GetProgram(const pvtSyntax* syntax)
{
    return syntax->program != NULL ? syntax->program : "paravent";
}

bool pvtParseLine(const pvtSyntax* syntax, int count, char* const* words, void* values,
                  pvtParsedLine* line)
{
    Parser parser = {syntax, count, words, 0, values, line};
    line->operandCount = 0;
    line->given = 0;
    line->message[0] = '\0';
    bool onlyOperands = false;
    while (parser.next < count) {
        const char* word = words[parser.next++];
        if (!onlyOperands && strcmp(word, "--") == 0) {
            onlyOperands = true;
            continue;
        }
        const bool isOption = !onlyOperands && word[0] == '-' && word[1] != '\0';
        if (!(isOption ? ReadDashedWord(&parser, word) : AddOperand(&parser, word))) {
            return false;
        }
    }
    return CheckComplete(&parser);
}

bool pvtIsOptionGiven(const pvtSyntax* syntax, const pvtParsedLine* line, const char* name)
{
    const int index = FindOption(syntax, name, strlen(name), 0);
    assert(index >= 0);
    return (line->given >> index & 1) != 0;
}
