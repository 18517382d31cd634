// SPDX-License-Identifier: MIT
// Triangles of glTF meshes, and which of their materials let light through.
#ifndef PVT_IO_GLTF_GEOMETRY_HPP
#define PVT_IO_GLTF_GEOMETRY_HPP

#include "builder.h"
#include "gltf_draco.hpp"
#include "gltf_mask.hpp"
#include "gltf_range.hpp"

namespace pvt
{

/// A mesh in its own space. Positions stand in the order of their first use.
struct GltfMesh {
    explicit GltfMesh(pvtContext* context) : positions(context), indices(context), cards(context)
    {
    }
    Array<pvtVec3> positions;
    Array<std::uint32_t> indices;
    Array<GltfCard> cards; // by rising triangle

    pvtLocalMesh View() const
    {
        return {positions.Data(), indices.Data(), positions.Size(), indices.Size() / 3};
    }
};

/// A mesh and how many instances of it are still to be placed.
struct UsedMesh {
    GltfMesh mesh;
    std::size_t uses;
};

/// Decodes meshes, and counts what it leaves out on the way.
class GltfDecoder
{
  public:
    GltfDecoder(const GltfFile& file, const GltfDraco& draco);

    GltfMesh Decode(std::size_t mesh);
    /// One warning for each kind of thing that was left out.
    void WarnOfOmissions() const;
    /// When nothing came of the file: says why. Returns when there was nothing left out.
    void RefuseIfAllOmitted() const;
    /// The same when there were masked surfaces, and no part of them was found to be opaque.
    void RefuseIfTransparent() const;

  private:
    /// Where a position came from: an element of a source.
    struct Origin {
        std::size_t source;
        std::uint32_t element;
    };
    /// A primitive's positions. Those that share an accessor have the same source.
    struct Positions {
        const GltfAccessor& accessor;
        std::size_t source;
        const GltfRange& range;
    };

    bool IsOmitted(const tinygltf::Primitive& primitive);
    bool IsMaskOmitted(const tinygltf::Primitive& primitive);
    std::optional<MaskedPrimitive> FindMask(std::size_t mesh, std::size_t index);
    void WarnOfMasks() const;
    void DecodePrimitive(std::size_t meshIndex, std::size_t index, GltfMesh& mesh);
    GltfAccessor OpenAttribute(std::size_t mesh, std::size_t primitive, const char* name) const;
    GltfAccessor OpenIndices(std::size_t mesh, std::size_t primitive) const;
    void CheckPositions(const GltfAccessor& positions, const std::string& place) const;
    void CheckIndices(const GltfAccessor& indices, const std::string& place) const;
    std::uint32_t AddPosition(const Positions& positions, std::uint32_t element, GltfMesh& mesh);

    const GltfFile& file_;
    const GltfDraco& draco_;
    GltfMasks masks_;
    bool quantized_;
    Array<std::uint32_t> places_; // by element: where it may be among the mesh's positions
    Array<Origin> origins_;       // one a position of the mesh
    std::size_t blended_ = 0, masked_ = 0, unplaced_ = 0, morphed_ = 0, drawn_ = 0; // primitives
    std::size_t unmapped_ = 0, judged_ = 0;
};

} // namespace pvt

#endif
