// SPDX-License-Identifier: MIT
#include "gltf_range.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pvt
{

namespace
{

// Writers round min and max to a few digits, and compression moves positions by half a step of
// their quantisation: five bits are the least that anybody uses.
constexpr double kRounding = 1e-4;
constexpr double kLoss = 1.0 / 32;
constexpr double kDigits = 1e-6;

bool IsCompressed(const GltfFile& file, const tinygltf::Accessor& accessor)
{
    const std::size_t view = static_cast<std::size_t>(accessor.bufferView);
    return view < GetCount(file.document, "bufferViews") &&
           FindExtension(file.document["bufferViews"][view], "EXT_meshopt_compression") != nullptr;
}

} // namespace

std::string GetGltfPlace(std::size_t mesh, std::size_t primitive)
{
    return "meshes[" + std::to_string(mesh) + "].primitives[" + std::to_string(primitive) + "]";
}

GltfRange::GltfRange(const GltfFile& file, std::size_t accessor, std::string place, bool lossy)
    : file_(file), accessor_(accessor), place_(std::move(place))
{
    const tinygltf::Accessor& source = file.model.accessors[accessor];
    std::fill_n(least_, 3, -std::numeric_limits<double>::infinity());
    std::fill_n(most_, 3, std::numeric_limits<double>::infinity());
    const auto read = [&](const std::vector<double>& values, const char* name, double* out) {
        if (!values.empty() && values.size() != 3) {
            Refuse(file.job, "%s: accessors[%zu].%s has %zu numbers; a VEC3 has 3", place_.c_str(),
                   accessor, name, values.size());
        }
        for (std::size_t k = 0; k < values.size(); ++k) {
            out[k] = source.normalized ? NormalizeGltf(values[k], source.componentType) : values[k];
        }
    };
    read(source.minValues, "min", least_);
    read(source.maxValues, "max", most_);
    double extent = 0.0, magnitude = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (least_[k] > most_[k]) {
            Refuse(file.job, "%s: accessors[%zu].min[%zu] is %.9g, which is more than max, %.9g",
                   place_.c_str(), accessor, k, least_[k], most_[k]);
        }
        if (std::isfinite(least_[k]) && std::isfinite(most_[k])) {
            extent = std::max(extent, most_[k] - least_[k]);
            magnitude = std::max({magnitude, std::fabs(least_[k]), std::fabs(most_[k])});
        }
    }
    const double slack =
        (lossy || IsCompressed(file, source) ? kLoss : kRounding) * extent + kDigits * magnitude;
    for (std::size_t k = 0; k < 3; ++k) {
        lower_[k] = least_[k] - slack;
        upper_[k] = most_[k] + slack;
    }
}

void GltfRange::Fail(double value, std::size_t axis, std::size_t element) const
{
    if (std::isinf(value)) {
        return; // dropped later, with a warning
    }
    const bool low = value < lower_[axis];
    Refuse(file_.job,
           "%s: element %zu has %c = %.9g, but accessors[%zu].%s says that it is at %s %.9g",
           place_.c_str(), element, "xyz"[axis], value, accessor_, low ? "min" : "max",
           low ? "least" : "most", low ? least_[axis] : most_[axis]);
}

} // namespace pvt
