#pragma once
#include <span>
#include <vector>

#include "core/strand_order.h"

namespace strandcast {

/// How far the strands of each neighbourhood of a StrandOrder may come from their roots in a step.
class StrandReach {
 public:
  /// `lengths`: of the strands at rest, m.
  StrandReach(const StrandModel& model, const StrandOrder& order, std::span<const float> lengths);

  size_t neighbourhoods() const { return reach_.size(); }
  /// Boxes that hold them while the model's bones go from `begin` to `end`, one per neighbourhood, `margin`
  /// (m) larger on all sides. Those of strands that other bones hold too are endless.
  void place(std::span<const Pose> begin, std::span<const Pose> end, float margin,
             std::span<Box> boxes) const;

 private:
  /// Roots of a neighbourhood that ride on one bone.
  struct Roots {
    uint32_t neighbourhood;
    uint16_t bone;
    Box box;  ///< m, in the bone's frame
  };
  std::vector<Roots> roots_;
  std::vector<float> reach_;  ///< m, per neighbourhood; kEndless where another bone holds a strand of it
};

}  // namespace strandcast
