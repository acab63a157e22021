#include "io/obj_lines.h"

#include <fmt/format.h>

#include <charconv>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "io/text_number.h"

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

/// A word as errors quote it: at most 24 characters, with "?" for those that are not printable.
std::string quoted(std::string_view word) {
  std::string text = "'";
  for (const char c : word.substr(0, 24)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > 24 ? "...'" : "'");
}

/// The line up to the '#' of a comment. The '#' of "1.#QNAN", which old C libraries print for NaN, starts
/// none.
std::string_view withoutComment(std::string_view line) {
  for (size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1))
    if (at == 0 || line[at - 1] != '.') return line.substr(0, at);
  return line;
}

/// Whether a word denotes a number that is not finite or beyond a double: nan, -inf, 1.#IND, 1e999.
bool isUnbounded(std::string_view word) {
  const std::optional<double> number = numberOrInfinite(word);
  return number ? !std::isfinite(*number) : word.find(".#") != std::string_view::npos;
}

/// Keywords, in lower case, of the format's version 3 and of older versions that programs still write.
bool isKeyword(const std::string& word) {
  static const std::set<std::string, std::less<>> kAll{
      "v",      "vt",    "vn",   "vp",     "f",      "fo",       "l",        "p",          "g",
      "o",      "s",     "mg",   "usemtl", "mtllib", "usemap",   "maplib",   "lod",        "bevel",
      "cstype", "deg",   "bmat", "step",   "curv",   "curv2",    "surf",     "parm",       "trim",
      "hole",   "scrv",  "sp",   "end",    "con",    "c_interp", "d_interp", "shadow_obj", "trace_obj",
      "ctech",  "stech", "bsp",  "bzp",    "cdc",    "cdp",      "res",      "call",       "csh"};
  return kAll.contains(word);
}

}  // namespace

std::string_view ObjLines::takeLine() {
  const auto [end, next] = lineEnd(text_, next_byte_);
  const std::string_view line = text_.substr(next_byte_, end - next_byte_);
  next_byte_ = next;
  ++lines_read_;
  return withoutComment(line);
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
    if (words_.empty()) continue;
    if (!isKeyword(keyword())) ++unknown_;
    return true;
  }
  return false;
}

std::string ObjLines::keyword() const {
  std::string out(words_[0]);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return out;
}

float ObjLines::coordinate(std::string_view word) const {
  const std::optional<double> value = numberOf(word);
  if (value && std::abs(*value) <= FLT_MAX) return static_cast<float>(*value);
  if (value || isUnbounded(word)) return std::numeric_limits<float>::quiet_NaN();
  const bool has_comma = word.find(',') != std::string_view::npos;
  fail("a coordinate is not a number: " + quoted(word), line_,
       has_comma ? "export it with points in numbers, not commas, and blanks between them" : kDamaged);
}

Vec3 ObjLines::position() const {
  if (words_.size() < 4) fail("a vertex has fewer than three coordinates", line_);
  return {coordinate(words_[1]), coordinate(words_[2]), coordinate(words_[3])};
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

void ObjLines::checkIndex(uint32_t vertex, size_t vertices, size_t line) const {
  if (vertex >= vertices)
    fail(fmt::format("vertex index {} is out of range, the file has {} vertices", uint64_t{vertex} + 1,
                     vertices),
         line);
}

void addOmissionCount(FileReport& report, size_t count, const std::string& what, const std::string& of) {
  if (count > 0) report.addOmission(fmt::format("{} {}{}{}", count, what, count == 1 ? "" : "s", of));
}

}  // namespace strandcast
