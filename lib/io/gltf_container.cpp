// SPDX-License-Identifier: MIT
// GLB: "glTF", version, length; then chunks of length, type, bytes (glTF 2.0, section 4.4).
#include "gltf_container.hpp"

#include <cstring>

namespace pvt
{

namespace
{

constexpr std::size_t kHeaderSize = 12, kChunkHeaderSize = 8;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
// No glTF that anybody means to use nests deeper, and parsers recurse.
constexpr int kMaxNesting = 64;

std::uint32_t ReadU32(const std::uint8_t* bytes)
{
    return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8 |
           static_cast<std::uint32_t>(bytes[2]) << 16 | static_cast<std::uint32_t>(bytes[3]) << 24;
}

// The part of the file that its header claims.
Span CheckHeader(const pvtLoadJob& job, const pvtSource& source)
{
    const Span file{source.bytes, source.size};
    if (file.size < kHeaderSize + kChunkHeaderSize) {
        Refuse(job, "the GLB ends after %zu bytes, within its header; it was cut short", file.size);
    }
    const std::uint32_t version = ReadU32(file.bytes + 4);
    if (version != 2) {
        Refuse(job, PVT_UNSUPPORTED, "GLB version %u is not supported; convert it to glTF 2.0",
               version);
    }
    const std::uint32_t length = ReadU32(file.bytes + 8);
    if (length > file.size) {
        Refuse(job, "its header says %u bytes, but the file has %zu; it was cut short", length,
               file.size);
    }
    if (length < kHeaderSize + kChunkHeaderSize) {
        Refuse(job, "its header says %u bytes, which is too few for any GLB", length);
    }
    return {file.bytes, length};
}

GltfContainer OpenGlb(const pvtLoadJob& job, const pvtSource& source)
{
    const Span file = CheckHeader(job, source);
    GltfContainer container;
    std::size_t at = kHeaderSize;
    for (int chunk = 0; at + kChunkHeaderSize <= file.size; ++chunk) {
        const std::uint32_t length = ReadU32(file.bytes + at);
        const std::uint32_t type = ReadU32(file.bytes + at + 4);
        const std::size_t left = file.size - at - kChunkHeaderSize;
        if (length > left) {
            Refuse(job,
                   "chunk %d of the GLB says %u bytes, but only %zu are left; it was cut short",
                   chunk, length, left);
        }
        const Span bytes{file.bytes + at + kChunkHeaderSize, length};
        if (chunk == 0 && type != kJsonChunk) {
            Refuse(job, "the first chunk of the GLB is not JSON (its type is 0x%08x)", type);
        }
        if (chunk == 0) {
            container.json = bytes;
        } else if (type == kBinaryChunk && container.binary.bytes == nullptr) {
            container.binary = bytes;
        }
        at += kChunkHeaderSize + length;
    }
    return container;
}

// Brackets outside of strings, counted before a parser sees them. Returns how many values there are
// about.
std::size_t CheckNesting(const pvtLoadJob& job, const Span& json)
{
    int depth = 0;
    bool inString = false;
    std::size_t valueCount = 1;
    for (std::size_t i = 0; i < json.size; ++i) {
        const char c = static_cast<char>(json.bytes[i]);
        if ((i & 0xfffff) == 0) {
            Poll(job.context);
        }
        if (inString) {
            i += c == '\\' ? 1 : 0;
            inString = c != '"';
        } else if (c == '"') {
            inString = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kMaxNesting) {
                Refuse(job, "the JSON nests deeper than %d levels at byte %zu", kMaxNesting, i);
            }
        } else if (c == ']' || c == '}') {
            --depth;
        } else if (c == ',' || c == ':') {
            ++valueCount;
        }
    }
    return valueCount;
}

// What parsers take is not counted by the context, so that it is asked for beforehand.
void CheckMemory(const pvtLoadJob& job, const Span& json, std::size_t valueCount)
{
    constexpr std::size_t bytesPerValue = 100, copies = 2; // this room's tree and tinygltf's
    const std::string purpose = std::string(job.path) + ": its JSON";
    Check(pvtCheckMemory(job.context, json.size + copies * bytesPerValue * valueCount,
                         purpose.c_str()));
}

} // namespace

GltfContainer OpenGltfContainer(const pvtLoadJob& job, const pvtSource& source)
{
    GltfContainer container;
    if (source.size >= 4 && std::memcmp(source.bytes, "glTF", 4) == 0) {
        container = OpenGlb(job, source);
    } else {
        container.json = {source.bytes, source.size};
    }
    CheckMemory(job, container.json, CheckNesting(job, container.json));
    return container;
}

} // namespace pvt
