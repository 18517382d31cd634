// SPDX-License-Identifier: MIT
// Draco streams, decoded by the program paravent-draco in a process of its own.
#ifndef PVT_IO_DRACO_PROCESS_HPP
#define PVT_IO_DRACO_PROCESS_HPP

#include "child_process.h"
#include "draco_result.h"
#include "gltf_container.hpp"

#include <string>
#include <vector>

namespace pvt
{

/// What is asked for.
struct DracoStream {
    std::string place; ///< in the file, for messages
    Span bytes;
    std::uint64_t pointCount;
    std::uint64_t faceCount; ///< or PVT_DRACO_ANY
    std::vector<std::uint32_t> ids;
};

/// What came of it, checked to lie in the result.
struct DracoAttribute {
    bool isFound = false;
    int componentType = 0, componentCount = 0;
    Span bytes; ///< pointCount elements, one behind the other
};

struct DracoMesh {
    Span indices;                           ///< of uint32_t, all of points that are there
    std::vector<DracoAttribute> attributes; ///< in the order of the ids
};

/// A process's result; the spans above point into it.
class DracoResult
{
  public:
    /// Decodes all streams in one process. Throws with PVT_UNSUPPORTED where the program is not
    /// there; what the data did wrong is told with its stream's place.
    DracoResult(const pvtLoadJob& job, const std::vector<DracoStream>& streams);
    ~DracoResult()
    {
        pvtChildResult_Free(&result_);
    }
    DracoResult(const DracoResult&) = delete;
    DracoResult& operator=(const DracoResult&) = delete;

    const DracoMesh& Mesh(std::size_t stream) const
    {
        return meshes_[stream];
    }

  private:
    void CheckHeader(const pvtLoadJob& job, const std::vector<DracoStream>& streams) const;
    void Bind(const pvtLoadJob& job, const std::vector<DracoStream>& streams);
    Span Take(const pvtLoadJob& job, std::uint64_t offset, std::uint64_t count,
              std::uint64_t size) const;

    pvtChildResult result_{};
    std::vector<DracoMesh> meshes_;
};

} // namespace pvt

#endif
