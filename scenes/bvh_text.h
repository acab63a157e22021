#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace strandcast {

/// Goes through the text of a BVH file word by word. Braces are words of their own. Blanks are spaces, tabs,
/// line ends of every kind and commas between numbers.
class BvhText {
 public:
  /// `name` stands for the file in errors. Both have to outlive it.
  BvhText(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  /// Throws Error with the line that was reached.
  [[noreturn]] void fail(const std::string& what, const std::string& remedy = kIncomplete) const;
  [[noreturn]] void failAt(size_t line, const std::string& what,
                           const std::string& remedy = kIncomplete) const;

  /// The next word, empty at the end of the text.
  std::string_view peek();
  /// The same, passed. Throws Error at the end of the text.
  std::string_view next();
  /// Up to the end of the line or a brace, without blanks around: names may have spaces. Throws Error where
  /// there is nothing.
  std::string_view nextName();
  /// Passes the rest of the line, up to a brace.
  void skipName();
  /// Passes a word that is `keyword` in any case. Throws Error where it is another.
  void expect(std::string_view keyword);
  /// Throws Error where the next word is not a number of at most 1e9 either way.
  double number();

  /// The rest of the text, line by line: the next line that is not blank; none at the end.
  std::optional<std::string_view> nextLine();
  size_t line() const { return line_; }  ///< 1-based, of what was passed last

  /// Where the text goes on, to come back to.
  struct Place {
    size_t at, line;
  };
  Place place() const { return {at_, line_}; }
  void goTo(const Place& place);

  bool hasDecimalCommas() const { return has_decimal_commas_; }

  /// The numbers and words of one line.
  class Row {
   public:
    explicit Row(std::string_view line) : line_(line) {}
    std::string_view next();  ///< empty at the end

   private:
    std::string_view line_;
  };
  /// As number(), but without a value where the word is not such a number.
  std::optional<double> numberIn(std::string_view word);

  /// A word as messages have it: up to 32 printable characters, "..." where there are more.
  static std::string shortened(std::string_view word);
  /// The same in quotes.
  static std::string shown(std::string_view word) { return "'" + shortened(word) + "'"; }
  /// Whether a word is `keyword`, which is in lower case, in any case.
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
