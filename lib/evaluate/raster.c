// SPDX-License-Identifier: MIT
// Triangles to bits, after Juan Pineda, "A Parallel Algorithm for Polygon Rasterization" (SIGGRAPH
// 1988): a pixel is covered when its centre lies on the inner side of the three edge functions.
// Corners are rounded to 1/256 pixel first and all that follows is integer and exact, so that two
// triangles that share an edge cover each pixel along it once. The rule for a centre that lies on
// an edge is "top-left": it belongs to the triangle when the edge bounds it from the left, or is
// level and bounds it from above. Here nothing is shaded: what is covered already needs no work,
// which takes care of most triangles of a dense mesh; the others go pixel by pixel when they are
// small, and row by row, by exact stepping of the quotients along the edges, when they are not.
#include "raster.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

enum {
    SUBPIXEL_BITS = 8,
    SUBPIXELS = 1 << SUBPIXEL_BITS,
    HALF_PIXEL = SUBPIXELS / 2,
    // Corners farther out than 2²² pixels are drawn at that distance, axis by axis: products of
    // two differences stay below 2⁶³.
    FARTHEST = (1 << 30) - 1,
    SMALL_SIDE = 8,  // [px] of a box that is walked pixel by pixel
    BATCH = 1 << 16, // between two looks whether it is cancelled
};

static const double ALMOST_UPRIGHT = 0.999;

// Pixels x0 to x1, y0 to y1, both inclusive.
typedef struct PixelBox {
    int x0, y0, x1, y1;
} PixelBox;

// The edge function of a to b at a pixel's centre, ≥ 0 inside.
typedef struct Edge {
    int64_t value, stepX, stepY;
} Edge;

// floor(numerator / denominator) along the rows: `quotient` bounds the row's span.
typedef struct EdgeWalk {
    int64_t quotient, remainder, quotientStep, remainderStep, denominator;
} EdgeWalk;

pvtStatus pvtCheckDirection(pvtContext* context, size_t number, pvtVec3 direction)
{
    const double length = pvtLength3(direction);
    if (isfinite(length) && length > 0.0) {
        return PVT_OK;
    }
    return pvtFail(context, PVT_INVALID_ARGUMENT,
                   "direction %zu has no length, or one that is not finite", number);
}

pvtScreen pvtMakeScreen(pvtVec3 direction)
{
    const pvtVec3 along = pvtNormalize(direction);
    const bool upright = fabs(along.y) > ALMOST_UPRIGHT;
    const pvtVec3 reference = {0.0, upright ? 0.0 : 1.0, upright ? 1.0 : 0.0};
    const pvtVec3 right = pvtNormalize(pvtCross(along, reference));
    return (pvtScreen){.direction = along, .right = right, .up = pvtCross(right, along)};
}

bool pvtProjectBounds(pvtContext* context, const pvtScreen* screen, const pvtSoup* soup,
                      pvtScreenBox* box)
{
    double x0 = INFINITY, y0 = INFINITY, x1 = -INFINITY, y1 = -INFINITY;
    for (size_t i = 0; i < soup->positionCount; ++i) {
        if (i % BATCH == 0 && pvtIsCancelled(context)) {
            return false;
        }
        const double x = pvtDot(screen->right, soup->positions[i]);
        const double y = pvtDot(screen->up, soup->positions[i]);
        x0 = x < x0 ? x : x0;
        y0 = y < y0 ? y : y0;
        x1 = x > x1 ? x : x1;
        y1 = y > y1 ? y : y1;
    }
    *box = (pvtScreenBox){{x0, y0}, {x1, y1}};
    return true;
}

pvtStatus pvtRaster_Resize(pvtContext* context, pvtRaster* raster, int width, int height)
{
    const size_t wordsPerRow = pvtGetWordCount((size_t)width);
    const size_t words = wordsPerRow * (size_t)height;
    if (words > raster->capacity) {
        pvtRaster_Free(context, raster);
        raster->words = pvtAllocate(context, words, sizeof *raster->words);
        if (raster->words == NULL) {
            return pvtContext_GetStatus(context);
        }
        raster->capacity = words;
    } else {
        memset(raster->words, 0, words * sizeof *raster->words);
    }
    raster->width = width;
    raster->height = height;
    raster->wordsPerRow = wordsPerRow;
    return PVT_OK;
}

void pvtRaster_Free(pvtContext* context, pvtRaster* raster)
{
    pvtRelease(context, raster->words);
    *raster = (pvtRaster){0};
}

// Rounds to the nearest subpixel. The number is positive before it is cut, so that cutting it is
// rounding down.
static inline int32_t SnapCoordinate(double pixels)
{
    const double value = pixels * SUBPIXELS + 0.5;
    const double above = value < -FARTHEST ? -FARTHEST : value;
    const double within = above > FARTHEST ? FARTHEST : above;
    return (int32_t)(within + (FARTHEST + 1.0)) - FARTHEST - 1;
}

static bool SnapPoints(pvtContext* context, const pvtScreen* screen, const pvtSoup* soup,
                       pvtScreenPoint* points)
{
    const double scale = 1.0 / screen->pixelSize;
    for (size_t i = 0; i < soup->positionCount; ++i) {
        if (i % BATCH == 0 && pvtIsCancelled(context)) {
            return false;
        }
        const double x = pvtDot(screen->right, soup->positions[i]) - screen->lower[0];
        const double y = pvtDot(screen->up, soup->positions[i]) - screen->lower[1];
        points[i] = (pvtScreenPoint){SnapCoordinate(x * scale), SnapCoordinate(y * scale)};
    }
    return true;
}

static inline int32_t Least(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static inline int32_t Most(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

// The pixels whose centres lie in the triangle's box; false when there are none.
static inline bool FindPixels(const pvtRaster* raster, const pvtScreenPoint p[3], PixelBox* box)
{
    const int32_t left = Least(Least(p[0].x, p[1].x), p[2].x);
    const int32_t right = Most(Most(p[0].x, p[1].x), p[2].x);
    const int32_t bottom = Least(Least(p[0].y, p[1].y), p[2].y);
    const int32_t top = Most(Most(p[0].y, p[1].y), p[2].y);
    box->x0 = Most((left + HALF_PIXEL - 1) >> SUBPIXEL_BITS, 0);
    box->y0 = Most((bottom + HALF_PIXEL - 1) >> SUBPIXEL_BITS, 0);
    box->x1 = Least((right - HALF_PIXEL) >> SUBPIXEL_BITS, raster->width - 1);
    box->y1 = Least((top - HALF_PIXEL) >> SUBPIXEL_BITS, raster->height - 1);
    return box->x0 <= box->x1 && box->y0 <= box->y1;
}

static inline bool IsCovered(const pvtRaster* raster, const PixelBox* box)
{
    const uint64_t* row = raster->words + (size_t)box->y0 * raster->wordsPerRow;
    for (int y = box->y0; y <= box->y1; ++y, row += raster->wordsPerRow) {
        if (!pvtIsBitRangeSet(row, (size_t)box->x0, (size_t)box->x1 + 1)) {
            return false;
        }
    }
    return true;
}

// The triangle lies on the left of its edges. A centre on an edge counts when the edge runs down
// (it is a left edge), or to the left (it is a top edge): the others are moved in by the smallest
// amount, 1.
static inline int64_t GetBias(int64_t dx, int64_t dy)
{
    return dy < 0 || (dy == 0 && dx < 0) ? 0 : -1;
}

static inline Edge MakeEdge(pvtScreenPoint a, pvtScreenPoint b, int x, int y)
{
    const int64_t dx = (int64_t)b.x - a.x, dy = (int64_t)b.y - a.y;
    const int64_t px = (int64_t)x * SUBPIXELS + HALF_PIXEL - a.x;
    const int64_t py = (int64_t)y * SUBPIXELS + HALF_PIXEL - a.y;
    return (Edge){dx * py - dy * px + GetBias(dx, dy), -dy * SUBPIXELS, dx * SUBPIXELS};
}

// For boxes of at most 64 pixels' width.
static void FillPixels(const pvtRaster* raster, const pvtScreenPoint p[3], const PixelBox* box)
{
    Edge e0 = MakeEdge(p[0], p[1], box->x0, box->y0);
    Edge e1 = MakeEdge(p[1], p[2], box->x0, box->y0);
    Edge e2 = MakeEdge(p[2], p[0], box->x0, box->y0);
    const unsigned shift = (unsigned)box->x0 & 63;
    uint64_t* row = raster->words + (size_t)box->y0 * raster->wordsPerRow + (box->x0 >> 6);
    for (int y = box->y0; y <= box->y1; ++y, row += raster->wordsPerRow) {
        int64_t v0 = e0.value, v1 = e1.value, v2 = e2.value;
        uint64_t mask = 0;
        for (int x = 0; x <= box->x1 - box->x0; ++x) {
            mask |= (uint64_t)((v0 | v1 | v2) >= 0) << x;
            v0 += e0.stepX;
            v1 += e1.stepX;
            v2 += e2.stepX;
        }
        row[0] |= mask << shift;
        if (shift > 0 && mask >> (64 - shift) != 0) {
            row[1] |= mask >> (64 - shift);
        }
        e0.value += e0.stepY;
        e1.value += e1.stepY;
        e2.value += e2.stepY;
    }
}

// For an edge that runs up (dy > 0) the quotient is the last pixel of row y inside it; for one that
// runs down the first.
static EdgeWalk StartWalk(pvtScreenPoint a, pvtScreenPoint b, int y)
{
    const int64_t dx = (int64_t)b.x - a.x, dy = (int64_t)b.y - a.y;
    const int64_t py = (int64_t)y * SUBPIXELS + HALF_PIXEL - a.y;
    const int64_t rise = dy > 0 ? dy : -dy;
    const int64_t inside = dx * py + GetBias(dx, dy);
    const int64_t start = ((int64_t)a.x - HALF_PIXEL) * rise;
    EdgeWalk walk = {.denominator = rise * SUBPIXELS};
    const int64_t numerator = dy > 0 ? start + inside : start - inside + walk.denominator - 1;
    const int64_t step = (dy > 0 ? dx : -dx) * SUBPIXELS;
    walk.quotient = pvtDivideDown(numerator, walk.denominator);
    walk.remainder = numerator - walk.quotient * walk.denominator;
    walk.quotientStep = pvtDivideDown(step, walk.denominator);
    walk.remainderStep = step - walk.quotientStep * walk.denominator;
    return walk;
}

static inline void NextRow(EdgeWalk* walk)
{
    walk->quotient += walk->quotientStep;
    walk->remainder += walk->remainderStep;
    if (walk->remainder >= walk->denominator) {
        walk->remainder -= walk->denominator;
        ++walk->quotient;
    }
}

// A level edge bounds rows, not spans. The box ends rightly at one above the triangle, whose
// centres count; those on one below the triangle do not.
static void SkipLowerEdge(pvtScreenPoint a, pvtScreenPoint b, PixelBox* box)
{
    if (a.y == b.y && b.x > a.x) {
        box->y0 = Most(box->y0, ((a.y - HALF_PIXEL) >> SUBPIXEL_BITS) + 1);
    }
}

static void FillRows(const pvtRaster* raster, const pvtScreenPoint p[3], PixelBox box)
{
    EdgeWalk lefts[3], rights[3];
    int leftCount = 0, rightCount = 0;
    for (int k = 0; k < 3; ++k) {
        SkipLowerEdge(p[k], p[(k + 1) % 3], &box);
    }
    for (int k = 0; k < 3; ++k) {
        const pvtScreenPoint a = p[k], b = p[(k + 1) % 3];
        if (b.y < a.y) {
            lefts[leftCount++] = StartWalk(a, b, box.y0);
        } else if (b.y > a.y) {
            rights[rightCount++] = StartWalk(a, b, box.y0);
        }
    }
    uint64_t* row = raster->words + (size_t)box.y0 * raster->wordsPerRow;
    for (int y = box.y0; y <= box.y1; ++y, row += raster->wordsPerRow) {
        int64_t begin = box.x0, end = box.x1;
        for (int k = 0; k < leftCount; ++k) {
            begin = lefts[k].quotient > begin ? lefts[k].quotient : begin;
            NextRow(&lefts[k]);
        }
        for (int k = 0; k < rightCount; ++k) {
            end = rights[k].quotient < end ? rights[k].quotient : end;
            NextRow(&rights[k]);
        }
        if (begin <= end) {
            pvtSetBitRange(row, (size_t)begin, (size_t)end + 1);
        }
    }
}

void pvtRaster_FillTriangle(pvtRaster* raster, pvtScreenPoint a, pvtScreenPoint b, pvtScreenPoint c)
{
    pvtScreenPoint p[3] = {a, b, c};
    PixelBox box;
    if (!FindPixels(raster, p, &box) || IsCovered(raster, &box)) {
        return;
    }
    const int64_t area2 =
        ((int64_t)b.x - a.x) * ((int64_t)c.y - a.y) - ((int64_t)b.y - a.y) * ((int64_t)c.x - a.x);
    if (area2 == 0) {
        return;
    }
    if (area2 < 0) {
        p[1] = c;
        p[2] = b;
    }
    if (box.x1 - box.x0 < SMALL_SIDE && box.y1 - box.y0 < SMALL_SIDE) {
        FillPixels(raster, p, &box);
    } else {
        FillRows(raster, p, box);
    }
}

bool pvtRasterizeSoup(pvtContext* context, const pvtScreen* screen, const pvtSoup* soup,
                      pvtScreenPoint* points, pvtRaster* raster)
{
    if (!SnapPoints(context, screen, soup, points)) {
        return false;
    }
    for (size_t t = 0; t < soup->triangleCount; ++t) {
        if (t % BATCH == 0 && pvtIsCancelled(context)) {
            return false;
        }
        const uint32_t* corners = soup->indices + 3 * t;
        pvtRaster_FillTriangle(raster, points[corners[0]], points[corners[1]], points[corners[2]]);
    }
    return true;
}
