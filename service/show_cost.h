// What a scene costs on this machine: a short run, as a daemon would do it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "groom/groom_check.h"
#include "options/settings.h"
#include "scenes/scene.h"

namespace strandcast {

/// Measurements of a run of at most a second of the scene.
struct ShowCost {
  std::string backend, device, codec;
  size_t strands = 0, vertices = 0;
  size_t steps = 0;            ///< measured, without the first ones, which make programs and buffers
  double steps_per_frame = 1;  ///< simulated steps from one published frame to the next
  double step_ms_median = 0, step_ms_p95 = 0;
  double encode_ms_median = 0;   ///< per frame, on the threads of the settings
  uint64_t bytes_per_frame = 0;  ///< mean of the frames, all chunks
  size_t memory_bytes = 0;       ///< estimate: hair (kBytesPerVertex) and the bodies' fields
  uint64_t strands_reset = 0;    ///< strands that broke and were put back to rest
  double max_stretch = 0;        ///< at the end, relative
  double max_penetration = 0;    ///< m, at the end
};

/// Runs the scene on the backend and with the codec and rate of `settings` for a second of its motion, or for
/// kLongestCostRun of this machine's time if that is less. `progress`: share done, 0 to 1. Throws Error as
/// makeSimulation(); Interrupted.
ShowCost measureShowCost(const Scene& scene, const Settings& settings,
                         const std::function<void(double part)>& progress = {});
constexpr double kLongestCostRun = 10;  ///< s

/// The measurements against the interval of frames at `rate` per second.
CheckReport checkCost(const ShowCost& cost, double rate);
constexpr double kFullFrame = 0.7;  ///< share of the interval above which there is a warning

}  // namespace strandcast
