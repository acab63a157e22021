#include "groom/usda_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "groom/text_number.h"

namespace strandcast {
namespace {

constexpr std::string_view kBegin = "#usda 1.0", kBinary = "PXR-USDC", kPackage = "PK";

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isNumberPart(char c) { return isDigit(c) || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E'; }
// What is beyond ASCII counts as letters.
bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool isWordPart(char c) {
  return isDigit(c) || isLetter(c) || c == '_' || c == ':' || c == '.' ||
         static_cast<unsigned char>(c) >= 0x80;
}
char closingOf(char c) { return c == '(' ? ')' : c == '[' ? ']' : c == '{' ? '}' : '\0'; }
bool closes(char c) { return c == ')' || c == ']' || c == '}'; }

}  // namespace

UsdaText::UsdaText(std::span<const std::byte> bytes, std::string name)
    : name_(std::move(name)), all_(textOfFile(bytes)) {
  if (all_.starts_with(kBinary) || all_.starts_with(kPackage))
    fail("this is USD in its binary form", "save it as text: usdcat FILE -o FILE.usda");
  if (!all_.starts_with(kBegin))
    fail("this is no USD text (it does not start with #usda 1.0)", "check the file and its extension");
  next();
}

void UsdaText::skipBlank() {
  for (; at_ < all_.size(); ++at_) {
    const char c = all_[at_];
    if (c == '#') {
      at_ = std::min(all_.find('\n', at_), all_.size());
      if (at_ == all_.size()) return;
    }
    if (all_[at_] == '\n')
      ++next_line_;
    else if (all_[at_] != ' ' && all_[at_] != '\t' && all_[at_] != '\r')
      return;
  }
}

void UsdaText::takeUntil(char end, Kind kind, const char* what) {
  const size_t first = at_ + 1, last = all_.find(end, first);
  if (last == std::string_view::npos) fail(fmt::format("{} does not end", what));
  kind_ = kind;
  text_ = all_.substr(first, last - first);
  next_line_ += static_cast<size_t>(std::count(text_.begin(), text_.end(), '\n'));
  at_ = last + 1;
}

void UsdaText::takeQuoted(char quote) {
  const std::string_view three = quote == '"' ? R"(""")" : "'''";
  const bool is_long = all_.substr(at_).starts_with(three);
  const size_t width = is_long ? 3 : 1, first = at_ + width;
  size_t last = first;
  for (;; ++last) {
    if (last >= all_.size() || (!is_long && all_[last] == '\n')) fail("a string does not end");
    if (all_[last] == '\\')
      ++last;
    else if (is_long ? all_.substr(last).starts_with(three) : all_[last] == quote)
      break;
  }
  kind_ = Kind::kString;
  text_ = all_.substr(first, last - first);
  next_line_ += static_cast<size_t>(std::count(text_.begin(), text_.end(), '\n'));
  at_ = last + width;
}

void UsdaText::next() {
  skipBlank();
  line_ = next_line_;
  text_ = {};
  kind_ = Kind::kEnd;
  if (at_ >= all_.size()) return;
  const char c = all_[at_];
  if (c == '"' || c == '\'') return takeQuoted(c);
  if (c == '@') return takeUntil('@', Kind::kAsset, "the name of an asset");
  if (c == '<') return takeUntil('>', Kind::kPath, "a path");
  const bool number = isDigit(c) || c == '-' || c == '+' || c == '.', word = isWordPart(c) && c != ':';
  size_t end = at_;
  while (end < all_.size() &&
         ((number && isNumberPart(all_[end])) || (word && !number && isWordPart(all_[end]))))
    ++end;
  while (number && end < all_.size() && isLetter(all_[end])) ++end;  // "-inf" is a number too
  kind_ = number ? Kind::kNumber : word ? Kind::kWord : Kind::kMark;
  end = std::max(end, at_ + 1);
  text_ = all_.substr(at_, end - at_);
  at_ = end;
}

bool UsdaText::takeMark(char mark) {
  const bool is = isMark(mark);
  if (is) next();
  return is;
}
bool UsdaText::takeWord(std::string_view word) {
  const bool is = isWord(word);
  if (is) next();
  return is;
}
void UsdaText::expectMark(char mark) {
  if (!takeMark(mark))
    fail(kind_ == Kind::kEnd ? fmt::format("the file ends where a '{}' should be", mark)
                             : fmt::format("there should be a '{}'", mark));
}
std::string_view UsdaText::takeString() {
  if (kind_ != Kind::kString) fail("there should be a name in quotes");
  const std::string_view text = text_;
  next();
  return text;
}

template <class Take>
void UsdaText::forEach(const Take& take) {
  std::string open;  // what is to close the brackets
  do {
    if (kind_ == Kind::kEnd) fail("the file ends within a value");
    const char mark = kind_ == Kind::kMark ? text_[0] : '\0';
    if (closingOf(mark) != '\0') {
      open.push_back(closingOf(mark));
    } else if (closes(mark)) {
      if (open.empty()) fail("a value is missing");
      if (open.back() != mark) fail(fmt::format("there should be a '{}'", open.back()));
      open.pop_back();
    } else if (mark != ',') {
      take();
    }
    next();
  } while (!open.empty());
}

void UsdaText::skipValue() {
  const bool asset = kind_ == Kind::kAsset;
  forEach([] {});
  if (asset && kind_ == Kind::kPath) next();  // a place in it
}

std::vector<double> UsdaText::takeNumbers() {
  std::vector<double> numbers;
  if (takeWord("None")) return numbers;
  forEach([&] {
    const std::optional<double> number = kind_ == Kind::kNumber ? numberOf(text_) : std::nullopt;
    if (!number || !std::isfinite(*number)) fail("there should be a finite number");
    numbers.push_back(*number);
  });
  return numbers;
}

std::vector<std::string> UsdaText::takeStrings() {
  std::vector<std::string> strings;
  if (takeWord("None")) return strings;
  forEach([&] {
    if (kind_ != Kind::kString) fail("there should be a string in quotes");
    strings.emplace_back(text_);
  });
  return strings;
}

}  // namespace strandcast
