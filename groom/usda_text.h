#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "groom/file_bytes.h"

namespace strandcast {

/// The tokens of a text of Universal Scene Description (.usda, versions 1.x), one after the other. White
/// space and comments (`#`, `//` and `/* */`) may stand between any two tokens. Lines end with LF, CR LF or
/// CR. Source: https://openusd.org/release/spec_usda.html and OpenUSD's textFileFormatParser.h.
class UsdaText {
 public:
  /// How many numbers stand in a pair of round brackets, at the least and at the most: 1 of those that stand
  /// in none; 0 without numbers.
  struct TupleSizes {
    size_t fewest = 0, most = 0;
    void add(size_t size);
  };

  enum class Kind { kEnd, kWord, kNumber, kString, kAsset, kPath, kMark };

  /// Throws Error unless it begins with `#usda 1.` and a number.
  UsdaText(std::span<const std::byte> bytes, std::string name);

  Kind kind() const { return kind_; }
  /// A word may have colons and points in it. Of strings, assets and paths, `text()` is what stands between
  /// their marks, with its escapes.
  std::string_view text() const { return text_; }
  size_t line() const { return line_; }  ///< 1-based, where it starts
  void next();

  bool isMark(char mark) const { return kind_ == Kind::kMark && text_[0] == mark; }
  bool isWord(std::string_view word) const { return kind_ == Kind::kWord && text_ == word; }
  /// Goes on where that mark, or word, is; gives whether it was.
  bool takeMark(char mark);
  bool takeWord(std::string_view word);
  void expectMark(char mark);
  std::string_view takeString();
  /// A whole value of whatever type: a word, or all between brackets.
  void skipValue();
  /// The numbers of a value, in their order, whatever brackets they are in: `None` has none. They may be
  /// infinite or not a number (`inf`, `nan`, or out of a double's range). Throws Error for anything else.
  /// Tells the sizes of their tuples where `sizes` is given.
  std::vector<double> takeNumbers(TupleSizes* sizes = nullptr);
  /// The strings of a value, likewise.
  std::vector<std::string> takeStrings();
  /// What a value refers to, likewise, for a report: assets as `@name@`, and paths that no asset precedes as
  /// `<path>`.
  std::vector<std::string> takeTargets();

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
  /// Goes on by `count` characters and counts the lines that end in them.
  void advance(size_t count);
  void takeQuoted(char quote);
  void takeAsset();
  void takePath();
  /// Calls take(mark) for each word between the brackets of a value, or for the one that it is, and
  /// close(mark) at each closing bracket; `mark` is that which closes the innermost, or 0.
  template <class Take, class Close>
  void forEach(const Take& take, const Close& close);
  template <class Take>
  void forEach(const Take& take) {
    forEach([&](char) { take(); }, [](char) {});
  }

  std::string name_;
  std::string_view all_;
  size_t at_ = 0, next_line_ = 1;  // of what follows
  Kind kind_ = Kind::kEnd;
  std::string_view text_;
  size_t line_ = 1;
};

/// A name of a file for a report: on one line, other than printable characters escaped, cut where it is long.
std::string printableName(std::string_view name);

}  // namespace strandcast
