// SPDX-License-Identifier: MIT
// A glTF document with the bytes that it refers to.
#ifndef PVT_IO_GLTF_DOCUMENT_HPP
#define PVT_IO_GLTF_DOCUMENT_HPP

#include "gltf_container.hpp"
#include "gltf_schema.hpp"
#include "gltf_uri.hpp"
#include "tinygltf.hpp"

#include <vector>

namespace pvt
{

/// Bytes of buffers and of buffer views. Nothing outside of a span can be asked for.
class GltfData
{
  public:
    /// Loads every buffer: the GLB's binary chunk, data URIs, files beside the model. Data URIs
    /// are taken out of `document`, so that their text does not stay in memory.
    GltfData(const pvtLoadJob& job, Json& document, const GltfContainer& container);

    /// All bytes of a buffer; null bytes: it has none.
    Span GetBuffer(std::size_t index) const
    {
        return buffers_[index];
    }

    /// The bytes of a buffer view, decompressed when it is compressed. Refuses a view that does
    /// not lie in its buffer.
    Span GetView(const Json& document, std::size_t view);

  private:
    void LoadBuffer(Json& buffer, std::size_t index, const GltfContainer& container);
    void LoadUri(const std::string& uri, std::size_t index);
    void CheckSize(std::size_t index, std::size_t claimed);
    Span Slice(const Json& range, const std::string& place) const;
    Span Decompress(const Json& extension, std::size_t size, std::size_t view);

    const pvtLoadJob& job_;
    std::vector<Span> buffers_;
    std::vector<Span> views_; // null bytes: not asked for yet
    std::vector<OwnedSource> files_;
    std::vector<Array<std::uint8_t>> decoded_;
};

/// Refuses what is no JSON.
Json ParseGltfJson(const pvtLoadJob& job, const Span& text);

/// What tinygltf makes of the checked document. Buffers, images, animations and cameras are left
/// out: this room reads bytes itself, and needs no other. An accessor without a buffer view has a
/// number that is not below the document's number of views.
tinygltf::Model ParseGltfModel(const pvtLoadJob& job, const Json& document);

} // namespace pvt

#endif
