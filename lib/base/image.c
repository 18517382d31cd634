// SPDX-License-Identifier: MIT
#include "context.h"

#include <paravent/image.h>

enum { MAX_SIDE = 32768 };

pvtStatus pvtCreateImage(pvtContext* context, int width, int height, pvtImage* image)
{
    *image = (pvtImage){0};
    if (width < 1 || height < 1 || width > MAX_SIDE || height > MAX_SIDE) {
        return pvtFail(context, PVT_INVALID_ARGUMENT,
                       "an image of %d × %d pixels; each side must be 1 to %d", width, height,
                       MAX_SIDE);
    }
    uint8_t* pixels = pvtAllocate(context, (size_t)width * (size_t)height, 4);
    if (pixels == NULL) {
        return pvtContext_GetStatus(context);
    }
    *image = (pvtImage){pixels, width, height};
    return PVT_OK;
}

void pvtImage_Free(pvtContext* context, pvtImage* image)
{
    pvtRelease(context, image->pixels);
    *image = (pvtImage){0};
}
