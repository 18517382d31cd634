// SPDX-License-Identifier: MIT
// The smallest program that uses the core, in C++.
#include <iostream>
#include <paravent/paravent.h>

int main()
{
    pvtContext* context = nullptr;
    if (pvtCreateContext(nullptr, &context) != PVT_OK) {
        return 1;
    }
    pvtImage image;
    const pvtStatus status = pvtCreateImage(context, 4, 3, &image);
    std::cout << "paravent " << pvtGetVersion() << ": " << pvtGetStatusName(status) << "\n";
    pvtImage_Free(context, &image);
    const bool leaked = pvtContext_GetHeldBytes(context) != 0;
    pvtDestroyContext(context);
    return status == PVT_OK && !leaked ? 0 : 1;
}
