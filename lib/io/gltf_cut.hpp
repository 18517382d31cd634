// SPDX-License-Identifier: MIT
// Masked triangles of meshes to ordinary ones.
#ifndef PVT_IO_GLTF_CUT_HPP
#define PVT_IO_GLTF_CUT_HPP

#include "gltf_geometry.hpp"
#include "gltf_nodes.hpp"

namespace pvt
{

/// Replaces every card of the meshes by what is opaque of it, as closely as the options ask for;
/// less closely, with a warning, where that would be millions of triangles.
void CutMaskedMeshes(const GltfFile& file, const std::vector<GltfInstance>& instances,
                     std::map<std::size_t, UsedMesh>& meshes);

} // namespace pvt

#endif
