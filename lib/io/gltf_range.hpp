// SPDX-License-Identifier: MIT
// An accessor's min and max: glTF 2.0, section 3.6.2.5. Nothing here is computed from them, but an
// accessor whose positions lie elsewhere than it says is damaged, or was put together wrongly.
#ifndef PVT_IO_GLTF_RANGE_HPP
#define PVT_IO_GLTF_RANGE_HPP

#include "gltf_accessor.hpp"

namespace pvt
{

/// "meshes[2].primitives[0]"
std::string GetGltfPlace(std::size_t mesh, std::size_t primitive);

class GltfRange
{
  public:
    /// Of a VEC3. `lossy`: what is behind it was rounded by a compression, the range was not.
    GltfRange(const GltfFile& file, std::size_t accessor, std::string place, bool lossy);

    /// Refuses a finite position that lies outside of the range by more than rounding.
    void Check(const pvtVec3& position, std::size_t element) const
    {
        const double values[3] = {position.x, position.y, position.z};
        for (std::size_t k = 0; k < 3; ++k) {
            // Written so that what is not a number passes: it is dropped later, with a warning.
            if (values[k] < lower_[k] || values[k] > upper_[k]) {
                Fail(values[k], k, element);
            }
        }
    }

  private:
    void Fail(double value, std::size_t axis, std::size_t element) const;

    const GltfFile& file_;
    std::size_t accessor_;
    std::string place_;
    double least_[3], most_[3];  // as the accessor says
    double lower_[3], upper_[3]; // with what rounding may add
};

} // namespace pvt

#endif
