// SPDX-License-Identifier: MIT
// Where saved meshes stand: as a node's translation, rotation and scale, or moved there.
#ifndef PVT_IO_PLACEMENT_H
#define PVT_IO_PLACEMENT_H

#include "formats.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Scaled, then rotated, then moved.
typedef struct pvtPlacement {
    double translation[3];
    double rotation[4]; ///< a unit quaternion: x, y, z, w
    double scale[3];    ///< at most one is negative
} pvtPlacement;

/// False when it takes more than that to make the transform: it has shear, or flattens.
bool pvtFindPlacement(const double transform[16], pvtPlacement* placement);

/// The items of a job as a writer takes them.
typedef struct pvtPlacedItems {
    pvtSaveItem* items;
    pvtMesh* meshes; ///< those that were moved; else empty
    size_t count;
} pvtPlacedItems;

/// Moves the meshes that the format cannot place by its nodes; `canPlace` tells whether it can
/// place any.
pvtStatus pvtPlaceItems(const pvtSaveJob* job, bool canPlace, pvtPlacedItems* placed);
void pvtPlacedItems_Free(pvtContext* context, pvtPlacedItems* placed);

#ifdef __cplusplus
}
#endif
#endif
