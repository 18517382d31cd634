// SPDX-License-Identifier: MIT
// A glTF file that comes out again whole, with more in its scene.
#ifndef PVT_IO_GLTF_ORIGINAL_HPP
#define PVT_IO_GLTF_ORIGINAL_HPP

#include "gltf_document.hpp"

#include <optional>

namespace pvt
{

/// A file as JSON and pieces of bytes, which end up behind each other in one buffer.
class GltfOriginal
{
  public:
    /// Reads the file with all its buffers. Images beside it are taken in; one that cannot be is
    /// left where it is, with a warning.
    explicit GltfOriginal(const pvtLoadJob& job);

    /// Adds all nodes, meshes, materials and bytes of a GLB that this program made. The nodes of
    /// its scene join scene number `scene`; −1: the default scene, or the first.
    void Append(const std::string& glb, int scene);

    /// A GLB, or JSON that holds its buffer.
    void Write(bool binary, pvtOutput* output);

  private:
    std::size_t AddPiece(const Span& bytes);
    void TakeBuffers(const GltfContainer& container);
    void TakeImages();
    void TakeImage(Json& image, std::size_t index);
    Json& ChooseScene(int scene);
    void WriteGlb(pvtOutput* output) const;
    void WriteJson(pvtOutput* output);
    void WritePieces(pvtOutput* output) const;

    const pvtLoadJob& job_;
    OwnedSource file_;
    Json document_;
    std::optional<GltfData> data_; // made once the document is there
    std::vector<OwnedSource> images_;
    std::string added_; // the bytes of what was appended
    std::vector<Span> pieces_;
    std::size_t size_ = 0; // [bytes] of all pieces with the gaps between them
};

} // namespace pvt

#endif
