// SPDX-License-Identifier: MIT
// Buffers and buffer views: glTF 2.0, sections 3.6.1 and 4.4.3; EXT_meshopt_compression.
#include "gltf_document.hpp"
#include "gltf_uri.hpp"

#include <cstring>
#include <meshoptimizer.h>

namespace pvt
{

namespace
{

// meshoptimizer's densest mode packs 64 bytes into one; what claims to do much better lies, and is
// refused before memory is asked for.
constexpr std::size_t kMaxCompression = 256;

std::size_t GetSize(const Json& object, const char* name)
{
    const auto found = object.find(name);
    return found != object.end() ? found->get<std::size_t>() : 0;
}

std::string GetText(const Json& object, const char* name)
{
    const auto found = object.find(name);
    return found != object.end() ? found->get<std::string>() : std::string();
}

} // namespace

GltfData::GltfData(const pvtLoadJob& job, Json& document, const GltfContainer& container)
    : job_(job)
{
    const std::size_t count = GetCount(document, "buffers");
    buffers_.resize(count);
    views_.resize(GetCount(document, "bufferViews"));
    for (std::size_t i = 0; i < count; ++i) {
        LoadBuffer(document["buffers"][i], i, container);
    }
}

void GltfData::LoadBuffer(Json& buffer, std::size_t index, const GltfContainer& container)
{
    const auto uri = buffer.find("uri");
    if (uri == buffer.end()) {
        // Only the first buffer may lie in the binary chunk. Another without a place is what a
        // compressed file falls back to: no byte of it may be asked for.
        if (index != 0 || container.binary.bytes == nullptr) {
            return;
        }
        buffers_[index] = container.binary;
    } else {
        LoadUri(uri->get_ref<const std::string&>(), index);
        *uri = "data:";
    }
    CheckSize(index, GetSize(buffer, "byteLength"));
}

void GltfData::CheckSize(std::size_t index, std::size_t claimed)
{
    Span& bytes = buffers_[index];
    if (claimed > bytes.size) {
        Refuse(job_, "buffers[%zu].byteLength is %zu, but its data has only %zu bytes", index,
               claimed, bytes.size);
    }
    bytes.size = claimed;
}

void GltfData::LoadUri(const std::string& uri, std::size_t index)
{
    const std::string place = "buffers[" + std::to_string(index) + "]";
    if (IsDataUri(uri)) {
        decoded_.emplace_back(job_.context);
        buffers_[index] = DecodeDataUri(job_, uri, place, decoded_.back());
    } else {
        files_.emplace_back(job_.context);
        buffers_[index] = ReadUri(job_, uri, place, files_.back());
    }
}

// The bytes that buffer, byteOffset and byteLength of `range` name.
Span GltfData::Slice(const Json& range, const std::string& place) const
{
    const std::size_t index = range["buffer"].get<std::size_t>();
    const std::size_t offset = GetSize(range, "byteOffset");
    const std::size_t length = GetSize(range, "byteLength");
    const Span& buffer = buffers_[index];
    if (buffer.bytes == nullptr) {
        Refuse(job_, "%s lies in buffers[%zu], which has no data", place.c_str(), index);
    }
    if (offset > buffer.size || length > buffer.size - offset) {
        Refuse(job_, "%s reaches from byte %zu to %zu, but buffers[%zu] has only %zu bytes",
               place.c_str(), offset, offset + length, index, buffer.size);
    }
    return {buffer.bytes + offset, length};
}

Span GltfData::GetView(const Json& document, std::size_t view)
{
    Span& bytes = views_[view];
    if (bytes.bytes == nullptr) {
        const Json& json = document["bufferViews"][view];
        const Json* compressed = FindExtension(json, "EXT_meshopt_compression");
        bytes = compressed == nullptr ? Slice(json, "bufferViews[" + std::to_string(view) + "]")
                                      : Decompress(*compressed, GetSize(json, "byteLength"), view);
    }
    return bytes;
}

namespace
{

// Strides that a filter or a mode can have, by the extension's text.
bool IsMeshoptStrideValid(const std::string& mode, const std::string& filter, std::size_t stride,
                          std::size_t count)
{
    if (mode != "ATTRIBUTES") {
        return (stride == 2 || stride == 4) && filter.empty() &&
               (mode == "INDICES" || count % 3 == 0);
    }
    if (filter == "OCTAHEDRAL") {
        return stride == 4 || stride == 8;
    }
    return stride % 4 == 0 && (filter != "QUATERNION" || stride == 8);
}

bool DecodeMeshopt(const std::string& mode, std::uint8_t* out, std::size_t count,
                   std::size_t stride, const Span& in)
{
    if (mode == "ATTRIBUTES") {
        return meshopt_decodeVertexBuffer(out, count, stride, in.bytes, in.size) == 0;
    }
    if (mode == "TRIANGLES") {
        return meshopt_decodeIndexBuffer(out, count, stride, in.bytes, in.size) == 0;
    }
    return meshopt_decodeIndexSequence(out, count, stride, in.bytes, in.size) == 0;
}

void ApplyMeshoptFilter(const std::string& filter, std::uint8_t* data, std::size_t count,
                        std::size_t stride)
{
    if (filter == "OCTAHEDRAL") {
        meshopt_decodeFilterOct(data, count, stride);
    } else if (filter == "QUATERNION") {
        meshopt_decodeFilterQuat(data, count, stride);
    } else if (filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(data, count, stride);
    }
}

} // namespace

Span GltfData::Decompress(const Json& extension, std::size_t size, std::size_t view)
{
    const std::string place =
        "bufferViews[" + std::to_string(view) + "].extensions.EXT_meshopt_compression";
    const Span packed = Slice(extension, place);
    const std::size_t count = GetSize(extension, "count");
    const std::size_t stride = GetSize(extension, "byteStride");
    const std::string mode = GetText(extension, "mode");
    std::string filter = GetText(extension, "filter");
    filter = filter == "NONE" ? "" : filter;
    if (!IsMeshoptStrideValid(mode, filter, stride, count)) {
        Refuse(job_, "%s: %zu elements of %zu bytes do not fit mode %s and filter \"%s\"",
               place.c_str(), count, stride, mode.c_str(), filter.c_str());
    }
    // Both are below 2^48 and 2^9: no overflow.
    if (count * stride != size || size / kMaxCompression > packed.size) {
        Refuse(job_, "%s: %zu elements of %zu bytes do not make the view's %zu bytes out of %zu",
               place.c_str(), count, stride, size, packed.size);
    }
    Array<std::uint8_t> bytes(job_.context);
    bytes.Resize(size + PVT_SOURCE_PADDING);
    if (!DecodeMeshopt(mode, bytes.Data(), count, stride, packed)) {
        Refuse(job_, "%s: the compressed data is damaged", place.c_str());
    }
    ApplyMeshoptFilter(filter, bytes.Data(), count, stride);
    decoded_.push_back(std::move(bytes));
    return {decoded_.back().Data(), size};
}

} // namespace pvt
