#pragma once
#include <vector>

#include "air/strand_samples.h"

namespace strandcast {

/// What of the drag of all hair is a piece's, where hair has factors of it (StrandModel::air_drag_scale): the
/// air is held back as hair is dragged along.
struct DragShares {
  double mean = 1;  ///< factor of all hair, by mass
  /// Per sample: its factor over the mean, so that masses x shares are together what masses are. Empty:
  /// all 1.
  std::vector<float> of_samples;
};

DragShares dragShares(const StrandModel& model, const StrandSamples& samples);

}  // namespace strandcast
