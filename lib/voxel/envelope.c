// SPDX-License-Identifier: MIT
// One line of an exact Euclidean distance transform.
//
// Meijster, Roerdink and Hesselink, "A general algorithm for computing distance transforms in
// linear time", 2000, second phase: the lower envelope of parabolas, in integers. The division
// that finds where two parabolas cross is a multiplication here. Rounding could only change its
// floor where they cross at a whole number, and there both have the same value.
#include "envelope.h"

#include <assert.h>

size_t pvtEnvelope_GetBytes(int length)
{
    return ((size_t)length + 1) * (sizeof(double) + sizeof(uint32_t) + 2 * sizeof(int)) + 64;
}

pvtEnvelope pvtMakeEnvelope(void* memory, int length)
{
    const size_t count = (size_t)length + 1;
    pvtEnvelope envelope = {.reciprocals = memory};
    envelope.values = (uint32_t*)(envelope.reciprocals + count);
    envelope.apexes = (int*)(envelope.values + count);
    envelope.starts = envelope.apexes + count;
    for (int i = 1; i <= length; ++i) {
        envelope.reciprocals[i] = 0.5 / i;
    }
    return envelope;
}

// The last x at which the parabola at `left` is not above the one at `right`; not below 0.
static int FindCrossing(const pvtEnvelope* envelope, int top, int right, uint32_t value)
{
    const int left = envelope->apexes[top];
    const int64_t apart = right - left;
    const int64_t difference =
        (int64_t)value - (int64_t)envelope->values[top] + apart * (right + left);
    return (int)((double)difference * envelope->reciprocals[apart]);
}

static uint32_t Evaluate(uint32_t value, int distance)
{
    return value + (uint32_t)(distance * distance);
}

// Puts the lower envelope on the stack; returns the number of its parabolas.
static int BuildStack(pvtEnvelope* envelope, const uint32_t* line, int length)
{
    int count = 0;
    for (int u = 0; u < length; ++u) {
        const uint32_t value = line[u];
        if (value == PVT_FAR) {
            continue;
        }
        while (count > 0) {
            const int start = envelope->starts[count - 1];
            const int apex = envelope->apexes[count - 1];
            if (Evaluate(envelope->values[count - 1], start - apex) <= Evaluate(value, start - u)) {
                break;
            }
            --count;
        }
        const int start = count == 0 ? 0 : FindCrossing(envelope, count - 1, u, value) + 1;
        if (start < length) {
            envelope->values[count] = value;
            envelope->apexes[count] = u;
            envelope->starts[count++] = start;
        }
    }
    return count;
}

void pvtEnvelope_Apply(pvtEnvelope* envelope, uint32_t* line, int length, uint32_t limit)
{
    assert(limit <= UINT32_C(1) << 30);
    const int count = BuildStack(envelope, line, length);
    if (count == 0) {
        return;
    }
    envelope->starts[count] = length;
    for (int i = 0; i < count; ++i) {
        const uint32_t value = envelope->values[i];
        const int apex = envelope->apexes[i];
        const int end = envelope->starts[i + 1];
        for (int x = envelope->starts[i]; x < end; ++x) {
            const uint32_t here = Evaluate(value, x - apex);
            line[x] = here <= limit ? here : PVT_FAR;
        }
    }
}
