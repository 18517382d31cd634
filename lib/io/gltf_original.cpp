// SPDX-License-Identifier: MIT
// Taking a glTF over: what this program does not know stays as it is. Only buffers are merged into
// one, as a GLB has room for no more, and views are moved along (glTF 2.0, sections 3.6.1, 4.4).
#include "gltf_original.hpp"

#include <algorithm>
#include <cstring>

namespace pvt
{

namespace
{

// What any extension asks of its views' offsets.
constexpr std::size_t kAlignment = 16;
constexpr std::size_t kMaxGlb = 0xffffffff;
constexpr char kZeroes[kAlignment] = {};

std::size_t Align(std::size_t size, std::size_t to)
{
    return (size + to - 1) / to * to;
}

void Shift(Json& object, const char* key, std::size_t by)
{
    const auto found = object.find(key);
    if (found != object.end()) {
        *found = found->get<std::size_t>() + by;
    }
}

void ShiftAll(Json& indices, std::size_t by)
{
    for (Json& index : indices) {
        index = index.get<std::size_t>() + by;
    }
}

// The list of that name, which is made when it is not there.
Json& GetList(Json& object, const char* name)
{
    Json& list = object[name];
    if (!list.is_array()) {
        list = Json::array();
    }
    return list;
}

// Where a buffer's bytes have gone.
struct Place {
    std::size_t buffer, offset;
};

// `range` is a buffer view, or the extension of one that names compressed bytes.
void MoveRange(Json& range, const std::vector<Place>& places)
{
    const auto buffer = range.find("buffer");
    if (buffer == range.end() || !buffer->is_number_unsigned() ||
        buffer->get<std::size_t>() >= places.size()) {
        return;
    }
    const Place& place = places[buffer->get<std::size_t>()];
    *buffer = place.buffer;
    if (place.offset != 0) {
        range["byteOffset"] = range.value("byteOffset", std::size_t{0}) + place.offset;
    }
}

void MoveViews(Json& document, const std::vector<Place>& places)
{
    const auto views = document.find("bufferViews");
    if (views == document.end()) {
        return;
    }
    for (Json& view : *views) {
        MoveRange(view, places);
        const auto extensions = view.find("extensions");
        if (extensions != view.end() && extensions->is_object()) {
            for (Json& extension : *extensions) {
                if (extension.is_object()) {
                    MoveRange(extension, places);
                }
            }
        }
    }
}

void AppendAll(Json& document, const Json& added, const char* name)
{
    const auto found = added.find(name);
    if (found != added.end()) {
        Json& list = GetList(document, name);
        list.insert(list.end(), found->begin(), found->end());
    }
}

void AppendExtensions(Json& document, const Json& added)
{
    const auto found = added.find("extensionsUsed");
    if (found == added.end()) {
        return;
    }
    for (const Json& name : *found) {
        if (!IsExtensionListed(document, "extensionsUsed",
                               name.get_ref<const std::string&>().c_str())) {
            GetList(document, "extensionsUsed").push_back(name);
        }
    }
}

// References within `added`, so that they hold behind what `document` has.
void ShiftReferences(Json& added, const Json& document, std::size_t offset)
{
    for (Json& view : added["bufferViews"]) {
        view["byteOffset"] = view.value("byteOffset", std::size_t{0}) + offset;
    }
    for (Json& accessor : added["accessors"]) {
        Shift(accessor, "bufferView", GetCount(document, "bufferViews"));
    }
    for (Json& mesh : added["meshes"]) {
        for (Json& primitive : mesh["primitives"]) {
            Shift(primitive, "indices", GetCount(document, "accessors"));
            Shift(primitive, "material", GetCount(document, "materials"));
            ShiftAll(primitive["attributes"], GetCount(document, "accessors"));
        }
    }
    for (Json& node : added["nodes"]) {
        Shift(node, "mesh", GetCount(document, "meshes"));
        const auto extensions = node.find("extensions");
        if (extensions != node.end()) {
            ShiftAll((*extensions)["MSFT_lod"]["ids"], GetCount(document, "nodes"));
        }
    }
    ShiftAll(added["scenes"][0]["nodes"], GetCount(document, "nodes"));
}

// Those that are nobody's children.
Json FindRoots(const Json& document)
{
    std::vector<char> isChild(GetCount(document, "nodes"), 0);
    for (std::size_t i = 0; i < isChild.size(); ++i) {
        for (const Json& child : document["nodes"][i].value("children", Json::array())) {
            isChild[child.get<std::size_t>()] = 1;
        }
    }
    Json roots = Json::array();
    for (std::size_t i = 0; i < isChild.size(); ++i) {
        if (isChild[i] == 0) {
            roots.push_back(i);
        }
    }
    return roots;
}

// What an image's first bytes say that it is; glTF wants it told where an image lies in a buffer.
const char* GetMimeType(const Span& bytes)
{
    static const struct {
        std::size_t at;
        const char* magic;
        const char* type;
    } kinds[] = {{0, "\x89PNG\r\n", "image/png"},
                 {0, "\xff\xd8\xff", "image/jpeg"},
                 {8, "WEBP", "image/webp"},
                 {0, "\xabKTX 20", "image/ktx2"},
                 {0, "DDS ", "image/vnd-ms.dds"}};
    for (const auto& kind : kinds) {
        const std::size_t length = std::strlen(kind.magic);
        if (bytes.size >= kind.at + length &&
            std::memcmp(bytes.bytes + kind.at, kind.magic, length) == 0) {
            return kind.type;
        }
    }
    return nullptr;
}

std::string EncodeBase64(pvtContext* context, const std::vector<Span>& pieces)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    std::uint32_t bits = 0;
    int held = 0;
    const auto put = [&](std::uint8_t byte) {
        bits = bits << 8 | byte;
        if (++held == 3) {
            for (int shift = 18; shift >= 0; shift -= 6) {
                text.push_back(digits[bits >> shift & 63]);
            }
            bits = 0;
            held = 0;
        }
    };
    std::size_t size = 0;
    for (const Span& piece : pieces) {
        Poll(context);
        for (; size % kAlignment != 0; ++size) {
            put(0);
        }
        for (std::size_t i = 0; i < piece.size; ++i) {
            put(piece.bytes[i]);
        }
        size += piece.size;
    }
    // The last one or two bytes, filled up.
    const int left = held;
    for (int i = left; i % 3 != 0; ++i) {
        put(0);
    }
    if (left != 0) {
        text.replace(text.size() - static_cast<std::size_t>(3 - left), std::string::npos,
                     static_cast<std::size_t>(3 - left), '=');
    }
    return text;
}

} // namespace

GltfOriginal::GltfOriginal(const pvtLoadJob& job) : job_(job), file_(job.context)
{
    Check(pvtReadOpenSource(job.context, job.file, job.size, job.path, &file_.source));
    const GltfContainer container = OpenGltfContainer(job, file_.source);
    document_ = ParseGltfJson(job, container.json);
    CheckGltfSchema(job, document_);
    TakeBuffers(container);
    TakeImages();
    document_["asset"]["generator"] = std::string("paravent ") + pvtGetVersion();
}

std::size_t GltfOriginal::AddPiece(const Span& bytes)
{
    const std::size_t offset = Align(size_, kAlignment);
    pieces_.push_back(bytes);
    size_ = offset + bytes.size;
    return offset;
}

// Buffers without bytes, which compressed files fall back to, stay buffers of their own.
void GltfOriginal::TakeBuffers(const GltfContainer& container)
{
    data_.emplace(job_, document_, container);
    Json kept = Json::array({Json::object()});
    std::vector<Place> places;
    for (std::size_t i = 0; i < GetCount(document_, "buffers"); ++i) {
        const Span bytes = data_->GetBuffer(i);
        if (bytes.bytes != nullptr) {
            places.push_back({0, AddPiece(bytes)});
        } else {
            places.push_back({kept.size(), 0});
            kept.push_back(document_["buffers"][i]);
        }
    }
    MoveViews(document_, places);
    document_["buffers"] = std::move(kept);
}

void GltfOriginal::TakeImages()
{
    const auto images = document_.find("images");
    if (images == document_.end() || !images->is_array()) {
        return;
    }
    for (std::size_t i = 0; i < images->size(); ++i) {
        Poll(job_.context);
        TakeImage((*images)[i], i);
    }
}

void GltfOriginal::TakeImage(Json& image, std::size_t index)
{
    const auto uri = image.is_object() ? image.find("uri") : image.end();
    if (!image.is_object() || uri == image.end() || !uri->is_string() ||
        IsDataUri(uri->get_ref<const std::string&>())) {
        return;
    }
    const std::string place = "images[" + std::to_string(index) + "]";
    OwnedSource file(job_.context);
    Span bytes;
    try {
        bytes = ReadUri(job_, uri->get_ref<const std::string&>(), place, file);
    } catch (const Failure& failure) {
        if (failure.status != PVT_INVALID_INPUT) {
            throw;
        }
        pvtLog(job_.context, PVT_LOG_WARNING, "%s; it stays a link",
               pvtContext_GetMessage(job_.context));
        return;
    }
    const char* type = GetMimeType(bytes);
    if (type == nullptr) {
        Warn(job_, "%s.uri \"%s\" is neither PNG, JPEG, WebP, KTX2 nor DDS; it stays a link",
             place.c_str(), Clean(uri->get<std::string>()).c_str());
        return;
    }
    const std::size_t offset = AddPiece(bytes);
    images_.push_back(std::move(file));
    image.erase(uri);
    image["mimeType"] = type;
    image["bufferView"] = GetCount(document_, "bufferViews");
    document_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size}});
}

Json& GltfOriginal::ChooseScene(int scene)
{
    if (GetCount(document_, "scenes") == 0) {
        document_["scenes"] = Json::array({{{"nodes", FindRoots(document_)}}});
        document_["scene"] = 0;
    }
    const std::size_t index =
        scene >= 0 ? static_cast<std::size_t>(scene) : document_.value("scene", std::size_t{0});
    if (index >= GetCount(document_, "scenes")) {
        Refuse(job_, PVT_INVALID_ARGUMENT, "there is no scene %zu", index);
    }
    return document_["scenes"][index];
}

void GltfOriginal::Append(const std::string& glb, int scene)
{
    added_ = glb;
    const pvtSource source = {reinterpret_cast<std::uint8_t*>(added_.data()), added_.size()};
    const GltfContainer container = OpenGltfContainer(job_, source);
    Json added = ParseGltfJson(job_, container.json);
    ShiftReferences(added, document_, AddPiece(container.binary));
    Json& nodes = GetList(ChooseScene(scene), "nodes");
    nodes.insert(nodes.end(), added["scenes"][0]["nodes"].begin(),
                 added["scenes"][0]["nodes"].end());
    for (const char* name : {"bufferViews", "accessors", "materials", "meshes", "nodes"}) {
        AppendAll(document_, added, name);
    }
    AppendExtensions(document_, added);
}

void GltfOriginal::WritePieces(pvtOutput* output) const
{
    std::size_t size = 0;
    for (const Span& piece : pieces_) {
        Poll(job_.context);
        pvtOutput_Write(output, kZeroes, Align(size, kAlignment) - size);
        pvtOutput_Write(output, piece.bytes, piece.size);
        size = Align(size, kAlignment) + piece.size;
    }
    pvtOutput_Write(output, kZeroes, Align(size, 4) - size);
}

void GltfOriginal::WriteGlb(pvtOutput* output) const
{
    std::string text = document_.dump();
    text.resize(Align(text.size(), 4), ' ');
    const std::size_t binary = Align(size_, 4), whole = 28 + text.size() + binary;
    if (whole > kMaxGlb) {
        Refuse(job_, PVT_LIMIT, "%zu bytes are more than a GLB holds", whole);
    }
    const auto write = [output](std::size_t number) {
        const auto n = static_cast<std::uint32_t>(number);
        const std::uint8_t bytes[4] = {
            static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(n >> 8),
            static_cast<std::uint8_t>(n >> 16), static_cast<std::uint8_t>(n >> 24)};
        pvtOutput_Write(output, bytes, sizeof bytes);
    };
    pvtOutput_Write(output, "glTF", 4);
    write(2);
    write(whole);
    write(text.size());
    pvtOutput_Write(output, "JSON", 4);
    pvtOutput_Write(output, text.data(), text.size());
    write(binary);
    pvtOutput_Write(output, "BIN", 4);
    WritePieces(output);
}

void GltfOriginal::WriteJson(pvtOutput* output)
{
    const std::string purpose = std::string(job_.path) + ": its buffers as text";
    Check(pvtCheckMemory(job_.context, 3 * size_, purpose.c_str()));
    document_["buffers"][0]["uri"] =
        "data:application/octet-stream;base64," + EncodeBase64(job_.context, pieces_);
    const std::string text = document_.dump(2);
    pvtOutput_Write(output, text.data(), text.size());
    pvtOutput_Write(output, "\n", 1);
}

void GltfOriginal::Write(bool binary, pvtOutput* output)
{
    document_["buffers"][0]["byteLength"] = size_;
    if (binary) {
        WriteGlb(output);
    } else {
        WriteJson(output);
    }
}

} // namespace pvt
