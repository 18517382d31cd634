// SPDX-License-Identifier: MIT
// The node tree: glTF 2.0, sections 3.5.2 to 3.5.3 and 3.7.3. Walked with a stack of its own, since
// a file decides how deep it is.
#include "gltf_nodes.hpp"

#include "builder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace pvt
{

namespace
{

constexpr Transform kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
constexpr std::size_t kNone = static_cast<std::size_t>(-1);
constexpr std::size_t kPollNodes = 1 << 12;

Transform Multiply(const Transform& a, const Transform& b)
{
    Transform product;
    pvtMultiplyTransforms(a.data(), b.data(), product.data());
    return product;
}

// What is 0 or ±1 but for rounding is that: a quarter turn that was written as a quaternion moves
// nothing off its axis, and gives the same positions as the same turn written as a matrix.
double Straighten(double x)
{
    const double whole = std::round(x);
    return std::fabs(x - whole) < 1e-12 ? whole : x;
}

// Translation × rotation × scale. A quaternion that is not of unit length is taken for the rotation
// that it is nearest to; one of no length for none.
Transform Compose(const double t[3], const double q[4], const double s[3])
{
    const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double k = norm > 0.0 ? 2.0 / norm : 0.0;
    const double xx = k * q[0] * q[0], yy = k * q[1] * q[1], zz = k * q[2] * q[2];
    const double xy = k * q[0] * q[1], xz = k * q[0] * q[2], yz = k * q[1] * q[2];
    const double wx = k * q[3] * q[0], wy = k * q[3] * q[1], wz = k * q[3] * q[2];
    const double columns[3][3] = {{1 - yy - zz, xy + wz, xz - wy},
                                  {xy - wz, 1 - xx - zz, yz + wx},
                                  {xz + wy, yz - wx, 1 - xx - yy}};
    Transform transform = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, t[0], t[1], t[2], 1};
    for (std::size_t column = 0; column < 3; ++column) {
        for (std::size_t row = 0; row < 3; ++row) {
            transform[4 * column + row] = s[column] * Straighten(columns[column][row]);
        }
    }
    return transform;
}

Transform GetLocalTransform(const tinygltf::Node& node)
{
    if (node.matrix.size() == 16) {
        Transform transform;
        std::copy(node.matrix.begin(), node.matrix.end(), transform.begin());
        return transform;
    }
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    std::copy_n(node.translation.begin(), std::min<std::size_t>(3, node.translation.size()), t);
    std::copy_n(node.rotation.begin(), std::min<std::size_t>(4, node.rotation.size()), q);
    std::copy_n(node.scale.begin(), std::min<std::size_t>(3, node.scale.size()), s);
    return Compose(t, q, s);
}

// To a thousandth of what the larger one moves or scales by.
bool AreNearlyEqual(const Transform& a, const Transform& b)
{
    double largest = 0.0, difference = 0.0;
    for (std::size_t k = 0; k < 16; ++k) {
        largest = std::max({largest, std::fabs(a[k]), std::fabs(b[k])});
        difference = std::max(difference, std::fabs(a[k] - b[k]));
    }
    return difference <= 1e-3 * largest;
}

class Walker
{
  public:
    explicit Walker(const GltfFile& file)
        : file_(file), nodes_(file.model.nodes), parents_(nodes_.size(), kNone),
          globals_(nodes_.size(), kIdentity)
    {
        FindParents();
        ComputeGlobals();
    }

    std::vector<GltfInstance> Walk()
    {
        FindRoots();
        std::vector<Visit> stack;
        PushReversed(roots_, WantedNode().empty(), stack);
        for (std::size_t count = 0; !stack.empty(); ++count) {
            if (count % kPollNodes == 0) {
                Poll(file_.job.context);
            }
            const Visit visit = stack.back();
            stack.pop_back();
            const tinygltf::Node& node = nodes_[visit.node];
            const bool wanted = visit.wanted || node.name == WantedNode();
            found_ = found_ || wanted;
            if (wanted && node.mesh >= 0) {
                AddInstance(visit.node);
            }
            PushReversed(node.children, wanted, stack);
        }
        RefuseUnlessFound();
        if (skinned_ > 0) {
            Warn(file_.job, "skinned meshes that are taken in their bind pose: %zu", skinned_);
        }
        if (posed_ > 0) {
            Warn(file_.job,
                 "skinned meshes that stand in another pose than they were bound in: %zu; bake the "
                 "pose in if it is the one that is seen",
                 posed_);
        }
        return std::move(instances_);
    }

  private:
    /// Where a skin's meshes stand, and whether that is how the file shows them.
    struct BindPose {
        Transform transform;
        bool isShown;
    };
    struct Visit {
        std::size_t node;
        bool wanted; // the node asked for, or below it
    };

    std::string WantedNode() const
    {
        return file_.job.options->node != nullptr ? file_.job.options->node : "";
    }

    static void PushReversed(const std::vector<int>& nodes, bool wanted, std::vector<Visit>& stack)
    {
        for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) {
            stack.push_back({static_cast<std::size_t>(*it), wanted});
        }
    }

    void FindParents()
    {
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            for (const int child : nodes_[i].children) {
                std::size_t& parent = parents_[static_cast<std::size_t>(child)];
                if (parent != kNone) {
                    Refuse(file_.job,
                           "nodes[%d] is a child of nodes[%zu] and of nodes[%zu]; a node"
                           " may have one parent",
                           child, parent, i);
                }
                parent = i;
            }
        }
    }

    // From the roots down. With one parent each, what is not reached lies in a cycle.
    void ComputeGlobals()
    {
        std::vector<std::size_t>& queue = downwards_;
        queue.reserve(nodes_.size());
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (parents_[i] == kNone) {
                queue.push_back(i);
            }
        }
        std::vector<char> reached(nodes_.size(), 0);
        for (std::size_t at = 0; at < queue.size(); ++at) {
            const std::size_t i = queue[at];
            const Transform local = GetLocalTransform(nodes_[i]);
            globals_[i] = parents_[i] == kNone ? local : Multiply(globals_[parents_[i]], local);
            reached[i] = 1;
            queue.insert(queue.end(), nodes_[i].children.begin(), nodes_[i].children.end());
        }
        const auto lost = std::find(reached.begin(), reached.end(), 0);
        if (lost != reached.end()) {
            Refuse(file_.job, "nodes[%td] is an ancestor of itself", lost - reached.begin());
        }
    }

    // Those of the scene asked for; of a file without scenes, every node without a parent.
    void FindRoots()
    {
        const auto& scenes = file_.model.scenes;
        const int asked = file_.job.options->scene;
        if (asked >= 0 && static_cast<std::size_t>(asked) >= scenes.size()) {
            Refuse(file_.job, PVT_INVALID_ARGUMENT, "there is no scene %d; the file has %zu", asked,
                   scenes.size());
        }
        if (scenes.empty()) {
            for (std::size_t i = 0; i < nodes_.size(); ++i) {
                if (parents_[i] == kNone) {
                    roots_.push_back(static_cast<int>(i));
                }
            }
            return;
        }
        const int scene = asked >= 0 ? asked : std::max(file_.model.defaultScene, 0);
        roots_ = scenes[static_cast<std::size_t>(scene)].nodes;
        CheckRoots(scene);
    }

    void CheckRoots(int scene) const
    {
        std::vector<char> seen(nodes_.size(), 0);
        for (const int root : roots_) {
            const std::size_t i = static_cast<std::size_t>(root);
            if (parents_[i] != kNone) {
                Refuse(file_.job,
                       "scenes[%d] lists nodes[%d], which is not a root but a child of "
                       "nodes[%zu]",
                       scene, root, parents_[i]);
            }
            if (seen[i] != 0) {
                Refuse(file_.job, "scenes[%d] lists nodes[%d] twice", scene, root);
            }
            seen[i] = 1;
        }
    }

    void RefuseUnlessFound() const
    {
        if (found_ || WantedNode().empty()) {
            return;
        }
        const bool elsewhere = std::any_of(nodes_.begin(), nodes_.end(), [&](const auto& node) {
            return node.name == WantedNode();
        });
        Refuse(file_.job, PVT_INVALID_ARGUMENT, "there is no node named \"%s\"%s",
               Clean(WantedNode()).c_str(),
               elsewhere ? " in this scene, but in another; choose it by --scene" : "");
    }

    void AddInstance(std::size_t index)
    {
        const tinygltf::Node& node = nodes_[index];
        const std::size_t mesh = static_cast<std::size_t>(node.mesh);
        const std::string& meshName = file_.model.meshes[mesh].name;
        const std::string name = !node.name.empty()  ? node.name
                                 : !meshName.empty() ? meshName
                                                     : "node_" + std::to_string(index);
        Transform transform = globals_[index];
        if (node.skin >= 0) {
            ++skinned_;
            const BindPose& pose = GetBindPose(static_cast<std::size_t>(node.skin));
            posed_ += pose.isShown ? 0 : 1;
            transform = pose.transform;
        }
        const Json* instancing =
            FindExtension(file_.document["nodes"][index], "EXT_mesh_gpu_instancing");
        if (instancing == nullptr) {
            instances_.push_back({name, mesh, transform});
        } else {
            AddCopies({name, mesh, transform}, (*instancing)["attributes"],
                      "nodes[" + std::to_string(index) + "].extensions.EXT_mesh_gpu_instancing");
        }
    }

    // EXT_mesh_gpu_instancing: one instance for each element of its accessors, all of one count.
    void AddCopies(const GltfInstance& instance, const Json& attributes, const std::string& place)
    {
        const Attribute translation =
            FindAttribute(attributes, "TRANSLATION", TINYGLTF_TYPE_VEC3, place);
        const Attribute rotation = FindAttribute(attributes, "ROTATION", TINYGLTF_TYPE_VEC4, place);
        const Attribute scale = FindAttribute(attributes, "SCALE", TINYGLTF_TYPE_VEC3, place);
        std::size_t count = 0;
        for (const Attribute* attribute : {&translation, &rotation, &scale}) {
            if (*attribute && count != 0 && (*attribute)->Count() != count) {
                Refuse(file_.job, "%s: its attributes have %zu and %zu elements", place.c_str(),
                       count, (*attribute)->Count());
            }
            count = *attribute ? (*attribute)->Count() : count;
        }
        const std::string purpose = std::string(file_.job.path) + ": " + place;
        Check(pvtCheckMemory(file_.job.context, count * sizeof(GltfInstance), purpose.c_str()));
        instances_.reserve(instances_.size() + count);
        for (std::size_t i = 0; i < count; ++i) {
            if (i % kPollNodes == 0) {
                Poll(file_.job.context);
            }
            double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
            GetElement(translation, i, 3, t);
            GetElement(rotation, i, 4, q);
            GetElement(scale, i, 3, s);
            instances_.push_back(
                {instance.name, instance.mesh, Multiply(instance.transform, Compose(t, q, s))});
        }
    }

    using Attribute = std::optional<GltfAccessor>;

    Attribute FindAttribute(const Json& attributes, const char* name, int type,
                            const std::string& place) const
    {
        const auto found = attributes.find(name);
        if (found == attributes.end()) {
            return {};
        }
        GltfAccessor accessor(file_, found->get<std::size_t>());
        const bool isFloat = accessor.ComponentType() == TINYGLTF_COMPONENT_TYPE_FLOAT;
        const bool isFraction = accessor.IsNormalized() && type == TINYGLTF_TYPE_VEC4;
        if (!accessor.Is(type) || !(isFloat || isFraction)) {
            Refuse(file_.job, "%s.attributes.%s is a %s; it must be a %s of FLOAT%s", place.c_str(),
                   name, accessor.Describe().c_str(), type == TINYGLTF_TYPE_VEC3 ? "VEC3" : "VEC4",
                   type == TINYGLTF_TYPE_VEC3 ? "" : " or of a normalized type");
        }
        return accessor;
    }

    static void GetElement(const Attribute& attribute, std::size_t element, std::size_t count,
                           double* out)
    {
        for (std::size_t k = 0; attribute && k < count; ++k) {
            out[k] = attribute->GetNumber(element, k);
        }
    }

    // A skinned mesh ignores its node's transform (glTF 2.0, section 3.7.3.3). In the bind pose all
    // joints move it alike: by what the joint stands at, after what took the mesh to the joint's
    // space. Where they do not, the file shows them in another pose, and the one nearest to the
    // root, which carries the others, tells best where the whole stands.
    const BindPose& GetBindPose(std::size_t index)
    {
        const auto known = bindPoses_.find(index);
        return known != bindPoses_.end()
                   ? known->second
                   : bindPoses_.emplace(index, ComputeBindPose(index)).first->second;
    }

    BindPose ComputeBindPose(std::size_t index)
    {
        const tinygltf::Skin& skin = file_.model.skins[index];
        if (skin.joints.empty()) {
            Refuse(file_.job, "skins[%zu] has no joints", index);
        }
        const Attribute inverses = FindInverses(skin, index);
        std::size_t best = 0, leastDepth = kNone;
        for (std::size_t i = 0; i < skin.joints.size(); ++i) {
            const std::size_t depth = CountAncestors(static_cast<std::size_t>(skin.joints[i]));
            if (depth < leastDepth) {
                best = i;
                leastDepth = depth;
            }
        }
        BindPose pose = {GetSkinMatrix(skin, inverses, best), true};
        for (std::size_t i = 0; i < skin.joints.size() && pose.isShown; ++i) {
            pose.isShown = AreNearlyEqual(pose.transform, GetSkinMatrix(skin, inverses, i));
        }
        return pose;
    }

    Attribute FindInverses(const tinygltf::Skin& skin, std::size_t index) const
    {
        if (skin.inverseBindMatrices < 0) {
            return {};
        }
        GltfAccessor matrices(file_, static_cast<std::size_t>(skin.inverseBindMatrices));
        if (!matrices.Is(TINYGLTF_TYPE_MAT4) ||
            matrices.ComponentType() != TINYGLTF_COMPONENT_TYPE_FLOAT ||
            matrices.Count() < skin.joints.size()) {
            Refuse(file_.job,
                   "skins[%zu].inverseBindMatrices are not a MAT4 of FLOAT for each "
                   "of %zu joints",
                   index, skin.joints.size());
        }
        return matrices;
    }

    Transform GetSkinMatrix(const tinygltf::Skin& skin, const Attribute& inverses,
                            std::size_t joint) const
    {
        Transform inverse = kIdentity;
        GetElement(inverses, joint, 16, inverse.data());
        return Multiply(globals_[static_cast<std::size_t>(skin.joints[joint])], inverse);
    }

    std::size_t CountAncestors(std::size_t node)
    {
        if (depths_.empty()) {
            depths_.assign(nodes_.size(), 0);
            for (const std::size_t i : downwards_) {
                depths_[i] = parents_[i] == kNone ? 0 : depths_[parents_[i]] + 1;
            }
        }
        return depths_[node];
    }

    const GltfFile& file_;
    const std::vector<tinygltf::Node>& nodes_;
    std::vector<std::size_t> parents_;
    std::vector<Transform> globals_;
    std::vector<std::size_t> downwards_;        // all nodes, parents before their children
    std::vector<std::size_t> depths_;           // how many ancestors a node has
    std::map<std::size_t, BindPose> bindPoses_; // of skins
    std::vector<int> roots_;
    std::vector<GltfInstance> instances_;
    std::size_t skinned_ = 0, posed_ = 0;
    bool found_ = false;
};

} // namespace

std::vector<GltfInstance> FindGltfInstances(const GltfFile& file)
{
    return Walker(file).Walk();
}

} // namespace pvt
