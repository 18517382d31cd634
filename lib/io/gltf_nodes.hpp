// SPDX-License-Identifier: MIT
// Which meshes stand where: scenes, nodes, transforms.
#ifndef PVT_IO_GLTF_NODES_HPP
#define PVT_IO_GLTF_NODES_HPP

#include "gltf_accessor.hpp"

#include <array>

namespace pvt
{

using Transform = std::array<double, 16>; // column after column

struct GltfInstance {
    std::string name;
    std::size_t mesh;
    Transform transform; // mesh to world
};

/// Every instance of a mesh in the scene and below the node that the options name, in the order of
/// a walk that takes children in their file's order.
std::vector<GltfInstance> FindGltfInstances(const GltfFile& file);

} // namespace pvt

#endif
