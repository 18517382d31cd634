// SPDX-License-Identifier: MIT
// Draco's encoder, for the tests of what reads its data.
#ifndef PVT_TEST_DRACO_ENCODER_H
#define PVT_TEST_DRACO_ENCODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The unique id of the positions in what EncodeDraco makes; 0 is an attribute of another kind.
enum { DRACO_POSITION_ID = 1 };

typedef struct DracoSource {
    const float* positions; ///< three a point
    size_t pointCount;
    const uint32_t* indices;
    size_t triangleCount;
    bool isSequential; ///< keeps the order of points and triangles; else edges are broken
    int bits;          ///< of a quantised coordinate; 0: nothing is lost
    bool isCloud;      ///< a point cloud instead of a mesh
} DracoSource;

/// Returns how many bytes of `out` it took, and how many points the data holds, which splits those
/// that are not manifold. 0 when it failed.
size_t EncodeDraco(const DracoSource* source, uint8_t* out, size_t room, size_t* pointCount);

#ifdef __cplusplus
}
#endif
#endif
