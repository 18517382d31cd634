// SPDX-License-Identifier: MIT
// A program that asks for a model which is not there: the reader must say so.
#include <paravent/io.h>
#include <stdio.h>

int main(void)
{
    pvtContext* context = NULL;
    if (pvtCreateContext(NULL, &context) != PVT_OK) {
        return 1;
    }
    pvtModel model;
    const pvtStatus glb = pvtLoadModel(context, NULL, "nothing-here.glb", &model);
    printf("%s\n", pvtContext_GetMessage(context));
    const pvtStatus obj = pvtLoadModel(context, NULL, "nothing-here.obj", &model);
    printf("%s\n", pvtContext_GetMessage(context));
    pvtDestroyContext(context);
    return glb == PVT_INVALID_INPUT && obj == PVT_INVALID_INPUT ? 0 : 1;
}
