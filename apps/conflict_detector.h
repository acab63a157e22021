#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "transport/publisher.h"

namespace strandcast {

/// Period after a daemon's first frame in which it gives way to a daemon that has cast the same groom for
/// longer.
inline constexpr std::chrono::seconds kConflictWindow{10};

/// Detects other daemons that cast the same groom. A starting daemon listens for them first (GroomClaim),
/// but a busy network may delay their messages, and a third-party daemon may not listen at all.
class ConflictDetector {
 public:
  explicit ConflictDetector(uint32_t groom_id) : groom_id_(groom_id) {}
  /// Returns why the daemon of `session`, which has cast `frames` frames for `casting`, must end: a
  /// conflicting daemon was heard late that has cast for longer, or equally long with the lower session. For
  /// any other one it logs a warning, once each, and returns empty.
  std::optional<std::string> check(const Publisher& publisher, uint64_t session, uint64_t frames,
                                   std::chrono::steady_clock::duration casting);

 private:
  uint32_t groom_id_;
  uint64_t warned_ = 0;  ///< session of the daemon warned of last
};

}  // namespace strandcast
