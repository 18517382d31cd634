// SPDX-License-Identifier: MIT
// Elements of accessors: every component type, strided, normalised, sparse.
#ifndef PVT_IO_GLTF_ACCESSOR_HPP
#define PVT_IO_GLTF_ACCESSOR_HPP

#include "gltf_document.hpp"

namespace pvt
{

/// A document, its bytes, and what is asked of them.
struct GltfFile {
    const pvtLoadJob& job;
    const Json& document;
    const tinygltf::Model& model;
    GltfData& data;
};

/// "FLOAT" and the like.
const char* GetGltfComponentName(int type);

/// Integers that stand for fractions: glTF 2.0, section 3.11.
double NormalizeGltf(double value, int componentType);

/// An accessor whose every byte was found to lie in its buffer view.
class GltfAccessor
{
  public:
    GltfAccessor(const GltfFile& file, std::size_t index);
    /// The same with decoded elements, one behind the other, in the place of its view's bytes.
    GltfAccessor(const GltfFile& file, std::size_t index, const Span& elements);
    /// Indices that were decoded: a SCALAR of UNSIGNED_INT that no accessor describes.
    GltfAccessor(std::string name, const Span& indices);

    /// Where it stands in the file, such as "accessors[3]".
    const std::string& Name() const
    {
        return name_;
    }
    std::size_t Count() const
    {
        return count_;
    }
    /// The accessor's type and component type, such as "VEC3 of FLOAT", for messages.
    std::string Describe() const;
    bool Is(int type) const
    {
        return type_ == type;
    }
    int ComponentType() const
    {
        return componentType_;
    }
    bool IsNormalized() const
    {
        return normalized_;
    }

    /// `element` below Count(), `component` below the type's number of them.
    double GetNumber(std::size_t element, std::size_t component) const;
    /// Of a SCALAR of an unsigned type.
    std::uint32_t GetIndex(std::size_t element) const;
    /// Of a VEC3.
    pvtVec3 GetVec3(std::size_t element) const;

  private:
    void ReadType(const GltfFile& file, const tinygltf::Accessor& accessor, std::size_t index);
    void BindView(const GltfFile& file, const tinygltf::Accessor& accessor);
    void BindSparse(const GltfFile& file, const tinygltf::Accessor& accessor);
    void CheckSparseIndices(const GltfFile& file) const;
    /// Where the element's first component lies; null when it is zero.
    const std::uint8_t* Find(std::size_t element) const;

    std::string name_; // such as "accessors[3]"
    std::size_t count_ = 0, stride_ = 0, elementSize_ = 0;
    int type_ = 0, componentType_ = 0;
    bool normalized_ = false;
    const std::uint8_t* bytes_ = nullptr;
    std::size_t sparseCount_ = 0;
    int sparseIndexType_ = 0;
    const std::uint8_t* sparseIndices_ = nullptr;
    const std::uint8_t* sparseValues_ = nullptr;
};

} // namespace pvt

#endif
