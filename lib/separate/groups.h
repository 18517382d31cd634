// SPDX-License-Identifier: MIT
// Which instances share an occluder, and in what space and at what lengths it is made.
#ifndef PVT_SEPARATE_GROUPS_H
#define PVT_SEPARATE_GROUPS_H

#include <paravent/separate.h>

/// Instances that share an occluder.
typedef struct pvtGroup {
    size_t source;        ///< the first mesh of those that are alike
    size_t firstInstance; ///< those that are not flat
    size_t instanceCount;
    int up;                  ///< the source's axis that points up, and 3 more when it points down
    double scale;            ///< the largest stretch over the instances
    double volume;           ///< Σ |determinant|: what the instances do to measures
    pvtMesh mesh;            ///< the source turned so that `up` is up; empty: it is already
    pvtBuildOptions options; ///< in the source's own lengths
    pvtWeightedDirection* views; ///< of `options`; null: the options' own
} pvtGroup;

typedef struct pvtGroupSet {
    pvtGroup* groups;
    size_t count;
    ptrdiff_t* ofInstance;
} pvtGroupSet;

pvtStatus pvtGroupInstances(pvtContext* context, const pvtBuildOptions* options,
                            const pvtInstanceSet* set, pvtGroupSet* groups);
void pvtGroupSet_Free(pvtContext* context, pvtGroupSet* set);

/// The mesh that a group's occluder is made for.
const pvtMesh* pvtGroup_GetMesh(const pvtGroup* group, const pvtInstanceSet* set);
/// Turns an occluder's mesh back to the space of the group's source.
void pvtGroup_TurnBack(const pvtGroup* group, pvtMesh* mesh);

/// canonical[i] is the first mesh that is alike to mesh i, to the last bit; only those that
/// `isUsed` are looked at.
pvtStatus pvtFindAlikeMeshes(pvtContext* context, const pvtInstanceSet* set, const bool* isUsed,
                             size_t* canonical);

#endif
