#pragma once
#include <cstdint>
#include <vector>

#include "core/backend.h"
#include "core/broad_phase.h"

namespace strandcast::gpu {

/// Remembers the bodies of the newest step, to decide whether the contact cache remains valid in the next.
class PreviousBodies {
 public:
  /// Call it once per step, in order. True if the step has the bodies of the step before, each starts where
  /// it ended, and the near-body lists and the hair's radius are the same.
  bool matchesNext(const StepInput& input);

 private:
  bool isContinuation(const StepInput& input) const;

  std::vector<MovingPrimitive> bodies_;
  bool listed_ = false;
  NearBodyLists near_;
  uint64_t shapes_revision_ = 0;
  float hair_radius_ = 0;
};

}  // namespace strandcast::gpu
