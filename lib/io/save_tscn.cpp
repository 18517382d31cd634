// SPDX-License-Identifier: MIT
// A text scene of Godot 4: below a root an OccluderInstance3D an item, whose ArrayOccluder3D holds
// the triangles; items of one mesh share it. Axes are glTF's, and Godot's occlusion culling sees
// triangles from both sides, so that they stay as they are. What Godot reads is specified by its
// loader (ResourceLoaderText and VariantParser): it takes names as they stand and does not make
// them valid or unique.
#include "writer.hpp"

#include <cmath>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace
{

// Godot's own list for names of nodes, and it puts the same sign in their place.
std::string MakeNodeName(const pvtSaveJob& job, std::size_t index)
{
    std::string name = pvt::CopyClean(job.context, pvt::GetItemName(job, index).c_str());
    for (char& c : name) {
        if (std::strchr(".:@/\"%", c) != nullptr) {
            c = '_';
        }
    }
    return name;
}

// Siblings of one name would push each other out of the tree: later ones get a number, as Godot
// counts, from 2 on.
class NodeNames
{
  public:
    explicit NodeNames(const pvtSaveJob& job)
    {
        for (std::size_t i = 0; i < job.count; ++i) {
            names_.push_back(MakeUnique(MakeNodeName(job, i)));
        }
    }
    const std::string& operator[](std::size_t index) const
    {
        return names_[index];
    }

  private:
    std::string MakeUnique(const std::string& name)
    {
        std::size_t& number = numbers_.emplace(name, 1).first->second;
        std::string unique = name;
        while (!taken_.insert(unique).second) {
            unique = name + std::to_string(++number);
        }
        return unique;
    }

    std::vector<std::string> names_;
    std::unordered_set<std::string> taken_;
    std::unordered_map<std::string, std::size_t> numbers_; // the last one given to a name
};

std::string Quote(const std::string& text)
{
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            quoted += '\\';
        }
        quoted += c;
    }
    return quoted + '"';
}

// Godot holds floats. Without a point the loader takes a number for an integer, which has no
// negative zero.
void WriteFloat(pvt::Writer& writer, double value)
{
    const float narrow = static_cast<float>(value);
    if (narrow == 0.0F && std::signbit(narrow)) {
        writer << "-0.0";
    } else {
        writer.Number(narrow);
    }
}

void WriteOccluder(const pvtMesh& mesh, std::size_t number, pvt::Writer& writer)
{
    writer << "\n[sub_resource type=\"ArrayOccluder3D\" id=\"ArrayOccluder3D_";
    writer.Number(number) << "\"]\nvertices = PackedVector3Array(";
    for (std::size_t i = 0; i < mesh.positionCount; ++i) {
        const pvtVec3& p = mesh.positions[i];
        writer << (i == 0 ? "" : ", ");
        WriteFloat(writer, p.x);
        writer << ", ";
        WriteFloat(writer, p.y);
        writer << ", ";
        WriteFloat(writer, p.z);
        writer.FlushIfFull();
    }
    writer << ")\nindices = PackedInt32Array(";
    for (std::size_t i = 0; i < 3 * mesh.triangleCount; ++i) {
        writer << (i == 0 ? "" : ", ");
        writer.Number(mesh.indices[i]);
        writer.FlushIfFull();
    }
    writer << ")\n";
}

// What glTF holds under extras.paravent, as a dictionary.
void WriteMetadata(const pvtSaveJob& job, std::size_t index, pvt::Writer& writer)
{
    const pvtSaveItem& item = job.items[index];
    const char* before = "metadata/paravent = {\n";
    const char* after = "";
    for (std::size_t i = 0; i < item.extraCount; ++i) {
        const pvtExtra& extra = item.extras[i];
        if (extra.text == nullptr && !std::isfinite(extra.number)) {
            continue;
        }
        writer << before << Quote(pvt::CopyClean(job.context, extra.key)) << ": ";
        if (extra.text != nullptr) {
            writer << Quote(pvt::CopyClean(job.context, extra.text));
        } else {
            writer.Number(extra.number);
        }
        before = ",\n";
        after = "\n}\n";
    }
    writer << after;
}

// Row after row, and then the origin.
void WriteTransform(const double* transform, pvt::Writer& writer)
{
    writer << "transform = Transform3D(";
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            WriteFloat(writer, transform[4 * column + row]);
            writer << ", ";
        }
    }
    for (std::size_t row = 0; row < 3; ++row) {
        WriteFloat(writer, transform[12 + row]);
        writer << (row < 2 ? ", " : ")\n");
    }
}

// The meshes of the items, numbered from 1 on as they first come.
class Resources
{
  public:
    explicit Resources(const pvtSaveJob& job)
    {
        for (std::size_t i = 0; i < job.count; ++i) {
            if (numbers_.emplace(job.items[i].mesh, meshes_.size() + 1).second) {
                meshes_.push_back(job.items[i].mesh);
            }
        }
    }
    const std::vector<const pvtMesh*>& Meshes() const
    {
        return meshes_;
    }
    std::size_t operator[](const pvtMesh* mesh) const
    {
        return numbers_.at(mesh);
    }

  private:
    std::vector<const pvtMesh*> meshes_;
    std::unordered_map<const pvtMesh*, std::size_t> numbers_;
};

void WriteNode(const pvtSaveJob& job, std::size_t index, const std::string& name,
               std::size_t resource, pvt::Writer& writer)
{
    writer << "\n[node name=" << Quote(name) << " type=\"OccluderInstance3D\" parent=\".\"]\n";
    if (job.items[index].transform != nullptr) {
        WriteTransform(job.items[index].transform, writer);
    }
    writer << "occluder = SubResource(\"ArrayOccluder3D_";
    writer.Number(resource) << "\")\n";
    WriteMetadata(job, index, writer);
    writer.FlushIfFull();
}

void WriteTscn(const pvtSaveJob& job, pvtOutput* output)
{
    const NodeNames names(job);
    const Resources resources(job);
    pvt::Writer writer(job.context, output);
    writer << "[gd_scene load_steps=";
    writer.Number(resources.Meshes().size() + 1) << " format=3]\n";
    for (const pvtMesh* mesh : resources.Meshes()) {
        WriteOccluder(*mesh, resources[mesh], writer);
    }
    writer << "\n[node name=\"Occluders\" type=\"Node3D\"]\nmetadata/generator = "
           << Quote(std::string("paravent ") + pvtGetVersion()) << "\n";
    for (std::size_t i = 0; i < job.count; ++i) {
        WriteNode(job, i, names[i], resources[job.items[i].mesh], writer);
    }
    writer.Flush();
}

} // namespace

pvtStatus pvtWriteTscn(const pvtSaveJob* job, pvtOutput* output)
{
    return pvt::Guard(job->context, "the scene", [&] { WriteTscn(*job, output); });
}
