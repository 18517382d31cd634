// SPDX-License-Identifier: MIT
// What is to be saved as glTF, before it is bytes.
#ifndef PVT_IO_GLTF_SAVE_HPP
#define PVT_IO_GLTF_SAVE_HPP

#include "edge.hpp"
#include "tinygltf.hpp"

namespace pvt
{

/// One node an item, in their order, all of them in the only scene; one buffer.
tinygltf::Model MakeGltfModel(const pvtSaveJob& job);

/// A GLB, or JSON that holds its buffer.
std::string SerializeGltf(pvtContext* context, const tinygltf::Model& model, bool binary);

} // namespace pvt

#endif
