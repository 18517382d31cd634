// SPDX-License-Identifier: MIT
// Triangles of glTF meshes, and which of their materials let light through.
#ifndef PVT_IO_GLTF_GEOMETRY_HPP
#define PVT_IO_GLTF_GEOMETRY_HPP

#include "builder.h"
#include "gltf_accessor.hpp"

namespace pvt
{

/// A mesh in its own space. Positions stand in the order of their first use.
struct GltfMesh {
    explicit GltfMesh(pvtContext* context) : positions(context), indices(context)
    {
    }
    Array<pvtVec3> positions;
    Array<std::uint32_t> indices;

    pvtLocalMesh View() const
    {
        return {positions.Data(), indices.Data(), positions.Size(), indices.Size() / 3};
    }
};

/// Decodes meshes, and counts what it leaves out on the way.
class GltfDecoder
{
  public:
    explicit GltfDecoder(const GltfFile& file);

    GltfMesh Decode(std::size_t mesh);
    /// One warning for each kind of thing that was left out.
    void WarnOfOmissions() const;
    /// When nothing came of the file: says why. Returns when there was nothing left out.
    void RefuseIfAllOmitted() const;

  private:
    /// Where a position came from: an element of an accessor.
    struct Origin {
        std::size_t accessor;
        std::uint32_t element;
    };

    bool IsOmitted(const tinygltf::Primitive& primitive);
    void DecodePrimitive(const tinygltf::Primitive& primitive, const std::string& place,
                         GltfMesh& mesh);
    void CheckPositions(const GltfAccessor& positions, const std::string& place) const;
    void CheckIndices(const GltfAccessor& indices, const std::string& place) const;
    std::uint32_t AddPosition(const GltfAccessor& positions, std::size_t accessor,
                              std::uint32_t element, GltfMesh& mesh);

    const GltfFile& file_;
    bool quantized_;
    Array<std::uint32_t> places_; // by element: where it may be among the mesh's positions
    Array<Origin> origins_;       // one a position of the mesh
    std::size_t blended_ = 0, masked_ = 0, unplaced_ = 0, morphed_ = 0, drawn_ = 0; // primitives
};

} // namespace pvt

#endif
