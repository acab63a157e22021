// Animations of glTF 2.0 (specification, "Animations").
#include "io/gltf_clips.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <tuple>

#include "core/error.h"
#include "io/gltf_scene.h"

namespace strandcast {
namespace {

using nlohmann::json;

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
      is_told_ = false;
      try {
        SkeletonClip clip = readClip(document_.entry("animations", a, "animations"), part);
        if (!clip.isStill())
          into_.clips.push_back(std::move(clip));
        else if (!is_told_)
          leaveOut("animations that move nothing of the scene", part);
      } catch (const Error& error) {  // the body and other clips remain usable
        report_.leaveOut(fmt::format("animations that cannot be read, as {}", error.what()), part);
      }
    }
    return std::move(played_);
  }

 private:
  void leaveOut(const std::string& what, const std::string& part) {
    report_.leaveOut(what, part);
    is_told_ = true;
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
          leaveOut("second channels of the weights of one node", where);
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
          leaveOut("channels without keys", where);
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
        leaveOut("weights of morph targets of nodes without a mesh", where);
      return;
    }
    try {
      const auto sampler = document_.unsignedMember(channel, "sampler", where);
      if (!sampler) document_.fail("the channel has no sampler", where);
      addWeights(readWeightSampler(animation, *sampler, mesh->second.weights.size(), clip_part), node,
                 mesh->second, clip);
    } catch (const Error& error) {
      leaveOut(fmt::format("weights of morph targets that cannot be read, as {}", error.what()), where);
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
      if (is_new) into_.targets.push_back({nameOf(node, t), morph.weights[t], {}});
      clip.morphs.push_back({known->second, static_cast<uint32_t>(clip.samplers.size())});
      clip.samplers.push_back(std::move(own));
    }
  }

  /// Name of a target from `extras.targetNames` of the mesh, a convention of exporters.
  std::string nameOf(uint64_t node, size_t target) const {
    const std::string part = gltfNodePart(node);
    const auto mesh = document_.unsignedMember(document_.entry("nodes", node, part), "mesh", part);
    const json& description = document_.entry("meshes", mesh.value(), part);
    const auto extras = description.find("extras");
    if (extras != description.end() && extras->is_object())
      if (const auto names = extras->find("targetNames"); names != extras->end() && names->is_array() &&
                                                          target < names->size() &&
                                                          (*names)[target].is_string())
        return printable((*names)[target].get_ref<const std::string&>());
    return fmt::format("target {}", target);
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
    if (*path == "pointer") leaveOut("channels of KHR_animation_pointer", part);
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
  bool is_told_ = false;  ///< part of the current animation was reported as left out
};

}  // namespace

GltfPlayed readGltfClips(const GltfDocument& document, const GltfMovable& movable, GltfReport& report,
                         SkinnedMesh& into) {
  return ClipReader(document, movable, report, into).read();
}

}  // namespace strandcast
