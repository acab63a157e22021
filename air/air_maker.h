#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "air/wind.h"
#include "air/wind_source.h"
#include "core/external_forces.h"

namespace strandcast {

/// Factory functions of a backend for air and for forces between hairs.
struct AirMaker {
  /// Makes the air system: wind grid and hair grid (docs/air.md). Throws Error for a source out of range.
  std::function<std::unique_ptr<ExternalForces>(std::vector<WindSource>)> make;
  /// Makes a wind grid alone. `cell`: m.
  std::function<std::unique_ptr<Wind>(int cells, float cell, Wind::Border)> wind;
};

/// Makers of the CPU backends: "reference" (float, scalar, one thread), "oracle" (the same in double) or
/// "simd" (vectors, `threads` threads, 0 = all). Throws Error on another name.
AirMaker cpuAir(const std::string& backend, int threads = 0);

}  // namespace strandcast
