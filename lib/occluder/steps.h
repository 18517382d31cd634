// SPDX-License-Identifier: MIT
// The steps that a build is made of. Each reads what those before it left in the struct.
#ifndef PVT_OCCLUDER_STEPS_H
#define PVT_OCCLUDER_STEPS_H

#include <paravent/occluder.h>

/// What a build holds on its way; one place to free it.
typedef struct pvtBuild {
    const pvtBuildOptions* options;
    const pvtMesh* mesh;
    double started; ///< on pvtGetSeconds' clock
    pvtBuildStats stats;
    pvtBitGrid surface;
    pvtSolid solid;
    pvtBitGrid allowed;
    pvtCellGrid cells;          // allowed parts of other voxels         ///< where polygons may lie
    pvtSliceVolume volume;      ///< of `allowed`
    pvtSliceVolume solidVolume; ///< of the solid: what the paper's way slices
    pvtBox3 bounds;             ///< [wu] of the allowed voxels
    pvtSlicer slicer;
    bool hasSlicer;
    pvtSectionSet sections;
    pvtCandidateSet candidates;
    pvtViewSet views;
    pvtOccluder occluder;
} pvtBuild;

typedef pvtStatus pvtBuildStep(pvtContext* context, pvtBuild* build);

pvtStatus pvtResolveSizes(pvtContext* context, pvtBuild* build);
pvtStatus pvtVoxelizeStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtFillStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtSearchStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtChainStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtSelectStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtRefineStep(pvtContext* context, pvtBuild* build);
pvtStatus pvtCheckStep(pvtContext* context, pvtBuild* build);
void pvtBuild_Free(pvtContext* context, pvtBuild* build);

#endif
