// SPDX-License-Identifier: MIT
// Primitives to triangles: glTF 2.0, sections 3.7.2 and 5.24; KHR_mesh_quantization.
#include "gltf_geometry.hpp"

#include <algorithm>

namespace pvt
{

namespace
{

constexpr std::size_t kPollTriangles = 1 << 16;

// The corners of triangle t, as places in the list of indices.
struct Corners {
    std::size_t a, b, c;
};

Corners GetCorners(int mode, std::size_t t)
{
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        return {t, t + 1 + t % 2, t + 2 - t % 2};
    }
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        return {t + 1, t + 2, 0};
    }
    return {3 * t, 3 * t + 1, 3 * t + 2};
}

// Indices that make no whole triangle are not drawn.
std::size_t CountTriangles(int mode, std::size_t indexCount)
{
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        return indexCount / 3;
    }
    return indexCount < 3 ? 0 : indexCount - 2;
}

} // namespace

GltfDecoder::GltfDecoder(const GltfFile& file)
    : file_(file),
      quantized_(IsExtensionListed(file.document, "extensionsUsed", "KHR_mesh_quantization") ||
                 IsExtensionListed(file.document, "extensionsRequired", "KHR_mesh_quantization")),
      places_(file.job.context), origins_(file.job.context)
{
}

bool GltfDecoder::IsOmitted(const tinygltf::Primitive& primitive)
{
    // Valid, and nothing that could be seen.
    if (primitive.attributes.count("POSITION") == 0) {
        ++unplaced_;
        return true;
    }
    if (primitive.material < 0) {
        return false;
    }
    const auto& material = file_.model.materials[static_cast<std::size_t>(primitive.material)];
    const bool blended = material.alphaMode == "BLEND";
    const bool masked =
        material.alphaMode == "MASK" && file_.job.options->masked != PVT_MASKED_OPAQUE;
    blended_ += blended ? 1 : 0;
    masked_ += masked ? 1 : 0;
    return blended || masked;
}

void GltfDecoder::CheckPositions(const GltfAccessor& positions, const std::string& place) const
{
    const int type = positions.ComponentType();
    const bool isFloat = type == TINYGLTF_COMPONENT_TYPE_FLOAT && !positions.IsNormalized();
    const bool isQuantized = quantized_ && type >= TINYGLTF_COMPONENT_TYPE_BYTE &&
                             type <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (!positions.Is(TINYGLTF_TYPE_VEC3) || !(isFloat || isQuantized)) {
        Refuse(file_.job, "%s: POSITION is a %s; it must be a VEC3 of FLOAT%s", place.c_str(),
               positions.Describe().c_str(),
               quantized_ ? " or of 8 or 16 bit integers"
                          : ", as long as the file does not use KHR_mesh_quantization");
    }
}

void GltfDecoder::CheckIndices(const GltfAccessor& indices, const std::string& place) const
{
    const int type = indices.ComponentType();
    if (!indices.Is(TINYGLTF_TYPE_SCALAR) || indices.IsNormalized() ||
        (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
         type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
         type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)) {
        Refuse(file_.job, "%s: indices are a %s; they must be a SCALAR of an unsigned type",
               place.c_str(), indices.Describe().c_str());
    }
}

// The place of an element among the mesh's positions. places_ is never cleared: an entry counts
// only when the position that it points at came from this very element.
std::uint32_t GltfDecoder::AddPosition(const GltfAccessor& positions, std::size_t accessor,
                                       std::uint32_t element, GltfMesh& mesh)
{
    const std::uint32_t known = places_[element];
    if (known < origins_.Size() && origins_[known].accessor == accessor &&
        origins_[known].element == element) {
        return known;
    }
    if (mesh.positions.Size() >= UINT32_MAX - 1) {
        Refuse(file_.job, PVT_LIMIT, "a mesh has more positions than 32 bits can index");
    }
    const std::uint32_t place = static_cast<std::uint32_t>(mesh.positions.Size());
    mesh.positions.Push(positions.GetVec3(element));
    origins_.Push({accessor, element});
    places_[element] = place;
    return place;
}

void GltfDecoder::DecodePrimitive(const tinygltf::Primitive& primitive, const std::string& place,
                                  GltfMesh& mesh)
{
    const std::size_t accessor = static_cast<std::size_t>(primitive.attributes.at("POSITION"));
    const GltfAccessor positions(file_, accessor);
    CheckPositions(positions, place);
    const bool indexed = primitive.indices >= 0;
    const std::size_t source = indexed ? static_cast<std::size_t>(primitive.indices) : accessor;
    const GltfAccessor indices(file_, source);
    if (indexed) {
        CheckIndices(indices, place);
    }
    if (positions.Count() > UINT32_MAX) {
        Refuse(file_.job, PVT_LIMIT, "%s has more positions than 32 bits can index", place.c_str());
    }
    places_.Resize(std::max(places_.Size(), positions.Count()));

    const auto getIndex = [&](std::size_t i) {
        const std::uint32_t index = indexed ? indices.GetIndex(i) : static_cast<std::uint32_t>(i);
        if (index >= positions.Count()) {
            Refuse(file_.job,
                   "%s: index %zu (of accessors[%zu]) is %u, but there are only %zu positions",
                   place.c_str(), i, source, index, positions.Count());
        }
        return index;
    };
    const std::size_t count = CountTriangles(primitive.mode, indices.Count());
    for (std::size_t t = 0; t < count; ++t) {
        if (t % kPollTriangles == 0) {
            Poll(file_.job.context);
        }
        const Corners corners = GetCorners(primitive.mode, t);
        const std::uint32_t a = getIndex(corners.a), b = getIndex(corners.b),
                            c = getIndex(corners.c);
        // Strips are stitched by triangles that repeat an index. They are never seen, but would
        // count as the segment between the pieces.
        if (primitive.mode != TINYGLTF_MODE_TRIANGLES && (a == b || b == c || c == a)) {
            continue;
        }
        for (const std::uint32_t index : {a, b, c}) {
            mesh.indices.Push(AddPosition(positions, accessor, index, mesh));
        }
    }
}

GltfMesh GltfDecoder::Decode(std::size_t index)
{
    const tinygltf::Mesh& source = file_.model.meshes[index];
    GltfMesh mesh(file_.job.context);
    origins_.Resize(0);
    for (std::size_t i = 0; i < source.primitives.size(); ++i) {
        const tinygltf::Primitive& primitive = source.primitives[i];
        const std::string place =
            "meshes[" + std::to_string(index) + "].primitives[" + std::to_string(i) + "]";
        if (primitive.extensions.count("KHR_draco_mesh_compression") != 0) {
            Refuse(file_.job, PVT_UNSUPPORTED,
                   "%s is compressed by KHR_draco_mesh_compression, which is not supported; export "
                   "it without",
                   place.c_str());
        }
        const bool hasTriangles = primitive.mode >= TINYGLTF_MODE_TRIANGLES;
        if (hasTriangles && !IsOmitted(primitive)) {
            morphed_ += primitive.targets.empty() ? 0 : 1;
            ++drawn_;
            DecodePrimitive(primitive, place, mesh);
        }
    }
    return mesh;
}

void GltfDecoder::WarnOfOmissions() const
{
    if (blended_ > 0) {
        Warn(file_.job,
             "%zu primitives with a blended material do not block the view and were "
             "left out",
             blended_);
    }
    if (masked_ > 0) {
        Warn(file_.job,
             "%zu primitives with a masked material were left out; --masked opaque keeps them",
             masked_);
    }
    if (unplaced_ > 0) {
        Warn(file_.job, "%zu primitives without a POSITION were left out", unplaced_);
    }
    if (morphed_ > 0) {
        Warn(file_.job, "%zu primitives have morph targets; their base shape is taken", morphed_);
    }
}

void GltfDecoder::RefuseIfAllOmitted() const
{
    if (drawn_ > 0 || blended_ + masked_ + unplaced_ == 0) {
        return;
    }
    Refuse(file_.job,
           "nothing is left: %zu primitives with masked and %zu with blended materials were left "
           "out, and %zu without a POSITION; %s",
           masked_, blended_, unplaced_,
           masked_ > 0    ? "keep the masked ones by --masked opaque"
           : blended_ > 0 ? "make the materials opaque if they block the view"
                          : "export the model again");
}

} // namespace pvt
