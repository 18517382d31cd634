// SPDX-License-Identifier: MIT
// paravent COMMAND INPUT [options]
#include "command.h"
#include "run.h"

#include <stdio.h>
#include <string.h>

static const pvtCommand* const commands[] = {
    &pvtGenerateCommand,
    &pvtEvaluateCommand,
    &pvtLadderCommand,
};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void PrintOverview(FILE* file)
{
    fputs("paravent - a few flat polygons that hide what a mesh hides\n\n"
          "Usage: paravent COMMAND INPUT [options]\n"
          "       paravent COMMAND --help\n"
          "       paravent --version\n\n"
          "Commands:\n",
          file);
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        fprintf(file, "  %-10s %s\n", commands[i]->syntax->name, commands[i]->syntax->summary);
    }
    fputs(
        "\nExit codes: 0 done, 1 wrong command line, 2 invalid input, 3 feature missing here,\n"
        "4 output cannot be written, 5 nothing to occlude with, 6 limit reached, 130 cancelled.\n",
        file);
}

static int FinishStdout(void)
{
    if (fflush(stdout) != 0) {
        fputs("paravent: the standard output cannot be written\n", stderr);
        return PVT_EXIT_OUTPUT;
    }
    return PVT_EXIT_DONE;
}

static int RefuseCommand(const char* word)
{
    const char* names[COMMAND_COUNT + 3];
    int count = 0;
    for (; count < COMMAND_COUNT; ++count) {
        names[count] = commands[count]->syntax->name;
    }
    names[count++] = "--version";
    names[count++] = "--help";
    names[count] = NULL;
    const char* similar = pvtFindSimilarWord(word, names);
    fprintf(stderr, "paravent: unknown %s '%s'", word[0] == '-' ? "option" : "command", word);
    if (similar != NULL) {
        fprintf(stderr, "; did you mean %s?\n", similar);
    } else {
        fputs("; 'paravent --help' lists the commands\n", stderr);
    }
    return PVT_EXIT_USAGE;
}

int main(int argc, char** argv)
{
    if (argc < 2) {
        PrintOverview(stderr);
        return PVT_EXIT_USAGE;
    }
    const bool wantsHelp = strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0;
    const bool wantsVersion = strcmp(argv[1], "--version") == 0;
    if ((wantsHelp || wantsVersion) && argc > 2) {
        fprintf(stderr, "paravent: '%s' is one argument too many behind %s\n", argv[2], argv[1]);
        return PVT_EXIT_USAGE;
    }
    if (wantsHelp) {
        PrintOverview(stdout);
        return FinishStdout();
    }
    if (wantsVersion) {
        printf("paravent %s\n", pvtGetVersion());
        return FinishStdout();
    }
    for (int i = 0; i < COMMAND_COUNT; ++i) {
        if (strcmp(argv[1], commands[i]->syntax->name) == 0) {
            return commands[i]->run(argc - 2, argv + 2);
        }
    }
    return RefuseCommand(argv[1]);
}
