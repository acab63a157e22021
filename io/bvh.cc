// Reads a BVH clip: the joints from HIERARCHY to MOTION, then the frames.
#include "io/bvh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <string_view>

#include "io/bvh_text.h"
#include "io/file_bytes.h"

namespace strandcast {

namespace {

/// A number stated before the frames, and the word that states it, which may be no number; empty if absent.
struct BvhStated {
  std::string word;
  std::optional<double> value;
};
struct BvhMotionHead {
  BvhStated frames, frame_time;
};

/// Consumes the lines of "Frames: 5" and "Frame Time: 0.1", in any order and case, with or without colons.
BvhMotionHead readBvhMotionHead(BvhText& text) {
  BvhMotionHead head;
  for (;;) {
    const BvhText::Place before = text.place();
    const std::optional<std::string_view> line = text.nextLine();
    if (!line) return head;
    std::string plain(*line);
    std::replace(plain.begin(), plain.end(), ':', ' ');
    BvhText::Row row(plain);
    const auto stated = [&] {
      const std::string_view word = row.next();
      return BvhStated{BvhText::shortened(word), text.numberIn(word)};
    };
    bool is_head = false;
    for (std::string_view word = row.next(); !word.empty(); word = row.next()) {
      const bool is_time = BvhText::is(word, "frametime") || BvhText::is(word, "frame_time");
      if (!is_time && !BvhText::is(word, "frames") && !BvhText::is(word, "frame")) break;
      is_head = true;
      if (BvhText::is(word, "frames"))
        head.frames = stated();
      else if (is_time || BvhText::is(row.next(), "time"))
        head.frame_time = stated();
    }
    if (is_head) continue;
    text.goTo(before);
    return head;
  }
}

/// Statistics on the number of values per line of a motion.
struct BvhLines {
  size_t whole = 0, others = 0;  ///< lines with one value per channel, and other lines
  size_t values = 0;
  size_t least = std::numeric_limits<size_t>::max(), most = 0;  ///< values of one line
};

BvhLines countBvhLines(BvhText& text, size_t channels) {
  BvhLines found;
  const BvhText::Place before = text.place();
  while (const std::optional<std::string_view> line = text.nextLine()) {
    BvhText::Row row(*line);
    size_t values = 0;
    while (!row.next().empty()) ++values;
    ++(values == channels ? found.whole : found.others);
    found.values += values;
    found.least = std::min(found.least, values);
    found.most = std::max(found.most, values);
  }
  text.goTo(before);
  return found;
}

/// Lines that are no frames, or frames over several lines with words that are no numbers.
struct BvhOddLines {
  size_t count = 0, first = 0;  ///< their number, and the line of the first
  std::string fault;            ///< of the first: its first word that is not a number, or its number of words
};

/// Reads one frame per line.
BvhOddLines readBvhFrameLines(BvhText& text, BvhClip& clip) {
  BvhOddLines odd;
  while (const std::optional<std::string_view> line = text.nextLine()) {
    const size_t begin = clip.values.size();
    BvhText::Row row(*line);
    size_t words = 0;
    std::string_view wrong;
    for (std::string_view word = row.next(); !word.empty(); word = row.next(), ++words) {
      const std::optional<double> value =
          words < clip.channels && wrong.empty() ? text.numberIn(word) : std::nullopt;
      if (value)
        clip.values.push_back(static_cast<float>(*value));
      else if (words < clip.channels && wrong.empty())
        wrong = word;
    }
    if (words == clip.channels && wrong.empty()) continue;
    clip.values.resize(begin);
    if (odd.count++ > 0) continue;
    odd.first = text.line();
    odd.fault =
        wrong.empty() ? fmt::format("{} value{}", words, words == 1 ? "" : "s") : BvhText::shown(wrong);
  }
  return odd;
}

/// Reads frames over several lines. A frame with a word that is not a number is left out.
BvhOddLines readBvhFrameStream(BvhText& text, BvhClip& clip, size_t values) {
  BvhOddLines odd;
  clip.values.reserve(values / clip.channels * clip.channels);
  for (size_t frame = 0; frame < values / clip.channels; ++frame) {
    const size_t begin = clip.values.size();
    bool is_whole = true;
    for (size_t c = 0; c < clip.channels; ++c) {
      const std::string_view word = text.next();
      const std::optional<double> value = text.numberIn(word);
      clip.values.push_back(static_cast<float>(value.value_or(0)));
      if (is_whole && !value && odd.count++ == 0) {
        odd.first = text.line();
        odd.fault = BvhText::shown(word);
      }
      is_whole = is_whole && value.has_value();
    }
    if (!is_whole) clip.values.resize(begin);
  }
  return odd;
}

void takeBvhFrameTime(const BvhStated& stated, BvhClip& clip) {
  constexpr double kUsual = 1.0 / 30, kMin = 1e-5, kMax = 100, kDoubtful = 1;  // s
  std::vector<std::string>& warnings = clip.report.warnings;
  clip.frame_time = kUsual;
  if (stated.word.empty())
    warnings.emplace_back("the motion has no frame time: 1/30 s is taken");
  else if (!(stated.value && *stated.value >= kMin && *stated.value <= kMax))
    warnings.push_back(fmt::format("the frame time is '{}': 1/30 s is taken", stated.word));
  else
    clip.frame_time = *stated.value;
  if (clip.frame_time > kDoubtful)
    warnings.push_back(fmt::format("a frame lasts {:g} s: is its time in milliseconds?", clip.frame_time));
}

/// Reads the part after MOTION: number of frames, frame time, and the frames, usually one per line with one
/// value per channel. `clip` has its joints and channels; its report receives what is repaired or left out.
/// - The number of lines counts, not the number that Frames states.
/// - A line with another number of values, or with a word that is not a number, is left out.
/// - Frames broken over several lines are read if the number of values is Frames times channels, or if each
///   line is shorter than a frame.
/// - A frame over several lines that contains a word that is not a number is left out.
/// - 1/30 s replaces a missing or unusable frame time.
///
/// Throws Error when there is no whole frame.
void readBvhMotion(BvhText& text, BvhClip& clip) {
  if (clip.channels == 0) text.fail("the clip has no channels");
  const BvhMotionHead head = readBvhMotionHead(text);
  takeBvhFrameTime(head.frame_time, clip);
  const BvhLines lines = countBvhLines(text, clip.channels);
  if (lines.values == 0) text.fail("the file ends before its first frame");
  const bool is_stream =
      lines.whole == 0 &&
      ((head.frames.value &&
        static_cast<double>(lines.values) == *head.frames.value * static_cast<double>(clip.channels)) ||
       (lines.most < clip.channels && lines.values >= clip.channels));
  if (!is_stream && lines.others > lines.whole + 2)
    text.fail(fmt::format("the lines of the motion have {} to {} values, the joints have {} channels",
                          lines.least, lines.most, clip.channels),
              "check CHANNELS, or export the clip again");
  std::vector<std::string>& warnings = clip.report.warnings;
  if (!is_stream) clip.values.reserve(lines.whole * clip.channels);
  const BvhOddLines odd =
      is_stream ? readBvhFrameStream(text, clip, lines.values) : readBvhFrameLines(text, clip);
  const char* what = is_stream ? "frame" : "line";
  if (clip.values.empty())
    text.failAt(odd.first,
                fmt::format("no {} of the motion has {} numbers, one a channel: the first has {}", what,
                            clip.channels, odd.fault),
                "check CHANNELS, or export the clip again");
  if (odd.count > 0) {
    const bool is_one = odd.count == 1;
    warnings.push_back(fmt::format("{} {}{} of the motion {} left out, as {} not {} numbers: line {} ({}){}",
                                   odd.count, what, is_one ? "" : "s", is_one ? "is" : "are",
                                   is_one ? "it has" : "they have", clip.channels, odd.first, odd.fault,
                                   is_one ? "" : " is the first"));
  }
  clip.frames = clip.values.size() / clip.channels;
  if (head.frames.word.empty())
    warnings.push_back(
        fmt::format("the motion does not say how many frames it has: all {} are played", clip.frames));
  else if (head.frames.value != static_cast<double>(clip.frames))
    warnings.push_back(fmt::format("Frames says {}, the motion has {} whole frame{}: {} played",
                                   head.frames.word, clip.frames, clip.frames == 1 ? "" : "s",
                                   clip.frames == 1 ? "it is" : "these are"));
  if (text.hasDecimalCommas()) warnings.emplace_back("commas in numbers are read as decimal points");
}

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
    warnOfDuplicateNames();
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

  void warnOfDuplicateNames() {
    constexpr size_t kMax = 3;  // names listed in the warning
    std::vector<std::string> shared;
    for (const auto& [name, joints] : named_)
      if (joints > 1) shared.push_back(fmt::format("{} ({})", BvhText::shown(name), joints));
    if (shared.empty()) return;
    const bool are_more = shared.size() > kMax;
    if (are_more) shared.resize(kMax);
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
    constexpr size_t kMaxChannels = std::size(kNames);
    const double count = text_.number();
    if (count != std::floor(count) || count < 0 || count > static_cast<double>(kMaxChannels))
      text_.fail(fmt::format("the number of channels must be 0 to {}, not {:g}", kMaxChannels, count));
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
      if (is_scale) clip_.report.addOmission("scale channels");
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
