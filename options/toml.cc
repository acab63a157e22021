#include "options/toml.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace strandcast {
namespace {

/// The end of the string whose opening quote is at `at`; the end of its line where the string is not closed.
size_t endOfString(const std::string& text, size_t at) {
  const std::string quote(text.compare(at, 3, std::string(3, text[at])) == 0 ? 3 : 1, text[at]);
  for (size_t i = at + quote.size(); i < text.size(); ++i) {
    if (text[i] == '\\' && quote[0] == '"') {
      ++i;
    } else if (text.compare(i, quote.size(), quote) == 0) {
      const size_t most = std::min(i + (quote.size() == 3 ? 5 : 1),
                                   text.size());  // two may be text
      size_t end = i + quote.size();
      while (end < most && text[end] == quote[0]) ++end;
      return end;
    } else if (text[i] == '\n' && quote.size() == 1) {
      return i;
    }
  }
  return text.size();
}

/// toml++ recurses once per part of a dotted key: very many parts overflow the stack.
void refuseLongKeys(const std::string& text, const std::string& name) {
  constexpr int kMaxParts = 64;
  const std::string ends_of_keys = "\n=,[]{}";
  int line = 1, parts = 1;
  for (size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (ends_of_keys.find(c) != std::string::npos) parts = 1;
    if (c == '.' && ++parts > kMaxParts)
      throw Error(fmt::format("a key has more than {} parts", kMaxParts),
                  fmt::format("{} line {}", name, line), "is it the right file?");
    const size_t end = c == '#'                ? std::min(text.find('\n', i), text.size())
                       : c == '"' || c == '\'' ? endOfString(text, i)
                                               : i + 1;
    line += static_cast<int>(std::count(text.begin() + static_cast<ptrdiff_t>(i),
                                        text.begin() + static_cast<ptrdiff_t>(end), '\n'));
    i = end;
  }
}

}  // namespace

toml::table parsedToml(const std::string& text, const std::string& name) {
  refuseLongKeys(text, name);
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw Error("not valid TOML: " + std::string(error.description()),
                fmt::format("{} line {}", name, error.source().begin.line), "");
  } catch (const std::invalid_argument& error) {
    throw Error("not valid TOML: " + std::string(error.what()), name, "check its keys");
  }
}

}  // namespace strandcast
