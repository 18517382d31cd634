// SPDX-License-Identifier: MIT
// The check of an occluder, triangle by triangle.
#ifndef PVT_OCCLUDER_CHECK_H
#define PVT_OCCLUDER_CHECK_H

#include <paravent/occluder.h>

/// As pvtCheckOccluder; `outside` has a count for each triangle, which ends at `enough`.
pvtStatus pvtCheckTriangles(pvtContext* context, const pvtInterior* interior, const pvtMesh* mesh,
                            uint64_t enough, uint64_t* outside);

#endif
