#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "apps/settings.h"
#include "transport/messages.h"

namespace strandcast {

/// How hair fared under a head that moved and then kept still.
struct ShakeResult {
  double step_ms_median = 0;
  double mean_stretch = 0;  ///< while the head moved: mean over edges and steps of |length / rest length - 1|
  double max_stretch = 0;   ///< the largest of the same
  double style_rms = 0;     ///< m, in the end: distance of vertices from the rest shape at the head, rms
  double style_max = 0;     ///< m, the largest
  double rest_speed = 0;    ///< m/s, rms over vertices and the steps of the last half second
  uint64_t moving_strands = 0;  ///< whose own rms speed then is above kRestingSpeed
  uint64_t strands_reset = 0;   ///< to their rest shape because they went wrong, times they were
  double max_penetration = 0;   ///< m, at any step
};

constexpr double kRestingSpeed = 1e-3;  ///< m/s, at which hair counts as at rest

/// Runs a scene's hair under the scene's motion for `shake` seconds, at whose end the head is back at its
/// rest pose, and for `rest` seconds more under a still head; step by step, as fast as the caller asks.
class ShakeTrial {
 public:
  /// Throws Error.
  ShakeTrial(const Scene& scene, const Settings& settings, double shake, double rest);

  size_t steps() const { return steps_; }  ///< of the whole trial
  void step();
  /// The newest guides, head and colliders, as a daemon would cast them.
  void fill(GuideFrame& frame);
  /// After the last step.
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
