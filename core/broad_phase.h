#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// For each neighbourhood of strands (StrandOrder) the bodies that it may touch in a step.
struct NearBodyLists {
  std::vector<uint32_t> offsets;  ///< neighbourhoods + 1, into `bodies`
  std::vector<uint32_t> bodies;   ///< indices, ascending in each list

  std::span<const uint32_t> of(size_t neighbourhood) const {
    return {bodies.data() + offsets[neighbourhood], offsets[neighbourhood + 1] - offsets[neighbourhood]};
  }
};

/// A side as far away as this has no end: planes, and strands that a bone may pull anywhere.
constexpr float kEndless = 1e18f;  // m

/// Finds which boxes meet. One caller at a time.
class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  /// Fills `out` with the bodies whose boxes meet that of each neighbourhood, all where those bodies are
  /// during a step.
  virtual void find(std::span<const Box> bodies, std::span<const Box> neighbourhoods, NearBodyLists& out) = 0;
};

/// Tries every body with every neighbourhood: the fastest for a few bodies.
std::unique_ptr<BroadPhase> makeAllPairs();

}  // namespace strandcast
