// SPDX-License-Identifier: MIT
#include "draco_encoder.h"

#include <draco/compression/encode.h>
#include <draco/compression/expert_encode.h>

#include <cstring>

namespace
{

// Returns the attribute's place in the mesh.
int AddAttribute(draco::PointCloud& cloud, draco::GeometryAttribute::Type type, int components,
                 std::size_t count, const float* values)
{
    draco::GeometryAttribute attribute;
    const auto size = static_cast<std::int64_t>(sizeof(float)) * components;
    attribute.Init(type, nullptr, static_cast<std::uint8_t>(components), draco::DT_FLOAT32, false,
                   size, 0);
    const int id = cloud.AddAttribute(attribute, true, static_cast<std::uint32_t>(count));
    for (std::uint32_t i = 0; i < count; ++i) {
        cloud.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i),
                                               values + static_cast<std::size_t>(components) * i);
    }
    return id;
}

std::size_t Take(const draco::EncoderBuffer& buffer, std::uint8_t* out, std::size_t room)
{
    if (buffer.size() > room) {
        return 0;
    }
    std::memcpy(out, buffer.data(), buffer.size());
    return buffer.size();
}

// Attributes 0 and 1: something else, then the positions.
int AddAttributes(const DracoSource& source, draco::PointCloud& cloud)
{
    const std::vector<float> zeroes(source.pointCount, 0.0f);
    cloud.set_num_points(static_cast<std::uint32_t>(source.pointCount));
    AddAttribute(cloud, draco::GeometryAttribute::GENERIC, 1, source.pointCount, zeroes.data());
    return AddAttribute(cloud, draco::GeometryAttribute::POSITION, 3, source.pointCount,
                        source.positions);
}

std::size_t EncodeMesh(const DracoSource& source, std::uint8_t* out, std::size_t room,
                       std::size_t* pointCount)
{
    draco::Mesh mesh;
    const int positions = AddAttributes(source, mesh);
    mesh.SetNumFaces(source.triangleCount);
    for (std::uint32_t f = 0; f < source.triangleCount; ++f) {
        const std::uint32_t* corners = source.indices + 3 * std::size_t{f};
        mesh.SetFace(draco::FaceIndex(f),
                     {draco::PointIndex(corners[0]), draco::PointIndex(corners[1]),
                      draco::PointIndex(corners[2])});
    }
    draco::ExpertEncoder encoder(mesh);
    encoder.SetTrackEncodedProperties(true);
    encoder.SetEncodingMethod(source.isSequential ? draco::MESH_SEQUENTIAL_ENCODING
                                                  : draco::MESH_EDGEBREAKER_ENCODING);
    if (source.bits > 0) {
        encoder.SetAttributeQuantization(positions, source.bits);
    }
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeToBuffer(&buffer).ok()) {
        return 0;
    }
    *pointCount = encoder.num_encoded_points();
    return Take(buffer, out, room);
}

std::size_t EncodeCloud(const DracoSource& source, std::uint8_t* out, std::size_t room)
{
    draco::PointCloud cloud;
    AddAttributes(source, cloud);
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    return encoder.EncodePointCloudToBuffer(cloud, &buffer).ok() ? Take(buffer, out, room) : 0;
}

} // namespace

std::size_t EncodeDraco(const DracoSource* source, std::uint8_t* out, std::size_t room,
                        std::size_t* pointCount)
{
    *pointCount = source->pointCount;
    return source->isCloud ? EncodeCloud(*source, out, room)
                           : EncodeMesh(*source, out, room, pointCount);
}
