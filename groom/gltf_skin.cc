// Skins, skeletons and animations from glTF 2.0.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "groom/gltf_document.h"
#include "groom/gltf_mesh.h"
#include "groom/gltf_primitives.h"
#include "groom/gltf_scene.h"

namespace strandcast {
namespace {

using nlohmann::json;

constexpr float kLargest = 1e9f;  ///< of a clip's numbers: what is made of them stays finite

/// Apart into move, turn and scale, as the specification asks of a node's matrix.
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
  explicit SkinReader(const GltfDocument& document) : document_(document), primitives_(document) {}

  /// Without clips.
  SkinnedMesh readAtRest() {
    const std::vector<GltfNode> nodes = sceneNodes(document_);
    for (const GltfNode& visit : nodes) {
      const std::string part = gltfNodePart(visit.index);
      const json& node = document_.entry("nodes", visit.index, "a scene or node");
      joint_of_[visit.index] = static_cast<uint32_t>(out_.skeleton.joints.size());
      const auto name = node.find("name");
      const bool named = name != node.end() && name->is_string();
      out_.skeleton.joints.push_back(
          {named ? name->get<std::string>() : part, visit.parent, localOf(document_, node, part)});
    }
    rest_ = out_.skeleton.place(out_.skeleton.rest());
    for (const GltfNode& visit : nodes) addMeshOf(visit);
    out_.mesh = primitives_.take();
    if (skins_.empty())
      document_.fail("no mesh of the scene has a skin", "skins",
                     "export the body with its armature, or leave it rigid");
    out_.stored = std::move(out_.mesh.positions);
    out_.mesh.positions = out_.blended(rest_);
    for (size_t v = 0; v < out_.mesh.positions.size(); ++v)
      if (!out_.mesh.positions[v].allFinite())
        document_.fail(fmt::format("vertex {} is placed at no finite point", v), "skins");
    return std::move(out_);
  }
  SkinnedMesh read() {
    SkinnedMesh skin = readAtRest();
    readClips(skin.clips);
    return skin;
  }

 private:
  void addMeshOf(const GltfNode& visit) {
    const std::string part = gltfNodePart(visit.index);
    const json& node = document_.entry("nodes", visit.index, part);
    const auto mesh = document_.unsignedMember(node, "mesh", part);
    if (!mesh) return;
    const auto skin = document_.unsignedMember(node, "skin", part);
    const uint32_t first = skin ? skinBindings(*skin, part) : nodeBinding(joint_of_.at(visit.index));
    const size_t joints = skin ? joints_of_skin_.at(*skin) : 1;
    const SkinBinding& example = out_.bindings[first];
    const bool mirrored = (rest_[example.joint] * example.inverse_bind).linear().determinant() < 0;
    primitives_.add(*mesh, GltfTransform::Identity(), mirrored, part,
                    [&](const json& attributes, uint64_t count, const std::string& where) {
                      if (skin)
                        addInfluences(attributes, count, first, joints, where);
                      else
                        out_.influences.insert(out_.influences.end(), count, SkinInfluences{{{first, 1.0f}}});
                    });
  }

  uint32_t nodeBinding(uint32_t joint) {
    out_.bindings.push_back({joint, Placement::Identity()});
    return static_cast<uint32_t>(out_.bindings.size() - 1);
  }

  /// The first of a skin's bindings, which lie in the order of its joints.
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
      inverse = document_.floats(*accessor, "MAT4", false);
    }
    const auto first = static_cast<uint32_t>(out_.bindings.size());
    for (size_t j = 0; j < joints->size(); ++j) {
      const json& node = (*joints)[j];
      const auto joint = node.is_number_unsigned() ? joint_of_.find(node.get<uint64_t>()) : joint_of_.end();
      if (joint == joint_of_.end()) document_.fail(fmt::format("joint {} is no node of the scene", j), part);
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

  void addInfluences(const json& attributes, uint64_t count, uint32_t first, size_t joints,
                     const std::string& part) {
    if (attributes.contains("JOINTS_1") || attributes.contains("WEIGHTS_1"))
      document_.fail("its vertices have more than four weights", part,
                     "export with four weights a vertex at most");
    const auto joint_accessor = document_.unsignedMember(attributes, "JOINTS_0", part);
    const auto weight_accessor = document_.unsignedMember(attributes, "WEIGHTS_0", part);
    if (!joint_accessor || !weight_accessor)
      document_.fail("its node has a skin but it has no JOINTS_0 or no WEIGHTS_0", part);
    if (document_.accessorCount(*joint_accessor, "VEC4") != count ||
        document_.accessorCount(*weight_accessor, "VEC4") != count)
      document_.fail(fmt::format("its joints and weights are not those of {} vertices", count), part);
    const auto own_joints = document_.joints(*joint_accessor);
    const std::vector<float> weights = document_.floats(*weight_accessor, "VEC4", true);
    for (uint64_t v = 0; v < count; ++v) {
      SkinInfluences influences;
      double sum = 0;
      for (size_t k = 0; k < 4; ++k) {
        const float weight = weights[4 * v + k];
        if (weight < 0) document_.fail(fmt::format("vertex {} has a weight below 0", v), part);
        if (weight == 0) continue;
        if (own_joints[v][k] >= joints)
          document_.fail(fmt::format("vertex {} hangs on joint {} of {}", v, own_joints[v][k], joints), part);
        influences[k] = {first + own_joints[v][k], weight};
        sum += static_cast<double>(weight);
      }
      if (!(sum > 1e-6))
        document_.fail(fmt::format("vertex {} has no weight", v), part, "give every vertex a joint");
      for (SkinInfluence& influence : influences)
        influence.weight = static_cast<float>(static_cast<double>(influence.weight) / sum);
      out_.influences.push_back(influences);
    }
  }

  void readClips(std::vector<SkeletonClip>& clips) {
    const auto list = document_.root().find("animations");
    if (list == document_.root().end()) return;
    if (!list->is_array()) document_.fail("this is not an array", "animations");
    for (size_t a = 0; a < list->size(); ++a) {
      SkeletonClip clip =
          readClip(document_.entry("animations", a, "animations"), fmt::format("animations[{}]", a));
      if (!clip.channels.empty()) clips.push_back(std::move(clip));
    }
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
    for (size_t c = 0; c < channels->size(); ++c) {
      const std::string where = fmt::format("{}.channels[{}]", part, c);
      const auto channel = readChannel((*channels)[c], where);
      if (!channel) continue;
      const auto& [joint, path, sampler] = *channel;
      if (!moved.emplace(joint, path).second) document_.fail("two channels move the same of one node", where);
      const bool turns = path == ClipPath::kRotation;
      const auto [known, is_new] =
          samplers.try_emplace({sampler, turns}, static_cast<uint32_t>(clip.samplers.size()));
      if (is_new) clip.samplers.push_back(readSampler(animation, sampler, turns, part));
      clip.channels.push_back({joint, path, known->second});
    }
    for (const ClipSampler& sampler : clip.samplers)
      clip.duration = std::max(clip.duration, static_cast<double>(sampler.times.back()));
    return clip;
  }

  /// Empty where it moves what no skeleton has.
  std::optional<std::tuple<uint32_t, ClipPath, uint64_t>> readChannel(const json& channel,
                                                                      const std::string& part) const {
    const auto target = channel.is_object() ? channel.find("target") : channel.end();
    if (!channel.is_object() || target == channel.end() || !target->is_object())
      document_.fail("the channel has no target", part);
    const auto sampler = document_.unsignedMember(channel, "sampler", part);
    if (!sampler) document_.fail("the channel has no sampler", part);
    const auto node = document_.unsignedMember(*target, "node", part);
    const auto path = target->find("path");
    if (path == target->end() || !path->is_string()) document_.fail("the channel's target has no path", part);
    if (!node || *path == "weights") return std::nullopt;
    if (document_.entry("nodes", *node, part).contains("matrix"))
      document_.fail("a node with a matrix cannot be animated", part,
                     "export it with translation, rotation and scale");
    const auto joint = joint_of_.find(*node);
    if (joint == joint_of_.end()) return std::nullopt;  // of another scene
    if (*path == "translation") return std::tuple(joint->second, ClipPath::kTranslation, *sampler);
    if (*path == "rotation") return std::tuple(joint->second, ClipPath::kRotation, *sampler);
    if (*path == "scale") return std::tuple(joint->second, ClipPath::kScale, *sampler);
    document_.fail("the channel's path is not translation, rotation, scale or weights", part);
  }

  ClipSampler readSampler(const json& animation, uint64_t index, bool turns, const std::string& clip) {
    const std::string part = fmt::format("{}.samplers[{}]", clip, index);
    const auto list = animation.find("samplers");
    if (list == animation.end() || !list->is_array() || index >= list->size() || !(*list)[index].is_object())
      document_.fail("there is no such sampler", part);
    const json& sampler = (*list)[index];
    ClipSampler out;
    out.components = turns ? 4 : 3;
    const auto interpolation = sampler.find("interpolation");
    if (interpolation != sampler.end()) {
      if (*interpolation == "STEP")
        out.interpolation = ClipInterpolation::kStep;
      else if (*interpolation == "CUBICSPLINE")
        out.interpolation = ClipInterpolation::kCubicSpline;
      else if (*interpolation != "LINEAR")
        document_.fail("the interpolation is not STEP, LINEAR or CUBICSPLINE", part);
    }
    const auto input = document_.unsignedMember(sampler, "input", part);
    const auto output = document_.unsignedMember(sampler, "output", part);
    if (!input || !output) document_.fail("the sampler has no input or no output", part);
    const char* type = turns ? "VEC4" : "VEC3";
    const uint64_t keys = document_.accessorCount(*input, "SCALAR"),
                   values = document_.accessorCount(*output, type);
    if (values != keys * (out.interpolation == ClipInterpolation::kCubicSpline ? 3 : 1))
      document_.fail(fmt::format("{} values do not fit {} keys", values, keys), part);
    // As meshes do, clips may use the same data again.
    values_spent_ += values * out.components;
    if (values_spent_ > document_.bufferBytes())
      document_.fail("the animations repeat their data too often", part, "export one animation");
    out.times = document_.floats(*input, "SCALAR", false);
    out.values = document_.floats(*output, type, turns);
    checkTimes(out, part);
    for (const float value : out.values)
      if (!(std::abs(value) <= kLargest))
        document_.fail(fmt::format("a value is beyond {:g}", kLargest), part);
    if (turns) checkRotations(out, part);
    return out;
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
  GltfPrimitives primitives_;
  SkinnedMesh out_;
  std::vector<Placement> rest_;            ///< of the joints in the file's units
  std::map<uint64_t, uint32_t> joint_of_;  ///< node -> joint
  std::map<uint64_t, uint32_t> skins_;     ///< skin -> its first binding
  std::map<uint64_t, size_t> joints_of_skin_;
  uint64_t values_spent_ = 0;
};

}  // namespace

SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name,
                         const std::optional<std::filesystem::path>& folder) {
  const GltfDocument document(bytes, name, folder);
  SkinnedMesh skin = SkinReader(document).read();
  skin.mesh.name = name;
  computeNormals(skin.mesh);
  return skin;
}

TriangleMesh skinAtRest(const GltfDocument& document) { return SkinReader(document).readAtRest().mesh; }

SkinnedMesh readGltfSkin(std::span<const std::byte> bytes, const std::string& name) {
  return readGltfSkin(bytes, name, std::nullopt);
}

}  // namespace strandcast
