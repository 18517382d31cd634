// SPDX-License-Identifier: MIT
#include "bench.h"

#include <stdio.h>
#include <string.h>

static const pvtCommand* const commands[] = {&pvtQualityCommand, &pvtSpeedCommand};

enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

int main(int argc, char** argv)
{
    for (int i = 0; argc >= 2 && i < COMMAND_COUNT; ++i) {
        if (strcmp(argv[1], commands[i]->syntax->name) == 0) {
            return commands[i]->run(argc - 2, argv + 2);
        }
    }
    fputs("usage: paravent-bench quality MODEL... [options]\n"
          "       paravent-bench speed [MODEL...] [options]\n"
          "       paravent-bench COMMAND --help\n",
          stderr);
    return PVT_EXIT_USAGE;
}
