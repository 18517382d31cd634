// SPDX-License-Identifier: MIT
// From the checked JSON to tinygltf's model. tinygltf 2.7 opens any path that a URI names, follows
// image views out of bounds and drops what it does not understand: it gets neither bytes nor URIs.
#include "gltf_document.hpp"

namespace pvt
{

namespace
{

// tinygltf refuses indices without a buffer view, though they are valid. One more view stands for
// "none" in the copy that it gets.
void FillMissingViews(Json& document)
{
    const std::size_t none = GetCount(document, "bufferViews");
    const auto accessors = document.find("accessors");
    if (accessors == document.end()) {
        return;
    }
    for (Json& accessor : *accessors) {
        if (!accessor.contains("bufferView")) {
            accessor["bufferView"] = none;
        }
    }
    document["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
}

} // namespace

tinygltf::Model ParseGltfModel(const pvtLoadJob& job, const Json& document)
{
    static const char* const kept[] = {"asset", "scene",     "scenes",      "nodes",    "meshes",
                                       "skins", "accessors", "bufferViews", "materials"};
    Json reduced = Json::object();
    for (const char* name : kept) {
        const auto found = document.find(name);
        if (found != document.end()) {
            reduced[name] = *found;
        }
    }
    FillMissingViews(reduced);
    const std::string text = reduced.dump();
    if (text.size() > 0xffffffffu) {
        Refuse(job, PVT_LIMIT, "the JSON has %zu bytes; at most 4 GB are read", text.size());
    }
    tinygltf::TinyGLTF parser;
    tinygltf::Model model;
    std::string errors, warnings;
    if (!parser.LoadASCIIFromString(&model, &errors, &warnings, text.data(),
                                    static_cast<unsigned int>(text.size()), "", 0)) {
        Refuse(job, "tinygltf: %s", Clean(errors).c_str());
    }
    return model;
}

} // namespace pvt
