#include "scenes/bvh_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace strandcast {
namespace {

/// What stands before the frames.
struct BvhMotionHead {
  std::optional<double> frames, frame_time;
};

/// Passes the lines of "Frames: 5" and "Frame Time: 0.1", in whatever order, case and with or without colons.
BvhMotionHead readBvhMotionHead(BvhText& text) {
  BvhMotionHead head;
  for (;;) {
    const BvhText::Place before = text.place();
    const std::optional<std::string_view> line = text.nextLine();
    if (!line) return head;
    std::string plain(*line);
    std::replace(plain.begin(), plain.end(), ':', ' ');
    BvhText::Row row(plain, text);
    bool is_head = false;
    for (std::string_view word = row.next(); !word.empty(); word = row.next()) {
      const bool is_time = BvhText::is(word, "frametime") || BvhText::is(word, "frame_time");
      if (!is_time && !BvhText::is(word, "frames") && !BvhText::is(word, "frame")) break;
      is_head = true;
      if (BvhText::is(word, "frames"))
        head.frames = row.number();
      else if (is_time || BvhText::is(row.next(), "time"))
        head.frame_time = row.number();
    }
    if (is_head) continue;
    text.goTo(before);
    return head;
  }
}

/// How many values the lines of a motion have.
struct BvhLines {
  size_t whole = 0, others = 0;  ///< lines of as many values as channels, and of another number
  size_t values = 0;
  size_t least = std::numeric_limits<size_t>::max(), most = 0;  ///< of one line
};

BvhLines countBvhLines(BvhText& text, size_t channels) {
  BvhLines found;
  const BvhText::Place before = text.place();
  while (const std::optional<std::string_view> line = text.nextLine()) {
    BvhText::Row row(*line, text);
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

/// One frame a line. Returns the lines left out and the number of the first.
std::pair<size_t, size_t> readBvhFrameLines(BvhText& text, BvhClip& clip) {
  size_t damaged = 0, first = 0;
  while (const std::optional<std::string_view> line = text.nextLine()) {
    const size_t begin = clip.values.size();
    BvhText::Row row(*line, text);
    bool is_whole = true;
    for (size_t c = 0; c < clip.channels && is_whole; ++c) {
      const std::optional<double> value = row.number();
      is_whole = value.has_value();
      if (is_whole) clip.values.push_back(static_cast<float>(*value));
    }
    if (is_whole && row.next().empty()) continue;
    clip.values.resize(begin);
    if (damaged++ == 0) first = text.line();
  }
  return {damaged, first};
}

/// Frames over several lines.
void readBvhFrameStream(BvhText& text, BvhClip& clip, size_t values) {
  const size_t whole = values / clip.channels * clip.channels;
  clip.values.reserve(whole);
  while (clip.values.size() < whole) clip.values.push_back(static_cast<float>(text.number()));
}

void takeBvhFrameTime(const std::optional<double>& stated, BvhClip& clip) {
  constexpr double kUsual = 1.0 / 30, kLeast = 1e-5, kMost = 100, kDoubtful = 1;  // s
  std::vector<std::string>& warnings = clip.report.warnings;
  clip.frame_time = kUsual;
  if (!stated)
    warnings.emplace_back("the motion has no frame time: 1/30 s is taken");
  else if (!(*stated >= kLeast && *stated <= kMost))
    warnings.push_back(fmt::format("the frame time is {:g} s: 1/30 s is taken", *stated));
  else
    clip.frame_time = *stated;
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
      lines.whole == 0 && ((head.frames && static_cast<double>(lines.values) ==
                                               *head.frames * static_cast<double>(clip.channels)) ||
                           (lines.most < clip.channels && lines.values >= clip.channels));
  if (!is_stream && lines.others > lines.whole + 2)
    text.fail(fmt::format("the lines of the motion have {} to {} values, the joints have {} channels",
                          lines.least, lines.most, clip.channels),
              "check CHANNELS, or export the clip again");
  std::vector<std::string>& warnings = clip.report.warnings;
  if (is_stream) {
    readBvhFrameStream(text, clip, lines.values);
  } else {
    clip.values.reserve(lines.whole * clip.channels);
    const auto [damaged, first] = readBvhFrameLines(text, clip);
    if (clip.values.empty())
      text.failAt(first, fmt::format("no line of the motion has {} numbers, one a channel", clip.channels),
                  "check CHANNELS, or export the clip again");
    if (damaged > 0)
      warnings.push_back(fmt::format("{} line{} of the motion {} left out, as {} not {} numbers: line {}{}",
                                     damaged, damaged == 1 ? "" : "s", damaged == 1 ? "is" : "are",
                                     damaged == 1 ? "it has" : "they have", clip.channels, first,
                                     damaged == 1 ? "" : " is the first"));
  }
  clip.frames = clip.values.size() / clip.channels;
  if (!head.frames)
    warnings.push_back(
        fmt::format("the motion does not say how many frames it has: all {} are played", clip.frames));
  else if (*head.frames != static_cast<double>(clip.frames))
    warnings.push_back(fmt::format("Frames says {:g}, the motion has {} whole frame{}: {} played",
                                   *head.frames, clip.frames, clip.frames == 1 ? "" : "s",
                                   clip.frames == 1 ? "it is" : "these are"));
  if (text.hasDecimalCommas()) warnings.emplace_back("commas in numbers are read as decimal points");
}

}  // namespace strandcast
