#include "groom/obj_lines.h"

#include <charconv>
#include <limits>

#include "groom/text_number.h"

namespace strandcast {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

bool endsInBackslash(std::string_view line) {
  while (!line.empty() && isBlank(line.back())) line.remove_suffix(1);
  return !line.empty() && line.back() == '\\';
}

void splitWords(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  for (size_t i = 0; i < line.size();) {
    if (isBlank(line[i])) {
      ++i;
      continue;
    }
    const size_t start = i;
    while (i < line.size() && !isBlank(line[i])) ++i;
    words.push_back(line.substr(start, i - start));
  }
}

/// A word as errors quote it: short, and printable whatever the file holds.
std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 24)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 24 ? "...'" : "'");
}

}  // namespace

std::string_view ObjLines::takeLine() {
  const size_t end = std::min(text_.find('\n', next_byte_), text_.size());
  const std::string_view line = text_.substr(next_byte_, end - next_byte_);
  next_byte_ = end + 1;
  ++lines_read_;
  return line.substr(0, line.find('#'));
}

bool ObjLines::next() {
  while (next_byte_ < text_.size()) {
    std::string_view line = takeLine();
    line_ = lines_read_;
    if (endsInBackslash(line)) {
      joined_.clear();
      while (endsInBackslash(line)) {
        joined_ += line.substr(0, line.rfind('\\'));
        joined_ += ' ';
        line = next_byte_ < text_.size() ? takeLine() : std::string_view();
      }
      joined_ += line;
      line = joined_;
    }
    splitWords(line, words_);
    if (!words_.empty()) return true;
  }
  return false;
}

Vec3 ObjLines::position() const {
  if (words_.size() < 4) fail("a vertex has fewer than three coordinates", line_);
  Vec3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<double> value = numberOf(words_[axis + 1]);
    if (!value) fail("a coordinate is not a number: " + quoted(words_[axis + 1]), line_);
    if (!(std::abs(*value) <= FLT_MAX))
      fail("a coordinate is not a finite number: " + quoted(words_[axis + 1]), line_);
    point[axis] = static_cast<float>(*value);
  }
  return point;
}

uint32_t ObjLines::vertexIndex(std::string_view corner, size_t vertices) const {
  const std::string_view digits = corner.substr(0, corner.find('/'));
  int64_t index = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  if (failure != std::errc() || end != digits.data() + digits.size() || index == 0)
    fail("this is not a vertex index: " + quoted(corner), line_);
  if (index < 0 && index < -static_cast<int64_t>(vertices))
    fail("vertex index " + std::to_string(index) + " counts back past the first vertex", line_);
  const int64_t absolute = index < 0 ? static_cast<int64_t>(vertices) + index : index - 1;
  if (absolute >= std::numeric_limits<uint32_t>::max())
    fail("vertex index " + std::to_string(index) + " is out of range", line_);
  return static_cast<uint32_t>(absolute);
}

}  // namespace strandcast
