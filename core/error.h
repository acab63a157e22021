// Public API
#pragma once
#include <stdexcept>
#include <string>

namespace strandcast {

/// An error that a user can fix: bad input, bad configuration, a missing driver. Prints as one line, `what:
/// where; remedy`. Programs exit with code 2 on it. The frame loop never throws it.
class Error : public std::runtime_error {
 public:
  /// `what` went wrong, `where` (file, byte offset, key, device), and the `remedy` the user can try.
  Error(const std::string& what, const std::string& where, const std::string& remedy)
      : std::runtime_error(what + ": " + where + (remedy.empty() ? "" : "; " + remedy)) {}
};

}  // namespace strandcast
