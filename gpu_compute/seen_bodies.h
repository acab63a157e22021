#pragma once
#include <cstdint>
#include <vector>

#include "core/backend.h"
#include "core/broad_phase.h"

namespace strandcast::gpu {

/// The bodies of the newest step, to tell whether what vertices have seen of them holds on in the next.
class SeenBodies {
 public:
  /// To be called in every step, in order. True when its bodies are those of the step before, go on from
  /// where they were, and the same strands may touch them.
  bool holdsIn(const StepInput& input);

 private:
  bool goOn(const StepInput& input) const;

  std::vector<MovingPrimitive> bodies_;
  bool listed_ = false;
  NearBodyLists near_;
  uint64_t shapes_revision_ = 0;
  float hair_radius_ = 0;
};

}  // namespace strandcast::gpu
