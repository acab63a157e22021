#pragma once
#include <stdexcept>
#include <string>

namespace strandcast {

/// What a user can mend: bad input, bad configuration, a missing driver. Prints as one line,
/// `what: where; remedy`. Programs end with exit code 2 on it. Never thrown by the frame loop.
class Error : public std::runtime_error {
 public:
  /// `what` went wrong, `where` (file, byte offset, key, device), and the `remedy` the user can try.
  Error(const std::string& what, const std::string& where, const std::string& remedy)
      : std::runtime_error(what + ": " + where + (remedy.empty() ? "" : "; " + remedy)) {}
};

}  // namespace strandcast
