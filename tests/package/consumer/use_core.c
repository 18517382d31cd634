// SPDX-License-Identifier: MIT
// The smallest program that uses the core.
#include <paravent/paravent.h>
#include <stdio.h>

int main(void)
{
    pvtContext* context = NULL;
    if (pvtCreateContext(NULL, &context) != PVT_OK) {
        return 1;
    }
    pvtImage image;
    const pvtStatus status = pvtCreateImage(context, 4, 3, &image);
    printf("paravent %s, %d × %d: %s\n", pvtGetVersion(), image.width, image.height,
           pvtGetStatusName(status));
    pvtImage_Free(context, &image);
    const bool leaked = pvtContext_GetHeldBytes(context) != 0;
    pvtDestroyContext(context);
    return status == PVT_OK && !leaked ? 0 : 1;
}
