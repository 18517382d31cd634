// SPDX-License-Identifier: MIT
// Masked triangles are cut once a mesh, in its own space, as closely as its largest instance asks.
#include "gltf_cut.hpp"

#include "mask_cut.h"

#include <algorithm>
#include <cmath>

namespace pvt
{

namespace
{

// Triangles that pieces may come to in all instances, pieces of one triangle, and cells of textures
// that are looked at. Beyond them the next coarser level is tried, at the last of which there are
// none. Fixed, so that the bytes do not depend on the machine.
constexpr std::size_t kMaxTriangles = std::size_t{4} << 20;
constexpr std::size_t kMaxPieces = std::size_t{1} << 18;
constexpr std::size_t kMaxCells = std::size_t{1} << 31;
constexpr std::size_t kPollPositions = 1 << 16;
constexpr std::uint32_t kNone = UINT32_MAX;

class OwnedPieceSet
{
  public:
    explicit OwnedPieceSet(pvtContext* context) : context_(context)
    {
    }
    OwnedPieceSet(const OwnedPieceSet&) = delete;
    OwnedPieceSet& operator=(const OwnedPieceSet&) = delete;
    ~OwnedPieceSet()
    {
        pvtPieceSet_Free(context_, &set);
    }

  private:
    pvtContext* context_;

  public:
    pvtPieceSet set{};
};

// A mesh without cards, under construction.
class MeshCutter
{
  public:
    MeshCutter(pvtContext* context, const GltfMesh& source, const pvtCutRules& rules)
        : context_(context), source_(source), rules_(rules), result_(context), moved_(context),
          owned_(context)
    {
        moved_.Resize(source.positions.Size());
        for (std::size_t i = 0; i < moved_.Size(); ++i) {
            moved_[i] = kNone;
        }
    }

    // False when pieces make more than `maxTriangles`, or too many cells have to be looked at.
    bool Cut(std::size_t maxTriangles, std::size_t maxCells)
    {
        std::size_t next = 0;
        const std::size_t count = source_.indices.Size() / 3;
        for (std::size_t t = 0; t < count; ++t) {
            if (t % kPollPositions == 0) {
                Poll(context_);
            }
            const bool isCard = next < source_.cards.Size() && source_.cards[next].triangle == t;
            if (isCard) {
                AddCard(source_.cards[next++]);
            } else {
                AddTriangle(t);
            }
            if (owned_.set.isTooMany || pieceTriangles_ > maxTriangles ||
                owned_.set.cellCount > maxCells) {
                return false;
            }
        }
        return true;
    }

    GltfMesh TakeResult()
    {
        return std::move(result_);
    }
    std::size_t PieceTriangles() const
    {
        return pieceTriangles_;
    }
    std::size_t CellCount() const
    {
        return owned_.set.cellCount;
    }

  private:
    std::uint32_t AddPosition(std::uint32_t index)
    {
        if (moved_[index] == kNone) {
            moved_[index] = AddPosition(source_.positions[index]);
        }
        return moved_[index];
    }

    std::uint32_t AddPosition(const pvtVec3& position)
    {
        result_.positions.Push(position);
        return static_cast<std::uint32_t>(result_.positions.Size() - 1);
    }

    void AddTriangle(std::size_t t)
    {
        for (std::size_t k = 0; k < 3; ++k) {
            result_.indices.Push(AddPosition(source_.indices[3 * t + k]));
        }
    }

    void AddCard(const GltfCard& card)
    {
        pvtMaskedTriangle triangle{};
        triangle.threshold = card.threshold;
        for (std::size_t k = 0; k < 3; ++k) {
            triangle.corners[k].position =
                source_.positions[source_.indices[3 * card.triangle + k]];
            triangle.corners[k].texel[0] = card.texels[k][0];
            triangle.corners[k].texel[1] = card.texels[k][1];
        }
        pvtPieceSet& set = owned_.set;
        Check(pvtCutMaskedTriangle(context_, card.map, &rules_, &triangle, &set));
        if (set.isWhole) {
            AddTriangle(card.triangle);
        }
        for (std::size_t i = 0; i < set.count; ++i) {
            AddPiece(card, set.pieces[i]);
        }
    }

    std::uint32_t AddPoint(const GltfCard& card, const pvtPiecePoint& point)
    {
        const std::size_t corner = static_cast<std::size_t>(std::max(point.corner, 0));
        return point.corner >= 0 ? AddPosition(source_.indices[3 * card.triangle + corner])
                                 : AddPosition(point.position);
    }

    // Convex: a fan.
    void AddPiece(const GltfCard& card, const pvtPiece& piece)
    {
        const pvtPiecePoint* points = owned_.set.points + piece.first;
        const std::uint32_t first = AddPoint(card, points[0]);
        std::uint32_t before = AddPoint(card, points[1]);
        for (std::size_t i = 2; i < piece.count; ++i) {
            const std::uint32_t at = AddPoint(card, points[i]);
            for (const std::uint32_t place : {first, before, at}) {
                result_.indices.Push(place);
            }
            before = at;
        }
        pieceTriangles_ += piece.count - 2;
    }

    pvtContext* context_;
    const GltfMesh& source_;
    pvtCutRules rules_;
    GltfMesh result_;
    Array<std::uint32_t> moved_; // where a position of the source is in the result
    OwnedPieceSet owned_;
    std::size_t pieceTriangles_ = 0;
};

// The largest factor by which an instance stretches an axis of its mesh.
double GetScale(const Transform& m)
{
    double scale = 0.0;
    for (std::size_t column = 0; column < 3; ++column) {
        const double* c = m.data() + 4 * column;
        scale = std::max(scale, std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]));
    }
    return scale;
}

class Cutter
{
  public:
    Cutter(const GltfFile& file, const std::vector<GltfInstance>& instances,
           std::map<std::size_t, UsedMesh>& meshes)
        : file_(file), instances_(instances), meshes_(meshes)
    {
    }

    void Run()
    {
        for (const GltfInstance& instance : instances_) {
            double& scale = scales_[instance.mesh];
            scale = std::max(scale, GetScale(instance.transform));
        }
        const double asked = file_.job.options->maskedCell;
        const double cell =
            asked > 0.0 ? asked : GetLongestSide() / file_.job.options->maskedResolution;
        int extraLevels = 0;
        while (!CutAll(cell, extraLevels)) {
            ++extraLevels;
        }
        if (extraLevels > 0) {
            Warn(file_.job,
                 "opaque parts of masked surfaces that are finer than %.3g do not count, since "
                 "looked at more closely they would be millions of triangles",
                 std::ldexp(cell, extraLevels));
        }
    }

  private:
    struct Extent {
        double least[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
        double most[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

        double LongestSide() const
        {
            return std::max({most[0] - least[0], most[1] - least[1], most[2] - least[2], 0.0});
        }
    };

    void Include(const GltfMesh& mesh, const Transform& m, Extent& extent) const
    {
        for (std::size_t i = 0; i < mesh.positions.Size(); ++i) {
            if (i % kPollPositions == 0) {
                Poll(file_.job.context);
            }
            const pvtVec3& p = mesh.positions[i];
            for (std::size_t k = 0; k < 3; ++k) {
                const double at = m[k] * p.x + m[4 + k] * p.y + m[8 + k] * p.z + m[12 + k];
                if (std::isfinite(at)) {
                    extent.least[k] = std::min(extent.least[k], at);
                    extent.most[k] = std::max(extent.most[k], at);
                }
            }
        }
    }

    // Of the box around all instances, cards included.
    double GetLongestSide() const
    {
        Extent extent;
        for (const GltfInstance& instance : instances_) {
            Include(meshes_.at(instance.mesh).mesh, instance.transform, extent);
        }
        return extent.LongestSide();
    }

    // In the mesh's own space. Meshes that are kept are looked at by themselves, each with as many
    // cells along its own longest side.
    double GetCell(std::size_t index, const GltfMesh& mesh, double cell) const
    {
        const pvtLoadOptions& options = *file_.job.options;
        if (!options.keepMeshes || options.maskedCell > 0.0) {
            return cell / scales_.at(index);
        }
        Extent extent;
        Include(mesh, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, extent);
        return extent.LongestSide() / options.maskedResolution;
    }

    // False, and nothing is changed, when too much comes out.
    bool CutAll(double cell, int extraLevels)
    {
        std::map<std::size_t, GltfMesh> results;
        std::size_t triangles = 0, cells = 0;
        for (const auto& [index, used] : meshes_) {
            if (used.mesh.cards.Size() == 0) {
                continue;
            }
            const pvtCutRules rules = {GetCell(index, used.mesh, cell), extraLevels, kMaxPieces};
            MeshCutter cutter(file_.job.context, used.mesh, rules);
            if (!cutter.Cut((kMaxTriangles - triangles) / used.uses, kMaxCells - cells)) {
                return false;
            }
            triangles += cutter.PieceTriangles() * used.uses;
            cells += cutter.CellCount();
            results.emplace(index, cutter.TakeResult());
        }
        for (auto& [index, mesh] : results) {
            meshes_.at(index).mesh = std::move(mesh);
        }
        return true;
    }

    const GltfFile& file_;
    const std::vector<GltfInstance>& instances_;
    std::map<std::size_t, UsedMesh>& meshes_;
    std::map<std::size_t, double> scales_; // by mesh
};

} // namespace

void CutMaskedMeshes(const GltfFile& file, const std::vector<GltfInstance>& instances,
                     std::map<std::size_t, UsedMesh>& meshes)
{
    const bool hasCards = std::any_of(meshes.begin(), meshes.end(), [](const auto& each) {
        return each.second.mesh.cards.Size() > 0;
    });
    if (hasCards) {
        Cutter(file, instances, meshes).Run();
    }
}

} // namespace pvt
