#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "io/file_bytes.h"

namespace strandcast {

/// Tokeniser of Universal Scene Description text (.usda, versions 1.x). White space and comments (`#`, `//`
/// and `/* */`) may separate any two tokens. Lines end with LF, CR LF or CR. Source:
/// https://openusd.org/release/spec_usda.html and OpenUSD's textFileFormatParser.h.
class UsdaText {
 public:
  /// Smallest and largest count of numbers in the tuples (round brackets) of a value. A number outside a
  /// tuple counts as a tuple of 1. Both are 0 without numbers.
  struct TupleSizes {
    size_t fewest = 0, most = 0;
    void add(size_t size);
  };

  enum class Kind { kEnd, kWord, kNumber, kString, kAsset, kPath, kMark };

  /// Throws Error unless the text begins with `#usda 1.` and a number.
  UsdaText(std::span<const std::byte> bytes, std::string name);

  Kind kind() const { return kind_; }
  /// Text of the token. A word may contain colons and points. Of a string, asset or path it is the part
  /// between the delimiters, with escapes unresolved.
  std::string_view text() const { return text_; }
  size_t line() const { return line_; }  ///< 1-based, where the token starts
  /// Advances to the next token. Throws Error on malformed text.
  void next();

  bool isMark(char mark) const { return kind_ == Kind::kMark && text_[0] == mark; }
  bool isWord(std::string_view word) const { return kind_ == Kind::kWord && text_ == word; }
  /// Advances past the given mark or word if it is the current token; returns whether it was.
  bool acceptMark(char mark);
  bool acceptWord(std::string_view word);
  /// Advances past the mark. Throws Error on another token.
  void expectMark(char mark);
  /// Advances past a string and returns its text. Throws Error on another token.
  std::string_view readString();
  /// Skips a whole value of any type: a word, or everything up to the matching closing bracket.
  void skipValue();
  /// Returns the numbers of a value in their order, ignoring brackets; none for `None`. They may be infinite
  /// or NaN (`inf`, `nan`, or out of the range of a double). Stores the sizes of tuples in `sizes` if given.
  /// With `flags`, `true` and `false` are 1 and 0. Throws Error on any other token.
  std::vector<double> readNumbers(TupleSizes* sizes = nullptr, bool flags = false);
  /// Returns the strings of a value, likewise.
  std::vector<std::string> readStrings();
  /// Returns the targets of a value for a report, likewise: assets as `@name@`, and paths not preceded by an
  /// asset as `<path>`.
  std::vector<std::string> readTargets();

  /// Throws Error located at the line of the token.
  [[noreturn]] void fail(const std::string& what,
                         const std::string& remedy = "mend the line or export the file again") const {
    failAt(line_, what, remedy);
  }
  [[noreturn]] void failAt(size_t line, const std::string& what, const std::string& remedy) const {
    throw Error(what, name_ + ", line " + std::to_string(line), remedy);
  }

 private:
  void checkVersion();
  void skipBlank();
  /// Advances by `count` characters and counts the line ends among them.
  void advance(size_t count);
  void scanQuoted(char quote);
  void scanAsset();
  void scanPath();
  /// Calls take(mark) for each word inside the brackets of a value, or once for a value without brackets, and
  /// close(mark) at each closing bracket. `mark` is the bracket that closes the innermost pair, or 0.
  template <class Take, class Close>
  void forEach(const Take& take, const Close& close);
  template <class Take>
  void forEach(const Take& take) {
    forEach([&](char) { take(); }, [](char) {});
  }

  std::string name_;
  std::string_view all_;
  size_t at_ = 0, next_line_ = 1;  // of the text after the token
  Kind kind_ = Kind::kEnd;
  std::string_view text_;
  size_t line_ = 1;
};

/// The characters that the text of a string stands for, with its escapes resolved; and the text of a string
/// in double quotes, on one line. usdaUnescaped(usdaEscaped(s)) is s.
std::string usdaUnescaped(std::string_view text);
std::string usdaEscaped(std::string_view characters);

/// A file name for a report: one line, non-printable characters escaped, truncated if long.
std::string printableName(std::string_view name);

}  // namespace strandcast
