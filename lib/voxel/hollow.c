// SPDX-License-Identifier: MIT
// What would fill a hollow solid.
//
// A shell with holes and a tangle of branches both have little inside, and a large enough ball
// closes both. What tells them apart is the room behind the openings: a shell encloses a place
// for a ball much wider than any that passes its openings, between branches there is none. So
// growing sizes D are tried, and the first counts at which balls half as wide again (and two
// voxels at least) are locked in places that a ball of diameter D cannot leave, over at least 1 %
// of the bounds and three times what is inside already. On 52 real models this found the shells,
// and no tree or twig.
//
// The ground closes nothing but what stands open on it, so that it may be told for less: a trunk is
// a small part of its tree's bounds, but nearly all that a tree hides anything by. Twice of what is
// inside is enough there, which on the same models found three trees and two buildings; with no
// other does the inside grow by more than six tenths.
//
// The search runs on a coarse copy of the grid, where each size costs little. Finer copies are
// looked at only when there is something to find, from the size that the coarser one gave, and
// only while that size is few voxels, so that a voxel matters. Coarse voxels make openings look
// narrower and cavities smaller, so there half the room is enough.
#include "outside.h"

#include "bit_grid.h"
#include "dilate.h"
#include "flood.h"

#include "base/context.h"

#include <math.h>

enum {
    COARSE_SIDE = 72,
    FINE_SIDE = 576,
    ESTIMATE_SIDE = 144,
    MARGIN = 1,
    SMALLEST_BALL = 2,
    MORE_ROOM = 2,
    EXACT_ENOUGH = 8,
    CANCEL_INTERVAL = 16,
    MOST_ROUNDS = 3
};

static const double roomFactor = 1.5;
static const double leastFraction = 0.01; // of the bounds
static const double leastGain = 3.0;
static const double leastGroundFraction = 0.0001;
static const double leastGroundGain = 2.0;
static const double coarseShare = 0.5;
static const double sizeStep = 1.1892071150027210; // ⁴√2
static const double largestShare = 0.25;           // of the longest side

// A landscape covers nearly all columns of its bounds, most of them once, and has no walls: columns
// of which it fills more than half.
static const double leastCoverage = 0.84;
static const double mostRuns = 1.15;
static const double mostWalls = 0.01;

// One grid of the search, the surface alone within a margin.
typedef struct Level {
    pvtBitGrid surface;
    double volume;  // [vx] of its bounds
    double longest; // [vx] side of its bounds
    double needed;  // [vx] room that makes a remedy worth telling
    bool isExact;   // the grid itself, not a coarser copy
} Level;

static double GetLongest(const pvtGridBox* box)
{
    double longest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        longest = fmax(longest, box->upper[axis] - box->lower[axis]);
    }
    return longest;
}

// Every second voxel is set when one of the eight in its place is.
static uint64_t HalveWord(uint64_t low, uint64_t high)
{
    uint64_t halves[2] = {low, high};
    for (int i = 0; i < 2; ++i) {
        uint64_t bits = (halves[i] | halves[i] >> 1) & UINT64_C(0x5555555555555555);
        bits = (bits | bits >> 1) & UINT64_C(0x3333333333333333);
        bits = (bits | bits >> 2) & UINT64_C(0x0F0F0F0F0F0F0F0F);
        bits = (bits | bits >> 4) & UINT64_C(0x00FF00FF00FF00FF);
        bits = (bits | bits >> 8) & UINT64_C(0x0000FFFF0000FFFF);
        halves[i] = (bits | bits >> 16) & UINT64_C(0x00000000FFFFFFFF);
    }
    return halves[0] | halves[1] << 32;
}

static pvtStatus HalveGrid(pvtContext* context, const pvtBitGrid* grid, pvtBitGrid* half)
{
    pvtGridFrame frame = {grid->frame.origin, 2.0 * grid->frame.voxelSize, {0, 0, 0}};
    for (int axis = 0; axis < 3; ++axis) {
        frame.size[axis] = (grid->frame.size[axis] + 1) / 2;
    }
    const pvtStatus status = pvtCreateBitGrid(context, &frame, half);
    if (status != PVT_OK) {
        return status;
    }
    for (int z = 0; z < grid->frame.size[2]; ++z) {
        if (z % CANCEL_INTERVAL == 0 && pvtIsCancelled(context)) {
            pvtBitGrid_Free(context, half);
            return pvtFailCancelled(context);
        }
        for (int y = 0; y < grid->frame.size[1]; ++y) {
            const uint64_t* from = pvtBitGrid_GetRow(grid, y, z);
            uint64_t* row = pvtBitGrid_GetRow(half, y / 2, z / 2);
            for (size_t i = 0; i < grid->wordsPerRow; i += 2) {
                const uint64_t high = i + 1 < grid->wordsPerRow ? from[i + 1] : 0;
                row[i / 2] |= HalveWord(from[i], high);
            }
        }
    }
    return PVT_OK;
}

// The surface cut to its bounds and a margin, so that padding costs nothing.
static pvtStatus CutToBounds(pvtContext* context, const pvtBitGrid* surface, pvtBitGrid* cut)
{
    pvtGridBox box;
    pvtBitGrid_FindBounds(surface, &box);
    int offset[3];
    int size[3];
    for (int axis = 0; axis < 3; ++axis) {
        offset[axis] = MARGIN - box.lower[axis];
        size[axis] = box.upper[axis] - box.lower[axis] + 2 * MARGIN;
    }
    return pvtMoveBitGrid(context, surface, offset, size, cut);
}

static pvtStatus MakeLevel(pvtContext* context, const pvtBitGrid* surface, double mostSide,
                           double neededFraction, Level* level)
{
    *level = (Level){.isExact = true};
    pvtStatus status = CutToBounds(context, surface, &level->surface);
    pvtGridBox box = {{0, 0, 0}, {0, 0, 0}};
    while (status == PVT_OK) {
        pvtBitGrid_FindBounds(&level->surface, &box);
        if (GetLongest(&box) <= mostSide) {
            break;
        }
        level->isExact = false;
        pvtBitGrid half;
        status = HalveGrid(context, &level->surface, &half);
        pvtBitGrid_Free(context, &level->surface);
        level->surface = half;
    }
    level->longest = GetLongest(&box);
    level->volume = pvtGridBox_GetVolume(&box);
    level->needed = neededFraction * level->volume * (level->isExact ? 1.0 : coarseShare);
    return status;
}

static pvtStatus CountInside(pvtContext* context, const pvtSolidOptions* options,
                             const pvtBitGrid* surface, double* strict)
{
    pvtBitGrid inside;
    const pvtStatus status = pvtFindInside(context, options, surface, &inside);
    if (status == PVT_OK) {
        *strict = (double)(pvtBitGrid_Count(&inside) - pvtBitGrid_Count(surface));
        pvtBitGrid_Free(context, &inside);
    }
    return status;
}

// What neither the flood reached nor the wider ball may enter: the centres of balls locked in.
static void KeepLocked(const pvtBitGrid* reached, pvtBitGrid* blocked)
{
    for (size_t i = 0; i < blocked->wordCount; ++i) {
        blocked->words[i] |= reached->words[i];
    }
    pvtBitGrid_Complement(blocked);
}

static bool AnySet(const pvtBitGrid* grid)
{
    pvtGridBox box;
    return pvtBitGrid_FindBounds(grid, &box);
}

// How a ball and a half wider one meet a surface.
typedef struct Balls {
    uint32_t squares[2]; // [vx²] of the radii
    pvtAxis up;
    int groundLayer; // neither may enter the layers below
} Balls;

// The voxels that the centre of one of the balls may not enter.
static pvtStatus FindBlocked(pvtContext* context, const pvtBitGrid* surface, const Balls* balls,
                             int ball, pvtBitGrid* blocked)
{
    const pvtStatus status = pvtDilateGrid(context, surface, balls->squares[ball], blocked);
    if (status == PVT_OK) {
        pvtBitGrid_SetLayers(blocked, balls->up, 0, balls->groundLayer);
    }
    return status;
}

// The room [vx] that balls around the centres cover above the ground.
static pvtStatus CountCovered(pvtContext* context, const pvtBitGrid* centers, const Balls* balls,
                              double* room)
{
    pvtBitGrid covered;
    const pvtStatus status = pvtDilateGrid(context, centers, balls->squares[1], &covered);
    if (status == PVT_OK) {
        pvtBitGrid_SetLayers(&covered, balls->up, 0, balls->groundLayer);
        const int* size = covered.frame.size;
        const double layer = (double)size[0] * size[1] * size[2] / size[balls->up];
        *room = (double)pvtBitGrid_Count(&covered) - layer * balls->groundLayer;
        pvtBitGrid_Free(context, &covered);
    }
    return status;
}

// The room of locked places in a surface with margin enough for both balls.
static pvtStatus MeasureRoomPadded(pvtContext* context, const pvtBitGrid* surface,
                                   const Balls* balls, double* room)
{
    pvtBitGrid blocked = {0};
    pvtBitGrid wide = {0};
    pvtBitGrid reached = {0};
    pvtStatus status = FindBlocked(context, surface, balls, 0, &blocked);
    if (status == PVT_OK) {
        status = pvtCreateBitGrid(context, &surface->frame, &reached);
    }
    if (status == PVT_OK) {
        status = pvtFloodFromBorder(context, &blocked, &reached);
    }
    if (status == PVT_OK) {
        KeepLocked(&reached, &blocked);
        status = AnySet(&blocked) ? FindBlocked(context, surface, balls, 1, &wide) : PVT_OK;
    }
    pvtBitGrid_Free(context, &blocked);
    if (status == PVT_OK && wide.words != NULL) {
        KeepLocked(&reached, &wide);
        status = AnySet(&wide) ? CountCovered(context, &wide, balls, room) : PVT_OK;
    }
    pvtBitGrid_Free(context, &wide);
    pvtBitGrid_Free(context, &reached);
    return status;
}

static pvtStatus MeasureRoom(pvtContext* context, const pvtSolidOptions* options,
                             const Level* level, double diameter, double* room)
{
    const pvtBitGrid* surface = &level->surface;
    const double wide = fmax(roomFactor * diameter, diameter + MORE_ROOM);
    const double unit = 0.5 * surface->frame.voxelSize;
    const int margin = (int)ceil(0.5 * diameter) + 1;
    const Balls balls = {{pvtGetSquaredReach(&surface->frame, diameter * unit),
                          pvtGetSquaredReach(&surface->frame, wide * unit)},
                         options->up,
                         options->ground ? MARGIN + margin : 0};
    const int offset[3] = {margin, margin, margin};
    const int size[3] = {surface->frame.size[0] + 2 * margin, surface->frame.size[1] + 2 * margin,
                         surface->frame.size[2] + 2 * margin};
    pvtBitGrid padded;
    *room = 0.0;
    pvtStatus status = pvtMoveBitGrid(context, surface, offset, size, &padded);
    if (status == PVT_OK) {
        status = MeasureRoomPadded(context, &padded, &balls, room);
        pvtBitGrid_Free(context, &padded);
    }
    return status;
}

// The least diameter [vx] from `from` on that locks enough room; 0 when none does.
static pvtStatus FindDiameter(pvtContext* context, const pvtSolidOptions* options,
                              const Level* level, double from, double* diameter)
{
    *diameter = 0.0;
    const double most = largestShare * level->longest;
    for (double tried = fmax(from, SMALLEST_BALL); tried <= most; tried *= sizeStep) {
        double room;
        const pvtStatus status = MeasureRoom(context, options, level, tried, &room);
        if (status != PVT_OK) {
            return status;
        }
        if (room >= level->needed) {
            *diameter = tried;
            return PVT_OK;
        }
    }
    return PVT_OK;
}

// Up to two digits, so that people can read and repeat it.
static double RoundUp(double value)
{
    const double unit = pow(10.0, floor(log10(value)) - 1.0);
    return ceil(value / unit - 1e-6) * unit;
}

// A larger ball reaches less. So when even the largest leaves too little inside, none does.
static pvtStatus CanAnyBallHelp(pvtContext* context, const pvtSolidOptions* options,
                                const Level* level, bool* can)
{
    pvtSolidOptions largest = *options;
    largest.smallestHole = largestShare * level->longest * level->surface.frame.voxelSize;
    *can = false;
    if (largest.smallestHole <= options->smallestHole) {
        return PVT_OK;
    }
    double strict = 0.0;
    const pvtStatus status = CountInside(context, &largest, &level->surface, &strict);
    *can = strict >= level->needed;
    return status;
}

// The size [wu] that one level gives, looking from *hole [wu] on; 0 when none does. `isCertain`
// when a finer level would not tell much more.
static pvtStatus FindHoleAtLevel(pvtContext* context, const pvtSolidOptions* options,
                                 const Level* level, double* hole, bool* isCertain)
{
    const double voxelSize = level->surface.frame.voxelSize;
    double diameter;
    const pvtStatus status = FindDiameter(context, options, level, *hole / voxelSize, &diameter);
    *isCertain = level->isExact || diameter == 0.0 || diameter >= EXACT_ENOUGH;
    // The touched voxels make an opening narrower than the surface has it: by one voxel, and by
    // up to two when they are coarse.
    const double more = level->isExact ? 1.0 : 2.0;
    *hole = diameter > 0.0 ? (diameter + more) * voxelSize : 0.0;
    return status;
}

static pvtStatus FindHole(pvtContext* context, const pvtSolidOptions* options,
                          const pvtBitGrid* surface, double neededFraction, double* smallestHole)
{
    double hole = 0.0;
    double from = options->smallestHole;
    bool isDone = false;
    for (int side = COARSE_SIDE; side <= FINE_SIDE && !isDone; side *= 2) {
        Level level;
        pvtStatus status = MakeLevel(context, surface, side, neededFraction, &level);
        bool can = true;
        if (status == PVT_OK && side == COARSE_SIDE) {
            status = CanAnyBallHelp(context, options, &level, &can);
        }
        if (status == PVT_OK && can) {
            hole = from;
            status = FindHoleAtLevel(context, options, &level, &hole, &isDone);
        }
        isDone = isDone || !can;
        // Both the size found and what was added to it may be two voxels too large.
        from = fmax(options->smallestHole, hole - 4.0 * level.surface.frame.voxelSize);
        pvtBitGrid_Free(context, &level.surface);
        if (status != PVT_OK) {
            return status;
        }
    }
    *smallestHole = hole > 0.0 ? RoundUp(hole) : 0.0;
    return PVT_OK;
}

static bool IsLandscape(const pvtBitGrid* surface, const pvtGridBox* box, pvtAxis up)
{
    const int height = box->upper[up] - box->lower[up];
    const double columns = pvtGridBox_GetVolume(box) / height;
    const pvtColumnStats stats = pvtCountColumns(surface, up, height / 2 + 1);
    const double touched = (double)stats.touched;
    return touched >= leastCoverage * columns && (double)stats.runs <= mostRuns * touched &&
           (double)stats.tall <= mostWalls * touched;
}

static pvtStatus TryOption(pvtContext* context, const pvtSolidOptions* options,
                           const pvtBitGrid* surface, double needed, bool* helps)
{
    double strict = 0.0;
    const pvtStatus status = CountInside(context, options, surface, &strict);
    *helps = status == PVT_OK && strict >= needed;
    return status;
}

// The voxels inside with a remedy that may close large holes, on a coarse copy: on a grid of 256 a
// ball of 40 voxels takes a tenth of a second, and on one of 2,048 an hour. Coarse voxels at the
// surface count as outside, which what is hollow has few of beside its inside.
static pvtStatus EstimateInside(pvtContext* context, const pvtSolidOptions* options,
                                const pvtBitGrid* surface, double* strict)
{
    Level level;
    pvtStatus status = MakeLevel(context, surface, ESTIMATE_SIDE, 0.0, &level);
    if (status == PVT_OK) {
        status = CountInside(context, options, &level.surface, strict);
        *strict *= pow(level.surface.frame.voxelSize / surface->frame.voxelSize, 3.0);
    }
    pvtBitGrid_Free(context, &level.surface);
    return status;
}

// An option by itself costs one flood, so it is tried on the grid itself.
static pvtStatus TryGround(pvtContext* context, const pvtSolidOptions* options,
                           const pvtBitGrid* surface, double needed, pvtRemedy* remedy)
{
    pvtSolidOptions tried = *options;
    tried.ground = true;
    return options->ground ? PVT_OK : TryOption(context, &tried, surface, needed, &remedy->ground);
}

static pvtStatus TryTerrain(pvtContext* context, const pvtSolidOptions* options,
                            const pvtBitGrid* surface, double needed, pvtRemedy* remedy)
{
    pvtGridBox box;
    if (options->terrain || !pvtBitGrid_FindBounds(surface, &box) ||
        !IsLandscape(surface, &box, options->up)) {
        return PVT_OK;
    }
    pvtSolidOptions tried = *options;
    tried.terrain = true;
    return TryOption(context, &tried, surface, needed, &remedy->terrain);
}

static bool IsFound(const pvtRemedy* remedy)
{
    return remedy->smallestHole > 0.0 || remedy->ground || remedy->terrain;
}

static pvtStatus FindNextRemedy(pvtContext* context, const pvtSolidOptions* options,
                                const pvtBitGrid* surface, double strictCount, pvtRemedy* remedy)
{
    *remedy = (pvtRemedy){0};
    pvtGridBox box;
    if (!pvtBitGrid_FindBounds(surface, &box)) {
        return PVT_OK;
    }
    const double volume = pvtGridBox_GetVolume(&box);
    const double touched = (double)pvtBitGrid_Count(surface) / volume;
    const double needed = fmax(leastFraction, leastGain * strictCount / volume);
    const double ofGround = fmax(leastGroundFraction, leastGroundGain * strictCount / volume);
    pvtStatus status = PVT_OK;
    if (ofGround <= 1.0 - touched) {
        status = TryGround(context, options, surface, ofGround * volume, remedy);
    }
    if (status != PVT_OK || IsFound(remedy) || needed > 1.0 - touched) {
        return status;
    }
    status = FindHole(context, options, surface, needed, &remedy->smallestHole);
    if (status == PVT_OK && !IsFound(remedy)) {
        status = TryTerrain(context, options, surface, needed * volume, remedy);
    }
    if (status == PVT_OK && !IsFound(remedy) && !options->ground) {
        pvtSolidOptions both = *options;
        both.ground = true;
        status = FindHole(context, &both, surface, needed, &remedy->smallestHole);
        remedy->ground = remedy->smallestHole > 0.0;
    }
    if (status != PVT_OK) {
        *remedy = (pvtRemedy){0};
    }
    return status;
}

static void Apply(const pvtRemedy* remedy, pvtSolidOptions* options)
{
    options->smallestHole = fmax(options->smallestHole, remedy->smallestHole);
    options->ground = options->ground || remedy->ground;
    options->terrain = options->terrain || remedy->terrain;
}

// What is hollow with the first remedy, too, would ask for the next one when it is run again: they
// are looked for at once, as long as each fills several times as much as the one before.
pvtStatus pvtFindRemedy(pvtContext* context, const pvtSolidOptions* options,
                        const pvtBitGrid* surface, uint64_t strictCount, pvtRemedy* remedy)
{
    *remedy = (pvtRemedy){0};
    pvtSolidOptions tried = *options;
    double strict = (double)strictCount;
    bool isMore = true;
    pvtStatus status = PVT_OK;
    for (int round = 0; round < MOST_ROUNDS && isMore && status == PVT_OK; ++round) {
        pvtRemedy next;
        status = FindNextRemedy(context, &tried, surface, strict, &next);
        isMore = status == PVT_OK && IsFound(&next) && (round == 0 || !next.terrain);
        if (isMore) {
            Apply(&next, &tried);
            remedy->smallestHole = fmax(remedy->smallestHole, next.smallestHole);
            remedy->ground = remedy->ground || next.ground;
            remedy->terrain = next.terrain;
            isMore = !next.terrain;
            status = EstimateInside(context, &tried, surface, &strict);
        }
    }
    if (status != PVT_OK && status != PVT_LIMIT) {
        *remedy = (pvtRemedy){0};
    }
    // The solid is whole without it, and a remedy is one without the next.
    return status == PVT_LIMIT ? PVT_OK : status;
}
