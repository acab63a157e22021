#pragma once
#include <cstdint>
#include <vector>

namespace strandcast {

/// Directions of a run's edges, unit, in the head's frame, as a StrandCoder goes along them: tile after tile,
/// edge after edge, x y z, a strand per lane.
using DirectionRows = std::vector<float>;

/// What both ends remember of a run for the frame that builds on it.
class TangentHistory {
 public:
  uint64_t frame = 0;  ///< 0 = nothing
  DirectionRows last;  ///< of `frame`

  /// Of the frame that it built on; of itself where it stood alone: no motion yet.
  const DirectionRows& before() const { return stood_alone_ ? last : before_; }

  /// What was written of a frame; exchanges the arrays.
  void accept(uint64_t of_frame, bool stands_alone, DirectionRows& directions) {
    frame = of_frame;
    stood_alone_ = stands_alone;
    before_.swap(last);
    last.swap(directions);
  }

 private:
  bool stood_alone_ = true;
  DirectionRows before_;
};

}  // namespace strandcast
