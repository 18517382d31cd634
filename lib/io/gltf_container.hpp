// SPDX-License-Identifier: MIT
// The outermost layer of a glTF file: where its JSON lies, and where its binary chunk.
#ifndef PVT_IO_GLTF_CONTAINER_HPP
#define PVT_IO_GLTF_CONTAINER_HPP

#include "edge.hpp"

namespace pvt
{

/// Bytes that belong to somebody else.
struct Span {
    const std::uint8_t* bytes = nullptr;
    std::size_t size = 0;
};

struct GltfContainer {
    Span json;
    Span binary; ///< null bytes: there is none
};

/// Checks the header and every chunk's length of a GLB, and how deep the JSON nests.
GltfContainer OpenGltfContainer(const pvtLoadJob& job, const pvtSource& source);

} // namespace pvt

#endif
