#include "io/bvh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>

#include "io/bvh_motion.h"
#include "io/bvh_text.h"
#include "io/file_bytes.h"

namespace strandcast {
namespace {

constexpr size_t kMaxJoints = 4096;
constexpr int kMaxDepth = 256;

/// Reads the joints of a clip, from HIERARCHY to MOTION.
class BvhHierarchy {
 public:
  BvhHierarchy(BvhText& text, BvhClip& clip) : text_(text), clip_(clip) {}

  void read() {
    text_.expect("hierarchy");
    while (BvhText::is(text_.peek(), "root")) {
      text_.next();
      joint(-1, 0);
    }
    if (clip_.joints.empty()) text_.fail("no ROOT joint");
    text_.expect("motion");
    if (without_offset_ > 0)
      clip_.report.warnings.push_back(fmt::format("{} joint{} no OFFSET: 0 0 0 stands for it",
                                                  without_offset_, without_offset_ == 1 ? " has" : "s have"));
    tellOfNamesakes();
  }

 private:
  BvhJoint& addJoint(int parent, int depth, const std::string& name) {
    if (depth > kMaxDepth) text_.fail("joints are nested too deep");
    if (clip_.joints.size() >= kMaxJoints) text_.fail("too many joints");
    BvhJoint& made = clip_.joints.emplace_back();
    made.name = name;
    made.parent = parent;
    return made;
  }

  void joint(int parent, int depth) {
    const auto index = static_cast<int>(clip_.joints.size());
    const std::string name(text_.nextName());
    addJoint(parent, depth, name);
    ++named_[name];
    body(index, depth);
  }

  void tellOfNamesakes() {
    constexpr size_t kMost = 3;  // names listed in the warning
    std::vector<std::string> shared;
    for (const auto& [name, joints] : named_)
      if (joints > 1) shared.push_back(fmt::format("{} ({})", BvhText::shown(name), joints));
    if (shared.empty()) return;
    const bool are_more = shared.size() > kMost;
    if (are_more) shared.resize(kMost);
    clip_.report.warnings.push_back(
        fmt::format("joints have one name, and the first of each in the file is taken: {}{}",
                    fmt::join(shared, ", "), are_more ? ", ..." : ""));
  }

  void endSite(int parent, int depth) {
    text_.skipName();  // "Site", or another word that programs write
    const auto index = static_cast<int>(clip_.joints.size());
    addJoint(parent, depth, "End Site");
    body(index, depth);
  }

  /// OFFSET, CHANNELS and children may come in any order.
  void body(int index, int depth) {
    text_.expect("{");
    bool has_offset = false;
    for (;;) {
      const std::string_view word = text_.next();
      if (word == "}") break;
      if (BvhText::is(word, "offset")) {
        for (int c = 0; c < 3; ++c)
          clip_.joints[static_cast<size_t>(index)].offset[c] = static_cast<float>(text_.number());
        has_offset = true;
      } else if (BvhText::is(word, "channels")) {
        channels(index);
      } else if (BvhText::is(word, "joint")) {
        joint(index, depth + 1);
      } else if (BvhText::is(word, "end") || BvhText::is(word, "endsite")) {
        endSite(index, depth + 1);
      } else {
        text_.fail("expected OFFSET, CHANNELS, JOINT, End Site or }, found " + BvhText::shown(word));
      }
    }
    without_offset_ += has_offset ? 0 : 1;
  }

  void channels(int index) {
    if (!clip_.joints[static_cast<size_t>(index)].channels.empty()) text_.fail("CHANNELS is given twice");
    static constexpr std::string_view kNames[] = {"xposition", "yposition", "zposition",
                                                  "xrotation", "yrotation", "zrotation",
                                                  "xscale",    "yscale",    "zscale"};
    constexpr size_t kMostChannels = std::size(kNames);
    const double count = text_.number();
    if (count != std::floor(count) || count < 0 || count > static_cast<double>(kMostChannels))
      text_.fail(fmt::format("the number of channels must be 0 to {}, not {:g}", kMostChannels, count));
    BvhJoint& owner = clip_.joints[static_cast<size_t>(index)];
    owner.first_channel = clip_.channels;
    for (size_t i = 0; i < static_cast<size_t>(count); ++i) {
      const std::string_view word = text_.next();
      const auto* found = std::find_if(std::begin(kNames), std::end(kNames),
                                       [&](std::string_view name) { return BvhText::is(word, name); });
      if (found == std::end(kNames)) text_.fail("unknown channel " + BvhText::shown(word));
      const size_t number = static_cast<size_t>(found - std::begin(kNames));
      const auto channel = static_cast<BvhChannel>(std::min(number, static_cast<size_t>(BvhChannel::kScale)));
      const bool is_scale = channel == BvhChannel::kScale;
      if (is_scale) clip_.report.leaveOut("scale channels");
      if (!is_scale &&
          std::find(owner.channels.begin(), owner.channels.end(), channel) != owner.channels.end())
        text_.fail("channel is given twice: " + BvhText::shown(word));
      owner.channels.push_back(channel);
    }
    clip_.channels += static_cast<size_t>(count);
  }

  BvhText& text_;
  BvhClip& clip_;
  size_t without_offset_ = 0;
  std::map<std::string, size_t> named_;  ///< name -> number of joints; End Sites are not counted
};

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

}  // namespace

int BvhClip::find(const std::string& name) const {
  for (size_t i = 0; i < joints.size(); ++i)
    if (name.empty() ? lowered(joints[i].name).find("head") != std::string::npos : joints[i].name == name)
      return static_cast<int>(i);
  return -1;
}

Pose BvhClip::pose(size_t joint, size_t frame) const {
  const BvhJoint& j = joints[joint];
  const float* value = values.data() + frame * channels + j.first_channel;
  Pose local{j.offset, Quat::Identity()};
  for (size_t i = 0; i < j.channels.size(); ++i) {
    const int channel = static_cast<int>(j.channels[i]);
    if (channel < 3) {
      local.position[channel] = value[i];
    } else if (channel < 6) {
      const Eigen::Vector3f axis = Eigen::Vector3f::Unit(channel - 3);
      local.rotation =
          local.rotation * Quat(Eigen::AngleAxisf(value[i] * std::numbers::pi_v<float> / 180, axis));
    }
  }
  return j.parent < 0 ? local : pose(static_cast<size_t>(j.parent), frame) * local;
}

Vec3 BvhClip::restOffset(size_t joint) const {
  const BvhJoint& j = joints[joint];
  if (!j.offset.isZero(0) || j.parent < 0) return j.offset;
  Vec3 offset = Vec3::Zero();
  for (size_t i = 0; i < j.channels.size(); ++i)
    if (const auto channel = static_cast<int>(j.channels[i]); channel < 3)
      offset[channel] = values[j.first_channel + i];
  return offset;
}

Vec3 BvhClip::restPosition(size_t joint) const {
  Vec3 sum = restOffset(joint);
  for (int j = joints[joint].parent; j >= 0; j = joints[static_cast<size_t>(j)].parent)
    sum += restOffset(static_cast<size_t>(j));
  return sum;
}

Quat BvhClip::upright(size_t head) const {
  const Vec3 up = restPosition(head) - restPosition(0);
  const bool z_up = std::fabs(up.z()) > std::fabs(up.y());
  const float turn = z_up ? -std::numbers::pi_v<float> / 2 : 0.0f;
  return Quat(Eigen::AngleAxisf(turn, Eigen::Vector3f::UnitX()));
}

float BvhClip::size() const {
  Box box;
  for (size_t j = 0; j < joints.size(); ++j) box.extend(Eigen::Vector3f(restPosition(j)));
  return box.sizes().maxCoeff();
}

float BvhClip::guessedUnit() const {
  constexpr float kPerson = 1.7f, kNothing = 1e-9f;  // m
  const float tall = size();
  const auto distance = [&](float unit) {
    return std::fabs(std::log(std::max(tall * unit, kNothing) / kPerson));
  };
  float best = 1;
  for (const float unit : {1.0f, 0.1f, 0.01f, 0.0254f, 0.001f})
    if (distance(unit) < distance(best)) best = unit;
  return best;
}

BvhClip readBvh(std::span<const std::byte> bytes, const std::string& name) {
  BvhClip clip;
  BvhText text(textOfFile(bytes, name), name);
  BvhHierarchy(text, clip).read();
  readBvhMotion(text, clip);
  return clip;
}

BvhClip readBvh(const std::filesystem::path& file) { return readBvh(readFileBytes(file), file.string()); }

}  // namespace strandcast
