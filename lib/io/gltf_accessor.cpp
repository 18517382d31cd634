// SPDX-License-Identifier: MIT
// Accessors: glTF 2.0, sections 3.6.2 and 5.1. Bytes are copied out one component at a time, since
// nothing promises that they are aligned.
#include "gltf_accessor.hpp"

#include <algorithm>
#include <cstring>

namespace pvt
{

namespace
{

// An accessor without data is all zero, whatever it counts; above this it is taken for an attack on
// memory: the largest real ones are sparse morph targets.
constexpr std::size_t kMaxEmptyCount = 1 << 24;
constexpr std::size_t kPollElements = 1 << 20;

std::size_t GetComponentSize(int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

// The columns of matrices of small components begin at multiples of four bytes.
std::size_t GetElementSize(int type, std::size_t componentSize)
{
    if (type == TINYGLTF_TYPE_MAT2 && componentSize == 1) {
        return 6; // the last column is not padded
    }
    if (type == TINYGLTF_TYPE_MAT3 && componentSize < 4) {
        return componentSize == 1 ? 11 : 22;
    }
    return static_cast<std::size_t>(
               tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(type))) *
           componentSize;
}

template <class T> double Load(const std::uint8_t* bytes)
{
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

double LoadComponent(const std::uint8_t* bytes, int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return Load<std::int8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return Load<std::uint8_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return Load<std::int16_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return Load<std::uint16_t>(bytes);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return Load<std::uint32_t>(bytes);
    default:
        return Load<float>(bytes);
    }
}

std::uint32_t LoadIndex(const std::uint8_t* bytes, int type)
{
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) {
        return *bytes;
    }
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
        std::uint16_t value;
        std::memcpy(&value, bytes, sizeof value);
        return value;
    }
    std::uint32_t value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

const char* GetTypeName(int type)
{
    switch (type) {
    case TINYGLTF_TYPE_SCALAR:
        return "SCALAR";
    case TINYGLTF_TYPE_VEC2:
        return "VEC2";
    case TINYGLTF_TYPE_VEC3:
        return "VEC3";
    case TINYGLTF_TYPE_VEC4:
        return "VEC4";
    default:
        return "MAT";
    }
}

// Whether count elements of `size` bytes, `stride` apart, lie in `room` bytes behind `offset`.
bool Fits(std::size_t count, std::size_t stride, std::size_t size, std::size_t offset,
          std::size_t room)
{
    if (count == 0) {
        return offset <= room;
    }
    // Strides are at most 252 and counts below 2^48, so that nothing overflows.
    return offset <= room && (count - 1) * stride + size <= room - offset;
}

} // namespace

const char* GetGltfComponentName(int type)
{
    static const char* const names[] = {"BYTE", "UNSIGNED_BYTE", "SHORT", "UNSIGNED_SHORT",
                                        "INT",  "UNSIGNED_INT",  "FLOAT"};
    const int place = type - TINYGLTF_COMPONENT_TYPE_BYTE;
    return place >= 0 && place < 7 ? names[place] : "another type";
}

double NormalizeGltf(double value, int type)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return std::max(value / 127.0, -1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return value / 255.0;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return std::max(value / 32767.0, -1.0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return value / 65535.0;
    default:
        return value;
    }
}

GltfAccessor::GltfAccessor(const GltfFile& file, std::size_t index)
{
    const tinygltf::Accessor& accessor = file.model.accessors[index];
    ReadType(file, accessor, index);
    BindView(file, accessor);
    if (accessor.sparse.isSparse) {
        BindSparse(file, accessor);
    }
}

GltfAccessor::GltfAccessor(const GltfFile& file, std::size_t index, const Span& elements)
{
    const tinygltf::Accessor& accessor = file.model.accessors[index];
    ReadType(file, accessor, index);
    if (elements.size / elementSize_ < count_) {
        Refuse(file.job, "%s counts %zu elements, but only %zu were decoded", name_.c_str(), count_,
               elements.size / elementSize_);
    }
    bytes_ = elements.bytes;
    stride_ = elementSize_;
    if (accessor.sparse.isSparse) {
        BindSparse(file, accessor);
    }
}

GltfAccessor::GltfAccessor(std::string name, const Span& indices)
    : name_(std::move(name)), count_(indices.size / sizeof(std::uint32_t)),
      stride_(sizeof(std::uint32_t)), elementSize_(sizeof(std::uint32_t)),
      type_(TINYGLTF_TYPE_SCALAR), componentType_(TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT),
      bytes_(indices.bytes)
{
}

void GltfAccessor::ReadType(const GltfFile& file, const tinygltf::Accessor& accessor,
                            std::size_t index)
{
    name_ = "accessors[" + std::to_string(index) + "]";
    count_ = accessor.count;
    type_ = accessor.type;
    componentType_ = accessor.componentType;
    normalized_ = accessor.normalized;
    const std::size_t componentSize = GetComponentSize(componentType_);
    if (componentSize == 0) {
        Refuse(file.job, "%s.componentType is %d, which glTF does not have", name_.c_str(),
               componentType_);
    }
    elementSize_ = GetElementSize(type_, componentSize);
}

void GltfAccessor::BindView(const GltfFile& file, const tinygltf::Accessor& accessor)
{
    const std::size_t view = static_cast<std::size_t>(accessor.bufferView);
    stride_ = elementSize_;
    if (view >= GetCount(file.document, "bufferViews")) {
        if (count_ > kMaxEmptyCount) {
            Refuse(file.job, PVT_LIMIT, "%s counts %zu elements, but has no data; at most %zu",
                   name_.c_str(), count_, kMaxEmptyCount);
        }
        return;
    }
    const Span bytes = file.data.GetView(file.document, view);
    const std::size_t stride = file.model.bufferViews[view].byteStride;
    if (stride != 0 && stride < elementSize_) {
        Refuse(file.job, "bufferViews[%zu].byteStride is %zu, but an element of %s has %zu bytes",
               view, stride, name_.c_str(), elementSize_);
    }
    stride_ = stride != 0 ? stride : elementSize_;
    if (!Fits(count_, stride_, elementSize_, accessor.byteOffset, bytes.size)) {
        Refuse(file.job,
               "%s counts %zu elements of %zu bytes, %zu apart, from byte %zu, but bufferViews[%zu]"
               " has only %zu bytes",
               name_.c_str(), count_, elementSize_, stride_, accessor.byteOffset, view, bytes.size);
    }
    bytes_ = bytes.bytes + accessor.byteOffset;
}

void GltfAccessor::BindSparse(const GltfFile& file, const tinygltf::Accessor& accessor)
{
    const auto& sparse = accessor.sparse;
    sparseCount_ = static_cast<std::size_t>(sparse.count);
    sparseIndexType_ = sparse.indices.componentType;
    if (sparseIndexType_ != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        sparseIndexType_ != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        sparseIndexType_ != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
        Refuse(file.job, "%s.sparse.indices.componentType is %d, which is no index type",
               name_.c_str(), sparseIndexType_);
    }
    const std::size_t indexSize = GetComponentSize(sparseIndexType_);
    const Span indices =
        file.data.GetView(file.document, static_cast<std::size_t>(sparse.indices.bufferView));
    const Span values =
        file.data.GetView(file.document, static_cast<std::size_t>(sparse.values.bufferView));
    const std::size_t indexOffset = static_cast<std::size_t>(sparse.indices.byteOffset);
    const std::size_t valueOffset = static_cast<std::size_t>(sparse.values.byteOffset);
    if (sparseCount_ > count_ ||
        !Fits(sparseCount_, indexSize, indexSize, indexOffset, indices.size) ||
        !Fits(sparseCount_, elementSize_, elementSize_, valueOffset, values.size)) {
        Refuse(file.job,
               "%s.sparse.count is %zu, which is more than its %zu elements, or than its indices "
               "or values have data for",
               name_.c_str(), sparseCount_, count_);
    }
    sparseIndices_ = indices.bytes + indexOffset;
    sparseValues_ = values.bytes + valueOffset;
    CheckSparseIndices(file);
}

// They must rise, which Find relies on.
void GltfAccessor::CheckSparseIndices(const GltfFile& file) const
{
    const std::size_t size = GetComponentSize(sparseIndexType_);
    std::uint64_t least = 0;
    for (std::size_t i = 0; i < sparseCount_; ++i) {
        const std::uint32_t index = LoadIndex(sparseIndices_ + i * size, sparseIndexType_);
        if (index < least || index >= count_) {
            Refuse(
                file.job,
                "%s.sparse: index %zu is %u; indices must rise and be less than the %zu elements",
                name_.c_str(), i, index, count_);
        }
        least = static_cast<std::uint64_t>(index) + 1;
        if (i % kPollElements == 0) {
            Poll(file.job.context);
        }
    }
}

const std::uint8_t* GltfAccessor::Find(std::size_t element) const
{
    std::size_t low = 0, high = sparseCount_;
    const std::size_t size = sparseCount_ > 0 ? GetComponentSize(sparseIndexType_) : 0;
    while (low < high) {
        const std::size_t middle = low + (high - low) / 2;
        const std::uint32_t index = LoadIndex(sparseIndices_ + middle * size, sparseIndexType_);
        if (index == element) {
            return sparseValues_ + middle * elementSize_;
        }
        (index < element ? low : high) = index < element ? middle + 1 : middle;
    }
    return bytes_ != nullptr ? bytes_ + element * stride_ : nullptr;
}

double GltfAccessor::GetNumber(std::size_t element, std::size_t component) const
{
    const std::uint8_t* bytes = Find(element);
    if (bytes == nullptr) {
        return 0.0;
    }
    const std::size_t offset = component * GetComponentSize(componentType_);
    const double value = LoadComponent(bytes + offset, componentType_);
    return normalized_ ? NormalizeGltf(value, componentType_) : value;
}

std::uint32_t GltfAccessor::GetIndex(std::size_t element) const
{
    const std::uint8_t* bytes = Find(element);
    return bytes != nullptr ? LoadIndex(bytes, componentType_) : 0;
}

pvtVec3 GltfAccessor::GetVec3(std::size_t element) const
{
    return {GetNumber(element, 0), GetNumber(element, 1), GetNumber(element, 2)};
}

std::string GltfAccessor::Describe() const
{
    return std::string(normalized_ ? "normalized " : "") + GetTypeName(type_) + " of " +
           GetGltfComponentName(componentType_);
}

} // namespace pvt
