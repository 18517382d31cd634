// SPDX-License-Identifier: MIT
// A program that asks for a model which is not there, in C++.
#include <iostream>
#include <paravent/io.h>

int main()
{
    pvtContext* context = nullptr;
    if (pvtCreateContext(nullptr, &context) != PVT_OK) {
        return 1;
    }
    pvtModel model;
    const pvtStatus status = pvtLoadModel(context, nullptr, "nothing-here.glb", &model);
    std::cout << pvtContext_GetMessage(context) << "\n";
    pvtDestroyContext(context);
    return status == PVT_INVALID_INPUT ? 0 : 1;
}
