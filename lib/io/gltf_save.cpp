// SPDX-License-Identifier: MIT
// glTF 2.0 through tinygltf's stream writer, which gets no file of its own: it would not notice a
// full disk.
#include "gltf_save.hpp"
#include "placement.h"
#include "writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <unordered_map>
#include <unordered_set>

namespace
{

// tinygltf counts a file in 32 bits; base64 and JSON need their share.
constexpr std::size_t kMaxBufferSize = 0x70000000;
// 65535 in 16 bits would restart a strip.
constexpr std::size_t kMaxShortPositions = 65535;

using Bytes = std::vector<unsigned char>;

template <class T> void Append(Bytes& bytes, const T& value)
{
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

class Saver
{
  public:
    explicit Saver(const pvtSaveJob& job) : job_(job)
    {
    }

    tinygltf::Model Build()
    {
        CheckSize();
        model_.asset.version = "2.0";
        model_.asset.generator = std::string("paravent ") + pvtGetVersion();
        model_.buffers.resize(1);
        AddMaterial();
        tinygltf::Scene scene;
        for (std::size_t i = 0; i < job_.count; ++i) {
            pvt::Poll(job_.context);
            AddNode(i);
            scene.nodes.push_back(static_cast<int>(i));
        }
        model_.scenes.push_back(std::move(scene));
        model_.defaultScene = 0;
        return std::move(model_);
    }

  private:
    void CheckSize() const
    {
        std::size_t size = 0;
        std::unordered_set<const pvtMesh*> counted;
        for (std::size_t i = 0; i < job_.count; ++i) {
            const pvtMesh& mesh = *job_.items[i].mesh;
            if (counted.insert(&mesh).second) {
                size += 12 * mesh.positionCount + 12 * mesh.triangleCount;
            }
        }
        if (size > kMaxBufferSize) {
            throw pvt::Failure{pvtFail(job_.context, PVT_LIMIT,
                                       "%zu bytes of geometry are more than a glTF file of this "
                                       "program holds; save as PLY",
                                       size)};
        }
    }

    void AddMaterial()
    {
        tinygltf::Material material;
        material.name = "occluder";
        material.doubleSided = true;
        material.pbrMetallicRoughness.baseColorFactor = {0.8, 0.8, 0.8, 1.0};
        material.pbrMetallicRoughness.metallicFactor = 0.0;
        material.pbrMetallicRoughness.roughnessFactor = 1.0;
        model_.materials.push_back(std::move(material));
    }

    void AddNode(std::size_t index)
    {
        const pvtSaveItem& item = job_.items[index];
        tinygltf::Node node;
        node.name = GetName(index);
        node.mesh = FindMesh(*item.mesh, node.name);
        node.extras = MakeExtras(item);
        if (item.transform != nullptr) {
            Place(item.transform, node);
        }
        model_.nodes.push_back(std::move(node));
    }

    // The items of a mesh share one, which is named after the first of them.
    int FindMesh(const pvtMesh& mesh, const std::string& name)
    {
        const auto [found, isNew] = meshes_.emplace(&mesh, static_cast<int>(model_.meshes.size()));
        if (isNew) {
            tinygltf::Primitive primitive;
            primitive.attributes["POSITION"] = AddPositions(mesh);
            primitive.indices = AddIndices(mesh);
            primitive.material = 0;
            primitive.mode = TINYGLTF_MODE_TRIANGLES;
            tinygltf::Mesh made;
            made.name = name;
            made.primitives.push_back(std::move(primitive));
            model_.meshes.push_back(std::move(made));
        }
        return found->second;
    }

    // Only what differs from doing nothing. Transforms with shear do not come here.
    static void Place(const double* transform, tinygltf::Node& node)
    {
        pvtPlacement p;
        pvtFindPlacement(transform, &p);
        if (p.translation[0] != 0.0 || p.translation[1] != 0.0 || p.translation[2] != 0.0) {
            node.translation.assign(p.translation, p.translation + 3);
        }
        if (p.rotation[0] != 0.0 || p.rotation[1] != 0.0 || p.rotation[2] != 0.0) {
            node.rotation.assign(p.rotation, p.rotation + 4);
        }
        if (p.scale[0] != 1.0 || p.scale[1] != 1.0 || p.scale[2] != 1.0) {
            node.scale.assign(p.scale, p.scale + 3);
        }
    }

    // Valid UTF-8: the JSON writer throws at anything else.
    std::string CleanText(const char* text) const
    {
        return pvt::CopyClean(job_.context, text);
    }

    std::string GetName(std::size_t index) const
    {
        return CleanText(pvt::GetItemName(job_, index).c_str());
    }

    // Numbers stay doubles: tinygltf cuts integers to 32 bits.
    tinygltf::Value MakeExtras(const pvtSaveItem& item) const
    {
        tinygltf::Value::Object values;
        for (std::size_t i = 0; i < item.extraCount; ++i) {
            const pvtExtra& extra = item.extras[i];
            if (extra.text != nullptr) {
                values[CleanText(extra.key)] = tinygltf::Value(CleanText(extra.text));
            } else if (std::isfinite(extra.number)) {
                values[CleanText(extra.key)] = tinygltf::Value(extra.number);
            }
        }
        if (values.empty()) {
            return tinygltf::Value();
        }
        tinygltf::Value::Object extras;
        extras["paravent"] = tinygltf::Value(std::move(values));
        return tinygltf::Value(std::move(extras));
    }

    // A view of what was appended to the buffer since `begin`, which starts at a multiple of four.
    int AddView(std::size_t begin, int target)
    {
        Bytes& bytes = model_.buffers[0].data;
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = begin;
        view.byteLength = bytes.size() - begin;
        view.target = target;
        bytes.resize((bytes.size() + 3) / 4 * 4);
        model_.bufferViews.push_back(std::move(view));
        return static_cast<int>(model_.bufferViews.size()) - 1;
    }

    int AddPositions(const pvtMesh& mesh)
    {
        Bytes& bytes = model_.buffers[0].data;
        const std::size_t begin = bytes.size();
        tinygltf::Accessor accessor;
        accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
        accessor.type = TINYGLTF_TYPE_VEC3;
        accessor.count = mesh.positionCount;
        accessor.minValues.assign(3, HUGE_VAL);
        accessor.maxValues.assign(3, -HUGE_VAL);
        for (std::size_t i = 0; i < mesh.positionCount; ++i) {
            const pvtVec3& p = mesh.positions[i];
            const float coordinates[3] = {static_cast<float>(p.x), static_cast<float>(p.y),
                                          static_cast<float>(p.z)};
            Append(bytes, coordinates);
            for (std::size_t k = 0; k < 3; ++k) {
                const double value = coordinates[k];
                accessor.minValues[k] = std::min(accessor.minValues[k], value);
                accessor.maxValues[k] = std::max(accessor.maxValues[k], value);
            }
        }
        accessor.bufferView = AddView(begin, TINYGLTF_TARGET_ARRAY_BUFFER);
        model_.accessors.push_back(std::move(accessor));
        return static_cast<int>(model_.accessors.size()) - 1;
    }

    int AddIndices(const pvtMesh& mesh)
    {
        Bytes& bytes = model_.buffers[0].data;
        const std::size_t begin = bytes.size();
        const bool isShort = mesh.positionCount <= kMaxShortPositions;
        for (std::size_t i = 0; i < 3 * mesh.triangleCount; ++i) {
            if (isShort) {
                Append(bytes, static_cast<std::uint16_t>(mesh.indices[i]));
            } else {
                Append(bytes, mesh.indices[i]);
            }
        }
        tinygltf::Accessor accessor;
        accessor.componentType =
            isShort ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        accessor.type = TINYGLTF_TYPE_SCALAR;
        accessor.count = 3 * mesh.triangleCount;
        accessor.bufferView = AddView(begin, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
        model_.accessors.push_back(std::move(accessor));
        return static_cast<int>(model_.accessors.size()) - 1;
    }

    const pvtSaveJob& job_;
    tinygltf::Model model_;
    std::unordered_map<const pvtMesh*, int> meshes_;
};

} // namespace

namespace pvt
{

tinygltf::Model MakeGltfModel(const pvtSaveJob& job)
{
    return Saver(job).Build();
}

std::string SerializeGltf(pvtContext* context, const tinygltf::Model& model, bool binary)
{
    std::ostringstream stream;
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&model, stream, true, binary)) {
        throw Failure{pvtFail(context, PVT_OUTPUT_FAILED, "the glTF could not be put together")};
    }
    return stream.str();
}

} // namespace pvt

pvtStatus pvtWriteGltf(const pvtSaveJob* job, bool binary, pvtOutput* output)
{
    return pvt::Guard(job->context, "the glTF", [&] {
        const std::string bytes =
            pvt::SerializeGltf(job->context, pvt::MakeGltfModel(*job), binary);
        pvtOutput_Write(output, bytes.data(), bytes.size());
    });
}
