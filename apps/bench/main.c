// SPDX-License-Identifier: MIT
#include "bench.h"

#include <stdio.h>
#include <string.h>

int main(int argc, char** argv)
{
    if (argc >= 2 && strcmp(argv[1], pvtQualityCommand.syntax->name) == 0) {
        return pvtQualityCommand.run(argc - 2, argv + 2);
    }
    fputs("usage: paravent-bench quality MODEL... [options]\n"
          "       paravent-bench quality --help\n",
          stderr);
    return PVT_EXIT_USAGE;
}
