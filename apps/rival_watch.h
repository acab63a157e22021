#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "transport/publisher.h"

namespace strandcast {

/// So long after its first frame a daemon gives way to one that has cast the same groom for longer.
inline constexpr std::chrono::seconds kSecondThoughts{10};

/// Looks for other daemons that cast the same groom. A daemon that starts listens for rivals first
/// (GroomClaim), but a network may be too busy to let it hear one in time, and a daemon that somebody has
/// written of their own may not listen at all.
class RivalWatch {
 public:
  explicit RivalWatch(uint32_t groom_id) : groom_id_(groom_id) {}
  /// Why the daemon of `session`, which has cast `frames` since `casting` ago, is to end: another one was
  /// heard late that has cast for longer, or as long and has the lower session. Of others it warns, once of
  /// each: nothing.
  std::optional<std::string> look(const Publisher& publisher, uint64_t session, uint64_t frames,
                                  std::chrono::steady_clock::duration casting);

 private:
  uint32_t groom_id_;
  uint64_t warned_ = 0;  ///< session
};

}  // namespace strandcast
