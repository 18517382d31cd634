// SPDX-License-Identifier: MIT
// A model of the project's own as the library's mesh, for tests of the core, which reads no files.
#ifndef PVT_TEST_RECIPE_MESH_H
#define PVT_TEST_RECIPE_MESH_H

#include <paravent/mesh.h>

/// PVT_INVALID_ARGUMENT when there is no recipe of this name.
pvtStatus MakeRecipeMesh(pvtContext* context, const char* name, pvtMesh* mesh);

#endif
