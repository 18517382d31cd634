// SPDX-License-Identifier: MIT
// OBJ as text and PLY as little-endian binary, the two that every tool reads. Both hold floats, as
// glTF does, so that a mesh is the same in each.
#include "writer.hpp"

namespace
{

// An object's name ends at the end of its line, and some readers stop at a space.
std::string GetObjName(const pvtSaveJob& job, std::size_t index)
{
    std::string name = pvt::GetItemName(job, index);
    for (char& c : name) {
        const unsigned char byte = static_cast<unsigned char>(c);
        c = byte <= ' ' || byte == 0x7f ? '_' : c;
    }
    return name;
}

void WriteObj(const pvtSaveJob& job, pvtOutput* output)
{
    pvt::Writer writer(job.context, output);
    writer << "# paravent " << pvtGetVersion() << "\n";
    std::size_t base = 1; // OBJ counts from 1, through all objects
    for (std::size_t i = 0; i < job.count; ++i) {
        const pvtMesh& mesh = *job.items[i].mesh;
        writer << "o " << GetObjName(job, i) << "\n";
        for (std::size_t p = 0; p < mesh.positionCount; ++p) {
            const pvtVec3& v = mesh.positions[p];
            writer << "v ";
            writer.Number(static_cast<float>(v.x)) << " ";
            writer.Number(static_cast<float>(v.y)) << " ";
            writer.Number(static_cast<float>(v.z)) << "\n";
            writer.FlushIfFull();
        }
        for (std::size_t t = 0; t < mesh.triangleCount; ++t) {
            const std::uint32_t* index = mesh.indices + 3 * t;
            writer << "f ";
            writer.Number(base + index[0]) << " ";
            writer.Number(base + index[1]) << " ";
            writer.Number(base + index[2]) << "\n";
            writer.FlushIfFull();
        }
        base += mesh.positionCount;
    }
    writer.Flush();
}

void WritePlyHeader(const pvtSaveJob& job, pvt::Writer& writer)
{
    std::size_t positionCount = 0, triangleCount = 0;
    for (std::size_t i = 0; i < job.count; ++i) {
        positionCount += job.items[i].mesh->positionCount;
        triangleCount += job.items[i].mesh->triangleCount;
    }
    if (positionCount > UINT32_MAX) {
        throw pvt::Failure{pvtFail(job.context, PVT_LIMIT,
                                   "%zu positions are more than a PLY can index", positionCount)};
    }
    writer << "ply\nformat binary_little_endian 1.0\ncomment paravent " << pvtGetVersion()
           << "\nelement vertex ";
    writer.Number(positionCount)
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face ";
    writer.Number(triangleCount) << "\nproperty list uchar uint vertex_indices\nend_header\n";
}

// assimp, and what reads by it, takes a \n right behind the header for a part of it. So the first
// of the positions changes its place with one that begins otherwise.
class PlyOrder
{
  public:
    explicit PlyOrder(const pvtMesh& mesh)
    {
        while (first_ < mesh.positionCount && BeginsWithLineEnd(mesh.positions[first_])) {
            ++first_;
        }
        first_ = first_ < mesh.positionCount ? first_ : 0;
    }
    std::size_t operator[](std::size_t position) const
    {
        return position == 0 ? first_ : position == first_ ? 0 : position;
    }

  private:
    static bool BeginsWithLineEnd(const pvtVec3& position)
    {
        return (pvt::Writer::GetFloatBits(position.x) & 0xff) == '\n';
    }

    std::size_t first_ = 0;
};

void WritePly(const pvtSaveJob& job, pvtOutput* output)
{
    const PlyOrder order(*job.items[0].mesh);
    pvt::Writer writer(job.context, output);
    WritePlyHeader(job, writer);
    for (std::size_t i = 0; i < job.count; ++i) {
        const pvtMesh& mesh = *job.items[i].mesh;
        for (std::size_t p = 0; p < mesh.positionCount; ++p) {
            const pvtVec3& v = mesh.positions[i == 0 ? order[p] : p];
            writer.PutFloat(v.x);
            writer.PutFloat(v.y);
            writer.PutFloat(v.z);
            writer.FlushIfFull();
        }
    }
    std::uint32_t base = 0;
    for (std::size_t i = 0; i < job.count; ++i) {
        const pvtMesh& mesh = *job.items[i].mesh;
        for (std::size_t t = 0; t < mesh.triangleCount; ++t) {
            writer.PutByte(3);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t index = mesh.indices[3 * t + k];
                writer.PutU32(base + (i == 0 ? static_cast<std::uint32_t>(order[index]) : index));
            }
            writer.FlushIfFull();
        }
        base += static_cast<std::uint32_t>(mesh.positionCount);
    }
    writer.Flush();
}

} // namespace

pvtStatus pvtWriteObj(const pvtSaveJob* job, pvtOutput* output)
{
    return pvt::Guard(job->context, "the OBJ", [&] { WriteObj(*job, output); });
}

pvtStatus pvtWritePly(const pvtSaveJob* job, pvtOutput* output)
{
    return pvt::Guard(job->context, "the PLY", [&] { WritePly(*job, output); });
}
