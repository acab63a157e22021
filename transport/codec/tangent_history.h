#pragma once
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Of an edge, for the next one and the next frame: |u| + |v| of its symbols, at most 65535.
using TangentSizes = std::vector<uint16_t>;

/// What both ends remember of a run for the frame that builds on it.
class TangentHistory {
 public:
  uint64_t frame = 0;      ///< 0 = nothing
  TangentSizes sizes;      ///< of `frame`
  std::vector<Vec3> last;  ///< per edge: unit, in the head's frame, of `frame`

  /// The same of the frame that it built on; of itself where it stood alone: no motion yet.
  const std::vector<Vec3>& before() const { return stood_alone_ ? last : before_; }

  /// What was written of a frame; exchanges the arrays.
  void accept(uint64_t of_frame, bool stands_alone, std::vector<Vec3>& directions, TangentSizes& of_sizes) {
    frame = of_frame;
    stood_alone_ = stands_alone;
    before_.swap(last);
    last.swap(directions);
    sizes.swap(of_sizes);
  }

 private:
  bool stood_alone_ = true;
  std::vector<Vec3> before_;
};

}  // namespace strandcast
