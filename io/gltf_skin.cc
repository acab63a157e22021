// Skins, skeletons and animations from glTF 2.0 (specification, "Skins", "Animations").
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "io/file_report.h"
#include "io/gltf_document.h"
#include "io/gltf_mesh.h"
#include "io/gltf_scene.h"
#include "io/skinned_mesh.h"

namespace strandcast {
namespace {

using nlohmann::json;

/// Nodes that the animations of a document may move.
struct GltfMovable {
  std::map<uint64_t, uint32_t> joints;   ///< node -> joint of the skeleton
  std::map<uint64_t, GltfMorph> meshes;  ///< node -> morph targets of its mesh
};

/// Morph targets that are read: (node, number of the target) -> index into SkinnedMesh::targets.
using GltfPlayed = std::map<std::pair<uint64_t, size_t>, uint32_t>;

constexpr float kLargest = 1e9f;  ///< bound of a clip's numbers, so that results stay finite

class ClipReader {
 public:
  ClipReader(const GltfDocument& document, const GltfMovable& movable, GltfReport& report, SkinnedMesh& into)
      : document_(document), movable_(movable), report_(report), into_(into) {}

  GltfPlayed read() {
    const auto list = document_.root().find("animations");
    if (list == document_.root().end()) return {};
    if (!list->is_array()) document_.fail("this is not an array", "animations");
    for (size_t a = 0; a < list->size(); ++a) {
      const std::string part = fmt::format("animations[{}]", a);
      is_reported_ = false;
      try {
        SkeletonClip clip = readClip(document_.entry("animations", a, "animations"), part);
        if (!clip.isStill())
          into_.clips.push_back(std::move(clip));
        else if (!is_reported_)
          addOmission("animations that move nothing of the scene", part);
      } catch (const Error& error) {  // the body and other clips remain usable
        report_.addOmission(fmt::format("animations that cannot be read, as {}", error.what()), part);
      }
    }
    return std::move(played_);
  }

 private:
  void addOmission(const std::string& what, const std::string& part) {
    report_.addOmission(what, part);
    is_reported_ = true;
  }

  SkeletonClip readClip(const json& animation, const std::string& part) {
    SkeletonClip clip;
    const auto name = animation.find("name");
    clip.name = name != animation.end() && name->is_string() ? name->get<std::string>() : part;
    const auto channels = animation.find("channels");
    if (channels == animation.end() || !channels->is_array())
      document_.fail("the animation has no channels", part);
    std::map<std::pair<uint64_t, bool>, uint32_t> samplers;
    std::set<std::pair<uint32_t, ClipPath>> moved;
    std::set<uint64_t> weighed;  // nodes with a channel of weights
    for (size_t c = 0; c < channels->size(); ++c) {
      const std::string where = fmt::format("{}.channels[{}]", part, c);
      const json& description = (*channels)[c];
      if (const auto node = weighedNode(description, where)) {
        if (weighed.insert(*node).second)
          readWeights(animation, description, *node, part, where, clip);
        else
          addOmission("second channels of the weights of one node", where);
        continue;
      }
      const auto channel = readChannel(description, where);
      if (!channel) continue;
      const auto& [joint, path, sampler] = *channel;
      if (!moved.emplace(joint, path).second) document_.fail("two channels move the same of one node", where);
      const bool turns = path == ClipPath::kRotation;
      const auto [known, is_new] =
          samplers.try_emplace({sampler, turns}, static_cast<uint32_t>(clip.samplers.size()));
      if (is_new) {
        ClipSampler read = readSampler(animation, sampler, turns, part);
        if (read.times.empty()) {
          samplers.erase(known);
          addOmission("channels without keys", where);
          continue;
        }
        clip.samplers.push_back(std::move(read));
      }
      clip.channels.push_back({joint, path, known->second});
    }
    for (const ClipSampler& sampler : clip.samplers)
      clip.duration = std::max(clip.duration, static_cast<double>(sampler.times.back()));
    return clip;
  }

  /// The node whose weights of morph targets a channel moves; empty for other channels.
  std::optional<uint64_t> weighedNode(const json& channel, const std::string& part) const {
    const auto target = channel.is_object() ? channel.find("target") : channel.end();
    if (!channel.is_object() || target == channel.end() || !target->is_object()) return std::nullopt;
    const auto path = target->find("path");
    if (path == target->end() || *path != "weights") return std::nullopt;
    return document_.unsignedMember(*target, "node", part);
  }

  void readWeights(const json& animation, const json& channel, uint64_t node, const std::string& clip_part,
                   const std::string& where, SkeletonClip& clip) {
    const auto mesh = movable_.meshes.find(node);
    if (mesh == movable_.meshes.end()) {  // the node is in another scene, hidden or damaged
      if (!document_.entry("nodes", node, where).contains("mesh"))
        addOmission("weights of morph targets of nodes without a mesh", where);
      return;
    }
    try {
      const auto sampler = document_.unsignedMember(channel, "sampler", where);
      if (!sampler) document_.fail("the channel has no sampler", where);
      addWeights(readWeightSampler(animation, *sampler, mesh->second.weights.size(), clip_part), node,
                 mesh->second, clip);
    } catch (const Error& error) {
      addOmission(fmt::format("weights of morph targets that cannot be read, as {}", error.what()), where);
    }
  }

  /// Reads the weights of all targets of a mesh as one sampler: `targets` components per key.
  ClipSampler readWeightSampler(const json& animation, uint64_t index, size_t targets,
                                const std::string& clip) {
    const std::string part = fmt::format("{}.samplers[{}]", clip, index);
    const json& sampler = samplerOf(animation, index, part);
    ClipSampler out;
    out.components = static_cast<uint32_t>(targets);
    out.interpolation = interpolationOf(sampler, part);
    const auto [input, output] = accessorsOf(sampler, part);
    const uint64_t keys = document_.accessorCount(input, "SCALAR"),
                   values = document_.accessorCount(output, "SCALAR"),
                   each = targets * (out.interpolation == ClipInterpolation::kCubicSpline ? 3 : 1);
    if (keys == 0 || each == 0 || values != keys * each)
      document_.fail(fmt::format("{} weights do not fit {} keys of {} targets", values, keys, targets), part);
    spend(2 * values + keys * targets, part);  // later one sampler per target, each with the times
    out.times = document_.floats(input, "SCALAR", false);
    out.values = document_.floats(output, "SCALAR", true);
    checkTimes(out, part);
    checkValues(out, part);
    return out;
  }

  /// Adds a channel for each target whose weight ever differs from that at rest.
  void addWeights(const ClipSampler& all, uint64_t node, const GltfMorph& morph, SkeletonClip& clip) {
    const size_t targets = morph.weights.size();
    const bool cubic = all.interpolation == ClipInterpolation::kCubicSpline;
    const size_t rows = all.values.size() / targets;
    for (size_t t = 0; t < targets; ++t) {
      ClipSampler own;
      own.interpolation = all.interpolation;
      own.components = 1;
      bool moves = false;
      for (size_t row = 0; row < rows; ++row) {
        own.values.push_back(all.values[row * targets + t]);
        moves |= own.values.back() != (cubic && row % 3 != 1 ? 0.0f : morph.weights[t]);
      }
      if (!moves) continue;
      own.times = all.times;
      const auto [known, is_new] =
          played_.try_emplace({node, t}, static_cast<uint32_t>(into_.targets.size()));
      if (is_new) into_.targets.push_back({gltfTargetName(document_, node, t), morph.weights[t], {}});
      clip.morphs.push_back({known->second, static_cast<uint32_t>(clip.samplers.size())});
      clip.samplers.push_back(std::move(own));
    }
  }

  /// Joint, path and sampler of a channel; empty if the channel moves no joint of the skeleton.
  std::optional<std::tuple<uint32_t, ClipPath, uint64_t>> readChannel(const json& channel,
                                                                      const std::string& part) {
    const auto target = channel.is_object() ? channel.find("target") : channel.end();
    if (!channel.is_object() || target == channel.end() || !target->is_object())
      document_.fail("the channel has no target", part);
    const auto sampler = document_.unsignedMember(channel, "sampler", part);
    if (!sampler) document_.fail("the channel has no sampler", part);
    const auto node = document_.unsignedMember(*target, "node", part);
    const auto path = target->find("path");
    if (path == target->end() || !path->is_string()) document_.fail("the channel's target has no path", part);
    if (*path == "pointer") addOmission("channels of KHR_animation_pointer", part);
    if (!node || *path == "pointer" || *path == "weights") return std::nullopt;
    if (document_.entry("nodes", *node, part).contains("matrix"))
      document_.fail("a node with a matrix cannot be animated", part,
                     "export it with translation, rotation and scale");
    const auto joint = movable_.joints.find(*node);
    if (joint == movable_.joints.end()) return std::nullopt;  // the node is in another scene
    if (*path == "translation") return std::tuple(joint->second, ClipPath::kTranslation, *sampler);
    if (*path == "rotation") return std::tuple(joint->second, ClipPath::kRotation, *sampler);
    if (*path == "scale") return std::tuple(joint->second, ClipPath::kScale, *sampler);
    document_.fail("the channel's path is not translation, rotation, scale or weights", part);
  }

  const json& samplerOf(const json& animation, uint64_t index, const std::string& part) const {
    const auto list = animation.find("samplers");
    if (list == animation.end() || !list->is_array() || index >= list->size() || !(*list)[index].is_object())
      document_.fail("there is no such sampler", part);
    return (*list)[index];
  }

  ClipInterpolation interpolationOf(const json& sampler, const std::string& part) const {
    const auto interpolation = sampler.find("interpolation");
    if (interpolation == sampler.end() || *interpolation == "LINEAR") return ClipInterpolation::kLinear;
    if (*interpolation == "STEP") return ClipInterpolation::kStep;
    if (*interpolation != "CUBICSPLINE")
      document_.fail("the interpolation is not STEP, LINEAR or CUBICSPLINE", part);
    return ClipInterpolation::kCubicSpline;
  }

  /// Accessors of the sampler's times and values.
  std::pair<uint64_t, uint64_t> accessorsOf(const json& sampler, const std::string& part) const {
    const auto input = document_.unsignedMember(sampler, "input", part);
    const auto output = document_.unsignedMember(sampler, "output", part);
    if (!input || !output) document_.fail("the sampler has no input or no output", part);
    return {*input, *output};
  }

  /// Counts numbers towards GltfLimits::clip_values: clips, like meshes, may use the same data many times.
  void spend(uint64_t values, const std::string& part) {
    values_spent_ += values;
    if (values_spent_ > document_.limits().clip_values)
      document_.fail(fmt::format("the animations have more than {} numbers", document_.limits().clip_values),
                     part, "export fewer animations");
  }

  ClipSampler readSampler(const json& animation, uint64_t index, bool turns, const std::string& clip) {
    const std::string part = fmt::format("{}.samplers[{}]", clip, index);
    const json& sampler = samplerOf(animation, index, part);
    ClipSampler out;
    out.components = turns ? 4 : 3;
    out.interpolation = interpolationOf(sampler, part);
    const auto [input, output] = accessorsOf(sampler, part);
    const char* type = turns ? "VEC4" : "VEC3";
    const uint64_t keys = document_.accessorCount(input, "SCALAR"),
                   values = document_.accessorCount(output, type);
    if (values != keys * (out.interpolation == ClipInterpolation::kCubicSpline ? 3 : 1))
      document_.fail(fmt::format("{} values do not fit {} keys", values, keys), part);
    spend(keys + values * out.components, part);
    out.times = document_.floats(input, "SCALAR", false);
    out.values = document_.floats(output, type, turns);
    checkTimes(out, part);
    checkValues(out, part);
    if (turns) checkRotations(out, part);
    return out;
  }

  void checkValues(const ClipSampler& sampler, const std::string& part) const {
    for (const float value : sampler.values)
      if (!(std::abs(value) <= kLargest))
        document_.fail(fmt::format("a value is beyond {:g}", kLargest), part);
  }

  void checkTimes(const ClipSampler& sampler, const std::string& part) const {
    constexpr float kLongest = 1e6f;  // s
    for (size_t k = 0; k < sampler.times.size(); ++k) {
      if (!(sampler.times[k] >= 0 && sampler.times[k] <= kLongest))
        document_.fail(fmt::format("the time of key {} is not 0 to {:g} s", k, kLongest), part);
      if (k > 0 && !(sampler.times[k] > sampler.times[k - 1]))
        document_.fail(fmt::format("key {} is not later than the one before", k), part);
    }
  }

  void checkRotations(const ClipSampler& sampler, const std::string& part) const {
    const size_t slots = sampler.interpolation == ClipInterpolation::kCubicSpline ? 3 : 1;
    for (size_t k = 0; k < sampler.times.size(); ++k) {
      const Eigen::Map<const Eigen::Vector4f> q(sampler.values.data() + 4 * (slots * k + slots / 2));
      const float length = q.norm();
      if (!(length > 0.5f && length < 2))
        document_.fail(fmt::format("the rotation of key {} is not of unit length", k), part);
    }
  }

  const GltfDocument& document_;
  const GltfMovable& movable_;
  GltfReport& report_;
  SkinnedMesh& into_;
  GltfPlayed played_;
  uint64_t values_spent_ = 0;
  bool is_reported_ = false;  ///< part of the current animation was reported as left out
};

/// Reads the animations into SkinnedMesh::clips. Morph targets whose weight ever differs from that at rest
/// are added to SkinnedMesh::targets, still without vertices. An animation that cannot be read is left out
/// and reported; so is a single channel of weights that cannot be read.
GltfPlayed readGltfClips(const GltfDocument& document, const GltfMovable& movable, GltfReport& report,
                         SkinnedMesh& into) {
  return ClipReader(document, movable, report, into).read();
}

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
  SkinReader(const GltfDocument& document, GltfReport& report, BodyTargets targets = BodyTargets::kClip)
      : document_(document),
        report_(report),
        read_targets_(targets),
        primitives_(document, report),
        morphs_(document, report) {}

  /// Reads the mesh and skeleton, and the clips if `with_clips`.
  SkinnedMesh read(bool with_clips) {
    reportAsset(document_, report_);
    const std::vector<GltfNode> nodes = sceneNodes(document_, report_);
    for (const GltfNode& visit : nodes) addNode(visit);
    out_.rig = gltfRig(document_, nodes);
    rest_ = out_.skeleton.worldTransforms(out_.skeleton.rest());
    if (with_clips) played_ = readGltfClips(document_, movable_, report_, out_);
    if (read_targets_ == BodyTargets::kAll) addOtherTargets();
    for (const auto& [node_and_target, target] : played_) {
      std::vector<bool>& played = movable_.meshes.at(node_and_target.first).played;
      played.resize(movable_.meshes.at(node_and_target.first).weights.size());
      played[node_and_target.second] = true;
    }
    for (const GltfNode& visit : nodes)
      if (visit.is_visible) addMeshOf(visit);
    reportWeights();
    out_.mesh = primitives_.take();
    if (skins_.empty() && played_.empty()) {
      const std::string without = report_.omissionsLine();
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
  void addOtherTargets() {
    constexpr size_t kMost = 100'000;
    for (const auto& [node, morph] : movable_.meshes)
      for (size_t t = 0; t < morph.weights.size(); ++t) {
        if (!played_.try_emplace({node, t}, static_cast<uint32_t>(out_.targets.size())).second) continue;
        if (out_.targets.size() == kMost)
          document_.fail(fmt::format("its nodes have more than {} morph targets", kMost), gltfNodePart(node),
                         "read those of a clip alone (--body-targets clip)");
        out_.targets.push_back({gltfTargetName(document_, node, t), morph.weights[t], {}});
      }
  }

  void addNode(const GltfNode& visit) {
    const std::string part = gltfNodePart(visit.index);
    const json& node = document_.entry("nodes", visit.index, "a scene or node");
    movable_.joints[visit.index] = static_cast<uint32_t>(out_.skeleton.joints.size());
    out_.skeleton.joints.push_back(
        {gltfNodeName(document_, visit.index), visit.parent, localOf(document_, node, part)});
    const auto mesh = document_.unsignedMember(node, "mesh", part);
    if (mesh && visit.is_visible) movable_.meshes[visit.index] = morphs_.of(node, *mesh, part);
  }

  void addMeshOf(const GltfNode& visit) {
    const std::string part = gltfNodePart(visit.index);
    const json& node = document_.entry("nodes", visit.index, part);
    const auto mesh = document_.unsignedMember(node, "mesh", part);
    if (!mesh) return;
    if (const auto skin = document_.unsignedMember(node, "skin", part)) {
      if (hasInstances(node)) report_.addOmission("instances of skinned meshes", part);
      return addMesh(visit, *mesh, skinBindings(*skin, part), skin, part);
    }
    const uint32_t joint = movable_.joints.at(visit.index);
    const std::vector<JointTransform> instances = gltfInstances(document_, node, part);
    if (instances.empty()) report_.addOmission("meshes of no instance", part);
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
        report_.addOmission(fmt::format("JOINTS_{0}, as there is no WEIGHTS_{0}", number), part);
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
        if (weight < 0) ++negative_weights_;
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

  void reportWeights() {
    if (reduced_ > 0)
      report_.addOmission(fmt::format("the weights beyond the four largest of {} vertices, of {:.3f} at most",
                                      reduced_, largest_dropped_));
    if (negative_weights_ > 0)
      report_.warn(fmt::format("{} weights below 0 are taken as 0", negative_weights_));
    if (weightless_ > 0)
      report_.warn(
          fmt::format("{} vertices have no weight: they go with the first joint of their skin", weightless_));
  }

  const GltfDocument& document_;
  GltfReport& report_;
  const BodyTargets read_targets_;
  GltfPrimitives primitives_;
  GltfMorphs morphs_;
  SkinnedMesh out_;
  GltfMovable movable_;
  GltfPlayed played_;
  std::vector<Placement> rest_;         ///< world transforms of the joints at rest, in the file's units
  std::map<uint64_t, uint32_t> skins_;  ///< skin -> index of its first binding
  std::map<uint64_t, size_t> joints_of_skin_;
  uint64_t reduced_ = 0, negative_weights_ = 0, weightless_ = 0;  ///< vertices, weights, vertices
  double largest_dropped_ = 0;                                    ///< share of the sum of a vertex's weights
};

}  // namespace

SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const ReadBeside& read_beside, const GltfLimits& limits, BodyTargets targets) {
  const GltfDocument document(bytes, name, read_beside, limits);
  GltfReport report;
  SkinnedMesh skin = SkinReader(document, report, targets).read(true);
  skin.mesh.name = name;
  computeNormals(skin.mesh);
  skin.report = report.report();
  return skin;
}

TriangleMesh skinAtRest(const GltfDocument& document, GltfReport& report) {
  return SkinReader(document, report).read(false).mesh;
}

SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name, const GltfLimits& limits,
                         BodyTargets targets) {
  return readGltfSkin(bytes, name, ReadBeside(), limits, targets);
}

}  // namespace strandcast
