#include "io/usda_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "io/text_number.h"

namespace strandcast {
namespace {

constexpr std::string_view kUsdaMagic = "#usda", kUsdcMagic = "PXR-USDC", kZipMagic = "PK";
constexpr std::string_view kUsdaLineEnds = "\r\n";

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isNumberPart(char c) { return isDigit(c) || c == '.' || c == '-' || c == '+' || c == 'e' || c == 'E'; }
// Bytes beyond ASCII count as letters.
bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool isWordPart(char c) {
  return isDigit(c) || isLetter(c) || c == '_' || c == ':' || c == '.' ||
         static_cast<unsigned char>(c) >= 0x80;
}
char closingOf(char c) { return c == '(' ? ')' : c == '[' ? ']' : c == '{' ? '}' : '\0'; }
bool isUsdaSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool closes(char c) { return c == ')' || c == ']' || c == '}'; }

}  // namespace

UsdaText::UsdaText(std::span<const std::byte> bytes, std::string name)
    : name_(std::move(name)), all_(textOfFile(bytes, name_)) {
  if (all_.starts_with(kUsdcMagic) || all_.starts_with(kZipMagic))
    fail("this is USD in its binary form", "save it as text: usdcat FILE -o FILE.usda");
  checkVersion();
  next();
}

void UsdaText::checkVersion() {
  if (!all_.starts_with(kUsdaMagic))
    fail("this is no USD text (it does not start with #usda 1.0)", "check the file and its extension");
  std::string_view version = all_.substr(kUsdaMagic.size());
  version = version.substr(0, std::min(version.find_first_of(kUsdaLineEnds), version.size()));
  version.remove_prefix(std::min(version.find_first_not_of(" \t"), version.size()));
  version = version.substr(0, std::min(version.find_first_of(" \t#/("), version.size()));
  const size_t point = version.find('.');
  const bool is_version =
      point != std::string_view::npos && point > 0 && point + 1 < version.size() &&
      std::all_of(version.begin(), version.end(), [](char c) { return isDigit(c) || c == '.'; });
  if (!is_version) fail("this USD text does not say its version (#usda 1.0)", "export the file again");
  if (version.substr(0, point) != "1")
    fail(fmt::format("USD text of version {} is not read, versions 1.x are", version.substr(0, 32)),
         "save it as version 1.0: usdcat FILE -o FILE.usda");
}

void UsdaText::advance(size_t count) {
  const size_t end = at_ + std::min(count, all_.size() - at_);
  for (; at_ < end; ++at_)
    if (all_[at_] == '\n' || (all_[at_] == '\r' && all_.substr(at_ + 1, 1) != "\n")) ++next_line_;
}

void UsdaText::skipBlank() {
  while (at_ < all_.size()) {
    const std::string_view rest = all_.substr(at_);
    if (rest[0] == '#' || rest.starts_with("//")) {
      advance(rest.find_first_of(kUsdaLineEnds));
    } else if (rest.starts_with("/*")) {
      const size_t last = rest.find("*/", 2);
      line_ = next_line_;
      if (last == std::string_view::npos) fail("a comment does not end", "close it with */");
      advance(last + 2);
    } else if (isUsdaSpace(rest[0])) {
      advance(1);
    } else {
      return;
    }
  }
}

/// `@name@`, or `@@@name@@@`. In the latter, the name may contain up to two adjacent `@`, also at its end,
/// and `\@@@`.
void UsdaText::scanAsset() {
  const std::string_view three = "@@@", rest = all_.substr(at_);
  size_t width = 1, last = rest.find('@', 1);
  if (rest.starts_with(three)) {
    width = 3;
    last = rest.find(three, width);
    while (last != std::string_view::npos && rest[last - 1] == '\\') last = rest.find(three, last + 3);
    for (int more = 0; more < 2 && last != std::string_view::npos && rest.substr(last + 3, 1) == "@"; ++more)
      ++last;
  }
  const size_t line_end = rest.find_first_of(kUsdaLineEnds);
  if (last == std::string_view::npos || line_end < last) fail("the name of an asset does not end");
  kind_ = Kind::kAsset;
  text_ = rest.substr(width, last - width);
  advance(last + width);
}

void UsdaText::scanPath() {
  const std::string_view rest = all_.substr(at_);
  const size_t last = rest.find('>');
  if (last == std::string_view::npos) fail("a path does not end");
  kind_ = Kind::kPath;
  text_ = rest.substr(1, last - 1);
  advance(last + 1);
}

void UsdaText::scanQuoted(char quote) {
  const std::string_view three = quote == '"' ? R"(""")" : "'''", rest = all_.substr(at_);
  const bool is_long = rest.starts_with(three);
  const size_t width = is_long ? 3 : 1;
  size_t last = width;
  for (;; ++last) {
    if (last >= rest.size() || (!is_long && kUsdaLineEnds.find(rest[last]) != std::string_view::npos))
      fail("a string does not end");
    if (rest[last] == '\\')
      ++last;
    else if (is_long ? rest.substr(last).starts_with(three) : rest[last] == quote)
      break;
  }
  kind_ = Kind::kString;
  text_ = rest.substr(width, last - width);
  advance(last + width);
}

void UsdaText::next() {
  skipBlank();
  line_ = next_line_;
  text_ = {};
  kind_ = Kind::kEnd;
  if (at_ >= all_.size()) return;
  const char c = all_[at_];
  if (c == '"' || c == '\'') return scanQuoted(c);
  if (c == '@') return scanAsset();
  if (c == '<') return scanPath();
  const bool number = isDigit(c) || c == '-' || c == '+' || c == '.', word = isWordPart(c) && c != ':';
  size_t end = at_;
  while (end < all_.size() &&
         ((number && isNumberPart(all_[end])) || (word && !number && isWordPart(all_[end]))))
    ++end;
  while (number && end < all_.size() && isLetter(all_[end])) ++end;  // "-inf" is a number, too
  kind_ = number ? Kind::kNumber : word ? Kind::kWord : Kind::kMark;
  end = std::max(end, at_ + 1);
  text_ = all_.substr(at_, end - at_);
  at_ = end;
}

bool UsdaText::acceptMark(char mark) {
  const bool is = isMark(mark);
  if (is) next();
  return is;
}
bool UsdaText::acceptWord(std::string_view word) {
  const bool is = isWord(word);
  if (is) next();
  return is;
}
void UsdaText::expectMark(char mark) {
  if (!acceptMark(mark))
    fail(kind_ == Kind::kEnd ? fmt::format("the file ends where a '{}' should be", mark)
                             : fmt::format("there should be a '{}'", mark));
}
std::string_view UsdaText::readString() {
  if (kind_ != Kind::kString) fail("there should be a name in quotes");
  const std::string_view text = text_;
  next();
  return text;
}

template <class Take, class Close>
void UsdaText::forEach(const Take& take, const Close& close) {
  std::string open;  // closing brackets that are still to come
  do {
    if (kind_ == Kind::kEnd) fail("the file ends within a value");
    const char mark = kind_ == Kind::kMark ? text_[0] : '\0';
    if (closingOf(mark) != '\0') {
      open.push_back(closingOf(mark));
    } else if (closes(mark)) {
      if (open.empty()) fail("a value is missing");
      if (open.back() != mark) fail(fmt::format("there should be a '{}'", open.back()));
      close(mark);
      open.pop_back();
    } else if (mark != ',') {
      take(open.empty() ? '\0' : open.back());
    }
    next();
  } while (!open.empty());
}

void UsdaText::skipValue() {
  const bool asset = kind_ == Kind::kAsset;
  forEach([] {});
  if (asset && kind_ == Kind::kPath) next();  // a path within that asset
}

void UsdaText::TupleSizes::add(size_t size) {
  fewest = most == 0 ? size : std::min(fewest, size);
  most = std::max(most, size);
}

std::vector<double> UsdaText::readNumbers(TupleSizes* sizes, bool flags) {
  std::vector<double> numbers;
  TupleSizes found;
  size_t in_tuple = 0;
  if (acceptWord("None")) return numbers;
  forEach(
      [&](char closing) {
        if (flags && (isWord("true") || isWord("false"))) {
          numbers.push_back(isWord("true") ? 1 : 0);
        } else {
          const bool may_be = kind_ == Kind::kNumber || isWord("inf") || isWord("nan");
          const std::optional<double> number = may_be ? numberOrInfinite(text_) : std::nullopt;
          if (!number) fail("there should be a number");
          numbers.push_back(*number);
        }
        if (closing == ')')
          ++in_tuple;
        else
          found.add(1);
      },
      [&](char closing) {
        if (closing != ')' || in_tuple == 0) return;
        found.add(std::exchange(in_tuple, 0));
      });
  if (sizes != nullptr) *sizes = found;
  return numbers;
}

std::vector<std::string> UsdaText::readStrings() {
  std::vector<std::string> strings;
  if (acceptWord("None")) return strings;
  forEach([&] {
    if (kind_ != Kind::kString) fail("there should be a string in quotes");
    strings.emplace_back(text_);
  });
  return strings;
}

std::vector<std::string> UsdaText::readTargets() {
  std::vector<std::string> targets;
  bool after_asset = false;  // a path that follows is within that asset
  forEach([&] {
    if (kind_ == Kind::kAsset) targets.push_back(fmt::format("@{}@", printableName(text_)));
    if (kind_ == Kind::kPath && !after_asset) targets.push_back(fmt::format("<{}>", printableName(text_)));
    after_asset = kind_ == Kind::kAsset;
  });
  if (after_asset && kind_ == Kind::kPath) next();
  return targets;
}

namespace {
/// Value of a hexadecimal digit, or -1.
int hexOf(char c) {
  return isDigit(c)             ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}
}  // namespace

std::string usdaUnescaped(std::string_view text) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\' || i + 1 == text.size()) {
      out += text[i];
      continue;
    }
    const char c = text[++i];
    const bool is_byte =
        c == 'x' && i + 2 < text.size() && hexOf(text[i + 1]) >= 0 && hexOf(text[i + 2]) >= 0;
    if (is_byte) {
      out += static_cast<char>(16 * hexOf(text[i + 1]) + hexOf(text[i + 2]));
      i += 2;
    } else {
      out += c == 'n' ? '\n' : c == 'r' ? '\r' : c == 't' ? '\t' : c;
    }
  }
  return out;
}

std::string usdaEscaped(std::string_view characters) {
  std::string out;
  for (const char c : characters)
    if (c == '"' || c == '\\')
      out += {'\\', c};
    else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      out += c;
  return out;
}

std::string printableName(std::string_view name) {
  constexpr size_t kMax = 80;
  const std::string quoted = fmt::format("{:?}", name.substr(0, kMax));
  return fmt::format("{}{}", quoted.substr(1, quoted.size() - 2), name.size() > kMax ? "..." : "");
}

}  // namespace strandcast
