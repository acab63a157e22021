#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "groom/file_bytes.h"

namespace strandcast {

/// Walks a text of Universal Scene Description (.usda) word by word: comments and white space taken off.
class UsdaText {
 public:
  enum class Kind { kEnd, kWord, kNumber, kString, kAsset, kPath, kMark };

  /// Throws Error unless it begins as such texts do.
  UsdaText(std::span<const std::byte> bytes, std::string name);

  Kind kind() const { return kind_; }
  /// A word may have colons and points in it; of strings, assets and paths what is between their marks.
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
  /// The numbers of a value, in their order, whatever brackets they are in: `None` has none. Throws Error
  /// where there is anything else, or one is not finite.
  std::vector<double> takeNumbers();
  /// The strings of a value, likewise.
  std::vector<std::string> takeStrings();

  [[noreturn]] void fail(const std::string& what,
                         const std::string& remedy = "mend the line or export the file again") const {
    failAt(line_, what, remedy);
  }
  [[noreturn]] void failAt(size_t line, const std::string& what, const std::string& remedy) const {
    throw Error(what, name_ + ", line " + std::to_string(line), remedy);
  }

 private:
  void skipBlank();
  void takeQuoted(char quote);
  void takeUntil(char end, Kind kind, const char* what);
  /// Calls take() for each word between the brackets of a value, or for the one that it is.
  template <class Take>
  void forEach(const Take& take);

  std::string name_;
  std::string_view all_;
  size_t at_ = 0, next_line_ = 1;  // of what follows
  Kind kind_ = Kind::kEnd;
  std::string_view text_;
  size_t line_ = 1;
};

}  // namespace strandcast
