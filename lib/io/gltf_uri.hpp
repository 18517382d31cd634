// SPDX-License-Identifier: MIT
// What a URI of a document names: data within it, or a file beside the model.
#ifndef PVT_IO_GLTF_URI_HPP
#define PVT_IO_GLTF_URI_HPP

#include "edge.hpp"
#include "gltf_container.hpp"

namespace pvt
{

/// A file that was read; freed with its owner.
class OwnedSource
{
  public:
    explicit OwnedSource(pvtContext* context) : context_(context)
    {
    }
    OwnedSource(OwnedSource&& other) noexcept
        : context_(other.context_), source(std::exchange(other.source, pvtSource{}))
    {
    }
    ~OwnedSource()
    {
        pvtSource_Free(context_, &source);
    }

  private:
    pvtContext* context_;

  public:
    pvtSource source{};
};

bool IsDataUri(const std::string& uri);

/// The bytes of a base64 data URI, which lie in `bytes`. `place` is whose URI it is, such as
/// "images[3]", for the messages of both.
Span DecodeDataUri(const pvtLoadJob& job, const std::string& uri, const std::string& place,
                   Array<std::uint8_t>& bytes);

/// The bytes of a file in the model's folder or below it; no scheme, nothing outside.
Span ReadUri(const pvtLoadJob& job, const std::string& uri, const std::string& place,
             OwnedSource& file);

} // namespace pvt

#endif
