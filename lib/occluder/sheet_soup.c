// SPDX-License-Identifier: MIT
// Planes fitted to triangles by area: gather what is near the plane, take the plane of least
// squares, and again, as long as that finds more (as the refitting of Schnabel, Wahl and Klein,
// Efficient RANSAC for Point-Cloud Shape Detection, 2007, section 4.3.1). Moments are integrals
// over the triangles and not sums over points, so that tessellation does not matter.
#include "sheet_soup.h"

#include "base/context.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 32, SIDE = 32, REFITS = 6, SWEEPS = 12 };

// Surface this close to a plane [vx] lies on it.
static const double ON_PLANE = 1.0 / 64.0;
// A plane with this part of the area on it is taken as it is.
static const double FLAT_SHARE = 0.6;
// Cosine between faces and the plane they are counted to.
static const double ALIGNED = 0.7;

void pvtSheetSoup_Free(pvtContext* context, pvtSheetSoup* soup)
{
    pvtRelease(context, soup->triangles);
    pvtRelease(context, soup->chunks);
    *soup = (pvtSheetSoup){0};
}

void pvtSheetSoup_GetCorners(const pvtSheetSoup* soup, size_t triangle, pvtVec3 corners[3])
{
    const double scale = 1.0 / soup->frame.voxelSize;
    for (int c = 0; c < 3; ++c) {
        const pvtVec3 p = soup->mesh->positions[soup->mesh->indices[3 * triangle + (size_t)c]];
        corners[c] = pvtScale(pvtSub(p, soup->frame.origin), scale);
    }
}

static pvtVec3 GetAreaVector(const pvtVec3 corners[3])
{
    return pvtScale(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])), 0.5);
}

static size_t GetBlock(const pvtSheetSoup* soup, const pvtVec3 corners[3])
{
    const pvtVec3 sum = pvtAdd(pvtAdd(corners[0], corners[1]), corners[2]);
    size_t block = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const double at = pvtGetAxis(sum, axis) / (3.0 * soup->frame.size[axis]) * SIDE;
        block = block * SIDE + (size_t)fmax(0.0, fmin(at, SIDE - 1.0));
    }
    return block;
}

static bool HasArea(const pvtVec3 corners[3])
{
    return pvtLength3(GetAreaVector(corners)) > 1e-12;
}

// Triangles by block, in their own order within each (a counting sort).
static pvtStatus SortByBlock(pvtContext* context, pvtSheetSoup* soup)
{
    enum { BLOCKS = SIDE * SIDE * SIDE };
    size_t* starts = pvtAllocate(context, BLOCKS + 1, sizeof *starts);
    soup->triangles = pvtAllocate(context, soup->mesh->triangleCount, sizeof *soup->triangles);
    if (starts == NULL || soup->triangles == NULL) {
        pvtRelease(context, starts);
        return pvtContext_GetStatus(context);
    }
    pvtVec3 corners[3];
    for (size_t t = 0; t < soup->mesh->triangleCount; ++t) {
        pvtSheetSoup_GetCorners(soup, t, corners);
        starts[GetBlock(soup, corners) + 1] += HasArea(corners) ? 1 : 0;
    }
    for (size_t b = 0; b < BLOCKS; ++b) {
        starts[b + 1] += starts[b];
    }
    soup->count = starts[BLOCKS];
    for (size_t t = 0; t < soup->mesh->triangleCount; ++t) {
        pvtSheetSoup_GetCorners(soup, t, corners);
        if (HasArea(corners)) {
            soup->triangles[starts[GetBlock(soup, corners)]++] = (uint32_t)t;
        }
    }
    pvtRelease(context, starts);
    return PVT_OK;
}

static void BoundChunk(const pvtSheetSoup* soup, pvtSheetSoupChunk* chunk)
{
    pvtVec3 low = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    pvtVec3 high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (size_t i = chunk->begin; i < chunk->end; ++i) {
        pvtVec3 corners[3];
        pvtSheetSoup_GetCorners(soup, soup->triangles[i], corners);
        for (int c = 0; c < 3; ++c) {
            low = (pvtVec3){fmin(low.x, corners[c].x), fmin(low.y, corners[c].y),
                            fmin(low.z, corners[c].z)};
            high = (pvtVec3){fmax(high.x, corners[c].x), fmax(high.y, corners[c].y),
                             fmax(high.z, corners[c].z)};
        }
    }
    chunk->center = pvtScale(pvtAdd(low, high), 0.5);
    chunk->half = pvtScale(pvtSub(high, low), 0.5);
}

pvtStatus pvtCreateSheetSoup(pvtContext* context, const pvtMesh* mesh, const pvtGridFrame* frame,
                             pvtSheetSoup* soup)
{
    *soup = (pvtSheetSoup){.mesh = mesh, .frame = *frame};
    pvtStatus status = SortByBlock(context, soup);
    if (status == PVT_OK) {
        soup->chunkCount = (soup->count + CHUNK - 1) / CHUNK;
        soup->chunks = pvtAllocate(context, soup->chunkCount, sizeof *soup->chunks);
        status = soup->chunks == NULL ? pvtContext_GetStatus(context) : PVT_OK;
    }
    for (size_t c = 0; c < soup->chunkCount && status == PVT_OK; ++c) {
        const size_t end = (c + 1) * CHUNK;
        soup->chunks[c].begin = c * CHUNK;
        soup->chunks[c].end = end < soup->count ? end : soup->count;
        BoundChunk(soup, &soup->chunks[c]);
    }
    if (status != PVT_OK) {
        pvtSheetSoup_Free(context, soup);
    }
    return status;
}

// Integrals over surface: of 1, p and p pᵀ, p from a point nearby.
typedef struct Moments {
    pvtVec3 from;
    double area;
    pvtVec3 first;
    double second[3][3];
} Moments;

static void AddTriangle(Moments* moments, const pvtVec3 corners[3], double area)
{
    moments->area += area;
    for (int c = 0; c < 3; ++c) {
        // Exact for what is quadratic: the mean over the middles of the edges.
        const pvtVec3 middle =
            pvtSub(pvtScale(pvtAdd(corners[c], corners[(c + 1) % 3]), 0.5), moments->from);
        const pvtVec3 weighted = pvtScale(middle, area / 3.0);
        moments->first = pvtAdd(moments->first, weighted);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                moments->second[i][j] += pvtGetAxis(weighted, i) * pvtGetAxis(middle, j);
            }
        }
    }
}

static void GatherTriangle(const pvtSheetSoup* soup, size_t triangle, const pvtFlat* flat,
                           double distance, Moments* moments)
{
    pvtVec3 corners[3];
    pvtSheetSoup_GetCorners(soup, triangle, corners);
    for (int c = 0; c < 3; ++c) {
        if (fabs(pvtDot(flat->normal, corners[c]) - flat->offset) > distance) {
            return;
        }
    }
    const pvtVec3 vector = GetAreaVector(corners);
    const double area = pvtLength3(vector);
    if (fabs(pvtDot(vector, flat->normal)) >= ALIGNED * area) {
        AddTriangle(moments, corners, area);
    }
}

static Moments Gather(const pvtSheetSoup* soup, const pvtFlat* flat, double distance)
{
    Moments moments = {.from = flat->center};
    // Distances are along the plane's axis, those along its normal are shorter.
    const pvtVec3 n = flat->normal;
    distance *= fmax(fabs(n.x), fmax(fabs(n.y), fabs(n.z)));
    for (size_t c = 0; c < soup->chunkCount; ++c) {
        const pvtSheetSoupChunk* chunk = &soup->chunks[c];
        if (!pvtIsChunkNear(chunk, flat->normal, flat->offset, distance)) {
            continue;
        }
        for (size_t i = chunk->begin; i < chunk->end; ++i) {
            GatherTriangle(soup, soup->triangles[i], flat, distance, &moments);
        }
    }
    return moments;
}

// One Jacobi rotation that clears m[p][q]; the columns of v follow.
static void Rotate(double m[3][3], double v[3][3], int p, int q)
{
    if (m[p][q] == 0.0) {
        return;
    }
    const double theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
    const double t = (theta < 0.0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
    const double c = 1.0 / sqrt(t * t + 1.0);
    const double s = t * c;
    for (int k = 0; k < 3; ++k) {
        const double a = m[k][p], b = m[k][q];
        m[k][p] = c * a - s * b;
        m[k][q] = s * a + c * b;
    }
    for (int k = 0; k < 3; ++k) {
        const double a = m[p][k], b = m[q][k];
        m[p][k] = c * a - s * b;
        m[q][k] = s * a + c * b;
        const double d = v[k][p], e = v[k][q];
        v[k][p] = c * d - s * e;
        v[k][q] = s * d + c * e;
    }
}

// The plane of least squares through what was gathered.
static pvtFlat FitMoments(const Moments* moments)
{
    const pvtVec3 mean = pvtScale(moments->first, 1.0 / moments->area);
    double m[3][3];
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            m[i][j] =
                moments->second[i][j] / moments->area - pvtGetAxis(mean, i) * pvtGetAxis(mean, j);
        }
    }
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
        Rotate(m, v, 0, 1);
        Rotate(m, v, 0, 2);
        Rotate(m, v, 1, 2);
    }
    int least = 0;
    for (int i = 1; i < 3; ++i) {
        least = m[i][i] < m[least][least] ? i : least;
    }
    pvtFlat flat = {.normal = pvtNormalize((pvtVec3){v[0][least], v[1][least], v[2][least]}),
                    .center = pvtAdd(moments->from, mean)};
    flat.offset = pvtDot(flat.normal, flat.center);
    return flat;
}

static pvtFlat Grow(const pvtSheetSoup* soup, pvtFlat flat, double distance)
{
    Moments moments = Gather(soup, &flat, distance);
    flat.area = moments.area;
    for (int i = 0; i < REFITS && moments.area > 0.0; ++i) {
        pvtFlat fitted = FitMoments(&moments);
        moments = Gather(soup, &fitted, distance);
        fitted.area = moments.area;
        if (fitted.area < flat.area) {
            break;
        }
        const bool settled = fitted.area < 1.01 * flat.area;
        flat = fitted;
        if (settled) {
            break;
        }
    }
    return flat;
}

pvtFlat pvtFitFlat(const pvtSheetSoup* soup, size_t triangle, double distance)
{
    pvtVec3 corners[3];
    pvtSheetSoup_GetCorners(soup, triangle, corners);
    pvtFlat seed = {.normal = pvtNormalize(GetAreaVector(corners)),
                    .center =
                        pvtScale(pvtAdd(pvtAdd(corners[0], corners[1]), corners[2]), 1.0 / 3.0)};
    seed.offset = pvtDot(seed.normal, seed.center);
    const pvtFlat flat = Grow(soup, seed, fmin(ON_PLANE, distance));
    const pvtFlat bent = Grow(soup, seed, distance);
    return flat.area > 0.0 && flat.area >= FLAT_SHARE * bent.area ? flat : bent;
}
