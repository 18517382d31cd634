// SPDX-License-Identifier: MIT
// The glTF reader: each step trusts only what the steps before it have checked.
#include "gltf_cut.hpp"

#include <cstdint>
#include <iterator>
#include <map>

namespace pvt
{

namespace
{

// Hands a parser its bytes, and asks now and then whether to stop.
class PolledBytes
{
  public:
    using iterator_category = std::input_iterator_tag;
    using value_type = char;
    using difference_type = std::ptrdiff_t;
    using pointer = const char*;
    using reference = char;

    PolledBytes(pvtContext* context, const std::uint8_t* at) : context_(context), at_(at)
    {
    }
    char operator*() const
    {
        return static_cast<char>(*at_);
    }
    PolledBytes& operator++()
    {
        if ((reinterpret_cast<std::uintptr_t>(++at_) & 0xffff) == 0) {
            Poll(context_);
        }
        return *this;
    }
    PolledBytes operator++(int)
    {
        const PolledBytes before = *this;
        ++*this;
        return before;
    }
    bool operator==(const PolledBytes& other) const
    {
        return at_ == other.at_;
    }
    bool operator!=(const PolledBytes& other) const
    {
        return at_ != other.at_;
    }

  private:
    pvtContext* context_;
    const std::uint8_t* at_;
};

class OwnedBuilder
{
  public:
    OwnedBuilder(const pvtLoadJob& job)
    {
        builder.context = job.context;
        builder.path = job.path;
        builder.keepsMeshes = job.options->keepMeshes;
    }
    ~OwnedBuilder()
    {
        pvtModelBuilder_Free(&builder);
    }
    OwnedBuilder(const OwnedBuilder&) = delete;
    OwnedBuilder& operator=(const OwnedBuilder&) = delete;
    pvtModelBuilder builder{};
};

std::map<std::size_t, UsedMesh> DecodeMeshes(GltfDecoder& decoder,
                                             const std::vector<GltfInstance>& instances)
{
    std::map<std::size_t, UsedMesh> meshes;
    for (const GltfInstance& instance : instances) {
        auto found = meshes.find(instance.mesh);
        if (found == meshes.end()) {
            found = meshes.emplace(instance.mesh, UsedMesh{decoder.Decode(instance.mesh), 0}).first;
        }
        ++found->second.uses;
    }
    return meshes;
}

void PlaceInstances(const std::vector<GltfInstance>& instances,
                    std::map<std::size_t, UsedMesh>& meshes, pvtModelBuilder& builder)
{
    std::size_t positionCount = 0, triangleCount = 0;
    for (const auto& [index, used] : meshes) {
        positionCount += used.mesh.positions.Size() * used.uses;
        triangleCount += used.mesh.indices.Size() / 3 * used.uses;
    }
    Check(pvtModelBuilder_Reserve(&builder, positionCount, triangleCount, instances.size()));
    for (const GltfInstance& instance : instances) {
        UsedMesh& used = meshes.at(instance.mesh);
        const pvtLocalMesh mesh = used.mesh.View();
        Check(pvtModelBuilder_AddPart(&builder, instance.name.c_str(), instance.mesh,
                                      instance.transform.data(), &mesh));
        if (--used.uses == 0) {
            used.mesh.positions.Clear();
            used.mesh.indices.Clear();
        }
    }
}

void LoadGltf(const pvtLoadJob& job, const pvtSource& source, pvtModel* model)
{
    const GltfContainer container = OpenGltfContainer(job, source);
    Json document = ParseGltfJson(job, container.json);
    CheckGltfSchema(job, document);
    GltfData data(job, document, container);
    const tinygltf::Model parsed = ParseGltfModel(job, document);
    const GltfFile file{job, document, parsed, data};
    pvtReportProgress(job.context, 0.6);

    const std::vector<GltfInstance> instances = FindGltfInstances(file);
    const GltfDraco draco(file, instances);
    GltfDecoder decoder(file, draco);
    std::map<std::size_t, UsedMesh> meshes = DecodeMeshes(decoder, instances);
    pvtReportProgress(job.context, 0.8);
    CutMaskedMeshes(file, instances, meshes);
    pvtReportProgress(job.context, 0.9);

    OwnedBuilder owned(job);
    PlaceInstances(instances, meshes, owned.builder);
    if (owned.builder.model.mesh.triangleCount == 0 && owned.builder.dropped == 0) {
        decoder.RefuseIfAllOmitted();
        decoder.RefuseIfTransparent();
        Refuse(job, "there is no triangle: %s; %s",
               instances.empty() ? "no node of the scene has a mesh"
                                 : "the scene's meshes hold at most points and lines",
               parsed.scenes.size() > 1 ? "choose another scene by --scene"
                                        : "export the model with its surfaces");
    }
    decoder.WarnOfOmissions();
    Check(pvtModelBuilder_Finish(&owned.builder, model));
}

} // namespace

Json ParseGltfJson(const pvtLoadJob& job, const Span& text)
{
    try {
        return Json::parse(PolledBytes(job.context, text.bytes),
                           PolledBytes(job.context, text.bytes + text.size));
    } catch (const Json::exception& error) {
        // "[json.exception.parse_error.101] parse error at line 1, ..."
        const std::string what = error.what();
        const std::size_t tag = what.find("] ");
        char clean[512];
        Refuse(job, "the JSON is not valid: %s",
               pvtCleanText(what.c_str() + (tag == std::string::npos ? 0 : tag + 2), clean,
                            sizeof clean));
    }
}

} // namespace pvt

pvtStatus pvtLoadGltf(const pvtLoadJob* job, const pvtSource* source, pvtModel* model)
{
    return pvt::Guard(job->context, job->path, [&] { pvt::LoadGltf(*job, *source, model); });
}
