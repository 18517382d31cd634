// SPDX-License-Identifier: MIT
// KHR_draco_mesh_compression, as ratified. What a stream's header claims (Draco bitstream 2.2,
// sections 4 and 8) is held against the accessors before anything is decoded.
#include "gltf_draco.hpp"

#include "gltf_range.hpp"

#include <cstring>

namespace pvt
{

namespace
{

constexpr const char* kName = "KHR_draco_mesh_compression";
constexpr std::size_t kHeaderSize = 11;
constexpr std::uint8_t kTriangularMesh = 1, kSequential = 0;
constexpr std::uint16_t kHasMetadata = 0x8000;

// Counts that a header tells; nothing where it does not.
struct Claims {
    std::optional<std::uint64_t> points, faces;
};

// LEB128, as Draco writes its counts.
std::optional<std::uint64_t> ReadVarint(const Span& bytes, std::size_t& at)
{
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35 && at < bytes.size; shift += 7) {
        const std::uint8_t byte = bytes.bytes[at++];
        value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
        if ((byte & 0x80) == 0) {
            return value;
        }
    }
    return {};
}

// Older bitstreams, and those with metadata, count elsewhere: the decoder sees to them.
Claims ReadClaims(const pvtLoadJob& job, const DracoStream& stream)
{
    const Span& bytes = stream.bytes;
    if (bytes.size < kHeaderSize || std::memcmp(bytes.bytes, "DRACO", 5) != 0) {
        Refuse(job, "%s: its buffer view holds no Draco data", stream.place.c_str());
    }
    if (bytes.bytes[7] != kTriangularMesh) {
        Refuse(job, "%s: its data is a point cloud, not a mesh", stream.place.c_str());
    }
    const unsigned version = bytes.bytes[5] * 256u + bytes.bytes[6];
    const unsigned flags = bytes.bytes[9] + 256u * bytes.bytes[10];
    Claims claims;
    if (version != 0x0202 || (flags & kHasMetadata) != 0) {
        return claims;
    }
    std::size_t at = kHeaderSize;
    if (bytes.bytes[8] == kSequential) {
        claims.faces = ReadVarint(bytes, at);
        claims.points = ReadVarint(bytes, at);
    } else {
        ++at;                        // how the edges are traversed
        (void)ReadVarint(bytes, at); // positions, which several points may share
        claims.faces = ReadVarint(bytes, at);
    }
    return claims;
}

std::size_t GetAccessorCount(const GltfFile& file, int accessor)
{
    return file.model.accessors[static_cast<std::size_t>(accessor)].count;
}

bool HasView(const GltfFile& file, int accessor)
{
    const int view = file.model.accessors[static_cast<std::size_t>(accessor)].bufferView;
    return static_cast<std::size_t>(view) < GetCount(file.document, "bufferViews");
}

const char* GetAlphaMode(const GltfFile& file, const tinygltf::Primitive& primitive)
{
    return primitive.material < 0
               ? ""
               : file.model.materials[static_cast<std::size_t>(primitive.material)]
                     .alphaMode.c_str();
}

} // namespace

GltfDraco::GltfDraco(const GltfFile& file, const std::vector<GltfInstance>& instances) : file_(file)
{
    std::vector<char> seen(file.model.meshes.size(), 0);
    for (const GltfInstance& instance : instances) {
        if (seen[instance.mesh] == 0) {
            seen[instance.mesh] = 1;
            AddMesh(instance.mesh);
        }
    }
    if (!wanted_.empty()) {
        Decode();
    }
}

const tinygltf::Primitive& GltfDraco::Find(const Place& place) const
{
    return file_.model.meshes[place.first].primitives[place.second];
}

void GltfDraco::AddMesh(std::size_t mesh)
{
    const Json& primitives = file_.document["meshes"][mesh]["primitives"];
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const Json* extension = FindExtension(primitives[i], kName);
        const tinygltf::Primitive& primitive = Find({mesh, i});
        // Points and lines, and what is left out anyhow, need not be decoded.
        if (extension != nullptr && primitive.mode >= TINYGLTF_MODE_TRIANGLES &&
            primitive.attributes.count("POSITION") != 0 &&
            std::strcmp(GetAlphaMode(file_, primitive), "BLEND") != 0) {
            AddPrimitive({mesh, i}, *extension);
        }
    }
}

void GltfDraco::AddPrimitive(const Place& place, const Json& extension)
{
    const tinygltf::Primitive& primitive = Find(place);
    Entry entry{wanted_.size(), {}, false};
    DracoStream stream;
    stream.place = GetGltfPlace(place.first, place.second) + ".extensions." + kName;
    if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        Refuse(file_.job, "%s: the primitive's mode is 6, a fan; Draco holds lists and strips",
               stream.place.c_str());
    }
    const int positions = primitive.attributes.at("POSITION");
    entry.isOptional =
        HasView(file_, positions) && (primitive.indices < 0 || HasView(file_, primitive.indices));
    stream.bytes = file_.data.GetView(file_.document, extension["bufferView"].get<std::size_t>());
    stream.pointCount = GetAccessorCount(file_, positions);
    stream.faceCount = PVT_DRACO_ANY;
    // A strip's indices are counted otherwise than the triangles that it is stored as.
    if (primitive.indices >= 0 && primitive.mode == TINYGLTF_MODE_TRIANGLES) {
        const std::size_t count = GetAccessorCount(file_, primitive.indices);
        stream.faceCount = count / 3;
        if (count % 3 != 0) {
            Refuse(file_.job, "%s: accessors[%d] counts %zu indices, which make no whole triangles",
                   stream.place.c_str(), primitive.indices, count);
        }
    }
    ChooseAttributes(primitive, extension["attributes"], entry, stream);
    CheckClaims(primitive, stream);
    wanted_.push_back(std::move(stream));
    streams_.emplace(place, std::move(entry));
}

// Positions, and of masked materials what decides how their texture lies on them.
void GltfDraco::ChooseAttributes(const tinygltf::Primitive& primitive, const Json& attributes,
                                 Entry& entry, DracoStream& stream) const
{
    const bool masked = std::strcmp(GetAlphaMode(file_, primitive), "MASK") == 0;
    for (auto it = attributes.begin(); it != attributes.end(); ++it) {
        const std::string& name = it.key();
        const auto listed = primitive.attributes.find(name);
        if (listed == primitive.attributes.end()) {
            Refuse(file_.job, "%s.attributes.%s is not among the primitive's attributes",
                   stream.place.c_str(), Clean(name).c_str());
        }
        const std::size_t count = GetAccessorCount(file_, listed->second);
        if (count != stream.pointCount) {
            Refuse(file_.job,
                   "%s.attributes.%s: accessors[%d] counts %zu elements, but %zu are "
                   "positions",
                   stream.place.c_str(), Clean(name).c_str(), listed->second, count,
                   static_cast<std::size_t>(stream.pointCount));
        }
        if (name == "POSITION" ||
            (masked && (name == "COLOR_0" || name.rfind("TEXCOORD_", 0) == 0))) {
            entry.names.push_back(name);
            stream.ids.push_back(it->get<std::uint32_t>());
        }
    }
    if (attributes.find("POSITION") == attributes.end() &&
        !HasView(file_, primitive.attributes.at("POSITION"))) {
        Refuse(file_.job, "%s.attributes has no POSITION, and its accessor has no data",
               stream.place.c_str());
    }
}

void GltfDraco::CheckIndexType(const tinygltf::Primitive& primitive,
                               const DracoStream& stream) const
{
    if (primitive.indices < 0) {
        return;
    }
    const int type =
        file_.model.accessors[static_cast<std::size_t>(primitive.indices)].componentType;
    const std::uint64_t most = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1u << 8
                               : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 1u << 16
                               : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT   ? UINT32_MAX
                                                                                : 0;
    if (stream.pointCount > most) {
        Refuse(file_.job,
               "%s has %zu points, which indices of accessors[%d].componentType %d "
               "cannot name",
               stream.place.c_str(), static_cast<std::size_t>(stream.pointCount), primitive.indices,
               type);
    }
}

void GltfDraco::CheckClaims(const tinygltf::Primitive& primitive, const DracoStream& stream) const
{
    const char* place = stream.place.c_str();
    const Claims claims = ReadClaims(file_.job, stream);
    if (claims.faces && stream.faceCount != PVT_DRACO_ANY && *claims.faces != stream.faceCount) {
        Refuse(file_.job,
               "%s says that it holds %zu triangles, but accessors[%d] counts %zu "
               "indices",
               place, static_cast<std::size_t>(*claims.faces), primitive.indices,
               static_cast<std::size_t>(3 * stream.faceCount));
    }
    if (claims.points && *claims.points != stream.pointCount) {
        Refuse(file_.job, "%s says that it holds %zu points, but accessors[%d] counts %zu", place,
               static_cast<std::size_t>(*claims.points), primitive.attributes.at("POSITION"),
               static_cast<std::size_t>(stream.pointCount));
    }
    CheckIndexType(primitive, stream);
    // The mesh that comes of it: three positions and three indices a triangle, at the most, with
    // what the decoder's process hands over.
    const std::uint64_t faces =
        stream.faceCount != PVT_DRACO_ANY ? stream.faceCount : claims.faces.value_or(0);
    const std::string purpose = std::string(file_.job.path) + ": " + stream.place;
    const std::uint64_t bytes = faces * 24 + stream.pointCount * (sizeof(pvtVec3) + 16);
    Check(pvtCheckMemory(file_.job.context, bytes, purpose.c_str()));
}

void GltfDraco::Decode()
{
    try {
        result_ = std::make_unique<DracoResult>(file_.job, wanted_);
    } catch (const Failure& failure) {
        bool optional = failure.status == PVT_UNSUPPORTED;
        for (const auto& [place, entry] : streams_) {
            optional = optional && entry.isOptional;
        }
        if (!optional) {
            throw;
        }
        Warn(file_.job, "%s is not supported here; the uncompressed copy beside it is taken",
             kName);
    }
    for (const auto& [place, entry] : streams_) {
        if (result_ != nullptr) {
            CheckFit(place, entry);
        }
    }
}

// The accessors have to describe what was decoded.
void GltfDraco::CheckFit(const Place& place, const Entry& entry) const
{
    const DracoStream& stream = wanted_[entry.stream];
    const tinygltf::Primitive& primitive = Find(place);
    for (std::size_t i = 0; i < entry.names.size(); ++i) {
        const DracoAttribute& found = result_->Mesh(entry.stream).attributes[i];
        const std::string name = stream.place + ".attributes." + Clean(entry.names[i]);
        const int index = primitive.attributes.at(entry.names[i]);
        const tinygltf::Accessor& accessor = file_.model.accessors[static_cast<std::size_t>(index)];
        if (!found.isFound) {
            Refuse(file_.job, "%s is %u, but the data has no attribute of that id", name.c_str(),
                   stream.ids[i]);
        }
        const int count =
            tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
        if (found.componentType != accessor.componentType || found.componentCount != count) {
            Refuse(file_.job, "%s: its data has %d components of %s, but accessors[%d] %d of %s",
                   name.c_str(), found.componentCount, GetGltfComponentName(found.componentType),
                   index, count, GetGltfComponentName(accessor.componentType));
        }
    }
}

GltfAccessor GltfDraco::OpenIndices(std::size_t mesh, std::size_t primitive) const
{
    const Span& bytes = result_->Mesh(streams_.at({mesh, primitive}).stream).indices;
    return GltfAccessor(GetGltfPlace(mesh, primitive) + ".indices", bytes);
}

std::optional<GltfAccessor> GltfDraco::OpenAttribute(std::size_t mesh, std::size_t primitive,
                                                     const std::string& name) const
{
    const Entry& entry = streams_.at({mesh, primitive});
    for (std::size_t i = 0; i < entry.names.size(); ++i) {
        if (entry.names[i] == name) {
            const int accessor = Find({mesh, primitive}).attributes.at(name);
            return GltfAccessor(file_, static_cast<std::size_t>(accessor),
                                result_->Mesh(entry.stream).attributes[i].bytes);
        }
    }
    return {};
}

} // namespace pvt
