#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace strandcast {

/// Tokeniser of BVH text. Braces are words of their own. Words are separated by spaces, tabs, line ends of
/// any kind, and commas between numbers.
class BvhText {
 public:
  /// `name` stands for the file in errors. The text and `name` must outlive the object.
  BvhText(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  /// Throws Error at the current line.
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = kIncomplete) const;
  [[noreturn]] void failAt(size_t line, const std::string& what,
                           const std::string& remedy = kIncomplete) const;

  /// The next word, not consumed; empty at the end of the text.
  std::string_view peek();
  /// Consumes and returns the next word. Throws Error at the end of the text.
  std::string_view next();
  /// Consumes and returns the text up to the end of the line or a brace, trimmed, since names may contain
  /// spaces. Throws Error if it is empty.
  std::string_view nextName();
  /// Skips the rest of the line, up to a brace.
  void skipName();
  /// Consumes the word `keyword`, in any case. Throws Error on another word.
  void expect(std::string_view keyword);
  /// Consumes a number. Throws Error if the next word is not a number of magnitude 1e9 or less.
  double number();

  /// Consumes and returns the next line that is not blank; none at the end.
  std::optional<std::string_view> nextLine();
  size_t line() const { return line_; }  ///< 1-based, of what was consumed last

  /// A position in the text, to return to.
  struct Place {
    size_t at, line;
  };
  Place place() const { return {at_, line_}; }
  void goTo(const Place& place);

  bool hasDecimalCommas() const { return has_decimal_commas_; }

  /// Splits one line into numbers and words.
  class Row {
   public:
    explicit Row(std::string_view line) : line_(line) {}
    std::string_view next();  ///< empty at the end

   private:
    std::string_view line_;
  };
  /// As number(), but returns none if the word is not such a number.
  std::optional<double> numberIn(std::string_view word);

  /// A word for messages: up to 32 printable characters, followed by "..." if longer.
  static std::string shortened(std::string_view word);
  /// As shortened(), in quotes.
  static std::string shown(std::string_view word) { return "'" + shortened(word) + "'"; }
  /// Whether a word equals `keyword`, ignoring case. `keyword` is in lower case.
  static bool is(std::string_view word, std::string_view keyword);

  static constexpr const char* kIncomplete = "check that the BVH file is complete";

 private:
  void skipBlanks();

  std::string_view text_;
  const std::string& name_;
  size_t at_ = 0;
  size_t line_ = 1;
  bool has_decimal_commas_ = false;
};

}  // namespace strandcast
