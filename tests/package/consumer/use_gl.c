// SPDX-License-Identifier: MIT
// A program that uses the graphics part. A machine without graphics is told so, and is fine.
#include <paravent/gl.h>
#include <stdio.h>

int main(void)
{
    pvtContext* context = NULL;
    if (pvtCreateContext(NULL, &context) != PVT_OK) {
        return 1;
    }
    pvtGl* gl = NULL;
    const pvtStatus status = pvtOpenGl(context, PVT_GL_AUTO, &gl);
    printf("%s\n", status == PVT_OK ? pvtGl_GetName(gl) : pvtContext_GetMessage(context));
    pvtCloseGl(context, gl);
    pvtDestroyContext(context);
    return status == PVT_OK || status == PVT_UNSUPPORTED ? 0 : 1;
}
