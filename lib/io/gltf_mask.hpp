// SPDX-License-Identifier: MIT
// Materials with alphaMode MASK: what their textures say of which surface.
#ifndef PVT_IO_GLTF_MASK_HPP
#define PVT_IO_GLTF_MASK_HPP

#include "alpha.h"
#include "gltf_accessor.hpp"

#include <array>
#include <map>
#include <optional>

namespace pvt
{

/// Freed with its owner.
class OwnedAlphaMap
{
  public:
    explicit OwnedAlphaMap(pvtContext* context) : context_(context)
    {
    }
    OwnedAlphaMap(const OwnedAlphaMap&) = delete;
    OwnedAlphaMap& operator=(const OwnedAlphaMap&) = delete;
    ~OwnedAlphaMap()
    {
        pvtAlphaMap_Free(context_, &map);
    }

  private:
    pvtContext* context_;

  public:
    pvtAlphaMap map{};
};

/// A material whose alpha is masked. Alpha is factor × vertex alpha × what the map says, and 1
/// stands for the map where there is none.
struct GltfMask {
    bool isKnown = false;             ///< false: there is no texture that can be looked at
    const pvtAlphaMap* map = nullptr; ///< null: the texture has no alpha
    double factor = 1.0, cutoff = 0.5;
    std::size_t texCoord = 0;
    /// From texture coordinates to texels, row after row: 2 × 3.
    std::array<double, 6> toTexels{};

    /// What the attribute of its texture coordinates is called: "TEXCOORD_0".
    std::string TexCoordName() const
    {
        return "TEXCOORD_" + std::to_string(texCoord);
    }
    /// The least value of the map that is opaque where a vertex has this alpha; 256 for none.
    int FindThreshold(double vertexAlpha) const;
};

/// A triangle of a mesh, parts of which may be transparent.
struct GltfCard {
    std::size_t triangle; // of the mesh
    const pvtAlphaMap* map;
    int threshold;       // of the map's values
    double texels[3][2]; // of the corners
};

/// The vertices of a masked primitive.
class MaskedPrimitive
{
  public:
    /// Its attributes, where it has them.
    struct Source {
        std::string place; // "meshes[0].primitives[1]"
        std::size_t positionCount;
        std::optional<GltfAccessor> texCoords, colors;
    };
    /// Refuses attributes that are not of the type, or not one a position.
    MaskedPrimitive(const pvtLoadJob& job, const GltfMask& mask, const Source& source);

    enum class Verdict { Opaque, Transparent, Mixed };
    /// The triangle with these three elements; when it is mixed, `card` is filled but for its
    /// place. Vertex alpha counts with its least value, which no point of the triangle falls below.
    Verdict Judge(const std::uint32_t elements[3], GltfCard& card) const;

  private:
    const GltfMask& mask_;
    std::optional<GltfAccessor> texCoords_, colors_;
};

/// The masks of a file, each found when it is asked for first.
class GltfMasks
{
  public:
    explicit GltfMasks(const GltfFile& file) : file_(file)
    {
    }
    const GltfMask& Find(std::size_t material);
    /// One warning for each image that cannot be looked at, saying why and what comes of it.
    void WarnOfUnreadable() const;

  private:
    /// An image and how it is wrapped along u and v.
    struct Key {
        std::size_t image;
        pvtWrap wraps[2];
        bool operator<(const Key& other) const;
    };
    /// What is known of its alpha.
    struct Texture {
        explicit Texture(pvtContext* context) : owned(context)
        {
        }
        OwnedAlphaMap owned; // without levels: it is opaque, or cannot be read
        int width = 1, height = 1;
        std::string failure;       // why it cannot be read; empty: it can
        std::size_t materials = 0; // that use it
    };

    GltfMask Read(std::size_t material);
    void ReadTexture(const Json& info, GltfMask& mask);
    std::optional<std::size_t> FindImage(std::size_t texture) const;
    pvtWrap FindWrap(std::size_t texture, const char* name) const;
    Texture& FindTexture(const Key& key);
    void LoadTexture(const Key& key, Texture& texture);

    const GltfFile& file_;
    std::map<std::size_t, GltfMask> masks_;
    std::map<Key, Texture> textures_;
    std::size_t textureless_ = 0; // materials without a texture, or one without an image
};

} // namespace pvt

#endif
