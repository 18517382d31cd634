// SPDX-License-Identifier: MIT
// paravent-draco NOTHING MEMORY SECONDS: decodes the Draco streams of a request on descriptor 3,
// and writes a result (draco_result.h) to descriptor 4. The decoder was seen to take seconds over a
// few kilobytes, and to give indices of points that are not there.
#include "child_main.hpp"
#include "draco_result.h"

#include <draco/compression/decode.h>

#include <cstdio>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace
{

using pvt::Input;

struct Miscount {
    std::uint64_t pointCount, faceCount;
};

// A request, bound to its bytes.
struct Request {
    pvtDracoRequest header;
    std::vector<pvtDracoStream> streams;
    std::vector<std::uint32_t> ids;
    const char* bytes;
};

template <class T>
std::vector<T> TakeArray(const Input& input, std::size_t& at, std::uint64_t count)
{
    if (count > (input.size - at) / sizeof(T)) {
        throw std::runtime_error("the request is damaged");
    }
    std::vector<T> array(count);
    if (count > 0) {
        std::memcpy(array.data(), input.bytes + at, count * sizeof(T));
    }
    at += count * sizeof(T);
    return array;
}

Request BindRequest(const Input& input)
{
    std::size_t at = 0;
    Request request;
    request.header = TakeArray<pvtDracoRequest>(input, at, 1)[0];
    if (std::memcmp(request.header.magic, PVT_DRACO_MAGIC, sizeof request.header.magic) != 0 ||
        request.header.version != PVT_DRACO_VERSION) {
        throw std::runtime_error("paravent-draco is of another version than paravent");
    }
    request.streams = TakeArray<pvtDracoStream>(input, at, request.header.streamCount);
    request.ids = TakeArray<std::uint32_t>(input, at, request.header.idCount);
    request.bytes = input.bytes;
    return request;
}

void Write(std::FILE* file, const void* bytes, std::size_t size)
{
    if (size > 0 && std::fwrite(bytes, size, 1, file) != 1) {
        throw std::bad_alloc(); // the result lies in memory
    }
}

// Data begins at multiples of eight bytes.
std::uint64_t BeginData(std::FILE* file)
{
    static const char zeroes[8] = {};
    const long at = std::ftell(file);
    if (at < 0) {
        throw std::bad_alloc();
    }
    Write(file, zeroes, static_cast<std::size_t>(-at & 7));
    return static_cast<std::uint64_t>((at + 7) & ~7L);
}

std::uint32_t GetComponentType(draco::DataType type)
{
    switch (type) {
    case draco::DT_INT8:
        return 5120;
    case draco::DT_UINT8:
        return 5121;
    case draco::DT_INT16:
        return 5122;
    case draco::DT_UINT16:
        return 5123;
    case draco::DT_UINT32:
        return 5125;
    case draco::DT_FLOAT32:
        return 5126;
    default:
        return 0;
    }
}

void WriteIndices(std::FILE* file, const draco::Mesh& mesh, pvtDracoMesh& result)
{
    result.faceCount = mesh.num_faces();
    result.indices = BeginData(file);
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
        const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(f));
        std::uint32_t corners[3];
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = face[k].value();
            if (corners[k] >= mesh.num_points()) {
                throw std::runtime_error("face " + std::to_string(f) + " refers to point " +
                                         std::to_string(corners[k]) + ", but there are only " +
                                         std::to_string(mesh.num_points()));
            }
        }
        Write(file, corners, sizeof corners);
    }
}

void WriteAttribute(std::FILE* file, const draco::Mesh& mesh, std::uint32_t id,
                    pvtDracoAttribute& result)
{
    const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
    if (attribute == nullptr) {
        return;
    }
    result.isFound = 1;
    result.componentType = GetComponentType(attribute->data_type());
    result.componentCount = static_cast<std::uint32_t>(attribute->num_components());
    if (result.componentType == 0 || result.componentCount == 0) {
        return; // whoever asked will see that it is nothing for glTF
    }
    result.data = BeginData(file);
    const std::size_t size =
        result.componentCount *
        static_cast<std::size_t>(draco::DataTypeLength(attribute->data_type()));
    const bool isMapped = !attribute->is_mapping_identity();
    for (std::uint32_t p = 0; p < mesh.num_points(); ++p) {
        const draco::AttributeValueIndex value =
            isMapped && p >= attribute->indices_map_size()
                ? draco::kInvalidAttributeValueIndex
                : attribute->mapped_index(draco::PointIndex(p));
        const std::uint8_t* bytes =
            value.value() < attribute->size() ? attribute->GetAddress(value) : nullptr;
        if (bytes == nullptr || !attribute->IsAddressValid(bytes + size - 1)) {
            throw std::runtime_error("attribute " + std::to_string(id) +
                                     " has no value for point " + std::to_string(p));
        }
        Write(file, bytes, size);
    }
}

void DecodeStream(std::FILE* file, const Request& request, const pvtDracoStream& stream,
                  pvtDracoMesh& mesh, pvtDracoAttribute* attributes)
{
    draco::DecoderBuffer buffer;
    buffer.Init(request.bytes + stream.offset, stream.size);
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) {
        throw std::runtime_error(decoded.status().error_msg());
    }
    const draco::Mesh& source = *decoded.value();
    const bool isCounted = stream.faceCount == PVT_DRACO_ANY
                               ? source.num_faces() <= stream.mostFaces
                               : source.num_faces() == stream.faceCount;
    if (source.num_points() != stream.pointCount || !isCounted) {
        throw Miscount{source.num_points(), source.num_faces()};
    }
    WriteIndices(file, source, mesh);
    for (std::uint64_t i = 0; i < stream.idCount; ++i) {
        WriteAttribute(file, source, request.ids[stream.firstId + i],
                       attributes[stream.firstId + i]);
    }
}

void DecodeAll(std::FILE* file, pvtDracoHeader& header)
{
    const Request request = BindRequest(pvt::MapChildInput());
    std::vector<pvtDracoMesh> meshes(request.streams.size());
    std::vector<pvtDracoAttribute> attributes(request.ids.size());
    const auto writeTables = [&] {
        if (std::fseek(file, 0, SEEK_SET) != 0) {
            throw std::bad_alloc();
        }
        Write(file, &header, sizeof header);
        Write(file, meshes.data(), meshes.size() * sizeof meshes[0]);
        Write(file, attributes.data(), attributes.size() * sizeof attributes[0]);
    };
    writeTables();
    for (std::size_t i = 0; i < request.streams.size(); ++i) {
        header.current = i;
        if (pwrite(PVT_CHILD_OUTPUT, &header.current, sizeof header.current,
                   offsetof(pvtDracoHeader, current)) != sizeof header.current) {
            throw std::bad_alloc();
        }
        DecodeStream(file, request, request.streams[i], meshes[i], attributes.data());
    }
    writeTables();
    if (std::fflush(file) != 0) {
        throw std::bad_alloc();
    }
}

// The status that goes into the header, and what it tells.
pvtDracoStatus Run(std::FILE* file, pvtDracoHeader& header)
{
    try {
        DecodeAll(file, header);
        return PVT_DRACO_DONE;
    } catch (const Miscount& miscount) {
        header.pointCount = miscount.pointCount;
        header.faceCount = miscount.faceCount;
        return PVT_DRACO_MISCOUNT;
    } catch (const std::bad_alloc&) {
        return PVT_DRACO_OUT_OF_MEMORY;
    } catch (const std::length_error&) {
        return PVT_DRACO_OUT_OF_MEMORY;
    } catch (const std::exception& error) {
        (void)std::snprintf(header.text, sizeof header.text, "%s", error.what());
    } catch (...) {
        (void)std::snprintf(header.text, sizeof header.text, "it cannot be decoded");
    }
    return PVT_DRACO_INVALID;
}

} // namespace

int main(int argc, char** argv)
{
    std::FILE* file = argc == 4 ? fdopen(PVT_CHILD_OUTPUT, "wb") : nullptr;
    if (file == nullptr) {
        (void)std::fprintf(stderr, "paravent-draco is run by paravent, not by hand\n");
        return 1;
    }
    pvt::SetChildLimits(argv[2], argv[3]);
    pvtDracoHeader header{};
    header.status = Run(file, header);
    std::memcpy(header.magic, PVT_DRACO_MAGIC, sizeof header.magic);
    header.version = PVT_DRACO_VERSION;
    const bool written =
        pwrite(PVT_CHILD_OUTPUT, &header, sizeof header, 0) == static_cast<ssize_t>(sizeof header);
    // Nothing is torn down: the process ends here.
    _exit(written ? 0 : 1);
}
