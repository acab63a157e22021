#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "air/wind.h"
#include "air/wind_source.h"
#include "core/surroundings.h"

namespace strandcast {

/// How a backend does the work of air and of forces between hairs.
struct AirMaker {
  /// Wind on a grid and forces between hairs (docs/air.md). Throws Error for a source that is out of range.
  std::function<std::unique_ptr<Surroundings>(std::vector<WindSource>)> surroundings;
  /// Air alone.
  std::function<std::unique_ptr<Wind>(int cells, float cell, Wind::Border)> wind;
};

/// Of the CPU backends: "reference" (float, scalar, one thread), "oracle" (the same in double) or "simd"
/// (lanes, `threads`, 0 = all). Error on another name.
AirMaker cpuAir(const std::string& backend, int threads = 0);

}  // namespace strandcast
