// Broad phase: neighbourhoods of strands, their bounds in a step, and the bodies that they may touch.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "core/strand_model.h"

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
  virtual void findPairs(std::span<const Box> bodies, std::span<const Box> neighbourhoods,
                         NearBodyLists& out) = 0;
};

/// Tests all pairs: the fastest choice for a few bodies.
std::unique_ptr<BroadPhase> makeAllPairs();

/// Strands sorted by vertex count and root position, and cut into neighbourhoods: up to kNeighbours strands
/// of equal vertex count that are side by side on the head. All code that handles several strands together
/// uses this order, so that each neighbourhood is one or more blocks of any CPU backend.
struct StrandOrder {
  std::vector<uint32_t> strands;           ///< strand indices in this order
  std::vector<uint32_t> offsets{0};        ///< neighbourhoods + 1 entries, into `strands`
  std::vector<uint32_t> neighbourhood_of;  ///< per strand, natural order

  size_t neighbourhoods() const { return offsets.size() - 1; }
  std::span<const uint32_t> strandsOf(size_t neighbourhood) const {
    return {strands.data() + offsets[neighbourhood], offsets[neighbourhood + 1] - offsets[neighbourhood]};
  }
};

/// Greatest size of a neighbourhood: a multiple of every number of lanes.
constexpr size_t kNeighbours = 64;

/// Computes the order of a model's strands.
StrandOrder strandOrder(const StrandModel& model);

/// Bounds of the strands of each neighbourhood of a StrandOrder in a step, for the broad phase.
class StrandReach {
 public:
  /// `lengths`: rest length per strand, m.
  StrandReach(const StrandModel& model, const StrandOrder& order, std::span<const float> lengths);

  size_t neighbourhoods() const { return reach_.size(); }
  /// Fills `boxes`, one per neighbourhood, with bounds while the model's bones move from `begin` to `end`,
  /// enlarged by `margin` (m) on all sides. They are infinite for strands with pins on other bones than that
  /// of their root.
  void place(std::span<const Pose> begin, std::span<const Pose> end, float margin,
             std::span<Box> boxes) const;

 private:
  /// Roots of a neighbourhood on one bone.
  struct Roots {
    uint32_t neighbourhood;
    uint16_t bone;
    Box box;  ///< m, in the bone's frame
  };
  std::vector<Roots> roots_;
  std::vector<float> reach_;  ///< m, per neighbourhood; kEndless if another bone holds one of its strands
};

}  // namespace strandcast
