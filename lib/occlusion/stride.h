// SPDX-License-Identifier: MIT
// An order of views in which any few that follow each other look from all sides.
#ifndef PVT_OCCLUSION_STRIDE_H
#define PVT_OCCLUSION_STRIDE_H

#include <stddef.h>

/// Sets of views come in order of their elevation. In steps of this many, which is prime to their
/// number and near the golden section of it, the next few are spread over all of them.
static inline size_t pvtGetViewStride(size_t count)
{
    size_t stride = count * 5 / 8 + 1;
    for (;; ++stride) {
        size_t a = count;
        size_t b = stride;
        while (b != 0) {
            const size_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1) {
            return stride;
        }
    }
}

#endif
