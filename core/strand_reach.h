#pragma once
#include <span>
#include <vector>

#include "core/strand_order.h"

namespace strandcast {

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
