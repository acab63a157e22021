#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Result of the broad phase: for each neighbourhood of strands (StrandOrder) the primitives that it may
/// touch in a step.
struct NearBodyLists {
  std::vector<uint32_t> offsets;  ///< neighbourhoods + 1 entries, into `bodies`
  std::vector<uint32_t> bodies;   ///< indices of primitives, ascending in each list

  std::span<const uint32_t> of(size_t neighbourhood) const {
    return {bodies.data() + offsets[neighbourhood], offsets[neighbourhood + 1] - offsets[neighbourhood]};
  }
};

/// Coordinate of a box side at infinity, m: of planes, and of strands that bones may move anywhere.
constexpr float kEndless = 1e18f;

/// Interface of the broad phase: finds overlapping boxes. Not thread-safe: one caller at a time.
class BroadPhase {
 public:
  virtual ~BroadPhase() = default;
  /// Fills `out` with the primitives whose boxes overlap that of each neighbourhood. `bodies`: one box per
  /// primitive; all boxes are swept over the step.
  virtual void find(std::span<const Box> bodies, std::span<const Box> neighbourhoods, NearBodyLists& out) = 0;
};

/// Tests all pairs: the fastest choice for a few bodies.
std::unique_ptr<BroadPhase> makeAllPairs();

}  // namespace strandcast
