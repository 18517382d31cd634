// SPDX-License-Identifier: MIT
// Polygons into bit masks by the edge-fill rule (Ackland and Weste, The Edge Flag Algorithm, 1981):
// each edge turns over everything to its right, so that what is left set is inside. A row of 64
// pixels costs one exclusive-or an edge, and an edge can be taken out again the way it went in.
#include "mask.h"

#include "base/vector.h"

#include <math.h>

pvtMaskFrame pvtMakeMaskFrame(const pvtView* view, const pvtBox3* bounds, int size)
{
    const pvtVec3 center = pvtScale(pvtAdd(bounds->lower, bounds->upper), 0.5);
    const pvtVec3 half = pvtScale(pvtSub(bounds->upper, bounds->lower), 0.5);
    const double halfX =
        fabs(view->right.x) * half.x + fabs(view->right.y) * half.y + fabs(view->right.z) * half.z;
    const double halfY =
        fabs(view->up.x) * half.x + fabs(view->up.y) * half.y + fabs(view->up.z) * half.z;
    const double span = 2.0 * fmax(halfX, halfY);
    const double pixelSize = span > 0.0 ? span / (size - 1) : 1.0;
    pvtMaskFrame frame = {.right = pvtScale(view->right, 1.0 / pixelSize),
                          .up = pvtScale(view->up, 1.0 / pixelSize),
                          .pixelSize = pixelSize,
                          .weight = view->weight};
    frame.offsetX = 0.5 * size - pvtDot(center, frame.right);
    frame.offsetY = 0.5 * size - pvtDot(center, frame.up);
    return frame;
}

static int32_t ToFixed(double pixels)
{
    // Far outside is as good as 2^20 pixels away.
    const double limit = 0x1p20;
    const double clamped = pixels < -limit ? -limit : pixels > limit ? limit : pixels;
    return (int32_t)lrint(clamped * (1 << PVT_MASK_POINT_BITS));
}

pvtMaskPoint pvtProjectToMask(const pvtMaskFrame* frame, pvtVec3 point)
{
    return (pvtMaskPoint){ToFixed(pvtDot(point, frame->right) + frame->offsetX),
                          ToFixed(pvtDot(point, frame->up) + frame->offsetY)};
}

// The first row or column whose centre is at or past `value`.
static int FirstCenter(int64_t value)
{
    const int64_t half = 1 << (PVT_MASK_POINT_BITS - 1);
    return (int)((value + half - 1) >> PVT_MASK_POINT_BITS);
}

static void ToggleFrom(uint64_t* row, int words, int first)
{
    if (first <= 0) {
        for (int word = 0; word < words; ++word) {
            row[word] = ~row[word];
        }
        return;
    }
    int word = first >> 6;
    if (word >= words) {
        return;
    }
    row[word] ^= ~UINT64_C(0) << (first & 63);
    for (++word; word < words; ++word) {
        row[word] = ~row[word];
    }
}

void pvtToggleMaskEdge(uint64_t* rows, int size, pvtMaskPoint from, pvtMaskPoint to)
{
    const pvtMaskPoint low = from.y < to.y ? from : to;
    const pvtMaskPoint high = from.y < to.y ? to : from;
    int row = FirstCenter(low.y);
    int end = FirstCenter(high.y);
    row = row < 0 ? 0 : row;
    end = end > size ? size : end;
    if (row >= end) {
        return;
    }
    // Sixteen more bits for the crossing, so that 256 steps drift by less than 1/256 pixel.
    const double slope = (double)(high.x - low.x) / (double)(high.y - low.y);
    const int64_t step = (int64_t)(slope * 0x1p24);
    const int64_t center = ((int64_t)row << PVT_MASK_POINT_BITS) + (1 << (PVT_MASK_POINT_BITS - 1));
    int64_t x = (int64_t)low.x * 65536 + (int64_t)(slope * 0x1p16 * (double)(center - low.y));
    const int words = size >> 6;
    if (words == 1) {
        for (; row < end; ++row, x += step) {
            const int first = FirstCenter(x >> 16);
            const uint64_t all = ~UINT64_C(0);
            rows[row] ^= first <= 0 ? all : first < 64 ? all << first : 0;
        }
        return;
    }
    for (; row < end; ++row, x += step) {
        ToggleFrom(rows + (size_t)row * (size_t)words, words, FirstCenter(x >> 16));
    }
}

void pvtToggleMaskPolygon(uint64_t* rows, int size, const pvtMaskPoint* points, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        pvtToggleMaskEdge(rows, size, points[i], points[i + 1 < count ? i + 1 : 0]);
    }
}
