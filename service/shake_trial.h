#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "options/settings.h"
#include "transport/messages.h"

namespace strandcast {

/// Measurements of hair under a head that moved and then kept still.
struct ShakeResult {
  double step_ms_median = 0;
  double mean_stretch = 0;  ///< while the head moves: mean over edges and steps of |length / rest length - 1|
  double max_stretch = 0;   ///< largest over edges and steps
  double style_rms = 0;     ///< m, at the end: rms distance of vertices from the rest shape at the head
  double style_max = 0;     ///< m, the largest distance
  double rest_speed = 0;    ///< m/s, rms over vertices and the steps of the last 0.5 s
  uint64_t moving_strands = 0;  ///< strands whose own rms speed then exceeds kRestingSpeed
  uint64_t strands_reset = 0;   ///< number of resets of broken strands to their rest shape
  double max_penetration = 0;   ///< m, largest of all steps
};

constexpr double kRestingSpeed = 1e-3;  ///< m/s, below which hair counts as at rest

/// Runs a scene's hair under the scene's motion for `shake` seconds, after which the head is at its rest
/// pose, and for `rest` seconds under a still head. The caller drives the steps.
class ShakeTrial {
 public:
  /// Throws Error.
  ShakeTrial(const Scene& scene, const Settings& settings, double shake, double rest);

  size_t steps() const { return steps_; }  ///< of the whole trial
  void step();
  /// Fills a frame with the newest guides, head and colliders, as a daemon would publish them.
  void fill(GuideFrame& frame);
  /// Call after the last step.
  ShakeResult result();

  Simulation& simulation() { return simulation_; }

 private:
  void addSpeeds();

  Simulation simulation_;
  std::shared_ptr<const SkinnedBody> skinned_;
  HeadMotion motion_;
  size_t shake_steps_, steps_, speed_steps_;
  ShakeResult result_;
  std::vector<double> step_ms_;
  std::vector<double> squared_speeds_;  ///< per strand, (m/s)^2, sum over vertices and steps
  StrandState state_;
};

}  // namespace strandcast
