// SPDX-License-Identifier: MIT
// Levels of detail in glTF: the extension MSFT_lod, or plain nodes.
#include "gltf_original.hpp"
#include "gltf_save.hpp"

#include <unistd.h>

#include <vector>

namespace
{

constexpr const char* kExtension = "MSFT_lod";

std::vector<pvtSaveItem> ListItems(const pvtLevelSet& set)
{
    std::vector<pvtSaveItem> items(set.others, set.others + set.otherCount);
    items.insert(items.end(), set.levels, set.levels + set.levelCount);
    return items;
}

// The finest level's node names the others, which no scene holds: who does not know the extension
// sees the finest alone.
void LinkLevels(const pvtLevelSet& set, tinygltf::Model& model)
{
    const int finest = static_cast<int>(set.otherCount);
    tinygltf::Value::Array ids, coverages;
    for (std::size_t i = 0; i < set.levelCount; ++i) {
        coverages.emplace_back(set.coverages[i]);
        if (i > 0) {
            ids.emplace_back(finest + static_cast<int>(i));
        }
    }
    tinygltf::Value::Object extension, extras;
    extension["ids"] = tinygltf::Value(std::move(ids));
    tinygltf::Node& node = model.nodes[set.otherCount];
    if (node.extras.IsObject()) {
        extras = node.extras.Get<tinygltf::Value::Object>();
    }
    extras["MSFT_screencoverage"] = tinygltf::Value(std::move(coverages));
    node.extensions[kExtension] = tinygltf::Value(std::move(extension));
    node.extras = tinygltf::Value(std::move(extras));
    model.extensionsUsed.emplace_back(kExtension);
    model.scenes[0].nodes.resize(set.otherCount + 1);
}

struct OpenFile {
    OpenFile(pvtContext* context, const char* path)
    {
        pvt::Check(
            pvtOpenSource(context, path, pvtDefaultLoadOptions().maxBytes, &descriptor, &size));
    }
    ~OpenFile()
    {
        close(descriptor);
    }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    int descriptor = -1;
    std::size_t size = 0;
};

void WriteLevels(pvtContext* context, const pvtLevelSet& set, bool binary, pvtOutput* output)
{
    const std::vector<pvtSaveItem> items = ListItems(set);
    tinygltf::Model model = pvt::MakeGltfModel({context, items.data(), items.size()});
    // The extension asks for another level at least.
    if (set.coverages != nullptr && set.levelCount > 1) {
        LinkLevels(set, model);
    }
    const bool isAlone = set.original == nullptr;
    const std::string bytes = pvt::SerializeGltf(context, model, binary || !isAlone);
    if (isAlone) {
        pvtOutput_Write(output, bytes.data(), bytes.size());
        return;
    }
    const OpenFile file(context, set.original);
    const pvtLoadOptions options = pvtDefaultLoadOptions();
    const pvtLoadJob job = {context, &options, set.original, file.descriptor, file.size};
    pvt::GltfOriginal original(job);
    original.Append(bytes, set.scene);
    original.Write(binary, output);
}

} // namespace

pvtStatus pvtWriteLevels(pvtContext* context, const pvtLevelSet* set, bool binary,
                         pvtOutput* output)
{
    const char* what = set->original != nullptr ? set->original : "the glTF";
    return pvt::Guard(context, what, [&] { WriteLevels(context, *set, binary, output); });
}
