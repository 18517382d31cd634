// SPDX-License-Identifier: MIT
// Gradient ascent on a softened recall. The paper selects sections and leaves them as they are;
// trying random changes one by one, as refine.c and bend.c do, spends nearly all of its time on
// changes that leave the inside. Here each step looks from a few dozen of many views, adds up which
// way all corners are pulled (pull.c), takes from that what would lead outside (contacts.c), and
// moves each corner by about the same length (Kingma and Ba, Adam, 2015). As steps look from ever
// other views, there is nothing to gain from the pixels of any of them.
//
// More triangles than the budget has start, and the least useful are taken away while the others
// move on: those that are left had the choice of their places. In cycles triangles are added where
// most is left to hide, and as many taken away (restructure.c). At last the mesh, which has been
// inside but for a fraction of a voxel, settles until the exact test agrees (settle.c).
#include "ascent.h"
#include "ascent_state.h"

#include "base/context.h"
#include "base/vector.h"
#include "voxel/bit_grid.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    QUADS = 800,            // drawn a sight
    GOAL_RESOLUTION = 256,  // nodes, about twice as many as half pixels
    FIELD_RESOLUTION = 272, // nodes: a voxel each at the default resolution
    JUDGES = 256,           // sights
    SWEEPS = 3,
    CONTACT_STEPS = 8,
    LATE_CONTACT_STEPS = 4,
    PRUNE_ROUNDS = 40, // in which the surplus at the start is taken away
};

static const float START_SOFTNESS = 30.0F; // [px]
static const float LATE_SOFTNESS = 3.0F;   // [px] below which contacts are looked for more closely
static const float COARSE_PIECE = 8.0F, FINE_PIECE = 5.0F; // [vx]
static const float START_REACH = 3.0F;                     // [vx] at 256 along the longest side
static const float GROWTH = 1.0F; // triangles added in a cycle, as part of the budget
static const float MOMENTUM = 0.9F, SQUARES = 0.98F;
static const float THIN_LOOK = 4.0F, THIN_LEAST = 0.1F; // [vx]
static const float THIN_PART = 0.1F;
static const float AHEAD = 2.0F;       // of a step
static const float LEAST_PULL = 0.02F; // of the strongest: corners that are pulled less move less

// Softness and reach fall by factors e^−x; shares of the iterations.
static const struct {
    double share;
    float softness, reach;
} phases[] = {{0.5, 2.3F, 1.8F}, {0.1, 0.0F, 0.0F}, {0.4, 1.1F, 1.6F}};

enum { PHASES = sizeof phases / sizeof *phases, CYCLES_PHASE = 1 };

int pvtGetAscentStart(int budget)
{
    return 2 * budget;
}

pvtVec3 pvtAscent_GetPlace(const pvtAscent* ascent, const float corner[3])
{
    const double h = ascent->frame.voxelSize;
    const pvtVec3 origin = ascent->frame.origin;
    return (pvtVec3){(float)(origin.x + h * (double)corner[0]),
                     (float)(origin.y + h * (double)corner[1]),
                     (float)(origin.z + h * (double)corner[2])};
}

static void FreeAscent(pvtContext* context, pvtAscent* ascent)
{
    pvtTriangleSet_Free(context, &ascent->set);
    pvtTriangleSet_Free(context, &ascent->before);
    pvtTriangleSet_Free(context, &ascent->start);
    pvtTriangleSet_Free(context, &ascent->best);
    pvtField_Free(context, &ascent->field);
    pvtSightSet_Free(context, &ascent->sights);
    pvtPuller_Free(context, &ascent->puller);
    pvtContactSet_Free(context, &ascent->contacts);
    pvtRelease(context, ascent->margins);
    pvtRelease(context, ascent->speeds);
    pvtRelease(context, ascent->squares);
    pvtRelease(context, ascent->squaresBefore);
    pvtRelease(context, ascent->moved);
    pvtRelease(context, ascent);
}

// Triangles in the order of their polygons, as pvtMakeOccluderMesh left them.
static pvtStatus TakeTriangles(pvtContext* context, const pvtOccluder* occluder, pvtAscent* ascent)
{
    pvtMesh mesh;
    const pvtStatus status = pvtWeldMesh(context, &occluder->mesh, &mesh);
    if (status != PVT_OK) {
        return status;
    }
    for (size_t c = 0; c < mesh.positionCount; ++c) {
        const pvtVec3 at = pvtScale(pvtSub(mesh.positions[c], occluder->frame.origin),
                                    1.0 / occluder->frame.voxelSize);
        pvtTriangleSet_AddCorner(&ascent->set, (float[3]){(float)at.x, (float)at.y, (float)at.z},
                                 false);
    }
    const pvtSheetSet* sheets = ascent->options->sheets;
    const size_t* starts = occluder->loops.starts;
    size_t triangle = 0;
    for (size_t p = 0; p < occluder->loops.loopCount; ++p) {
        const bool isFixed =
            sheets != NULL && pvtSheetSet_Find(sheets, &occluder->planes[p]) != NULL;
        const size_t end = triangle + (starts[p + 1] - starts[p] - 2);
        for (; triangle < end; ++triangle) {
            const uint32_t* corners = mesh.indices + 3 * triangle;
            pvtTriangleSet_AddTriangle(&ascent->set, corners, (int32_t)p);
            for (int k = 0; k < 3 && isFixed; ++k) {
                ascent->set.isFixed[corners[k]] = true;
            }
        }
    }
    assert(triangle == mesh.triangleCount);
    pvtMesh_Free(context, &mesh);
    return PVT_OK;
}

static pvtStatus MakeRoom(pvtContext* context, const pvtOccluder* occluder, pvtAscent* ascent)
{
    const int start = (int)occluder->mesh.triangleCount;
    const int grown = 2 * ascent->options->budget + 8;
    const int triangles = start > grown ? start : grown;
    const size_t corners = 3 * (size_t)triangles;
    pvtTriangleSet* const sets[] = {&ascent->set, &ascent->before, &ascent->start, &ascent->best};
    pvtStatus status = PVT_OK;
    for (size_t i = 0; i < sizeof sets / sizeof *sets && status == PVT_OK; ++i) {
        status = pvtCreateTriangleSet(context, (int)corners, triangles, sets[i]);
    }
    if (status == PVT_OK) {
        status = pvtCreateContacts(context, triangles, &ascent->contacts);
    }
    ascent->margins = pvtAllocate(context, (size_t)triangles, sizeof *ascent->margins);
    ascent->speeds = pvtAllocate(context, corners, sizeof *ascent->speeds);
    ascent->squares = pvtAllocate(context, corners, sizeof *ascent->squares);
    ascent->squaresBefore = pvtAllocate(context, corners, sizeof *ascent->squares);
    ascent->moved = pvtAllocate(context, corners, sizeof *ascent->moved);
    return status == PVT_OK &&
                   (ascent->margins == NULL || ascent->speeds == NULL || ascent->squares == NULL ||
                    ascent->squaresBefore == NULL || ascent->moved == NULL)
               ? pvtContext_GetStatus(context)
               : status;
}

static pvtStatus MakeSights(pvtContext* context, pvtAscent* ascent)
{
    const pvtAscentOptions* options = ascent->options;
    const pvtSightOptions sights = {
        .views = options->views, .count = options->sights, .quads = QUADS, .seed = options->seed};
    pvtField goal;
    pvtStatus status = pvtCreateField(context, options->goal, options->inside->interior.cells,
                                      GOAL_RESOLUTION, &goal);
    if (status == PVT_OK) {
        status = pvtCreateSights(context, &sights, &goal, &ascent->sights);
        pvtField_Free(context, &goal);
    }
    return status;
}

static pvtStatus Prepare(pvtContext* context, const pvtOccluder* occluder, pvtAscent* ascent)
{
    pvtStatus status = MakeRoom(context, occluder, ascent);
    if (status == PVT_OK) {
        status = TakeTriangles(context, occluder, ascent);
    }
    if (status == PVT_OK) {
        status = MakeSights(context, ascent);
    }
    if (status == PVT_OK) {
        status = pvtCreateField(context, ascent->options->inside->interior.allowed,
                                ascent->options->inside->interior.cells, FIELD_RESOLUTION,
                                &ascent->field);
    }
    if (status == PVT_OK) {
        status = pvtCreatePuller(context, &ascent->sights, &ascent->set, &ascent->puller);
    }
    if (status == PVT_OK) {
        pvtTriangleSet_Copy(&ascent->set, &ascent->start);
    }
    return status;
}

// From the start again, and from other sights on: that is enough to end elsewhere.
static void BeginTry(pvtAscent* ascent, int attempt)
{
    const int* size = ascent->frame.size;
    const int longest = pvtGetLongestSide(size);
    ascent->softness = START_SOFTNESS;
    ascent->reach = START_REACH * (float)longest / 256.0F;
    ascent->next = ascent->sights.count * (size_t)attempt / (size_t)ascent->options->tries;
    ascent->contactAge = 0;
    pvtTriangleSet_Copy(&ascent->start, &ascent->set);
    const size_t corners = (size_t)ascent->set.cornerCapacity;
    memset(ascent->speeds, 0, corners * sizeof *ascent->speeds);
    memset(ascent->squares, 0, corners * sizeof *ascent->squares);
}

// Where the inside is thin, steps are short: a fraction of how deep it is a little farther in.
static float LimitReach(const pvtAscent* ascent, const float corner[3])
{
    float inward[3], deeper[3];
    pvtField_GetDepthAndInward(&ascent->field, corner, inward);
    for (int axis = 0; axis < 3; ++axis) {
        deeper[axis] = corner[axis] + THIN_LOOK * inward[axis];
    }
    const float depth = pvtField_GetDepth(&ascent->field, deeper);
    const float most = THIN_LEAST + THIN_PART * (depth > 0.0F ? depth : 0.0F);
    return ascent->reach < most ? ascent->reach : most;
}

// The mean pull over the root of its mean square: about 1 for a corner that is always pulled the
// same way, and next to nothing for one that is pulled to and fro.
static void MoveCorners(pvtAscent* ascent)
{
    pvtTriangleSet* set = &ascent->set;
    float most = 0.0F;
    for (int c = 0; c < set->cornerCount; ++c) {
        float* speed = ascent->speeds[c];
        float square = 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
            const float pull = ascent->puller.corners[c][axis];
            speed[axis] = MOMENTUM * speed[axis] + (1.0F - MOMENTUM) * pull;
            square += pull * pull;
        }
        ascent->squares[c] = SQUARES * ascent->squares[c] + (1.0F - SQUARES) * square;
        most = ascent->squares[c] > most ? ascent->squares[c] : most;
    }
    for (int c = 0; c < set->cornerCount && most > 0.0F; ++c) {
        const float scale = LimitReach(ascent, set->corners[c]) /
                            (sqrtf(ascent->squares[c]) + LEAST_PULL * sqrtf(most));
        for (int axis = 0; axis < 3 && !set->isFixed[c]; ++axis) {
            set->corners[c][axis] += scale * ascent->speeds[c][axis];
        }
    }
}

void pvtAscent_Step(pvtContext* context, pvtAscent* ascent, bool wantsEdges)
{
    const pvtPullOptions pull = {.first = ascent->next,
                                 .count = ascent->options->batch,
                                 .softness = ascent->softness,
                                 .inset = PVT_ASCENT_INSET,
                                 .wantsEdges = wantsEdges};
    pvtPullCorners(context, &pull, &ascent->puller);
    ascent->next = (ascent->next + (size_t)pull.count) % ascent->sights.count;
    // Contacts change slowly: they are looked for now and then, a little farther away.
    const bool isLate = ascent->softness < LATE_SOFTNESS;
    pvtContactOptions contact = {.margins = ascent->margins,
                                 .band = AHEAD * ascent->reach,
                                 .piece = isLate ? FINE_PIECE : COARSE_PIECE,
                                 .isAnew = ascent->contactAge == 0};
    if (ascent->contactAge++ % (isLate ? LATE_CONTACT_STEPS : CONTACT_STEPS) == 0) {
        pvtFindContacts(context, &contact, &ascent->field, &ascent->set, &ascent->contacts);
    } else {
        pvtUpdateContacts(&ascent->field, &ascent->set, &ascent->contacts);
    }
    contact.band = ascent->reach;
    for (int c = 0; c < ascent->set.cornerCount; ++c) {
        if (ascent->set.isFixed[c]) {
            memset(ascent->puller.corners[c], 0, sizeof ascent->puller.corners[c]);
        }
    }
    pvtSlideAlong(&contact, &ascent->contacts, &ascent->set, SWEEPS, ascent->puller.corners);
    MoveCorners(ascent);
    pvtPushInside(&ascent->contacts, &ascent->field, ascent->margins, SWEEPS, &ascent->set);
}

double pvtAscent_Judge(pvtContext* context, pvtAscent* ascent)
{
    double sum = 0.0;
    for (size_t first = 0; first < JUDGES; first += PVT_MOST_BATCH) {
        const pvtPullOptions pull = {.first = first,
                                     .count = PVT_MOST_BATCH,
                                     .softness = ascent->softness,
                                     .inset = PVT_ASCENT_INSET};
        pvtPullCorners(context, &pull, &ascent->puller);
        sum += ascent->puller.share;
    }
    return sum * PVT_MOST_BATCH / JUDGES;
}

// A cycle that lost is undone; corners start anew from rest.
static void EndCycle(pvtContext* context, pvtAscent* ascent)
{
    const double worth = pvtAscent_Judge(context, ascent);
    if (worth < ascent->worth) {
        ascent->contactAge = 0;
        pvtTriangleSet_Copy(&ascent->before, &ascent->set);
        memset(ascent->speeds, 0, (size_t)ascent->set.cornerCount * sizeof *ascent->speeds);
        memcpy(ascent->squares, ascent->squaresBefore,
               (size_t)ascent->set.cornerCount * sizeof *ascent->squares);
    }
}

static void BeginCycle(pvtContext* context, pvtAscent* ascent)
{
    pvtTriangleSet_Copy(&ascent->set, &ascent->before);
    memcpy(ascent->squaresBefore, ascent->squares,
           (size_t)ascent->set.cornerCount * sizeof *ascent->squares);
    ascent->worth = pvtAscent_Judge(context, ascent);
}

// How many triangles there are to be at a time of the first phase, 0 to 1.
static int GetStartCount(const pvtAscent* ascent, int start, double time)
{
    const int budget = ascent->options->budget;
    const double surplus = start - budget;
    const double left = 1.0 - time;
    return start <= budget ? start : budget + (int)(surplus * left * left);
}

// A cycle is a quarter of growing, a half of pruning, and a quarter of rest.
static int GetCycleCount(const pvtAscent* ascent, double time)
{
    const double left = time < 0.25 ? 1.0 : time < 0.75 ? (0.75 - time) / 0.5 : 0.0;
    return ascent->options->budget + (int)((double)GROWTH * ascent->options->budget * left * left);
}

typedef struct Clock {
    int iteration, end; // of the phase
    int start;          // triangles at its start
} Clock;

static void RunPhaseStep(pvtContext* context, pvtAscent* ascent, int phase, const Clock* clock)
{
    const int count = ascent->set.triangleCount;
    const double time = (double)clock->iteration / clock->end;
    int wanted = ascent->options->budget;
    bool grows = false;
    if (phase == 0) {
        const int round = clock->end / PRUNE_ROUNDS > 1 ? clock->end / PRUNE_ROUNDS : 1;
        wanted = clock->iteration % round == 0 ? GetStartCount(ascent, clock->start, time) : count;
    } else if (phase == CYCLES_PHASE && ascent->options->cycles > 0) {
        const int cycle = clock->end / ascent->options->cycles + 1;
        const int within = clock->iteration % cycle;
        const int round = cycle / PRUNE_ROUNDS > 1 ? cycle / PRUNE_ROUNDS : 1;
        if (within == 0 && clock->iteration > 0) {
            EndCycle(context, ascent);
        }
        grows = within == 0 && clock->iteration + cycle / 2 < clock->end;
        wanted = within % round == 0 ? GetCycleCount(ascent, (double)within / cycle) : count;
    }
    if (count > wanted) {
        pvtAscent_Prune(context, ascent, wanted);
    }
    if (grows) {
        BeginCycle(context, ascent);
    }
    pvtAscent_Step(context, ascent, grows);
    if (grows) {
        pvtAscent_Grow(ascent, GetCycleCount(ascent, 0.0) - ascent->set.triangleCount);
    }
}

// False when time is up.
static bool GoOn(pvtContext* context, const pvtAscent* ascent)
{
    const pvtAscentOptions* options = ascent->options;
    const double share = (double)ascent->steps / options->iterations / options->tries;
    pvtReportProgress(context, share < 1.0 ? share : 1.0);
    if (options->deadline > 0.0 && pvtGetSeconds() > options->deadline) {
        pvtLog(context, PVT_LOG_WARNING,
               "the deadline ended the refinement after %.0f %% of its steps", 100.0 * share);
        return false;
    }
    return true;
}

static bool Climb(pvtContext* context, pvtAscent* ascent)
{
    for (int phase = 0; phase < PHASES; ++phase) {
        const bool isLeftOut = phase == CYCLES_PHASE && ascent->options->cycles == 0;
        const double share = isLeftOut ? 0.0 : phases[phase].share;
        Clock clock = {.end = (int)(share * ascent->options->iterations),
                       .start = ascent->set.triangleCount};
        for (; clock.iteration < clock.end; ++clock.iteration, ++ascent->steps) {
            RunPhaseStep(context, ascent, phase, &clock);
            ascent->softness *= 1.0F - phases[phase].softness / (float)clock.end;
            ascent->reach *= 1.0F - phases[phase].reach / (float)clock.end;
            if (pvtIsCancelled(context) || !GoOn(context, ascent)) {
                return false;
            }
        }
    }
    return true;
}

static pvtStatus RunTries(pvtContext* context, pvtAscent* ascent)
{
    bool goesOn = true;
    for (int attempt = 0; attempt < ascent->options->tries && goesOn; ++attempt) {
        BeginTry(ascent, attempt);
        goesOn = Climb(context, ascent);
        if (ascent->set.triangleCount > ascent->options->budget) {
            pvtAscent_Prune(context, ascent, ascent->options->budget);
        }
        const double worth = pvtAscent_Judge(context, ascent);
        if (attempt == 0 || worth > ascent->bestWorth) {
            ascent->bestWorth = worth;
            pvtTriangleSet_Copy(&ascent->set, &ascent->best);
        }
    }
    pvtTriangleSet_Copy(&ascent->best, &ascent->set);
    return pvtIsCancelled(context) ? pvtFailCancelled(context) : PVT_OK;
}

// Polygons of which no triangle is left go; the others stay in order.
static void KeepPolygons(const pvtAscent* ascent, pvtOccluder* occluder)
{
    pvtLoopSet* loops = &occluder->loops;
    size_t kept = 0, points = 0;
    for (size_t p = 0; p < loops->loopCount; ++p) {
        const size_t first = loops->starts[p], count = loops->starts[p + 1] - first;
        bool isUsed = false;
        for (int t = 0; t < ascent->set.triangleCount && !isUsed; ++t) {
            isUsed = ascent->set.tags[t] == (int32_t)p;
        }
        if (isUsed) {
            occluder->planes[kept] = occluder->planes[p];
            memmove(loops->points + points, loops->points + first, count * sizeof *loops->points);
            loops->starts[kept++] = points;
            points += count;
        }
    }
    loops->starts[kept] = points;
    loops->loopCount = kept;
    loops->pointCount = points;
}

static pvtStatus StoreTriangles(pvtContext* context, const pvtAscent* ascent, pvtOccluder* occluder)
{
    const pvtTriangleSet* set = &ascent->set;
    pvtVec3* places = pvtAllocate(context, (size_t)set->cornerCount, sizeof *places);
    if (places == NULL) {
        return pvtContext_GetStatus(context);
    }
    for (int c = 0; c < set->cornerCount; ++c) {
        places[c] = pvtAscent_GetPlace(ascent, set->corners[c]);
    }
    pvtMesh mesh;
    const pvtStatus status = pvtCreateMesh(context, places, (size_t)set->cornerCount,
                                           set->triangles[0], (size_t)set->triangleCount, &mesh);
    if (status == PVT_OK) {
        pvtMesh_Free(context, &occluder->mesh);
        occluder->mesh = mesh;
        KeepPolygons(ascent, occluder);
    }
    pvtRelease(context, places);
    return status;
}

pvtStatus pvtAscendOccluder(pvtContext* context, const pvtAscentOptions* options,
                            pvtOccluder* occluder)
{
    assert(options->budget >= 1 && options->budget <= PVT_MOST_ASCENT);
    pvtAscent* ascent = pvtAllocate(context, 1, sizeof *ascent);
    if (ascent == NULL) {
        return pvtContext_GetStatus(context);
    }
    ascent->options = options;
    ascent->frame = occluder->frame;
    pvtStatus status = Prepare(context, occluder, ascent);
    if (status == PVT_OK) {
        status = RunTries(context, ascent);
    }
    if (status == PVT_OK) {
        status = pvtAscent_Settle(context, ascent);
    }
    if (status == PVT_OK) {
        status = StoreTriangles(context, ascent, occluder);
    }
    FreeAscent(context, ascent);
    return status;
}
