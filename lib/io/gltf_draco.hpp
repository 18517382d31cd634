// SPDX-License-Identifier: MIT
// KHR_draco_mesh_compression: which primitives have it, what their accessors say of it, and the
// accessors with what was decoded behind them.
#ifndef PVT_IO_GLTF_DRACO_HPP
#define PVT_IO_GLTF_DRACO_HPP

#include "draco_process.hpp"
#include "gltf_accessor.hpp"
#include "gltf_nodes.hpp"

#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace pvt
{

class GltfDraco
{
  public:
    /// Decodes what is compressed in the instances' meshes, all at once. Where the decoder is not
    /// installed but the file has the same uncompressed, that is taken, with a warning.
    GltfDraco(const GltfFile& file, const std::vector<GltfInstance>& instances);

    /// Whether the primitive's data comes from here.
    bool Has(std::size_t mesh, std::size_t primitive) const
    {
        return result_ != nullptr && streams_.count({mesh, primitive}) != 0;
    }
    /// Of a primitive that Has(): its indices, three a triangle.
    GltfAccessor OpenIndices(std::size_t mesh, std::size_t primitive) const;
    /// The same for an attribute; none when it is not among what is compressed.
    std::optional<GltfAccessor> OpenAttribute(std::size_t mesh, std::size_t primitive,
                                              const std::string& name) const;

  private:
    using Place = std::pair<std::size_t, std::size_t>; // mesh, primitive
    struct Entry {
        std::size_t stream;
        std::vector<std::string> names; // of the attributes, in the order of the stream's ids
        bool isOptional;                // the same is there uncompressed
    };

    void AddMesh(std::size_t mesh);
    void AddPrimitive(const Place& place, const Json& extension);
    void ChooseAttributes(const tinygltf::Primitive& primitive, const Json& attributes,
                          Entry& entry, DracoStream& stream) const;
    void CheckClaims(const tinygltf::Primitive& primitive, const DracoStream& stream) const;
    void CheckIndexType(const tinygltf::Primitive& primitive, const DracoStream& stream) const;
    void CheckFit(const Place& place, const Entry& entry) const;
    void Decode();
    const tinygltf::Primitive& Find(const Place& place) const;

    const GltfFile& file_;
    std::map<Place, Entry> streams_;
    std::vector<DracoStream> wanted_;
    std::unique_ptr<DracoResult> result_;
};

} // namespace pvt

#endif
