// SPDX-License-Identifier: MIT
// A program that uses the graphics part, in C++.
#include <iostream>
#include <paravent/gl.h>

int main()
{
    pvtContext* context = nullptr;
    if (pvtCreateContext(nullptr, &context) != PVT_OK) {
        return 1;
    }
    pvtGl* gl = nullptr;
    const pvtStatus status = pvtOpenGl(context, PVT_GL_AUTO, &gl);
    std::cout << (status == PVT_OK ? pvtGl_GetName(gl) : pvtContext_GetMessage(context)) << "\n";
    pvtCloseGl(context, gl);
    pvtDestroyContext(context);
    return status == PVT_OK || status == PVT_UNSUPPORTED ? 0 : 1;
}
