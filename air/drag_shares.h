#pragma once
#include <vector>

#include "air/strand_samples.h"

namespace strandcast {

/// Distribution of the drag over the samples where strands have drag factors (StrandModel::air_drag_scale).
/// The momentum that the air loses then equals the momentum that the hair gains.
struct DragShares {
  double mean = 1;  ///< mean drag factor of all hair, weighted by mass
  /// Per sample: its drag factor over the mean. The sum of mass x share equals the sum of masses. Empty: all
  /// shares are 1.
  std::vector<float> of_samples;
};

DragShares dragShares(const StrandModel& model, const StrandSamples& samples);

}  // namespace strandcast
