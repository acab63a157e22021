#pragma once
#include <cstdint>
#include <vector>

#include "core/geometry.h"

namespace strandcast {

/// Of an edge, for the next one and the next frame: |u| + |v| of its symbols, at most 65535.
using TangentSizes = std::vector<uint16_t>;

/// What both ends remember of a run for the frame that builds on it.
struct TangentHistory {
  uint64_t frame = 0;              ///< 0 = nothing
  std::vector<Vec3> last, before;  ///< per edge: unit, in the head's frame, of `frame` and the one before it
  TangentSizes sizes;              ///< of `frame`

  /// What was written of a frame; exchanges the arrays. One that `stands_alone` has no motion yet.
  void accept(uint64_t of_frame, bool stands_alone, std::vector<Vec3>& directions, TangentSizes& of_sizes) {
    frame = of_frame;
    before.swap(last);
    last.swap(directions);
    if (stands_alone) before = last;
    sizes.swap(of_sizes);
  }
};

}  // namespace strandcast
