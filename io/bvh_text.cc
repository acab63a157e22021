#include "io/bvh_text.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "io/file_bytes.h"
#include "io/text_number.h"

namespace strandcast {
namespace {

constexpr double kLargestNumber = 1e9;

bool isBvhBlank(char c) { return static_cast<unsigned char>(c) <= ' '; }
bool isBvhBrace(char c) { return c == '{' || c == '}'; }

/// Length of the word at the start of `rest`. A comma ends the word, except a decimal comma: the only comma
/// of a word without a point, with digits on both sides.
size_t bvhWordLength(std::string_view rest) {
  if (rest.empty() || isBvhBrace(rest[0])) return std::min<size_t>(rest.size(), 1);
  size_t end = 0, commas = 0, comma = 0;
  bool has_point = false;
  for (; end < rest.size() && !isBvhBlank(rest[end]) && !isBvhBrace(rest[end]); ++end) {
    has_point |= rest[end] == '.';
    if (rest[end] != ',') continue;
    if (commas++ == 0) comma = end;
  }
  const auto isDigit = [&](size_t i) { return i < end && rest[i] >= '0' && rest[i] <= '9'; };
  const bool is_decimal = commas == 1 && !has_point && comma > 0 && isDigit(comma - 1) && isDigit(comma + 1);
  return commas == 0 || is_decimal ? end : std::max<size_t>(comma, 1);
}

}  // namespace

void BvhText::failAt(size_t line, const std::string& what, const std::string& remedy) const {
  throw Error(what, name_ + ", line " + std::to_string(line), remedy);
}

void BvhText::fail(const std::string& what, const std::string& remedy) const { failAt(line_, what, remedy); }

void BvhText::skipBlanks() {
  for (; at_ < text_.size() && (isBvhBlank(text_[at_]) || text_[at_] == ','); ++at_) {
    const bool ends_line =
        text_[at_] == '\n' || (text_[at_] == '\r' && !text_.substr(at_ + 1).starts_with('\n'));
    line_ += ends_line ? 1 : 0;
  }
}

std::string_view BvhText::peek() {
  skipBlanks();
  const std::string_view rest = text_.substr(at_);
  return rest.substr(0, bvhWordLength(rest));
}

std::string_view BvhText::next() {
  const std::string_view word = peek();
  if (word.empty()) fail("the file ends early");
  at_ += word.size();
  return word;
}

std::string_view BvhText::nextName() {
  skipBlanks();
  std::string_view rest = text_.substr(at_);
  rest = rest.substr(0, rest.find_first_of("\r\n{"));
  while (!rest.empty() && isBvhBlank(rest.back())) rest.remove_suffix(1);
  if (rest.empty()) fail("a joint has no name");
  at_ += rest.size();
  return rest;
}

void BvhText::skipName() { at_ = std::min(text_.find_first_of("\r\n{", at_), text_.size()); }

void BvhText::expect(std::string_view keyword) {
  const std::string_view found = next();
  if (is(found, keyword)) return;
  std::string wanted(keyword);
  std::transform(wanted.begin(), wanted.end(), wanted.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  fail("expected " + wanted + ", found " + shown(found));
}

double BvhText::number() {
  const std::string_view word = next();
  if (const std::optional<double> value = numberIn(word)) return *value;
  fail((numberOrInfinite(word) ? "number is out of range: " : "expected a number, found ") + shown(word));
}

std::optional<double> BvhText::numberIn(std::string_view word) {
  std::string with_point;
  if (const size_t comma = word.find(','); comma != std::string_view::npos) {
    with_point = word;
    with_point[comma] = '.';
    word = with_point;
    has_decimal_commas_ = true;
  }
  const std::optional<double> value = numberOf(word);
  return value && std::abs(*value) <= kLargestNumber ? value : std::nullopt;
}

std::optional<std::string_view> BvhText::nextLine() {
  skipBlanks();
  if (at_ == text_.size()) return {};
  const LineEnd found = lineEnd(text_, at_);
  const std::string_view line = text_.substr(at_, found.end - at_);
  at_ = found.end;
  return line;
}

void BvhText::goTo(const Place& place) {
  at_ = place.at;
  line_ = place.line;
}

std::string_view BvhText::Row::next() {
  while (!line_.empty() && (isBvhBlank(line_[0]) || line_[0] == ',')) line_.remove_prefix(1);
  const std::string_view word = line_.substr(0, bvhWordLength(line_));
  line_.remove_prefix(word.size());
  return word;
}

std::string BvhText::shortened(std::string_view word) {
  constexpr size_t kMax = 32;
  std::string out;
  for (const char c : word.substr(0, kMax)) out += c >= ' ' && c <= '~' ? c : '?';
  return out + (word.size() > kMax ? "..." : "");
}

bool BvhText::is(std::string_view word, std::string_view keyword) {
  return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(), [](char a, char b) {
    return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
  });
}

}  // namespace strandcast
