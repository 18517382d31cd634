// SPDX-License-Identifier: MIT
// Masked materials: glTF 2.0, sections 3.8.2, 3.9.2 and 3.9.4; KHR_texture_transform;
// EXT_texture_webp. Mip levels above the finest are a renderer's own, and are not looked at.
#include "gltf_mask.hpp"
#include "gltf_uri.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pvt
{

namespace
{

constexpr int kRepeat = 10497, kMirroredRepeat = 33648, kClampToEdge = 33071;

double GetNumber(const Json& object, const char* name, double fallback)
{
    const auto found = object.find(name);
    return found != object.end() ? found->get<double>() : fallback;
}

double GetNumber(const Json& object, const char* name, std::size_t index, double fallback)
{
    const auto found = object.find(name);
    return found != object.end() ? (*found)[index].get<double>() : fallback;
}

std::size_t GetInteger(const Json& object, const char* name, std::size_t fallback)
{
    const auto found = object.find(name);
    return found != object.end() ? found->get<std::size_t>() : fallback;
}

// Scaled, then turned, then moved. The extension's sample code turns the other way than its text
// and than every renderer: with v pointing down, counter-clockwise is from u towards −v.
std::array<double, 6> GetTransform(const Json& transform)
{
    const double angle = GetNumber(transform, "rotation", 0.0);
    const double c = std::cos(angle), s = std::sin(angle);
    const double scaleU = GetNumber(transform, "scale", 0, 1.0);
    const double scaleV = GetNumber(transform, "scale", 1, 1.0);
    return {c * scaleU,  s * scaleV, GetNumber(transform, "offset", 0, 0.0),
            -s * scaleU, c * scaleV, GetNumber(transform, "offset", 1, 0.0)};
}

// The image's index, and its name where it has one.
std::string DescribeImage(const Json& image, std::size_t index)
{
    const std::string place = "images[" + std::to_string(index) + "]";
    const auto uri = image.find("uri");
    const auto name = image.find("name");
    if (uri != image.end() && !IsDataUri(uri->get_ref<const std::string&>())) {
        return place + " \"" + Clean(uri->get<std::string>()) + "\"";
    }
    return name != image.end() ? place + " \"" + Clean(name->get<std::string>()) + "\"" : place;
}

class OwnedAlpha
{
  public:
    explicit OwnedAlpha(pvtContext* context) : context_(context)
    {
    }
    OwnedAlpha(const OwnedAlpha&) = delete;
    OwnedAlpha& operator=(const OwnedAlpha&) = delete;
    ~OwnedAlpha()
    {
        pvtAlpha_Free(context_, &alpha);
    }

  private:
    pvtContext* context_;

  public:
    pvtAlpha alpha{};
};

// Decodes an image wherever it lies. What is not its own memory is freed behind it.
void DecodeImage(const GltfFile& file, std::size_t index, const std::string& label, pvtAlpha& alpha)
{
    const pvtLoadJob& job = file.job;
    const Json& image = file.document["images"][index];
    const std::string place = "images[" + std::to_string(index) + "]";
    Array<std::uint8_t> decoded(job.context);
    OwnedSource source(job.context);
    Span bytes;
    const auto uri = image.find("uri");
    const auto view = image.find("bufferView");
    if (uri != image.end()) {
        const std::string& text = uri->get_ref<const std::string&>();
        bytes = IsDataUri(text) ? DecodeDataUri(job, text, place, decoded)
                                : ReadUri(job, text, place, source);
    } else if (view != image.end()) {
        bytes = file.data.GetView(file.document, view->get<std::size_t>());
    } else {
        Refuse(job, "%s has neither uri nor bufferView", place.c_str());
    }
    const std::string whole = std::string(job.path) + ": " + label;
    Check(pvtDecodeAlpha(job.context, whole.c_str(), bytes.bytes, bytes.size, &alpha));
}

} // namespace

int GltfMask::FindThreshold(double vertexAlpha) const
{
    if (!(cutoff > 0.0)) {
        return 0;
    }
    const double whole = std::min(factor * vertexAlpha, 1.0);
    // False for NaN, which is never opaque.
    if (!(whole >= cutoff)) {
        return UINT8_MAX + 1;
    }
    int threshold = static_cast<int>(cutoff / whole * UINT8_MAX);
    while (threshold < UINT8_MAX && threshold / 255.0 * whole < cutoff) {
        ++threshold;
    }
    return threshold;
}

MaskedPrimitive::MaskedPrimitive(const pvtLoadJob& job, const GltfMask& mask, const Source& source)
    : mask_(mask), texCoords_(source.texCoords), colors_(source.colors)
{
    const std::string place = source.place + ".attributes.";
    const std::string name = mask.TexCoordName();
    if (mask.map != nullptr && !texCoords_->Is(TINYGLTF_TYPE_VEC2)) {
        Refuse(job, "%s%s is a %s; it must be a VEC2", place.c_str(), name.c_str(),
               texCoords_->Describe().c_str());
    }
    if (colors_ && !colors_->Is(TINYGLTF_TYPE_VEC3) && !colors_->Is(TINYGLTF_TYPE_VEC4)) {
        Refuse(job, "%sCOLOR_0 is a %s; it must be a VEC3 or VEC4", place.c_str(),
               colors_->Describe().c_str());
    }
    for (const auto& attribute : {texCoords_, colors_}) {
        if (attribute && attribute->Count() != source.positionCount) {
            Refuse(job, "%s: %s counts %zu elements, but %zu are positions", source.place.c_str(),
                   attribute->Name().c_str(), attribute->Count(), source.positionCount);
        }
    }
    if (colors_ && colors_->Is(TINYGLTF_TYPE_VEC3)) {
        colors_.reset(); // opaque
    }
}

MaskedPrimitive::Verdict MaskedPrimitive::Judge(const std::uint32_t elements[3],
                                                GltfCard& card) const
{
    double alpha = 1.0;
    for (int i = 0; i < 3 && colors_; ++i) {
        const double own = colors_->GetNumber(elements[i], 3);
        alpha = own < alpha || std::isnan(own) ? own : alpha;
    }
    const int threshold = mask_.FindThreshold(alpha);
    const int most = mask_.map != nullptr ? mask_.map->most : UINT8_MAX;
    const int least = mask_.map != nullptr ? mask_.map->least : UINT8_MAX;
    if (threshold > most || threshold <= least) {
        return threshold > most ? Verdict::Transparent : Verdict::Opaque;
    }
    card.map = mask_.map;
    card.threshold = threshold;
    const std::array<double, 6>& m = mask_.toTexels;
    for (int i = 0; i < 3; ++i) {
        const double u = texCoords_->GetNumber(elements[i], 0);
        const double v = texCoords_->GetNumber(elements[i], 1);
        card.texels[i][0] = m[0] * u + m[1] * v + m[2];
        card.texels[i][1] = m[3] * u + m[4] * v + m[5];
    }
    return Verdict::Mixed;
}

bool GltfMasks::Key::operator<(const Key& other) const
{
    return std::tie(image, wraps[0], wraps[1]) <
           std::tie(other.image, other.wraps[0], other.wraps[1]);
}

const GltfMask& GltfMasks::Find(std::size_t material)
{
    const auto found = masks_.find(material);
    return found != masks_.end() ? found->second
                                 : masks_.emplace(material, Read(material)).first->second;
}

GltfMask GltfMasks::Read(std::size_t material)
{
    const Json& json = file_.document["materials"][material];
    GltfMask mask;
    mask.cutoff = GetNumber(json, "alphaCutoff", 0.5);
    const auto roughness = json.find("pbrMetallicRoughness");
    const bool hasTexture = roughness != json.end() && roughness->contains("baseColorTexture");
    if (hasTexture) {
        mask.factor = GetNumber(*roughness, "baseColorFactor", 3, 1.0);
        ReadTexture((*roughness)["baseColorTexture"], mask);
    } else {
        // A mask without one is what is left of a material whose textures were taken off, and as
        // likely a leaf as a wall.
        ++textureless_;
    }
    return mask;
}

void GltfMasks::ReadTexture(const Json& info, GltfMask& mask)
{
    const std::size_t index = info["index"].get<std::size_t>();
    const std::optional<std::size_t> image = FindImage(index);
    if (!image) {
        ++textureless_;
        return;
    }
    Texture& texture = FindTexture({*image, {FindWrap(index, "wrapS"), FindWrap(index, "wrapT")}});
    ++texture.materials;
    mask.isKnown = texture.failure.empty();
    mask.map = texture.owned.map.levelCount > 0 ? &texture.owned.map : nullptr;
    mask.texCoord = GetInteger(info, "texCoord", 0);
    mask.toTexels = {1, 0, 0, 0, 1, 0};
    const Json* transform = FindExtension(info, "KHR_texture_transform");
    if (transform != nullptr) {
        mask.texCoord = GetInteger(*transform, "texCoord", mask.texCoord);
        mask.toTexels = GetTransform(*transform);
    }
    for (std::size_t i = 0; i < 6; ++i) {
        mask.toTexels[i] *= i < 3 ? texture.width : texture.height;
    }
}

// The image that every reader knows, or else the one that this one does.
std::optional<std::size_t> GltfMasks::FindImage(std::size_t texture) const
{
    const Json& json = file_.document["textures"][texture];
    const Json* places[] = {
        &json, FindExtension(json, "EXT_texture_webp"), FindExtension(json, "KHR_texture_basisu"),
        FindExtension(json, "EXT_texture_avif"), FindExtension(json, "MSFT_texture_dds")};
    for (const Json* place : places) {
        if (place != nullptr && place->contains("source")) {
            return (*place)["source"].get<std::size_t>();
        }
    }
    return {};
}

pvtWrap GltfMasks::FindWrap(std::size_t texture, const char* name) const
{
    const auto sampler = file_.document["textures"][texture].find("sampler");
    if (sampler == file_.document["textures"][texture].end()) {
        return PVT_WRAP_REPEAT;
    }
    const std::size_t index = sampler->get<std::size_t>();
    const std::size_t wrap = GetInteger(file_.document["samplers"][index], name, kRepeat);
    if (wrap != kRepeat && wrap != kMirroredRepeat && wrap != kClampToEdge) {
        Refuse(file_.job, "samplers[%zu].%s is %zu; it must be %d, %d or %d", index, name, wrap,
               kRepeat, kMirroredRepeat, kClampToEdge);
    }
    return wrap == kRepeat           ? PVT_WRAP_REPEAT
           : wrap == kMirroredRepeat ? PVT_WRAP_MIRROR
                                     : PVT_WRAP_CLAMP;
}

GltfMasks::Texture& GltfMasks::FindTexture(const Key& key)
{
    const auto found = textures_.find(key);
    if (found != textures_.end()) {
        return found->second;
    }
    Texture& texture = textures_.try_emplace(key, file_.job.context).first->second;
    try {
        LoadTexture(key, texture);
    } catch (const Failure& failure) {
        texture.failure = pvtContext_GetMessage(file_.job.context);
        // The model can do without the image; not so what concerns the whole run.
        if (failure.status == PVT_LIMIT) {
            throw Failure{pvtFail(file_.job.context, PVT_LIMIT,
                                  "%s; --masked skip does without the image",
                                  texture.failure.c_str())};
        }
        if (failure.status != PVT_INVALID_INPUT && failure.status != PVT_UNSUPPORTED) {
            throw;
        }
    }
    return texture;
}

void GltfMasks::LoadTexture(const Key& key, Texture& texture)
{
    OwnedAlpha owned(file_.job.context);
    const std::string label = DescribeImage(file_.document["images"][key.image], key.image);
    DecodeImage(file_, key.image, label, owned.alpha);
    if (owned.alpha.values == nullptr) {
        return;
    }
    texture.width = owned.alpha.width;
    texture.height = owned.alpha.height;
    Check(pvtBuildAlphaMap(file_.job.context, &owned.alpha, key.wraps, &texture.owned.map));
    // Most masked atlases have some part of it; one that has none needs no map.
    if (texture.owned.map.least == UINT8_MAX) {
        pvtAlphaMap_Free(file_.job.context, &texture.owned.map);
    }
}

void GltfMasks::WarnOfUnreadable() const
{
    for (const auto& [key, texture] : textures_) {
        if (!texture.failure.empty()) {
            pvtLog(file_.job.context, PVT_LOG_WARNING,
                   "%s; without it %zu masked materials cannot be judged", texture.failure.c_str(),
                   texture.materials);
        }
    }
    if (textureless_ > 0) {
        Warn(file_.job, "masked materials without a texture to be judged by: %zu", textureless_);
    }
}

} // namespace pvt
