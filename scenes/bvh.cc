#include "scenes/bvh.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "core/error.h"
#include "groom/file_bytes.h"
#include "groom/text_number.h"

namespace strandcast {
namespace {

constexpr size_t kMaxJoints = 4096;
constexpr int kMaxDepth = 256;

class Parser {
 public:
  Parser(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  BvhClip run() {
    expect("HIERARCHY");
    while (peek() == "ROOT") {
      next();
      joint(-1, 0);
    }
    if (clip_.joints.empty()) fail("no ROOT joint");
    motion();
    return std::move(clip_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(what, name_ + ", line " + std::to_string(line_), "check that the BVH file is complete");
  }

  void skipSpace() {
    while (at_ < text_.size() && static_cast<unsigned char>(text_[at_]) <= ' ') line_ += text_[at_++] == '\n';
  }
  std::string_view peek() {
    skipSpace();
    size_t end = at_;
    while (end < text_.size() && static_cast<unsigned char>(text_[end]) > ' ') ++end;
    return text_.substr(at_, end - at_);
  }
  std::string_view next() {
    const std::string_view token = peek();
    if (token.empty()) fail("the file ends early");
    at_ += token.size();
    return token;
  }
  /// Up to the end of the line or a brace: names may have spaces.
  std::string_view restOfLine() {
    skipSpace();
    std::string_view rest = text_.substr(at_);
    rest = rest.substr(0, rest.find_first_of("\n{"));
    while (!rest.empty() && static_cast<unsigned char>(rest.back()) <= ' ') rest.remove_suffix(1);
    if (rest.empty()) fail("a joint has no name");
    at_ += rest.size();
    return rest;
  }
  void expect(std::string_view token) {
    const std::string_view found = next();
    if (found != token) fail("expected " + std::string(token) + ", found " + shown(found));
  }
  // Up to 32 printable characters of what was found.
  static std::string shown(std::string_view token) {
    std::string out = "'";
    for (char c : token.substr(0, 32)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + "'";
  }
  double number() {
    const std::string_view token = next();
    const std::optional<double> value = numberOf(token);
    if (!value) fail("expected a number, found " + shown(token));
    if (!std::isfinite(*value) || std::fabs(*value) > 1e9) fail("number is out of range: " + shown(token));
    return *value;
  }
  size_t count(const char* of, size_t least, size_t most) {
    const double value = number();
    if (value != std::floor(value) || value < static_cast<double>(least) || value > static_cast<double>(most))
      fail(std::string(of) + " must be " + std::to_string(least) + " to " + std::to_string(most));
    return static_cast<size_t>(value);
  }

  void joint(int parent, int depth) {
    if (depth > kMaxDepth) fail("joints are nested too deep");
    if (clip_.joints.size() >= kMaxJoints) fail("too many joints");
    const int index = static_cast<int>(clip_.joints.size());
    BvhJoint& made = clip_.joints.emplace_back();
    made.name = restOfLine();
    made.parent = parent;
    body(index, depth);
  }

  void body(int index, int depth) {
    expect("{");
    expect("OFFSET");
    for (int c = 0; c < 3; ++c) clip_.joints[index].offset[c] = static_cast<float>(number());
    for (;;) {
      const std::string_view token = next();
      if (token == "}") return;
      if (token == "CHANNELS") {
        channels(index);
      } else if (token == "JOINT") {
        joint(index, depth + 1);
      } else if (token == "End") {
        expect("Site");
        endSite(index, depth + 1);
      } else {
        fail("expected CHANNELS, JOINT, End Site or }, found " + shown(token));
      }
    }
  }

  void endSite(int parent, int depth) {
    if (clip_.joints.size() >= kMaxJoints) fail("too many joints");
    BvhJoint& made = clip_.joints.emplace_back();
    made.name = "End Site";
    made.parent = parent;
    body(static_cast<int>(clip_.joints.size()) - 1, depth);
  }

  void channels(int index) {
    if (!clip_.joints[index].channels.empty()) fail("CHANNELS is given twice");
    static constexpr std::string_view kNames[] = {"Xposition", "Yposition", "Zposition",
                                                  "Xrotation", "Yrotation", "Zrotation"};
    const size_t n = count("the number of channels", 0, 6);
    BvhJoint& owner = clip_.joints[index];
    owner.first_channel = clip_.channels;
    for (size_t i = 0; i < n; ++i) {
      const std::string_view token = next();
      const auto* found = std::find(std::begin(kNames), std::end(kNames), token);
      if (found == std::end(kNames)) fail("unknown channel " + shown(token));
      const auto channel = static_cast<BvhChannel>(found - std::begin(kNames));
      if (std::find(owner.channels.begin(), owner.channels.end(), channel) != owner.channels.end())
        fail("channel is given twice: " + shown(token));
      owner.channels.push_back(channel);
    }
    clip_.channels += n;
  }

  void motion() {
    expect("MOTION");
    expect("Frames:");
    clip_.frames = count("the number of frames", 1, 100000000);
    expect("Frame");
    expect("Time:");
    clip_.frame_time = number();
    if (!(clip_.frame_time >= 1e-5 && clip_.frame_time <= 100)) fail("frame time must be 1e-5 to 100 s");
    if (clip_.channels == 0) fail("the clip has no channels");
    // A value takes two characters at the least.
    if (clip_.frames > (text_.size() - at_ + 1) / 2 / clip_.channels)
      fail("the file ends before its last frame");
    clip_.values.reserve(clip_.frames * clip_.channels);
    for (size_t i = 0; i < clip_.frames * clip_.channels; ++i)
      clip_.values.push_back(static_cast<float>(number()));
    if (!peek().empty()) fail("more values than frames x channels");
  }

  std::string_view text_;
  std::string name_;
  size_t at_ = 0;
  size_t line_ = 1;
  BvhClip clip_;
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
    } else {
      const Eigen::Vector3f axis = Eigen::Vector3f::Unit(channel - 3);
      local.rotation =
          local.rotation * Quat(Eigen::AngleAxisf(value[i] * std::numbers::pi_v<float> / 180, axis));
    }
  }
  return j.parent < 0 ? local : pose(static_cast<size_t>(j.parent), frame) * local;
}

Vec3 BvhClip::restPosition(size_t joint) const {
  Vec3 sum = joints[joint].offset;
  for (int j = joints[joint].parent; j >= 0; j = joints[static_cast<size_t>(j)].parent)
    sum += joints[static_cast<size_t>(j)].offset;
  return sum;
}

Quat BvhClip::upright(size_t head) const {
  const Vec3 up = restPosition(head) - restPosition(0);
  const bool z_up = std::fabs(up.z()) > std::fabs(up.y());
  const float turn = z_up ? -std::numbers::pi_v<float> / 2 : 0.0f;
  return Quat(Eigen::AngleAxisf(turn, Eigen::Vector3f::UnitX()));
}

float BvhClip::guessedUnit() const {
  Box box;
  for (size_t j = 0; j < joints.size(); ++j) box.extend(Eigen::Vector3f(restPosition(j)));
  const float tall = box.sizes().maxCoeff();
  float best = 1;
  for (float unit : {1.0f, 0.1f, 0.01f, 0.0254f, 0.001f})
    if (std::fabs(std::log(std::max(tall * unit, 1e-9f) / 1.7f)) <
        std::fabs(std::log(std::max(tall * best, 1e-9f) / 1.7f)))
      best = unit;
  return best;
}

BvhClip readBvh(std::span<const std::byte> bytes, const std::string& name) {
  return Parser(textOfFile(bytes), name).run();
}

BvhClip readBvh(const std::filesystem::path& file) { return readBvh(readFileBytes(file), file.string()); }

}  // namespace strandcast
