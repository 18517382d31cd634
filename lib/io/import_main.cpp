// SPDX-License-Identifier: MIT
// paravent-import ENDING MEMORY SECONDS: reads a model from descriptor 3 by assimp, and writes a
// result (import_result.h) to descriptor 4. It opens no other file, whatever the model names.
#include "child_main.hpp"
#include "import_checks.hpp"
#include "import_result.h"

#include <assimp/BaseImporter.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

namespace
{

using pvt::Input;

class InputStream : public Assimp::IOStream
{
  public:
    explicit InputStream(const Input& input) : input_(input)
    {
    }
    size_t Read(void* out, size_t size, size_t count) override
    {
        const size_t left = size > 0 ? (input_.size - at_) / size : 0;
        const size_t got = std::min(count, left);
        std::memcpy(out, input_.bytes + at_, got * size);
        at_ += got * size;
        return got;
    }
    size_t Write(const void*, size_t, size_t) override
    {
        return 0;
    }
    aiReturn Seek(size_t offset, aiOrigin origin) override
    {
        const size_t base = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? at_ : input_.size;
        // From the end assimp's importers count backwards, as its own streams do.
        const size_t to = origin == aiOrigin_END ? base - offset : base + offset;
        if (to > input_.size) {
            return aiReturn_FAILURE;
        }
        at_ = to;
        return aiReturn_SUCCESS;
    }
    size_t Tell() const override
    {
        return at_;
    }
    size_t FileSize() const override
    {
        return input_.size;
    }
    void Flush() override
    {
    }

  private:
    const Input& input_;
    size_t at_ = 0;
};

// A file system with one file: no material library, no texture, no included scene can be reached.
class OneFile : public Assimp::IOSystem
{
  public:
    OneFile(const Input& input, const std::string& name) : input_(input), name_(name)
    {
    }
    bool Exists(const char* path) const override
    {
        return name_ == path;
    }
    char getOsSeparator() const override
    {
        return '/';
    }
    Assimp::IOStream* Open(const char* path, const char* mode) override
    {
        return Exists(path) && mode[0] == 'r' ? new InputStream(input_) : nullptr;
    }
    void Close(Assimp::IOStream* stream) override
    {
        delete stream;
    }

  private:
    const Input& input_;
    std::string name_;
};

// Exact positions of a mesh to their first places, by open addressing.
class Welder
{
  public:
    explicit Welder(std::size_t count) : slots_(RoundUp(2 * count + 2), 0)
    {
    }
    // The place of `position` in `positions`, where it is put if it is new.
    std::uint32_t Add(const float position[3], std::vector<float>& positions, std::size_t base)
    {
        std::uint32_t bits[3];
        std::memcpy(bits, position, sizeof bits);
        std::size_t slot = Hash(bits) & (slots_.size() - 1);
        for (; slots_[slot] != 0; slot = (slot + 1) & (slots_.size() - 1)) {
            const std::size_t place = slots_[slot] - 1;
            std::uint32_t known[3];
            std::memcpy(known, &positions[3 * (base + place)], sizeof known);
            if (std::equal(bits, bits + 3, known)) {
                return static_cast<std::uint32_t>(place);
            }
        }
        const std::size_t place = positions.size() / 3 - base;
        positions.insert(positions.end(), position, position + 3);
        slots_[slot] = static_cast<std::uint32_t>(place + 1);
        return static_cast<std::uint32_t>(place);
    }

  private:
    static std::size_t RoundUp(std::size_t count)
    {
        std::size_t size = 16;
        while (size < count) {
            size *= 2;
        }
        return size;
    }
    static std::size_t Hash(const std::uint32_t bits[3])
    {
        std::uint64_t hash = 0x9e3779b97f4a7c15u;
        for (int k = 0; k < 3; ++k) {
            hash = (hash ^ bits[k]) * 0xff51afd7ed558ccdu;
            hash ^= hash >> 32;
        }
        return static_cast<std::size_t>(hash);
    }

    std::vector<std::uint32_t> slots_; // place + 1; 0: free
};

struct Result {
    std::vector<pvtImportNode> nodes;
    std::vector<pvtImportMesh> meshes;
    std::vector<std::uint64_t> uses;
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    std::string names;
    std::uint64_t skinned = 0, morphed = 0;
};

void AddMesh(const aiMesh& mesh, Result& result)
{
    pvtImportMesh added{};
    added.firstPosition = result.positions.size() / 3;
    added.firstIndex = result.indices.size();
    Welder welder(mesh.mNumVertices);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        if (face.mNumIndices != 3) {
            continue; // points and lines
        }
        for (unsigned k = 0; k < 3; ++k) {
            const unsigned index = face.mIndices[k];
            if (index >= mesh.mNumVertices) {
                throw std::runtime_error("face " + std::to_string(f) + " refers to position " +
                                         std::to_string(index) + ", but there are only " +
                                         std::to_string(mesh.mNumVertices));
            }
            const aiVector3D& v = mesh.mVertices[index];
            const float position[3] = {v.x, v.y, v.z};
            result.indices.push_back(welder.Add(position, result.positions, added.firstPosition));
        }
        ++added.triangleCount;
    }
    added.positionCount = result.positions.size() / 3 - added.firstPosition;
    result.skinned += mesh.HasBones() ? 1 : 0;
    result.morphed += mesh.mNumAnimMeshes > 0 ? 1 : 0;
    result.meshes.push_back(added);
}

// The tree with parents before children, whatever its depth.
void AddNodes(const aiScene& scene, Result& result)
{
    struct Visit {
        const aiNode* node;
        std::uint64_t parent;
    };
    std::vector<Visit> stack = {{scene.mRootNode, 0}};
    std::map<std::vector<unsigned>, std::uint64_t> groups;
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const aiNode& node = *visit.node;
        const aiMatrix4x4& m = node.mTransformation;
        pvtImportNode added{};
        const float columns[16] = {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2,
                                   m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
        std::copy(columns, columns + 16, added.transform);
        added.parent = visit.parent;
        added.firstUse = result.uses.size();
        added.useCount = node.mNumMeshes;
        added.name = result.names.size();
        const std::vector<unsigned> uses(node.mMeshes, node.mMeshes + node.mNumMeshes);
        added.group = groups.emplace(uses, groups.size()).first->second;
        result.uses.insert(result.uses.end(), uses.begin(), uses.end());
        result.names.append(node.mName.C_Str()).push_back('\0');
        const std::uint64_t place = result.nodes.size();
        result.nodes.push_back(added);
        for (unsigned c = node.mNumChildren; c > 0; --c) {
            stack.push_back({node.mChildren[c - 1], place});
        }
    }
}

// Leaves the importer with nothing but what reads this ending, so that contents cannot choose.
void KeepOneLoader(Assimp::Importer& importer, const std::string& ending)
{
    for (std::size_t i = importer.GetImporterCount(); i > 0; --i) {
        Assimp::BaseImporter* loader = importer.GetImporter(i - 1);
        const std::string endings = std::string(" ") + loader->GetInfo()->mFileExtensions + " ";
        if (endings.find(" " + ending + " ") == std::string::npos) {
            importer.UnregisterLoader(loader);
            delete loader;
        }
    }
}

void CheckBytes(const Input& input, const std::string& ending)
{
    const std::string_view bytes(input.bytes, input.size);
    if (ending == "obj") {
        pvt::CheckObj(bytes);
    } else if (ending == "ply") {
        pvt::CheckPly(bytes);
    } else if (ending == "stl") {
        pvt::CheckStl(bytes);
    }
}

Result ReadModel(const Input& file, const std::string& ending)
{
    CheckBytes(file, ending);
    const std::string ended = ending == "ply" ? pvt::EndPlyHeader({file.bytes, file.size}) : "";
    const Input input = ended.empty() ? file : Input{ended.data(), ended.size()};
    const std::string name = "model." + ending;
    Assimp::Importer importer;
    KeepOneLoader(importer, ending);
    importer.SetIOHandler(new OneFile(input, name));
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_ANIMATIONS, false);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_READ_TEXTURES, false);
    const aiScene* scene = importer.ReadFile(name, aiProcess_Triangulate);
    if (scene == nullptr || scene->mRootNode == nullptr) {
        const std::string error = importer.GetErrorString();
        if (error.find("bad_alloc") != std::string::npos) {
            throw std::bad_alloc();
        }
        throw std::runtime_error("assimp refuses it: " + error);
    }
    Result result;
    for (unsigned i = 0; i < scene->mNumMeshes; ++i) {
        AddMesh(*scene->mMeshes[i], result);
    }
    AddNodes(*scene, result);
    return result;
}

template <class Container> void WriteArray(std::FILE* file, const Container& array)
{
    const std::size_t size = sizeof(typename Container::value_type);
    if (!array.empty() && std::fwrite(array.data(), size, array.size(), file) != array.size()) {
        throw std::bad_alloc(); // the result lies in memory
    }
}

void WriteResult(std::FILE* file, const Result& result, pvtImportHeader& header)
{
    header.nodeCount = result.nodes.size();
    header.meshCount = result.meshes.size();
    header.useCount = result.uses.size();
    header.positionCount = result.positions.size() / 3;
    header.indexCount = result.indices.size();
    header.nameBytes = result.names.size();
    header.skinnedCount = result.skinned;
    header.morphedCount = result.morphed;
    WriteArray(file, result.nodes);
    WriteArray(file, result.meshes);
    WriteArray(file, result.uses);
    WriteArray(file, result.positions);
    WriteArray(file, result.indices);
    WriteArray(file, result.names);
    if (std::fflush(file) != 0) {
        throw std::bad_alloc();
    }
}

// The status that goes into the header, and its text.
pvtImportStatus Run(const char* ending, std::FILE* file, pvtImportHeader& header)
{
    try {
        WriteResult(file, ReadModel(pvt::MapChildInput(), ending), header);
        return PVT_IMPORT_DONE;
    } catch (const std::bad_alloc&) {
        return PVT_IMPORT_OUT_OF_MEMORY;
    } catch (const std::exception& error) {
        (void)std::snprintf(header.text, sizeof header.text, "%s; export the model again",
                            error.what());
    } catch (...) {
        (void)std::snprintf(header.text, sizeof header.text, "assimp cannot read it");
    }
    return PVT_IMPORT_INVALID;
}

} // namespace

int main(int argc, char** argv)
{
    std::FILE* file = argc == 4 ? fdopen(PVT_CHILD_OUTPUT, "wb") : nullptr;
    if (file == nullptr) {
        (void)std::fprintf(stderr, "paravent-import is run by paravent, not by hand\n");
        return 1;
    }
    pvt::SetChildLimits(argv[2], argv[3]);
    std::string ending = argv[1];
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    pvtImportHeader header{};
    if (std::fwrite(&header, sizeof header, 1, file) != 1) {
        return 1;
    }
    header.status = Run(ending.c_str(), file, header);
    std::memcpy(header.magic, PVT_IMPORT_MAGIC, sizeof header.magic);
    header.version = PVT_IMPORT_VERSION;
    const bool written =
        pwrite(PVT_CHILD_OUTPUT, &header, sizeof header, 0) == static_cast<ssize_t>(sizeof header);
    // Nothing is torn down: the process ends here.
    _exit(written ? 0 : 1);
}
