// SPDX-License-Identifier: MIT
#include "draco_process.hpp"

#include "edge.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <sys/mman.h>
#include <unistd.h>

namespace pvt
{

namespace
{

// What the process takes in any case, and what the decoder takes for each byte that comes out, with
// its tables of corners and the attributes that nobody asks for: 5 for positions alone.
constexpr std::size_t kLeastMemory = 256 << 20;
constexpr std::size_t kMemoryPerByte = 16;
constexpr std::size_t kLeastSeconds = 10;
// Bytes that come out in a second, at the very least.
constexpr std::size_t kBytesPerSecond = 1 << 20;
constexpr const char* kRemedy = "compress it again, or export it without Draco";

// A file in memory, for the process to read.
class RequestFile
{
  public:
    explicit RequestFile(const pvtLoadJob& job)
        : job_(job), file_(memfd_create("paravent-draco", MFD_CLOEXEC))
    {
        if (file_ < 0) {
            Fail();
        }
    }
    ~RequestFile()
    {
        if (file_ >= 0) {
            close(file_);
        }
    }
    RequestFile(const RequestFile&) = delete;
    RequestFile& operator=(const RequestFile&) = delete;

    void Write(const void* bytes, std::size_t size)
    {
        const char* at = static_cast<const char*>(bytes);
        while (size > 0) {
            const ssize_t written = write(file_, at, size);
            if (written < 0 && errno == EINTR) {
                continue;
            }
            if (written <= 0) {
                Fail();
            }
            at += written;
            size -= static_cast<std::size_t>(written);
        }
    }
    int Get() const
    {
        return file_;
    }

  private:
    [[noreturn]] void Fail() const
    {
        Refuse(job_, PVT_OUT_OF_MEMORY, "Draco streams cannot be handed on: %s",
               std::strerror(errno));
    }

    const pvtLoadJob& job_;
    int file_;
};

// The decoded size that the counts ask for, as far as they are known. Elements have at most 16
// bytes.
std::size_t CountBytes(const DracoStream& stream)
{
    const std::uint64_t faces = stream.faceCount == PVT_DRACO_ANY ? 0 : stream.faceCount;
    // Counts are below 2^48.
    return faces * 12 + stream.pointCount * 16 * std::max<std::size_t>(1, stream.ids.size());
}

void WriteRequest(const std::vector<DracoStream>& streams, std::size_t mostFaces, RequestFile& file)
{
    pvtDracoRequest header{};
    std::memcpy(header.magic, PVT_DRACO_MAGIC, sizeof header.magic);
    header.version = PVT_DRACO_VERSION;
    header.streamCount = streams.size();
    for (const DracoStream& stream : streams) {
        header.idCount += stream.ids.size();
    }
    file.Write(&header, sizeof header);
    std::uint64_t offset = sizeof header + streams.size() * sizeof(pvtDracoStream) +
                           header.idCount * sizeof(std::uint32_t);
    std::uint64_t firstId = 0;
    for (const DracoStream& stream : streams) {
        const pvtDracoStream entry = {
            offset,           stream.bytes.size, firstId, stream.ids.size(), stream.pointCount,
            stream.faceCount, mostFaces};
        file.Write(&entry, sizeof entry);
        offset += stream.bytes.size;
        firstId += stream.ids.size();
    }
    for (const DracoStream& stream : streams) {
        file.Write(stream.ids.data(), stream.ids.size() * sizeof(std::uint32_t));
    }
    for (const DracoStream& stream : streams) {
        file.Write(stream.bytes.bytes, stream.bytes.size);
    }
}

std::size_t GetComponentSize(std::uint32_t type)
{
    return type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
}

} // namespace

DracoResult::DracoResult(const pvtLoadJob& job, const std::vector<DracoStream>& streams)
{
    std::size_t bytes = 0;
    bool isCounted = true;
    for (const DracoStream& stream : streams) {
        bytes += CountBytes(stream);
        isCounted = isCounted && stream.faceCount != PVT_DRACO_ANY;
    }
    const std::size_t free = pvtGetFreeBytes(job.context);
    const std::size_t most = free < SIZE_MAX - kLeastMemory ? free + kLeastMemory : free;
    const std::size_t wanted = isCounted ? kLeastMemory + kMemoryPerByte * bytes : most;
    RequestFile file(job);
    WriteRequest(streams, free / 12, file);
    pvtChildDef def{};
    def.program = "paravent-draco";
    def.purpose = "KHR_draco_mesh_compression";
    def.remedy = "build paravent with -DPARAVENT_DRACO=ON and libdraco-dev, name the program's "
                 "folder in PARAVENT_MODULE_PATH, or export the model without Draco";
    def.argument = "decode";
    def.input = file.Get();
    def.memory = std::min(wanted, most);
    def.seconds = kLeastSeconds + bytes / kBytesPerSecond;
    Check(pvtRunChild(&job, &def, &result_));
    try {
        CheckHeader(job, streams);
        Bind(job, streams);
    } catch (...) {
        pvtChildResult_Free(&result_); // no destructor runs for what was not constructed
        throw;
    }
}

void DracoResult::CheckHeader(const pvtLoadJob& job, const std::vector<DracoStream>& streams) const
{
    pvtDracoHeader header{};
    if (result_.size > 0) {
        std::memcpy(&header, result_.bytes, std::min(result_.size, sizeof header));
    }
    const DracoStream& stream = streams[header.current < streams.size() ? header.current : 0];
    const char* place = stream.place.c_str();
    if (result_.signal != 0) {
        Check(
            pvtFailOfSignal(&job, result_.signal, (stream.place + ": ").c_str(), "Draco", kRemedy));
    }
    if (std::memcmp(header.magic, PVT_DRACO_MAGIC, sizeof header.magic) != 0 ||
        header.version != PVT_DRACO_VERSION) {
        Refuse(job, "%s: Draco's decoder ended early (status %d); the data is damaged: %s", place,
               result_.exitCode, kRemedy);
    }
    if (header.status == PVT_DRACO_MISCOUNT) {
        const std::string wanted =
            stream.faceCount == PVT_DRACO_ANY ? "as many as fit" : std::to_string(stream.faceCount);
        Refuse(job, "%s holds %zu points and %zu triangles, but its accessors count %zu and %s",
               place, static_cast<std::size_t>(header.pointCount),
               static_cast<std::size_t>(header.faceCount),
               static_cast<std::size_t>(stream.pointCount), wanted.c_str());
    }
    if (header.status == PVT_DRACO_OUT_OF_MEMORY) {
        Refuse(job, PVT_LIMIT,
               "%s: Draco needs more memory than is left; raise the memory limit, or export the "
               "model without Draco",
               place);
    }
    if (header.status != PVT_DRACO_DONE) {
        header.text[sizeof header.text - 1] = '\0';
        Refuse(job, "%s: Draco refuses the data (%s); it is damaged: %s", place,
               Clean(header.text).c_str(), kRemedy);
    }
}

// count elements of `size` bytes at `offset` of the result.
Span DracoResult::Take(const pvtLoadJob& job, std::uint64_t offset, std::uint64_t count,
                       std::uint64_t size) const
{
    if (offset > result_.size || count > (result_.size - offset) / size) {
        Refuse(job, "Draco's decoder gave less than it says; the data is damaged: %s", kRemedy);
    }
    return {result_.bytes + offset, count * size};
}

void DracoResult::Bind(const pvtLoadJob& job, const std::vector<DracoStream>& streams)
{
    std::uint64_t nextMesh = sizeof(pvtDracoHeader);
    std::uint64_t nextAttribute = nextMesh + streams.size() * sizeof(pvtDracoMesh);
    for (const DracoStream& stream : streams) {
        pvtDracoMesh found;
        std::memcpy(&found, Take(job, nextMesh, 1, sizeof found).bytes, sizeof found);
        nextMesh += sizeof found;
        if (stream.faceCount != PVT_DRACO_ANY && found.faceCount != stream.faceCount) {
            Refuse(job,
                   "%s: Draco's decoder gave %zu triangles instead of %zu; the data is damaged: %s",
                   stream.place.c_str(), static_cast<std::size_t>(found.faceCount),
                   static_cast<std::size_t>(stream.faceCount), kRemedy);
        }
        DracoMesh mesh;
        mesh.indices = Take(job, found.indices, found.faceCount, 3 * sizeof(std::uint32_t));
        for (std::size_t i = 0; i < stream.ids.size(); ++i) {
            pvtDracoAttribute entry;
            std::memcpy(&entry, Take(job, nextAttribute, 1, sizeof entry).bytes, sizeof entry);
            nextAttribute += sizeof entry;
            DracoAttribute attribute;
            attribute.isFound = entry.isFound != 0;
            attribute.componentType = static_cast<int>(entry.componentType);
            attribute.componentCount = static_cast<int>(std::min(entry.componentCount, 255u));
            if (attribute.isFound && entry.componentType != 0 && entry.componentCount != 0) {
                const std::size_t size = GetComponentSize(entry.componentType) *
                                         static_cast<std::size_t>(attribute.componentCount);
                attribute.bytes = Take(job, entry.data, stream.pointCount, size);
            }
            mesh.attributes.push_back(attribute);
        }
        meshes_.push_back(std::move(mesh));
    }
}

} // namespace pvt
