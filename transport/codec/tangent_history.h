#pragma once
#include <cstdint>
#include <vector>

namespace strandcast {

/// Directions of a run's edges, unit vectors in the head's frame, in the order of StrandCoder: tile after
/// tile, edge after edge, x y z, one strand per lane.
using DirectionRows = std::vector<float>;

/// What encoder and decoder keep of a run for the frame that builds on it.
class TangentHistory {
 public:
  uint64_t frame = 0;  ///< 0 = none
  DirectionRows last;  ///< directions in `frame`

  /// Directions in the frame that `frame` built on; equal to `last` (no motion) where `frame` was a key
  /// frame.
  const DirectionRows& before() const { return stood_alone_ ? last : before_; }

  /// Records the directions of a frame; swaps the arrays.
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
