#pragma once
#include <cstdint>

#include "transport/publisher.h"

namespace strandcast {

/// Warns, once of each, of other daemons that cast the same groom. A daemon that starts listens for rivals
/// first (claimGroom()), but a network may be too busy to let it hear one in time, and a daemon that somebody
/// has written of their own may not listen at all.
class RivalWarning {
 public:
  explicit RivalWarning(uint32_t groom_id) : groom_id_(groom_id) {}
  void look(const Publisher& publisher);

 private:
  uint32_t groom_id_;
  uint64_t warned_ = 0;  ///< session
};

}  // namespace strandcast
