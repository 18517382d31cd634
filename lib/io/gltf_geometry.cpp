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

GltfDecoder::GltfDecoder(const GltfFile& file, const GltfDraco& draco)
    : file_(file), draco_(draco), masks_(file),
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
    blended_ += blended ? 1 : 0;
    return blended || (material.alphaMode == "MASK" && IsMaskOmitted(primitive));
}

bool GltfDecoder::IsMaskOmitted(const tinygltf::Primitive& primitive)
{
    if (file_.job.options->masked == PVT_MASKED_OPAQUE) {
        return false;
    }
    bool omitted = true;
    if (file_.job.options->masked == PVT_MASKED_AUTO) {
        const GltfMask& mask = masks_.Find(static_cast<std::size_t>(primitive.material));
        const bool mapped =
            mask.map == nullptr || primitive.attributes.count(mask.TexCoordName()) != 0;
        omitted = !mask.isKnown || !mapped;
        unmapped_ += mask.isKnown && !mapped ? 1 : 0;
    }
    masked_ += omitted ? 1 : 0;
    judged_ += omitted ? 0 : 1;
    return omitted;
}

void GltfDecoder::CheckPositions(const GltfAccessor& positions, const std::string& place) const
{
    const int type = positions.ComponentType();
    const bool isFloat = type == TINYGLTF_COMPONENT_TYPE_FLOAT && !positions.IsNormalized();
    const bool isQuantized = quantized_ && type >= TINYGLTF_COMPONENT_TYPE_BYTE &&
                             type <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    if (!positions.Is(TINYGLTF_TYPE_VEC3) || !(isFloat || isQuantized)) {
        Refuse(file_.job, "%s.attributes.POSITION is a %s; it must be a VEC3 of FLOAT%s",
               place.c_str(), positions.Describe().c_str(),
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
        Refuse(file_.job, "%s.indices are a %s; they must be a SCALAR of an unsigned type",
               place.c_str(), indices.Describe().c_str());
    }
}

// The place of an element among the mesh's positions. places_ is never cleared: an entry counts
// only when the position that it points at came from this very element.
std::uint32_t GltfDecoder::AddPosition(const Positions& positions, std::uint32_t element,
                                       GltfMesh& mesh)
{
    const std::uint32_t known = places_[element];
    if (known < origins_.Size() && origins_[known].source == positions.source &&
        origins_[known].element == element) {
        return known;
    }
    if (mesh.positions.Size() >= UINT32_MAX - 1) {
        Refuse(file_.job, PVT_LIMIT, "a mesh has more positions than 32 bits can index");
    }
    const pvtVec3 position = positions.accessor.GetVec3(element);
    positions.range.Check(position, element);
    const std::uint32_t place = static_cast<std::uint32_t>(mesh.positions.Size());
    mesh.positions.Push(position);
    origins_.Push({positions.source, element});
    places_[element] = place;
    return place;
}

// An attribute of a primitive, wherever its data comes from.
GltfAccessor GltfDecoder::OpenAttribute(std::size_t mesh, std::size_t primitive,
                                        const char* name) const
{
    if (draco_.Has(mesh, primitive)) {
        std::optional<GltfAccessor> decoded = draco_.OpenAttribute(mesh, primitive, name);
        if (decoded) {
            return *decoded;
        }
    }
    const auto& attributes = file_.model.meshes[mesh].primitives[primitive].attributes;
    return GltfAccessor(file_, static_cast<std::size_t>(attributes.at(name)));
}

// The same for its indices, which it has.
GltfAccessor GltfDecoder::OpenIndices(std::size_t mesh, std::size_t primitive) const
{
    if (draco_.Has(mesh, primitive)) {
        return draco_.OpenIndices(mesh, primitive);
    }
    const int accessor = file_.model.meshes[mesh].primitives[primitive].indices;
    return GltfAccessor(file_, static_cast<std::size_t>(accessor));
}

// None for a primitive that is opaque as a whole.
std::optional<MaskedPrimitive> GltfDecoder::FindMask(std::size_t mesh, std::size_t index)
{
    const tinygltf::Primitive& primitive = file_.model.meshes[mesh].primitives[index];
    const std::size_t material = static_cast<std::size_t>(primitive.material);
    if (file_.job.options->masked != PVT_MASKED_AUTO || primitive.material < 0 ||
        file_.model.materials[material].alphaMode != "MASK") {
        return {};
    }
    const GltfMask& mask = masks_.Find(material);
    const std::string names[] = {mask.TexCoordName(), "COLOR_0"};
    std::optional<GltfAccessor> found[2];
    for (std::size_t i = 0; i < 2; ++i) {
        if (primitive.attributes.count(names[i]) != 0) {
            found[i] = OpenAttribute(mesh, index, names[i].c_str());
        }
    }
    const MaskedPrimitive::Source source = {GetGltfPlace(mesh, index),
                                            OpenAttribute(mesh, index, "POSITION").Count(),
                                            found[0], found[1]};
    return MaskedPrimitive(file_.job, mask, source);
}

void GltfDecoder::DecodePrimitive(std::size_t meshIndex, std::size_t index, GltfMesh& mesh)
{
    const tinygltf::Primitive& primitive = file_.model.meshes[meshIndex].primitives[index];
    const std::string place = GetGltfPlace(meshIndex, index);
    const bool compressed = draco_.Has(meshIndex, index);
    const std::size_t accessor = static_cast<std::size_t>(primitive.attributes.at("POSITION"));
    const GltfAccessor positions = OpenAttribute(meshIndex, index, "POSITION");
    CheckPositions(positions, place);
    const bool indexed = compressed || primitive.indices >= 0;
    const GltfAccessor indices = indexed ? OpenIndices(meshIndex, index) : positions;
    if (indexed) {
        CheckIndices(indices, place);
    }
    if (positions.Count() > UINT32_MAX) {
        Refuse(file_.job, PVT_LIMIT, "%s has more positions than 32 bits can index", place.c_str());
    }
    places_.Resize(std::max(places_.Size(), positions.Count()));
    const GltfRange range(file_, accessor, place + ".attributes.POSITION", compressed);
    const Positions source = {positions,
                              compressed ? file_.model.accessors.size() + index : accessor, range};
    // Draco stores strips as lists.
    const int mode = compressed ? TINYGLTF_MODE_TRIANGLES : primitive.mode;

    const auto getIndex = [&](std::size_t i) {
        const std::uint32_t element = indexed ? indices.GetIndex(i) : static_cast<std::uint32_t>(i);
        if (element >= positions.Count()) {
            Refuse(file_.job,
                   "%s.indices: element %zu (of %s) is %u, but there are only %zu positions",
                   place.c_str(), i, indices.Name().c_str(), element, positions.Count());
        }
        return element;
    };
    const std::optional<MaskedPrimitive> mask = FindMask(meshIndex, index);
    GltfCard card{};
    const std::size_t count = CountTriangles(mode, indices.Count());
    for (std::size_t t = 0; t < count; ++t) {
        if (t % kPollTriangles == 0) {
            Poll(file_.job.context);
        }
        const Corners corners = GetCorners(mode, t);
        const std::uint32_t elements[] = {getIndex(corners.a), getIndex(corners.b),
                                          getIndex(corners.c)};
        // Strips are stitched by triangles that repeat an index. They are never seen, but would
        // count as the segment between the pieces.
        if (mode != TINYGLTF_MODE_TRIANGLES &&
            (elements[0] == elements[1] || elements[1] == elements[2] ||
             elements[2] == elements[0])) {
            continue;
        }
        if (mask) {
            const MaskedPrimitive::Verdict verdict = mask->Judge(elements, card);
            if (verdict == MaskedPrimitive::Verdict::Transparent) {
                continue;
            }
            if (verdict == MaskedPrimitive::Verdict::Mixed) {
                card.triangle = mesh.indices.Size() / 3;
                mesh.cards.Push(card);
            }
        }
        for (const std::uint32_t element : elements) {
            mesh.indices.Push(AddPosition(source, element, mesh));
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
        const bool hasTriangles = primitive.mode >= TINYGLTF_MODE_TRIANGLES;
        if (hasTriangles && !IsOmitted(primitive)) {
            morphed_ += primitive.targets.empty() ? 0 : 1;
            ++drawn_;
            DecodePrimitive(index, i, mesh);
        }
    }
    return mesh;
}

void GltfDecoder::WarnOfMasks() const
{
    masks_.WarnOfUnreadable();
    if (unmapped_ > 0) {
        Warn(file_.job,
             "%zu primitives with a masked material lack the texture coordinates that it asks for",
             unmapped_);
    }
    if (masked_ > 0) {
        Warn(file_.job,
             "%zu primitives with a masked material were left out; --masked opaque keeps them",
             masked_);
    }
}

void GltfDecoder::WarnOfOmissions() const
{
    if (blended_ > 0) {
        Warn(file_.job,
             "%zu primitives with a blended material do not block the view and were "
             "left out",
             blended_);
    }
    WarnOfMasks();
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
    WarnOfMasks();
    Refuse(file_.job,
           "nothing is left: %zu primitives with masked and %zu with blended materials were left "
           "out, and %zu without a POSITION; %s",
           masked_, blended_, unplaced_,
           masked_ > 0    ? "keep the masked ones by --masked opaque"
           : blended_ > 0 ? "make the materials opaque if they block the view"
                          : "export the model again");
}

void GltfDecoder::RefuseIfTransparent() const
{
    if (judged_ == 0) {
        return;
    }
    WarnOfOmissions();
    Refuse(file_.job, PVT_NOTHING_INSIDE,
           "no part of its masked surfaces is opaque, as closely as they were looked at; a higher "
           "resolution looks more closely, and --masked opaque keeps them as they are");
}

} // namespace pvt
