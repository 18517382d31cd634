// SPDX-License-Identifier: MIT
// What the files of the ascent share.
#ifndef PVT_OCCLUDER_ASCENT_STATE_H
#define PVT_OCCLUDER_ASCENT_STATE_H

#include "ascent.h"
#include "contacts.h"
#include "pull.h"

#define PVT_ASCENT_INSET 0.5F ///< [px] as pvtPullOptions tells

typedef struct pvtAscent {
    const pvtAscentOptions* options;
    const pvtOccluder* occluder; ///< as it was selected
    pvtGridFrame frame;
    pvtTriangleSet set; ///< tagged by the polygons that they began as
    pvtField field;
    pvtSightSet sights;
    pvtPuller puller;
    pvtContactSet contacts;
    float (*speeds)[3];   ///< of each corner: the running mean of its pulls
    float* squares;       ///< of each corner: the running mean of their squares
    int32_t* moved;       ///< scratch, one a corner
    pvtTriangleSet start; ///< the first
    pvtTriangleSet best;  ///< of the climbs and cycles
    pvtTriangleSet rival; ///< the best before the last climb
    double bestWorth;
    int steps, allSteps; ///< that were taken, and that there are to be
    int contactAge;      ///< steps since contacts were looked for; 0: look for them
    size_t next;         ///< sight that comes next
    float softness;      ///< [px]
    float reach;         ///< [vx] of a step
    int iterations;      ///< steps of a climb
    float wrongCost;     ///< as pvtPullOptions tells
    double right, wrong; ///< what was hidden in the last steps, the later the more it counts
    bool isShell;        ///< most triangles are between walls, or were when they settled once
} pvtAscent;

/// Adds the mesh's positions [wu] to the corners of `set`, each anchored where it is.
void pvtAscent_AddCorners(pvtAscent* ascent, const pvtMesh* mesh);
/// `set` becomes one of the starts.
pvtStatus pvtAscent_TakeStart(pvtContext* context, pvtAscent* ascent, int start);
/// Where the mesh has no more triangles than the budget, `set` becomes these, wherever they lie.
/// `mesh` may be null.
pvtStatus pvtAscent_TakeMesh(pvtContext* context, const pvtMesh* mesh, pvtAscent* ascent,
                             bool* isTaken);
/// Takes away the least useful triangles, one after the other, until `count` are left.
void pvtAscent_Prune(pvtContext* context, pvtAscent* ascent, int count);
/// Adds up to `count` triangles to the edges behind which there is most to hide; they start as
/// slivers. Uses the puller's last pull, with its edges.
void pvtAscent_Grow(pvtAscent* ascent, int count);
/// Whether the inside is no deeper than a wall's around most of the area of `set`.
bool pvtAscent_IsBetweenWalls(const pvtAscent* ascent);
/// All climbs and cycles, from `set` as the first start; `set` is the best then, and inside.
pvtStatus pvtAscent_Climb(pvtContext* context, pvtAscent* ascent);
/// Pulls with the sights that come next, and moves all corners by a step.
void pvtAscent_Step(pvtContext* context, pvtAscent* ascent, bool wantsEdges);
/// Moves triangles inwards until the inside test finds each inside, and anchors them there.
/// Triangles that cannot be brought inside are taken away.
pvtStatus pvtAscent_Settle(pvtContext* context, pvtAscent* ascent);
/// Of a mesh that is inside, moves corners towards their goals [vx], as far as it stays there.
pvtStatus pvtAscent_Return(pvtContext* context, pvtAscent* ascent, const float (*goals)[3]);
/// Moves the corners of a mesh that is inside by a few more steps, as far as it stays there.
pvtStatus pvtAscent_Polish(pvtContext* context, pvtAscent* ascent);

/// [wu] as files store it.
pvtVec3 pvtAscent_GetPlace(const pvtAscent* ascent, const float corner[3]);
/// [vx] of a triangle as it will be read: rounded to what files store.
void pvtAscent_GetTriangle(const pvtAscent* ascent, int triangle, pvtVec3 corners[3]);

#endif
