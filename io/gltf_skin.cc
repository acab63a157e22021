// Skins and skeletons from glTF 2.0.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "io/gltf_clips.h"
#include "io/gltf_document.h"
#include "io/gltf_extensions.h"
#include "io/gltf_mesh.h"
#include "io/gltf_primitives.h"
#include "io/gltf_scene.h"

namespace strandcast {
namespace {

using nlohmann::json;

/// Splits a matrix into translation, rotation and scale, as the specification demands of a node's matrix.
JointTransform decomposed(const Placement& matrix, const GltfDocument& document, const std::string& part) {
  JointTransform out;
  out.translation = matrix.translation().cast<float>();
  Eigen::Matrix3d axes = matrix.linear();
  for (int c = 0; c < 3; ++c) {
    const double length = axes.col(c).norm();
    if (!(length > 0)) document.fail("the matrix has no inverse", part);
    out.scale[c] = static_cast<float>(length);
    axes.col(c) /= length;
  }
  if (axes.determinant() < 0) {
    axes.col(0) *= -1;
    out.scale.x() *= -1;
  }
  if (!((axes.transpose() * axes - Eigen::Matrix3d::Identity()).norm() < 1e-3))
    document.fail("the matrix shears", part, "export joints with translation, rotation and scale");
  out.rotation = Eigen::Quaterniond(axes).normalized().cast<float>();
  return out;
}

JointTransform localOf(const GltfDocument& document, const json& node, const std::string& part) {
  if (const auto matrix = gltfNodeMatrix(document, node, part)) return decomposed(*matrix, document, part);
  return gltfNodeTransform(document, node, part);
}

class SkinReader {
 public:
  SkinReader(const GltfDocument& document, GltfReport& report)
      : document_(document), report_(report), primitives_(document, report), morphs_(document, report) {}

  /// Reads the mesh and skeleton, and the clips if `with_clips`.
  SkinnedMesh read(bool with_clips) {
    tellOfAsset(document_, report_);
    const std::vector<GltfNode> nodes = sceneNodes(document_, report_);
    for (const GltfNode& visit : nodes) addNode(visit);
    rest_ = out_.skeleton.place(out_.skeleton.rest());
    if (with_clips) played_ = readGltfClips(document_, movable_, report_, out_);
    for (const auto& [node_and_target, target] : played_) {
      std::vector<bool>& played = movable_.meshes.at(node_and_target.first).played;
      played.resize(movable_.meshes.at(node_and_target.first).weights.size());
      played[node_and_target.second] = true;
    }
    for (const GltfNode& visit : nodes)
      if (visit.is_visible) addMeshOf(visit);
    tellOfWeights();
    out_.mesh = primitives_.take();
    if (skins_.empty() && played_.empty()) {
      const std::string without = report_.leftOutLine();
      document_.fail("no mesh of the scene has a skin or morph targets that are animated" +
                         (without.empty() ? "" : ", read " + without),
                     "skins", "export the body with its armature, or leave it rigid");
    }
    out_.bindTargets();
    out_.stored = std::move(out_.mesh.positions);
    out_.mesh.positions = out_.blended(rest_);
    for (size_t v = 0; v < out_.mesh.positions.size(); ++v)
      if (!out_.mesh.positions[v].allFinite())
        document_.fail(fmt::format("vertex {} is placed at no finite point", v), "skins");
    return std::move(out_);
  }

 private:
  void addNode(const GltfNode& visit) {
    const std::string part = gltfNodePart(visit.index);
    const json& node = document_.entry("nodes", visit.index, "a scene or node");
    movable_.joints[visit.index] = static_cast<uint32_t>(out_.skeleton.joints.size());
    const auto name = node.find("name");
    const bool named = name != node.end() && name->is_string();
    out_.skeleton.joints.push_back(
        {named ? name->get<std::string>() : part, visit.parent, localOf(document_, node, part)});
    const auto mesh = document_.unsignedMember(node, "mesh", part);
    if (mesh && visit.is_visible) movable_.meshes[visit.index] = morphs_.of(node, *mesh, part);
  }

  void addMeshOf(const GltfNode& visit) {
    const std::string part = gltfNodePart(visit.index);
    const json& node = document_.entry("nodes", visit.index, part);
    const auto mesh = document_.unsignedMember(node, "mesh", part);
    if (!mesh) return;
    if (const auto skin = document_.unsignedMember(node, "skin", part)) {
      if (hasInstances(node)) report_.leaveOut("instances of skinned meshes", part);
      return addMesh(visit, *mesh, skinBindings(*skin, part), skin, part);
    }
    const uint32_t joint = movable_.joints.at(visit.index);
    const std::vector<JointTransform> instances = gltfInstances(document_, node, part);
    if (instances.empty()) report_.leaveOut("meshes of no instance", part);
    for (const JointTransform& instance : instances)
      addMesh(visit, *mesh,
              nodeBinding(joint, hasInstances(node) ? instance.placement() : Placement::Identity()),
              std::nullopt, part);
  }

  void addMesh(const GltfNode& visit, uint64_t mesh, uint32_t first, std::optional<uint64_t> skin,
               const std::string& part) {
    const SkinBinding& example = out_.bindings[first];
    const bool mirrored = (rest_[example.joint] * example.inverse_bind).linear().determinant() < 0;
    primitives_.add(
        mesh, movable_.meshes.at(visit.index), GltfTransform::Identity(), mirrored, part,
        [&](const GltfPrimitives::Added& added) {
          if (skin)
            addInfluences(added, first, joints_of_skin_.at(*skin));
          else
            out_.influences.insert(out_.influences.end(), added.count, SkinInfluences{{{first, 1.0f}}});
          for (const auto& [number, moves] : added.moves)
            addMoves(played_.at({visit.index, number}), added.first, moves);
        });
  }

  void addMoves(uint32_t target, uint64_t first, const std::vector<Vec3>& moves) {
    for (size_t v = 0; v < moves.size(); ++v)
      if (!moves[v].isZero(0))
        out_.targets[target].moves.push_back({static_cast<uint32_t>(first + v), moves[v]});
  }

  uint32_t nodeBinding(uint32_t joint, const Placement& instance) {
    out_.bindings.push_back({joint, instance});
    return static_cast<uint32_t>(out_.bindings.size() - 1);
  }

  /// Index of the first binding of a skin. Its bindings are in the order of its joints.
  uint32_t skinBindings(uint64_t index, const std::string& asked_by) {
    const auto known = skins_.find(index);
    if (known != skins_.end()) return known->second;
    const std::string part = fmt::format("skins[{}]", index);
    const json& skin = document_.entry("skins", index, asked_by);
    const auto joints = skin.find("joints");
    if (joints == skin.end() || !joints->is_array() || joints->empty())
      document_.fail("the skin has no joints", part);
    std::vector<float> inverse;
    if (const auto accessor = document_.unsignedMember(skin, "inverseBindMatrices", part)) {
      if (document_.accessorCount(*accessor, "MAT4") < joints->size())
        document_.fail(
            fmt::format("there are fewer inverse bind matrices than its {} joints", joints->size()), part);
      inverse = document_.floats(*accessor, "MAT4", false, joints->size());
    }
    const auto first = static_cast<uint32_t>(out_.bindings.size());
    for (size_t j = 0; j < joints->size(); ++j) {
      const json& node = (*joints)[j];
      const auto joint =
          node.is_number_unsigned() ? movable_.joints.find(node.get<uint64_t>()) : movable_.joints.end();
      if (joint == movable_.joints.end())
        document_.fail(fmt::format("joint {} is no node of the scene", j), part);
      SkinBinding binding{joint->second, Placement::Identity()};
      if (!inverse.empty()) {
        const float* m = inverse.data() + 16 * j;
        if (!(std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) + std::abs(m[15] - 1) < 1e-3f))
          document_.fail(fmt::format("inverse bind matrix {} does not end with 0 0 0 1", j), part);
        for (int c = 0; c < 4; ++c)
          for (int r = 0; r < 3; ++r) binding.inverse_bind.matrix()(r, c) = static_cast<double>(m[4 * c + r]);
      }
      out_.bindings.push_back(binding);
    }
    joints_of_skin_[index] = joints->size();
    return skins_[index] = first;
  }

  void addInfluences(const GltfPrimitives::Added& added, uint32_t first, size_t joints) {
    const std::string& part = added.part;
    auto joint_sets = gltfSets(document_, added.attributes, "JOINTS_", part);
    auto weight_sets = gltfSets(document_, added.attributes, "WEIGHTS_", part);
    if (!joint_sets.contains(0) || !weight_sets.contains(0))
      document_.fail("its node has a skin but it has no JOINTS_0 or no WEIGHTS_0", part);
    std::vector<InfluenceSet> sets;
    for (const auto& [number, accessor] : joint_sets) {
      if (!weight_sets.contains(number)) {
        report_.leaveOut(fmt::format("JOINTS_{0}, as there is no WEIGHTS_{0}", number), part);
        continue;
      }
      const uint64_t weights = weight_sets.at(number);
      if (document_.accessorCount(accessor, "VEC4") != added.count ||
          document_.accessorCount(weights, "VEC4") != added.count)
        document_.fail(fmt::format("its joints and weights are not those of {} vertices", added.count), part);
      sets.push_back({document_.joints(accessor), document_.floats(weights, "VEC4", true)});
    }
    for (uint64_t v = 0; v < added.count; ++v)
      out_.influences.push_back(influencesOf(sets, v, first, joints, part));
  }

  struct InfluenceSet {
    std::vector<std::array<uint32_t, 4>> joints;
    std::vector<float> weights;
  };

  SkinInfluences influencesOf(const std::vector<InfluenceSet>& sets, uint64_t v, uint32_t first,
                              size_t joints, const std::string& part) {
    std::vector<SkinInfluence> all;
    for (const InfluenceSet& set : sets)
      for (size_t k = 0; k < 4; ++k) {
        float weight = set.weights[4 * v + k];
        if (weight < 0) ++below_zero_;
        weight = std::max(weight, 0.0f);
        if (weight > 0 && set.joints[v][k] >= joints)
          document_.fail(fmt::format("vertex {} hangs on joint {} of {}", v, set.joints[v][k], joints), part);
        all.push_back({weight > 0 ? first + set.joints[v][k] : 0, weight});
      }
    if (all.size() > 4) keepLargest(all);
    SkinInfluences influences;
    double sum = 0;
    for (size_t k = 0; k < 4; ++k) {
      influences[k] = all[k];
      sum += static_cast<double>(all[k].weight);
    }
    if (!(sum > 1e-6)) {
      ++weightless_;
      return {{{first, 1.0f}}};
    }
    for (SkinInfluence& influence : influences)
      influence.weight = static_cast<float>(static_cast<double>(influence.weight) / sum);
    return influences;
  }

  /// Merges influences of the same joint, then keeps the four largest.
  void keepLargest(std::vector<SkinInfluence>& all) {
    std::map<uint32_t, float> weights;
    double sum = 0;
    for (const SkinInfluence& influence : all) {
      if (influence.weight > 0) weights[influence.binding] += influence.weight;
      sum += static_cast<double>(influence.weight);
    }
    all.clear();
    for (const auto& [binding, weight] : weights) all.push_back({binding, weight});
    std::stable_sort(all.begin(), all.end(),
                     [](const SkinInfluence& a, const SkinInfluence& b) { return a.weight > b.weight; });
    if (all.size() > 4) {
      ++reduced_;
      largest_dropped_ = std::max(largest_dropped_, static_cast<double>(all[4].weight) / sum);
    }
    all.resize(4);
  }

  void tellOfWeights() {
    if (reduced_ > 0)
      report_.leaveOut(fmt::format("the weights beyond the four largest of {} vertices, of {:.3f} at most",
                                   reduced_, largest_dropped_));
    if (below_zero_ > 0) report_.warn(fmt::format("{} weights below 0 are taken as 0", below_zero_));
    if (weightless_ > 0)
      report_.warn(
          fmt::format("{} vertices have no weight: they go with the first joint of their skin", weightless_));
  }

  const GltfDocument& document_;
  GltfReport& report_;
  GltfPrimitives primitives_;
  GltfMorphs morphs_;
  SkinnedMesh out_;
  GltfMovable movable_;
  GltfPlayed played_;
  std::vector<Placement> rest_;         ///< world transforms of the joints at rest, in the file's units
  std::map<uint64_t, uint32_t> skins_;  ///< skin -> index of its first binding
  std::map<uint64_t, size_t> joints_of_skin_;
  uint64_t reduced_ = 0, below_zero_ = 0, weightless_ = 0;  ///< vertices, weights, vertices
  double largest_dropped_ = 0;                              ///< share of the sum of a vertex's weights
};

}  // namespace

SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const ReadBeside& read_beside, const GltfLimits& limits) {
  const GltfDocument document(bytes, name, read_beside, limits);
  GltfReport report;
  SkinnedMesh skin = SkinReader(document, report).read(true);
  skin.mesh.name = name;
  computeNormals(skin.mesh);
  skin.report = report.report();
  return skin;
}

TriangleMesh skinAtRest(const GltfDocument& document, GltfReport& report) {
  return SkinReader(document, report).read(false).mesh;
}

SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const GltfLimits& limits) {
  return readGltfSkin(bytes, name, ReadBeside(), limits);
}

}  // namespace strandcast
