// SPDX-License-Identifier: MIT
// OBJ as text and PLY as little-endian binary, the two that every tool reads. Both hold floats, as
// glTF does, so that a mesh is the same in each; no locale has a say in how numbers look.
#include "edge.hpp"

#include <charconv>
#include <cstring>

namespace
{

// Bytes gathered before they are handed on.
constexpr std::size_t kPiece = 1 << 16;

class Writer
{
  public:
    explicit Writer(pvtContext* context, pvtOutput* output) : context_(context), output_(output)
    {
        text_.reserve(kPiece + 256);
    }

    Writer& operator<<(const char* text)
    {
        text_ += text;
        return *this;
    }
    Writer& operator<<(const std::string& text)
    {
        text_ += text;
        return *this;
    }
    // Numbers in the fewest digits that read back as the same number.
    template <class T> Writer& Number(T value)
    {
        char digits[48];
        const auto end = std::to_chars(digits, digits + sizeof digits, value);
        text_.append(digits, end.ptr);
        return *this;
    }
    void PutU32(std::uint32_t value)
    {
        for (int shift = 0; shift < 32; shift += 8) {
            text_.push_back(static_cast<char>(value >> shift & 0xff));
        }
    }
    void PutFloat(double value)
    {
        const float narrow = static_cast<float>(value);
        std::uint32_t bits;
        std::memcpy(&bits, &narrow, sizeof bits);
        PutU32(bits);
    }
    void PutByte(std::uint8_t value)
    {
        text_.push_back(static_cast<char>(value));
    }

    void FlushIfFull()
    {
        if (text_.size() >= kPiece) {
            Flush();
        }
    }
    void Flush()
    {
        pvt::Poll(context_);
        pvtOutput_Write(output_, text_.data(), text_.size());
        text_.clear();
    }

  private:
    pvtContext* context_;
    pvtOutput* output_;
    std::string text_;
};

std::string GetName(const pvtSaveJob& job, std::size_t index)
{
    const char* name = job.items[index].name;
    return name != nullptr && name[0] != '\0' ? name : "node_" + std::to_string(index);
}

// An object's name ends at the end of its line, and some readers stop at a space.
std::string GetObjName(const pvtSaveJob& job, std::size_t index)
{
    std::string name = GetName(job, index);
    for (char& c : name) {
        const unsigned char byte = static_cast<unsigned char>(c);
        c = byte <= ' ' || byte == 0x7f ? '_' : c;
    }
    return name;
}

void WriteObj(const pvtSaveJob& job, pvtOutput* output)
{
    Writer writer(job.context, output);
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

void WritePlyHeader(const pvtSaveJob& job, Writer& writer)
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

void WritePly(const pvtSaveJob& job, pvtOutput* output)
{
    Writer writer(job.context, output);
    WritePlyHeader(job, writer);
    for (std::size_t i = 0; i < job.count; ++i) {
        const pvtMesh& mesh = *job.items[i].mesh;
        for (std::size_t p = 0; p < mesh.positionCount; ++p) {
            writer.PutFloat(mesh.positions[p].x);
            writer.PutFloat(mesh.positions[p].y);
            writer.PutFloat(mesh.positions[p].z);
            writer.FlushIfFull();
        }
    }
    std::uint32_t base = 0;
    for (std::size_t i = 0; i < job.count; ++i) {
        const pvtMesh& mesh = *job.items[i].mesh;
        for (std::size_t t = 0; t < mesh.triangleCount; ++t) {
            writer.PutByte(3);
            for (std::size_t k = 0; k < 3; ++k) {
                writer.PutU32(base + mesh.indices[3 * t + k]);
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
