// SPDX-License-Identifier: MIT
// The last refinement: triangles leave the planes of their polygons. Any triangle is planar, so
// that nothing else holds them there, and a polygon that bends along its inner edges follows a
// round silhouette with fewer of them. Corners that triangles share move together, so that no gap
// opens along an edge, unless one triangle gains by letting go.
//
// A change is kept when it raises what the triangles hide of all rectangles on the screen, first
// seen from the views that are optimised for, then from others too. Without the second look the
// search finds gaps so narrow that they fall between the pixels of all the views that it knows.
//
// At the end each corner is tried along the edges that end at it. On a wall a triangle grows no
// other way without leaving it, so that of a box nearly all is covered in the end.
#include "bend.h"

#include "base/context.h"
#include "base/random.h"
#include "base/vector.h"
#include "facets.h"
#include "triangle_set.h"
#include "voxel/bit_grid.h"

#include <math.h>

enum { BATCH = 8, STEPS = 3, JOIN_CHOICES = 3, GROWTHS = 6 };

static const double RELINKS = 0.08;      // of the trials
static const double BOTH_ENDS = 0.1;     // of the moves: of an edge
static const double ALONG_EDGES = 0.7;   // of the moves: along an edge of the triangle
static const double SHORTER = 0.2;       // of these: so that the edge gets shorter
static const double REACH = 0.08;        // of the longest side: the farthest step
static const double MOST_HALVINGS = 6.6; // of the reach: to about a hundredth
static const double STEP_FACTOR = 0.4;   // from one attempt to the next

typedef struct Trial {
    pvtFacetChange change;
    bool gains;
} Trial;

typedef struct Bending {
    pvtContext* context;
    const pvtBendOptions* options;
    pvtFacets facets;
    pvtGridFrame frame;
    double reach; // [wu]
    double rest;  // of the trials at random: 1 at first, 0 at the end
    Trial trials[BATCH];
    uint64_t next;       // number of the batch's first trial: its dice
    uint64_t begin, end; // numbers of the sweeps' trials, which come after the random ones
} Bending;

// Close to a normal distribution: the sum of four even ones.
static double Scatter(pvtRandom* random)
{
    double sum = -2.0;
    for (int i = 0; i < 4; ++i) {
        sum += pvtRandom_Unit(random);
    }
    return 1.7 * sum;
}

// As files store it.
static pvtVec3 RoundPlace(pvtVec3 place)
{
    return (pvtVec3){(float)place.x, (float)place.y, (float)place.z};
}

static bool IsInside(const Bending* bending, const pvtFacetChange* change)
{
    for (int i = 0; i < change->count; ++i) {
        pvtVec3 corners[3];
        for (int c = 0; c < 3; ++c) {
            corners[c] = pvtToGrid(&bending->frame, pvtGetChangedPlace(&bending->facets, change,
                                                                       change->corners[i][c]));
        }
        if (!pvtInsideTest_HasTriangle(bending->options->inside, corners)) {
            return false;
        }
    }
    return true;
}

// A few points of each triangle: most that leave are found out by them.
static bool MayBeInside(const Bending* bending, const pvtFacetChange* change)
{
    static const double spots[10][3] = {
        {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0},   {0.0, 0.0, 1.0},   {0.5, 0.5, 0.0},   {0.0, 0.5, 0.5},
        {0.5, 0.0, 0.5}, {0.25, 0.75, 0.0}, {0.75, 0.25, 0.0}, {0.0, 0.25, 0.75}, {0.25, 0.25, 0.5},
    };
    for (int i = 0; i < change->count; ++i) {
        pvtVec3 corners[3];
        for (int c = 0; c < 3; ++c) {
            corners[c] = pvtToGrid(&bending->frame, pvtGetChangedPlace(&bending->facets, change,
                                                                       change->corners[i][c]));
        }
        for (int spot = 0; spot < 10; ++spot) {
            const pvtVec3 point = pvtAdd(
                pvtScale(corners[0], spots[spot][0]),
                pvtAdd(pvtScale(corners[1], spots[spot][1]), pvtScale(corners[2], spots[spot][2])));
            if (!pvtInsideTest_HasPoint(bending->options->inside, point)) {
                return false;
            }
        }
    }
    return true;
}

// The cheapest tests first: most trials end at one of them.
static bool Gains(const Bending* bending, pvtFacetChange* change)
{
    const pvtFacets* facets = &bending->facets;
    if (!MayBeInside(bending, change) || !pvtScreenFacetChange(facets, change) ||
        !IsInside(bending, change)) {
        return false;
    }
    pvtEvaluateFacetChange(facets, change);
    return change->screened > facets->screened && change->total > facets->total;
}

// The triangles around the corners that move; false when they are too many.
static bool ListTriangles(const pvtMesh* mesh, pvtFacetChange* change)
{
    change->count = 0;
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        const uint32_t* corners = mesh->indices + 3 * t;
        if (!pvtHasCorner(corners, change->moved[0]) &&
            !pvtHasCorner(corners, change->moved[change->movedCount - 1])) {
            continue;
        }
        if (change->count == PVT_MAX_CHANGED_FACETS) {
            return false;
        }
        for (int c = 0; c < 3; ++c) {
            change->corners[change->count][c] = corners[c];
        }
        change->triangles[change->count++] = t;
    }
    return true;
}

// Of all sizes, though fewer large ones towards the end.
static pvtVec3 DrawStep(const Bending* bending, pvtRandom* random)
{
    // Halvings, with straight lines between them: pow is not the same on every machine.
    const double halvings = MOST_HALVINGS * pvtRandom_Unit(random) * (1.0 - 0.5 * bending->rest);
    const double whole = floor(halvings);
    const double size = ldexp(1.0 - 0.5 * (halvings - whole), -(int)whole);
    const double x = Scatter(random);
    const double y = Scatter(random);
    const double z = Scatter(random);
    return pvtScale((pvtVec3){x, y, z}, size * bending->reach);
}

// A step as long as `step`, away from another corner or towards it: what lies along a wall stays
// there, and grows.
static pvtVec3 TurnAlongEdge(pvtVec3 step, pvtVec3 corner, pvtVec3 other, pvtRandom* random)
{
    const double length = pvtLength3(step);
    const double sign = pvtRandom_Unit(random) < SHORTER ? -1.0 : 1.0;
    return pvtScale(pvtNormalize(pvtSub(corner, other)), sign * length);
}

// Moves corners by a step, or by a part of it.
static bool TryStep(const Bending* bending, pvtVec3 step, pvtFacetChange* change)
{
    const pvtMesh* mesh = &bending->facets.mesh;
    if (!ListTriangles(mesh, change)) {
        return false;
    }
    for (int attempt = 0; attempt < STEPS; ++attempt) {
        for (int i = 0; i < change->movedCount; ++i) {
            change->places[i] = RoundPlace(pvtAdd(mesh->positions[change->moved[i]], step));
        }
        if (Gains(bending, change)) {
            return true;
        }
        step = pvtScale(step, STEP_FACTOR);
    }
    return false;
}

static bool TryMove(const Bending* bending, pvtRandom* random, pvtFacetChange* change)
{
    const pvtMesh* mesh = &bending->facets.mesh;
    const uint32_t* corners =
        mesh->indices + 3 * pvtRandom_Below(random, (uint32_t)mesh->triangleCount);
    const uint32_t first = pvtRandom_Below(random, 3);
    change->movedCount = pvtRandom_Unit(random) < BOTH_ENDS ? 2 : 1;
    for (uint32_t i = 0; i < 2; ++i) {
        change->moved[i] = corners[(first + i) % 3];
    }
    pvtVec3 step = DrawStep(bending, random);
    if (pvtRandom_Unit(random) < ALONG_EDGES) {
        // Not along the edge that moves as a whole.
        const uint32_t way = change->movedCount == 2 || pvtRandom_Unit(random) < 0.5 ? 2 : 1;
        step = TurnAlongEdge(step, mesh->positions[corners[first]],
                             mesh->positions[corners[(first + way) % 3]], random);
    }
    return TryStep(bending, step, change);
}

// Each corner of each triangle away from each of the two others. In sweeps, of half the step each
// time and of a voxel in the last one: random steps seldom find what is left of that.
static bool TryGrow(const Bending* bending, uint64_t number, pvtFacetChange* change)
{
    const pvtMesh* mesh = &bending->facets.mesh;
    const uint64_t trials = GROWTHS * mesh->triangleCount;
    const uint64_t sweepsLeft = (bending->end - number - 1) / trials;
    const uint64_t place = (number - bending->begin) % trials;
    const uint32_t* corners = mesh->indices + 3 * (place / GROWTHS);
    const size_t first = place % 3, other = (first + 1 + place % GROWTHS / 3) % 3;
    const pvtVec3 way = pvtSub(mesh->positions[corners[first]], mesh->positions[corners[other]]);
    const double size = ldexp(bending->frame.voxelSize, (int)sweepsLeft);
    change->movedCount = 1;
    change->moved[0] = corners[first];
    return TryStep(bending, pvtScale(pvtNormalize(way), size), change);
}

// A corner that no triangle uses; there is one whenever some triangles share a corner.
static bool FindSpareCorner(const pvtMesh* mesh, uint32_t* spare)
{
    bool isUsed[3 * PVT_MAX_FACETS] = {false};
    for (size_t i = 0; i < 3 * mesh->triangleCount; ++i) {
        isUsed[mesh->indices[i]] = true;
    }
    for (*spare = 0; *spare < mesh->positionCount; ++*spare) {
        if (!isUsed[*spare]) {
            return true;
        }
    }
    return false;
}

// The nearest of a few corners of other triangles, to share.
static bool FindCornerToJoin(const pvtMesh* mesh, const uint32_t* corners, uint32_t corner,
                             pvtRandom* random, uint32_t* joined)
{
    double least = HUGE_VAL;
    for (int i = 0; i < JOIN_CHOICES; ++i) {
        const uint32_t other =
            mesh->indices[pvtRandom_Below(random, (uint32_t)(3 * mesh->triangleCount))];
        const pvtVec3 way = pvtSub(mesh->positions[other], mesh->positions[corner]);
        if (!pvtHasCorner(corners, other) && pvtDot(way, way) < least) {
            least = pvtDot(way, way);
            *joined = other;
        }
    }
    return least < HUGE_VAL;
}

// One triangle lets go of a corner that it shares, or takes a corner of another one.
static bool TryRelink(const Bending* bending, pvtRandom* random, pvtFacetChange* change)
{
    const pvtMesh* mesh = &bending->facets.mesh;
    const size_t triangle = pvtRandom_Below(random, (uint32_t)mesh->triangleCount);
    const uint32_t side = pvtRandom_Below(random, 3);
    const uint32_t* corners = mesh->indices + 3 * triangle;
    uint32_t corner = corners[side];
    if (pvtRandom_Unit(random) < 0.5) {
        const pvtVec3 place = mesh->positions[corner];
        if (!FindSpareCorner(mesh, &corner)) {
            return false;
        }
        change->movedCount = 1;
        change->moved[0] = corner;
        change->places[0] = RoundPlace(pvtAdd(place, DrawStep(bending, random)));
    } else if (!FindCornerToJoin(mesh, corners, corner, random, &corner)) {
        return false;
    }
    change->count = 1;
    change->triangles[0] = triangle;
    for (uint32_t c = 0; c < 3; ++c) {
        change->corners[0][c] = c == side ? corner : corners[c];
    }
    return Gains(bending, change);
}

static void RunTrials(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Bending* bending = taskData;
    for (size_t i = begin; i < end; ++i) {
        Trial* trial = &bending->trials[i];
        pvtRandom random = pvtMakeRandom(bending->options->seed, bending->next + i);
        trial->change = (pvtFacetChange){0};
        trial->gains = pvtRandom_Unit(&random) < RELINKS
                           ? TryRelink(bending, &random, &trial->change)
                           : TryMove(bending, &random, &trial->change);
    }
}

static void RunGrowths(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    Bending* bending = taskData;
    for (size_t i = begin; i < end; ++i) {
        Trial* trial = &bending->trials[i];
        trial->change = (pvtFacetChange){0};
        trial->gains =
            bending->next + i < bending->end && TryGrow(bending, bending->next + i, &trial->change);
    }
}

// As in refine.c: the first that gains is made, and those behind it count as not tried.
static void RunBatch(pvtContext* context, Bending* bending)
{
    pvtParallelFor(context, RunTrials, BATCH, 1, bending);
    for (int i = 0; i < BATCH && bending->next < bending->begin; ++i) {
        ++bending->next;
        if (bending->trials[i].gains) {
            pvtApplyFacetChange(context, &bending->facets, &bending->trials[i].change);
            return;
        }
    }
}

// Moves a corner, and takes that back when it does not gain after all.
static bool MakeMove(pvtContext* context, pvtFacets* facets, pvtFacetChange* change)
{
    const double screened = facets->screened, total = facets->total;
    const pvtVec3 before = facets->mesh.positions[change->moved[0]];
    pvtApplyFacetChange(context, facets, change);
    if (facets->screened > screened && facets->total > total) {
        return true;
    }
    change->places[0] = before;
    pvtApplyFacetChange(context, facets, change);
    return false;
}

// Many gain: all are made that have no triangle in common.
static void RunGrowthBatch(pvtContext* context, Bending* bending)
{
    bool isChanged[PVT_MAX_FACETS] = {false};
    pvtParallelFor(context, RunGrowths, BATCH, 1, bending);
    for (int i = 0; i < BATCH; ++i) {
        pvtFacetChange* change = &bending->trials[i].change;
        bool isMade = bending->trials[i].gains;
        for (int t = 0; t < change->count; ++t) {
            isMade = isMade && !isChanged[change->triangles[t]];
        }
        isMade = isMade && MakeMove(context, &bending->facets, change);
        for (int t = 0; t < change->count && isMade; ++t) {
            isChanged[change->triangles[t]] = true;
        }
    }
    bending->next += BATCH;
}

static pvtStatus Climb(pvtContext* context, Bending* bending)
{
    const pvtBendOptions* options = bending->options;
    const uint64_t sweep = GROWTHS * bending->facets.mesh.triangleCount;
    bending->begin = (uint64_t)options->trials;
    bending->end = bending->begin + (uint64_t)options->sweeps * sweep;
    while (bending->next < bending->end) {
        const double done = (double)bending->next / (double)bending->end;
        if (bending->next < bending->begin) {
            bending->rest = 1.0 - (double)bending->next / (double)bending->begin;
            RunBatch(context, bending);
        } else {
            RunGrowthBatch(context, bending);
        }
        if (pvtIsCancelled(context)) {
            return pvtFailCancelled(context);
        }
        if (pvtEnough_Ends(context, &options->enough, "last refinement", "trials", done)) {
            break;
        }
        pvtReportProgress(context, done);
    }
    return PVT_OK;
}

pvtStatus pvtBendOccluder(pvtContext* context, const pvtBendOptions* options, pvtOccluder* occluder)
{
    if (occluder->mesh.triangleCount == 0) {
        return PVT_OK;
    }
    Bending* bending = pvtAllocate(context, 1, sizeof *bending);
    if (bending == NULL) {
        return pvtContext_GetStatus(context);
    }
    const int* size = occluder->frame.size;
    bending->context = context;
    bending->options = options;
    bending->frame = occluder->frame;
    bending->reach = REACH * occluder->frame.voxelSize * fmax(size[0], fmax(size[1], size[2]));
    const pvtFacetOptions facets = {options->views, options->more, options->bounds};
    pvtStatus status = pvtCreateFacets(context, &facets, &occluder->mesh, &bending->facets);
    if (status == PVT_OK) {
        status = Climb(context, bending);
    }
    if (status == PVT_OK) {
        pvtMesh bent;
        status = pvtWeldMesh(context, &bending->facets.mesh, &bent);
        if (status == PVT_OK) {
            pvtMesh_Free(context, &occluder->mesh);
            occluder->mesh = bent;
        }
    }
    pvtFacets_Free(context, &bending->facets);
    pvtRelease(context, bending);
    return status;
}
