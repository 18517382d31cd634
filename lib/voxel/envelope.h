// SPDX-License-Identifier: MIT
// One line of an exact Euclidean distance transform.
#ifndef PVT_VOXEL_ENVELOPE_H
#define PVT_VOXEL_ENVELOPE_H

#include <paravent/base.h>

/// Marks a value that no marked voxel is near enough to give.
#define PVT_FAR UINT32_MAX

/// Room for lines of up to a given length.
typedef struct pvtEnvelope {
    double* reciprocals; ///< 1 / (2 i)
    uint32_t* values;    ///< of the parabolas on the stack
    int* apexes;
    int* starts; ///< where each parabola becomes the lowest
} pvtEnvelope;

size_t pvtEnvelope_GetBytes(int length);
/// In pvtEnvelope_GetBytes(length) bytes at `memory`, aligned to 8.
pvtEnvelope pvtMakeEnvelope(void* memory, int length);

/// line[x] = min over u of line[u] + (x − u)², or PVT_FAR when that is above `limit`. Values are
/// PVT_FAR or at most `limit`; limit ≤ 2³⁰.
void pvtEnvelope_Apply(pvtEnvelope* envelope, uint32_t* line, int length, uint32_t limit);

#endif
