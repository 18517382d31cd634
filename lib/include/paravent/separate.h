// SPDX-License-Identifier: MIT
// One occluder a mesh instead of one for everything: made once, and instanced as the mesh is.
#ifndef PARAVENT_SEPARATE_H
#define PARAVENT_SEPARATE_H

#include <paravent/occluder.h>

#ifdef __cplusplus
extern "C" {
#endif

/// What a mesh has to say when a budget is shared.
typedef struct pvtClaim {
    double possible;      ///< [wu³] what an instance could hide, in the mean; 0: nothing
    size_t instanceCount; ///< how often its triangles are drawn; at least 1
} pvtClaim;

/// Shares `budget` triangles, as they are drawn, so that Σ shares[i] × instanceCount ≤ budget.
/// First, from the largest claim down, everybody gets 2 as long as that fits, so that what is small
/// has an occluder too. What is left goes where a triangle hides most, on the assumption that t
/// triangles hide t ÷ (t + 8) of what is possible; shares then grow with the square root of the
/// claim. A claim of nothing, and one whose instances do not fit, gets 0.
PVT_API pvtStatus pvtShareBudget(pvtContext* context, const pvtClaim* claims, size_t count,
                                 int budget, int* shares);

/// Where a mesh stands.
typedef struct pvtInstance {
    size_t mesh;             ///< which of the meshes
    const double* transform; ///< 16 numbers, mesh to world, column after column; borrowed
    const char* name;        ///< for messages; may be null; borrowed
} pvtInstance;

typedef struct pvtInstanceSet {
    const pvtMesh* meshes; ///< each in its own space
    size_t meshCount;
    const pvtInstance* instances;
    size_t instanceCount;
} pvtInstanceSet;

typedef enum pvtSeparateResult {
    PVT_SEPARATE_MADE,     ///< there is an occluder
    PVT_SEPARATE_HOLLOW,   ///< the mesh has no inside: `reason` says what would help
    PVT_SEPARATE_NO_SHARE, ///< the budget is too small for all its instances
} pvtSeparateResult;

/// The occluder of a mesh.
typedef struct pvtSeparateOccluder {
    pvtSeparateResult result;
    pvtMesh mesh;         ///< in the space of the mesh that it is for; else empty
    size_t polygonCount;  ///< that its triangles make
    size_t source;        ///< the mesh that it is for: the first of those that are alike
    size_t firstInstance; ///< of those that take it
    size_t instanceCount; ///< that take it
    int budget;           ///< most triangles that it was given
    double scale;         ///< how much its instances stretch it, at most
    /// Lengths are those of the instance that stretches it most; measures are those of all
    /// instances together, `outside` and the rest those of the one build.
    pvtBuildStats stats;
    char* reason; ///< why there is none; null where there is
} pvtSeparateOccluder;

enum { PVT_NO_OCCLUDER = -1 };

typedef struct pvtSeparation {
    int budget;                     ///< that was shared
    pvtSeparateOccluder* occluders; ///< in the order of their first instances
    size_t count;
    /// For each instance the occluder that it takes, which may have come to nothing, or
    /// PVT_NO_OCCLUDER: the instance is flat.
    ptrdiff_t* ofInstance;
    size_t instanceCount;
} pvtSeparation;

/// One occluder for each different mesh that has instances: meshes that are alike to the last bit
/// count as one. Each is made in the space of its mesh, so that its instances can share it, and the
/// promise holds for each instance, as being inside does not depend on an affine transform.
///
/// `options` mean what they mean to pvtBuildOccluder, with these differences. The budget is shared
/// by pvtShareBudget; 0 stands for 16 triangles an instance of those whose mesh has an inside, but
/// at least 64 and at most 65535. The resolution is along each mesh's own longest side. Lengths in
/// world units hold for each instance: they are divided by the largest stretch. Where `ground`,
/// `terrain` or views from above ask for what is up, instances of a mesh that stand on different
/// sides count as different meshes; up is then the mesh's own axis that is nearest to it. Views
/// from a list are turned into the mesh's space for as many instances as 64 views allow. The
/// deadline is that of the whole.
///
/// Warnings name the instance. PVT_NOTHING_INSIDE when no mesh gets an occluder, PVT_INVALID_INPUT
/// when none has any extent.
PVT_API pvtStatus pvtBuildSeparateOccluders(pvtContext* context, const pvtBuildOptions* options,
                                            const pvtInstanceSet* set, pvtSeparation* separation);
PVT_API void pvtSeparation_Free(pvtContext* context, pvtSeparation* separation);

#ifdef __cplusplus
}
#endif
#endif
