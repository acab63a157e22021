#include "io/bvh_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

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
  constexpr double kUsual = 1.0 / 30, kLeast = 1e-5, kMost = 100, kDoubtful = 1;  // s
  std::vector<std::string>& warnings = clip.report.warnings;
  clip.frame_time = kUsual;
  if (stated.word.empty())
    warnings.emplace_back("the motion has no frame time: 1/30 s is taken");
  else if (!(stated.value && *stated.value >= kLeast && *stated.value <= kMost))
    warnings.push_back(fmt::format("the frame time is '{}': 1/30 s is taken", stated.word));
  else
    clip.frame_time = *stated.value;
  if (clip.frame_time > kDoubtful)
    warnings.push_back(fmt::format("a frame lasts {:g} s: is its time in milliseconds?", clip.frame_time));
}

}  // namespace

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

}  // namespace strandcast
